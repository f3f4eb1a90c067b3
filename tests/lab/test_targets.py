"""What is sought beside four other codes: the runs are as good as asked where their table says so, and the table says where not."""

import math

import numpy as np
import pytest

from cable_model.lab.cost_cases import SHIFTED
from cable_model.lab.hard import basin
from cable_model.lab.peers import targets
from cable_model.lab.published.modes import displaced_tip
from cable_model.studies.timed import timed


@pytest.fixture(autouse=True)
def once(monkeypatch):
    monkeypatch.setattr(targets, "REPETITIONS", 1)


def test_tip_of_the_displaced_chain_lags_behind_a_fast_shift_and_follows_a_slow_one():
    early = displaced_tip(np.array([0.4, 1.0, 1.9]), 0.4, count=400)  # the wave comes to the tip after 2 s
    assert early == pytest.approx([0.0, 0.0, 0.0], abs=1e-6)
    slow = displaced_tip(np.array([0.0, 100.0, 200.0, 210.0]), 200.0)
    assert slow == pytest.approx([0.0, 0.5, 1.0, 1.0], abs=1e-3)


def test_fine_chain_follows_the_displaced_chains_series():
    scene = targets.scene_at("free_chain", SHIFTED, 101, 0.0025, -1.0)
    assert targets.shift_error(scene, timed(scene)) < 3e-4


@pytest.mark.parametrize("case", [targets.free_chain, targets.sphere_on_cable, targets.wire])
def test_chain_is_as_good_as_is_sought(case):
    outcome = case()
    assert [sought.words for sought in outcome.sought if not sought.met] == []
    assert outcome.cost > 0.0 and math.isfinite(outcome.allowed)


def test_a_periodic_series_has_no_scatter(monkeypatch):
    times = 0.01 * np.arange(1500)
    noise = np.random.default_rng(1).normal(size=1500)
    monkeypatch.setattr(basin, "series", lambda period: (times, np.sin(2.0 * np.pi * times / period) ** 3))
    assert basin.scatter(1.25) < 1e-12
    monkeypatch.setattr(basin, "series", lambda period: (times, np.sin(2.0 * np.pi * times / period) ** 3 + 0.02 * noise))
    assert basin.scatter(1.25) == pytest.approx(0.01, rel=0.1)


def test_a_tension_is_judged_by_its_mean_cycle_maxima_and_by_its_series(monkeypatch):
    samples = np.arange(12 * 125 + 1) / 125.0
    measured = basin.maxima()[:, 2]
    found = basin.maxima_error(lambda radius, period: 50.0 - 3.0 * (1.0 - np.cos(2.0 * np.pi * samples)))
    assert found == pytest.approx(math.sqrt(np.mean((50.0 - measured) ** 2)))
    times = 0.01 * np.arange(1500)
    monkeypatch.setattr(basin, "series", lambda period: (times, 20.0 + 10.0 * np.sin(2.0 * np.pi * times / period)))
    assert basin.miss(20.0 + 10.0 * np.cos(2.0 * np.pi * samples), 1.25) == pytest.approx(0.0, abs=0.003)  # at whatever phase
    assert basin.miss(22.0 + 10.0 * np.cos(2.0 * np.pi * samples), 1.25) == pytest.approx(0.1, abs=0.001)


def test_table_scales_the_costs_to_this_machine_and_says_what_is_not_met():
    sought = (targets.Sought("good", 0.5, 1.0), targets.Sought("bad", 2.0, 1.0))
    found = targets.Targets((targets.Outcome("a", "peer", "ours", sought, 0.3, 1.0),), 0.5 * targets.YARDSTICK_COST, 0.02)
    text = targets.markdown(found)
    assert "| good | 0.5 | 1 | yes |" in text
    assert "| bad | 2 | 1 | **no** |" in text
    assert "| processor seconds a simulated second | 0.3 | 0.5 | yes |" in text
