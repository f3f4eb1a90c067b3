"""A failed step says when, where and how badly, and what to try; what came before it is kept."""

from __future__ import annotations

import re

import numpy as np
import pytest

from cable_model import CableChain, SolverError, load, simulate
from cable_model.simulation import COLUMNS


def test_a_step_without_a_solution_ends_with_time_node_size_and_remedy_and_the_rows_before():
    model, rows = CableChain(load("hanging_chain")), []

    def spoil(time):
        if time > 0.09:
            model.state[-200] = np.nan

    with pytest.raises(SolverError) as caught:
        simulate(model, duration=0.2, progress=spoil, keep=rows.append)
    assert re.fullmatch(
        r"CableChain at t = 0\.1 s: Newton's method found no solution even with steps a millionth of solver\.time_step "
        r"\(largest last Newton change nan at node \d+ from the lower end\)\. Try a smaller solver\.time_step, "
        r"solver\.lambda_infinity = -0\.5, more slack_damping, or a smoother motion\. Results before this time are valid\.",
        str(caught.value),
    )
    assert len(rows) == 6
    assert caught.value.result.table == pytest.approx(np.array(rows))
    assert caught.value.result.columns == COLUMNS
