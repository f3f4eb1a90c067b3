"""Water about the chain: linear waves, drag and added mass against closed forms."""

import numpy as np
import pytest
from chain_support import WIRE, drive, every, make, swing
from scipy.optimize import brentq

from cable_model.effects import Parts
from cable_model.kernels.fluid import body_drag, element_drag
from cable_model.kernels.problem import Water
from cable_model.kernels.waves import wave_motion
from cable_model.sea import table_of

WAVE = np.array([[0.8, 1.1, 1.1**2 / 9.81, 0.6, 0.3, 0.0]])  # amplitude, omega, k = omega^2/g, direction, phase
SEA = Parts(waves=table_of(WAVE))
PLACE, TIME = (2.0, -1.0, -3.0), 1.7


def test_wave_velocity_is_that_of_a_linear_wave_in_deep_water():
    a, omega, k, direction, phase, _ = WAVE[0]
    angle = k * (PLACE[0] * np.cos(direction) + PLACE[1] * np.sin(direction)) - omega * TIME + phase
    size = a * omega * np.exp(k * PLACE[2])
    velocity, acceleration, gradient = wave_motion(SEA, PLACE, TIME)
    expected = [size * np.cos(angle) * np.cos(direction), size * np.cos(angle) * np.sin(direction), size * np.sin(angle)]
    assert velocity == pytest.approx(expected, rel=1e-12)
    ahead, behind = (np.array(wave_motion(SEA, PLACE, TIME + dt)[0]) for dt in (1e-5, -1e-5))
    assert acceleration == pytest.approx((ahead - behind) / 2e-5, rel=1e-8)
    columns = []
    for step in np.eye(3) * 1e-5:
        up, down = (np.array(wave_motion(SEA, tuple(PLACE + sign * step), TIME)[0]) for sign in (1.0, -1.0))
        columns.append((up - down) / 2e-5)
    matrix = np.reshape(gradient, (3, 3))
    assert matrix == pytest.approx(np.array(columns), abs=1e-9)  # symmetric too: the flow is irrotational
    assert matrix == pytest.approx(matrix.T, abs=1e-14)
    assert np.trace(matrix) == pytest.approx(0.0, abs=1e-12)  # and of no divergence


def test_waves_above_the_still_surface_hold_the_values_of_the_surface():
    level = wave_motion(SEA, (2.0, -1.0, 0.0), TIME)
    above = wave_motion(SEA, (2.0, -1.0, 0.7), TIME)
    assert above[0] == pytest.approx(level[0], rel=1e-14)
    assert above[1] == pytest.approx(level[1], rel=1e-14)


def test_drag_of_an_element_is_the_morison_law_in_its_own_axes():
    water = Water(3.0, 0.2, 0.0, 0.0)
    tangent, aside = np.array([0.6, 0.8]), np.array([-0.8, 0.6])
    force, _, _ = element_drag(water, tuple(1.5 * aside - 2.0 * tangent), tuple(tangent), 1.21)
    assert force == pytest.approx(1.1 * (-3.0 * 1.5**2 * aside + 0.2 * 2.0**2 * tangent), rel=1e-12)


def test_drag_of_the_body_is_the_same_in_every_direction():
    for angle in (0.0, 0.4, 1.9):
        u = 1.3 * np.array([np.cos(angle), np.sin(angle)])
        force, _ = body_drag(5.0, tuple(u))
        assert force == pytest.approx(-5.0 * 1.3 * u, rel=1e-12)


def test_a_body_in_water_swings_with_its_added_mass_and_its_wet_weight():
    # light cable: omega^2 = (M - rho V) g / ((M + m_a) L)
    model = make(
        WIRE, cable__length=10.0, cable__mass_per_length=1e-3, cable__diameter=1e-3, cable__normal_drag_coefficient=0.0,
        body__drag_area=0.0, solver__nodes=5, solver__time_step=0.02,
    )  # fmt: skip
    push = swing((0.02, 0.0, 0.0), 2.0 * np.pi / 6.0, ramp_time=6.0)

    def once(t: float) -> np.ndarray:
        return push(t) if t < 6.0 else push(6.0) * [1, 0, 0, 0, 0, 0, 0, 0, 0]

    run = drive(model, every(0.02, 100.0), once)
    later = run["time"] > 8.0
    x, t = run["body.x"][later], run["time"][later]
    up = np.flatnonzero((x[:-1] < 0.0) & (x[1:] >= 0.0))
    crossings = t[up] - x[up] * 0.02 / (x[up + 1] - x[up])
    found = 2.0 * np.pi * (len(crossings) - 1) / (crossings[-1] - crossings[0])
    assert found == pytest.approx(np.sqrt((1000.0 - 1025.0 * 0.4) * 9.80665 / (1400.0 * 10.0)), rel=1e-3)


def test_a_body_let_down_slowly_trails_behind_a_steady_tow_like_in_a_current():
    # the same speed reached by moving the top and by moving the water
    speed = 1.0

    def tow(t: float) -> np.ndarray:
        s = min(t / 60.0, 1.0)
        x = speed * (60.0 * s**4 * (2.5 - 3.0 * s + s * s) if s < 1.0 else t - 30.0)
        v = speed * s**3 * (10.0 - 15.0 * s + 6.0 * s * s)
        return np.array([x, 0.0, 0.0, v, 0.0, 0.0, speed * 30.0 * (s * (1.0 - s)) ** 2 / 60.0, 0.0, 0.0])

    towed = make(WIRE, solver__time_step=0.5)
    drive(towed, every(0.5, 600.0), tow)
    trailed = make(WIRE, current__speed=-speed)
    trailed.initialize(np.zeros(9))
    assert towed.positions()[0, 0] - tow(600.0)[0] == pytest.approx(trailed.positions()[0, 0], rel=2e-3)
    # one body, no cable to speak of: tan of the angle is drag over wet weight
    alone = make(WIRE, current__speed=-speed, cable__mass_per_length=1e-3, cable__diameter=1e-6)
    alone.initialize(np.zeros(9))
    angle = brentq(lambda a: np.tan(a) - 0.5 * 1025.0 * speed**2 / ((1000.0 - 410.0) * 9.80665), 0.0, 1.5)
    assert alone.outputs[4] == pytest.approx(angle, rel=1e-3)
