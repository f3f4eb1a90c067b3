"""Peers: where MoorDyn is installed it agrees with the chain on what both can do; what is not translated is refused."""

import math
import sys

import numpy as np
import pytest

from cable_model.errors import ParameterError
from cable_model.hard.cases import BASIN, basin_label
from cable_model.peers import compare, deck, moordyn
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
    short = compare.Case("free_chain", {**compare.SHIFTED, "cable.axial_stiffness": 1e4, "run.duration": 3.0}, ("position",))
    monkeypatch.setattr(compare, "CASES", {"short": short})
    (row,) = compare.compare("short", [0.01], told=lambda line: None)
    assert row.why == "it cannot let go"
    assert "| it cannot let go | - | not reached |" in compare.markdown([row])


def test_the_table_gives_the_ratio_or_says_that_it_was_not_reached():
    rows = [
        compare.Row("a", 0.01, "ours", 0.001, "theirs", "coarse", 0.02, 0.003),
        compare.Row("a", 0.003, "ours", 0.002, "theirs", "", math.inf, 0.003, "it stopped"),
    ]
    text = compare.markdown(rows)
    assert "| 20.0 | 3.0e-03 |" in text and "| it stopped | - | not reached |" in text


def test_a_lone_run_has_nothing_to_be_judged_by():
    lone = compare.Run("5 segments, step 1 s", lambda: ours, ours := timed(load("hanging_chain")))
    assert compare._cheapest([lone], 0.01, ("position",)) == ("", math.inf, "nothing but 5 segments, step 1 s ran")
