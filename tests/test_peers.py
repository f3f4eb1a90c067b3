"""Peers: where MoorDyn is installed it agrees with the chain on what both can do; what is not translated is refused."""

import math
import sys

import pytest

from cable_model.errors import ParameterError
from cable_model.peers import compare, deck, moordyn
from cable_model.scene import load, with_values
from cable_model.studies.timed import Scale, errors, timed


def case(name):
    return compare.CASES[name].load()


def test_a_missing_peer_is_named_with_what_to_do(monkeypatch):
    monkeypatch.setitem(sys.modules, "moordyn", None)
    with pytest.raises(ParameterError, match=r"cable-fmu\[peers\]"):
        moordyn.run(case("C4 wire, 1 m at 10 s"), 5, 1e-3)


@pytest.mark.parametrize(("name", "tension", "position"), [("C4 wire, 1 m at 10 s", 0.04, 1e-4), ("C3 sphere, EA 22 N", 0.03, 0.005)])
def test_moordyn_and_the_chain_agree(name, tension, position):
    pytest.importorskip("moordyn")
    scene = case(name)
    ours = timed(with_values(scene, {"solver.nodes": 81, "solver.time_step": 0.0125}))
    theirs = moordyn.run(scene, 10, 2e-3)
    found = errors(theirs, ours, Scale.of(ours))
    assert not theirs.error
    assert found["tension"] < tension and found["position"] < position


def test_what_is_not_translated_is_refused():
    pytest.importorskip("moordyn")
    with pytest.raises(ParameterError, match="bending"):
        moordyn.run(load("towed_body").__class__(**{**vars(load("towed_body")), "current": load("hanging_chain").current}), 5, 1e-3)
    with pytest.raises(ParameterError, match=r"anchor|seabed"):
        moordyn.run(load("basin_chain"), 5, 1e-3)


def test_a_peer_that_cannot_run_a_case_is_shown_with_the_reason(monkeypatch):
    def cannot(scene, segments, step):
        raise deck.NotTranslated("it cannot let go")

    monkeypatch.setattr(compare, "CODES", {"theirs": (cannot, lambda scene, segments: [0.01])})
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
