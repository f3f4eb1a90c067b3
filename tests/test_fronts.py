"""An end that is suddenly free, and the front that runs up from it."""

import numpy as np
import pytest
from chain_support import drive, every, make, still
from parting_support import MAY_PART, mooring

JUMPS = {
    "let go in the run": {"parting__time": 0.1},
    "let go at the start": {"lower_end__released": True},
    "no more held aside": {"lower_end": {}, "lower_end__release_force": 8e4},
}


@pytest.mark.parametrize("way", JUMPS)
@pytest.mark.parametrize("lam", [-0.9, -0.5, 0.0])
def test_an_end_that_is_suddenly_free_goes_as_fast_in_long_steps_as_in_short_ones(way, lam):
    """A taut wire that goes slack behind the front: nothing would take back what the end overshoots in a step."""
    changes = dict(JUMPS[way])
    wire = {
        "cable": {"length": 100.0, "mass_per_length": 3.0, "axial_stiffness": 5e7, "axial_damping": 2e5, **MAY_PART},
        "lower_end": changes.pop("lower_end", {"anchored": True, "x": -60.0, "z": -80.17}),
    }
    ends = []
    for step in (0.02, 1e-3):
        model = make(wire, solver__nodes=41, solver__time_step=step, solver__lambda_infinity=lam, **changes)
        run = drive(model, every(0.02, 0.2), still())
        ends.append(np.hypot(run["body.vx"], run["body.vz"]))
    after = slice(7, 11)  # 0.04 s and more after it
    assert ends[1][after].min() > 4.0
    assert ends[0][after] == pytest.approx(ends[1][after], rel=0.03)


@pytest.mark.parametrize("sliver", [1e-4, 2e-3])
def test_a_front_is_resolved_whatever_the_communication_steps(sliver):
    """One that is short, after the cut or just before its end: neither lets the next one be long, nor all the next ones short."""
    wire = {
        "cable": {"length": 100.0, "mass_per_length": 3.0, "axial_stiffness": 5e7, "axial_damping": 2e5, **MAY_PART},
        "lower_end": {"anchored": True, "x": -60.0, "z": -80.17},
    }
    speeds, steps = [], []
    even = every(0.02, 0.3)
    for times in (even, np.sort([*even, 0.1 + sliver]), np.sort([*even[even != 0.1], 0.1 + sliver]), even):
        model = make(wire, solver__nodes=41, solver__time_step=0.02, solver__lambda_infinity=-0.5, parting__time=0.1)
        run = drive(model, times, still())
        speeds.append(np.hypot(run["body.vx"][-1], run["body.vz"][-1]))
        steps.append(run["solver.steps"][-1])
    assert speeds == pytest.approx([speeds[0]] * 4, rel=0.01)
    assert max(steps) < 1.5 * min(steps)


def test_a_member_that_overshoots_is_told():
    """lambda_infinity above 0, where an end is let go in a run or at the start, and the cable goes slack behind the front."""
    said = "solver.lambda_infinity = 0.3, above 0, where an end is suddenly free: "
    for changes, told in (
        ({"lower_end__released": True}, True), ({"parting__time": 0.1}, True), ({}, False),
        ({"parting__time": 0.1, "cable__compressible": True}, False),
    ):  # fmt: skip
        model = mooring("chain in drag", solver__lambda_infinity=0.3, **changes)
        drive(model, every(0.1, 0.3), still())
        assert any(text.startswith(said) for text in model.warnings()) == told
    model = mooring("chain in drag", solver__lambda_infinity=-0.3, parting__time=0.1)
    drive(model, every(0.1, 0.3), still())
    assert not any("suddenly" in text for text in model.warnings())
