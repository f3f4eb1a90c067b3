"""Batteries: what must hold for every scene that the table of effects allows, tried on random ones, a hundred a test.

`-m long` tries sixty times as many scenes.  Without object code for every scene there are none: numba would compile for each.
"""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import numba
import numpy as np
import pytest
from battery import UNITS, Run, in_other_units, is_calm, motion_of_ends, scenes, unit_factor
from hypothesis import HealthCheck, given, note, settings
from hypothesis import strategies as st

from cable_model.scene import Scene
from cable_model.signals import OUTPUTS
from cable_model.simulated import one_line
from fmu_src.native.object_code import can_export

EXAMPLES = int(os.environ.get("BATTERY_EXAMPLES", "100"))
pytestmark = pytest.mark.skipif(not (can_export() or numba.config.DISABLE_JIT), reason="kernels would be compiled for each scene")
battery = settings(
    max_examples=EXAMPLES, deadline=None, derandomize=EXAMPLES == 100, database=None, print_blob=False,
    suppress_health_check=list(HealthCheck),
)  # fmt: skip


def told(case: tuple[str, Scene]) -> tuple[str, Scene]:
    model, scene = case
    note(f"{model}: {one_line(scene, model)}")
    note(repr(scene))
    return case


def close(scene: Scene, found: np.ndarray, expected: np.ndarray, tolerance: float) -> None:
    """Rows of outputs agree within shares of the cable's dry weight, its length, and what it falls by its length."""
    length, gravity = scene.cable.length, scene.environment.gravity
    weight = (scene.cable.mass_per_length * length + scene.body.mass) * gravity
    scales = {"N": weight, "m": length, "m/s": np.sqrt(gravity * length), "rad": 1.0}
    judged = [k for k, (name, unit) in enumerate(zip(OUTPUTS, UNITS, strict=True)) if unit in scales or name == "cable.slack_fraction"]
    scale = np.array([scales.get(UNITS[k], 1.0) for k in judged])
    assert found.shape == expected.shape
    size = np.maximum(np.abs(expected[:, judged]) / scale, 1.0)
    off = np.abs(found - expected)[:, judged] / scale / size
    least, most = (expected[:, OUTPUTS.index(f"cable.tension_{name}")] for name in ("min", "max"))
    bears_nothing = (least <= 0.0) & (most >= 0.0)  # a straight cable's middle: whether it is slack is a matter of rounding
    off[bears_nothing, judged.index(OUTPUTS.index("cable.slack_fraction"))] = 0.0
    worst = off.max(axis=0)
    assert (worst <= tolerance).all(), dict(zip([OUTPUTS[k] for k in judged], worst.tolist(), strict=True))


@battery
@given(scenes(), st.tuples(*[st.integers(-3, 3)] * 3))
def test_units_are_a_matter_of_taste(case, powers):
    """Powers of two are exact: the same scene in other units gives the same numbers, so nothing in the kernels has a size of its own.

    But for a gravity below 1e-3 m/s2, which counts as none: these factors stay above it.
    """
    model, scene = told(case)
    factors = tuple(2.0**power for power in powers)
    other = in_other_units(scene, *factors)
    first = Run(model, scene).go(4)
    second = Run(model, other).go(4)
    assert len(first.rows) == len(second.rows), (first.failed, second.failed)
    if first.rows:
        close(scene, second.table / [unit_factor(unit, *factors) for unit in UNITS], first.table, 1e-9)
        assert np.array_equal(first.table[:, 15:18], second.table[:, 15:18])


@battery
@given(scenes(), st.integers(1, 5))
def test_a_saved_state_is_the_whole_state(case, when):
    model, scene = told(case)
    run = Run(model, scene).go(when)
    if run.failed:
        return
    state, rows, steps = run.model.state.copy(), len(run.rows), run.steps
    expected = run.go(3).table[rows:]
    fresh = Run(model, scene)
    fresh.model.state[:] = state
    fresh.rows, fresh.steps = [], steps
    found = fresh.go(3).table
    assert np.array_equal(found, expected)


@battery
@given(scenes())
def test_what_rests_goes_on_resting(case):
    """Statics and dynamics are of one mind: under a top that stays, in still or steadily flowing water, nothing moves."""
    model, scene = told(case)
    if not is_calm(scene):
        return
    still = motion_of_ends(scene)(0.0)
    run = Run(model, scene, lambda time: still).go(4)
    assert not run.failed or len(run.rows) == 0, run.failed
    if run.rows:
        close(scene, run.table, np.repeat(run.table[:1], len(run.rows), axis=0), 1e-6)


@battery
@given(scenes())
def test_what_hangs_freely_weighs_what_it_weighs(case):
    """In still water far from surface and bottom the top carries the weight less the buoyancy, whatever else is simulated."""
    model, scene = told(case)
    if not is_calm(scene) or scene.lower_end.anchored:
        return
    if scene.current.speed or scene.current.levels or scene.seabed.stiffness or not scene.tow.cable_mass or scene.tow.minimum_tension:
        return
    cable, body = scene.cable, scene.body
    density = scene.water.density if scene.water is not None else 0.0
    rows = cable.section or (cable,)
    weights = [(row.mass_per_length - density * row.displaced_area) * row.length for row in rows]
    weights += [one.mass - density * one.volume for one in (body, *cable.body)]
    weight = sum(weights) * scene.environment.gravity
    if min(weights) < 0.0 or weight == 0.0:
        return
    run = Run(model, scene, lambda time: np.array([0.0, 0.0, -2.0 * cable.length, *[0.0] * 7]))
    assert not run.failed
    force = run.table[0, :4]
    strain = weight / cable.axial_stiffness
    assert force == pytest.approx([0.0, 0.0, -weight, weight], rel=1e-9, abs=1e-9 * weight)
    assert -run.table[0, 7] - 2.0 * cable.length == pytest.approx(cable.length, rel=2e-3 + 2.0 * strain)


@pytest.mark.long
@pytest.mark.parametrize("name", [name for name, test in list(globals().items()) if hasattr(test, "hypothesis")])
def test_more_scenes(name: str):
    done = subprocess.run(
        [sys.executable, "-m", "pytest", "-q", "-x", "-p", "no:cacheprovider", f"{__file__}::{name}"],
        env={**os.environ, "BATTERY_EXAMPLES": str(60 * EXAMPLES)}, cwd=Path(__file__).parents[1],
        capture_output=True, text=True, check=False,
    )  # fmt: skip
    assert done.returncode == 0, done.stdout[-6000:]
