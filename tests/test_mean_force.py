"""top.force_mean: the impulse of the cable's force on its attachment, by the balance of momentum and by the force itself."""

from __future__ import annotations

from collections.abc import Callable

import numba
import numpy as np
import pytest
from chain_support import HANGING, SECOND_MODE, SHORT_BENDING, WIRE, Motion, kinetic_matrix, make, swing, view
from test_chain_seabed import MOORING
from test_communication_steps import TAUT, at_the_end_of_the_wire, random_steps
from tow_reference import DRY, NUMBERS, WET, circling, tow

from cable_model import CableChain, simulate
from cable_model.model import Model
from cable_model.scene import from_dict
from cable_model.signals import OUTPUTS

SLOW = bool(numba.config.DISABLE_JIT)
FORCE = slice(0, 3)
MEAN = slice(OUTPUTS.index("top.force_mean_x"), OUTPUTS.index("top.force_mean_z") + 1)
GRAVITY = 9.81
SWUNG = swing((0.05, 0.0, 0.02), 5.0, phase=(0.0, 0.0, 1.0))
CIRCLED = swing((0.05, 0.04, 0.02), 5.0, phase=(0.0, 1.5, 1.0))
TOWED = circling(0.5, 0.9, 2.0)


def momentum_of_nodes(model: CableChain) -> np.ndarray:
    """Of a staggered chain without a body, (3,)."""
    now, mass = view(model), model.scene.cable.mass_per_length
    v = now.y[now.mesh.shape[0] + 1 :]
    found = mass * (kinetic_matrix(now.mesh[:, 0], now.mesh[:, 1]) @ v).sum(axis=0)
    return found if len(found) == 3 else np.array([found[0], 0.0, found[1]])


def momentum_of_cells(model: CableChain) -> np.ndarray:
    """Of a chain on the box grid, by the trapezoidal rule."""
    now, mass = view(model), model.scene.cable.mass_per_length
    u, v, phi = now.y[:, 1:4].T
    node = np.array([u * np.sin(phi) + v * np.cos(phi), 0.0 * u, u * np.cos(phi) - v * np.sin(phi)])
    return mass * (0.5 * (node[:, 1:] + node[:, :-1]) @ now.mesh[:, 0])


def momentum_of_the_line(model: Model) -> np.ndarray:
    """Of the straight cable and the body of the tow model, in air."""
    top, body = model.state[9:12], model.outputs[8:11]
    return NUMBERS["cable.mass_per_length"] * NUMBERS["cable.length"] * 0.5 * (top + body) + NUMBERS["body.mass"] * body


HUNG = 0.1 * 1.75 * GRAVITY
TOW_WEIGHT = GRAVITY * (NUMBERS["cable.mass_per_length"] * NUMBERS["cable.length"] + NUMBERS["body.mass"])
FREE: dict[str, tuple[Callable[[], Model], Callable, Motion, float, float, float]] = {  # and weight, communication step, error over W
    "staggered": (lambda: make(HANGING), momentum_of_nodes, SWUNG, HUNG, 0.04, 1e-4),
    "bent, in space": (
        lambda: make(HANGING, cable__bending_stiffness=SHORT_BENDING, solver__space=True), momentum_of_nodes, CIRCLED, HUNG, 0.04, 1e-4
    ),
    "box": (lambda: make(HANGING, solver__grid="box"), momentum_of_cells, SWUNG, HUNG, 0.04, 1e-4),
    "tow": (lambda: tow(DRY), momentum_of_the_line, TOWED, TOW_WEIGHT, 0.2, 1e-7),
    "tow, explicit": (
        lambda: tow(DRY, solver__tolerance=1e-6, tow__explicit=1.0), momentum_of_the_line, TOWED, TOW_WEIGHT, 0.2, 1e-6
    ),
    "tow, in space": (lambda: tow(DRY._replace(space=True)), momentum_of_the_line, TOWED, TOW_WEIGHT, 0.2, 1e-7),
}  # fmt: skip


@pytest.mark.parametrize("kind", FREE)
def test_the_impulse_is_the_change_of_momentum_less_that_of_the_weight(kind):
    """Over one communication step of four internal ones, and of as many as the tow model takes."""
    made, momentum, motion, weight, step, error = FREE[kind]
    model = made()
    model.initialize(motion(0.0))
    before = momentum(model)
    moved = 0.0
    for k in range(5 if SLOW else 25):
        model.advance(k * step, step, motion(k * step), motion((k + 1) * step))
        after = momentum(model)
        balance = before - after - np.array([0.0, 0.0, weight * step])
        assert model.outputs[MEAN] * step == pytest.approx(balance, abs=error * weight * step), k
        moved = max(moved, float(np.abs(after - before).max()))
        before = after
    assert moved > 20.0 * error * weight * step


@pytest.mark.parametrize("kind", ["staggered", "box", "tow"])
def test_slivers_lose_no_impulse_and_make_no_peaks(kind):
    """Time that waits is told ahead, and what that was off by afterwards, over no less than an internal step."""
    made, momentum, motion, weight, _, error = FREE[kind]
    model = made()
    model.initialize(motion(0.0))
    start, time, told, forces, means = momentum(model), 0.0, np.zeros(3), [], []
    longest = 0.01 if kind != "tow" else 0.05
    regular = [longest] * 20
    steps = [*regular, *[1e-9] * 5, *[0.3 * longest] * 20, *random_steps(longest, (5 if SLOW else 50) * longest, 5.0), *regular]
    for span in steps:
        model.advance(time, span, motion(time), motion(time + span))
        time += span
        told += span * model.outputs[MEAN]
        forces.append(model.outputs[FORCE].copy())
        means.append(model.outputs[MEAN].copy())
    balance = start - momentum(model) - np.array([0.0, 0.0, weight * time])
    assert told == pytest.approx(balance, abs=error * weight * time)
    room = np.ptp(forces, axis=0) + 1e-3 * weight
    assert (np.array(means) > np.min(forces, axis=0) - 0.5 * room).all()
    assert (np.array(means) < np.max(forces, axis=0) + 0.5 * room).all()


def winding(time: float) -> np.ndarray:
    return np.array([*swing((0.3, 0.0, 0.2), 1.5)(time), 0.2 * min(time, 1.0)])


SCENES: dict[str, tuple[Callable[[], Model], Motion, float, int]] = {  # and the communication step, and its internal ones
    "anchored": (lambda: make(TAUT), at_the_end_of_the_wire(swing((0.0, 0.0, 0.01), 8.0, ramp_time=0.5)), 0.04, 4),
    "wire in water, winch": (lambda: make(WIRE, winch__fitted=True, solver__time_step=0.02), winding, 0.08, 4),
    "seabed": (lambda: make(MOORING), swing((0.3, 0.0, 0.3), 1.5), 0.04, 4),
    "box": (lambda: make(HANGING, solver__grid="box"), swing((0.02, 0.0, 0.0), SECOND_MODE), 0.04, 4),
    "tow in water": (lambda: tow(WET), TOWED, 0.2, 40),
}  # fmt: skip


def elsewhere(motion: Motion, model: Model) -> Motion:
    """About where the scene has its top."""
    place = model.scene.top.position if hasattr(model, "scene") else (0.0, 0.0, 0.0)
    if np.allclose(motion(0.0)[:3], place):
        return motion
    return lambda time: motion(time) + np.concatenate([place, np.zeros(len(motion(0.0)) - 3)])


@pytest.mark.parametrize("kind", SCENES)
def test_the_mean_is_that_of_the_force(kind):
    """By Simpson's rule over the forces at the ends of internal steps, which are communication steps of another run."""
    made, motion, step, internal = SCENES[kind]
    model = made()
    motion = elsewhere(motion, model)
    model.initialize(motion(0.0))
    small = step / internal
    weights = np.array([1.0, *[4.0, 2.0] * (internal // 2 - 1), 4.0, 1.0]) / (3.0 * internal)
    forces = [model.outputs[FORCE].copy()]
    count = 10 if SLOW else 50
    for k in range(count * internal):
        model.advance(k * small, small, motion(k * small), motion((k + 1) * small))
        forces.append(model.outputs[FORCE].copy())
    size = np.ptp(forces, axis=0).max()
    model.initialize(motion(0.0))
    assert np.array_equal(model.outputs[MEAN], model.outputs[FORCE])
    for k in range(count):
        model.advance(k * step, step, motion(k * step), motion((k + 1) * step))
        expected = weights @ np.array(forces[k * internal : (k + 1) * internal + 1])
        assert model.outputs[MEAN] == pytest.approx(expected, abs=0.02 * size), k


def test_a_run_tells_the_mean_over_its_output_steps():
    """Where an output step is followed in pieces too: here the top sets off with a jerk in the middle of one."""
    base = {**HANGING, "run": {"duration": 0.4, "output_step": 0.2}}
    parts = [{"kind": "ramp", "axis": "x", "velocity": 0.1, "start": 0.1, "duration": 0.05}]
    model = CableChain(from_dict({**base, "top": {"motion": parts}}))
    result = simulate(model)
    fine = simulate(model, output_step=0.01)
    for name in ("x", "z"):
        means = fine[f"top.force_mean_{name}"][1:].reshape(2, 20).mean(axis=1)
        assert result[f"top.force_mean_{name}"][1:] == pytest.approx(means, abs=1e-3 * HUNG)
        assert result[f"top.force_mean_{name}"][0] == result[f"top.force_{name}"][0]
