"""What a fixed-step run of the chain will cost, in steps of one node: to order what is tried, and to expect what finer runs cost."""

from __future__ import annotations

import math

from cable_model.scene import Scene, with_values
from cable_model.studies.timed import Setting

CALL = 150.0  # a call from Python and its outputs, measured: some 25 us, where a step of one node takes 0.16 us
STEP = 10.0  # what a step costs whatever the number of nodes


def work(scene: Scene, setting: Setting) -> float:
    """Of the steps of a run alone, in steps of one node."""
    changed = with_values(scene, setting.changes)
    every = scene.run.output_step
    return scene.run.duration / every * math.ceil(every / changed.solver.time_step - 1e-9) * (STEP + changed.solver.nodes)


def expected(scene: Scene, setting: Setting) -> float:
    """Cost of a run, in steps of one node on smooth motion; comparable between settings of one scene only."""
    return scene.run.duration / scene.run.output_step * CALL + work(scene, setting)
