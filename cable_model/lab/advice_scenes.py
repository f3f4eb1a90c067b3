"""The ten scenes on which the adviser is tried: shipped ones with other bodies, lengths, motion and seas; short, and none chaotic."""

from __future__ import annotations

import math
from collections.abc import Mapping

from cable_model.scene import Scene, load, with_values


def _sinusoid(axis: str, amplitude: float, period: float, phase: float = 0.0, ramp_time: float = 0.0) -> dict[str, object]:
    return {
        "kind": "sinusoid", "axis": axis, "amplitude": amplitude, "angular_frequency": 2.0 * math.pi / period, "phase": phase,
        "ramp_time": ramp_time or 2.0 * period,
    }  # fmt: skip


SCENES: Mapping[str, tuple[str, Mapping[str, object]]] = {
    "light sphere in waves": ("dale_sphere", {
        "waves.amplitude": 0.03, "waves.period": 2.0, "top.motion": [_sinusoid("x", 0.05, 3.1), _sinusoid("z", 0.05, 3.1, 1.0)],
        "run.duration": 30.0,
    }),
    "heavy sphere, slow": ("dale_sphere", {
        "body.mass": 0.1, "body.volume": 1.5e-5, "top.motion": [_sinusoid("x", 0.1, 9.0), _sinusoid("z", 0.04, 9.0, 0.7)],
        "run.duration": 45.0,
    }),
    "steel wire, heaving body": ("hard/snap", {
        "cable.length": 500.0, "body.mass": 2000.0, "body.volume": 0.6, "top.motion": [_sinusoid("z", 0.8, 7.0)], "run.duration": 42.0,
    }),
    "towed body in a current": ("towed_body", {
        "cable.length": 120.0, "current.speed": -1.5, "top.motion": [_sinusoid("x", 0.3, 6.0), _sinusoid("z", 0.6, 6.0, 1.0)],
        "run.duration": 48.0,
    }),
    "free chain above its second mode": ("hanging_chain", {
        "top.motion": [_sinusoid("x", 0.01, 0.75)], "run.duration": 7.5,
    }),
    "stiff chain below its first mode": ("hanging_chain", {
        "cable.bending_stiffness": 0.02, "top.motion": [_sinusoid("x", 0.06, 3.2)], "run.duration": 9.6,
    }),
    "mooring chain on a seabed": ("basin_chain", {
        "top.motion": [_sinusoid("x", 0.08, 2.2, 0.5 * math.pi, 5.0), _sinusoid("z", 0.1, 2.2, math.pi, 5.0)], "run.duration": 12.6,
    }),
    "bungee with a body": ("hard/bungee", {
        "lower_end.anchored": False, "lower_end.released": False, "lower_end.z": 0.0, "cable.axial_stiffness": 600.0, "body.mass": 8.0,
        "top.motion": [_sinusoid("z", 0.4, 5.0)], "run.duration": 25.0,
    }),
    "irregular sea on a wire": ("hard/three_hours", {
        "cable.length": 200.0, "waves.significant_height": 2.0, "waves.peak_period": 8.0, "waves.seed": 11, "run.duration": 60.0,
        "run.output_step": 0.1,
    }),
    "tow across a current, in space": ("towed_body", {
        "cable.length": 150.0, "cable.bending_stiffness": 0.0, "solver.space": True, "current.speed": 1.0, "current.direction": 2.5,
        "top.motion": [_sinusoid("x", 1.0, 12.0), _sinusoid("y", 1.5, 12.0, 0.5 * math.pi), _sinusoid("z", 0.5, 7.0)],
        "run.duration": 60.0,
    }),
}  # fmt: skip


def scene(name: str) -> Scene:
    """A scene of the trial by its name."""
    shipped, changes = SCENES[name]
    return with_values(load(shipped), {**changes})
