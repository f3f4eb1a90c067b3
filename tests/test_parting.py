"""A cable that is cut at a time or by an input, at its lower end, between its ends or at its top."""

import numpy as np
import pytest
from chain_support import drive, every, make, still, view
from parting_support import IMPACT, KINDS, MOORING, PULL, SLOW_KINDS, SPEED, STRING, drifting, mooring

from cable_model.errors import ParameterError, SolverError
from cable_model.kernels import header
from cable_model.kernels.doubt import PARTS
from cable_model.signals import INPUTS, OUTPUTS
from cable_model.simulation import simulate


@pytest.mark.parametrize("kind", [*KINDS, *(pytest.param(kind, marks=pytest.mark.long) for kind in SLOW_KINDS)])
def test_let_go_in_a_run_it_falls_as_one_that_is_let_go_at_the_start(kind):
    """From the same rest, so that nothing but the time differs: places, forces and the tensions along it."""
    later = 0.5
    start = still()
    at_once, in_time = mooring(kind, lower_end__released=True), mooring(kind, parting__time=later)
    shapes = [], []
    one = drive(at_once, every(0.1, 2.0), start, lambda _: shapes[0].append(at_once.shape(31)))
    other = drive(in_time, every(0.1, 2.5), start, lambda _: shapes[1].append(in_time.shape(31)))
    before = round(later / 0.1)
    assert np.ptp(other["body.z"][: before + 1]) < 1e-6
    assert other["cable.parted"].tolist() == [0.0] * before + [1.0] * (len(other["time"]) - before)
    there, later_there = np.array(shapes[0])[1:], np.array(shapes[1])[before + 1 :]
    moved = np.ptp(there[:, :, :3], axis=0).max()
    assert moved > 0.2
    assert np.abs(later_there - there)[:, :, :3].max() < 1e-4 * moved
    assert np.abs(later_there - there)[:, :, 3].max() < 1e-3 * one["top.tension"][0]
    assert np.abs(other["top.force_mean_x"][before + 1 :] - one["top.force_mean_x"][1:]).max() < 1e-3 * one["top.tension"][0]
    steps = other["solver.steps"][-1] - other["solver.steps"][before]
    assert steps == pytest.approx(one["solver.steps"][-1], rel=0.02)
    assert any(text.startswith("cable parted at t = 0.5 s with ") for text in in_time.warnings())
    assert not any("parted" in text for text in at_once.warnings())


def test_cut_between_its_ends_it_goes_on_as_one_of_that_length_whose_load_is_let_go():
    """What hung below is a body of its mass on the other one.  Equal cells: the same equations from there on."""
    vertical = {"lower_end": {}, "water": {"density": 0.0}}
    swing = {"top__motion_order": 2}
    whole = make({**MOORING, **vertical}, solver__nodes=41, solver__grading=1.0, parting__time=0.3, parting__place=50.0, **swing)
    half = make(
        {**MOORING, **vertical}, solver__nodes=21, solver__grading=1.0, parting__time=0.3, cable__length=50.0, body__mass=200.0, **swing
    )

    one, other = drive(whole, every(0.05, 0.3), drifting), drive(half, every(0.05, 0.3), drifting)
    assert whole.state[header.NODES] == 21
    assert one["cable.remaining_length"][-1] == other["cable.remaining_length"][-1] == pytest.approx(50.0, rel=1e-12)
    # the halves have swung a little differently by then, and now go on from one state
    here, there = view(whole), view(half)
    assert here.mesh == pytest.approx(there.mesh, rel=1e-12)
    assert here.y == pytest.approx(there.y, abs=1e-3)  # velocities too
    assert here.force == pytest.approx(there.force, rel=1e-3)
    gone = whole.nodes()
    assert np.array_equal(gone[:20, :3], np.repeat(gone[20:21, :3], 20, axis=0))
    assert whole.arc_lengths()[:21].tolist() == [0.0] * 21
    assert whole.arc_lengths()[20:] == pytest.approx(half.arc_lengths(), rel=1e-12)
    assert gone[20:, :3] == pytest.approx(half.nodes()[:, :3], abs=1e-3)
    half.state[header.HEADER :] = whole.state[header.HEADER :][: len(half.state) - header.HEADER]
    for model in (whole, half):
        for k in range(20):
            t = 0.3 + 0.02 * k
            model.advance(t, 0.02, drifting(t), drifting(t + 0.02))
    assert whole.nodes()[20:] == pytest.approx(half.nodes(), abs=1e-6)
    assert whole.outputs[:3] == pytest.approx(half.outputs[:3], rel=1e-9)


@pytest.mark.parametrize(("place", "left"), [(0.0, 100.0), (50.0, 50.0)])
def test_the_pull_leaves_a_string_as_dalembert_has_it(place, left):
    """Behind the front that the cut sends up the string is without tension and goes at T/sqrt(EA m); it comes back as pressure."""
    run = drive(make(STRING, parting__time=0.1, parting__place=place), every(0.002, 0.1 + 2.9 * left / SPEED), still())
    t, way = run["time"] - 0.1, left / SPEED
    assert run["top.tension"][t < 0.9 * way] == pytest.approx(PULL, rel=2e-3)
    behind = (t > 0.1 * way) & (t < 1.0 * way)
    assert np.mean(run["body.vz"][behind]) == pytest.approx(IMPACT, rel=0.01)
    pressed = (t > 1.1 * way) & (t < 2.8 * way)
    assert np.mean(run["top.tension"][pressed]) == pytest.approx(-PULL, rel=0.02)
    assert run["body.tension"][t > 1e-9].tolist() == [0.0] * int(np.sum(t > 1e-9))


def test_a_cable_that_is_cut_at_its_top_leaves_nothing():
    model = make(STRING, parting__time=0.1049, parting__place=100.0)
    run = drive(model, every(0.01, 0.2), still((0.0, 0.0, 0.0)))
    after = run["time"] > 0.1049
    for name in ("top.force_x", "top.force_z", "top.tension", "body.tension", "cable.tension_max", "cable.remaining_length"):
        assert not run[name][after].any(), name
    assert run["cable.parted"].tolist() == [0.0] * 11 + [2.0] * 10
    (told,) = model.warnings()
    assert told.startswith("cable parted at its top at t = 0.1049 s with 100 m below: nothing is left.")
    assert run["top.force_mean_z"][11] == pytest.approx(-0.49 * PULL, rel=1e-6)
    assert not run["top.force_mean_z"][12:].any()
    assert not model.shape()[:, 3].any()
    assert np.array_equal(model.shape()[:, :3], np.zeros((11, 3)))
    wound, aside = np.zeros(10), np.zeros(9)
    wound[9] = aside[1] = 0.5
    for inputs, text in ((wound, "the winch turned"), (aside, "left the vertical plane")):
        with pytest.raises(SolverError, match=text):
            model.step(0.2, 0.01, inputs)
    model.step(0.2, 0.01, np.array([0.0, 0.0, 0.5, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0]))
    assert model.outputs[OUTPUTS.index("body.z")] > 0.0


def test_a_cable_that_a_winch_has_paid_out_may_lose_more_than_it_had():
    model = make(
        MOORING, cable__length=30.0, lower_end__x=-10.0, lower_end__z=-25.0, winch__fitted=True, parting__time=13.0, parting__place=30.0
    )

    def paying_out(t):
        inputs = np.zeros(10)
        inputs[9] = 8.0
        return inputs

    run = drive(model, every(0.1, 20.0), paying_out)
    assert run["winch.paid_out"][-1] == pytest.approx(160.0, rel=1e-9)
    gone = 30.0 + 160.0 - run["cable.remaining_length"][-1]
    assert gone == pytest.approx(7 * (30.0 + 13.0 * 8.0) / 30.0, rel=1e-6)  # to the seventh node of 31
    assert gone > 30.0
    inputs = np.zeros(10)
    inputs[9] = -30.0
    for k in range(20):
        model.step(20.0 + 0.1 * k, 0.1, inputs)
    with pytest.raises(SolverError, match="the winch hauled in the whole cable"):
        for k in range(60):
            model.step(22.0 + 0.1 * k, 0.1, inputs)


def test_what_is_cut_from_a_free_end_is_a_cell_at_least():
    model = make({**MOORING, "lower_end": {}}, parting__time=0.2, parting__place=1.0, solver__grading=1.0)
    run = drive(model, every(0.1, 0.4), still())
    assert run["cable.remaining_length"][-1] == pytest.approx(100.0 - 100.0 / 30.0)


def test_profiles_of_what_is_left_are_its_own():
    """A straight cable has no curvature, where it was cut neither."""
    model = make({**MOORING, "lower_end": {}}, parting__time=0.2, parting__place=40.0)
    run = simulate(model, 0.4, 0.1)
    along = run.profiles()
    assert np.abs(along.curvatures).max() < 1e-9
    assert along.arc_lengths[-1, -1] == pytest.approx(run["cable.remaining_length"][-1])


@pytest.mark.parametrize("nodes", [3, 4])
def test_of_a_few_cells_what_can_be_simulated_is_left(nodes):
    rope = {"cable": {"length": 40.0, "mass_per_length": 2.0, "axial_stiffness": 1e6, "axial_damping": 1e4}, "body": {"mass": 50.0}}
    for place, left in ((0.0, 40.0), (40.0 / (nodes - 1), 40.0 - 40.0 / (nodes - 1))):
        model = make({**rope, "solver": {"nodes": nodes, "grading": 1.0}}, parting__time=0.1, parting__place=place)
        run = drive(model, every(0.1, 30.0), still())
        if nodes == 3 and place > 0.0:
            left = 0.0
        assert run["cable.remaining_length"][-1] == pytest.approx(left, abs=1e-9)
        assert np.mean(run["top.force_mean_z"][150:]) == pytest.approx(-2.0 * 9.80665 * left, rel=1e-3, abs=1e-9)


def test_when_it_parts_does_not_depend_on_the_communication_steps():
    """A cut within steps of any length, some of them too short for an internal one."""
    ends = []
    for seed in (0, 1, 2):
        model = mooring("chain in drag", parting__time=0.777, solver__time_step=0.0025)
        random = np.random.default_rng(seed)
        times = np.unique(np.round(random.uniform(0.0, 1.2, 40), 4 if seed else 1))
        times = np.array([0.0, *times[(times > 0.0) & (times < 1.2)], 1.2])
        drive(model, times, still())
        assert model.state[header.DOUBT + 2 * PARTS] == pytest.approx(0.777, abs=1e-12)
        ends.append(model.positions())
    assert ends[1] == pytest.approx(ends[0], abs=1e-3)
    assert ends[2] == pytest.approx(ends[0], abs=1e-3)
    assert np.abs(ends[0][0] - [-60.0, 0.0, -70.0]).max() > 0.3


def test_a_cut_is_not_missed_by_the_rounding_of_a_hosts_times():
    """A step that a host says begins a little after where the last one ended, with the cut between both."""
    model = make(STRING, parting__time=0.1 + 4e-10)
    model.initialize(still()(0.0))
    for k in range(2):
        model.step(0.05 * k, 0.05, still()(0.0))
    model.step(0.1 + 8e-10, 0.05, still()(0.0))
    assert model.outputs[OUTPUTS.index("cable.parted")] == 1.0


@pytest.mark.parametrize("damping", [0.0, 245.0])
@pytest.mark.parametrize("times", [(0.25, 0.5 - 1e-9, 0.5, 0.5 + 1e-6), (0.25, 0.5 - 1e-6, 0.5 + 1e-9, 0.51), (0.25, 0.5 + 1e-7, 0.51)])
def test_slivers_about_a_cut_make_no_tensions(damping, times):
    """A taut string's, before any front is back, are at most what pulled there; rates over a sliver would be those of rounding."""
    model = make(STRING, parting__time=0.5, cable__axial_damping=damping, solver__time_step=0.1, solver__nodes=51)
    run = drive(model, np.array([0.0, *times]), still())
    assert run["cable.tension_max"].max() == pytest.approx(PULL, rel=1e-5)
    assert run["cable.parted"][-1] == 1.0
    assert model.shape()[:, 3].max() < PULL * (1.0 + 1e-5)
    told = run["top.force_mean_z"][1:] * np.diff(run["time"])
    assert -np.sum(told) == pytest.approx(PULL * times[-1], rel=1e-6)


@pytest.mark.parametrize("when", [0.25, 0.6])
def test_a_state_saved_before_or_after_it_parts_goes_on_bit_for_bit(when):
    model = mooring("friction on a seabed", parting__time=0.5)
    model.initialize(still()(0.0))
    rows = []
    for k in range(20):
        if abs(0.05 * k - when) < 1e-9:
            saved, first = model.state.copy(), k
        model.step(0.05 * k, 0.05, still()(0.0))
        rows.append(np.concatenate((model.outputs, model.nodes().ravel())))
    model.state[:] = saved
    for k in range(first, 20):
        model.step(0.05 * k, 0.05, still()(0.0))
        assert np.array_equal(np.concatenate((model.outputs, model.nodes().ravel())), rows[k])
    model.initialize(still()(0.0))
    assert model.outputs[OUTPUTS.index("cable.parted")] == 0.0


def test_the_audit_of_a_cable_that_is_cut_closes():
    """What has gone took its energy with it; what is left gains and loses what is done to it."""
    model = mooring("audited", parting__time=0.5, parting__place=40.0)
    run = drive(model, every(0.05, 2.0), drifting)
    assert run["cable.parted"][-1] == 1.0
    kinetic = 0.5 * 4.0 * 60.0 * 4.0**2  # J, of what is left at 4 m/s, more than it gets
    assert model.audit.exchanged < 4.0 * 9.81 * 60.0 * 20.0 + kinetic
    assert np.abs(run["audit.energy"]).max() < 0.01 * model.audit.exchanged
    assert run["audit.momentum"].max() < 0.01 * model.audit.forces


def test_a_winch_goes_on_winding_what_is_left():
    model = make(MOORING, winch__fitted=True, winch__speeds=[[0.0, 2.0]], parting__time=1.0, parting__place=40.0)
    run = simulate(model, 3.0, 0.25)
    left = run["cable.remaining_length"]
    before = run["time"] < 1.0
    assert left[before] == pytest.approx(100.0 + 2.0 * run["time"][before], rel=1e-12)
    assert np.diff(left[run["time"] >= 1.0]) == pytest.approx(0.5, rel=1e-9)
    assert left[run["time"] == 1.0][0] == pytest.approx(62.0, abs=2.5)  # 40 m below, but for half a cell


@pytest.mark.parametrize("at_end", [False, True])
def test_an_input_lets_the_lower_end_go(at_end):
    """As a cut at that time: the start of the step in which it turns true, or where inputs are given at its end, the end."""
    told = mooring("chain in drag", parting__by_input=True, top__inputs_at=int(at_end))
    timed = mooring("chain in drag", parting__time=0.5, top__inputs_at=int(at_end))
    for model in (told, timed):
        model.initialize(still()(0.0))
    for k in range(20):
        let_go = np.zeros(len(INPUTS))
        let_go[INPUTS.index("lower_end.let_go")] = float(k >= (9 if at_end else 10))
        told.step(0.05 * k, 0.05, let_go)
        timed.step(0.05 * k, 0.05, still()(0.0))
        assert told.outputs[OUTPUTS.index("cable.parted")] == float(k >= (9 if at_end else 10))
    assert told.nodes() == pytest.approx(timed.nodes(), abs=1e-6)


def test_what_does_not_go_with_parting_is_refused():
    free = {**MOORING, "lower_end": {}}
    cases = [
        (MOORING, {"parting__place": 20.0}, "parting.place = 20 m: must be 0 where nothing cuts the cable"),
        (free, {"parting__time": 2.0}, "parting.place = 0 m: must be > 0 where the lower end is free"),
        (MOORING, {"parting__time": -1.0}, "parting.time = -1 s: must be >= 0"),
        (MOORING, {"solver__grid": "box", "parting__time": 2.0, "parting__place": 1.0}, "parting.time = 2 s: must be 0 on the box grid"),
    ]  # fmt: skip
    for base, changes, text in cases:
        with pytest.raises(ParameterError) as told:
            make({**base, "cable": {**base["cable"], "breaking_tension": 0.0}}, **changes)
        assert str(told.value).startswith(text)
    model = make(MOORING, parting__time=1.0, parting__place=100.5)
    with pytest.raises(ParameterError, match=r"cable.length = 100 m: must be >= parting.place = 100.5"):
        model.initialize(still()(0.0))
    model = make(MOORING)
    model.initialize(still()(0.0))
    let_go = np.zeros(len(INPUTS))
    let_go[-1] = 1.0
    with pytest.raises(SolverError, match=r"the input lower_end.let_go is true, but is not asked for"):
        model.step(0.0, 0.1, let_go)
