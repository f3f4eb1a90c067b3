"""A driven lower end: both ends are moved, and both tell the force on what holds them."""

import math

import numpy as np
import pytest
from catenaries import between_points
from chain_support import drive, every, make, still, view
from driven_support import (
    AIR,
    DRIVEN,
    FAR,
    LINE,
    LOW,
    LOW_MEAN,
    OTHER_WAY_ROUND,
    SWAYING,
    TOP,
    TOP_MEAN,
    about,
    inputs,
    run,
)

from cable_model.signals import OUTPUTS

SCENES = {
    "drag and current": {},
    "in space": {"solver__space": True, "current__direction": 0.7},
    "bending": {"cable__bending_stiffness": 2e3},
    "goes slack": {"cable__length": 140.0, "current__speed": 0.0},
    "seabed": {"seabed__level": -20.0, "seabed__stiffness": 1e4, "seabed__friction_coefficient": 0.5, "current__speed": 0.0},
    "damping": {"cable__axial_damping": 1e5, "cable__quadratic_damping": 1e5},
}


@pytest.mark.parametrize("name", SCENES)
def test_it_makes_no_difference_which_end_is_called_the_top(name):
    """A cable that is moved at one end and held at the other, both ways round: equal cells, so what differs is what Newton's method leaves.

    That is more where nodes land and lift off.
    """
    moved, fixed = about((0.0, 0.0, -2.0), (0.8, 0.5 if "space" in name else 0.0, 0.6), 0.6), still(FAR)
    one, other = (run(make(LINE, **SCENES[name]), inputs(*ends), 0.02, 8.0) for ends in ((moved, fixed), (fixed, moved)))
    for here, there in OTHER_WAY_ROUND:
        size = np.abs(one[:, here]).max()
        assert np.abs(one[:, here] - other[:, there]).max() < (2e-3 if name == "seabed" else 2e-4) * size
    assert np.ptp(one[:, TOP[0]]) > 0.05 * size


@pytest.mark.parametrize("nodes", [11, 21, 51])
@pytest.mark.parametrize(
    ("length", "stiffness", "mass", "diameter", "span", "rise"),
    [(85.0, 1e6, 2.0, 0.03, 40.0, 55.0), (6000.0, 4e8, 25.0, 0.08, 3000.0, 4495.0)],
)
def test_at_rest_its_force_tension_and_angle_are_the_elastic_catenarys(nodes, length, stiffness, mass, diameter, span, rise):
    """Of second order in the cells, on a grid that is graded."""
    cable = {"length": length, "axial_stiffness": stiffness, "mass_per_length": mass, "diameter": diameter}
    model = make({"cable": cable, "water": {"surface": False}, "solver": {"nodes": nodes}, **DRIVEN})
    model.initialize(inputs(still((span, 0.0, -5.0)), still((0.0, 0.0, -5.0 - rise)))(0.0))
    weight = (mass - 1025.0 * np.pi / 4.0 * diameter**2) * 9.80665
    across, up = between_points(length, weight, stiffness, span, rise)
    tension = np.hypot(across, up - weight * length)
    found = dict(zip(OUTPUTS, model.outputs, strict=True))
    assert model.outputs[LOW] == pytest.approx([across, 0.0, up - weight * length], abs=1.5 / nodes**2 * tension)
    assert found["body.tension"] == pytest.approx(tension, rel=0.8 / nodes**2)
    assert found["lower.declination"] == pytest.approx(np.arctan2(across, up - weight * length), abs=15.0 / nodes**2)


def test_both_ends_moved_alike_carry_the_cable_along():
    """Towed at a speed through still water a cable hangs between its ends as between fixed ones in the current that it then feels."""
    places, speed, ramp = ((0.0, 0.0, -2.0), FAR), 0.8, 20.0

    def moving(place):
        def motion(t):
            s = min(t / ramp, 1.0)
            way = speed * ramp * s**3 * (1.0 - 0.5 * s) + speed * max(t - ramp, 0.0)
            return np.array(
                [place[0] - way, *place[1:], -speed * s**2 * (3.0 - 2.0 * s), 0.0, 0.0, -speed / ramp * 6.0 * s * (1.0 - s), 0.0, 0.0]
            )

        return motion

    towed = make(LINE, current__speed=0.0, solver__time_step=0.1)
    rows = run(towed, inputs(*map(moving, places)), 0.1, 300.0)
    fixed = make(LINE, current__speed=speed)
    fixed.initialize(inputs(*map(still, places))(0.0))
    for force in (TOP, TOP_MEAN, LOW, LOW_MEAN):
        assert rows[-1, force] == pytest.approx(fixed.outputs[force], rel=1e-4, abs=0.05)
    carried = towed.positions() - [speed * (0.5 * ramp - 300.0), 0.0, 0.0]
    assert np.abs(carried - fixed.positions()).max() < 1e-3


def test_a_lower_end_that_is_driven_as_a_body_moved_gives_the_bodys_run():
    """The lower end of a free body's run, replayed with accelerations: the same top force, and below it the tension that the body needs."""
    hung = {part: values for part, values in LINE.items() if part != "lower_end"}
    hung["body"] = {"mass": 300.0, "volume": 0.1, "drag_area": 0.2, "added_mass": 50.0}
    top, times = about((0.0, 0.0, 0.0), (1.0, 0.0, 0.5), 1.1), every(0.02, 10.0)
    free = drive(make(hung), times, top)
    path = np.column_stack([free[f"body.{kind}{axis}"] for kind in ("", "v") for axis in "xyz"])
    path = np.hstack([path, np.gradient(path[:, 3:], times, axis=0, edge_order=2)])
    found = run(make(LINE), inputs(top, lambda t: path[round(t / 0.02)]), 0.02, 10.0)[50:]
    forces = np.column_stack([free[OUTPUTS[place]] for place in TOP])
    size = np.ptp(forces[:, 2])
    assert np.abs(found[:, TOP] - forces[50:]).max() < 0.01 * size
    assert np.abs(np.linalg.norm(found[:, LOW], axis=1) - free["body.tension"][50:]).max() < 0.02 * size


def test_a_wave_from_a_moved_lower_end_runs_up_as_d_alembert_says():
    """A taut string without weight whose lower end is displaced sideways by a pulse: the pulse arrives at the top after L/c, and the force
    across it there is twice m c v, as at a fixed end."""
    m, tension, length, stiffness = 0.5, 2000.0, 40.0, 1e6
    c = math.sqrt(tension / m / (1.0 + tension / stiffness))  # along the unstretched length
    span = length * (1.0 + tension / stiffness)
    scene = {
        "cable": {"length": length, "mass_per_length": m, "axial_stiffness": stiffness},
        "environment": {"gravity": 0.0},
        "solver": {"nodes": 161, "time_step": 0.001, "grading": 1.0, "lambda_infinity": -1.0, "slack_damping": 0.0},
        **DRIVEN,
    }
    height, duration = 0.02, 0.2

    def low(t):
        s = min(t, duration) / duration * 2.0 * np.pi
        k = 2.0 * np.pi / duration
        if t >= duration:
            return np.array([height, 0.0, -span, *[0.0] * 6])
        x, v, a = (height * (s - math.sin(s)) / (2.0 * np.pi), height / duration * (1.0 - math.cos(s)), height / duration * k * math.sin(s))
        return np.array([x, 0.0, -span, v, 0.0, 0.0, a, 0.0, 0.0])

    rows = run(make(scene), inputs(still(), low), 0.001, 0.8)
    times = every(0.001, 0.8)
    arrives = length / c
    rate = np.array([low(t - arrives)[3] if t >= arrives else 0.0 for t in times])
    impedance = m * c
    expected = 2.0 * impedance * rate
    assert np.abs(rows[:, TOP[0]] - expected).max() < 5e-3 * expected.max()
    at_low = np.array([-impedance * low(t)[3] for t in times])
    assert np.abs(rows[:, LOW[0]] - at_low).max() < 5e-3 * expected.max()


def momentum(model, mass: float) -> np.ndarray:
    """Of a dry cable of equal cells in the plane, along x and z, kg m/s."""
    v = view(model).y[AIR["solver"]["nodes"] :]
    return mass / (len(v) - 1) * (0.5 * v[0] + v[1:-1].sum(axis=0) + 0.5 * v[-1])


def test_the_impulses_of_both_ends_and_the_weight_are_the_change_of_momentum():
    motion = inputs(about((0.0, 0.0, 0.0), (2.0, 0.0, 0.0), 2.0), about((30.0, 0.0, -10.0), (0.0, 0.0, 1.5), 1.4))
    step, duration, mass = 0.02, 10.0, 1.5 * 50.0
    model = make(AIR, environment__gravity=9.80665)
    rows = run(model, motion, step, duration)
    impulse = -step * (rows[1:, TOP_MEAN] + rows[1:, LOW_MEAN]).sum(axis=0) - [0.0, 0.0, mass * 9.80665 * duration]
    assert np.abs(impulse[[0, 2]] - momentum(model, mass)).max() < 2e-3 * mass * 4.0


@pytest.mark.parametrize("step", [0.05, 0.025])
def test_two_vessels_on_a_dry_cable_keep_their_momentum(step):
    """Each gets the mean force of the step that the cable made: what it gives both is what it loses, whatever the step."""
    model = make(AIR, solver__time_step=step)
    masses, places, speeds = np.array([2e4, 5e4]), np.array([50.02, 0.0]), np.array([0.3, -0.1])
    given = np.zeros(19)
    given[[0, 10]] = places
    model.initialize(given)
    start = masses @ speeds
    for k in range(round(20.0 / step)):
        given[[0, 10]], given[[3, 13]] = places, speeds
        model.step(k * step, step, given)
        forces = model.outputs[[TOP_MEAN[0], LOW_MEAN[0]]]
        places = places + step * (speeds + 0.5 * step * forces / masses)
        speeds = speeds + step * forces / masses
    assert speeds[0] < 0.0
    assert masses @ speeds + momentum(model, 1.5 * 50.0)[0] == pytest.approx(start, abs=2e-3 * start)


def test_a_driven_end_does_not_drift_away_from_where_it_is_said_to_be():
    def circle(t):
        s, c = 3.0 * math.sin(0.5 * t), 3.0 * math.cos(0.5 * t)
        return np.array([90.0 + c, s, -5.0, -0.5 * s, 0.5 * c, 0.0, -0.25 * c, -0.25 * s, 0.0])

    model = make(LINE, solver__space=True, solver__time_step=0.1, solver__nodes=11)
    run(model, inputs(about((0.0, 0.0, 0.0), (2.0, 1.0, 1.0), 0.7), circle), 0.1, 1000.0)
    assert np.abs(model.positions()[0] - circle(1000.0)[:3]).max() < 1e-3


@pytest.mark.parametrize(
    "changes", [{}, *(pytest.param(more, marks=pytest.mark.long) for more in ({"solver__space": True}, {"cable__bending_stiffness": 2e3}))]
)
def test_energy_and_momentum_close_at_second_order(changes):
    found = []
    for step in (0.04, 0.02):
        model = make(LINE, solver__audit=True, solver__time_step=step, solver__slack_damping=0.0, **changes)
        run(model, SWAYING, step, 12.0)
        found.append(model.audit)
    assert found[1].energy_share < 1e-3
    assert found[1].momentum_share < 1e-4
    assert found[0].energy / found[1].energy > 3.0
