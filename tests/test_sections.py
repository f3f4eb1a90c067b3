"""A cable in sections and with bodies on it at rest: catenaries in pieces, tensions at joints, bodies on a seabed and at the surface."""

from __future__ import annotations

import numpy as np
import pytest
from chain_support import make, still, view
from scipy.integrate import solve_bvp
from sections_support import BUOY, CHAIN, DENSITY, FLOAT, GRAVITY, MOORINGS, ROPE, WET, catenary, weights

from cable_model import CableChain
from cable_model.scene import from_dict
from cable_model.sections import pieces
from cable_model.signals import OUTPUTS


@pytest.mark.parametrize("space", [False, pytest.param(True, marks=pytest.mark.long)])
@pytest.mark.parametrize("name", MOORINGS)
def test_at_rest_it_hangs_in_catenaries_one_after_the_other(name, space):
    """Force, tensions and joints, of second order in the cells."""
    cable, span, rise = MOORINGS[name]
    base = {"cable": cable, "lower_end": {"anchored": True, "x": -span, "z": -rise}, "water": WET}
    for nodes in (21, 41) if space else (21, 41, 81):
        scene = from_dict({**base, "solver": {"nodes": nodes, "space": space}})
        model = CableChain(scene)
        model.initialize(still()(0.0))
        found = dict(zip(OUTPUTS, model.outputs, strict=True))
        total = sum(weight * length for weight, _, length in weights(scene.cable)[0]) + sum(weights(scene.cable)[1])
        h, low, up, joints = catenary(scene.cable, (-found["top.force_x"], -found["top.force_z"] - total), span, rise)
        size = np.hypot(h, up)
        assert -model.outputs[[0, 2]] == pytest.approx([h, up], abs=2.0 / nodes**2 * size)
        assert found["body.tension"] == pytest.approx(np.hypot(h, low), abs=4.0 / nodes**2 * size)
        arcs = np.concatenate([[0.0], np.cumsum(view(model).mesh[:, 0])])
        places = model.positions()[:, [0, 2]] + (span, rise)
        for arc, joint in zip(np.cumsum([row.length for row in pieces(scene.cable)[0]]), joints, strict=True):
            k = int(np.argmin(np.abs(arcs - arc)))
            assert arcs[k] == pytest.approx(arc, rel=1e-9)
            assert places[k] == pytest.approx(joint, abs=5.0 / nodes**2 * scene.cable.length)


def test_arc_lengths_go_over_all_sections():
    model = make({"cable": MOORINGS["chain and rope with a float above their joint"][0], "water": WET, "solver": {"nodes": 21}})
    model.initialize(still()(0.0))
    arcs = model.arc_lengths()
    assert arcs[-1] == pytest.approx(350.0) and np.all(np.diff(arcs) > 0.0)
    assert min(abs(arcs - 100.0)) < 1e-9 and min(abs(arcs - 140.0)) < 1e-9


def test_tensions_at_joints_and_bodies_are_those_of_what_hangs_below():
    """Where the tension jumps it is the larger one that is told, and the largest is at a joint below a float."""
    sections = [{**CHAIN, "length": 20.0}, {**ROPE, "length": 30.0}]
    bodies = [{"at": 20.0, **FLOAT}, {"at": 35.0, "mass": 100.0}]
    base = {"cable": {"section": sections, "body": bodies}, "body": {"mass": 4000.0}, "water": WET}
    for nodes in (9, 17, 33):
        model = make(base, solver__nodes=nodes)
        model.initialize(still()(0.0))
        made, hung = weights(model.scene.cable)
        loads = np.cumsum([4000.0 * GRAVITY, *np.ravel([(w * length, b) for (w, _, length), b in zip(made, hung[1:], strict=True)])])
        arcs, tensions = model.arc_lengths(), model.nodes()[:, 3]
        at = [tensions[np.argmin(np.abs(arcs - place))] for place in (0.0, 20.0, 35.0, 50.0)]
        assert at == pytest.approx([loads[0], max(loads[1:3]), max(loads[3:5]), loads[5]], rel=1e-6)
        assert model.outputs[OUTPUTS.index("cable.tension_max")] == pytest.approx(loads.max(), rel=1e-6)


def test_a_clump_on_a_seabed_sinks_in_as_deep_as_the_cable_whatever_the_mesh():
    """w/(K d), with the weight and the diameter of the cable about it."""
    clump = {"at": 20.0, "mass": 500.0, "volume": 0.1}
    cable = {"length": 80.0, "mass_per_length": 5.0, "axial_stiffness": 1e6, "diameter": 0.04, "body": [clump]}
    base = {
        "cable": cable, "water": {}, "lower_end": {"anchored": True, "x": -70.0, "z": -30.0}, "seabed": {"level": -30.0, "stiffness": 1e5},
    }  # fmt: skip
    depth = (5.0 - DENSITY * np.pi / 4.0 * 0.04**2) * GRAVITY / (1e5 * 0.04)
    for nodes in (21, 41, 81):
        model = make(base, solver__nodes=nodes)
        model.initialize(still((0.0, 0.0, -5.0))(0.0))
        place = np.argmin(np.abs(model.arc_lengths() - 20.0))
        assert -30.0 - model.positions()[place, 2] == pytest.approx(depth, rel=0.05)


def test_a_light_cable_with_a_float_between_two_anchors_arches_up():
    """Cells that can be pressed too: a V that hangs down would stand on its legs."""
    cable = {
        "length": 30.0, "mass_per_length": 1.0, "axial_stiffness": 1e5, "diameter": 0.02, "compressible": True,
        "body": [{"at": 15.0, "mass": 20.0, "volume": 0.2}],
    }  # fmt: skip
    model = make({"cable": cable, "water": WET, "lower_end": {"anchored": True, "x": -16.0, "z": -40.0}, "solver": {"nodes": 21}})
    model.initialize(still((0.0, 0.0, -40.0))(0.0))
    assert model.positions()[:, 2].max() == pytest.approx(-40.0 + np.sqrt(15.0**2 - 8.0**2), abs=0.3)
    assert model.outputs[OUTPUTS.index("cable.tension_min")] > 0.0


def test_a_float_on_the_cable_that_the_water_does_not_lift_is_told():
    """In waves that are held it is as wet as in still water, and above water without a surface it is in water."""
    cable = {"length": 50.0, "mass_per_length": 0.3, "axial_stiffness": 1e5, "diameter": 0.01, "body": [{**BUOY, "at": 30.0}]}
    base = {"cable": cable, "lower_end": {"anchored": True, "z": -20.0}, "solver": {"nodes": 31}}
    above = make({**base, "water": {"surface": False}})
    above.initialize(still((15.0, 0.0, -2.0))(0.0))
    assert "an end of the cable or a body at z" in str(above.warnings())
    held = make({**base, "water": {}, "waves": {"amplitude": 0.5}})
    held.initialize(still((15.0, 0.0, -2.0))(0.0))
    assert "the lower end or a body at z" in str(held.warnings())


@pytest.mark.parametrize("ratio", [10.0, 1000.0])
def test_a_beam_of_two_stiffnesses_under_tension_sags_as_its_equation_says(ratio):
    """(EI y'')'' - T y'' = -w between hinges, slope, moment and shear continuous at the joint; of second order in the cells."""
    length, pull, weight, soft = 10.0, 1e3, 0.1, 1e3
    across = np.array([soft, soft * ratio])

    def rates(_, y):  # of both halves side by side, over half the length: deflection, slope, moment, shear
        low, up = y[:4], y[4:]
        halves = zip((low, up), across, strict=True)
        return np.concatenate([[part[1], part[2] / ei, part[3], pull * part[2] / ei - weight] for part, ei in halves])

    def ends(a, b):  # hinges outside, everything continuous in the middle
        return np.array([a[0], a[2], b[4], b[6], *(b[:4] - a[4:])])

    solved = solve_bvp(rates, ends, np.linspace(0.0, 0.5 * length, 101), np.zeros((8, 101)), tol=1e-9, max_nodes=100000)
    assert solved.success
    errors = []
    for nodes in (21, 41):
        half = {"length": 0.5 * length, "mass_per_length": weight / 10.0, "axial_stiffness": 1e7}
        base = {
            "cable": {"section": [{**half, "bending_stiffness": ei} for ei in across]}, "environment": {"gravity": 10.0},
            "lower_end": {"anchored": True, "x": -length * (1.0 + pull / 1e7)}, "solver": {"nodes": nodes},
        }  # fmt: skip
        model = make(base)
        model.initialize(still()(0.0))
        arcs, sag = model.arc_lengths(), model.positions()[:, 2]
        low, up = solved.sol(np.minimum(arcs, 0.5 * length))[0], solved.sol(np.maximum(arcs - 0.5 * length, 0.0))[4]
        right = np.where(arcs <= 0.5 * length, low, up)
        errors.append(np.abs(sag - right).max() / np.abs(right).max())
    assert errors[1] < 5e-3 and np.log2(errors[0] / errors[1]) > 1.8
