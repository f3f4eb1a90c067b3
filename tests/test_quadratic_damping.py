"""Axial damping by the square of the strain rate."""

import math

import numpy as np
import pytest
from scipy.optimize import brentq

from cable_model import CableChain, TowCable
from cable_model.errors import ParameterError
from cable_model.scene import from_dict, load, with_values

LENGTH, STIFFNESS, MASS, DAMPING, GRAVITY = 10.0, 1e5, 100.0, 4e5, 9.80665
STRAIN = MASS * GRAVITY / STIFFNESS
AMPLITUDE = 0.05  # m, of the first swing


def payload(**cable: float) -> CableChain:
    """A payload on a wire of a millionth of its mass, let go AMPLITUDE below its rest."""
    tables = {
        "cable": {"length": LENGTH, "mass_per_length": 1e-5, "axial_stiffness": STIFFNESS, "compressible": True, **cable},
        "body": {"mass": MASS},
        "lower_end": {"anchored": True, "released": True, "z": -LENGTH * (1.0 + STRAIN) - AMPLITUDE},
        "solver": {"nodes": 6, "time_step": 0.001, "lambda_infinity": -1.0},
    }
    return CableChain(from_dict(tables))


def swings(model: CableChain, seconds: float) -> np.ndarray:
    """Heights of the payload's turning points about its rest, m, by parabolas through the three samples about each."""
    step = 0.001
    model.initialize(np.zeros(10))
    z = [model.outputs[7]]
    for k in range(round(seconds / step)):
        model.advance(k * step, step, np.zeros(10), np.zeros(10))
        z.append(model.outputs[7])
    x = np.array(z) + LENGTH * (1.0 + STRAIN)
    at = np.nonzero(np.diff(np.sign(np.diff(x))) != 0)[0] + 1
    left, middle, right = x[at - 1], x[at], x[at + 1]
    return middle - (right - left) ** 2 / (8.0 * (left - 2.0 * middle + right))


def test_a_payload_loses_what_the_exact_solution_of_its_swing_loses():
    """M x'' + k x + b |x'| x' = 0, b = c/L^2: v^2 is linear in x within a swing, so from turning point a to the next one, b',

    (1 + q a) exp(-q a) = (1 - q b') exp(q b'),  q = 2 b/M.
    """
    q = 2.0 * DAMPING / LENGTH**2 / MASS
    expected = [AMPLITUDE]
    for _ in range(8):
        a = expected[-1]
        left = (1.0 + q * a) * math.exp(-q * a)
        expected.append(brentq(lambda x, left=left: (1.0 - q * x) * math.exp(q * x) - left, 0.0, min(a, 1.0 / q)))
    found = np.abs(swings(payload(quadratic_damping=DAMPING), 9.0 * math.pi * math.sqrt(MASS * LENGTH / STIFFNESS)))
    assert found[:8] == pytest.approx(expected[1:], rel=1e-3)
    assert expected[8] < 0.2 * AMPLITUDE  # it is the damping that is seen


def test_a_payload_without_it_keeps_its_swing():
    found = np.abs(swings(payload(), 9.0 * math.pi * math.sqrt(MASS * LENGTH / STIFFNESS)))
    assert found[:8] == pytest.approx(np.full(8, AMPLITUDE), rel=1e-3)


@pytest.mark.parametrize(
    ("changes", "text"),
    [
        ({"solver.grid": "box"}, r"cable\.quadratic_damping = 2 N\.s2: must be 0 on the box grid\. Set solver\.grid = \"staggered\"\."),
        ({"cable.quadratic_damping": -2.0}, r"cable\.quadratic_damping = -2 N\.s2: must be >= 0\. "),
    ],
)
def test_it_is_refused_where_it_is_not_simulated(changes: dict[str, object], text: str):
    scene = with_values(payload().scene, {"lower_end.released": False, "lower_end.anchored": False, "lower_end.z": 0.0})
    with pytest.raises(ParameterError, match=text):
        with_values(scene, {"cable.quadratic_damping": 2.0, **changes})


def test_the_straight_cable_refuses_it():
    scene = with_values(load("dale_sphere"), {"cable.quadratic_damping": 2.0})
    with pytest.raises(ParameterError, match=r"cable\.quadratic_damping = 2 N\.s2: must be 0 for TowCable\. Use CableChain\."):
        TowCable(scene)
