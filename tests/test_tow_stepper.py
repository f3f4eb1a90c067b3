"""Steppers of the tow model: order, stiffness, slack events, error control, failures, and the completeness of the state."""

import math

import numpy as np
import pytest
from tow_reference import DRY, NUMBERS, SLOW, WET, circling, follow, still, tow

from cable_model.effects import Parts
from cable_model.errors import SolverError
from cable_model.kernels import header, tow_schemes, tow_step
from cable_model.kernels import tow as kernels
from cable_model.kernels.path import COLUMNS, ROWS
from cable_model.tow_cable import TowCable

CALM = WET._replace(current=np.array([[0.0, 1.5, 0.0]]))  # no velocity of the water past cable or body changes its sign
GRAVITY = NUMBERS["environment.gravity"]
SOFT = {"cable__axial_stiffness": 5e3, "tow__reference_tension": 0.0}


def run(parts, duration, step, motion, **changes):
    model = tow(parts, **changes)
    model.initialize(motion(0.0))
    follow(model, motion, step, round(duration / step))
    return model


def test_coefficients_of_radau_are_those_of_collocation():
    """A from the nodes: sum_j a_ij c_j^(q-1) = c_i^q/q; its inverse is split by T into one real and one complex eigenvalue."""
    s = tow_schemes
    c = np.array([s.C1, s.C2, 1.0])
    powers = np.vander(c, 3, increasing=True)
    a = (np.vander(c, 4, increasing=True)[:, 1:] / [1.0, 2.0, 3.0]) @ np.linalg.inv(powers)
    for k in range(1, 6):  # order 5 at the end of the step
        assert a[2] @ c ** (k - 1) == pytest.approx(1.0 / k, rel=1e-14)
    t = np.array([[s.T11, s.T12, s.T13], [s.T21, s.T22, s.T23], [1.0, 1.0, 0.0]])
    split = np.array([[s.S11, s.S12, s.S13], np.real([s.P1, s.P2, s.P3]), np.imag([s.P1, s.P2, s.P3])])
    assert split @ t == pytest.approx(np.eye(3), abs=1e-13)
    alpha, beta = s.PAIR.real, s.PAIR.imag
    blocks = np.array([[s.REAL, 0.0, 0.0], [0.0, alpha, -beta], [0.0, beta, alpha]])
    assert split @ np.linalg.inv(a) @ t == pytest.approx(blocks, abs=1e-12)


@pytest.mark.parametrize("freedoms", [2, 3])
@pytest.mark.parametrize("rate", [3.7, 2.0 - 5.0j])
def test_the_linear_solve_inverts_the_whole_jacobian(rate, freedoms):
    random = np.random.default_rng(5)
    n = 2 * freedoms
    by_place, by_rate = random.normal(size=(freedoms, freedoms)), random.normal(size=(freedoms, freedoms))
    r = random.normal(size=n) * (1.0 if isinstance(rate, float) else 1.0 + 0.5j)
    full = np.zeros((n, n))
    full[0::2, 1::2] = np.eye(freedoms)
    full[1::2, 0::2], full[1::2, 1::2] = by_place, by_rate
    j = (tuple(by_place.ravel()), tuple(by_rate.ravel()))
    assert tow_schemes.solve(rate, j, tuple(r)) == pytest.approx(np.linalg.solve(rate * np.eye(n) - full, r), rel=1e-11)


@pytest.mark.parametrize(("explicit", "order"), [(0.0, 5), (1.0, 4)])
def test_fixed_steps_converge_at_the_order_of_the_method(explicit, order):
    sway = circling(0.5, 0.9, 2.0)
    duration = 0.8
    exact = run(CALM, duration, 0.8, sway, solver__tolerance=0.0, solver__time_step=0.005, **SOFT).motion
    errors = []
    for step in (0.1, 0.05):
        model = run(CALM, duration, 0.8, sway, solver__tolerance=0.0, solver__time_step=step, tow__explicit=explicit, **SOFT)
        errors.append(np.abs(model.motion - exact)[:2].max())
    observed = math.log2(errors[0] / errors[1])
    assert observed == pytest.approx(order, abs=0.1)


def test_fixed_steps_end_with_the_communication_step():
    """Whatever the ratio of the two steps: no step is lost or added by rounding of n h/n."""
    model, _, _ = bouncer(solver__tolerance=0.0, solver__time_step=0.01)
    for pieces in range(1, 60):
        for h in (0.01 * pieces, 0.0097 * pieces):
            before = model["solver.steps"]
            model.advance(0.0, h, still(), still())
            assert model["solver.steps"] - before == math.ceil(h / 0.01 - 1e-9)


def test_error_control_delivers_what_the_tolerance_asks():
    sway = circling(0.5, 0.9, 2.0)
    duration = 2.0 if SLOW else 12.0
    exact = run(WET, duration, 0.5, sway, solver__tolerance=1e-12, **SOFT).motion
    error, steps = [], []
    for tolerance in (1e-4, 1e-6, 1e-8):
        model = run(WET, duration, 0.5, sway, solver__tolerance=tolerance, **SOFT)
        error.append(np.abs(model.motion - exact).max() / tolerance)
        steps.append(model["solver.steps"])
    assert max(error) < 10.0
    assert steps[0] < steps[1] < steps[2]


def test_explicit_and_implicit_agree():
    sway = circling(0.5, 0.9, 2.0)
    duration = 1.0 if SLOW else 20.0
    implicit = run(WET, duration, 0.5, sway, solver__tolerance=1e-10)
    explicit = run(WET, duration, 0.5, sway, solver__tolerance=1e-10, tow__explicit=1.0)
    assert explicit["solver.newton_iterations"] == 0.0 < implicit["solver.newton_iterations"]
    assert explicit.motion == pytest.approx(implicit.motion, rel=1e-8, abs=1e-9)
    assert explicit.outputs[:14] == pytest.approx(implicit.outputs[:14], rel=1e-7, abs=1e-7)


def table_1_sphere(stiffness, **changes):
    """The suspended sphere of [Wang 1971, table 1], model scale: 1 inch, 0.025 lbf in water, 9 ft of cable."""
    pound, foot, inch = 4.4482216, 0.3048, 0.0254
    rho, volume, weight = 1000.0, math.pi / 6.0 * inch**3, 0.025 * pound
    length, area = 9.0 * foot, math.pi / 4.0 * inch**2
    numbers = {
        "cable.length": length,
        "cable.diameter": 0.025 * inch,
        "cable.mass_per_length": 0.000171 * 14.5939 / length,
        "cable.axial_stiffness": stiffness,
        "cable.normal_drag_coefficient": 2.0,
        "cable.added_mass_coefficient": 1.0,
        "body.mass": weight / 9.81 + rho * volume,
        "body.volume": volume,
        "body.drag_area": 0.45 * area,
        "body.added_mass": 0.5 * rho * volume,
        "tow.added_mass_vertical": 0.5 * rho * volume,
        "environment.gravity": 9.81,
        "water.density": rho,
    }
    numbers |= {k.replace("__", "."): v for k, v in changes.items()}
    return TowCable.from_numbers(numbers, Parts(body=True, water=True, cable_mass=True))


@pytest.mark.parametrize("stiffness", [2.2e2, 4.45e6])
def test_the_swing_is_as_accurate_with_a_stiff_cable_as_with_a_soft_one(stiffness):
    """Newton's stiff part converges at once; were it trusted for the swing, a stiff cable would err by 1.6e-4 rad, not 5e-6."""
    sway = circling(0.06, 2.28, 5.0)
    angles = []
    for tolerance in (1e-6, 1e-3):
        model = table_1_sphere(stiffness, solver__tolerance=tolerance)
        model.initialize(sway(0.0))
        seen = []
        follow(model, sway, 0.5, 4 if SLOW else 40, see=lambda t, to=seen, of=model: to.append(of.motion[0]))
        angles.append(np.array(seen))
    assert np.abs(angles[1] - angles[0]).max() < 2e-5


@pytest.mark.parametrize("tolerance", [1e-3, 1e-4])
def test_cost_does_not_grow_with_the_stiffness_of_the_cable(tolerance):
    """Right-hand sides over 40 s of the same smooth circling, EA from 5 to 1e6 lbf (22 N to 4.4e6 N): equal within 1.5."""
    sway = circling(0.06, 1.14, 5.0)
    counts = []
    for stiffness in (22.2, 2.2e2, 2.2e3, 2.2e4, 2.2e5, 4.45e6):
        model = table_1_sphere(stiffness, solver__tolerance=tolerance)
        model.initialize(sway(0.0))
        follow(model, sway, 0.5, 10 if SLOW else 80)
        counts.append(model.state[kernels.EVALUATIONS])
    assert max(counts) < 1.5 * min(counts)


def bouncer(**changes):
    """A body on a spring without mass or water, which goes slack at zero stretch; its rest stretch and angular frequency."""
    model = tow(
        Parts(body=True, tension_floor=True),
        **({"cable__mass_per_length": 0.0, "tow__reference_tension": 0.0, "tow__minimum_tension": 0.0} | changes),
    )
    model.initialize(still())
    k = NUMBERS["cable.axial_stiffness"] / NUMBERS["cable.length"]
    return model, NUMBERS["body.mass"] * GRAVITY / k, math.sqrt(k / NUMBERS["body.mass"])


def bounce_period(height, rest, omega):
    """From rest `height` above the slack point and back: free fall, an oscillation about the rest stretch, free flight."""
    speed = math.sqrt(2.0 * GRAVITY * height)
    return 2.0 * speed / GRAVITY + 2.0 / omega * (math.pi / 2.0 + math.atan(rest * omega / speed))


@pytest.mark.parametrize(("explicit", "tolerance"), [(0.0, 1e-10), (1.0, 1e-10), (0.0, 0.0)])
def test_a_bouncing_body_keeps_its_period_through_slack(explicit, tolerance):
    """Ballistic and harmonic pieces have a closed form; a smeared corner of the tension floor would shift it."""
    model, rest, omega = bouncer(tow__explicit=explicit, solver__tolerance=tolerance, solver__time_step=0.01)
    assert model.motion[2] == pytest.approx(rest, rel=1e-12)
    height = 0.7
    period = bounce_period(height, rest, omega)
    model.set_state(0.0, 0.0, -height, 0.0)
    assert model["cable.slack_fraction"] == 1.0
    assert model["top.tension"] == 0.0
    count = 1 if SLOW else 10
    slack = []
    follow(model, lambda t: still(), period / 16, 16 * count, see=lambda t: slack.append(model["cable.slack_fraction"]))
    assert 0.2 < np.mean(slack) < 0.8
    assert model.motion[2] == pytest.approx(-height, abs=1e-7)
    assert model.motion[3] == pytest.approx(0.0, abs=1e-6)


def test_events_keep_the_order_of_fixed_steps():
    """Steps are cut at the corner, so that halving them gains about 2^5; a smeared corner would leave at most 2^2."""
    errors = []
    for step in (0.1, 0.05):
        model, rest, omega = bouncer(solver__tolerance=0.0, solver__time_step=step)
        model.set_state(0.0, 0.0, -0.7, 0.0)
        follow(model, lambda t: still(), bounce_period(0.7, rest, omega), 2)
        errors.append(abs(model.motion[3]))
    assert errors[0] / errors[1] > 16.0


@pytest.mark.parametrize(("explicit", "accuracy"), [(0.0, 1e-4), (1.0, 1e-3)])
def test_a_slack_spell_within_one_step_is_not_missed(explicit, accuracy):
    """The body rises 2 cm beyond the slack point and returns, all in one step, taut at both ends: the step falls into three."""
    model, rest, omega = bouncer(tow__explicit=explicit, solver__tolerance=0.0, solver__time_step=10.0)
    speed = math.sqrt(2.0 * GRAVITY * 0.02)
    reach = math.hypot(rest, speed / omega)
    phase = math.acos(-rest / reach) - 0.6  # 0.6 rad before the cable goes slack
    stretch, rate = rest + reach * math.cos(phase), -reach * omega * math.sin(phase)
    model.set_state(0.0, 0.0, stretch, rate)
    model.advance(0.0, 1.2 / omega + 2.0 * speed / GRAVITY, still(), still())
    assert model["solver.steps"] == 3.0
    assert model.motion[2:] == pytest.approx([stretch, -rate], abs=accuracy)


def test_the_communication_step_does_not_change_the_answer():
    """The top moves along one quintic, which every division into communication steps reproduces: only the tolerance is left."""

    def shift(t):
        s, span = t / 5.0, 5.0
        x = (10 * s**3 - 15 * s**4 + 6 * s**5, 30 * s**2 * (1 - s) ** 2 / span, 60 * s * (1 - s) * (1 - 2 * s) / span**2)
        return np.array([4 * x[0], 0, x[0], 4 * x[1], 0, x[1], 4 * x[2], 0, x[2]])

    coarse, fine, odd = (run(WET, 5.0, step, shift, solver__tolerance=1e-9).motion for step in (5.0, 0.1, 5.0 / 7.0))
    assert fine == pytest.approx(coarse, rel=1e-8, abs=1e-8)
    assert odd == pytest.approx(coarse, rel=1e-8, abs=1e-8)


@pytest.mark.parametrize("explicit", [0.0, 1.0])
def test_a_restored_state_continues_bit_for_bit(explicit):
    sway = circling(1.5, 1.6, 2.0)
    parts = WET._replace(tension_floor=True)
    model = run(parts, 2.0, 0.25, sway, solver__tolerance=1e-6, tow__explicit=explicit)
    saved = model.state.copy()
    follow(model, sway, 0.25, 8, start=2.0)
    first = model.state.copy()
    other = tow(parts, solver__tolerance=1e-6, tow__explicit=explicit)
    other.state[:] = saved
    other._work[:] = np.nan  # work is no part of the state
    follow(other, sway, 0.25, 8, start=2.0)
    assert np.array_equal(other.state, first)
    assert np.array_equal(other.outputs, model.outputs)


def test_an_effect_that_is_absent_is_bit_identical_to_one_of_no_size():
    sway = circling(0.5, 0.9, 2.0)
    with_floor = run(DRY._replace(tension_floor=True), 1.0, 0.25, sway, tow__minimum_tension=-1e9)
    without = run(DRY, 1.0, 0.25, sway)
    assert np.array_equal(with_floor.state, without.state)


def nasty(random):
    """Numbers of all sizes, and what is not a number."""
    return random.choice([0.0, 1.0, -1e3, 1e6, 1e12, 1e200, np.inf, -np.inf, np.nan])


def test_nan_never_comes_back_with_ok():
    random = np.random.default_rng(4)
    parts = WET._replace(tension_floor=True)
    model = tow(parts, solver__tolerance=1e-3)
    failures = 0
    for trial in range(20 if SLOW else 200):
        model.initialize(still())
        model.state[random.integers(kernels.ANGLE, kernels.ANGLE + 4)] = nasty(random) if trial % 2 else 0.0
        path = np.zeros((ROWS, COLUMNS))
        path[random.integers(6), random.choice([0, 2])] = nasty(random)
        before = model.state.copy()
        with np.errstate(all="ignore"):
            status = tow_step.advance(model.parts, model.numbers, 0.0, 0.01, path, model.state, model._work)
        assert status == header.NOT_FINITE or np.isfinite(path).all()
        if status == header.OK:
            assert np.isfinite(model.state).all()
        else:
            failures += 1
            changed = [header.ERROR_TIME, header.ERROR_SIZE]
            model.state[changed] = before[changed]
            assert np.array_equal(model.state, before, equal_nan=True)
    assert failures > 5


def test_an_explicit_fixed_step_beyond_stability_fails_and_says_when():
    model = tow(DRY, tow__explicit=1.0, solver__tolerance=0.0, solver__time_step=0.5, cable__axial_stiffness=1e9)
    model.initialize(still())
    model.set_state(0.3, 0.0, model.motion[2], 0.0)
    with pytest.raises(SolverError, match="TowCable at t = "):
        follow(model, lambda t: still(), 5.0, 40)
    assert np.isfinite(model.motion).all()


def test_unknown_numbers_are_refused():
    with pytest.raises(ValueError, match=r"cable\.lenght: unknown parameter"):
        TowCable.from_numbers({"cable.lenght": 3.0}, DRY)
