"""What a step costs: microseconds per node and Newton iteration for each effect switched on alone, interleaved and compared.

Times are machine-dependent; the ratios to the bare chain are what to read.
"""

from __future__ import annotations

import math
import statistics
import time
from dataclasses import dataclass

from cable_model import ready
from cable_model.driving import output_steps, pieces
from cable_model.effects import COST_CASES
from cable_model.machine import machine
from cable_model.model import Model, compiled
from cable_model.models import MODELS
from cable_model.motion import motion_of
from cable_model.scene import Scene, from_dict, with_values

BARE = {
    "title": "forced chain",
    "cable": {"length": 1.75, "mass_per_length": 0.1, "axial_stiffness": 17167.5, "diameter": 0.005},
    "top": {"motion": [{"kind": "sinusoid", "axis": "x", "amplitude": 0.02, "angular_frequency": 6.5, "ramp_time": 1.0}]},
    "solver": {"nodes": 101, "time_step": 0.005},
    "run": {"duration": 2.0, "output_step": 0.1},
}
NAMED_WITH_0 = ("cable.bending_stiffness", "cable.axial_damping", "body.mass", "waves.amplitude")
CASES: dict[str, dict[str, object]] = {
    "bare chain": {},
    "bare chain, absent effects named with 0": dict.fromkeys(NAMED_WITH_0, 0.0),
    **COST_CASES,
    "space and bending": {**COST_CASES["space"], **COST_CASES["bending"]},
    "box grid and bending": {**COST_CASES["box grid"], **COST_CASES["bending"]},
}


@dataclass(frozen=True)
class Cost:
    """One case: medians over the repetitions."""

    name: str
    microseconds: float  # per node and internal step, outputs included
    iterations: float  # Newton iterations per step
    ratio: float  # of the time per node and step to the first case's, of the same repetition
    every: float  # of the time by object code for every scene to that by kernels for this one, of the same repetition; NaN: serves it not


def scene_of(changes: dict[str, object]) -> Scene:
    return with_values(from_dict(BARE), changes)


def _seconds(model: Model, scene: Scene) -> float:
    motion = motion_of(scene)
    model.initialize(motion(0.0))
    outputs = output_steps(scene.run.duration, scene.run.output_step)
    moments = [piece for output in outputs for piece in pieces(motion, output, scene.solver.time_step)]
    begun = time.perf_counter()
    for piece in moments:
        model.advance(*piece)
    return time.perf_counter() - begun


def served(scene: Scene) -> bool:
    """Whether object code for every scene lies ready here, and serves this one."""
    return ready.calls(MODELS["chain"](scene, compiled)) is not None


def ratio(value: float) -> str:
    """As tables show it."""
    return "-" if math.isnan(value) else f"{value:.2f}"


def measure(names: list[str] | None = None, repetitions: int = 7) -> list[Cost]:
    """Time every case, all cases in turn in each repetition, so that a slow spell of the machine hits them alike."""
    names = names or list(CASES)
    scenes = {name: scene_of(CASES[name]) for name in names}
    models = {name: MODELS["chain"](scene, compiled) for name, scene in scenes.items()}
    for name, model in models.items():  # compile
        _seconds(model, scenes[name])
    each: dict[str, list[float]] = {name: [] for name in names}
    by_every: dict[str, list[float]] = {name: [] for name in names}
    every = {name: MODELS["chain"](scene) for name, scene in scenes.items() if served(scene)}
    for _ in range(repetitions):
        for name, model in models.items():
            seconds = _seconds(model, scenes[name])
            each[name].append(1e6 * seconds / (model.outputs[15] * scenes[name].solver.nodes))
            by_every[name].append(_seconds(every[name], scenes[name]) / seconds if name in every else math.nan)
    bare = each[names[0]]
    return [
        Cost(
            name,
            statistics.median(each[name]),
            float(models[name].outputs[16] / models[name].outputs[15]),
            statistics.median(x / y for x, y in zip(each[name], bare, strict=True)),
            statistics.median(by_every[name]),
        )
        for name in names
    ]


def markdown(costs: list[Cost], proof: str = "") -> str:
    """The costs as a table, with what they were measured on; `proof` is a paragraph below it."""
    lines = [
        "# What each effect costs",
        "",
        "Written by `python -m cable_model.lab bench --absent -o docs/cost_of_effects.md`: forced chain of 101 nodes, each effect alone;",
        "medians of interleaved repetitions.  Read the ratios: microseconds are those of one machine,",
        f"{machine()}.",
        "",
        "Where a step takes more than one iteration, part of the ratio is the motion's, not the effect's: the drag of still water bends",
        "sharply wherever the cable's velocity changes its sign, which it does not in a current faster than the motion.",
        "",
        "These are kernels that numba compiles for exactly the effects of a scene.  The last column is the time of the object code for",
        "every scene, on which runs start, over theirs.",
        "",
        "| effects | us per node and step | iterations per step | ratio to the bare chain | object code for every scene |",
        "|---|---:|---:|---:|---:|",
    ]
    lines += [f"| {c.name} | {c.microseconds:.3f} | {c.iterations:.2f} | {c.ratio:.2f} | {ratio(c.every)} |" for c in costs]
    lines += ["", proof] if proof else []
    return "\n".join(lines) + "\n"
