"""A flexible jumper whose top is moved, in surge, sway and heave through the surface, and in waves: against a published calculation.

Source: Lowe and Langley, OMAE 2006: end forces at rest, and the total force at the top, whose smallest and largest values are those of the
series that MoorDyn's tests hold (digitised there from the paper's figures).  The phases of the waves are not published with them.
"""

import numpy as np
import pytest
from chain_support import make

from cable_model.simulation import simulate

pytestmark = pytest.mark.shipped

JUMPER = {  # 170 m between an anchor and a top that is 5 m below the surface
    "cable": {
        "length": 170.0, "mass_per_length": 165.0, "axial_stiffness": 5e8, "diameter": 0.396, "bending_stiffness": 120.8e3,
        "normal_drag_coefficient": 1.0, "added_mass_coefficient": 1.0,
    },
    "lower_end": {"anchored": True, "x": -100.0, "z": -55.0},
    "environment": {"gravity": 9.807},
    "water": {"density": 1000.0},
    "top": {"position": [0.0, 0.0, -5.0]},
    "solver": {"nodes": 51, "time_step": 0.05},
}  # fmt: skip
MOTIONS = {"x": (41.48, 52.24), "y": (44.29, 49.12), "z": (36.78, 57.78)}  # axis: least and largest force at the top, kN
WAVES = {0: (42.01, 53.15), 45: (41.09, 53.32), 90: (40.05, 52.73)}  # degrees from the jumper's plane, likewise


def force(run: dict, start: float) -> np.ndarray:
    """Force at the top from a time on, kN."""
    late = run["time"] >= start
    return 1e-3 * np.sqrt(sum(run[f"top.force_{axis}"][late] ** 2 for axis in "xyz"))


def test_the_jumper_hangs_at_rest_as_published():
    run = simulate(make(JUMPER, run__duration=0.05))
    assert run["top.force_x"][0] == pytest.approx(-11400.0, abs=10.0)
    assert run["top.force_z"][0] == pytest.approx(-45710.0, abs=10.0)
    submerged = (165.0 - 1000.0 * np.pi / 4.0 * 0.396**2) * 9.807 * 170.0
    assert submerged + run["top.force_z"][0] == pytest.approx(24040.0, abs=50.0)  # what the anchor carries


@pytest.mark.parametrize("axis", [pytest.param("x", marks=pytest.mark.long), pytest.param("y", marks=pytest.mark.long), "z"])
def test_force_of_the_moved_jumper_is_the_published_one(axis):
    # 10 m at 27 s: in heave the top comes 5 m out of the water
    motion = {"kind": "sinusoid", "axis": axis, "amplitude": 10.0, "angular_frequency": 2.0 * np.pi / 27.0, "ramp_time": 27.0}
    run = simulate(make(JUMPER, top__motion=[motion], solver__space=axis == "y", run__duration=108.0))
    found = force(run, 54.0)
    assert (found.min(), found.max()) == pytest.approx(MOTIONS[axis], abs=0.5)  # half a kN: what reading a figure costs


@pytest.mark.parametrize("angle", [0, pytest.param(45, marks=pytest.mark.long), pytest.param(90, marks=pytest.mark.long)])
def test_force_of_the_jumper_in_waves_is_the_published_one(angle):
    waves = {"amplitude": 5.0, "period": 10.0, "direction": np.radians(angle)}
    run = simulate(make({**JUMPER, "waves": waves}, solver__space=angle > 0, run__duration=50.0))
    found = force(run, 20.0)
    assert (found.min(), found.max()) == pytest.approx(WAVES[angle], abs=0.5)
