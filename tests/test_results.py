"""Results along the cable and as files: closed forms, units, what comes back from netCDF, and what is refused."""

from __future__ import annotations

import contextlib
import io
import re
import sys
import tomllib
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import xarray
from catenaries import between_points
from chain_support import HANGING, WEIGHT, make
from typer.testing import CliRunner

from cable_model import CableChain, TowCable, __version__, cli, load, simulate
from cable_model.errors import ParameterError
from cable_model.facts import PROFILE
from cable_model.profiles import curvature
from cable_model.result_files import dataset, write_netcdf
from cable_model.scene import from_dict, with_values
from cable_model.signals import INPUTS, OUTPUTS
from cable_model.simulation import COLUMNS, Result, read_csv
from fmu_src.interface import table

GUIDE = Path(__file__).parent.parent / "docs" / "how_to" / "results.md"
PROFILES = ("x", "y", "z", "tension", "curvature")
SCENE = """
title = "A chain, shaken"
source = "none, for these tests"
[cable]
length = 1.75
mass_per_length = 0.1
axial_stiffness = 17167.5
[[top.motion]]
kind = "sinusoid"
axis = "x"
amplitude = 0.02
angular_frequency = 6.5
ramp_time = 1.0
[solver]
nodes = 11
[run]
duration = 0.5
output_step = 0.05
"""
WINCH = "[winch]\nfitted = true\nspeeds = [[0.0, 0.5], [10.0, 0.5]]\n"


def ran(*arguments):
    done = CliRunner().invoke(cli.app, ["run", *map(str, arguments)])
    return done.exit_code, done.output, done.exception


# -- values


def on_a_circle(angles, radius):
    """Points on a circle in a plane that is none of the axes'."""
    across, up = np.array([2.0, 1.0, 2.0]) / 3.0, np.array([-2.0, 2.0, 1.0]) / 3.0
    return radius * (np.cos(angles)[:, None] * across + np.sin(angles)[:, None] * up) + 7.0


def test_curvature_of_equal_chords_in_a_circle_is_exact():
    for radius, count in ((0.3, 3), (5.0, 4), (400.0, 50)):
        points = on_a_circle(np.linspace(0.3, 2.0, count), radius)
        assert curvature(points) == pytest.approx(1.0 / radius, rel=1e-9)
        assert curvature(np.stack((points, 2.0 * points)))[1] == pytest.approx(0.5 / radius, rel=1e-9)


def test_curvature_of_a_line_that_turns_back_is_finite_and_of_a_straight_one_0():
    line = np.array([[0.0, 0.0, 0.0], [0.0, 0.0, -0.5], [0.0, 0.0, 0.0]])
    assert curvature(line) == pytest.approx(2.0 / 0.5)
    assert curvature(np.outer(np.geomspace(1.0, 9.0, 6), [1.0, 2.0, 2.0])) == pytest.approx(0.0, abs=1e-9)
    assert np.array_equal(curvature(line[:2]), [0.0, 0.0])
    assert np.isfinite(curvature(line[[0, 1, 1, 2]])).all()  # two points in one place


def test_curvature_is_led_on_to_the_ends_by_a_straight_line_but_not_below_0():
    """Of a line in the plane whose curvature is linear over its length, by unequal chords."""
    lengths = np.array([0.1, 0.2, 0.3, 0.4])
    for slope in (1.0, -0.5, 1.6, -1.6):
        expected = 1.0 + slope * (np.cumsum([0.0, *lengths]) - 0.5)
        turns = 2.0 * np.arcsin(0.5 * np.clip(expected[1:-1], 0.0, None) * 0.5 * (lengths[1:] + lengths[:-1]))
        angles = np.cumsum([0.4, *turns])
        chords = lengths[:, None] * np.column_stack((np.cos(angles), np.zeros(4), np.sin(angles)))
        assert curvature(np.cumsum([[0.0, 0.0, 0.0], *chords], axis=0)) == pytest.approx(expected, rel=1e-9)
    downwards = np.array([[-1.0, 0.0, 0.0], [0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [2.0, 0.0, 1.0]])
    assert curvature(downwards)[0] == 0.0 and curvature(downwards)[-1] > curvature(downwards)[-2] > 0.5


@pytest.mark.parametrize(
    ("grid", "grading", "stiffness"), [("staggered", 0.0, 1e9), ("staggered", 0.0, 500.0), ("staggered", 2.0, 500.0), ("box", 0.0, 500.0)]
)
def test_tension_and_curvature_along_a_catenary_are_of_second_order(grid, grading, stiffness):
    """At every node, the ends too: T^2 = H^2 + (V - w (L - s))^2, and w H/T^2 of the unstretched cable over 1 + T/EA."""
    across, up = between_points(10.0, 10.0, stiffness, 7.0, 3.0)
    misses = []
    for nodes in (51, 101, 201):
        scene = from_dict({
            "cable": {"length": 10.0, "mass_per_length": 1.0, "axial_stiffness": stiffness}, "environment": {"gravity": 10.0},
            "lower_end": {"anchored": True}, "top": {"position": [7.0, 0.0, 3.0]},
            "solver": {"nodes": nodes, "grid": grid, "grading": grading},
        })  # fmt: skip
        profiles = simulate(CableChain(scene), duration=0.01).profiles([0.0])
        tension = np.hypot(across, up - 10.0 * (10.0 - profiles.arc_lengths[0]))
        bent = 10.0 * across / tension**2 / (1.0 + tension / stiffness)
        of_tension, of_curvature = np.abs(profiles.tensions[0] / tension - 1.0), np.abs(profiles.curvatures[0] - bent) / bent.max()
        misses.append([of_tension.max(), of_curvature[1:-1].max(), *of_curvature[[0, -1]]])
    assert max(misses[0]) < 0.003
    assert np.log2(np.divide(misses[1], misses[2])) == pytest.approx(2.0, abs=0.1)


@pytest.mark.parametrize(("grid", "grading"), [("staggered", 0.0), ("staggered", 2.0), ("box", 1.0)])
def test_a_soft_hanging_cable_is_stretched_and_carries_what_is_below_as_in_closed_form(grid, grading):
    """T = F + w s and z = -(L - s) - (F (L - s) + w (L^2 - s^2)/2)/EA over the unstretched length s from the lower end."""
    stiffness, load_below = 20.0 * WEIGHT, 3.0 * WEIGHT
    base = {**HANGING, "body": {"mass": 0.3 * 1.75}}
    model = make(base, solver__grid=grid, solver__grading=grading, solver__nodes=21, cable__axial_stiffness=stiffness)
    profiles = simulate(model, duration=0.1).profiles()
    s = profiles.arc_lengths[-1]
    assert s[[0, -1]] == pytest.approx([0.0, 1.75], abs=1e-12)
    assert (np.ptp(np.diff(s)) > 1e-3) == (grading != 1.0)  # unequal cells
    assert profiles.tensions[-1] == pytest.approx(load_below + WEIGHT * s / 1.75, rel=1e-6)
    stretched = (load_below * (1.75 - s) + 0.5 * WEIGHT * (1.75**2 - s**2) / 1.75) / stiffness
    assert profiles.positions[-1][:, 2] == pytest.approx(s - 1.75 - stretched, abs=1e-4)
    assert profiles.positions[-1][:, :2] == pytest.approx(0.0, abs=1e-9)
    assert profiles.curvatures[-1] == pytest.approx(0.0, abs=1e-6)


def test_a_straight_cable_has_its_two_ends_and_no_curvature():
    run = simulate(TowCable(load("dale_sphere")), duration=1.0)
    profiles = run.profiles()
    assert np.array_equal(profiles.arc_lengths, np.tile([0.0, 2.7432], (11, 1)))
    assert np.array_equal(profiles.curvatures, np.zeros((11, 2)))
    assert np.array_equal(profiles.tensions.T, [run["body.tension"], run["top.tension"]])


def test_profiles_are_those_of_the_output_steps_nearest_to_the_times_that_are_asked_for(run):
    assert np.array_equal(run.profiles().times, run["time"])
    some = run.profiles(times=[0.5, 0.0, 0.17, 0.23])
    rows = [10, 0, 3, 5]
    assert np.array_equal(some.times, run["time"][rows])
    assert np.array_equal(some.positions, run.shapes[rows]) and np.array_equal(some.tensions, run.tensions[rows])
    assert np.array_equal(run.profiles(0.26).times, run["time"][[5]])
    begun = replace(run, table=run.table[:1])  # of a run that stopped in its first step
    assert np.array_equal(begun.profiles(0.0).positions, run.shapes[:1]) and run.profiles([]).curvatures.shape == (0, 11)
    for time, shown in ((-0.01, "-0.01"), (0.51, "0.51"), (np.nan, "nan")):
        told = f"times = {shown} s: must be >= 0 and <= 0.5, the times of the run. Ask for others, or simulate longer."
        with pytest.raises(ParameterError, match=f"^{re.escape(told)}$"):
            run.profiles([0.1, time])


# -- datasets


def test_every_variable_has_its_unit_and_meaning(run):
    made = run.to_xarray()
    assert set(made.variables) == {*COLUMNS, *PROFILE}
    units = {"x": "m", "y": "m", "z": "m", "vx": "m/s", "vy": "m/s", "vz": "m/s", "ax": "m/s2", "ay": "m/s2", "az": "m/s2"}
    units |= {"time": "s", "arc_length": "m", "curvature": "1/m", "declination": "rad", "growth": "1/s", "energy": "J", "speed": "m/s",
              "current_x": "m/s", "current_y": "m/s", "bending_moment_max": "N.m", "suspended_length": "m", "touchdown_x": "m",
              "touchdown_y": "m", "touchdown_z": "m", "paid_out": "m", "elevation": "m", "remaining_length": "m", "let_go": ""}  # fmt: skip
    units |= {f"moment_{axis}": "N.m" for axis in "xyz"}
    for name, variable in made.variables.items():
        key = name.rpartition(".")[2]
        force = "force" in key or "tension" in key or key == "momentum"
        assert variable.attrs["units"] == ("N" if force else units.get(key, "1")), name
        assert variable.attrs["long_name"]
    counted = {name for name, variable in made.variables.items() if variable.attrs["units"] == "1"}
    assert counted == {"cable.slack_fraction", "solver.steps", "solver.newton_iterations", "solver.rejected_steps", "cable.parted"}
    fmus = {row.name: (row.unit, row.description) for row in table()}
    assert all(fmus[name] == (made[name].attrs["units"], made[name].attrs["long_name"]) for name in (*INPUTS, *OUTPUTS))


def test_a_dataset_has_the_numbers_of_the_result(run):
    made = run.to_xarray()
    assert all(np.array_equal(made[name], run[name]) for name in COLUMNS)
    assert made["top.tension"].dims == ("time",) and {made[name].dims for name in PROFILES} == {("time", "arc_length")}
    assert np.array_equal(np.stack([made[axis] for axis in "xyz"], axis=-1), run.shapes)
    assert np.array_equal(made["tension"].sel(arc_length=1.75), run["top.tension"])
    assert np.array_equal(made["curvature"], run.profiles().curvatures) and made["curvature"].max() > 0.04


def test_a_dataset_says_where_it_comes_from(scene, run):
    told = run.to_xarray().attrs
    assert told["title"] == "A chain, shaken" and told["source"] == "none, for these tests"
    assert told["model"] == "CableChain" and told["version"] == f"cable-fmu {__version__}"
    assert from_dict(tomllib.loads(told["scene"])) == load(scene)
    assert "warnings" not in told
    shorter = simulate(CableChain(load(scene)), duration=0.1, output_step=0.1)
    assert from_dict(tomllib.loads(shorter.to_xarray().attrs["scene"])) == with_values(
        load(scene), {"run.duration": 0.1, "run.output_step": 0.1}
    )
    doubtful = Result(run.columns, run.table, run.shapes, ("one.", "two, μ."))
    assert dataset(doubtful).attrs == {"version": told["version"], "warnings": "one.\ntwo, μ."}


@pytest.mark.parametrize("winch", [False, True])
def test_a_dataset_comes_back_from_netcdf_as_it_was(scene, tmp_path, winch):
    path = tmp_path / "new" / "a.nc"
    scene = tmp_path / "a.toml"
    scene.write_text(SCENE.replace("shaken", "shäken") + (WINCH if winch else ""), encoding="utf-8")
    result = simulate(CableChain(load(scene)), duration=0.2)
    write_netcdf(path, result)
    xarray.testing.assert_identical(xarray.load_dataset(path, engine="scipy"), result.to_xarray())
    assert path.read_bytes()[:4] == b"CDF"


def test_arc_lengths_of_a_cable_that_is_paid_out_go_over_time(tmp_path):
    (tmp_path / "a.toml").write_text(SCENE + WINCH, encoding="utf-8")
    run = simulate(CableChain(load(tmp_path / "a.toml")))
    made = run.to_xarray()
    assert made["arc_length"].dims == made["tension"].dims == ("time", "point")
    assert made["arc_length"][:, -1].values == pytest.approx(1.75 + 0.5 * run["time"], rel=1e-9)
    assert made["arc_length"][:, 0].values == pytest.approx(0.0, abs=0.0)
    assert "arc_length" in made.coords


def test_a_result_that_is_of_no_model_says_that_it_has_no_profiles(run):
    of_an_fmu = Result(run.columns, run.table, run.shapes[:, [0, -1]])
    told = "profiles: must be of a model's run, and this result has time series only. Use simulate, or connect shape.* of the FMU."
    with pytest.raises(ParameterError, match=f"^{re.escape(told)}$"):
        of_an_fmu.profiles()
    assert set(of_an_fmu.to_xarray().variables) == set(COLUMNS)


# -- the command line


@pytest.fixture
def refused(monkeypatch):
    """The line that an error is; nothing may be simulated before it."""

    def simulated(*arguments):
        raise AssertionError

    monkeypatch.setattr(cli, "run_with_progress", simulated)

    def run(*arguments):
        _, _, error = ran(*arguments)
        assert type(error) is ParameterError
        return str(error)

    return run


def test_the_ending_of_the_output_decides_what_is_written(scene, run, tmp_path):
    for name in ("a.nc", "b.NC", "c.csv"):
        status, told, _ = ran(scene, "-o", tmp_path / name)
        assert status == 0 and f"wrote {tmp_path / name}\n" in told and "top tension, mean" in told
    for name in ("a.nc", "b.NC"):
        xarray.testing.assert_identical(xarray.load_dataset(tmp_path / name, engine="scipy"), run.to_xarray())
    columns, numbers = read_csv(tmp_path / "c.csv")
    assert columns == COLUMNS and np.array_equal(numbers, run.table)


def test_profiles_are_written_on_request_a_line_for_each_point_at_each_output_step(scene, run, tmp_path):
    status, told, _ = ran(scene, "-o", tmp_path / "a.csv", "--profiles", tmp_path / "new" / "p.csv")
    assert status == 0 and f"wrote {tmp_path / 'a.csv'} and {tmp_path / 'new' / 'p.csv'}" in told
    columns, numbers = read_csv(tmp_path / "new" / "p.csv")
    assert columns == ("time", "arc_length", "x", "y", "z", "tension", "curvature")
    profiles, by_step = run.profiles(), numbers.reshape(11, 11, 7)
    assert np.array_equal(by_step[:, :, 0], np.tile(run["time"][:, None], 11))
    assert np.array_equal(by_step[:, :, 1], profiles.arc_lengths) and np.array_equal(by_step[:, :, 2:5], profiles.positions)
    assert np.array_equal(by_step[:, :, 5], profiles.tensions) and np.array_equal(by_step[:, :, 6], profiles.curvatures)


def test_of_two_models_each_has_its_files(scene, tmp_path):
    scene = tmp_path / "b.toml"
    scene.write_text(SCENE + "[body]\nmass = 1.0\n", encoding="utf-8")
    assert ran(scene, "--model", "both", "-o", tmp_path / "a.nc", "--profiles", tmp_path / "p.csv")[0] == 0
    assert {path.name for path in tmp_path.iterdir()} == {"b.toml", "a_chain.nc", "a_tow.nc", "p_chain.csv", "p_tow.csv"}
    assert xarray.load_dataset(tmp_path / "a_tow.nc", engine="scipy").attrs["model"] == "TowCable"


def test_a_run_that_stops_leaves_what_came_before_in_all_files(tmp_path):
    hauled = tmp_path / "hauled.toml"
    hauled.write_text(SCENE + WINCH.replace("0.5]", "-10.0]"), encoding="utf-8")
    status, _, error = ran(hauled, "-o", tmp_path / "a.nc", "--profiles", tmp_path / "p.csv")
    assert status == 1 and "the winch hauled in the whole cable" in str(error)
    left = xarray.load_dataset(tmp_path / "a.nc", engine="scipy")
    assert 2 <= left.sizes["time"] < 11
    assert len(read_csv(tmp_path / "p.csv")[1]) == 11 * left.sizes["time"]


def test_names_of_other_files_are_refused_before_simulating(scene, refused, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    folder, given = tmp_path / "folder.nc", tmp_path / "a.csv"
    folder.mkdir()
    for option in ("-o", "--profiles"):
        assert refused(scene, option, folder) == f"{folder}: is a folder. Give the name of a file."
    assert refused(scene, "-o", "a.h5") == "a.h5: no name of a file of results. Give one that ends in .nc (netCDF) or .csv."
    told = "a.nc: no name of a table of profiles. Give one that ends in .csv; -o FILE.nc has profiles too."
    assert refused(scene, "--profiles", "a.nc") == told
    same = "is the file of the time series. Give profiles a name of their own."
    assert refused(scene, "-o", given, "--profiles", "a.csv") == f"a.csv: {same}"
    assert refused(scene, "--profiles", "results/chain.csv") == f"results/chain.csv: {same}"
    assert refused(scene, "--model", "tow", "--profiles", "results/chain_tow.csv") == f"results/chain_tow.csv: {same}"


def test_what_is_not_installed_is_named(scene, run, refused, monkeypatch):
    monkeypatch.setitem(sys.modules, "xarray", None)
    told = "xarray: not installed. Install it with pip install 'cable-fmu[results]'."
    assert refused(scene, "-o", "a.nc") == told
    with pytest.raises(ParameterError, match=f"^{re.escape(told)}$"):
        run.to_xarray()


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="needs a disk that is full")
@pytest.mark.parametrize("name", ["full.nc", "full.csv"])
def test_a_full_disk_is_named(scene, tmp_path, name, monkeypatch, capsys):
    full = tmp_path / name
    full.symlink_to("/dev/full")
    files = ("-o", full) if name == "full.nc" else ("-o", tmp_path / "a.csv", "--profiles", full)
    monkeypatch.setattr(sys, "argv", ["cable_model", "run", str(scene), *map(str, files)])
    with pytest.raises(SystemExit) as ended:
        cli.main()
    assert ended.value.code == 2
    assert capsys.readouterr().out.strip() == f"error: {full}: No space left on device. Free some space, or write elsewhere with -o."


# -- the guide


def test_the_guide_does_what_it_says(tmp_path, monkeypatch):
    text = GUIDE.read_text(encoding="utf-8")
    (commands,) = re.findall(r"```bash\n(.*?)```", text, re.DOTALL)
    first, last = re.findall(r"```python\n(.*?)```", text, re.DOTALL)
    install, command = commands.splitlines()
    assert install == "pip install 'cable-fmu[results]'"
    monkeypatch.chdir(tmp_path)
    assert ran(*command.split()[2:])[0] == 0 and command.startswith("cable-fmu run ")
    assert {path.name for path in tmp_path.iterdir()} == {"chain.nc", "chain_profiles.csv"}
    told = [io.StringIO(), io.StringIO()]
    for block, shown in zip((first, last), told, strict=True):
        with contextlib.redirect_stdout(shown):
            exec(compile(block, GUIDE.name, "exec"), {})
    tension, along, sharpest = told[0].getvalue().splitlines()
    assert re.fullmatch(r"\d\.\d+ N", tension) and 0.0 < float(along) < float(tension.split()[0])
    assert set(re.findall(r"'(\w+)'", sharpest)) == {"time", "arc_length"}
    assert told[1].getvalue().startswith("[1. 2.] (2, 51) (2, 51, 3)\n") and "<xarray.Dataset>" in told[1].getvalue()
