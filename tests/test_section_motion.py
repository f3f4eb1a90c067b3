"""Motion of a cable in sections and with bodies on it: pulses at joints and beads, a body at mid-length, error control."""

from __future__ import annotations

import itertools

import numpy as np
import pytest
from chain_support import Motion, drive, every, make, swing, view
from scipy.integrate import solve_ivp
from sections_support import CLUMP, DENSITY, GRAVITY, ROPE, WET, WIRE


def pulse(size: float, duration: float, axis: int) -> Motion:
    """A top that goes aside and back, with three continuous derivatives."""

    def motion(t: float) -> np.ndarray:
        state, s = np.zeros(9), t / duration
        if 0.0 < s < 1.0:
            b, c = s * (1.0 - s), 1.0 - 2.0 * s
            state[axis] = 256.0 * size * b**4
            state[3 + axis] = 1024.0 * size * b**3 * c / duration
            state[6 + axis] = 256.0 * size * (12.0 * b * b * c * c - 8.0 * b**3) / duration**2
        return state

    return motion


TAUT, EA = 1e4, 1e7  # N


def field(cable: dict, nodes: int, fastest: float, length: float, duration: float, motion: Motion, axis: int):
    """Displacements of the nodes of a taut cable, 100 m long, and their arc lengths, after a motion of its top."""
    base = {
        "cable": {**cable, "compressible": True}, "lower_end": {"anchored": True, "z": -length}, "environment": {"gravity": 0.0},
        "solver": {"nodes": nodes, "lambda_infinity": -0.9},
    }  # fmt: skip
    count = int(np.ceil(duration / (50.0 / (nodes - 1) / fastest)))
    step = duration / count
    model = make(base, solver__time_step=1.0001 * step)
    model.initialize(motion(0.0))
    before = model.positions()
    for k in range(count):
        model.advance(k * step, step, motion(k * step), motion((k + 1) * step))
    return (model.positions() - before)[:, axis], np.concatenate([[0.0], np.cumsum(view(model).mesh[:, 0])])


@pytest.mark.parametrize(
    ("mass", "stiffer", "axis"), [(4.0, 1.0, 0), (1.0 / 9.0, 1.0, 0), (4.0, 0.25, 2), (1.0, 10.0, 2)],
    ids=["across, heavy", "across, light", "along, heavy and soft", "along, stiff"],
)  # fmt: skip
def test_a_pulse_goes_on_and_back_at_a_joint_as_the_impedances_say(mass, stiffer, axis):
    """Reflected (Z2 - Z1)/(Z2 + Z1) and passed on 2 Z2/(Z1 + Z2), Z = sqrt(T m) across the cable and sqrt(EA m) along it."""
    lower = TAUT / (1.0 + TAUT / (EA * stiffer)) if axis == 0 else EA * stiffer
    upper = TAUT / (1.0 + TAUT / EA) if axis == 0 else EA
    slow, fast = np.sqrt(lower / mass), np.sqrt(upper)
    z1, z2 = np.sqrt(lower * mass), np.sqrt(upper)
    fastest = max(slow, fast)
    motion, duration = pulse(1e-3, 30.0 / fastest, axis), 50.0 / fast + 45.0 / fastest
    cable = {
        "section": [
            {"length": 50.0, "mass_per_length": mass, "axial_stiffness": EA * stiffer},
            {"length": 50.0, "mass_per_length": 1.0, "axial_stiffness": EA},
        ]
    }
    errors = []
    for nodes in (101, 201):
        length = 50.0 * (2.0 + TAUT / EA + TAUT / (EA * stiffer))
        moved, arcs = field(cable, nodes, fastest, length, duration, motion, axis)
        at_joint = duration - 50.0 / fast

        def expected(s: float, at_joint: float = at_joint) -> float:
            if s < 50.0:
                return 2.0 * z2 / (z1 + z2) * motion(at_joint - (50.0 - s) / slow)[axis]
            back = (z2 - z1) / (z2 + z1) * motion(at_joint - (s - 50.0) / fast)[axis]
            return motion(duration - (100.0 - s) / fast)[axis] + back

        errors.append(np.abs(moved - [expected(s) for s in arcs]).max() / 1e-3)
    assert errors[0] < 0.08 and np.log2(errors[0] / errors[1]) > 1.9


@pytest.mark.parametrize("mass", [2.0, 20.0])
def test_a_pulse_goes_past_a_bead_as_its_inertia_says(mass):
    """M y'' = 2 Z (g' - y') for a string of impedance Z on either side, on which g comes in."""
    pull = TAUT / (1.0 + TAUT / EA)
    speed, z = np.sqrt(pull), np.sqrt(pull)
    motion, duration = pulse(1e-3, 20.0 / speed, 0), 95.0 / speed
    late = 50.0 / speed
    solved = solve_ivp(
        lambda t, y: [y[1], 2.0 * z / mass * (motion(t - late)[3] - y[1])], (0.0, duration), [0.0, 0.0], rtol=1e-10, atol=1e-14,
        dense_output=True, max_step=0.4 / speed,
    )  # fmt: skip

    def bead(t: float) -> float:
        return solved.sol(t)[0] if t > 0.0 else 0.0

    def expected(s: float) -> float:
        if s < 50.0:
            return bead(duration - (50.0 - s) / speed)
        there = duration - (s - 50.0) / speed
        return motion(duration - (100.0 - s) / speed)[0] + bead(there) - motion(there - late)[0]

    errors = []
    cable = {"length": 100.0, "mass_per_length": 1.0, "axial_stiffness": EA, "body": [{"at": 50.0, "mass": mass}]}
    for nodes in (101, 201):
        moved, arcs = field(cable, nodes, speed, 100.0 * (1.0 + TAUT / EA), duration, motion, 0)
        errors.append(np.abs(moved - [expected(s) for s in arcs]).max() / 1e-3)
    assert errors[0] < 0.08 and np.log2(errors[0] / errors[1]) > 1.9


def two_segments(lengths, bodies, top: Motion, times: np.ndarray) -> np.ndarray:
    """Places (times, 2, 2), x and z, of bodies on two straight massless segments under a moved top, from rest straight down.

    By Lagrange with the angles theta of both segments from straight down: r_i = r_top + sum_(j <= i) l_j (sin theta_j, -cos theta_j), and
    sum_i (m_i + m_a,i) a_i . dr_i/dtheta_j = sum_i F_i . dr_i/dtheta_j with weight in water and drag of each body in water at rest.
    """
    masses = np.array([body["mass"] + body["added_mass"] for body in bodies])
    drags = np.array([0.5 * DENSITY * body["drag_area"] for body in bodies])
    loads = np.array([-(body["mass"] - DENSITY * body["volume"]) * GRAVITY for body in bodies])

    def along(theta: np.ndarray) -> np.ndarray:
        """l_j (cos theta_j, sin theta_j): derivatives of all places below joint j."""
        return lengths[:, None] * np.column_stack((np.cos(theta), np.sin(theta)))

    def rates(t: float, state: np.ndarray) -> np.ndarray:
        theta, omega = state[:2], state[2:]
        at = top(t)
        turn, toward = along(theta), lengths[:, None] * np.column_stack((-np.sin(theta), np.cos(theta)))
        matrix, right = np.zeros((2, 2)), np.zeros(2)
        for i in range(2):
            v = at[[3, 5]] + omega[: i + 1] @ turn[: i + 1]
            force = -drags[i] * np.linalg.norm(v) * v + (0.0, loads[i])
            force = force - masses[i] * (at[[6, 8]] + omega[: i + 1] ** 2 @ toward[: i + 1])
            for j in range(i + 1):
                right[j] += force @ turn[j]
                for k in range(i + 1):
                    matrix[j, k] += masses[i] * turn[j] @ turn[k]
        return np.concatenate([omega, np.linalg.solve(matrix, right)])

    angles = solve_ivp(rates, (0.0, times[-1]), np.zeros(4), t_eval=times, rtol=1e-9, atol=1e-12).y[:2].T
    steps = lengths[None, :, None] * np.stack((np.sin(angles), -np.cos(angles)), axis=-1)
    return np.array([top(t)[[0, 2]] for t in times])[:, None, :] + np.cumsum(steps, axis=1)


def test_a_body_at_mid_length_swings_as_the_lower_of_two_segments_says():
    """Wang's own next step from two degrees of freedom: a body along the cable."""
    upper = {"mass": 120.0, "volume": 0.02, "drag_area": 0.2, "added_mass": 10.0}
    lower = {"mass": 300.0, "volume": 0.1, "drag_area": 0.4, "added_mass": 60.0}
    base = {
        "cable": {"length": 50.0, "mass_per_length": 1e-4, "axial_stiffness": 1e8, "diameter": 1e-5, "body": [{"at": 30.0, **upper}]},
        "body": lower, "water": WET, "solver": {"nodes": 5, "time_step": 0.01, "slack_damping": 0.0},
    }  # fmt: skip
    top, times = swing((3.0, 0.0, 0.5), 0.6, ramp_time=6.0), every(0.01, 40.0)
    model = make(base)
    model.initialize(top(0.0))
    places = [model.positions()[[2, 0]][:, [0, 2]]]
    for before, after in itertools.pairwise(times):
        model.advance(before, after - before, top(before), top(after))
        places.append(model.positions()[[2, 0]][:, [0, 2]])
    right = two_segments(np.array([20.0, 30.0]), (upper, lower), top, times)
    size = np.ptp(right[:, 1, 0])
    assert size > 2.0 and np.abs(np.array(places) - right).max() < 1e-3 * size


def test_error_control_follows_its_tolerance_with_sections_and_bodies():
    motion = swing((0.6, 0.0, 0.5), 1.3, ramp_time=3.0)
    base = {
        "cable": {"section": [{**ROPE, "length": 40.0}, {**WIRE, "length": 60.0}], "body": [{"at": 70.0, **CLUMP}]}, "water": WET,
        "body": {"mass": 200.0}, "solver": {"nodes": 33, "time_step": 0.5},
    }  # fmt: skip
    fine = drive(make(base, solver__time_step=0.0025), every(0.05, 12.0), motion)
    found = drive(make(base, solver__tolerance=1e-2), every(0.05, 12.0), motion)
    tension = fine["top.tension"]
    assert np.abs(found["top.tension"] - tension).max() < 5e-2 * np.ptp(tension)
    assert found["solver.steps"][-1] < 0.25 * fine["solver.steps"][-1]
