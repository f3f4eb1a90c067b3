"""Operations are counted as they are done, the longest path waits for its operands, and the note shows both beside the times."""

import json
import os
import subprocess
import sys

import pytest

from cable_model.lab.limits import absent
from cable_model.lab.limits.counting import LATENCY, Counted
from cable_model.lab.limits.measuring import Rates, machine_rates
from cable_model.lab.limits.report import Limits, markdown


@pytest.fixture
def operations(monkeypatch):
    monkeypatch.setattr(Counted, "operations", dict.fromkeys(LATENCY, 0))
    return Counted


def test_every_operation_is_counted_once_and_waits_for_its_operands(operations):
    x, y = Counted(3.0), Counted(4.0)
    result = (x * x + y * y) ** 0.5 / 5.0
    assert result == 1.0
    assert operations.operations == {"add": 1, "multiply": 2, "divide": 1, "root": 1, "sine": 0}
    # the two squares wait for nothing, so not for each other
    assert result.ready == LATENCY["multiply"] + LATENCY["add"] + LATENCY["root"] + LATENCY["divide"]


def test_operations_with_plain_numbers_count_from_either_side(operations):
    x = Counted(2.0)
    assert (1.0 + x, 1.0 - x, 3.0 * x, 1.0 / x, -x, abs(-x)) == (3.0, -1.0, 6.0, 0.5, -2.0, 2.0)
    assert operations.operations == {"add": 2, "multiply": 1, "divide": 1, "root": 0, "sine": 0}


def test_bending_and_space_cost_operations_that_a_bare_chain_does_not():
    command = [sys.executable, "-m", "cable_model.lab.limits.counting", "{}", "bare chain", "bending", "space"]
    done = subprocess.run(command, env={**os.environ, "NUMBA_DISABLE_JIT": "1"}, capture_output=True, text=True, check=True)
    counts = json.loads(done.stdout)
    for case in counts.values():
        assert case["flops"] == sum(case[kind] for kind in LATENCY)
        assert 0.0 < case["path"] < sum(case[kind] * cycles for kind, cycles in LATENCY.items())
    assert counts["bare chain"]["flops"] < counts["bending"]["flops"] < counts["space"]["flops"]
    assert counts["bending"]["path"] - counts["bare chain"]["path"] < 10.0  # the outer bands are eliminated beside the inner ones


def test_the_note_sets_counts_bounds_and_times_side_by_side():
    counts = {"bare chain": {**dict.fromkeys(LATENCY, 10.0), "flops": 400.0, "path": 25e-9}}
    found = Limits(
        counts,
        {"bare chain": 1e-7},
        {"bare chain": 2e-7},
        Rates(4e9, {"add": 1e-9}, 2e-9),
        [(100, 1e-5, 1.04), (200, 9e-6, 1.05), (300, 8e-6, 1.06)],
    )
    text = markdown(found)
    assert "| bare chain | 400 | 10 + 10 | 100 | 20 | 25 | 100 | 200 | 100 |" in text
    assert "0.30 ms for the calls, 7.00 us for each node" in text
    assert "| 200 | 1.80 | 1.70 | +5.9 % | 1.05 |" in text


def test_what_an_absent_part_never_reaches_is_cut_out_and_the_rest_is_left(tmp_path):
    assert absent.cut_out(tmp_path) > 50
    kernels = tmp_path / "cable_model" / "kernels"
    water = (kernels / "staggered_water.py").read_text(encoding="utf-8")
    assert "flow, flow_rate, flow_gradient = water_motion" not in water  # behind `if water is None: return`
    assert "barrier" in (kernels / "slack.py").read_text(encoding="utf-8")  # the bare chain has slack
    grid = (kernels / "grid.py").read_text(encoding="utf-8")
    assert "by_presence(_staggered_step, _staggered_step)" in grid


def test_the_machine_has_a_latency_for_every_kind_that_is_counted():
    assert set(machine_rates(1000).latencies) == set(LATENCY)


@pytest.mark.long
def test_kernels_without_the_code_of_absent_effects_give_the_same_bits():
    assert len(absent.measure(rounds=2, told=lambda _: None).ratios) == 2  # it raises where a bit differs
