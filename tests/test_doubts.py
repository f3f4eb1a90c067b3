"""Warnings: what is doubtful is told once, in one form, with both numbers, and where nothing is, nothing is told."""

from __future__ import annotations

import contextlib
import math
import re
from pathlib import Path

import numpy as np
import pytest
from doubts_support import FORM, WIRE
from fmu_support import FMICallException
from native_support import FLAVOURS
from typer.testing import CliRunner

from cable_model import CableChain, TowCable, load, simulate
from cable_model.cli import app
from cable_model.doubts import FEWEST_STEPS, at_the_start, before_the_run, forcing, seen, under_a_given_motion
from cable_model.kernels.jit import for_kernels
from cable_model.kernels.watch_outputs import watch_outputs
from cable_model.model import Model
from cable_model.parameters import value_of
from cable_model.scene import Scene, from_dict, shipped, to_toml, with_values
from cable_model.signals import OUTPUTS

NEUTRAL = Path(__file__).parent / "data" / "F6_neutral_rov.toml"


def outputs(lowest: float, highest: float) -> list[float]:
    """Outputs with these tensions."""
    row = [0.0] * len(OUTPUTS)
    row[OUTPUTS.index("cable.tension_min")], row[OUTPUTS.index("cable.tension_max")] = lowest, highest
    return row


def swaying(period: float, axis: str = "x", **solver: float) -> dict[str, object]:
    motion = {"kind": "sinusoid", "axis": axis, "amplitude": 1.0, "angular_frequency": 2.0 * math.pi / period}
    return {**WIRE, "top": {"motion": [motion]}, "solver": solver, "run": {"output_step": 1.0}}


def at_rest(scene: Scene, kind: type[Model], tension: float = 0.0) -> tuple[str, ...]:
    """What a run that starts with this largest tension leaves doubtful, as the kernels see it."""
    model = kind(scene)
    watch_outputs(model.parts, for_kernels(model.numbers), model.state, np.array(outputs(0.0, tension)))
    return seen(model.state)


@pytest.mark.parametrize("kind", [CableChain, TowCable])
def test_a_neutral_vehicle_on_a_neutral_tether_has_no_unique_rest(kind: type[Model]):
    scene = load(NEUTRAL)
    (text,) = at_rest(scene, kind)
    assert re.match(r"weight in water = \S+ N of a mass of 16\.15 kg: there is no unique rest position", text)
    assert FORM.fullmatch(text)
    (last_digit,) = at_rest(with_values(scene, {"cable.mass_per_length": 0.046498712865782485}), kind)
    assert FORM.fullmatch(last_digit)
    assert not at_rest(with_values(scene, {"body.mass": 11.6}), kind)
    assert not at_rest(with_values(scene, {"current.speed": 0.1}), kind)
    (weightless,) = at_rest(with_values(scene, {"environment.gravity": 0.0}), kind)
    assert weightless.startswith("weight in water = 0 N of")


def test_a_weightless_cable_that_is_slack_between_two_held_ends_rests_in_any_shape():
    cable = {"cable.mass_per_length": 1025.0 * math.pi / 4.0 * 0.01**2, "lower_end.anchored": True, "lower_end.x": 50.0}
    scene = with_values(from_dict({**WIRE, "water": {}}), cable)
    (text,) = at_rest(scene, CableChain, 1e-7)
    assert FORM.fullmatch(text)
    assert re.match(r"weight in water = \S+ N of a mass of 8\.05 kg between two held ends: ", text)
    assert not at_rest(scene, CableChain, 50.0)
    assert not at_rest(with_values(scene, {"cable.mass_per_length": 1.0}), CableChain, 1e-7)


@pytest.mark.parametrize("flavour", FLAVOURS)
@pytest.mark.parametrize("key", ["chain", "tow"])
def test_every_fmu_says_that_a_neutral_vehicle_may_rest_anywhere(request: pytest.FixtureRequest, flavour: str, key: str):
    """As a warning, or as an error where no rest is found."""
    fmu = request.getfixturevalue(flavour)[key]
    instance, own = fmu.instance(), load(NEUTRAL)
    names = ("cable.length", "cable.mass_per_length", "cable.axial_stiffness", "cable.diameter", "body.mass", "body.volume")
    with contextlib.suppress(FMICallException):
        instance.initialize({name: value_of(own, name) for name in names} | {"current.speed": 0.0}, [0.0, 0.0, -1.0, *[0.0] * 7])
    assert sum("rest position" in text or "weigh less than a millionth" in text for _, text in instance.messages) == 1
    instance.slave.freeInstance()


def test_a_step_of_fewer_than_twenty_in_a_period_is_told_and_its_remedy_is_none():
    (text,) = before_the_run(from_dict(swaying(5.0, time_step=0.5)))
    assert FORM.fullmatch(text)
    assert "time step = 0.5 s under a forcing of 5 s: 10 steps a period" in text
    remedy = float(re.search(r"solver\.time_step = ([\d.]+)", text)[1])
    assert remedy == pytest.approx(5.0 / FEWEST_STEPS)
    assert not list(before_the_run(from_dict(swaying(5.0, time_step=remedy))))
    assert not list(before_the_run(from_dict(swaying(5.0, time_step=0.5, tolerance=1e-3))))


def test_waves_and_cable_that_know_two_bottoms_are_told():
    seabed = {"level": -80.0, "stiffness": 1e5}
    scene = from_dict({**WIRE, "water": {"depth": 50.0}, "waves": {"amplitude": 0.5}, "seabed": seabed})
    (text,) = before_the_run(scene)
    assert text.startswith("water.depth = 50 m over a seabed at z = -80 m:")
    assert FORM.fullmatch(text)
    assert not list(before_the_run(with_values(scene, {"water.depth": 80.0})))
    assert not list(before_the_run(with_values(scene, {"waves.amplitude": 0.0, "water.depth": 0.0})))


def test_the_forcing_of_a_sea_is_that_of_the_waves_which_move_water():
    """Pierson-Moskowitz: the share of m2 above omega is erf(sqrt(5)/2 (peak/omega)^2), with u = omega^-2 in its integral."""
    sea = {"spectrum": "pierson-moskowitz", "significant_height": 3.0, "peak_period": 10.0, "components": 400}
    scene = from_dict({**WIRE, "water": {}, "waves": sea})
    peak = 0.2 * math.pi
    share = math.erf(math.sqrt(1.25) * (peak / forcing(scene)) ** 2)
    assert share == pytest.approx(0.05, abs=0.01)


def test_a_table_of_motion_that_swings_between_rows_that_are_alike_is_told():
    """At rest for 40 s, by rows 20 s apart: the spline begins at 0.13 m/s and goes half a metre off."""
    rest, after = [0.0, 20.0, 40.0], [(50.0, 2.5), (60.0, 7.5), (80.0, 17.5), (100.0, 27.5)]
    sparse = [[time, 0.0, 0.0, 0.0] for time in rest] + [[time, x, 0.0, 0.0] for time, x in after]
    (text,) = under_a_given_motion(from_dict({**WIRE, "top": {"table": sparse}}))
    assert re.fullmatch(FORM, text) and text.startswith("top.table = 0.")
    assert "m off between rows that are alike at 0 and 20 s, of 27.5 m in all: " in text
    close = [[time, 0.0, 0.0, 0.0] for time in np.arange(0.0, 40.0, 0.5)] + sparse[3:]
    assert not list(under_a_given_motion(from_dict({**WIRE, "top": {"table": [[0.0, 0.0, 0.0, 0.0], *close[36:]]}})))
    assert not list(before_the_run(from_dict({**WIRE, "top": {"table": sparse}})))  # a host moves the top of an FMU


def test_cells_that_do_not_resolve_waves_along_and_across_are_told():
    scene = from_dict(swaying(0.5, nodes=11))
    texts = list(at_the_start(scene, "chain", outputs(500.0, 1500.0)))
    speed = math.sqrt(1000.0 / 1.0)
    assert [FORM.fullmatch(text) is not None for text in texts] == [True]
    assert f"cells = 10 m for waves across the cable of {0.5 * speed:.3g} m" in texts[0]
    nodes = int(re.search(r"solver\.nodes = (\d+)", texts[0])[1])
    assert not list(at_the_start(with_values(scene, {"solver.nodes": nodes}), "chain", outputs(500.0, 1500.0)))
    heave = from_dict(swaying(0.05, axis="z", nodes=11))
    (text,) = at_the_start(heave, "chain", outputs(500.0, 1500.0))
    assert f"waves along the cable of {0.05 * 1000.0:.3g} m" in text
    assert not list(at_the_start(scene, "tow", outputs(500.0, 1500.0)))


def test_a_run_and_the_command_line_tell_them_and_the_numbers_are_the_same(tmp_path: Path):
    scene = with_values(load("dale_sphere"), {"solver.time_step": 0.5, "run.output_step": 0.5, "run.duration": 2.0})
    result = simulate(TowCable(scene))
    assert len(result.warnings) == 1
    path = tmp_path / "coarse.toml"
    path.write_text(to_toml(scene), encoding="utf-8")
    done = CliRunner().invoke(app, ["run", str(path), "--model", "tow", "-o", str(tmp_path / "a.csv")])
    assert done.exit_code == 0
    assert f"warning: {result.warnings[0]}" in done.stderr
    assert "warning" not in done.stdout


def test_a_mass_of_the_host_under_a_given_motion_is_told():
    scene = with_values(load("dale_sphere"), {"host.mass": 500.0, "run.duration": 1.0})
    (text,) = simulate(TowCable(scene)).warnings
    assert text.startswith("host.mass = 500 kg in a run whose top moves as the scene says: it changes nothing. ")
    assert FORM.fullmatch(text)
    assert not simulate(TowCable(with_values(scene, {"host.mass": 0.0}))).warnings


@pytest.mark.parametrize("name", [name for name in shipped() if "/" not in name])
def test_shipped_scenes_leave_no_doubt(name: str):
    scene = load(name)
    assert not list(before_the_run(scene))


def test_the_shaken_chain_resolves_its_waves():
    model = CableChain(load("hanging_chain"))
    model.initialize([0.0] * 10)
    assert model.warnings() == ()
