"""Inputs that are given at the end of a communication step: the top arrives exactly there, and the tension is that of the motion."""

from __future__ import annotations

import math

import numpy as np
import pytest
from chain_support import WIRE, make, swing

from cable_model import TowCable
from cable_model.errors import ParameterError
from cable_model.kernels import header
from cable_model.scene import from_dict
from cable_model.signals import OUTPUTS

OMEGA = 0.4 * math.pi  # 5 s, as ships heave
TENSION = OUTPUTS.index("top.tension")
TOP = slice(header.TOP, header.TOP + 9)
LIGHT = {"cable": {**WIRE["cable"], "axial_damping": 1e4}, "body": WIRE["body"], "solver": {"nodes": 5, "time_step": 0.01}}


def tow(order: int, at_end: int) -> TowCable:
    return TowCable(from_dict({**LIGHT, "top": {"motion_order": order, "inputs_at": at_end}}))


_MOTION = swing((0.0, 0.0, 1.0), OMEGA, ramp_time=5.0)


def heave(time: float) -> np.ndarray:
    """A top that heaves by 1 m, faded in; position, velocity, acceleration, winch speed (10,)."""
    return np.append(_MOTION(time), 0.0)


def tensions(model, step: float, at_end: bool, until: float = 15.0) -> np.ndarray:
    """Top tension at whole half seconds."""
    model.initialize(heave(0.0))
    every = round(0.5 / step)
    found = []
    for k in range(round(until / step)):
        model.step(k * step, step, heave((k + at_end) * step))
        if (k + 1) % every == 0:
            found.append(model.outputs[TENSION])
    return np.array(found)


@pytest.fixture(scope="module")
def exact() -> np.ndarray:
    model = tow(2, 0)
    model.initialize(heave(0.0))
    found = []
    for k in range(30):
        for j in range(50):
            a, b = 0.5 * k + 0.01 * j, 0.5 * k + 0.01 * (j + 1)
            model.advance(a, 0.01, heave(a), heave(b))
        found.append(model.outputs[TENSION])
    return np.array(found)


@pytest.mark.parametrize(("order", "share"), [(0, 11.0 / 12.0), (1, 1.0 / 3.0), (2, 1e-4)])
def test_the_tension_is_that_of_the_motion(exact: np.ndarray, order: int, share: float):
    """At fifty steps a period, where values at the start leave a third of the range without accelerations.

    A cubic through positions errs by 11/12 (omega h)^2 in the acceleration at its end, a parabola through velocities by a third of it.
    """
    ends = np.abs(tensions(tow(order, 1), 0.1, True) - exact)[10:].max() / np.ptp(exact)
    starts = np.abs(tensions(tow(order, 0), 0.1, False) - exact)[10:].max() / np.ptp(exact)
    assert ends < 3.0 * share * (OMEGA * 0.1) ** 2
    assert ends < 0.2 * starts


@pytest.mark.parametrize(("order", "power"), [(0, 2.0), (1, 2.0), (2, 3.0)])
def test_its_error_falls_with_the_step(exact: np.ndarray, order: int, power: float):
    coarse, fine = (np.abs(tensions(tow(order, 1), step, True) - exact)[10:].max() for step in (0.25, 0.125))
    assert math.log2(coarse / fine) > power - 0.2


@pytest.mark.parametrize("order", [0, 1, 2])
def test_the_top_is_exactly_where_it_was_said_to_arrive(order: int):
    """Whatever the steps: regular, of a thousandth, or slivers."""
    model = tow(order, 1)
    model.initialize(heave(0.0))
    time = 0.0
    for step in (0.1, 0.1, 1e-4, 0.07, 1e-9, 0.1, 0.003, 0.2):
        inputs = heave(time + step)
        model.step(time, step, inputs)
        time += step
        given = 3 * (order + 1)
        assert model.state[TOP][:given] == pytest.approx(inputs[:given], abs=1e-12)
        assert np.abs(model.state[TOP] - heave(time)[:9])[3:6].max() < 0.2


def test_the_chain_arrives_likewise():
    model = make(LIGHT, top__motion_order=1, top__inputs_at=1)
    model.initialize(heave(0.0))
    for k in range(3):
        model.step(0.1 * k, 0.1, heave(0.1 * (k + 1)))
        assert model.state[TOP][:6] == pytest.approx(heave(0.1 * (k + 1))[:6], abs=1e-12)


def test_a_winch_reaches_the_speed_given():
    model = make({**LIGHT, "winch": {"fitted": True}}, top__motion_order=1, top__inputs_at=1)
    model.initialize(np.zeros(10))
    for k in range(4):
        model.step(0.1 * k, 0.1, np.array([*[0.0] * 9, 0.1 * (k + 1)]))
        assert model.state[header.WINCH_SPEED] == pytest.approx(0.1 * (k + 1))
    assert model.state[header.PAID_OUT] == pytest.approx(0.5 * 0.4 * 0.4)  # the speed rises by 1 m/s2


def test_a_restored_run_goes_on_bit_identically():
    model = tow(0, 1)
    tensions(model, 0.1, True, 1.0)
    state = model.state.copy()
    rows = []
    for _ in range(2):
        model.state[:] = state
        for k in range(10, 15):
            model.step(0.1 * k, 0.1, heave(0.1 * (k + 1)))
        rows.append(model.outputs.copy())
    assert np.array_equal(*rows)


def test_another_place_in_the_step_is_refused():
    with pytest.raises(ParameterError, match=r"top\.inputs_at = 2: must be >= 0 and <= 1\."):
        from_dict({**LIGHT, "top": {"inputs_at": 2}})
