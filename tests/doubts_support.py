"""A cable whose top is moved in some way, and what a run of it leaves doubtful."""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Mapping
from typing import Any

import numpy as np

from cable_model import TowCable
from cable_model.doubts import before_the_run
from cable_model.model import Model
from cable_model.scene import Scene, from_dict, with_values

WIRE = {"cable": {"length": 100.0, "mass_per_length": 1.0, "axial_stiffness": 1e6, "diameter": 0.01}}
FORM = re.compile(r"[^:]+ [^:]*\d[^:]*: .+\. (Give|Set|Check) .+\.")

OMEGA = 0.4 * math.pi
POSITION, VELOCITY, ACCELERATION = (np.repeat(np.arange(4) == k, [3, 3, 3, 1]) for k in range(3))
Inputs = Callable[[float], np.ndarray]


def heaving(amplitude: float, values: Mapping[str, object] | None = None, order: int = 1) -> tuple[Scene, Inputs]:
    """A scene, and inputs of a top that heaves by sin(OMEGA t)."""
    scene = with_values(from_dict(WIRE), {"body.mass": 50.0, "top.motion_order": order, "solver.nodes": 6, **(values or {})})

    def inputs(time: float) -> np.ndarray:
        sine, cosine = amplitude * math.sin(OMEGA * time), amplitude * math.cos(OMEGA * time)
        return np.array([0.0, 0.0, sine, 0.0, 0.0, OMEGA * cosine, 0.0, 0.0, -(OMEGA**2) * sine, 0.0])

    return scene, inputs


def moved(inputs: Inputs, x: float = 0.0, z: float = 0.0, since: float = -1.0) -> Inputs:
    """The same inputs, from a time on with the top elsewhere."""
    offset = np.array([x, 0.0, z, *[0.0] * 7])
    return lambda time: inputs(time) + offset * (time > since)


def times(inputs: Inputs, factors: np.ndarray) -> Inputs:
    return lambda time: inputs(time) * factors


def all_told(scene: Scene, inputs: Inputs, step: float = 0.1, steps: int = 30, kind: type[Model] = TowCable) -> list[str]:
    """What a run under inputs at the starts, or by top.inputs_at the ends, of steps leaves doubtful; no more than once each."""
    model = kind(scene)
    model.initialize(inputs(0.0))
    for k in range(steps):
        model.step(k * step, step, inputs((k + scene.top.inputs_at) * step))
    before = {*before_the_run(scene)}
    texts = [text for text in model.warnings() if text not in before]
    assert all(FORM.fullmatch(text) for text in texts)
    return texts


def told(*run: Any, **how: Any) -> list[str]:
    """The same but for a straight cable that pushes, as after a sudden start."""
    return [text for text in all_told(*run, **how) if not text.startswith("tension = ")]
