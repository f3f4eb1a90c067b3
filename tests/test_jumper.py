"""A flexible jumper whose top is moved, in surge, sway and heave through the surface, and in waves: against a published calculation.

Source: Lowe and Langley, OMAE 2006: end forces at rest, and series of the total force at the top, digitised from the paper's figures for
MoorDyn's tests, of which the least and largest value are held here and those at the quarters of a motion.  The waves' phases are not known.
"""

import numpy as np
import pytest
from chain_support import make

from cable_model.simulation import simulate

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
PERIOD = 27.0  # s, of the motions
MOTIONS = {  # axis: force at the top in kN, least and largest, and at 10 m sin(0), sin(90), sin(180), sin(270 degrees)
    "x": ((41.48, 52.24), (49.95, 41.76, 47.02, 48.60)),
    "y": ((44.29, 49.12), (48.27, 45.49, 48.34, 45.46)),
    "z": ((36.78, 57.78), (55.86, 43.91, 39.27, 55.48)),
}
WAVES = {0: (42.01, 53.15), 45: (41.09, 53.32), 90: (40.05, 52.73)}  # degrees from the jumper's plane: least and largest force, kN
READING = 0.5  # kN: what reading a figure costs


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


@pytest.mark.parametrize("axis", MOTIONS)
def test_force_of_the_moved_jumper_is_the_published_one(axis):
    # in heave the top comes 5 m out of the water: in water up there its force would be 6 kN less
    motion = {"kind": "sinusoid", "axis": axis, "amplitude": 10.0, "angular_frequency": 2.0 * np.pi / PERIOD, "ramp_time": PERIOD}
    run = simulate(make(JUMPER, top__motion=[motion], solver__space=axis == "y", run__duration=3.0 * PERIOD))
    extremes, quarters = MOTIONS[axis]
    found = force(run, 2.0 * PERIOD)
    assert (found.min(), found.max()) == pytest.approx(extremes, abs=READING)
    times = 2.0 * PERIOD + 0.25 * PERIOD * np.arange(4)
    assert np.interp(times, run["time"][-len(found) :], found) == pytest.approx(quarters, abs=READING)


@pytest.mark.parametrize("angle", list(WAVES))
def test_force_of_the_jumper_in_waves_is_the_published_one(angle):
    waves = {"amplitude": 5.0, "period": 10.0, "direction": np.radians(angle)}
    run = simulate(make({**JUMPER, "waves": waves}, solver__space=angle > 0, run__duration=50.0))
    found = force(run, 20.0)
    assert (found.min(), found.max()) == pytest.approx(WAVES[angle], abs=READING)
