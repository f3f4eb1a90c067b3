"""What a step costs: microseconds per node and Newton iteration for each effect switched on alone, interleaved and compared.

Times are machine-dependent; the ratios to the bare chain are what to read.
"""

from __future__ import annotations

import statistics
import time
from dataclasses import dataclass

from cable_model.driving import output_steps, pieces
from cable_model.machine import machine
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
WATER: dict[str, object] = {"water.density": 1000.0, "cable.normal_drag_coefficient": 1.2, "cable.added_mass_coefficient": 1.0}
SEA = {"waves.spectrum": "jonswap", "waves.significant_height": 0.02, "waves.peak_period": 1.0, "waves.components": 20}
SEABED: dict[str, object] = {"seabed.level": -1.8, "seabed.stiffness": 1e6}
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
    "water and 20 waves": {**WATER, **SEA},
    "water and 60 waves": {**WATER, **SEA, "waves.components": 60},
    "water and 20 waves, finite depth": {**WATER, **SEA, "water.depth": 10.0},
    "water and 20 waves, stretched": {**WATER, **SEA, "waves.surface": "wheeler"},
    "water and 20 waves, cut": {**WATER, **SEA, "waves.surface": "cut"},
    "seabed": SEABED,
    "seabed and friction": {**SEABED, "seabed.friction_coefficient": 0.3},
    "winch": {"winch.fitted": True},
    "table of the axial stiffness": {"cable.stiffness_curve": [[0.0, 0.0], [0.01, 171.675], [0.1, 1716.75]]},
    "space": {"solver.space": True},
    "space and bending": {"solver.space": True, "cable.bending_stiffness": 5e-6},
    "box grid": {"solver.grid": "box"},
    "box grid and bending": {"solver.grid": "box", "cable.bending_stiffness": 5e-6},
}


@dataclass(frozen=True)
class Cost:
    """One case: medians over the repetitions."""

    name: str
    microseconds: float  # per node and internal step, outputs included
    iterations: float  # Newton iterations per step
    ratio: float  # of the time per node and step to the first case's, of the same repetition


def scene_of(changes: dict[str, object]) -> Scene:
    return with_values(from_dict(BARE), changes)


def _seconds(model: Model, scene: Scene) -> float:
    motion = top_motion(scene.top)
    model.initialize(motion(0.0))
    outputs = output_steps(scene.run.duration, scene.run.output_step)
    moments = [piece for output in outputs for piece in pieces(motion, output, scene.solver.time_step)]
    begun = time.perf_counter()
    for piece in moments:
        model.advance(*piece)
    return time.perf_counter() - begun


def measure(names: list[str] | None = None, repetitions: int = 7) -> list[Cost]:
    """Time every case, all cases in turn in each repetition, so that a slow spell of the machine hits them alike."""
    names = names or list(CASES)
    scenes = {name: scene_of(CASES[name]) for name in names}
    models = {name: MODELS["chain"](scene) for name, scene in scenes.items()}
    for name, model in models.items():  # compile
        _seconds(model, scenes[name])
    each: dict[str, list[float]] = {name: [] for name in names}
    for _ in range(repetitions):
        for name, model in models.items():
            seconds = _seconds(model, scenes[name])
            each[name].append(1e6 * seconds / (model.outputs[15] * scenes[name].solver.nodes))
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


def markdown(costs: list[Cost], proof: str = "") -> str:
    """The costs as a table, with what they were measured on; `proof` is a paragraph below it."""
    lines = [
        "# What each effect costs",
        "",
        "Written by `python -m cable_model bench --absent -o docs/cost_of_effects.md`: forced chain of 101 nodes, each effect alone;",
        "medians of interleaved repetitions.  Read the ratios: microseconds are those of one machine,",
        f"{machine()}.",
        "",
        "Where a step takes more than one iteration, part of the ratio is the motion's, not the effect's: the drag of still water bends",
        "sharply wherever the cable's velocity changes its sign, which it does not in a current faster than the motion.",
        "",
        "| effects | us per node and step | iterations per step | ratio to the bare chain |",
        "|---|---:|---:|---:|",
    ]
    lines += [f"| {c.name} | {c.microseconds:.3f} | {c.iterations:.2f} | {c.ratio:.2f} |" for c in costs]
    lines += ["", proof] if proof else []
    return "\n".join(lines) + "\n"
