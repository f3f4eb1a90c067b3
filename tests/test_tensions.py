"""Tensions along the cable: those of a hanging cable in closed form, and the largest and smallest among them as the outputs have them."""

import itertools

import numpy as np
import pytest
from chain_support import HANGING, WEIGHT, make

from cable_model import CableChain, TowCable, load, simulate
from cable_model.kernels import header
from cable_model.motion import top_motion
from cable_model.scene import with_values
from cable_model.signals import OUTPUTS

SURGE = {"kind": "sinusoid", "axis": "x", "amplitude": 1.0, "angular_frequency": 2.0, "ramp_time": 2.0}

pytestmark = pytest.mark.shipped


def test_a_hanging_cable_carries_what_hangs_below_the_middle_of_each_cell():
    run = simulate(make(HANGING, solver__grading=1.0), duration=0.1)
    below = (np.arange(50) + 0.5) / 50
    assert run.tensions.shape == (len(run.table), 50)
    assert run.tensions[-1] == pytest.approx(WEIGHT * below, rel=1e-6)


@pytest.mark.parametrize(
    ("name", "changes", "duration"),
    [
        ("basin_chain", {}, 8.0),  # goes slack
        ("hard/whirl", {}, 12.0),  # in space
        ("hard/loops", {"cable.bending_stiffness": 500.0, "top.motion": [SURGE]}, 5.0),  # what bending adds is not little
    ],
)
def test_the_largest_and_the_smallest_are_those_of_the_outputs(name, changes, duration):
    run = simulate(CableChain(with_values(load(name), changes)), duration)
    largest, smallest = run["cable.tension_max"], run["cable.tension_min"]
    assert np.ptp(largest) > 0.1 * largest.mean()
    close = {"rel": 1e-9, "abs": 1e-9 * largest.max()}
    assert np.maximum(run.tensions.max(axis=1), run["top.tension"]) == pytest.approx(largest, **close)
    assert run.tensions.min(axis=1) == pytest.approx(smallest, **close)


def test_they_lead_on_over_time_that_waits_for_an_internal_step():
    model, motion = CableChain(load("hanging_chain")), top_motion(load("hanging_chain").top)
    model.initialize(motion(0.0, 1))
    times = [*np.linspace(0.0, 2.0, 201), 2.001]
    for before, after in itertools.pairwise(times):
        model.advance(before, after - before, motion(before, 1), motion(after, 1))
    assert model.state[header.PENDING] == pytest.approx(0.001)
    largest, smallest = (model.outputs[OUTPUTS.index(f"cable.tension_{word}")] for word in ("max", "min"))
    assert max(model.tensions().max(), model.outputs[OUTPUTS.index("top.tension")]) == pytest.approx(largest, rel=1e-12)
    assert model.tensions().min() == pytest.approx(smallest, rel=1e-9)


def test_a_straight_cable_and_the_box_grid_tell_none_along_the_cable():
    scene = with_values(load("hanging_chain"), {"run.duration": 0.1})
    assert simulate(CableChain(scene)).tensions is not None
    assert simulate(TowCable(scene)).tensions is None
    assert CableChain(with_values(scene, {"solver.grid": "box"})).tensions() is None
