"""A cable that breaks: when, where, and again."""

import numpy as np
import pytest
from chain_support import drive, every, make, observed_orders, still
from parting_support import STRING

from cable_model.errors import SolverError
from cable_model.kernels import header
from cable_model.kernels.doubt import ALL_GONE


def pulled_up(t):
    """A top that rises ever faster from rest: position, velocity, acceleration (9,)."""
    return np.array([0.0, 0.0, 2.0 * t**3, 0.0, 0.0, 6.0 * t**2, 0.0, 0.0, 12.0 * t])


def broken_at(**changes):
    """When and where above its anchor the string breaks as its top rises."""
    model = make(STRING, cable__breaking_tension=1700.0, solver__nodes=21, **changes)
    run = drive(model, every(0.1, 1.0), pulled_up)
    assert run["cable.parted"][-1] == 2.0  # at the top, where the wave that runs up is thrown back
    return model.state[header.DOUBT + 2 * ALL_GONE], run


def test_it_breaks_when_its_tension_reaches_what_it_bears_with_an_error_of_second_order():
    """The tension told just before is what it bears."""
    times = [broken_at(solver__time_step=step)[0] for step in (0.02, 0.01, 0.005, 0.0025)]
    assert np.ptp(times) > 1e-7
    assert min(observed_orders(times)) > 1.6
    when, _ = broken_at(solver__time_step=0.0025)
    just_before = make(STRING, cable__breaking_tension=0.0, parting__time=50.0, solver__nodes=21, solver__time_step=0.0025)
    run = drive(just_before, np.array([*every(0.0025, 0.0025 * np.floor(when / 0.0025)), when]), pulled_up)
    assert run["cable.tension_max"][-1] == pytest.approx(1700.0, rel=1e-3)


@pytest.mark.parametrize("nodes", [11, 41])
def test_what_hangs_breaks_at_its_top_where_the_tension_is_largest(nodes):
    """Rising evenly faster, a rope weighs more: it breaks when m L (g + a) is what it bears, and all of it has gone."""
    rope = {"cable": {"length": 50.0, "mass_per_length": 2.0, "axial_stiffness": 1e6, "axial_damping": 1e5}}
    bears = 2.0 * 50.0 * (9.80665 + 3.0)
    model = make({**rope, "solver": {"nodes": nodes, "time_step": 0.01}}, cable__breaking_tension=bears)

    def ever_faster(t):  # acceleration t
        return np.array([0.0, 0.0, t**3 / 6.0, 0.0, 0.0, 0.5 * t**2, 0.0, 0.0, t])

    run = drive(model, every(0.05, 4.0), ever_faster)
    gone = run["cable.parted"] > 0.0
    assert run["time"][gone][0] == pytest.approx(3.0, abs=0.08)
    assert run["cable.parted"][-1] == 2.0
    assert run["top.tension"][~gone].max() == pytest.approx(bears, rel=0.02)


def test_a_cable_of_sections_breaks_at_the_weakest_for_what_it_carries():
    sections = [
        {"length": 20.0, "breaking_tension": 900.0}, {"length": 10.0, "breaking_tension": 400.0},
        {"length": 20.0, "breaking_tension": 2000.0},
    ]  # fmt: skip
    rope = {"mass_per_length": 2.0, "axial_stiffness": 1e6, "axial_damping": 1e5, "section": sections}
    model = make({"cable": rope, "body": {"mass": 5.0}, "solver": {"nodes": 26, "time_step": 0.01}})
    weight = 5.0 + 2.0 * 20.0  # kg below the weak section, whose upper end carries 10 m more: 588 N against 400
    with pytest.raises(SolverError, match="the tension at rest is more than the cable bears"):
        model.initialize(still()(0.0))
    rope["section"][1]["breaking_tension"] = 800.0
    model = make({"cable": rope, "body": {"mass": 5.0}, "solver": {"nodes": 26, "time_step": 0.01}})
    run = drive(model, every(0.05, 5.0), lambda t: np.array([0.0, 0.0, t**3 / 6.0, 0.0, 0.0, 0.5 * t**2, 0.0, 0.0, t]))
    assert run["cable.remaining_length"][-1] == pytest.approx(20.0, rel=1e-12)
    due = 800.0 / (weight + 2.0 * 10.0) - 9.80665
    assert run["time"][run["cable.parted"] > 0.0][0] == pytest.approx(due, abs=0.1)


def test_a_cable_breaks_again_where_it_still_bears_too_little():
    sections = [{"length": 40.0, "breaking_tension": 2e4}, {"length": 60.0, "breaking_tension": 5e4}]
    rope = {"mass_per_length": 1.0, "axial_stiffness": 1e6, "axial_damping": 1e4, "section": sections}
    scene = {"cable": rope, "lower_end": {"anchored": True, "z": -100.5}, "parting": {"time": 3.0, "place": 100.0}, "solver": {"nodes": 26}}
    model = make(scene, solver__time_step=0.01)
    run = drive(model, every(0.05, 4.0), lambda t: np.array([0.0, 0.0, t**3, 0.0, 0.0, 3.0 * t**2, 0.0, 0.0, 6.0 * t]))
    assert sorted({round(float(left), 6) for left in run["cable.remaining_length"]}) == [0.0, 60.0, 100.0]
    first, second = model.warnings()[-2:]
    assert first.startswith("cable parted at t = ") and "with 60 m left above" in first
    assert second.startswith("cable parted at its top at t = 3 s with 60 m below")
