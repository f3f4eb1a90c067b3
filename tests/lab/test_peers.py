"""Peers: where MoorDyn is installed it agrees with the chain on what both can do; what is not translated is refused."""

import dataclasses
import math
import sys
from functools import partial
from pathlib import Path

import numpy as np
import pytest

from cable_model.cable_chain import CableChain
from cable_model.errors import ParameterError
from cable_model.lab.cost_cases import SHIFTED
from cable_model.lab.hard.cases import BASIN, basin_label
from cable_model.lab.peers import cabledyn, compare, deck, moordyn
from cable_model.moordyn import read
from cable_model.moordyn_scene import scene_of
from cable_model.motion import motion_of
from cable_model.parameters import value_of
from cable_model.scene import load, with_values
from cable_model.studies.timed import Scale, errors, timed


def case(name):
    return compare.CASES[name].load()


def test_a_missing_peer_is_named_with_what_to_do(monkeypatch):
    monkeypatch.setitem(sys.modules, "moordyn", None)
    with pytest.raises(ParameterError, match=r"cable-fmu\[peers\]"):
        moordyn.run(case("C4 wire, 1 m at 10 s"), 5, 1e-3, 20)


@pytest.mark.parametrize(("name", "tension", "position"), [("C4 wire, 1 m at 10 s", 0.04, 1e-4), ("C3 sphere, EA 22 N", 0.03, 0.005)])
def test_moordyn_and_the_chain_agree(name, tension, position):
    pytest.importorskip("moordyn")
    scene = case(name)
    ours = timed(with_values(scene, {"solver.nodes": 81, "solver.time_step": 0.0125}))
    theirs = moordyn.run(scene, 10, 2e-3, 20)
    found = errors(theirs, ours, Scale.of(ours))
    assert not theirs.error
    assert found["tension"] < tension and found["position"] < position


def test_moordyn_holds_a_line_of_a_deck_as_the_chain_holds_it_imported():
    """OC3-Hywind at rest, on 20 segments and on 50 cells: 0.14 % apart."""
    md = pytest.importorskip("moordyn")
    source = Path(__file__).parents[1] / "data" / "moordyn" / "oc3_hywind.txt"
    options = ("OPTIONS -------------------", "OPTIONS -------------------\n1e-6 threshIC\n0 writeLog")
    with deck.written(source.read_text(encoding="utf-8").replace(*options)) as path:
        system = md.Create(str(path))
        try:
            tops = np.array([md.GetPointPos(md.GetPoint(system, number)) for number in (4, 5, 6)]).ravel()
            assert md.Init(system, list(tops), [0.0] * 9) == 0
            line = md.GetLine(system, 1)
            theirs = np.array(md.GetLineNodeForce(line, md.GetLineN(line)))
        finally:
            md.Close(system)
    scene, _ = scene_of(read(source), 1)
    chain = CableChain(scene)
    chain.initialize(motion_of(scene)(0.0, 1))
    assert np.linalg.norm(theirs) == pytest.approx(chain.outputs[3], rel=3e-3)
    assert theirs == pytest.approx(np.array(chain.outputs[:3]), abs=5e-3 * chain.outputs[3])


UNCHANGED = (
    "cable.length", "cable.mass_per_length", "cable.axial_stiffness", "cable.axial_damping", "lower_end.anchored", "lower_end.x",
    "lower_end.y", "lower_end.z", "body.mass", "body.volume", "body.drag_area", "body.added_mass", "environment.gravity", "water.density",
    "seabed.level", "seabed.friction_coefficient", "top.position",
)  # fmt: skip


@pytest.mark.parametrize("name", ["basin_chain", "towed_body"])
def test_a_scene_written_as_a_deck_comes_back_the_same(name, tmp_path):
    """A deck has one diameter, that of the volume, and coefficients to it."""
    scene = with_values(load(name), {"cable.axial_damping": 12.5, "cable.bending_stiffness": 0.0, "top.motion": []})
    path = tmp_path / "deck.txt"
    path.write_text(deck.text(scene, 30, moordyn.seabed_options(scene)), encoding="utf-8")
    back, _ = scene_of(read(path))
    for value in UNCHANGED:
        assert value_of(back, value) == pytest.approx(value_of(scene, value)), value
    assert back.cable.displaced_area == pytest.approx(scene.cable.displaced_area)
    assert back.cable.added_mass(1000.0) == pytest.approx(scene.cable.added_mass(1000.0))
    per_diameter = ("cable.normal_drag_coefficient", "cable.tangential_drag_coefficient", "seabed.stiffness")
    for value in per_diameter:
        assert value_of(back, value) * back.cable.diameter == pytest.approx(value_of(scene, value) * scene.cable.diameter), value


def test_cabledyn_reads_the_same_input_file():
    pytest.importorskip("cabledyn")
    scene = with_values(case("C4 wire, 1 m at 10 s"), {"run.duration": 10.0})
    theirs = cabledyn.run(scene, 10, 5)
    assert not theirs.error
    assert errors(theirs, timed(scene), Scale.of(timed(scene)))["position"] < 3e-3


def test_what_is_not_translated_is_refused():
    pytest.importorskip("moordyn")
    with pytest.raises(ParameterError, match="bending"):
        moordyn.run(load("towed_body").__class__(**{**vars(load("towed_body")), "current": load("hanging_chain").current}), 5, 1e-3, 20)
    with pytest.raises(ParameterError, match="seabed"):
        deck.refuse_untranslated(load("basin_chain"), "CableDyn")


@pytest.mark.parametrize(("period", "apart"), [(3.5, 0.02), (1.25, 0.045)])
def test_moordyn_and_the_chain_agree_on_a_mooring_on_the_seabed(period, apart):
    """Pull and slack, volume, drag and, in the fast motion, friction; a softer seabed lets MoorDyn's step be longer."""
    pytest.importorskip("moordyn")
    motion = {variant.label: variant for variant in BASIN}[basin_label(0.2, period)].changes
    scene = with_values(load("basin_chain"), {**motion, "seabed.stiffness": 3e6, "run.output_step": 0.01})
    ours, theirs = timed(scene), moordyn.run(scene, 20, 1e-3, 10)
    assert not theirs.error
    assert theirs.tension[0] == pytest.approx(ours.tension[0], rel=0.005)  # 20 segments; 0.2 % apart with 80
    assert np.sqrt(np.mean((theirs.tension - ours.tension) ** 2)) < apart * np.ptp(ours.tension)  # without friction: 0.063 in the fast one


def test_first_tension_of_moordyn_is_that_of_the_cables_end_as_the_others_are():
    """Not that of the last segment's middle, which lacks the weight of half of it."""
    pytest.importorskip("moordyn")
    scene = with_values(case("C4 wire, 1 m at 10 s"), {"run.duration": 2.0})
    theirs = moordyn.run(scene, 5, 2e-3, 20)
    assert theirs.tension[0] == pytest.approx(theirs.tension[1], rel=1e-3)


def test_a_peer_that_cannot_run_a_case_is_shown_with_the_reason(monkeypatch):
    def cannot(scene):
        raise deck.NotTranslated("it cannot let go")

    monkeypatch.setattr(compare, "CODES", {"theirs": lambda scene, segments: [("5 segments", cannot)]})
    short = compare.Case("free_chain", {**SHIFTED, "cable.axial_stiffness": 1e4, "run.duration": 3.0}, ("position",))
    monkeypatch.setattr(compare, "CASES", {"short": short})
    (row,) = compare.compare("short", [0.01], told=lambda line: None)
    assert row.by_itself.why == row.by_ours.why == "it cannot let go"
    assert "| it cannot let go | - | not reached |" in compare.markdown([row])


def test_the_table_gives_both_ratios_or_says_that_they_were_not_reached():
    ours, coarse, none = compare.Reached("ours", 0.001), compare.Reached("coarse", 0.02), compare.Reached("", math.inf, "it stopped")
    text = compare.markdown([compare.Row("a", 0.01, ours, "theirs", coarse, none, 0.003)])
    assert "| coarse | 0.02 | 20.0 | it stopped | - | not reached | 3.0e-03 |" in text


def test_a_code_is_judged_by_a_finer_mesh_of_its_own_and_by_our_reference(monkeypatch):
    """A code that converges to a wrong answer: twice ours, whatever the mesh."""

    def wrong(scene, segments):
        run = timed(scene)
        return dataclasses.replace(run, position=(2.0 + 1e-4 / segments) * run.position, seconds=0.01 * segments)

    def settings(scene, segments):
        return [(f"{segments} segments", partial(wrong, segments=segments))]

    monkeypatch.setattr(compare, "CODES", {"theirs": settings})
    short = compare.Case("free_chain", {**SHIFTED, "cable.axial_stiffness": 1e4, "run.duration": 3.0}, ("position",))
    monkeypatch.setattr(compare, "CASES", {"short": short})
    (row,) = compare.compare("short", [0.01], (10, 20), told=lambda line: None)
    assert row.by_itself.setting == "10 segments" and row.by_itself.cost == pytest.approx(0.1 / 3.0)
    assert row.by_ours.cost == math.inf and row.by_ours.why.startswith("none of its runs is nearer than")
    assert row.apart > 0.5
