"""Scenes in water that changes, and what moves in them."""

import math

import numpy as np
import pytest
from chain_support import Motion, still

from cable_model import CableChain, TowCable

LINE = {  # a wire with a sphere, all of it deep
    "cable": {
        "length": 60.0, "diameter": 0.02, "mass_per_length": 1.5, "axial_stiffness": 4e6, "normal_drag_coefficient": 1.2,
        "tangential_drag_coefficient": 0.02, "added_mass_coefficient": 1.0,
    },
    "body": {"mass": 400.0, "volume": 0.1, "drag_area": 0.4, "added_mass": 50.0},
    "water": {"density": 1025.0},
    "top": {"position": [0.0, 0.0, -20.0], "motion_order": 2},
    "solver": {"nodes": 21, "time_step": 0.02},
}  # fmt: skip
BY_INPUT = {"water__current_input": True}
DEEP = still((0.0, 0.0, -20.0))
BOTH = pytest.mark.parametrize("model", [CableChain, TowCable])
WAY = [  # model, and what makes it another grid or dimension; numba compiles the box grid for each set of parts: in the long run
    pytest.param("chain", {}, id="staggered"),
    pytest.param("chain", {"solver__grid": "box"}, id="box", marks=pytest.mark.long),
    pytest.param("chain", {"solver__space": True}, id="chain in space"),
    pytest.param("tow", {}, id="tow"),
    pytest.param("tow", {"solver__space": True}, id="tow in space"),
]


def stream(motion: Motion, current):
    """All inputs, from the motion of the top and the current (x, y) at a time."""
    return lambda t: np.concatenate([motion(t), np.zeros(10), current(t)])


def changing(t):
    return [0.6 * math.sin(0.9 * t) + 0.2 * t, 0.0]
