"""A taut cable has the axial damping that its scene says and no other: the damping of the slack law ends where a cell is taut."""

import numpy as np
import pytest
from chain_support import WIRE, drive, every, make, observed_orders, still, swing, view
from scipy.optimize import minimize_scalar

from cable_model import scene
from cable_model.cable_chain import CableChain
from cable_model.kernels.slack import FADED, fading
from cable_model.simulation import simulate

HUNG_IN_AIR = {
    "cable": {"length": 300.0, "mass_per_length": 3.0, "axial_stiffness": 5e7},
    "solver": {"nodes": 51, "grading": 1.0, "lambda_infinity": -1.0},
}
CRANE_WIRE = {  # 3000 m with 20 t, in air
    "cable": {"length": 3000.0, "mass_per_length": 20.0, "axial_stiffness": 3e8, "axial_damping": 4e6},
    "body": {"mass": 20e3},
    "solver": {"nodes": 51, "lambda_infinity": -1.0},
}
MOORING = {  # 33 m of chain between two points, sagging freely
    "cable": {
        "length": 33.0, "mass_per_length": 0.0818, "axial_stiffness": 2e3, "diameter": 0.0022, "normal_drag_coefficient": 2.5,
        "tangential_drag_coefficient": 0.5, "added_mass_coefficient": 2.8,
    },
    "lower_end": {"anchored": True},
    "water": {"density": 1000.0},
    "solver": {"nodes": 51, "time_step": 0.05, "lambda_infinity": -0.5},
}  # fmt: skip


def amplitude(times: np.ndarray, series: np.ndarray, omega: float) -> float:
    """Amplitude at omega by least squares."""
    columns = np.column_stack([np.cos(omega * times), np.sin(omega * times), np.ones(len(times))])
    return float(np.hypot(*np.linalg.lstsq(columns, series, rcond=None)[0][:2]))


def test_the_share_of_the_slack_damping_falls_smoothly_from_all_to_none():
    below = 50.0
    tensions = np.linspace(-5.0, 15.0, 2001)
    share = np.array([fading(True, t, below) for t in tensions])
    assert (share[tensions <= 0.0] == 1.0).all()
    assert (share[tensions >= FADED * below] == 0.0).all()
    assert (np.diff(share) <= 0.0).all()
    assert share[tensions == 0.5 * FADED * below] == pytest.approx(0.5)
    assert fading(None, -1.0, below) == 0.0


def test_an_axial_vibration_of_a_taut_wire_keeps_its_amplitude_over_50_periods():
    speed = np.sqrt(5e7 / 3.0)
    omega = 0.5 * np.pi * speed / 300.0  # free below, held above
    period = 2.0 * np.pi / omega
    step = period / 80.0
    model = make(HUNG_IN_AIR, solver__time_step=step)
    model.initialize(still()(0.0))
    now = view(model)
    now.y[51:, 1] = 0.1 * np.cos(0.5 * np.pi * np.linspace(0.0, 1.0, 51))
    heights = []
    for k in range(50 * 80):
        model.advance(k * step, step, still()(0.0), still()(0.0))
        heights.append(model.outputs[7])
    times = step * np.arange(1, 50 * 80 + 1)
    first = amplitude(times[:80], np.array(heights[:80]), omega)
    last = amplitude(times[-80:], np.array(heights[-80:]), omega)
    assert first == pytest.approx(0.1 / omega, rel=2e-3)
    assert last == pytest.approx(first, rel=1e-3)


def force_per_heave(omega: float) -> float:
    """Amplitude of the top's force per amplitude of its heave, N/m: a linear Kelvin-Voigt bar with a mass M below.

    m u_tt = E u_ss, E = EA + i omega C, M u_tt = E u_s at s = 0: u = cos(k s) - (M omega^2/(E k)) sin(k s), k = omega sqrt(m/E).
    """
    cable, mass = CRANE_WIRE["cable"], CRANE_WIRE["body"]["mass"]
    stiffness = cable["axial_stiffness"] + 1j * omega * cable["axial_damping"]
    k = omega * np.sqrt(cable["mass_per_length"] / stiffness)
    ratio, end = mass * omega**2 / (stiffness * k), k * cable["length"]
    motion = np.cos(end) - ratio * np.sin(end)
    force = stiffness * k * (-np.sin(end) - ratio * np.cos(end))
    return float(abs(force / motion))


def test_a_wire_at_its_axial_resonance_pulls_as_its_own_damping_allows():
    omega = minimize_scalar(lambda w: -force_per_heave(w), bounds=(1.0, 2.2), method="bounded", options={"xatol": 1e-10}).x
    step, heave = 2.0 * np.pi / omega / 100.0, 0.01
    periods = 250
    series = drive(
        make(CRANE_WIRE, solver__time_step=step),
        every(step, periods * 100 * step),
        swing((0.0, 0.0, heave), omega, ramp_time=10.0),
    )
    late = slice(-1000, None)
    found = amplitude(series["time"][late], series["top.force_z"][late], omega)
    assert found == pytest.approx(heave * force_per_heave(omega), rel=3e-3)


def test_a_moving_wire_is_of_second_order_in_the_length_of_its_cells():
    motion = swing((0.5, 0.0, 0.5), 2.0 * np.pi / 8.0, ramp_time=8.0, phase=(0.0, 0.0, np.pi / 2.0))
    for name in ("top.tension", "body.z"):
        answers = []
        for nodes in (26, 51, 101, 201):
            model = make(WIRE, solver__nodes=nodes, cable__axial_stiffness=1e6)
            answers.append(drive(model, every(0.05, 12.0), motion)[name])
        assert observed_orders(answers)[-1] == pytest.approx(2.0, abs=0.1), name


def test_a_moving_mooring_is_of_second_order_in_the_length_of_its_cells():
    sway = swing((0.3, 0.0, 0.2), 2.0, ramp_time=4.0, phase=(0.0, 0.0, np.pi / 2.0))

    def motion(t: float) -> np.ndarray:
        return sway(t) + np.array([31.5, 0.0, 5.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0])

    answers = []
    for nodes in (26, 51, 101, 201):
        answers.append(drive(make(MOORING, solver__nodes=nodes), every(0.05, 8.0), motion)["top.tension"])
    assert observed_orders(answers)[-1] == pytest.approx(2.0, abs=0.1)


@pytest.mark.parametrize("damping", [1e6, 0.0])
def test_a_load_that_snaps_every_4_s_is_simulated_without_the_damping_of_a_taut_wire(damping):
    heave = {"kind": "sinusoid", "axis": "z", "amplitude": 3.0, "angular_frequency": 0.5 * np.pi, "ramp_time": 4.0}
    values = {
        "solver.nodes": 51, "solver.time_step": 0.01, "top.motion": [heave], "run.duration": 30.0, "run.output_step": 0.01,
        "cable.axial_damping": damping,
    }  # fmt: skip
    series = simulate(CableChain(scene.with_values(scene.load("hard/snap"), values)))
    assert series["time"][-1] == pytest.approx(30.0)
    assert series["solver.rejected_steps"][-1] == 0.0
    assert series["solver.newton_iterations"][-1] < 6.0 * series["solver.steps"][-1]
    assert np.max(series["cable.slack_fraction"]) > 0.9
