"""A cable between two ends that are both moved: scenes, motions and forces."""

import numpy as np
from chain_support import Motion, drive, every, still, swing

from cable_model import CableChain
from cable_model.signals import OUTPUTS

TOP, TOP_MEAN, LOW, LOW_MEAN = (
    [OUTPUTS.index(f"{end}.force{kind}_{axis}") for axis in "xyz"] for end in ("top", "lower") for kind in ("", "_mean")
)
OTHER_WAY_ROUND = ((TOP, LOW), (LOW, TOP), (TOP_MEAN, LOW_MEAN), (LOW_MEAN, TOP_MEAN))
DRIVEN = {"lower_end": {"anchored": True, "driven": True}}
LINE = {  # a tow line between two ships, hanging in a current
    "cable": {
        "length": 120.0, "diameter": 0.05, "mass_per_length": 4.0, "axial_stiffness": 4e6, "normal_drag_coefficient": 1.2,
        "tangential_drag_coefficient": 0.02, "added_mass_coefficient": 1.0,
    },
    "water": {"density": 1025.0, "surface": False},
    "current": {"speed": 0.4},
    "solver": {"nodes": 31, "time_step": 0.02, "grading": 1.0},
    **DRIVEN,
}  # fmt: skip
AIR = {
    "cable": {"length": 50.0, "mass_per_length": 1.5, "axial_stiffness": 2e5},
    "environment": {"gravity": 0.0},
    "solver": {"nodes": 26, "time_step": 0.02, "grading": 1.0, "slack_damping": 0.0},
    **DRIVEN,
}
FAR = (100.0, 0.0, -12.0)


def about(place: tuple[float, float, float], sway: tuple[float, float, float], omega: float) -> Motion:
    """An end that sways about a place."""
    motion, offset = swing(sway, omega, ramp_time=4.0), still(place)(0.0)
    return lambda t: offset + motion(t)


def inputs(top: Motion, low: Motion) -> Motion:
    """Inputs (19,), of which the winch's is 0, from the motions of both ends."""
    return lambda t: np.concatenate([top(t), [0.0], low(t)])


SWAYING = inputs(about((0.0, 0.0, -2.0), (0.5, 0.0, 0.3), 0.7), about(FAR, (0.7, 0.0, 0.4), 0.5))


def run(model: CableChain, motion: Motion, step: float, duration: float) -> np.ndarray:
    """Outputs, a row a step with the start first, where both ends follow their motions exactly."""
    series = drive(model, every(step, duration), motion)
    return np.column_stack([series[name] for name in OUTPUTS])
