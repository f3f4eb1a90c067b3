"""Peers: where MoorDyn is installed it agrees with the chain on what both can do; what is not translated is refused."""

import dataclasses
import math
import sys
from functools import partial

import numpy as np
import pytest

from cable_model.errors import ParameterError
from cable_model.lab.cost_cases import SHIFTED
from cable_model.lab.hard.cases import BASIN, basin_label
from cable_model.lab.peers import cabledyn, compare, deck, moordyn
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
