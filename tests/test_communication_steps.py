"""Whatever pattern of communication steps a host takes, the answer is that of equal steps: both models, both grids, plane and space."""

import itertools
from collections.abc import Callable, Iterable

import numba
import numpy as np
import pytest
from chain_support import HANGING, SECOND_MODE, WIRE, Motion, make, swing
from tow_reference import WET, circling, tow

from cable_model import TowCable
from cable_model.cable_chain import CableChain
from cable_model.kernels import header
from cable_model.model import Model
from cable_model.scene import from_dict, with_values
from cable_model.signals import OUTPUTS

SLOW = bool(numba.config.DISABLE_JIT)  # plain Python: fewer steps
SWAY = swing((0.02, 0.0, 0.0), SECOND_MODE)
TOW = swing((0.5, 0.0, 0.5), 2.0 * np.pi / 8.0, ramp_time=4.0, phase=(0.0, 0.0, np.pi / 2.0))
FINE = HANGING | {"solver": HANGING["solver"] | {"time_step": 0.005}}
TAUT = {  # a level wire, 1 % longer than it is when slack
    "cable": {"length": 50.0, "mass_per_length": 1.0, "axial_stiffness": 1e6},
    "lower_end": {"anchored": True},
    "top": {"position": [50.5, 0.0, 0.0]},
    "solver": {"nodes": 51, "time_step": 0.01},
}
SHAKEN = swing((0.0, 0.0, 0.01), 8.0, ramp_time=0.5)
SEEN = [OUTPUTS.index(name) for name in ("top.force_x", "top.force_z", "top.tension", "body.x", "body.z")]
Scene = tuple[dict, Motion, float]
SCENES: dict[str, Scene] = {"hanging": (FINE, SWAY, 2.0), "wire": (WIRE, TOW, 10.0), "taut": (TAUT, SHAKEN, 2.0)}


def at_the_end_of_the_wire(motion: Motion) -> Motion:
    return lambda t: motion(t) + 50.5 * np.eye(9)[0]


def chain(name: str, **changes: object) -> tuple[CableChain, Motion]:
    base, motion, _ = SCENES[name]
    return make(base, **changes), at_the_end_of_the_wire(motion) if name == "taut" else motion


def run(model: Model, motion: Motion, steps: Iterable[float], held: bool = True, given: int = 0) -> tuple[np.ndarray, np.ndarray]:
    """Times and outputs; the top's inputs are `given` at the start (0) of the steps, as FMI does, or their end (1), or at both."""
    time = 0.0
    model.initialize(motion(time))
    times, rows = [time], [model.outputs.copy()]
    for step in steps:
        if held:
            model.step(time, step, motion(time + given * step))
        else:
            model.advance(time, step, motion(time), motion(time + step))
        time += step
        times.append(time)
        rows.append(model.outputs.copy())
    return np.array(times), np.array(rows)


def equal(step: float, duration: float) -> list[float]:
    return [step] * round(duration / step)


def random_steps(longest: float, duration: float, decades: float = 7.0) -> list[float]:
    """Log-uniform over seven decades, as many as reach the duration."""
    draw = np.random.default_rng(1)
    steps = []
    while sum(steps) < duration:
        steps.append(longest * 10.0 ** draw.uniform(-decades, 0.0))
    return steps[:-1]


def at(times: np.ndarray, known: tuple[np.ndarray, np.ndarray]) -> np.ndarray:
    return np.array([np.interp(times, known[0], known[1][:, k]) for k in SEEN])


def deviations(found: tuple[np.ndarray, np.ndarray], known: tuple[np.ndarray, np.ndarray]) -> np.ndarray:
    """Largest differences of the outputs SEEN, over their ranges; those of a point that is held are over a metre."""
    exact = at(found[0], known)
    size = np.ptp(exact, axis=1)
    size[size < 1e-6] = 1.0
    return np.abs(found[1][:, SEEN].T - exact).max(axis=1) / size


@pytest.mark.parametrize("held", [True, False], ids=["sampled", "known"])
@pytest.mark.parametrize("lam", [-0.9, -0.5, 0.0])
@pytest.mark.parametrize(("name", "grid"), [("hanging", "staggered"), ("hanging", "box"), ("wire", "staggered"), ("taut", "staggered")])
def test_random_communication_steps_over_seven_decades_change_no_answer(name, grid, lam, held):
    """Within a hundredth of the range, and what equal steps of the longest size err by."""
    base, _, duration = SCENES[name]
    duration = 0.1 * duration if SLOW else duration
    longest = base["solver"]["time_step"]
    model, motion = chain(name, solver__grid=grid, solver__lambda_infinity=lam)
    fine = run(model, motion, equal(0.25 * longest, duration), held=False)
    coarse = deviations(run(model, motion, equal(longest, duration), held), fine)
    found = run(model, motion, random_steps(longest, duration), held)
    assert (deviations(found, fine) < 0.01 + coarse).all()


@pytest.mark.parametrize("space", [False, True], ids=["plane", "space"])
def test_random_communication_steps_change_no_answer_of_the_tow_model(space):
    parts = WET._replace(space=True) if space else WET
    motion, duration = circling(0.5, 0.9, 2.0), 0.2 if SLOW else 5.0
    model = tow(parts)
    fine = run(model, motion, equal(0.0125, duration), held=False)
    coarse = deviations(run(model, motion, equal(0.05, duration)), fine)
    found = run(model, motion, random_steps(0.05, duration, 12.0))
    assert (deviations(found, fine) < 1e-3 + coarse).all()


@pytest.mark.parametrize(
    "rhythm", [[1.0, 0.21], [1.0] * 20 + [0.01] * 20, [0.5**k for k in range(14)]], ids=["one fifth", "blocks", "halved"]
)
@pytest.mark.parametrize("lam", [-0.9, -0.5])
def test_rhythms_of_a_host_do_not_feed_what_the_mesh_does_not_resolve(rhythm, lam):
    duration = 0.2 if SLOW else 2.0
    model, motion = chain("hanging", solver__lambda_infinity=lam)
    ends = itertools.accumulate(0.005 * part for part in itertools.cycle(rhythm))
    steps = np.diff([0.0, *itertools.takewhile(lambda end: end <= duration, ends)])
    fine = run(model, motion, equal(0.00125, duration), held=False)
    coarse = deviations(run(model, motion, equal(0.005, duration)), fine)
    assert (deviations(run(model, motion, steps), fine) < 0.01 + coarse).all()


MODELS: dict[str, Callable[[], tuple[Model, Motion]]] = {
    "staggered": lambda: chain("hanging"),
    "box": lambda: chain("hanging", solver__grid="box"),
    "anchored": lambda: chain("taut"),
    "tow": lambda: (tow(WET), circling(0.5, 0.9, 2.0)),
}


@pytest.mark.parametrize("kind", MODELS)
def test_what_the_sum_of_steps_leaves_before_a_time_costs_no_step_and_changes_nothing(kind):
    """`while t < 0.5: h = min(0.05, 0.5 - t); t += h` ends with a step of 6e-17 s; positions alone are given."""
    model, motion = MODELS[kind]()
    model._calls._order = 0
    plain = run(model, motion, [0.05] * 15)[1][-5:]
    steps, time = [], 0.0
    while time < 0.5:
        steps.append(min(0.05, 0.5 - time))
        time += steps[-1]
    assert 0.0 < steps[-1] < 1e-16
    found = run(model, motion, [*steps, *[0.05] * 5])[1][-5:]
    assert np.abs(found - plain).max(axis=0) / (np.abs(plain).max(axis=0) + 1e-3) == pytest.approx(0.0, abs=1e-6)
    assert (found[:, OUTPUTS.index("solver.steps")] == plain[:, OUTPUTS.index("solver.steps")]).all()


def wire(kind: str, order: int, inputs_at: int) -> Model:
    changed = {"top.motion_order": order, "top.inputs_at": inputs_at}
    return (
        make(WIRE, **{name.replace(".", "__"): value for name, value in changed.items()})
        if kind == "chain"
        else TowCable(
            with_values(
                from_dict({part: values for part, values in WIRE.items() if part != "solver"}), {**changed, "solver.time_step": 0.05}
            )
        )
    )


def elsewhere(motion: Motion) -> Motion:
    """Far from the origin, where positions have their rounding."""
    return lambda t: motion(t) + 100.0 * np.eye(9)[0] - 10.0 * np.eye(9)[2]


@pytest.mark.parametrize("sliver", [1e-12, 1e-9, 1e-6, 1e-4])
@pytest.mark.parametrize("inputs_at", [0, 1], ids=["at start", "at end"])
@pytest.mark.parametrize("order", [0, 1, 2])
@pytest.mark.parametrize("kind", ["chain", "tow"])
def test_slivers_among_regular_steps_leave_the_tension_alone(kind, order, inputs_at, sliver):
    """Five slivers in a row at 0.5 m of sway left 4 kN of 3 kN once; given at the end, second differences were rounding over h^2."""
    model, motion = wire(kind, order, inputs_at), elsewhere(TOW)
    regular = run(model, motion, [0.05] * 100, given=inputs_at)
    found = run(model, motion, [*[0.05] * 40, *[sliver] * 5, *[0.05] * 20, *[sliver, 0.05] * 40], given=inputs_at)
    tension = OUTPUTS.index("top.tension")
    size = np.ptp(regular[1][:, tension])
    known = np.interp(found[0], regular[0], regular[1][:, tension])
    coarse = 1e-4 + 0.1 * sliver  # by which the samples come later
    assert np.abs(found[1][:, tension] - known).max() < 0.002 * size + coarse * size
    if kind == "chain":
        assert found[1][-1, OUTPUTS.index("solver.steps")] <= regular[1][-1, OUTPUTS.index("solver.steps")]


@pytest.mark.parametrize("inputs_at", [0, 1], ids=["at start", "at end"])
@pytest.mark.parametrize("order", [0, 1, 2])
@pytest.mark.parametrize("kind", ["chain", "tow"])
def test_a_run_is_the_same_wherever_it_begins(kind, order, inputs_at):
    """The tow model took its top to have been at the origin before the start: 30 kN of 4."""
    model = wire(kind, order, inputs_at)
    here, there = (run(model, motion, [0.05] * 20, given=inputs_at)[1] for motion in (TOW, elsewhere(TOW)))
    tension = OUTPUTS.index("top.tension")
    assert there[:, tension] == pytest.approx(here[:, tension], abs=1e-6 * here[0, tension])


@pytest.mark.parametrize("order", [0, 1])
@pytest.mark.parametrize("inputs_at", [0, 1], ids=["at start", "at end"])
@pytest.mark.parametrize("kind", [*MODELS, "wire"])
@pytest.mark.parametrize("sliver", [1e-12, 1e-6])
def test_a_run_may_begin_with_slivers(kind, sliver, inputs_at, order):
    if kind == "tow":
        model, motion = MODELS[kind]()
        model._calls._order, model._calls._numbers[0].top.inputs_at = order, inputs_at
    else:
        grid = "box" if kind == "box" else "staggered"
        name = {"anchored": "taut", "wire": "wire"}.get(kind, "hanging")
        model, motion = chain(name, solver__grid=grid, top__motion_order=order, top__inputs_at=inputs_at)
    motion = elsewhere(motion) if kind != "anchored" else motion
    model.initialize(motion(0.0))
    first = model.outputs.copy()
    for _ in range(3):
        model.step(0.0, sliver, motion(0.0))
        assert model.outputs[:15] == pytest.approx(first[:15], rel=1e-6, abs=1e-6)


@pytest.mark.parametrize("kind", MODELS)
def test_a_state_saved_while_time_is_pending_goes_on_bit_for_bit(kind):
    model, motion = MODELS[kind]()
    steps = random_steps(0.01, 0.2)
    run(model, motion, steps)
    time = sum(steps)
    for step in (0.01, 1e-8, 1e-9):
        model.step(time, step, motion(time))
        time += step
    assert model.state[header.PENDING] > 0.0
    saved = model.state.copy()
    rows = []
    for _ in range(2):
        now = time
        for step in (*steps[:50], 0.01):
            model.step(now, step, motion(now))
            now += step
        rows.append((model.outputs.copy(), model.state.copy(), model.positions()))
        model.state[:] = saved
        model._work[:] = np.nan  # work is no part of the state
    for first, second in zip(*rows, strict=True):
        assert np.array_equal(first, second)


def test_a_winch_that_turns_pays_out_the_same_whatever_the_steps():
    """Its speed rises over a second to 0.2 m/s; pending time is paid out too."""
    lengths = []
    chosen = random_steps(0.05, 2.0)
    for steps in ([0.05] * 40, [*chosen, 2.0 - sum(chosen)]):
        model = make(WIRE, winch__fitted=True)
        time = 0.0
        model.initialize(np.zeros(10))
        for step in steps:
            inputs = np.zeros((2, 10))
            inputs[:, 9] = 0.2 * np.clip([time, time + step], 0.0, 1.0)
            model.advance(time, step, *inputs)
            time += step
        lengths.append((model.state[header.PAID_OUT], model.outputs[OUTPUTS.index("body.z")]))
    assert lengths[0][0] == pytest.approx(0.3, rel=1e-2)
    assert lengths[1] == pytest.approx(lengths[0], abs=2e-3)
