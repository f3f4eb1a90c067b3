"""Observed order of the staggered chain in time and space, on smooth motion, by successive halving."""

import numpy as np
import pytest
from chain_support import HANGING, SECOND_MODE, WIRE, Motion, drive, every, make, observed_orders, swing

SWAY = swing((0.02, 0.0, 0.0), SECOND_MODE)
TOW = swing((0.5, 0.0, 0.5), 2.0 * np.pi / 8.0, ramp_time=8.0, phase=(0.0, 0.0, np.pi / 2.0))
RHYTHM = np.array([1.0, 1.3, 0.8, 1.1, 0.9, 1.2, 0.7, 1.1, 0.9, 1.0])  # mean 1: every step differs from the one before


def fixed(step: float, duration: float) -> np.ndarray:
    return every(step, duration)


def changing(step: float, duration: float) -> np.ndarray:
    return np.concatenate([[0.0], np.cumsum(np.tile(step * RHYTHM, round(duration / (10.0 * step))))])


def orders_in_time(rule, steps, base: dict, motion: Motion, duration: float, name: str, **changes) -> list[float]:
    """Orders of an output at common times, the internal steps being the communication steps of `rule`."""
    common = 10.0 * max(steps)
    answers = []
    for step in steps:
        times = rule(step, duration)
        series = drive(make(base, solver__time_step=1e3, **changes), times, motion)
        chosen = [int(np.argmin(np.abs(times - t))) for t in common * np.arange(1, round(duration / common) + 1)]
        answers.append(series[name][chosen])
    return observed_orders(answers)


@pytest.mark.parametrize(("rule", "name"), [(fixed, "body.x"), (fixed, "top.tension"), (changing, "body.x")])
def test_lambda_of_minus_a_half_is_second_order_with_fixed_and_with_changing_steps(rule, name):
    orders = orders_in_time(rule, (0.01, 0.005, 0.0025, 0.00125), HANGING, SWAY, 2.0, name)
    assert orders[-1] == pytest.approx(2.0, abs=0.1)


@pytest.mark.parametrize(
    ("integrator", "lam", "order"),
    [
        ("generalized-alpha", -0.9, 2),
        ("generalized-alpha", 0.0, 2),
        ("trapezoidal", 0.0, 2),
        ("cornwell-malkus", -0.5, 2),
        ("wbz", -0.5, 2),
        ("generalized-trapezoidal", -0.5, 1),
        ("backward-difference", 0.0, 1),
    ],
)
def test_every_member_of_the_family_has_its_order(integrator, lam, order):
    steps = (0.005, 0.0025, 0.00125, 0.000625) if order == 2 else (0.00125, 0.000625, 0.0003125)
    orders = orders_in_time(fixed, steps, HANGING, SWAY, 2.0, "body.x", solver__integrator=integrator, solver__lambda_infinity=lam)
    assert orders[-1] == pytest.approx(order, abs=0.1)


@pytest.mark.parametrize("rule", [fixed, changing])
@pytest.mark.parametrize("name", ["body.x", "body.z", "top.tension"])
def test_second_order_holds_with_a_body_drag_and_a_moving_top(rule, name):
    # a current keeps the drag from changing sign, a soft wire keeps its axial oscillation resolved
    steps = (0.05, 0.025, 0.0125, 0.00625)
    orders = orders_in_time(rule, steps, WIRE, TOW, 12.0, name, cable__axial_stiffness=1e6, current__speed=1.0)
    assert orders[-1] == pytest.approx(2.0, abs=0.1)


def test_second_order_in_the_cell_length_on_the_graded_mesh():
    answers = []
    for nodes in (51, 101, 201, 401):
        series = drive(make(HANGING, solver__nodes=nodes, solver__time_step=0.005), every(0.2, 2.0), SWAY)
        answers.append(series["body.x"])
    assert observed_orders(answers) == pytest.approx([2.0, 2.0], abs=0.1)
