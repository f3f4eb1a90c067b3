"""Scenes: what is refused and with which words, what is absent, and what the shipped ones hold."""

from __future__ import annotations

import pytest

from cable_model.errors import ParameterError
from cable_model.scene import from_dict, load, shipped, with_values
from cable_model.simulated import effects, one_line, parts_of, unknowns_per_node

CABLE = {"length": 10.0, "mass_per_length": 1.0, "axial_stiffness": 1e6}

REFUSED = [
    (
        {"cable": CABLE, "solver": {"audit": 1}},
        "solver.audit = 1: must be true or false. Say whether the balances of energy and momentum are audited.",
    ),
    ({"cable": {**CABLE, "length": -3.0}}, "cable.length = -3 m: must be > 0. Give the unstretched length."),
    ({"cable": {**CABLE, "length": float("nan")}}, "cable.length = nan m: must be finite. Give the unstretched length."),
    ({"cable": {**CABLE, "axial_stiffness": float("inf")}}, "cable.axial_stiffness = inf N: must be finite. Give the axial stiffness EA."),
    ({"cable": {**CABLE, "length": "long"}}, "cable.length = 'long' m: must be a number. Give the unstretched length."),
    ({"cable": {**CABLE, "length": True}}, "cable.length = True m: must be a number. Give the unstretched length."),
    ({"cable": CABLE, "solver": {"nodes": 0}}, "solver.nodes = 0: must be >= 3 and <= 100000. Give the number of nodes of the chain."),
    ({"cable": CABLE, "solver": {"nodes": 10.5}}, "solver.nodes = 10.5: must be a whole number. Give the number of nodes of the chain."),
    ({"cable": CABLE, "solver": {"time_step": 0.0}}, "solver.time_step = 0 s: must be > 0. Give a step above 0."),
    ({"cable": CABLE, "solver": {"time_step": -0.1}}, "solver.time_step = -0.1 s: must be > 0. Give a step above 0."),
    (
        {"cable": CABLE, "solver": {"grid": "fine"}},
        "solver.grid = 'fine': must be one of staggered, box. Give the finite-difference grid.",
    ),
    ({"cable": {"length": 1.0}}, "cable.mass_per_length: missing. Give the mass per unstretched length."),
    ({"cable": 5}, "cable = 5: must be a table. Write it as [cable]."),
    (
        {"cable": CABLE, "current": {"speed": 1.0}},
        "current.speed = 1 m/s: must be 0 without water. Add [water] or remove [current].",
    ),
    (
        {"cable": CABLE, "waves": {"amplitude": 1.0}},
        "waves.amplitude = 1 m: must be 0 without water. Add [water] or remove [waves].",
    ),
    ({"cable": CABLE, "water": {}}, "cable.diameter = 0 m: must be > 0 in water. Give the diameter, or remove [water]."),
    (
        {"cable": CABLE, "body": {"mass": 2.0}, "lower_end": {"anchored": True}},
        "body.mass = 2 kg: must be 0 at an anchored end. Remove [body], in an FMU by zeros of all its values, or lower_end.anchored.",
    ),
    (
        {"cable": CABLE, "body": {"volume": 0.5}},
        "body.mass = 0 kg: must be > 0 for a body with volume, drag area or added mass. Give the body's mass, or remove all of [body].",
    ),
    (
        {"cable": CABLE, "seabed": {"level": -5.0}},
        "seabed.stiffness = 0 Pa/m: must be > 0 for a seabed. Give the stiffness, or remove [seabed].",
    ),
    (
        {"cable": {**CABLE, "diameter": 0.1}, "water": {}, "current": {"speed": 1.0, "levels": [[0.0, 1.0, 0.0]]}},
        "current.speed = 1 m/s: must be 0 beside current.levels. Keep one of them.",
    ),
    (
        {"cable": {**CABLE, "diameter": 0.1}, "water": {}, "waves": {"amplitude": 1.0}, "environment": {"gravity": 0.0}},
        "environment.gravity = 0 m/s2: must be > 0 with waves. Give gravity.",
    ),
    (
        {"cable": CABLE, "solver": {"grading": 0.5}},
        "solver.grading = 0.5: must be 0 or >= 1 and <= 4. Take 0 (automatic), 1 (uniform) or 2 (a free end).",
    ),
    (
        {"cable": CABLE, "lower_end": {"z": -80.0}},
        "lower_end.anchored = False: must be true for a lower end that has a place. Set lower_end.anchored = true, or remove "
        "lower_end.x, y and z.",
    ),
    *(
        (
            {"cable": CABLE, "seabed": {name: 0.5}},
            "seabed.stiffness = 0 Pa/m: must be > 0 for a seabed. Give the stiffness, or remove [seabed].",
        )
        for name in ("level", "damping_ratio", "friction_coefficient", "friction_displacement", "friction_velocity")
    ),
    *(
        (
            {"cable": CABLE, "tow": {name: 1.0}},
            "body.mass = 0 kg: must be > 0 for the body that [tow] describes. Give the body's mass, or remove its values from [tow].",
        )
        for name in ("drag_area_axial", "body_angle", "added_mass_vertical")
    ),
    (
        {"cable": CABLE, "body": {"mass": 1.0}, "tow": {"drag_area_axial": 1.0}},
        "tow.body_angle = 18 rad: must be <= pi for a disk's drag along its axis. Give the angle of the disk, or remove "
        "tow.drag_area_axial.",
    ),
    (
        {"cable": {**CABLE, "volume_per_length": -0.5}},
        "cable.volume_per_length = -0.5 m2: must be -1 or >= 0. Give the displaced volume per length, as of a chain (-1 = that of the "
        "diameter).",
    ),
    (
        {"cable": CABLE, "solver": {"lambda_infinity": 0.9}},
        "solver.lambda_infinity = 0.9: must be >= -1 and <= 0.5. Near -1 is most accurate on smooth motion, -0.5 damps more.",
    ),
    (
        {"cable": {**CABLE, "inextensible": True}},
        'cable.inextensible = True: must be false on the staggered grid. Set solver.grid = "box", or raise axial_stiffness.',
    ),
    (
        {"cable": {**CABLE, "diameter": 0.1}, "water": {}, "current": {"speed": 1.0, "direction": 0.5}},
        "current.direction = 0.5 rad: must be 0 or pi in the plane. Set solver.space = true, or turn the axes so that x is along it.",
    ),
]


@pytest.mark.parametrize(("values", "text"), REFUSED, ids=[text.split(":")[0] for _, text in REFUSED])
def test_a_bad_value_gets_one_error_with_name_unit_rule_and_remedy(values, text):
    with pytest.raises(ParameterError) as caught:
        from_dict(values)
    assert str(caught.value) == text


def test_an_unknown_key_names_the_nearest_known_one():
    with pytest.raises(ParameterError, match=r"^cable\.lenght: unknown key\. Did you mean 'cable\.length'\? Known: "):
        from_dict({"cable": {**CABLE, "lenght": 2.0}})


def test_an_unknown_scene_names_the_nearest_shipped_one():
    with pytest.raises(ParameterError, match=r"^towed_boddy: unknown scene\. Did you mean 'towed_body'\? Known: "):
        load("towed_boddy")


def test_a_missing_file_an_empty_file_and_a_broken_file_get_one_error_each(tmp_path):
    with pytest.raises(
        ParameterError, match=r"nothing\.toml: no such file\. Give the path of a scene, or one of: basin_chain, dale_sphere, "
    ):
        load(tmp_path / "nothing.toml")
    (tmp_path / "empty.toml").write_text("# nothing\n")
    with pytest.raises(ParameterError, match=r"empty\.toml: an empty scene\. Give at least \[cable\] with length, "):
        load(tmp_path / "empty.toml")
    (tmp_path / "broken.toml").write_text("[cable\n")
    with pytest.raises(ParameterError, match=r"broken\.toml: not a valid TOML file \("):
        load(tmp_path / "broken.toml")


@pytest.mark.parametrize("name", sorted(shipped()))
def test_a_shipped_scene_names_its_source(name):
    scene = load(name)
    assert scene.title
    assert scene.source.strip()


def test_the_four_shipped_scenes_are_there():
    assert {"dale_sphere", "hanging_chain", "free_chain", "towed_body"} <= set(shipped())


def test_an_effect_with_a_zero_coefficient_is_as_absent_as_one_that_was_never_named():
    named = {"body": {"mass": 0.0}, "water": {"density": 0.0}, "current": {"speed": 0.0}, "waves": {"amplitude": 0.0}}
    zeros = from_dict({"cable": {**CABLE, "bending_stiffness": 0.0, "axial_damping": 0.0}, **named})
    assert parts_of(zeros, "chain") == parts_of(from_dict({"cable": CABLE}), "chain")


def test_bending_and_space_change_the_unknowns_of_a_node():
    scene = from_dict({"cable": {**CABLE, "bending_stiffness": 1.0}})
    assert unknowns_per_node(scene, "chain") == 2
    assert unknowns_per_node(with_values(scene, {"solver.space": True}), "chain") == 3
    assert unknowns_per_node(with_values(scene, {"solver.grid": "box"}), "chain") == 6
    assert unknowns_per_node(with_values(scene, {"solver.grid": "box", "cable.bending_stiffness": 0.0}), "chain") == 4


def test_describe_says_what_switched_each_effect_on():
    line = one_line(load("towed_body"), "chain")
    assert "bending (cable.bending_stiffness = 30 N.m2)" in line
    assert "current (current.speed = -2 m/s)" in line
    assert "waves" not in line
    assert {e.name for e in effects(load("free_chain"), "chain") if e.active} == {
        "lower end held aside until the start", "bending", "stretch", "slack (no compression)",
    }  # fmt: skip


def test_values_replaced_by_name_are_checked_like_a_file():
    scene = with_values(load("towed_body"), {"cable.length": 20.0})
    assert scene.cable.length == 20.0
    with pytest.raises(ParameterError, match=r"^cable\.length = -1 m: must be > 0\. "):
        with_values(scene, {"cable.length": -1.0})
    with pytest.raises(ParameterError, match="unknown key"):
        with_values(scene, {"cable.colour": 1.0})
