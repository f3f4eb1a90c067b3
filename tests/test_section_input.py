"""Sections and bodies in scenes: what the cable is on the whole, what is taken from [cable], and what is refused."""

from __future__ import annotations

import dataclasses
import tomllib
from pathlib import Path

import pytest
from sections_support import CHAIN, ROPE, UPPER, WIRE

from cable_model import TowCable
from cable_model.errors import ParameterError
from cable_model.parameters import Section
from cable_model.scene import from_dict, to_toml, with_values
from cable_model.sections import pieces, whole
from cable_model.studies.settings import METHODS, methods


def test_the_whole_of_a_cable_is_what_its_sections_are_in_sum():
    sections = (Section(**CHAIN), Section(**ROPE), Section(**UPPER))
    of_all = whole(sections)
    assert of_all["length"] == 480.0
    assert of_all["mass_per_length"] * 480.0 == pytest.approx(150.0 * 100.0 + 250.0 * 6.0 + 80.0 * 80.0)
    assert 480.0 / of_all["axial_stiffness"] == pytest.approx(150.0 / 8e8 + 250.0 / 2e6 + 80.0 / 6e8)
    drag = sum(s.length * s.diameter * s.normal_drag_coefficient for s in sections)
    assert of_all["normal_drag_coefficient"] * of_all["diameter"] * 480.0 == pytest.approx(drag)


def test_sections_take_what_they_do_not_give_from_the_cable_and_come_back_as_they_were_written():
    scene = from_dict(
        {"cable": {"axial_stiffness": 1e6, "section": [{"length": 2.0, "mass_per_length": 1.0}, {**ROPE, "axial_stiffness": 2e6}]}}
    )
    assert [section.axial_stiffness for section in scene.cable.section] == [1e6, 2e6]
    text = to_toml(scene)
    assert from_dict(tomllib.loads(text)) == scene and "cable.length" not in text and tomllib.loads(text)["cable"].keys() == {"section"}


TWO = {"section": [CHAIN, ROPE]}
WRONG = [
    ({**TWO, "length": 300.0}, {}, "cable.length = 300 m: must be 400, that of its sections. Remove it, or mend the sections."),
    (
        {**TWO, "diameter": 0.3}, {},
        "cable.diameter: every section has its own. Remove it from [cable], or from the sections that share it.",
    ),
    ({"section": [CHAIN, {"length": 3.0}]}, {}, "cable.section[1].mass_per_length: missing. Give the mass per unstretched length."),
    ({"section": [{**CHAIN, "lenght": 3.0}]}, {}, "cable.section[0].lenght: unknown key. Did you mean 'cable.section[0].length'? Known: "),
    (
        {"section": [CHAIN, {**ROPE, "diameter": 0.0}]}, {},
        "cable.section[1].diameter = 0 m: must be > 0 in water or on a seabed. Give the diameter.",
    ),
    (
        TWO, {"solver": {"nodes": 4}},
        "solver.nodes = 4: must be >= 5 with 2 lengths of cable between joints and bodies. Give more nodes.",
    ),
    (
        TWO, {"winch": {"fitted": True}},
        "winch.fitted = True: must be false with sections or bodies on the cable. Leave the winch out, or make the cable alike all along.",
    ),
    (
        {**WIRE, "body": [{"at": 300.0, "mass": 1.0}]}, {},
        "cable.body[0].at = 300 m: must be between 0 and cable.length = 300. An end's is in [body].",
    ),
    (
        TWO, {"solver": {"grid": "box"}},
        'cable.section = 2 rows: must be empty on the box grid. Set solver.grid = "staggered".',
    ),
    (
        {**TWO, "stiffness_curve": [[0.0, 0.0], [0.1, 1e5]]}, {},
        "cable.stiffness_curve = 2 rows: must be empty beside sections or bodies on the cable. Give axial_stiffness.",
    ),
    ({"section": [CHAIN, 3]}, {}, "cable.section[1] = 3: must be a table. "),
    ({"section": 3}, {}, "cable.section = 3: must be a list of tables. Write each as [[cable.section]]."),
]  # fmt: skip


@pytest.mark.parametrize(("cable", "more", "text"), WRONG)
def test_sections_and_bodies_that_cannot_be_are_refused(cable, more, text):
    with pytest.raises(ParameterError) as refused:
        from_dict({"cable": cable, "water": {}, **more})
    assert str(refused.value).startswith(text)


def test_tow_cable_refuses_sections():
    with pytest.raises(ParameterError, match=r"^cable\.section = 2 rows: must be empty for TowCable\. Use CableChain\."):
        TowCable(from_dict({"cable": {"section": [CHAIN, ROPE]}}))


def test_a_value_of_the_whole_cable_cannot_be_changed_beside_its_sections():
    scene = from_dict({"cable": {"section": [CHAIN, ROPE]}})
    assert with_values(scene, {"solver.nodes": 31}).cable == scene.cable
    assert with_values(scene, {"cable.section": [CHAIN]}).cable.length == CHAIN["length"]
    with pytest.raises(ParameterError, match=r"^cable\.mass_per_length: is of the cable's sections in this scene\. Give cable\.section"):
        with_values(scene, {"cable.mass_per_length": 3.0})
    with pytest.raises(ParameterError, match=r"^cable\.mass_per_length = 3: must be 41\.25, that of its sections\."):
        dataclasses.replace(scene, cable=dataclasses.replace(scene.cable, mass_per_length=3.0))


def test_the_scene_of_the_guide_is_one():
    page = (Path(__file__).parents[1] / "docs" / "how_to" / "sections.md").read_text(encoding="utf-8")
    scene = from_dict(tomllib.loads(page.split("```toml\n")[1].split("```")[0]))
    assert len(scene.cable.section) == 2 and len(pieces(scene.cable)[0]) == 3


def test_study_has_the_chain_for_a_cable_of_many_sections():
    scene = from_dict({"cable": {"section": [CHAIN, ROPE, UPPER, ROPE]}, "solver": {"nodes": 41}})
    assert set(methods(scene)) >= {name for name, changes in METHODS.items() if changes.get("solver.grid") != "box"}
