"""The chain on a seabed: penetration, touchdown, friction, damping and landing against closed forms."""

import numpy as np
import pytest
from catenaries import touchdown
from chain_support import drive, every, make, still, view

from cable_model.errors import ParameterError

MOORING = {
    "cable": {"length": 33.0, "mass_per_length": 0.08, "axial_stiffness": 1e4, "diameter": 0.0022},
    "lower_end": {"anchored": True, "z": -3.0},
    "environment": {"gravity": 9.81},
    "seabed": {"level": -3.0, "stiffness": 3e9},
    "top": {"position": [32.5, 0.0, 0.3]},
    "solver": {"nodes": 101, "time_step": 0.01, "lambda_infinity": -0.5},
}
WEIGHT = 0.08 * 9.81  # N/m
LYING = {  # 10 m of cable on the floor, its top at the floor's height
    "cable": {"length": 10.0, "mass_per_length": 2.0, "axial_stiffness": 1e6, "diameter": 0.02},
    "lower_end": {"anchored": False},
    "environment": {"gravity": 10.0},
    "seabed": {"level": -5.0, "stiffness": 1e5, "friction_coefficient": 0.4, "friction_velocity": 1e-3},
    "solver": {"nodes": 21, "grading": 1.0, "time_step": 0.02, "lambda_infinity": -0.5},
}
TOP = (32.5, 0.0, 0.3)
ON_FLOOR = (0.0, 0.0, -5.01)  # as deep as the cable sinks in


def test_a_lying_cable_sinks_in_by_its_weight_over_the_stiffness():
    model = make(MOORING)
    model.initialize(still(TOP)(0.0))
    depth = -3.0 - model.positions()[5:30, 2]
    assert depth == pytest.approx(np.full(25, WEIGHT / (3e9 * 0.0022)), rel=1e-2)  # the slack law's share is 1e-3


def test_the_touchdown_of_a_mooring_is_that_of_the_elastic_catenary():
    pull, suspended = touchdown(33.0, WEIGHT, 1e4, 32.5, 3.3)
    tension = np.hypot(pull, WEIGHT * suspended)
    errors = []
    for nodes in (51, 101, 201):
        model = make(MOORING, solver__nodes=nodes)
        model.initialize(still(TOP)(0.0))
        errors.append(max(abs(model.outputs[3] / tension - 1.0), abs(model.outputs[11] / pull - 1.0)))
    assert errors[-1] < 1e-3
    assert errors[-1] < 0.5 * errors[0]


SLACK = {  # 1000 m of line of which 130 m hang down 100 m: H/w = 34 m, what the line bends over where it touches down
    "cable": {"length": 1000.0, "mass_per_length": 1.0, "axial_stiffness": 1e9, "diameter": 0.1},
    "lower_end": {"anchored": True, "x": -940.0, "z": -100.0},
    "environment": {"gravity": 10.0},
    "seabed": {"level": -100.0, "stiffness": 1e7},
}


@pytest.mark.parametrize("nodes", [51, 52, 101, 102, 201, 401])
def test_a_slack_mooring_errs_by_the_square_of_its_cells_over_the_bend_at_touchdown(nodes):
    # touchdown falls anywhere in a cell, which costs up to h^2/(8 H/w) of height: the sign and size jump from mesh to mesh under that bound
    pull, _ = touchdown(1000.0, 10.0, 1e9, 940.0, 100.0)
    model = make(SLACK, solver__nodes=nodes)
    model.initialize(still()(0.0))
    assert abs(-model.outputs[0] / pull - 1.0) < 0.1 * (1000.0 / (nodes - 1) / (pull / 10.0)) ** 2


def test_dragging_a_lying_cable_takes_its_weight_times_the_friction():
    model = make(LYING, lower_end__release_force=200.0)
    start = still(ON_FLOOR)(0.0)

    def pull(t: float) -> np.ndarray:
        """0.25 m/s away from the cable, reached within 2 s."""
        s = min(t / 2.0, 1.0)
        state = start.copy()
        state[0] = -0.5 * (s**3 - 0.5 * s**4) - 0.25 * max(t - 2.0, 0.0)
        state[3] = -0.25 * (3.0 * s**2 - 2.0 * s**3)
        state[6] = -0.75 * (s - s**2)
        return state

    series = drive(model, every(0.02, 12.0), pull)
    carried = 2.0 * 10.0 * 10.0 * (1.0 - 0.5 / 20.0)  # half a cell belongs to the top node, which is prescribed
    assert series["top.force_x"][-100:] == pytest.approx(np.full(100, 0.4 * carried), rel=2e-3)


def test_without_friction_dragging_costs_nothing():
    model = make(LYING, lower_end__release_force=200.0, seabed__friction_coefficient=0.0)
    assert model.parts.friction is None
    series = drive(model, every(0.02, 4.0), still(ON_FLOOR))
    assert abs(series["top.force_x"][-1]) < 0.4 * 200.0  # released, it comes to rest in waves only


def test_a_dropped_cable_lands_and_stays():
    """A body on a cable is lowered to the floor and past it: then the floor carries it and the cable goes slack."""
    model = make(
        LYING, seabed__stiffness=1e7, seabed__friction_coefficient=0.0, seabed__level=-10.2, body__mass=50.0, solver__time_step=0.01,
    )  # fmt: skip

    def lowered(t: float) -> np.ndarray:
        s = min(t / 2.0, 1.0)
        depth = 0.8 * s**3 * (10.0 + s * (-15.0 + 6.0 * s))
        speed = 0.8 * 30.0 * s**2 * (1.0 - s) ** 2 / 2.0
        return np.array([0.0, 0.0, -depth, 0.0, 0.0, -speed, 0.0, 0.0, -0.8 * 60.0 * s * (1.0 - s) * (1.0 - 2.0 * s) / 4.0])

    series = drive(model, every(0.01, 6.0), lowered)
    assert series["body.z"][0] == pytest.approx(-10.0, abs=0.01)
    assert series["body.z"].min() > -10.2 - 1e-3
    assert series["body.z"][-1] == pytest.approx(-10.2, abs=1e-3)
    assert series["top.tension"][-1] < 2.0 * 10.0 * 10.0 + 5.0  # the cable's weight alone, at most
    assert abs(series["body.vz"][-1]) < 1e-3


@pytest.mark.parametrize("ratio", [0.1, 0.3])
def test_a_node_on_the_seabed_swings_with_the_stated_damping(ratio):
    """The lying part, lifted a little and let go, moves as an oscillator of K d per length: its decay is that of the ratio."""
    model = make(LYING, seabed__damping_ratio=ratio, seabed__friction_coefficient=0.0, seabed__stiffness=1e4, solver__time_step=1e-3,
                 lower_end__release_force=100.0, solver__lambda_infinity=-1.0, cable__axial_stiffness=1e5)  # fmt: skip
    omega = np.sqrt(1e4 * 0.02 / 2.0)  # 10 rad/s
    rest = -5.0 - 2.0 * 10.0 / (1e4 * 0.02)
    start = still((0.0, 0.0, rest))(0.0)
    model.initialize(start)
    kick = -0.05  # m/s, deeper into the floor: contact is not lost
    now = view(model)
    now.y[now.mesh.shape[0] + 1 : -1, 1] = kick
    times = every(1e-3, 0.3)
    heights = [model.positions()[0, 2] - rest]
    for t in times[1:]:
        model.advance(t - 1e-3, 1e-3, start, start)
        heights.append(model.positions()[0, 2] - rest)
    damped = omega * np.sqrt(1.0 - ratio**2)
    expected = kick / damped * np.exp(-ratio * omega * times) * np.sin(damped * times)
    assert heights == pytest.approx(expected, abs=2e-2 * abs(kick / omega))


def test_a_plane_mooring_in_space_is_the_plane_mooring():
    def swing(t: float) -> np.ndarray:
        w = 1.8
        return np.array([32.5 + 0.1 * np.sin(w * t), 0, 0.3, 0.1 * w * np.cos(w * t), 0, 0, -0.1 * w * w * np.sin(w * t), 0, 0])

    plane = drive(make(MOORING, solver__nodes=31, seabed__friction_coefficient=0.3), every(0.01, 2.0), swing)
    space = drive(make(MOORING, solver__nodes=31, seabed__friction_coefficient=0.3, solver__space=True), every(0.01, 2.0), swing)
    assert space["top.tension"] == pytest.approx(plane["top.tension"], rel=1e-8)
    assert np.abs(space["top.force_y"]).max() < 1e-9


@pytest.mark.parametrize(
    ("changes", "text"),
    [
        ({"cable__diameter": 0.0}, "cable.diameter = 0 m: must be > 0 on a seabed. Give the diameter, or remove [seabed]."),
        ({"solver__grid": "box"}, 'seabed.stiffness = 3000000000 Pa/m: must be 0 on the box grid. Set solver.grid = "staggered".'),
    ],
)
def test_a_seabed_that_does_not_fit_is_refused(changes, text):
    with pytest.raises(ParameterError) as error:
        make(MOORING, **changes)
    assert str(error.value) == text


@pytest.mark.parametrize(
    ("top", "changes", "text"),
    [
        ((32.5, 0.0, -4.0), {}, "top.z = -4 m: must be >= seabed.level = -3. Lower the seabed or lift the top."),
        (TOP, {"lower_end__z": -3.5}, "lower_end.z = -3.5 m: must be >= seabed.level = -3. Lower the seabed or lift the anchor."),
    ],
)
def test_ends_below_the_seabed_are_refused_at_the_start(top, changes, text):
    with pytest.raises(ParameterError) as error:
        make(MOORING, **changes).initialize(still(top)(0.0))
    assert str(error.value) == text
