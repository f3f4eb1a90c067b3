"""A run of the chain that is given up when it takes too many steps: members of the family that do not damp can cut theirs without end."""

from __future__ import annotations

import math

import numpy as np

from cable_model.cable_chain import CableChain
from cable_model.driving import follow, output_steps
from cable_model.errors import SolverError
from cable_model.motion import motion_of
from cable_model.scene import Scene
from cable_model.signals import OUTPUTS
from cable_model.studies.timed import Timed

STEPS = OUTPUTS.index("solver.steps")


def run(scene: Scene, most_steps: float = math.inf) -> tuple[Timed, np.ndarray]:
    """Series at every output step, and the last outputs; its `error` says why it ended early, if it did."""
    model, motion = CableChain(scene), motion_of(scene)
    outputs = output_steps(scene.run.duration, scene.run.output_step)
    times = np.array([0.0, *(output.end for output in outputs)])
    rows = np.zeros((len(times), len(OUTPUTS)))
    tops = np.array([motion(time)[:3] for time in times])
    why, reached = "", 0
    model.initialize(motion(0.0))
    rows[0] = model.outputs
    for k, output in enumerate(outputs):
        try:
            follow(model.advance, motion, output, scene.solver.time_step)
        except SolverError as failure:
            why = str(failure)
            break
        reached = k + 1
        rows[reached] = model.outputs
        if model.outputs[STEPS] > most_steps:
            why = f"more than {most_steps:g} steps"
            break
    kept = slice(0, reached + 1)
    return Timed(times[kept], rows[kept, 3], (rows[:, 5:8] - tops)[kept], 0.0, why), rows[reached]
