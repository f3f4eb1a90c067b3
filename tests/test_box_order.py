"""Observed order of the box grid in time and space, on smooth motion, by successive halving."""

import os

import numpy as np
import pytest
from chain_support import HANGING, SECOND_MODE, WEIGHT, WIRE, drive, every, make, observed_orders, swing

from cable_model.kernels.family import coefficients

SLOW = pytest.mark.skipif(bool(os.environ.get("NUMBA_DISABLE_JIT")), reason="minutes in plain Python")
SWAY = swing((0.05, 0.0, 0.0), 4.0)
TOW = swing((0.5, 0.0, 0.5), 2.0 * np.pi / 8.0, ramp_time=8.0, phase=(0.0, 0.0, np.pi / 2.0))
RHYTHM = np.array([1.0, 1.3, 0.8, 1.1, 0.9, 1.2, 0.7, 1.1, 0.9, 1.0])  # mean 1: every step differs from the one before
# soft and thick enough that every mode of the grid that moves is resolved
SOFT = {
    "cable": HANGING["cable"] | {"axial_stiffness": 100.0 * WEIGHT, "bending_stiffness": 1e-3 * WEIGHT * 1.75**2},
    "environment": HANGING["environment"],
    "solver": {"nodes": 21, "lambda_infinity": -0.5, "grid": "box"},
}
BODY = WIRE | {"solver": {"nodes": 21, "lambda_infinity": -0.5, "grid": "box"}}


def series(base, motion, step, duration, rhythm, name, **changes):
    """An output at every tenth step, the internal steps being the communication steps."""
    steps = np.tile(step * rhythm, round(duration / (10.0 * step)))
    times = np.concatenate([[0.0], np.cumsum(steps)])
    return drive(make(base, solver__time_step=2.0 * step, **changes), times, motion)[name][10::10]


def orders_in_time(base, motion, steps, duration, rhythm, name, **changes):
    answers = [series(base, motion, step, duration, rhythm, name, **changes) for step in steps]
    return observed_orders([a[round(steps[0] / step) - 1 :: round(steps[0] / step)] for a, step in zip(answers, steps, strict=True)])


@SLOW
@pytest.mark.parametrize("rhythm", [np.ones(10), RHYTHM], ids=["fixed", "changing"])
@pytest.mark.parametrize("name", ["body.x", "top.tension"])
def test_lambda_of_minus_a_half_is_second_order_with_fixed_and_with_changing_steps(rhythm, name):
    orders = orders_in_time(SOFT, SWAY, (0.01, 0.005, 0.0025, 0.00125), 2.0, rhythm, name)
    assert orders[-1] == pytest.approx(2.0, abs=0.1)


@SLOW
@pytest.mark.parametrize(
    ("integrator", "lam", "order"), [("generalized-alpha", -0.9, 2), ("generalized-alpha", 0.0, 2), ("backward-difference", 0.0, 1)]
)
def test_members_of_the_family_have_their_order(integrator, lam, order):
    steps = (0.01, 0.005, 0.0025, 0.00125) if order == 2 else (0.0025, 0.00125, 0.000625)
    orders = orders_in_time(SOFT, SWAY, steps, 2.0, np.ones(10), "body.x", solver__integrator=integrator, solver__lambda_infinity=lam)
    assert orders[-1] == pytest.approx(order, abs=0.1)


@SLOW
@pytest.mark.parametrize("rhythm", [np.ones(10), RHYTHM], ids=["fixed", "changing"])
@pytest.mark.parametrize("name", ["body.x", "body.z", "top.tension"])
def test_second_order_holds_with_a_body_drag_and_a_moving_top(rhythm, name):
    # a current keeps the drag from changing sign, a soft wire keeps its axial oscillation resolved
    orders = orders_in_time(
        BODY, TOW, (0.025, 0.0125, 0.00625, 0.003125), 12.0, rhythm, name, cable__axial_stiffness=1e6, current__speed=1.0
    )
    assert orders[-1] == pytest.approx(2.0, abs=0.1)


@SLOW
def test_second_order_holds_where_the_water_changes_with_place_and_time():
    shallow = BODY | {"cable": BODY["cable"] | {"length": 10.0, "axial_stiffness": 1e5}}
    shallow |= {"waves": {"amplitude": 0.5, "period": 4.0}, "body": {"mass": 100.0, "volume": 0.04, "drag_area": 0.2, "added_mass": 40.0}}
    orders = orders_in_time(shallow, TOW, (0.04, 0.02, 0.01, 0.005), 8.0, np.ones(10), "body.x", current__speed=3.0)
    assert orders[-1] == pytest.approx(2.0, abs=0.1)


@SLOW
@pytest.mark.parametrize("name", ["body.x", "top.tension"])
def test_second_order_in_the_cell_length(name):
    answers = []
    for nodes in (21, 41, 81, 161):
        model = make(SOFT, solver__nodes=nodes, solver__time_step=0.005, cable__bending_stiffness=1e-2 * WEIGHT * 1.75**2)
        answers.append(drive(model, every(0.2, 2.0), SWAY)[name])
    assert observed_orders(answers)[-1] == pytest.approx(2.0, abs=0.1)


def mass_at(weight_of_old, steps):
    """y at t = 1 of (1 + y) y' + y = 0, y(0) = 1, with the coefficient at the given weight of the old state; lambda -0.5."""
    c = coefficients(0, -0.5)
    h = 1.0 / steps
    old, new_gain = weight_of_old(c), 1.0 / (c.gamma * h)
    y, rate = 1.0, -0.5
    rate += (c.alpha_m - c.alpha_k) * h * 0.125  # y'' = y'^2-terms at the start: d/dt of -y/(1+y) = -y'/(1+y)^2 = 1/8
    for _ in range(steps):
        new = y
        for _ in range(50):
            slope = new_gain * (new - y) - (1.0 - c.gamma) / c.gamma * rate
            mean_rate = (1.0 - c.alpha_m) * slope + c.alpha_m * rate
            mass = 1.0 + (1.0 - old) * new + old * y
            row = mass * mean_rate + (1.0 - c.alpha_k) * new + c.alpha_k * y
            new -= row / (mass * (1.0 - c.alpha_m) * new_gain + (1.0 - old) * mean_rate + 1.0 - c.alpha_k)
        rate = new_gain * (new - y) - (1.0 - c.gamma) / c.gamma * rate
        y = new
    return np.array([y])


@pytest.mark.parametrize(("weight_of_old", "order"), [(lambda c: c.alpha_m, 1), (lambda c: c.alpha_k, 2)], ids=["eq 23", "ours"])
def test_a_mass_averaged_with_alpha_m_as_in_eq_23_costs_an_order(weight_of_old, order):
    answers = [mass_at(weight_of_old, steps) for steps in (40, 80, 160, 320)]
    assert observed_orders(answers)[-1] == pytest.approx(order, abs=0.1)


@SLOW
def test_box_and_staggered_grid_converge_to_the_same_motion():
    motion = swing((0.02, 0.0, 0.0), SECOND_MODE)
    common = {"cable": HANGING["cable"] | {"bending_stiffness": 1e-2 * WEIGHT * 1.75**2}}
    gaps = []
    for nodes in (26, 51, 101):
        runs = [
            drive(make(HANGING | common, solver__grid=grid, solver__nodes=nodes, solver__time_step=0.0025), every(0.2, 2.0), motion)
            for grid in ("box", "staggered")
        ]
        gaps.append(np.max(np.abs(runs[0]["body.x"] - runs[1]["body.x"])))
    assert gaps[2] < 0.35 * gaps[1] < 0.35 * 0.35 * gaps[0]
