"""What a step costs: microseconds per node and Newton iteration for each effect switched on alone, interleaved and compared.

Times are machine-dependent; the ratios to the bare chain are what to read.
"""

from __future__ import annotations

import statistics
import time
from dataclasses import dataclass

from cable_model.model import Model
from cable_model.models import MODELS
from cable_model.motion import top_motion
from cable_model.scene import Scene, from_dict, with_values

BARE = {
    "title": "forced chain",
    "cable": {"length": 1.75, "mass_per_length": 0.1, "axial_stiffness": 17167.5, "diameter": 0.005},
    "top": {"motion": [{"kind": "sinusoid", "axis": "x", "amplitude": 0.02, "angular_frequency": 6.5, "ramp_time": 1.0}]},
    "solver": {"nodes": 101, "time_step": 0.005},
    "run": {"duration": 2.0, "output_step": 0.1},
}
WATER = {"water.density": 1000.0, "cable.normal_drag_coefficient": 1.2, "cable.added_mass_coefficient": 1.0}
CASES: dict[str, dict[str, object]] = {
    "bare chain": {},
    "bare chain, absent effects named with 0": {
        "cable.bending_stiffness": 0.0,
        "cable.axial_damping": 0.0,
        "body.mass": 0.0,
        "waves.amplitude": 0.0,
    },
    "linear law instead of slack": {"cable.compressible": True},
    "bending": {"cable.bending_stiffness": 5e-6},
    "material damping": {"cable.axial_damping": 10.0},
    "body": {"body.mass": 0.1},
    "water": WATER,
    "water and current": {**WATER, "current.speed": 0.1},
    "water and waves": {**WATER, "waves.amplitude": 0.01, "waves.period": 1.0},
    "space": {"solver.space": True},
    "space and bending": {"solver.space": True, "cable.bending_stiffness": 5e-6},
    "box grid": {"solver.grid": "box"},
    "box grid and bending": {"solver.grid": "box", "cable.bending_stiffness": 5e-6},
}


@dataclass(frozen=True)
class Cost:
    """One case: medians over the repetitions."""

    name: str
    microseconds: float  # per node and Newton iteration
    iterations: float  # Newton iterations per step
    ratio: float  # of the time per node and iteration to the bare chain's, of the same repetition


def _scene(changes: dict[str, object]) -> Scene:
    return with_values(from_dict(BARE), changes)


def _seconds(model: Model, scene: Scene) -> float:
    motion = top_motion(scene.top)
    step = scene.run.output_step
    model.initialize(motion(0.0))
    moments = [(k * step, motion(k * step), motion((k + 1) * step, -1)) for k in range(round(scene.run.duration / step))]
    begun = time.perf_counter()
    for moment, start, end in moments:
        model.advance(moment, step, start, end)
    return time.perf_counter() - begun


def measure(names: list[str] | None = None, repetitions: int = 7) -> list[Cost]:
    """Time every case, all cases in turn in each repetition, so that a slow spell of the machine hits them alike."""
    names = names or list(CASES)
    scenes = {name: _scene(CASES[name]) for name in names}
    models = {name: MODELS["chain"](scene) for name, scene in scenes.items()}
    for name, model in models.items():  # compile
        _seconds(model, scenes[name])
    each: dict[str, list[float]] = {name: [] for name in names}
    for _ in range(repetitions):
        for name, model in models.items():
            seconds = _seconds(model, scenes[name])
            each[name].append(1e6 * seconds / (model.outputs[16] * scenes[name].solver.nodes))
    bare = each[names[0]]
    return [
        Cost(
            name,
            statistics.median(each[name]),
            float(models[name].outputs[16] / models[name].outputs[15]),
            statistics.median(x / y for x, y in zip(each[name], bare, strict=True)),
        )
        for name in names
    ]
