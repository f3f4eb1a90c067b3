"""The chain let go from a small sideways pull at its tip, against its modes [Gobat 2002, figures 3-5]."""

import numpy as np
import pytest
from chain_support import drive, every, make, still

from cable_model.lab.published.modes import beam_series

FREE = {  # the shipped scene `free_chain`: m = g = L = 1, tip force 0.001 N
    "cable": {"length": 1.0, "mass_per_length": 1.0, "axial_stiffness": 1e9},
    "environment": {"gravity": 1.0},
    "lower_end": {"release_force": 0.001},
    "solver": {"nodes": 101, "time_step": 0.01},
}
TIMES = every(0.05, 30.0)


def tip(**changes: object) -> np.ndarray:
    return drive(make(FREE, **changes), TIMES, still())["body.x"]


def miss(found: np.ndarray, expected: np.ndarray) -> float:
    return float(np.sqrt(np.mean((found - expected) ** 2) / np.mean(expected**2)))


def test_a_stiff_chain_without_bending_finds_its_catenary():
    model = make(FREE)
    model.initialize(still()(0.0))
    assert model.outputs[5] == pytest.approx(0.001 * np.arcsinh(1000.0), rel=0.01)


def test_release_with_bending_follows_the_modes_of_the_heavy_beam_within_one_percent():
    expected = beam_series(160, 1e-6).tip(TIMES)
    assert miss(tip(cable__bending_stiffness=1e-6, solver__time_step=0.0025), expected) < 0.01
