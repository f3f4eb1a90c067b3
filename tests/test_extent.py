"""What outputs tell of the whole cable: what hangs, where it touches down, its load on the seabed, its bending, waves over its top."""

import math

import numpy as np
import pytest
from catenaries import touchdown
from chain_support import drive, every, make, still
from scipy.integrate import cumulative_trapezoid, solve_bvp

from cable_model import TowCable, scene
from cable_model.signals import OUTPUTS

LENGTH, MASS, STIFFNESS, DEPTH, SPAN = 300.0, 60.0, 5e8, 80.0, 270.0
CHAIN = {
    "cable": {"length": LENGTH, "mass_per_length": MASS, "axial_stiffness": STIFFNESS, "diameter": 0.1},
    "lower_end": {"anchored": True, "x": SPAN, "z": -DEPTH},
    "seabed": {"level": -DEPTH, "stiffness": 1e7},
    "environment": {"gravity": 9.81},
    "solver": {"nodes": 101, "time_step": 0.05},
}  # fmt: skip
WEIGHT = MASS * 9.81
AT_TOP = still()(0.0)


def told(model, *names):
    return [float(model.outputs[OUTPUTS.index(name)]) for name in names]


def rested(model, inputs=AT_TOP):
    model.initialize(inputs)
    return model


@pytest.mark.parametrize("space", [False, True])
def test_a_mooring_touches_down_where_its_catenary_does(space):
    """Within half a cell, which is what a node at the edge may carry of its weight, and of second order on average."""
    pull, hanging = touchdown(LENGTH, WEIGHT, STIFFNESS, SPAN, DEPTH)
    aside = 0.3 if space else 0.0
    errors = []
    for nodes in (51, 101, 201):
        place = {"lower_end__x": SPAN * math.cos(aside), "lower_end__y": SPAN * math.sin(aside)} if space else {}
        model = rested(make(CHAIN, solver__nodes=nodes, solver__space=space, **place))
        above, x, y, z, reaction = told(
            model, "cable.suspended_length", "seabed.touchdown_x", "seabed.touchdown_y", "seabed.touchdown_z", "seabed.force_z"
        )
        across = SPAN - (LENGTH - hanging) * (1.0 + pull / STIFFNESS)
        cell = LENGTH / (nodes - 1)
        assert above == pytest.approx(hanging, abs=0.5 * cell)
        assert (x, y) == pytest.approx((across * math.cos(aside), across * math.sin(aside)), abs=0.5 * cell)
        assert z == pytest.approx(-DEPTH, abs=0.02 * cell + WEIGHT / (1e7 * 0.1))
        force = told(model, "top.force_z")[0]
        (_, _, z0, tension), (_, _, z1, _) = model.nodes()[:2]
        at_anchor = 0.5 * cell * WEIGHT + tension * (z0 - z1) / cell  # its own node, and what the cable, which has sunk in, pulls down
        assert reaction - force + at_anchor == pytest.approx(WEIGHT * LENGTH, rel=1e-5)
        errors.append(abs(above - hanging))
    assert errors[2] < 0.25 * LENGTH / 200


def test_a_payload_that_has_landed_rests_with_its_weight():
    model = make({
        "cable": {"length": 60.0, "mass_per_length": 2.0, "axial_stiffness": 1e6, "diameter": 0.02}, "body": {"mass": 500.0, "volume": 0.1},
        "water": {"density": 1025.0}, "seabed": {"level": -50.0, "stiffness": 1e7}, "solver": {"nodes": 61, "time_step": 0.02},
    })  # fmt: skip
    rested(model, still((0.0, 0.0, -1.0))(0.0))
    force, reaction, hanging = told(model, "top.force_z", "seabed.force_z", "cable.suspended_length")
    weight = (500.0 - 102.5 + 60.0 * (2.0 - 1025.0 * math.pi / 4.0 * 0.02**2)) * 9.80665
    assert reaction - force == pytest.approx(weight, rel=1e-6)
    assert hanging == pytest.approx(49.0, abs=0.5)
    assert told(model, "seabed.touchdown_x")[0] == pytest.approx(0.0, abs=0.5)


def test_what_hangs_free_hangs_from_end_to_end():
    model = rested(make(CHAIN, lower_end__z=-DEPTH, seabed__level=-500.0))
    hanging, reaction, *place = told(model, "cable.suspended_length", "seabed.force_z", "seabed.touchdown_x", "seabed.touchdown_z")
    assert (hanging, place) == (LENGTH, pytest.approx([SPAN, -DEPTH]))
    assert reaction == pytest.approx(0.0, abs=1e-3 * WEIGHT)


@pytest.mark.parametrize("grid", ["staggered", "box"])
def test_the_largest_moment_of_a_beam_under_tension_is_that_of_its_equation(grid):
    length, pull, weight, stiffness = 10.0, 1e3, 0.1, 2e3

    def rates(_, y):  # of deflection, slope, moment, shear
        return np.array([y[1], y[2] / stiffness, y[3], pull * y[2] / stiffness - weight])

    def hinges(a, b):
        return np.array([a[0], a[2], b[0], b[2]])

    solved = solve_bvp(rates, hinges, np.linspace(0.0, length, 101), np.zeros((4, 101)), tol=1e-9)
    right = np.abs(solved.sol(np.linspace(0.0, length, 2001))[2]).max()
    base = {
        "cable": {"length": length, "mass_per_length": weight / 10.0, "axial_stiffness": 1e7, "bending_stiffness": stiffness},
        "environment": {"gravity": 10.0}, "lower_end": {"anchored": True, "x": -length * (1.0 + pull / 1e7)},
    }  # fmt: skip
    errors = []
    for nodes in (21, 41):
        model = rested(make(base, solver__nodes=nodes, solver__grid=grid))
        errors.append(abs(told(model, "cable.bending_moment_max")[0] / right - 1.0))
    assert errors[1] < 5e-3 and errors[1] < 0.5 * errors[0]


def test_a_winch_tells_what_it_has_paid_out():
    model = make(CHAIN, winch__fitted=True)
    series = drive(model, every(0.1, 4.0), lambda t: np.append(AT_TOP, 0.2 * math.sin(t)))
    speeds = 0.2 * np.sin(series["time"])
    assert series["winch.paid_out"] == pytest.approx(cumulative_trapezoid(speeds, dx=0.1, initial=0.0), abs=1e-9)
    assert series["cable.suspended_length"][-1] < series["cable.suspended_length"][0] - 1.0  # a slacker line lies longer


@pytest.mark.parametrize("space", [False, True])
@pytest.mark.parametrize("kind", ["chain", "tow"])
def test_the_elevation_is_that_of_the_waves_over_the_top(kind, space):
    base = {
        "cable": {"length": 30.0, "mass_per_length": 2.0, "axial_stiffness": 1e6, "diameter": 0.02}, "body": {"mass": 100.0},
        "water": {"density": 1025.0}, "waves": {"amplitude": 0.7, "period": 6.0, "phase": 0.4, "direction": 0.5 if space else 0.0},
        "solver": {"nodes": 11, "time_step": 0.05, "space": space}, "environment": {"gravity": 9.81},
    }  # fmt: skip

    def motion(t):
        return np.array([3.0 + 0.5 * t, 2.0, -5.0, 0.5, 0.0, 0.0, 0.0, 0.0, 0.0])

    series = drive(TowCable(scene.from_dict(base)) if kind == "tow" else make(base), every(0.1, 3.0), motion)
    k, aside = (2.0 * math.pi / 6.0) ** 2 / 9.81, 0.5 if space else 0.0
    along = (3.0 + 0.5 * series["time"]) * math.cos(aside) + (2.0 * math.sin(aside) if space else 0.0)
    right = 0.7 * np.cos(k * along - 2.0 * math.pi / 6.0 * series["time"] + 0.4)
    assert series["water.elevation"] == pytest.approx(right, abs=1e-9)


def test_the_tow_model_hangs_in_one_piece():
    model = TowCable(scene.from_dict({"cable": {"length": 30.0, "mass_per_length": 2.0, "axial_stiffness": 1e6}, "body": {"mass": 9.0}}))
    rested(model)
    found = told(model, "cable.suspended_length", "cable.bending_moment_max", "seabed.force_z", "winch.paid_out", "water.elevation")
    assert found == [30.0, 0.0, 0.0, 0.0, 0.0]
    assert told(model, "seabed.touchdown_z") == told(model, "body.z")
