"""One timed run of a scene at one setting, and its distance from a reference; which settings to try is not its business."""

from __future__ import annotations

import math
import time as clock
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from cable_model.driving import output_steps, pieces
from cable_model.errors import ParameterError, SolverError
from cable_model.models import MODELS
from cable_model.motion import motion_of
from cable_model.scene import Scene, with_values

SIGNALS = ("tension", "position")  # of the top, of the lower end


@dataclass(frozen=True)
class Setting:
    """A model and the values that differ from the scene's; settings of one `method` are a line of a picture."""

    method: str
    model: str
    changes: Mapping[str, object]

    @property
    def label(self) -> str:
        """What tells it from others of its method."""
        c = self.changes
        parts = [f"{c['solver.nodes']} nodes"] if "solver.nodes" in c else []
        if c.get("solver.tolerance"):
            parts.append(f"tolerance {c['solver.tolerance']:.0e}")
        elif "solver.time_step" in c:
            parts.append(f"step {c['solver.time_step']:.3g} s")
        return ", ".join(parts)


@dataclass(frozen=True)
class Timed:
    """Series of a run and the processor time of its steps; `error` says why it ended early, if it did."""

    times: np.ndarray
    tension: np.ndarray  # of the top, N
    position: np.ndarray  # (rows, 3) of the lower end seen from the top, m
    seconds: float
    error: str = ""


@dataclass(frozen=True)
class Scale:
    """What counts as everything: the dynamic part of each signal, its rms about the mean, or a thousandth of its size if that is more."""

    tension: float
    position: float

    @classmethod
    def of(cls, run: Timed) -> Scale:
        """The scales of a run, of the reference as a rule."""
        motion = math.sqrt(float(np.mean(np.sum((run.position - run.position.mean(axis=0)) ** 2, axis=1))))
        length = float(np.linalg.norm(run.position, axis=1).max())
        return cls(max(float(run.tension.std()), 1e-3 * float(np.abs(run.tension).max())), max(motion, 1e-3 * length))


def timed(scene: Scene, setting: Setting | None = None, repetitions: int = 1, longest: float = math.inf) -> Timed:
    """Run a scene at a setting; sampled at its output step, which no internal step exceeds.

    The processor time is the least of the repetitions, of the steps alone, without what the kernels' compilation takes.
    A run that fails, or takes more than `longest` s of it, returns what it reached.
    """
    model_name = setting.model if setting is not None else scene.run.model
    try:
        scene = with_values(scene, setting.changes) if setting is not None else scene
        model = MODELS[model_name](scene)
    except ParameterError as refused:
        return Timed(np.zeros(0), np.zeros(0), np.zeros((0, 3)), 0.0, str(refused))
    motion = motion_of(scene)
    outputs = output_steps(scene.run.duration, scene.run.output_step)
    tops = [list(pieces(motion, output, scene.solver.time_step)) for output in outputs]
    start = tops[0][0].first
    rows = np.zeros((len(outputs) + 1, len(model.outputs)))
    best, reached, error = math.inf, 0, ""
    for repetition in range(repetitions + 1):
        try:
            if repetition == 0:  # compiles
                model.initialize(start)
                model.advance(*tops[0][0])
                continue
            model.initialize(start)
            rows[0] = model.outputs
            reached = 0
            begun = clock.process_time()
            for k, top in enumerate(tops):
                for piece in top:
                    model.advance(*piece)
                rows[k + 1] = model.outputs
                reached = k + 1
                if clock.process_time() - begun > longest:
                    raise SolverError(f"given up at {outputs[k].end:.3g} s of simulated time: it takes more than {longest:.3g} s")
            best = min(best, clock.process_time() - begun)
        except (SolverError, ParameterError) as failure:
            error = str(failure)
            break
    kept = slice(0, reached + 1)
    at_top = np.array([start[:3], *(top[-1].last[:3] for top in tops)])
    times = np.array([0.0, *(output.end for output in outputs)])
    return Timed(times[kept], rows[kept, 3], rows[kept, 5:8] - at_top[kept], best, error)


def errors(run: Timed, reference: Timed, scale: Scale) -> dict[str, float]:
    """Rms difference over the dynamic rms of the reference, by signal; infinite where either did not reach the end."""
    if (
        run.error
        or reference.error
        or len(run.times) < 2
        or run.times[-1] < reference.times[-1] - (run.times[1] - run.times[0]) * (1.0 + 1e-9)
    ):
        return dict.fromkeys(SIGNALS, math.inf)
    rows = np.searchsorted(reference.times, run.times - 0.5 * (reference.times[1] - reference.times[0]))
    tension = math.sqrt(float(np.mean((run.tension - reference.tension[rows]) ** 2)))
    apart = math.sqrt(float(np.mean(np.sum((run.position - reference.position[rows]) ** 2, axis=1))))
    found = {"tension": tension / scale.tension, "position": apart / scale.position}
    return {name: value if math.isfinite(value) else math.inf for name, value in found.items()}


def worst(found: Mapping[str, float], signals: tuple[str, ...] = SIGNALS) -> float:
    return max(found[name] for name in signals)
