"""A cable in sections and with bodies on it: no difference where there should be none, and balances of energy and momentum."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest
from chain_support import drive, every, make, still
from driven_support import OTHER_WAY_ROUND, about, inputs, run
from sections_support import BUOY

from cable_model import CableChain, simulate
from cable_model.parameters import Section
from cable_model.scene import from_dict
from cable_model.signals import OUTPUTS

ALIKE = {  # a mooring with all that the staggered grid has, on equal cells
    "cable": {
        "length": 60.0, "mass_per_length": 3.0, "axial_stiffness": 1e6, "diameter": 0.05, "normal_drag_coefficient": 1.2,
        "tangential_drag_coefficient": 0.03, "added_mass_coefficient": 1.0, "bending_stiffness": 20.0, "axial_damping": 1e3,
        "quadratic_damping": 10.0,
    },
    "lower_end": {"anchored": True, "z": -20.0},
    "water": {},
    "current": {"speed": 0.3},
    "waves": {"amplitude": 0.3, "period": 5.0},
    "seabed": {"level": -20.0, "stiffness": 1e5, "friction_coefficient": 0.4},
    "top": {"position": [52.0, 0.0, 0.2]},
    "solver": {"nodes": 31, "time_step": 0.05, "audit": True},
}  # fmt: skip
MOVING = about((52.0, 0.0, 0.2), (0.5, 0.0, 0.6), 1.1)


def in_three(base: dict) -> dict:
    """The same scene with its cable in three sections that are alike."""
    shared = {field.name for field in dataclasses.fields(Section)}
    alike = {name: value for name, value in base["cable"].items() if name in shared and name != "length"}
    rest = {name: value for name, value in base["cable"].items() if name not in shared}
    third = {"length": base["cable"]["length"] / 3.0}
    return {**base, "cable": {**rest, **alike, "section": [third, third, {**third, **alike}]}}


def test_sections_that_are_alike_are_one_cable():
    one, three = (drive(make(base), every(0.05, 6.0), MOVING) for base in (ALIKE, in_three(ALIKE)))
    for name in OUTPUTS:
        size = max(np.abs(one[name]).max(), 1e-9)
        assert np.abs(one[name] - three[name]).max() < 1e-6 * size, name


LIFTED = {  # a line between two ships, heavy at one end, with a clump and a float
    "cable": {
        "section": [
            {"length": 40.0, "mass_per_length": 20.0, "axial_stiffness": 2e7, "diameter": 0.04, "bending_stiffness": 4e3},
            {"length": 60.0, "mass_per_length": 2.0, "axial_stiffness": 3e6, "diameter": 0.05, "bending_stiffness": 1e3},
            {"length": 20.0, "mass_per_length": 5.0, "axial_stiffness": 5e6, "diameter": 0.06, "bending_stiffness": 0.0},
        ],
        "normal_drag_coefficient": 1.2, "tangential_drag_coefficient": 0.02, "added_mass_coefficient": 1.0,
        "body": [
            {"at": 25.0, "mass": 300.0, "volume": 0.05, "drag_area": 0.3, "added_mass": 40.0},
            {"at": 80.0, "mass": 30.0, "volume": 0.06, "drag_area": 0.3, "added_mass": 30.0},
        ],
    },
    "water": {"density": 1025.0, "surface": False},
    "current": {"speed": 0.4},
    "lower_end": {"anchored": True, "driven": True},
    "solver": {"nodes": 37, "time_step": 0.02, "grading": 1.0},
}  # fmt: skip


def turned(base: dict) -> dict:
    """The same cable with its other end up."""
    cable = dict(base["cable"])
    length = sum(section["length"] for section in cable["section"])
    cable["section"] = cable["section"][::-1]
    cable["body"] = [{**body, "at": length - body["at"]} for body in cable["body"]]
    return {**base, "cable": cable}


BOTTOM = {"seabed__level": -30.0, "seabed__stiffness": 1e4, "seabed__friction_coefficient": 0.5, "current__speed": 0.0}


@pytest.mark.parametrize("changes", [pytest.param({}, marks=pytest.mark.long, id="hanging"), pytest.param(BOTTOM, id="on the bottom")])
def test_it_makes_no_difference_which_end_of_it_is_called_the_top(changes):
    far = (100.0, 0.0, -12.0)
    moved, fixed = about((0.0, 0.0, -2.0), (0.8, 0.0, 0.6), 0.6), still(far)
    one = run(make(LIFTED, **changes), inputs(moved, fixed), 0.02, 6.0)
    other = run(make(turned(LIFTED), **changes), inputs(fixed, moved), 0.02, 6.0)
    for here, there in OTHER_WAY_ROUND:
        size = np.abs(one[:, here]).max()
        assert np.abs(one[:, here] - other[:, there]).max() < (2e-3 if changes else 2e-4) * size


def test_what_its_balances_lack_falls_with_the_square_of_the_step():
    """Of energy and momentum, with all that sections and bodies have, on a seabed and through the surface."""
    sections = [
        {**ALIKE["cable"], "length": 25.0, "mass_per_length": 12.0, "axial_stiffness": 3e6, "diameter": 0.03},
        {**ALIKE["cable"], "length": 35.0, "bending_stiffness": 60.0, "axial_damping": 3e3, "diameter": 0.08},
    ]
    for section in sections:
        del section["quadratic_damping"]
    cable = {
        "section": sections, "quadratic_damping": 10.0,
        "body": [
            {"at": 40.0, "mass": 50.0, "volume": 0.06, "drag_area": 0.2, "added_mass": 20.0}, {"at": 54.0, "mass": 5.0, "volume": 0.02},
        ],
    }  # fmt: skip
    lacking = []
    for step in (0.02, 0.01):
        model = make({**ALIKE, "cable": cable}, solver__time_step=step, solver__nodes=41, solver__lambda_infinity=-1.0)
        found = drive(model, every(step, 6.0), MOVING)
        assert model.audit is not None
        lacking.append((np.abs(found["audit.energy"]).max() / model.audit.exchanged, found["audit.momentum"][-1] / model.audit.forces))
    assert max(lacking[1]) < 5e-3
    assert all(coarse > 2.8 * fine for coarse, fine in zip(*lacking, strict=True)), lacking


@pytest.mark.long
def test_a_slack_pennant_under_a_float_gains_no_energy():
    """The slack law's width goes by what hangs from a length of cable, not by a float that others hold."""
    rope = {"mass_per_length": 0.3, "axial_stiffness": 1e5, "diameter": 0.01, "volume_per_length": 1e-4, "normal_drag_coefficient": 1.2}
    sections = [{**rope, "length": 40.0}, {**rope, "length": 30.0, "mass_per_length": 0.1, "volume_per_length": 7e-5}]
    scene = from_dict({
        "cable": {"section": sections, "added_mass_coefficient": 1.0, "body": [BUOY]},
        "lower_end": {"anchored": True, "x": -20.0, "z": -30.0},
        "seabed": {"level": -30.0, "stiffness": 1e5}, "water": {}, "waves": {"amplitude": 0.5, "period": 10.0, "surface": "wheeler"},
        "top": {"position": [10.0, 0.0, -1.0]}, "solver": {"nodes": 41, "time_step": 0.01, "audit": True}, "run": {"duration": 40.0},
    })  # fmt: skip
    run = simulate(CableChain(scene))
    assert run.audit is not None and run.audit.energy_share < 0.01
    assert run["cable.tension_max"].max() < 90.0


@pytest.mark.long
def test_a_cable_that_is_let_down_onto_the_bottom_in_a_heap_can_be_audited():
    base = {
        "cable": {"length": 14.0, "mass_per_length": 0.5, "axial_stiffness": 1e5, "diameter": 0.02, "volume_per_length": 1e-4},
        "body": {"mass": 30.0, "volume": 0.02}, "water": {"surface": False}, "seabed": {"level": -10.0, "stiffness": 1e6},
        "top": {"position": [0.0, 0.0, -2.0]}, "solver": {"nodes": 31, "time_step": 0.005}, "run": {"duration": 2.0, "output_step": 0.1},
    }  # fmt: skip
    plain, audited = (simulate(CableChain(from_dict({**base, "solver": {**base["solver"], "audit": audit}}))) for audit in (False, True))
    assert np.array_equal(plain["body.z"], audited["body.z"])
