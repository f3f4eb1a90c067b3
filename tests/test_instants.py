"""A force that swings within a communication step is told, by what numba compiles and what is shipped; a smooth one is not."""

from __future__ import annotations

import math

import numpy as np
import pytest

from cable_model.cable_chain import CableChain
from cable_model.just_in_time import JustInTime
from cable_model.model import compiled
from cable_model.scene import Scene, from_dict
from cable_model.signals import OUTPUTS
from cable_model.tow_cable import TowCable

MASS, LENGTH, STIFFNESS, PER_LENGTH = 500.0, 20.0, 9.5e6, 0.68
BOUNCE = 2.0 * math.pi * math.sqrt((MASS + PER_LENGTH * LENGTH / 3.0) * LENGTH / STIFFNESS)  # of the body on its wire, in air
FORCE = OUTPUTS.index("top.force_z")
OMEGA = 2.0 * math.pi / 12.0


def hung(order: int, at_end: bool) -> Scene:
    return from_dict({
        "cable": {"length": LENGTH, "mass_per_length": PER_LENGTH, "axial_stiffness": STIFFNESS},
        "body": {"mass": MASS},
        "solver": {"nodes": 11, "time_step": 0.01},
        "top": {"motion_order": order, "inputs_at": int(at_end)},
    })  # fmt: skip


def heave(t: float) -> np.ndarray:
    """A swell of 0.5 m that grows over some seconds."""
    grown, rate = 1.0 - math.exp(-((t / 4.0) ** 2)), t / 8.0 * math.exp(-((t / 4.0) ** 2))
    inputs = np.zeros(10)
    inputs[2] = 0.5 * grown * math.sin(OMEGA * t)
    inputs[5] = 0.5 * (rate * math.sin(OMEGA * t) + grown * OMEGA * math.cos(OMEGA * t))
    return inputs


def run(model, step: float, at_end: bool) -> tuple[float, bool]:
    """Largest miss of the force over the force of inertia m omega^2 a that the heave asks for, and whether it was told to swing."""
    model.initialize(heave(0.0))
    misses = []
    for k in range(round(40.0 / step)):
        model.step(k * step, step, heave((k + at_end) * step))
        t = (k + 1) * step
        if t > 20.0:
            rigid = (MASS + PER_LENGTH * LENGTH) * (9.81 - 0.5 * OMEGA**2 * math.sin(OMEGA * t))
            misses.append(abs(-model.outputs[FORCE] - rigid))
    told = any("swings within a step" in text for text in model.warnings())
    return max(misses) / ((MASS + PER_LENGTH * LENGTH) * 0.5 * OMEGA**2), told


@pytest.mark.parametrize("kind", [CableChain, TowCable])
@pytest.mark.parametrize(
    ("share", "at_end", "wrong"),
    [(1.0, False, True), (2.0, False, True), (0.25, False, False), (0.5, True, False), (1.0, True, False)],
)
def test_kicks_in_time_with_the_bounce_of_the_body_are_told(kind, share, at_end, wrong):
    miss, told = run(kind(hung(1, at_end)), share * BOUNCE, at_end)
    assert told == wrong
    assert (miss > 1.0) == wrong


@pytest.mark.parametrize("kind", [CableChain, TowCable])
def test_next_to_no_force_is_not_told_to_swing(kind):
    """Neutral cable and body at rest: what is left is rounding."""
    area, density = 0.25 * math.pi * 0.01**2, 1025.0
    model = kind(from_dict({
        "cable": {"length": LENGTH, "diameter": 0.01, "mass_per_length": density * area, "axial_stiffness": STIFFNESS},
        "body": {"mass": MASS, "volume": MASS / density}, "water": {"density": density}, "solver": {"nodes": 11},
    }))  # fmt: skip
    model.initialize(np.zeros(10))
    for k in range(100):
        model.step(0.1 * k, 0.1, np.zeros(10))
    assert not any("swings" in text for text in model.warnings())


def test_what_numba_compiles_tells_the_same():
    ready, own = TowCable(hung(1, False)), TowCable(hung(1, False), compiled)
    assert isinstance(own._calls, JustInTime)
    assert run(ready, BOUNCE, False) == pytest.approx(run(own, BOUNCE, False), rel=1e-6)
    assert own.warnings() == ready.warnings() != ()
