"""solver.tolerance: forces that are there, steps near the number of the fixed step's, and an end."""

import numpy as np
import pytest
from chain_support import HANGING, make
from test_communication_steps import SEEN, TAUT, run
from tow_reference import WET, tow

from cable_model.errors import SolverError
from cable_model.kernels.error_control import Trials, judge
from cable_model.kernels.family import coefficients, coefficients_of_change
from cable_model.kernels.header import HEADER, LAST_ERROR
from cable_model.signals import OUTPUTS

LENGTH = 50.5  # m, of the level wire
PULSE = 0.3  # s, in which the top rises by 20 mm and comes back: 0.3 times what a wave takes to go there and back


def pulse(t: float) -> np.ndarray:
    """A p^4 of the top, p = 4 s (1 - s), with its velocity and acceleration."""
    state = np.zeros(9)
    state[0] = LENGTH
    s = t / PULSE
    if 0.0 < s < 1.0:
        p, slope = s * (1.0 - s), 1.0 - 2.0 * s
        state[2::3] = 256.0 * p**4, 1024.0 * p**3 * slope / PULSE, (3072.0 * p * p * slope * slope - 2048.0 * p**3) / PULSE**2
        state[2::3] *= 0.02
    return state


@pytest.mark.parametrize("tolerance", [1e-1, 1e-2, 1e-3])
def test_the_forces_of_a_taut_wire_are_within_the_tolerance(tolerance):
    """Drift of the held top was closed within the next internal step, however small: 36 kN of false force at 1e-2."""
    fine = run(make(TAUT, solver__time_step=0.0005), pulse, [0.01] * 100, held=False)[1][:, SEEN[:3]]
    found = run(make(TAUT, solver__tolerance=tolerance), pulse, [0.01] * 100, held=False)[1][:, SEEN[:3]]
    assert (np.abs(found - fine).max(axis=0) < tolerance * np.ptp(fine, axis=0)).all()


def test_a_cable_without_gravity_is_simulated_under_error_control():
    model = make(TAUT, environment__gravity=0.0, solver__tolerance=1e-2)
    found = run(model, pulse, [0.01] * 50, held=False)[1]
    assert found[-1, OUTPUTS.index("solver.steps")] < 5000


def test_an_impulsive_start_ends_under_error_control():
    def start(t: float) -> np.ndarray:
        return np.array([0.5 * t, 0.0, 0.0, 0.5, 0.0, 0.0, 0.0, 0.0, 0.0])

    found = run(make(HANGING, solver__tolerance=1e-3), start, [0.01] * 30, held=False)[1]
    assert found[-1, OUTPUTS.index("solver.steps")] < 20000


@pytest.mark.parametrize("kind", ["chain", "tow"])
def test_a_step_that_would_take_millions_of_internal_steps_is_one_error(kind):
    model = make(HANGING, solver__time_step=1e-9) if kind == "chain" else tow(WET, solver__tolerance=0.0, solver__time_step=1e-9)
    model.initialize(np.zeros(9))
    with pytest.raises(SolverError) as caught:
        model.step(0.0, 0.01, np.zeros(9))
    assert str(caught.value) == (
        f"{type(model).__name__} at t = 0 s: a communication step would take more than a million internal steps. Raise solver.time_step, "
        "or solver.tolerance where the motion is a sequence of shocks, or take shorter steps. Results before this time are valid."
    )


def test_an_error_above_the_allowed_one_is_tried_again_and_an_error_that_stays_is_let_be():
    state = np.zeros(HEADER)
    factor, again, trials = judge(state, 10.0, 1.0, 0.1, 1e-7, Trials(0.0, 0.0))
    assert again
    assert factor == 0.3
    factor, again, trials = judge(state, 9.0, 1.0, 0.03, 1e-7, trials)
    assert not again  # nothing gained: it rings, and the step goes back towards the first
    assert factor == 2.0
    assert trials == (0.0, 0.0)
    assert state[LAST_ERROR] == 10.0


@pytest.mark.parametrize(("ratio", "factor"), [(1e-9, 2.0), (0.25, 1.84), (0.8, 1.0), (1.3, 1.0), (1.9, 0.92 / np.sqrt(1.9))])
def test_the_next_step_follows_the_error_but_not_every_change_of_it(ratio, factor):
    assert judge(np.zeros(HEADER), ratio, 1.0, 0.1, 1e-7, Trials(0.0, 0.0))[0] == pytest.approx(factor)


def test_a_step_of_another_size_is_taken_by_a_member_that_damps():
    assert coefficients_of_change(0, -0.9) == coefficients(0, -0.5)
    assert coefficients_of_change(0, 0.0) == coefficients(0, 0.0)
    for other in range(1, 6):
        assert coefficients_of_change(other, -0.9) == coefficients(other, -0.9)
