"""Warnings: what is doubtful is told once, in one form, with both numbers, and where nothing is, nothing is told."""

from __future__ import annotations

import math
import re
from pathlib import Path

import pytest
from typer.testing import CliRunner

from cable_model import CableChain, TowCable, load, simulate
from cable_model.cli import app
from cable_model.doubts import FEWEST_STEPS, at_the_start, before_the_run, forcing
from cable_model.scene import from_dict, shipped, to_toml, with_values
from cable_model.signals import OUTPUTS

WIRE = {"cable": {"length": 100.0, "mass_per_length": 1.0, "axial_stiffness": 1e6, "diameter": 0.01}}
FORM = re.compile(r"[^:]+ [^:]*\d[^:]*: .+\. (Give|Set|Check) .+\.")
NEUTRAL = Path(__file__).parent / "data" / "F6_neutral_rov.toml"


def outputs(lowest: float, highest: float) -> list[float]:
    """Outputs with these tensions."""
    row = [0.0] * len(OUTPUTS)
    row[OUTPUTS.index("cable.tension_min")], row[OUTPUTS.index("cable.tension_max")] = lowest, highest
    return row


def swaying(period: float, axis: str = "x", **solver: float) -> dict[str, object]:
    motion = {"kind": "sinusoid", "axis": axis, "amplitude": 1.0, "angular_frequency": 2.0 * math.pi / period}
    return {**WIRE, "top": {"motion": [motion]}, "solver": solver, "run": {"output_step": 1.0}}


def test_a_neutral_vehicle_on_a_neutral_tether_has_no_unique_rest():
    (text,) = before_the_run(load(NEUTRAL), "chain")
    assert text.startswith("weight in water = ")
    assert FORM.fullmatch(text)
    assert not list(before_the_run(with_values(load(NEUTRAL), {"body.mass": 11.6}), "chain"))
    assert not list(before_the_run(with_values(load(NEUTRAL), {"current.speed": 0.1}), "chain"))


def test_a_step_of_fewer_than_twenty_in_a_period_is_told_and_its_remedy_is_none():
    (text,) = before_the_run(from_dict(swaying(5.0, time_step=0.5)), "chain")
    assert FORM.fullmatch(text)
    assert "time step = 0.5 s under a forcing of 5 s: 10 steps a period" in text
    remedy = float(re.search(r"solver\.time_step = ([\d.]+)", text)[1])
    assert remedy == pytest.approx(5.0 / FEWEST_STEPS)
    assert not list(before_the_run(from_dict(swaying(5.0, time_step=remedy)), "chain"))
    assert not list(before_the_run(from_dict(swaying(5.0, time_step=0.5, tolerance=1e-3)), "chain"))


def test_the_forcing_of_a_sea_is_that_of_the_waves_which_move_water():
    """Pierson-Moskowitz: the share of m2 above omega is erf(sqrt(5)/2 (peak/omega)^2), with u = omega^-2 in its integral."""
    sea = {"spectrum": "pierson-moskowitz", "significant_height": 3.0, "peak_period": 10.0, "components": 400}
    scene = from_dict({**WIRE, "water": {}, "waves": sea})
    peak = 0.2 * math.pi
    share = math.erf(math.sqrt(1.25) * (peak / forcing(scene)) ** 2)
    assert share == pytest.approx(0.05, abs=0.01)


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


def test_ends_above_the_water_are_told_where_the_surface_is_not_simulated():
    wet = from_dict({**WIRE, "water": {}})
    assert not list(at_the_start(wet, "chain", outputs(1.0, 1.0), 5.0))
    (text,) = at_the_start(wet, "tow", outputs(1.0, 1.0), 5.0)
    assert FORM.fullmatch(text)
    assert text.startswith("an end of the cable at z = 5 m, the water's surface at 0:")
    assert len(list(at_the_start(with_values(wet, {"water.surface": False}), "chain", outputs(1.0, 1.0), 5.0))) == 1
    assert not list(at_the_start(wet, "tow", outputs(1.0, 1.0), -0.1))


def test_a_strain_beyond_a_tenth_is_told():
    (text,) = at_the_start(from_dict(WIRE), "tow", outputs(0.0, 2e5))
    assert FORM.fullmatch(text)
    assert text.startswith("strain = 0.2 under 2e+05 N, beyond 0.1:")
    assert not list(at_the_start(from_dict(WIRE), "tow", outputs(0.0, 0.9e5)))


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


@pytest.mark.parametrize("name", [name for name in shipped() if "/" not in name])
def test_shipped_scenes_leave_no_doubt(name: str):
    scene = load(name)
    assert not list(before_the_run(scene, scene.run.model))


def test_the_shaken_chain_resolves_its_waves():
    model = CableChain(load("hanging_chain"))
    model.initialize([0.0] * 10)
    assert model.warnings() == ()
