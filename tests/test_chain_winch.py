"""Paying out and hauling in: closed forms, the energy balance of a cable of changing length, and refusals."""

import numpy as np
import pytest
from chain_support import drive, every, kinetic_matrix, make, still, view
from scipy.integrate import cumulative_trapezoid, solve_ivp

from cable_model import scene
from cable_model.errors import ParameterError, SolverError
from cable_model.kernels import header
from cable_model.simulation import simulate
from cable_model.tow_cable import TowCable

LOAD = {
    "cable": {"length": 50.0, "mass_per_length": 2.0, "axial_stiffness": 1e8},
    "body": {"mass": 100.0},
    "environment": {"gravity": 9.81},
    "winch": {"fitted": True},
    "solver": {"nodes": 11, "time_step": 0.02},
}


def speed(t: float) -> float:
    """Rises smoothly to 1 m/s within 4 s."""
    s = min(t / 4.0, 1.0)
    return s**3 * (10.0 - 15.0 * s + 6.0 * s**2)


def acceleration(t: float) -> float:
    s = min(t / 4.0, 1.0)
    return 7.5 * s**2 * (1.0 - s) ** 2


def paid_out(t: float) -> float:
    s = min(t / 4.0, 1.0)
    return 4.0 * (2.5 * s**4 - 3.0 * s**5 + s**6) + max(t - 4.0, 0.0)


def winding(scale: float = 1.0):
    def motion(t: float) -> np.ndarray:
        state = np.zeros(10)
        state[9] = scale * speed(t)
        return state

    return motion


def test_a_lowered_load_weighs_less_by_its_acceleration():
    # the whole cable below the winch moves down at the winch's speed: T = (M + m L(t)) (g - a)
    series = drive(make(LOAD, solver__time_step=0.005), every(0.005, 6.0), winding())
    times = series["time"]
    weight = (100.0 + 2.0 * (50.0 + np.array([paid_out(t) for t in times]))) * (9.81 - np.array([acceleration(t) for t in times]))
    assert series["top.tension"] == pytest.approx(weight, rel=1e-3)
    assert series["body.z"] == pytest.approx(-50.0 - np.array([paid_out(t) for t in times]), abs=2e-3)
    assert series["body.vz"] == pytest.approx(-np.array([speed(t) for t in times]), abs=2e-3)


def pendulum(t: float, y: np.ndarray, rate: float) -> list[float]:
    angle, turning, length = y
    return [turning, -(2.0 * rate * speed(t) * turning + 9.81 * np.sin(angle)) / length, rate * speed(t)]


@pytest.mark.parametrize("rate", [0.4, -0.4])
def test_a_pendulum_of_changing_length_swings_as_its_equation_says(rate):
    model = make(
        LOAD, cable__length=5.0, cable__mass_per_length=1e-4, cable__axial_stiffness=1e7, solver__nodes=5, solver__time_step=0.005,
        lower_end__release_force=200.0,
    )  # fmt: skip
    model.initialize(np.zeros(10))
    start = np.arctan2(model.outputs[5], -model.outputs[7])
    series = drive(model, every(0.005, 7.0), winding(rate))
    exact = solve_ivp(pendulum, (0.0, 7.0), [start, 0.0, 5.0], args=(rate,), rtol=1e-10, atol=1e-12, t_eval=series["time"])
    angle, _, length = exact.y
    assert series["body.x"] == pytest.approx(length * np.sin(angle), abs=2e-3 * np.ptp(series["body.x"]))
    assert series["body.z"] == pytest.approx(-length * np.cos(angle), abs=5e-3)


def energies(model, length: float) -> float:
    """Kinetic, potential and strain energy of the material, from its own velocity v - s (L'/L) q."""
    now, table = view(model), model.scene
    h, split = now.mesh[:, 0], now.mesh[:, 1]
    n = len(h) + 1
    q, v = now.y[: n - 1], now.y[n:].copy()
    rate = model.state[header.WINCH_SPEED] / length
    s = np.concatenate(([0.0], np.cumsum(h)))
    tangent = np.vstack((q[:1], 0.5 * (q[1:] + q[:-1]), q[-1:] + 0.5 * (q[-1:] - q[-2:-1])))
    v -= rate * s[:, None] * tangent
    z = model.positions()[:, 2]
    m = table.cable.mass_per_length
    kinetic = 0.5 * m * np.sum(v * (kinetic_matrix(h, split) @ v))
    potential = m * 9.81 * np.sum(h * (split * z[:-1] + (1.0 - split) * z[1:]))
    strain = 0.5 * table.cable.axial_stiffness * np.sum(h * (np.linalg.norm(q, axis=1) - 1.0) ** 2)
    return float(kinetic + potential + strain)


def test_the_energy_of_a_swinging_chain_that_is_paid_out_balances():
    """dE/dt = power of the top on the material there, plus the energy that comes in with the new cable; after the shock of the release."""
    residues = []
    for nodes, h in ((41, 0.01), (81, 0.01)):
        model = make(
            LOAD, cable__length=10.0, cable__axial_stiffness=1e5, body__mass=0.0, solver__nodes=nodes, solver__time_step=h,
            solver__lambda_infinity=-1.0, lower_end__release_force=150.0, solver__slack_damping=0.0, solver__grading=1.0,
        )  # fmt: skip
        rate = 0.5
        model.initialize(np.zeros(10))
        stored, powers = [energies(model, 10.0)], []
        motion = winding(rate)
        for k in range(round(4.0 / h)):
            model.advance(k * h, h, motion(k * h), motion(k * h + h))
            length = 10.0 + rate * paid_out(k * h + h)
            stored.append(energies(model, length))
            q = view(model).y[nodes - 2]
            slide = rate * speed(k * h + h)
            material = -slide * q  # velocity of the cable at the still top
            flow = slide * (0.5 * 2.0 * material @ material + 0.5 * 1e5 * (np.linalg.norm(q) - 1.0) ** 2)  # z = 0 there
            force = -np.array([model.outputs[0], model.outputs[2]])  # on the cable
            powers.append(force @ material + flow)
        calm = round(1.0 / h)
        gained = np.array(stored[1:])[calm:] - stored[1 + calm]
        worked = cumulative_trapezoid(np.array(powers)[calm:], dx=h, initial=0.0)
        residues.append(np.abs(gained - worked).max() / np.abs(worked).max())
    assert residues[1] < 2e-3


def test_a_mooring_that_is_paid_out_comes_to_rest_as_a_longer_one():
    base = {
        "cable": {"length": 33.0, "mass_per_length": 0.08, "axial_stiffness": 1e4, "diameter": 0.0022, "normal_drag_coefficient": 2.5,
                  "axial_damping": 100.0},  # else nothing ends its axial vibration
        "lower_end": {"anchored": True, "z": -3.0},
        "water": {"density": 1000.0},
        "seabed": {"level": -3.0, "stiffness": 1e7, "damping_ratio": 1.0},
        "winch": {"fitted": True, "speeds": [[0.0, 0.0], [1.0, 0.1], [5.0, 0.1], [6.0, 0.0]]},
        "top": {"position": [32.4, 0.0, 0.0]},
        "solver": {"nodes": 41, "time_step": 0.02, "lambda_infinity": -0.5},
        "run": {"duration": 40.0, "output_step": 0.1},
    }  # fmt: skip
    wound = simulate(make(base))
    longer = make(base, cable__length=33.5, winch__fitted=False, winch__speeds=[])
    longer.initialize(still((32.4, 0.0, 0.0))(0.0))
    assert wound["winch.speed"].max() == pytest.approx(0.1)
    assert wound["top.tension"][-1] == pytest.approx(longer.outputs[3], rel=2e-3)
    assert wound["body.tension"][-1] == pytest.approx(longer.outputs[11], rel=2e-3)


def test_a_winch_that_stands_still_changes_nothing_but_rounding():
    def swing(t: float) -> np.ndarray:
        return np.array([0.1 * np.sin(2 * t) ** 2, 0, 0, 0.2 * np.sin(4 * t), 0, 0, 0.8 * np.cos(4 * t), 0, 0, 0.0])

    with_it = drive(make(LOAD), every(0.02, 3.0), swing)
    without = drive(make(LOAD, winch__fitted=False), every(0.02, 3.0), swing)
    assert with_it["top.tension"] == pytest.approx(without["top.tension"], rel=1e-9)
    assert with_it["body.x"] == pytest.approx(without["body.x"], abs=1e-9)


def test_held_inputs_wind_at_second_order_in_the_communication_step():
    ends = []
    for step in (0.4, 0.2, 0.1):
        model = make(LOAD)
        model.initialize(np.zeros(10))
        for k in range(round(6.0 / step)):
            inputs = np.zeros(10)
            inputs[9] = speed(k * step)
            model.step(k * step, step, inputs)
        ends.append(model.outputs[7] + 50.0 + paid_out(6.0))
    assert abs(ends[2]) < 0.02
    assert abs(ends[1] - ends[2]) < 0.35 * abs(ends[0] - ends[1])


def test_what_winches_cannot_do_is_refused():
    with pytest.raises(ParameterError, match=r"winch.fitted = True: must be false on the box grid."):
        make(LOAD, solver__grid="box")
    with pytest.raises(ParameterError, match=r"winch.speeds = 2 rows: must be empty without a winch. Set winch.fitted = true."):
        make(LOAD, winch__fitted=False, winch__speeds=[[0.0, 0.0], [1.0, 1.0]])
    turning = np.zeros(10)
    turning[9] = 0.5
    fixed = make(LOAD, winch__fitted=False)
    tow = TowCable(scene.with_values(scene.from_dict({**LOAD, "winch": {}}), {"body.mass": 100.0}))
    for model in (fixed, tow):
        model.initialize(np.zeros(10))
        with pytest.raises(
            SolverError, match=r"the winch turned, but the cable has none. Leave winch.speed at 0, or set winch.fitted = true"
        ):
            model.step(0.0, 0.1, turning)
    hauled = make(LOAD)
    hauled.initialize(np.zeros(10))
    turning[9] = -1000.0
    with pytest.raises(SolverError, match="the winch hauled in the whole cable"):
        hauled.advance(0.0, 0.1, turning, turning)
