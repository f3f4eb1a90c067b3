"""A cable that parts: cut at a time or by an input, at its lower end, between its ends or at its top, or broken by its tension."""

import numpy as np
import pytest
from chain_support import drive, every, make, observed_orders, still, view

from cable_model.errors import ParameterError, SolverError
from cable_model.kernels import header
from cable_model.kernels.watch import ALL_GONE, PARTS
from cable_model.signals import INPUTS, OUTPUTS
from cable_model.simulation import simulate

pytestmark = pytest.mark.shipped

MAY_PART = {"breaking_tension": 1e12}  # a cable that may and does not: its kernels are those of one that is let go
MOORING = {  # 100 m of light chain between a float and an anchor to its side
    "cable": {
        "length": 100.0, "mass_per_length": 4.0, "axial_stiffness": 2e6, "diameter": 0.04, "normal_drag_coefficient": 1.5,
        "added_mass_coefficient": 1.0, **MAY_PART,
    },
    "water": {"surface": False},
    "lower_end": {"anchored": True, "x": -60.0, "z": -70.0},
    "solver": {"nodes": 31, "time_step": 0.02, "lambda_infinity": -0.5},
}  # fmt: skip
SECTIONS = [
    {"length": 40.0, "mass_per_length": 9.0}, {"length": 30.0, "mass_per_length": 2.0, "axial_stiffness": 1e6}, {"length": 30.0},
]  # fmt: skip
STRING = {  # a straight one under 1000 N that nothing weighs down, whose waves run at 316 m/s
    "cable": {"length": 100.0, "mass_per_length": 1.0, "axial_stiffness": 1e5, "compressible": True, **MAY_PART},
    "environment": {"gravity": 0.0},
    "lower_end": {"anchored": True, "z": -101.0},
    "solver": {"nodes": 101, "grading": 1.0, "time_step": 1e-3, "lambda_infinity": -0.5},
}
PULL, SPEED = 1000.0, np.sqrt(1e5)
IMPACT = PULL / np.sqrt(1e5)  # m/s, of an end from which the pull falls off

KINDS = {
    "chain in drag": {},
    "bending, in space, in a current": {
        "cable__bending_stiffness": 2e3, "solver__space": True, "current__speed": 0.8, "current__direction": 0.7,
    },
    "friction on a seabed": {
        "cable__length": 120.0, "lower_end__x": -80.0, "lower_end__z": -60.0, "seabed__level": -60.0, "seabed__stiffness": 1e5,
        "seabed__friction_coefficient": 0.2,
    },
}  # fmt: skip
SLOW_KINDS = {
    "sections and a float": {"section": True},
    "steps by a tolerance": {"solver__tolerance": 1e-3, "cable__axial_damping": 1e5},
    "audited": {"solver__audit": True},
}


def mooring(kind, **changes):
    changes = {**KINDS, **SLOW_KINDS}[kind] | changes
    if not changes.pop("section", False):
        return make(MOORING, **changes)
    common = {name: value for name, value in MOORING["cable"].items() if name != "length"}
    cable = {**common, "section": SECTIONS, "body": [{"at": 70.0, "mass": 100.0, "volume": 0.3}]}
    return make({**MOORING, "cable": cable}, **changes)


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

    def motion(t):
        return np.array([0.5 * t**3, 0.0, 0.0, 1.5 * t**2, 0.0, 0.0, 3.0 * t, 0.0, 0.0])

    one, other = drive(whole, every(0.05, 0.3), motion), drive(half, every(0.05, 0.3), motion)
    assert whole.state[header.NODES] == 21
    assert one["cable.remaining_length"][-1] == other["cable.remaining_length"][-1] == pytest.approx(50.0, rel=1e-12)
    # the halves have swung a little differently by then, and now go on from one state
    here, there = view(whole), view(half)
    assert here.mesh == pytest.approx(there.mesh, rel=1e-12)
    gone = whole.nodes()
    assert np.array_equal(gone[:20, :3], np.repeat(gone[20:21, :3], 20, axis=0))
    assert whole.arc_lengths()[:21].tolist() == [0.0] * 21
    assert whole.arc_lengths()[20:] == pytest.approx(half.arc_lengths(), rel=1e-12)
    assert gone[20:, :3] == pytest.approx(half.nodes()[:, :3], abs=1e-3)
    half.state[header.HEADER :] = whole.state[header.HEADER :][: len(half.state) - header.HEADER]
    for model in (whole, half):
        for k in range(20):
            t = 0.3 + 0.02 * k
            model.advance(t, 0.02, motion(t), motion(t + 0.02))
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
    model.step(0.2, 0.01, np.array([0.0, 0.0, 0.5, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0]))
    assert model.outputs[OUTPUTS.index("body.z")] > 0.0


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
    swing = lambda t: np.array([0.5 * t**3, 0.0, 0.0, 1.5 * t**2, 0.0, 0.0, 3.0 * t, 0.0, 0.0])  # noqa: E731
    run = drive(model, every(0.05, 2.0), swing)
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
