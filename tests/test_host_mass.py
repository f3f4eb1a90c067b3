"""host.mass: a host that steps beside the cable, and holds the force that it was foretold, moves as one system with the cable."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
import pytest
from fmu_support import Fmu, assert_same
from native_support import FLAVOURS
from test_coupling import errors, rings
from vessels import DAMPER, VESSELS, on, scene, together

from cable_model import CableChain, TowCable
from cable_model.errors import ParameterError, SolverError
from cable_model.kernels import header, host
from cable_model.model import Model
from cable_model.scene import Scene, from_dict, with_values
from cable_model.signals import OUTPUTS

FORCE, MEAN, NEXT = ([OUTPUTS.index(f"top.force{kind}_{axis}") for axis in "xyz"] for kind in ("", "_mean", "_next"))
GROWTH = OUTPUTS.index("coupling.growth")
STEPS = (0.2, 0.1, 0.05, 0.02)


def carried(name: str) -> Scene:
    return with_values(scene(VESSELS[name]), {"host.mass": VESSELS[name].mass})


@pytest.mark.parametrize(
    ("kind", "name", "heave", "force"),
    [
        (CableChain, "20 t", 5e-4, 4e-3), (CableChain, "2 t", 1e-3, 5e-3), (CableChain, "heavy 20 t", 2e-3, 4e-3),
        (TowCable, "20 t", 5e-4, 6e-3), (TowCable, "2 t", 1e-3, 6e-3),
    ],
)  # fmt: skip
def test_a_light_vessel_moves_as_in_one_system_with_its_cable(kind: type[Model], name: str, heave: float, force: float):
    """In steps of 0.1 s, both at once: of these only the first moves so under a held force, 0.25 % off."""
    exact = together(VESSELS[name], 0.1 * np.arange(161), 20)
    model = kind(carried(name))
    found = on(model, VESSELS[name], 0.1, 16.0, NEXT[2])
    wrong = errors(found, exact, 0.1)
    assert wrong[0] < heave
    assert wrong[1] < force
    assert not [text for text in model.warnings() if text.startswith(("ringing", "motion led on", "internal step"))]


# -- a host that moves along all axes


@dataclass(frozen=True)
class Floating:
    """Mass kg, springs N/m and amplitudes of the waves' force N along x, y, z."""

    mass: float
    springs: tuple[float, float, float]
    waves: tuple[float, float, float]

    def driven(self, time: float) -> np.ndarray:
        fade = 0.5 - 0.5 * math.cos(math.pi * min(time, 8.0) / 8.0)
        return fade * np.array(self.waves) * [math.cos(0.8 * time), math.sin(time + 0.5), math.sin(0.8 * time)]

    def moved(self, time: float, step: float, x: np.ndarray, v: np.ndarray, force: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """After a step under a held force, by central differences in pieces of 5 ms."""
        n = max(1, math.ceil(step / 0.005))
        d = step / n
        for k in range(n):
            half = v + 0.5 * d / self.mass * (force + self.driven(time + k * d) - self.springs * x - DAMPER * v)
            x = x + d * half
            v = half + 0.5 * d / self.mass * (force + self.driven(time + (k + 1) * d) - self.springs * x - DAMPER * half)
        return x, v


def exchange(
    model: Model,
    floating: Floating,
    steps: Sequence[float],
    told: list[int],
    first: bool = False,
    each: Callable[[int], None] | None = None,
) -> np.ndarray:
    """Time, place of the host and force less that at rest (rows, 7); `first`: the cable steps before the host, not beside it."""
    model.initialize(np.zeros(10))
    rest = model.outputs[FORCE].copy()
    time, x, v = 0.0, np.zeros(3), np.zeros(3)
    rows = [np.zeros(7)]
    for k, step in enumerate(steps):
        if each is not None:
            each(k)
        held = model.outputs[told].copy()
        model.step(time, step, np.concatenate([x, v, np.zeros(4)]))
        x, v = floating.moved(time, step, x, v, (model.outputs[told] if first else held) - rest)
        time += step
        rows.append(np.array([time, *x, *(model.outputs[FORCE] - rest)]))
    return np.array(rows)


def carrying(kind: type[Model], made: Scene, floating: Floating) -> Model:
    return kind(with_values(made, {"host.mass": floating.mass}))


def shares(found: np.ndarray, exact: np.ndarray) -> np.ndarray:
    """Errors of place and force along each axis over their own deviations; of what does not move, over the largest."""
    wrong = found[:, 1:] - np.column_stack([np.interp(found[:, 0], exact[:, 0], column) for column in exact[:, 1:].T])
    size = exact[:, 1:].std(axis=0)
    size = np.where(size > 1e-6 * size.max(), size, size.max())
    return np.sqrt((wrong**2).mean(axis=0)) / size


BENT = with_values(scene(VESSELS["20 t"]), {"cable.bending_stiffness": 500.0, "solver.space": True})
STRAIGHT = with_values(BENT, {"cable.bending_stiffness": 0.0})
MOORED = from_dict({
    "cable": {
        "length": 270.0, "diameter": 0.1, "mass_per_length": 100.0, "axial_stiffness": 4e8, "normal_drag_coefficient": 1.2,
        "tangential_drag_coefficient": 0.1, "added_mass_coefficient": 1.0,
    },
    "water": {"density": 1025.0, "surface": False},
    "lower_end": {"anchored": True, "x": 220.0, "z": -100.0},
    "seabed": {"level": -100.0, "stiffness": 3e6},
})  # fmt: skip
AFLOAT = Floating(20e3, (2.5e4, 2e4, 1e5), (2.5e4, 2e4, 1e5))
ANCHORED = Floating(200e3, (2e4, 0.0, 1e6), (1e5, 0.0, 5e5))


@pytest.mark.parametrize(
    ("kind", "made", "floating", "place", "force"),
    [
        (CableChain, BENT, AFLOAT, 1e-3, 1e-2),
        (CableChain, MOORED, ANCHORED, 2e-3, 5e-2),
        (TowCable, STRAIGHT, AFLOAT, 1e-3, 1e-2),
    ],
    ids=["bent, in space", "moored", "tow, in space"],
)
def test_surge_and_sway_are_right_too(kind: type[Model], made: Scene, floating: Floating, place: float, force: float):
    """Against steps of 0.02 s in which the cable steps first, and gives the very impulse that it has given: no lag, and no mass told."""
    exact = exchange(kind(made), floating, [0.02] * 800, MEAN, first=True)
    found = exchange(carrying(kind, made, floating), floating, [0.1] * 160, NEXT)
    wrong = shares(found, exact)
    assert (wrong[:3] < place).all()
    assert (wrong[3:] < force).all()


@pytest.mark.plain
def test_the_box_grid_has_it_too():
    values = {"solver.nodes": 9, "cable.length": 20.0, "cable.axial_stiffness": 2e6, "solver.time_step": 0.05, "solver.space": False}
    made, floating = with_values(BENT, values), Floating(2e3, (2e3, 0.0, 2e4), (1e3, 0.0, 3e4))
    staggered, box = (
        exchange(carrying(CableChain, with_values(made, {"solver.grid": grid}), floating), floating, [0.1] * 30, NEXT)
        for grid in ("staggered", "box")
    )
    assert (shares(box, staggered) < 0.02).all()


# -- impulse, steps, state


def test_what_is_told_is_the_impulse_of_the_cable():
    """All but that of a step, which is due."""
    model, steps = carrying(TowCable, STRAIGHT, AFLOAT), [0.1] * 50
    told, given = np.zeros(3), np.zeros(3)
    model.initialize(np.zeros(10))
    x, v = np.zeros(3), np.zeros(3)
    rest = model.outputs[FORCE].copy()
    for k, step in enumerate(steps):
        held = model.outputs[NEXT].copy()
        model.step(k * step, step, np.concatenate([x, v, np.zeros(4)]))
        x, v = AFLOAT.moved(k * step, step, x, v, held - rest)
        told += step * held
        given += step * model.outputs[MEAN]
    due = model.state[host.DUE : host.DUE + 3]
    assert given - told == pytest.approx(due, abs=1e-9 * abs(given[2]))
    assert (abs(due) < 0.01 * 0.1 * abs(rest[2])).all()


DRAWN = np.random.default_rng(5)
PATTERNS = {
    "slivers": [0.1, 1e-9] * 120,
    "random": list(10.0 ** DRAWN.uniform(-7.0, -1.0, 900)),
    "sudden": [0.1] * 60 + [0.01] * 100 + [0.1] * 50,
}


@pytest.mark.parametrize("kind", [CableChain, TowCable])
@pytest.mark.parametrize("steps", PATTERNS.values(), ids=PATTERNS)
def test_any_communication_steps_will_do(kind: type[Model], steps: list[float]):
    made = with_values(STRAIGHT, {"solver.space": False})
    floating = Floating(2e3, (2.5e3, 0.0, 1e4), (1e3, 0.0, 3e3))
    exact = exchange(carrying(kind, made, floating), floating, [0.02] * round(sum(steps) / 0.02 + 1.0), NEXT)
    model = carrying(kind, made, floating)
    found = exchange(model, floating, steps, NEXT)
    wrong = shares(found, exact)
    assert (wrong[:3] < 2e-3).all()
    assert (wrong[3:] < 5e-2).all()
    assert not rings(model)


@pytest.mark.parametrize("at", [20, 21])
@pytest.mark.parametrize("kind", [CableChain, TowCable])
def test_a_run_goes_on_from_a_saved_state(kind: type[Model], at: int):
    """After a step, and after a sliver."""
    model = carrying(kind, STRAIGHT, AFLOAT)

    def renewed(k: int) -> None:
        if k == at:
            saved, outputs = model.state.copy(), model.outputs.copy()
            model.initialize(np.zeros(10))
            model.step(0.0, 0.1, np.array([0.0, 0.0, 0.0, 0.5, 0.5, 0.5, 0.0, 0.0, 0.0, 0.0]))
            model.state[:], model.outputs[:] = saved, outputs

    steps = [0.1, 1e-8] * 20
    assert np.array_equal(exchange(model, AFLOAT, steps, NEXT), exchange(model, AFLOAT, steps, NEXT, each=renewed))


def test_a_slope_that_is_no_longer_right_is_renewed():
    """A line of 20 m that falls with its body from nearly level turns its stiff axis; with its first slope the force is 6 % off."""
    made = with_values(STRAIGHT, {"solver.space": False, "cable.length": 20.0, "host.mass": 500.0})
    falling = Floating(500.0, (1e3, 0.0, 1e4), (0.0, 0.0, 0.0))

    def fall(step: float) -> np.ndarray:
        model = TowCable(made)

        def let_go(k: int) -> None:
            if k == 0:
                model.set_state(1.4, 0.0, 0.3 * float(model.motion[2]), 0.0)

        return exchange(model, falling, [step] * round(6.0 / step), NEXT, each=let_go)

    assert (shares(fall(0.05), fall(0.02))[[0, 2, 5]] < 0.05).all()


# -- what has none, and what is refused


@pytest.mark.parametrize("kind", [CableChain, TowCable])
def test_without_a_mass_the_force_now_is_the_one_to_hold(kind: type[Model]):
    model = kind(scene(VESSELS["20 t"]))
    on(model, VESSELS["20 t"], 0.05, 1.0, NEXT[2], lambda model: np.testing.assert_array_equal(model.outputs[NEXT], model.outputs[FORCE]))
    assert (model.state[header.HOST : header.DOUBTS] == 0.0).all()


def test_a_step_is_good_though_the_next_one_would_fail():
    """What the winch leaves after it is too little for another."""
    values = {"winch.fitted": True, "host.mass": 20e3, "cable.length": 20.0, "cable.axial_stiffness": 1e6}
    model, hauled = CableChain(with_values(scene(VESSELS["20 t"]), values)), np.array([*[0.0] * 9, -8.0])
    model.initialize(np.zeros(10))
    for k in range(25):
        model.step(0.1 * k, 0.1, hauled)
    assert model.outputs[NEXT] == pytest.approx(model.outputs[MEAN], abs=0.1 * abs(model.outputs[MEAN[2]]))
    with pytest.raises(SolverError, match="hauled in the whole cable"):
        model.step(2.5, 0.1, hauled)


@pytest.mark.parametrize(
    ("values", "text"),
    [
        ({"host.mass": -1.0}, "host.mass = -1 kg: must be >= 0. Give the mass that the top is fastened to"),
        (
            {"host.mass": 5.0, "top.motion_order": 0},
            "top.motion_order = 0: must be >= 1 with host.mass. Give the host's velocities too, or set host.mass = 0.",
        ),
        (
            {"host.mass": 5.0, "top.inputs_at": 1},
            "top.inputs_at = 1: must be 0 with host.mass. Give inputs at the start of the step, or set host.mass = 0.",
        ),
    ],
)
def test_what_cannot_be_served_is_refused(values: dict[str, float], text: str):
    with pytest.raises(ParameterError) as refused:
        with_values(BENT, values)
    assert str(refused.value).startswith(text)


# -- the FMUs


@pytest.mark.parametrize("flavour", FLAVOURS)
@pytest.mark.parametrize("key", ["chain", "tow"])
def test_every_fmu_foretells_as_the_library_does(request: pytest.FixtureRequest, flavour: str, key: str):
    """Through a state that is saved, left and restored."""
    fmu: Fmu = request.getfixturevalue(flavour)[key]
    values = {"water.surface": False, "top.motion_order": 1, "host.mass": 2e3}
    model = {"chain": CableChain, "tow": TowCable}[key](with_values(scene(VESSELS["2 t"]), values))
    expected: list[np.ndarray] = []
    on(model, VESSELS["2 t"], 0.1, 2.0, NEXT[2], lambda model: expected.append(model.outputs.copy()))
    instance = fmu.instance()
    instance.initialize(values, np.zeros(10))
    vessel, z, v, rows = VESSELS["2 t"], 0.0, 0.0, []
    rest = instance.outputs()[FORCE[2]]
    for k in range(20):
        held = instance.outputs()[NEXT[2]]
        if k == 10:
            state = instance.slave.getFMUstate()
            instance.step(1.0, 0.1, np.array([0.0, 0.0, z, 0.0, 0.0, v + 1.0, 0.0, 0.0, 0.0, 0.0]))  # elsewhere
            instance.slave.setFMUstate(state)
            instance.slave.freeFMUstate(state)
        rows.append(instance.step(0.1 * k, 0.1, np.array([0.0, 0.0, z, 0.0, 0.0, v, 0.0, 0.0, 0.0, 0.0])))
        z, v = vessel.moved(0.1 * k, 0.1, z, v, held - rest)
    assert_same(np.array(rows), np.array(expected))
    instance.close()


# -- the whole table


@pytest.mark.long
@pytest.mark.parametrize("kind", [CableChain, TowCable])
@pytest.mark.parametrize("name", [name for name in VESSELS if name not in ("0.5 t", "heavy 2 t")])
def test_vessels_of_two_tonnes_and_more_are_right_at_a_tenth_of_a_second(name: str, kind: type[Model]):
    """Forty seconds; the heavy cable carries twenty.  The straight cable has the first of its waves only: what it has to say of itself."""
    exact = together(VESSELS[name], 0.01 * np.arange(4001))
    for step in STEPS[1:]:
        model = kind(carried(name))
        found = on(model, VESSELS[name], step, 40.0, NEXT[2])
        heave, force = errors(found, exact[:: round(step / 0.01)], step)
        assert heave < 2e-3
        assert kind is TowCable or force < 1e-2
        assert not rings(model)
        assert model.outputs[GROWTH] == 0.0
