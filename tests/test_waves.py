"""The waves: dispersion, potential flow, surface, and the models that feel them."""

import math

import numpy as np
import pytest
from chain_support import WIRE, drive, every, make, still

from cable_model import scene
from cable_model.effects import Parts
from cable_model.errors import ParameterError
from cable_model.kernels.waves import elevation, wave_motion
from cable_model.parameters import Waves
from cable_model.sea import components, table_of, wave_number
from cable_model.simulated import parts_of
from cable_model.tow_cable import TowCable

G = 9.81
KINDS = {"held": {}, "wheeler": {"stretched": True}, "cut": {"cut": True}}


def sea(depth: float, **kinds: bool) -> Parts:
    rows = [(0.8, 1.1, 0.6, 0.3), (0.3, 2.0, -1.0, 2.0)]
    table = table_of(np.array([[a, w, wave_number(w, depth, G), d, p, depth] for a, w, d, p in rows]))
    return Parts(waves=table, finite_depth=True if depth > 0.0 else None, **kinds)


@pytest.mark.parametrize("depth", [0.1, 1.0, 5.0, 30.0, 1e3, 0.0])
@pytest.mark.parametrize("omega", [0.05, 0.5, 1.5, 6.0])
def test_wave_numbers_obey_the_dispersion_relation(depth, omega):
    k = wave_number(omega, depth, G)
    assert G * k * (math.tanh(k * depth) if depth else 1.0) == pytest.approx(omega**2, rel=4e-15)


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("depth", [0.0, 12.0])
@pytest.mark.parametrize("z", [-4.0, -0.3, 0.55])
def test_gradient_and_acceleration_are_derivatives_of_the_velocity(kind, depth, z):
    parts, place, t, h = sea(depth, **KINDS[kind]), np.array([2.0, -1.0, z]), 1.7, 1e-6
    if kind == "cut" and z > 0.0:
        surface = elevation(parts.waves, None, tuple(place), t)[0]
        place[2] = surface + 0.03  # in the taper of 0.05 * 1.1 m
    _, acceleration, gradient = wave_motion(parts, tuple(place), t)

    def velocity(at: np.ndarray, time: float) -> np.ndarray:
        return np.array(wave_motion(parts, tuple(at), time)[0])

    columns = [(velocity(place + h * e, t) - velocity(place - h * e, t)) / (2.0 * h) for e in np.eye(3)]
    assert np.reshape(gradient, (3, 3)) == pytest.approx(np.array(columns).T, abs=3e-8)
    if kind != "cut":  # what is cut off follows the surface: its share in the acceleration is left out
        assert acceleration == pytest.approx((velocity(place, t + h) - velocity(place, t - h)) / (2.0 * h), abs=1e-8)


@pytest.mark.parametrize("depth", [0.0, 3.0])
def test_the_flow_is_a_potential_flow_over_an_impermeable_bottom(depth):
    parts = sea(depth)
    _, _, gradient = wave_motion(parts, (2.0, -1.0, -1.3), 0.4)
    matrix = np.reshape(gradient, (3, 3))
    assert np.trace(matrix) == pytest.approx(0.0, abs=1e-13)
    assert matrix == pytest.approx(matrix.T, abs=1e-13)
    if depth:
        assert wave_motion(parts, (2.0, -1.0, -depth), 0.4)[0][2] == pytest.approx(0.0, abs=1e-15)


@pytest.mark.parametrize("depth", [0.0, 3.0])
def test_the_surface_rises_as_the_water_there_does(depth):
    parts = sea(depth)
    _, rate, _ = elevation(parts.waves, None, (2.0, -1.0, 0.0), 0.4)
    assert wave_motion(parts, (2.0, -1.0, 0.0), 0.4)[0][2] == pytest.approx(rate, rel=1e-12)


def test_in_great_depth_waves_are_those_of_deep_water():
    for a, b in zip(wave_motion(sea(0.0), (2.0, -1.0, -3.0), 0.4), wave_motion(sea(500.0), (2.0, -1.0, -3.0), 0.4), strict=True):
        assert a == pytest.approx(b, rel=1e-12)


def test_stretched_waves_have_at_the_surface_what_held_ones_have_at_still_water():
    for depth in (0.0, 12.0):
        parts = sea(depth, stretched=True)
        surface = elevation(parts.waves, None, (2.0, -1.0, 0.0), 0.4)[0]
        at_surface = wave_motion(parts, (2.0, -1.0, surface - 1e-12), 0.4)[0]
        assert at_surface == pytest.approx(wave_motion(sea(depth), (2.0, -1.0, 0.0), 0.4)[0], rel=1e-9)
        if depth:
            assert wave_motion(parts, (2.0, -1.0, -depth), 0.4)[0][2] == pytest.approx(0.0, abs=1e-14)


def test_cut_waves_end_at_the_surface():
    parts = sea(0.0, cut=True)
    surface = elevation(parts.waves, None, (2.0, -1.0, 0.0), 0.4)[0]
    assert wave_motion(parts, (2.0, -1.0, surface + 0.06), 0.4)[0] == (0.0, 0.0, 0.0)
    assert wave_motion(parts, (2.0, -1.0, surface - 1e-9), 0.4)[0] == wave_motion(sea(0.0), (2.0, -1.0, surface - 1e-9), 0.4)[0]


def test_a_table_of_one_row_is_the_regular_wave():
    runs = []
    for waves in ({"amplitude": 1.0, "period": 8.0, "phase": 0.4}, {"table": [[1.0, 8.0, 0.0, 0.4]]}):
        base = {**WIRE, "waves": waves}
        runs.append(drive(make(base), every(0.05, 2.0), still()))
    assert np.array_equal(runs[0]["top.tension"], runs[1]["top.tension"])


@pytest.mark.parametrize(
    "surface", [pytest.param("held", marks=pytest.mark.long), "wheeler", pytest.param("cut", marks=pytest.mark.long)]
)  # each compiles
def test_a_wire_in_an_irregular_sea_takes_three_iterations_a_step_at_most(surface):
    waves = {"spectrum": "jonswap", "significant_height": 3.0, "peak_period": 9.0, "components": 20, "surface": surface}
    model = make({**WIRE, "waves": waves, "water": {"density": 1025.0, "depth": 250.0}})
    run = drive(model, every(0.05, 10.0), still((0.0, 0.0, 2.0)))
    assert run["solver.newton_iterations"][-1] <= 3.0 * run["solver.steps"][-1]
    assert np.std(run["body.x"]) > 0.0


def test_tow_cable_feels_the_irregular_sea():
    waves = {"spectrum": "pierson-moskowitz", "significant_height": 3.0, "peak_period": 9.0}
    model = TowCable(scene.from_dict({**WIRE, "cable": {**WIRE["cable"], "length": 20.0}, "waves": waves}))
    model.initialize(np.zeros(9))
    for k in range(100):
        model.advance(0.1 * k, 0.1, np.zeros(9), np.zeros(9))
    assert abs(model.outputs[5]) > 1e-3


@pytest.mark.parametrize(
    ("changes", "text"),
    [
        ({"waves": {"spectrum": "jonswap"}},
         "waves.significant_height = 0 m: must be > 0 with a spectrum. Give the significant wave height."),
        ({"waves": {"spectrum": "jonswap", "significant_height": 2.0, "amplitude": 1.0}},
         "waves = 2 kinds: must be one of amplitude, spectrum, table and record. Keep one of them."),
        ({"waves": {"table": [[1.0, 0.0, 0.0, 0.0]]}},
         "waves.table[0] = '1 m, 0 s': must be an amplitude >= 0 and a period > 0. Mend the row."),
        ({"waves": {"table": [[1.0, 5.0, 0.7, 0.0]]}},
         "waves.table[0] = 0.7 rad: must be 0 or pi in the plane. Set solver.space = true, or turn the axes so that x is along it."),
        ({"waves": {"spectrum": "jonswap", "significant_height": 2.0}, "water": {"density": 0.0}},
         "waves.spectrum = 'jonswap': must be none without water. Add [water] or remove [waves]."),
    ],
)  # fmt: skip
def test_seas_that_are_none_are_refused(changes, text):
    with pytest.raises(ParameterError) as error:
        scene.from_dict({**WIRE, **changes})
    assert str(error.value) == text


def test_absent_parts_of_the_sea_are_absent():
    parts = parts_of(scene.from_dict({**WIRE, "waves": {"amplitude": 1.0}}), "chain")
    assert parts.finite_depth is None and parts.stretched is None and parts.cut is None


def direct(rows: np.ndarray, place: np.ndarray, t: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Velocity, acceleration and gradient (3, 3) of linear waves at z <= 0, by numpy's functions."""
    a, omega, k, direction, phase, depth = rows.T
    angle = k * (place[0] * np.cos(direction) + place[1] * np.sin(direction)) - omega * t + phase
    if depth[0] > 0.0:
        across = np.exp(k * place[2]) * (1.0 + np.exp(-2.0 * k * (place[2] + depth))) / (1.0 - np.exp(-2.0 * k * depth))
        rise = np.exp(k * place[2]) * (1.0 - np.exp(-2.0 * k * (place[2] + depth))) / (1.0 - np.exp(-2.0 * k * depth))
    else:
        across = rise = np.exp(k * place[2])
    along = np.array([np.cos(direction), np.sin(direction)])
    c, s = a * omega * np.cos(angle), a * omega * np.sin(angle)
    velocity = np.array([*(along @ (across * c)), np.sum(rise * s)])
    rate = np.array([*(along @ (omega * across * s)), -np.sum(omega * rise * c)])
    gradient = np.zeros((3, 3))
    gradient[:2, :2] = -np.einsum("ij,kj,j->ik", along, along, k * across * s)
    gradient[2, :2] = gradient[:2, 2] = along @ (k * rise * c)
    gradient[2, 2] = np.sum(k * across * s)
    return velocity, rate, gradient


@pytest.mark.parametrize("depth", [0.0, 60.0])
@pytest.mark.parametrize("space", [False, True])
def test_a_sea_is_the_sum_of_its_components(space, depth):
    """Velocity, acceleration and gradient, near the surface and where most components are no longer felt, early and after three hours."""
    given = Waves(spectrum="jonswap", significant_height=3.0, peak_period=9.0, components=200, spreading_exponent=4.0 if space else 0.0)
    rows = components(given, G, depth)
    scales = [math.sqrt(np.sum((rows[:, 0] * rows[:, 1] * factor) ** 2)) for factor in (1.0, rows[:, 1], rows[:, 2])]
    parts = Parts(waves=table_of(rows), finite_depth=True if depth else None)
    axes = [0, 1, 2] if space else [0, 2]
    rng = np.random.default_rng(4)
    for _ in range(60):
        place = np.array([rng.uniform(-500.0, 500.0), rng.uniform(-500.0, 500.0) if space else 0.0, -55.0 * rng.uniform() ** 2])
        t = rng.choice([rng.uniform(0.0, 100.0), rng.uniform(1e4, 1.1e4)])
        found = wave_motion(parts, tuple(float(place[k]) for k in axes), float(t))
        velocity, rate, gradient = direct(rows, place, t)
        right = (velocity[axes], rate[axes], gradient[np.ix_(axes, axes)].ravel())
        for value, expected, size in zip(found, right, scales, strict=True):
            assert np.array(value) == pytest.approx(expected, abs=1e-8 * size)


@pytest.mark.parametrize("z", [-200.0, -700.0, -1500.0])
def test_a_component_that_is_not_felt_is_left_out(z):
    rows = components(Waves(spectrum="jonswap", significant_height=3.0, peak_period=9.0, components=200), G, 0.0)
    found = wave_motion(Parts(waves=table_of(rows)), (3.0, z), 5.0)
    velocity, rate, _ = direct(rows, np.array([3.0, 0.0, z]), 5.0)
    scale_u = math.sqrt(np.sum((rows[:, 0] * rows[:, 1]) ** 2))
    assert np.array(found[0]) == pytest.approx(velocity[[0, 2]], abs=3e-9 * scale_u)
    assert np.array(found[1]) == pytest.approx(rate[[0, 2]], abs=3e-9 * scale_u)
