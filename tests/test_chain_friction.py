"""Friction along the seabed against closed forms: a chain dragged and held, its loop of hysteresis, and moorings that were laid out.

The dragged chain is elastic, lies on a bottom whose friction is f = mu w per metre, and is long enough for its far end not to move.  Its
friction is full where it has slid and that of a spring before.  With d the displacement at which a node begins to slide, the first
integral of EA u'' = friction(u), friction = min(f u/d, f), is T^2/(2 EA) = f (u - d/2) at the end that is dragged by u > d.
"""

import numpy as np
import pytest
from chain_support import drive, every, make, septic, still, view
from scipy.optimize import brentq

from cable_model import CableChain, simulate
from cable_model.errors import ParameterError
from cable_model.kernels import friction
from cable_model.kernels.audit import BED_WORK
from cable_model.kernels.contact import BASE, COLUMNS
from cable_model.kernels.seabed import Ground
from cable_model.kernels.staggered_step import Gains
from cable_model.scene import from_dict, with_values
from cable_model.tow_cable import TowCable

STIFFNESS, FRICTION, DISPLACEMENT = 1e6, 98.0, 1e-3  # EA in N, f in N/m, d in m
PULL, PULLED_IN = 0.3, 30.0  # m, s
BED, DEPTH = -50.0, 98.0 / (3e6 * 0.05)  # m: how deep it sinks in
LAID = {  # 100 m of chain of 98 N/m straight on the bottom
    "cable": {"length": 100.0, "mass_per_length": 98.0 / 9.81, "axial_stiffness": STIFFNESS, "diameter": 0.05},
    "environment": {"gravity": 9.81},
    "lower_end": {"anchored": True, "z": BED},
    "seabed": {"level": BED, "stiffness": 3e6, "friction_coefficient": 1.0},
    "solver": {"nodes": 51, "time_step": 0.05, "grading": 1.0},
}
MOORING = {
    "cable": {"length": 33.0, "mass_per_length": 0.08, "axial_stiffness": 1e4, "diameter": 0.0022},
    "environment": {"gravity": 9.81},
    "lower_end": {"anchored": True, "z": -3.0},
    "seabed": {"level": -3.0, "stiffness": 3e9, "friction_coefficient": 1.0, "friction_displacement": 1e-5, "laid_from_anchor": True},
    "solver": {"nodes": 101, "time_step": 0.01, "lambda_infinity": -0.5},
}
TOP = (32.5, 0.0, 0.3)


def drags(*turns: float, angle: float = 0.0):
    """The top goes from one displacement along the chain to the next in 30 s each, and stays at the last."""

    def motion(t: float) -> np.ndarray:
        k = min(int(t / PULLED_IN), len(turns) - 2)
        s, rate, change = septic(t - k * PULLED_IN, PULLED_IN)
        far = turns[k + 1] - turns[k]
        along = np.array([np.cos(angle), np.sin(angle), 0.0])
        place = (100.0 + turns[k] + far * s) * along
        place[2] = BED - DEPTH
        return np.concatenate([place, far * rate * along, far * change * along])

    return motion


def first_integral(u: float) -> float:
    """Tension at the end of a dragged chain, N."""
    return float(np.sqrt(2.0 * STIFFNESS * FRICTION * (u - 0.5 * DISPLACEMENT)))


# -- dragged and held


@pytest.mark.parametrize(
    ("nodes", "step"),
    [
        (51, 0.05),
        (101, 0.02),
        pytest.param(201, 0.01, marks=pytest.mark.long),
        pytest.param(51, 0.01, marks=pytest.mark.long),
        pytest.param(201, 0.05, marks=pytest.mark.long),
    ],
)
def test_a_chain_that_is_dragged_and_held_keeps_its_tension(nodes, step):
    """Right is 7672 N at the top in the limits of small cells and displacements, and 0 at the anchor, for ever."""
    run = drive(make(LAID, solver__nodes=nodes, solver__time_step=step), every(0.1, 300.0), drags(0.0, PULL))
    half_cell = 0.5 * 100.0 / (nodes - 1)  # the top's, which is prescribed and has no friction
    held = run["time"] >= PULLED_IN
    assert run["top.tension"][held] + FRICTION * half_cell == pytest.approx(first_integral(PULL), rel=1e-4)
    assert np.ptp(run["top.tension"][held]) < 1e-5 * first_integral(PULL)
    assert np.abs(run["body.tension"]).max() < 1e-3 * 9800.0  # the width of the slack law
    assert run["solver.rejected_steps"][-1] == 0


def test_cells_and_steps_that_resolve_nothing_do_not_let_newton_go_to_and_fro():
    """Of 10 m and 0.2 s: waves along the chain pass six cells within a step, and sliders turn round within an iteration."""
    run = drive(make(LAID, solver__nodes=11, solver__time_step=0.2), every(0.2, 40.0), drags(0.0, PULL, 0.2))
    assert run["solver.rejected_steps"][-1] == 0
    assert run["solver.newton_iterations"][-1] <= 5 * run["solver.steps"][-1]


def test_the_tension_decays_by_the_friction_of_each_metre_that_has_slid():
    model = make(LAID, solver__nodes=201)
    drive(model, every(0.1, 40.0), drags(0.0, PULL))
    now = view(model)
    slid = np.abs(now.sliders[:, 0]) > (1.0 - 1e-3) * DISPLACEMENT
    # the front, where springs are stretched by d, carries sqrt(EA f d)
    zone = (first_integral(PULL) - np.sqrt(STIFFNESS * FRICTION * DISPLACEMENT)) / FRICTION
    assert 100.0 - 0.5 * np.flatnonzero(slid)[0] == pytest.approx(zone, abs=1.0)  # two cells
    assert np.all(slid[np.flatnonzero(slid)[0] :])
    assert np.diff(now.force[slid]) == pytest.approx(np.full(slid.sum() - 1, 0.5 * FRICTION), rel=1e-4)


def test_pulled_to_and_fro_it_takes_the_area_of_its_loop():
    """Every branch but the first is the first at twice the size (Masing's rule): of width 2 x the loop takes 8 int_0^x T du - 4 x T(x)."""
    width = 0.12
    nodes = 201
    slow = make(LAID, solver__nodes=nodes, seabed__friction_velocity=10.0)  # dashpots that take nothing
    run = drive(slow, every(0.1, 90.0), drags(0.0, PULL, PULL - width, PULL))
    displaced = np.array([drags(0.0, PULL, PULL - width, PULL)(t)[0] for t in run["time"]])
    loop = run["time"] >= PULLED_IN
    area = np.sum(0.5 * (run["top.tension"][loop][1:] + run["top.tension"][loop][:-1]) * np.diff(displaced[loop]))
    x, d = 0.5 * width, DISPLACEMENT
    root = np.sqrt(2.0 * STIFFNESS * FRICTION)
    under = 0.5 * np.sqrt(STIFFNESS * FRICTION / d) * d**2 + 2.0 / 3.0 * root * ((x - 0.5 * d) ** 1.5 - (0.5 * d) ** 1.5)
    own = 2.0 * FRICTION * 0.5 * 100.0 / (nodes - 1) * (width - 2.0 * d)  # the loop of the top's half cell, which has no friction
    assert area == pytest.approx(8.0 * under - 4.0 * x * first_integral(x) - own, rel=2e-3)
    assert run["top.tension"][-1] == pytest.approx(run["top.tension"][300], rel=1e-4)  # the loop is closed


# -- energy


def test_friction_takes_half_the_work_of_a_drag_and_gives_none_back():
    """Work int T du = 2/3 T u, strain energy T^3/(6 EA f) = T u/3 for u >> d."""
    scene = from_dict(
        {**LAID, "seabed": {**LAID["seabed"], "damping_ratio": 0.0}, "top": {"position": [100.0, 0.0, BED - DEPTH], "motion": [
            {"kind": "ramp", "axis": "x", "velocity": 0.02, "start": 0.0, "duration": 10.0},
            {"kind": "ramp", "axis": "x", "velocity": -0.02, "start": 15.0, "duration": 10.0},
        ]}, "run": {"duration": 30.0}}
    )  # fmt: skip
    model = CableChain(with_values(scene, {"solver.audit": True, "run.output_step": 0.05}))
    by_bed: list[float] = []
    run = simulate(model, keep=lambda _: by_bed.append(float(model.state[BED_WORK])))
    lost = -np.array(by_bed)
    half_cell = FRICTION * 1.0  # N, of the top's
    taken = first_integral(PULL) * PULL / 3.0 - half_cell * PULL
    assert lost[-1] == pytest.approx(taken, rel=0.01)
    assert np.diff(lost).min() > -1e-5 * taken
    assert np.max(np.abs(run["audit.energy"])) < 1e-3 * taken


@pytest.mark.parametrize("like", [(0.0, 0.0), (0.0, 0.0, 0.0)], ids=["plane", "space"])
def test_a_slider_stores_no_more_than_it_took(like):
    """Each step, whatever the velocity and N: friction's work is at least the change of the spring's energy."""
    rng = np.random.default_rng(2)
    mu, k, c, length, h, v_share = 0.4, 3e4, 3e3, 0.7, 0.02, 2.0 / 3.0
    ground = Ground(0.0, 1e6, 0.0, 1.0, mu, k, c, 0.0, 0.0, 1e-3)
    gains = Gains(0.0, v_share, 0.0, 0.0, 1.0, h, None)
    up = (*like[1:], 1.0)
    contact, stretch = np.zeros((1, COLUMNS)), np.zeros((1, len(like)))
    slid = held = 0
    for _ in range(200):
        u = tuple(rng.choice([3e-4, 3e-2]) * rng.standard_normal(len(like)))
        force = rng.uniform(0.0, 200.0)
        level = np.array([*u[:-1], 0.0])
        contact[0, 0] = force
        contact[0, BASE : BASE + len(like)] = stretch[0]
        before = stretch.copy()
        per_force, fixed, _ = friction.friction_of(True, ground, gains, length, up, None, like, u, force, contact, 0)
        pull = force * np.array(per_force) + np.array(fixed)
        friction.keep_slider(True, ground, length, h, contact, 0, like, stretch)
        assert np.linalg.norm(pull) <= mu * force * (1.0 + 1e-12)
        stored = 0.5 * k * length * (np.sum(stretch**2) - np.sum(before**2))
        assert pull @ level * h >= stored - 1e-12
        assert pull == pytest.approx(length * (k * stretch[0] + c * (stretch[0] - before[0]) / h), abs=1e-9)
        slid += bool(np.any(per_force))
        held += bool(np.any(fixed))
    assert min(slid, held) > 20


# -- state


def test_the_springs_are_part_of_the_state():
    """Saved while the chain slides, it goes on in another model as in the first, bit for bit."""
    first, second = make(LAID), make(LAID)
    motion = drags(0.0, PULL, 0.2)
    drive(first, every(0.1, 20.0), motion)
    second.initialize(motion(0.0))
    second.state[:] = first.state
    for k in range(200, 400):
        for model in (first, second):
            model.advance(0.1 * k, 0.1, motion(0.1 * k), motion(0.1 * (k + 1)))
    assert np.array_equal(first.state, second.state)
    assert np.array_equal(first.outputs, second.outputs)


def test_a_drag_in_any_direction_is_the_one_along_x():
    plane = drive(make(LAID), every(0.1, 60.0), drags(0.0, PULL, 0.2))
    angle = 0.7
    turned = {"lower_end__y": 0.0, "solver__space": True}
    space = drive(make(LAID, **turned), every(0.1, 60.0), drags(0.0, PULL, 0.2, angle=angle))
    assert space["top.tension"] == pytest.approx(plane["top.tension"], abs=1e-5 * first_integral(PULL))
    assert space["top.force_y"] == pytest.approx(np.tan(angle) * space["top.force_x"], abs=1e-5 * first_integral(PULL))


# -- statics


def laid_catenary(mu: float) -> tuple[float, float, float]:
    """Horizontal force at touchdown and top, suspended length, and tension at the anchor, of an elastic catenary whose lying part was
    pulled over the bottom: from touchdown on it loses mu w a metre, until it is 0 [MoorPy's rows with CB = mu]."""
    length, w, stiffness, x, z = 33.0, 0.08 * 9.81, 1e4, 32.5, 3.3

    def parts(pull: float) -> tuple[float, float, float]:
        s = brentq(lambda s: pull / w * (np.hypot(1.0, w * s / pull) - 1.0) + w * s * s / (2.0 * stiffness) - z, 1e-9, length)
        lying = min(length - s, pull / (mu * w))
        end = pull - mu * w * lying
        across = pull / w * np.arcsinh(w * s / pull) + pull * s / stiffness + length - s + 0.5 * (pull + end) * lying / stiffness
        return across, s, end

    pull = brentq(lambda h: parts(h)[0] - x, 1e-2, 1e2)
    return pull, *parts(pull)[1:]


@pytest.mark.parametrize("mu", [0.3, 1.0, 3.0])  # with the last the anchor feels nothing
def test_a_mooring_laid_out_from_its_anchor_is_the_catenary_with_friction(mu):
    pull, suspended, end = laid_catenary(mu)
    w, nodes = 0.08 * 9.81, 101
    model = make(MOORING, seabed__friction_coefficient=mu)
    model.initialize(still(TOP)(0.0))
    assert -model.outputs[0] == pytest.approx(pull, rel=1e-3)
    assert model.outputs[3] == pytest.approx(np.hypot(pull, w * suspended), rel=1e-3)
    half_cell = 0.5 * mu * w * 33.0 / (nodes - 1) * (end > 0.0)  # the tension of a cell is that of its middle
    assert model.outputs[11] - half_cell == pytest.approx(end, abs=2e-3 * pull)


def test_a_cable_that_was_laid_out_stays_at_rest():
    """In space too, where it lies another way."""
    far = TOP[0] * np.array([np.cos(2.0), np.sin(2.0)])
    for top, changes in ((TOP, {}), ((*far, TOP[2]), {"solver__space": True})):
        model = make(MOORING, **changes)
        start = still(top)(0.0)
        model.initialize(start)
        before, shape = model.outputs.copy(), model.positions()
        for k in range(20):
            model.advance(0.1 * k, 0.1, start, start)
        assert model.outputs[[0, 1, 2, 3, 11]] == pytest.approx(before[[0, 1, 2, 3, 11]], abs=1e-5 * before[3])
        assert model.positions() == pytest.approx(shape, abs=1e-7)


def test_statics_have_no_friction_unless_the_cable_was_laid_out():
    with_friction, without = (make(MOORING, seabed__laid_from_anchor=False, seabed__friction_coefficient=mu) for mu in (1.0, 0.0))
    for model in (with_friction, without):
        model.initialize(still(TOP)(0.0))
    assert with_friction.outputs[:15] == pytest.approx(without.outputs[:15], rel=1e-7, abs=1e-7)
    assert not view(with_friction).sliders.any()


@pytest.mark.parametrize("changes", [{"seabed__friction_coefficient": 0.0}, {"lower_end__anchored": False}])
def test_laid_out_without_friction_or_an_anchor_is_refused(changes):
    with pytest.raises(ParameterError) as error:
        make(MOORING, **changes)
    assert str(error.value) == (
        "seabed.laid_from_anchor = True: must be false without friction and an anchor. "
        "Give seabed.friction_coefficient and set lower_end.anchored = true."
    )


def test_tow_cable_has_no_friction():
    with pytest.raises(ParameterError, match=r"for TowCable"):
        TowCable(from_dict(LAID))
