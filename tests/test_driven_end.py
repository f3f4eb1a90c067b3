"""A driven lower end: both ends are moved, and both tell the force on what holds them."""

import dataclasses
import math
import re
from pathlib import Path

import numpy as np
import pytest
from chain_support import make, view
from fmu_support import FMICallException, Fmu, assert_same
from native_support import FLAVOURS

from cable_model import CableChain, TowCable
from cable_model.errors import ParameterError, SolverError
from cable_model.scene import from_dict, with_values
from cable_model.signals import INPUTS, OUTPUTS
from cable_model.simulation import simulate
from fmu_src.interface import generic_scene, scene_from_values

pytestmark = pytest.mark.shipped

TOP, TOP_MEAN, LOW, LOW_MEAN = (
    [OUTPUTS.index(f"{end}.force{kind}_{axis}") for axis in "xyz"] for end in ("top", "lower") for kind in ("", "_mean")
)
DRIVEN = {"lower_end": {"anchored": True, "driven": True}}
LINE = {  # a tow line between two ships, hanging in a current
    "cable": {
        "length": 120.0, "diameter": 0.05, "mass_per_length": 4.0, "axial_stiffness": 4e6, "normal_drag_coefficient": 1.2,
        "tangential_drag_coefficient": 0.02, "added_mass_coefficient": 1.0,
    },
    "water": {"density": 1025.0, "surface": False},
    "current": {"speed": 0.4},
    "solver": {"nodes": 31, "time_step": 0.02, "grading": 1.0},
    **DRIVEN,
}  # fmt: skip
AIR = {
    "cable": {"length": 50.0, "mass_per_length": 1.5, "axial_stiffness": 2e5},
    "solver": {"nodes": 26, "time_step": 0.02, "grading": 1.0, "slack_damping": 0.0},
    **DRIVEN,
}
GUIDE = Path(__file__).parent.parent / "docs" / "how_to" / "both_ends.md"
FADE = 4.0  # s
FAR = (100.0, 0.0, -12.0)


def along(place, sway, omega, t):
    """Position, velocity and acceleration (9,) of an end that sways about a place, faded in by 1 - cos over FADE."""
    s = np.pi * min(t, FADE) / FADE
    r = (
        np.array([0.5 * (1 - math.cos(s)), 0.5 * np.pi / FADE * math.sin(s), 0.5 * (np.pi / FADE) ** 2 * math.cos(s)])
        if t < FADE
        else np.eye(3)[0]
    )
    x, v, a = math.sin(omega * t), omega * math.cos(omega * t), -(omega**2) * math.sin(omega * t)
    one = np.array(place), np.zeros(3), np.zeros(3)
    moved = r[0] * x, r[1] * x + r[0] * v, r[2] * x + 2.0 * r[1] * v + r[0] * a
    return np.concatenate([base + m * np.array(sway) for base, m in zip(one, moved, strict=True)])


def inputs(top, low):
    """Of two functions of time that give (9,)."""
    return lambda t: np.concatenate([top(t), [0.0], low(t)])


def run(model, motion, step, count, held=False):
    """Outputs (count + 1, .) of a run under prescribed motion, or by inputs of the start of each step."""
    model.initialize(motion(0.0))
    rows = [model.outputs.copy()]
    for k in range(count):
        if held:
            model.step(k * step, step, motion(k * step))
        else:
            model.advance(k * step, step, motion(k * step), motion((k + 1) * step))
        rows.append(model.outputs.copy())
    return np.array(rows)


def still(place):
    return lambda t: np.array([*place, *[0.0] * 6])


SCENES = {
    "drag and current": {},
    "in space": {"solver__space": True, "current__direction": 0.7},
    "bending": {"cable__bending_stiffness": 2e3},
    "goes slack": {"cable__length": 140.0, "current__speed": 0.0},
    "seabed": {"seabed__level": -20.0, "seabed__stiffness": 1e4, "seabed__friction_coefficient": 0.5, "current__speed": 0.0},
    "damping": {"cable__axial_damping": 1e5, "cable__quadratic_damping": 1e5},
}


@pytest.mark.parametrize("name", SCENES)
def test_it_makes_no_difference_which_end_is_called_the_top(name):
    """A cable that is moved at one end and held at the other, both ways round: equal cells, so what differs is what Newton's method leaves.

    That is more where nodes land and lift off.
    """
    sway = (0.8, 0.5 if "space" in name else 0.0, 0.6)
    moved, fixed = (lambda t: along((0.0, 0.0, -2.0), sway, 0.6, t)), still(FAR)
    model = make(LINE, **SCENES[name])
    one, other = run(model, inputs(moved, fixed), 0.02, 400), run(make(LINE, **SCENES[name]), inputs(fixed, moved), 0.02, 400)
    for here, there in ((TOP, LOW), (LOW, TOP), (TOP_MEAN, LOW_MEAN), (LOW_MEAN, TOP_MEAN)):
        size = np.abs(one[:, here]).max()
        assert np.abs(one[:, here] - other[:, there]).max() < (2e-3 if name == "seabed" else 2e-4) * size
    assert np.ptp(one[:, TOP[0]]) > 0.05 * size


def test_both_ends_moved_alike_carry_the_cable_along():
    """Towed at a speed through still water a cable hangs between its ends as between fixed ones in the current that it then feels."""
    places, speed, ramp = ((0.0, 0.0, -2.0), FAR), 0.8, 20.0

    def moving(place):
        def motion(t):
            s = min(t / ramp, 1.0)
            way = speed * ramp * s**3 * (1.0 - 0.5 * s) + speed * max(t - ramp, 0.0)
            return np.array(
                [place[0] - way, *place[1:], -speed * s**2 * (3.0 - 2.0 * s), 0.0, 0.0, -speed / ramp * 6.0 * s * (1.0 - s), 0.0, 0.0]
            )

        return motion

    towed = make(LINE, current__speed=0.0, solver__time_step=0.1)
    rows = run(towed, inputs(*map(moving, places)), 0.1, 3000)
    fixed = make(LINE, current__speed=speed)
    fixed.initialize(inputs(*map(still, places))(0.0))
    for force in (TOP, TOP_MEAN, LOW, LOW_MEAN):
        assert rows[-1, force] == pytest.approx(fixed.outputs[force], rel=1e-4, abs=0.05)
    carried = towed.positions() - [speed * (0.5 * ramp - 300.0), 0.0, 0.0]
    assert np.abs(carried - fixed.positions()).max() < 1e-3


def test_a_lower_end_that_is_driven_as_a_body_moved_gives_the_bodys_run():
    """The lower end of a free body's run, replayed with accelerations: the same top force, and below it the tension that the body needs."""
    body = {
        **{k: v for k, v in LINE.items() if k != "lower_end"},
        "body": {"mass": 300.0, "volume": 0.1, "drag_area": 0.2, "added_mass": 50.0},
    }
    step, count = 0.02, 500
    top = lambda t: along((0.0, 0.0, 0.0), (1.0, 0.0, 0.5), 1.1, t)  # noqa: E731
    free = make(body)
    free.initialize(top(0.0))
    n = 31
    path, rows = [], []
    for k in range(count + 1):
        if k:
            free.advance((k - 1) * step, step, top((k - 1) * step), top(k * step))
        places = [OUTPUTS.index(f"body.{v}{axis}") for v in ("", "v") for axis in "xyz"]
        path.append(free.outputs[places])
        rows.append(free.outputs.copy())
    path, rows = np.array(path), np.array(rows)
    accelerations = np.gradient(path[:, 3:], step, axis=0, edge_order=2)
    replay = lambda t: np.concatenate([top(t), [0.0], path[round(t / step)], accelerations[round(t / step)]])  # noqa: E731
    found = run(make(LINE), replay, step, count)
    assert n == len(free.positions())
    size = np.ptp(rows[:, TOP[2]])
    assert np.abs(found[50:, TOP] - rows[50:, TOP]).max() < 0.01 * size
    assert np.abs(np.linalg.norm(found[50:, LOW], axis=1) - rows[50:, OUTPUTS.index("body.tension")]).max() < 0.02 * size


def test_a_wave_from_a_moved_lower_end_runs_up_as_d_alembert_says():
    """A taut string without weight whose lower end is displaced sideways by a pulse: the pulse arrives at the top after L/c, and the force
    across it there is twice m c v, as at a fixed end."""
    m, tension, length, stiffness = 0.5, 2000.0, 40.0, 1e6
    c = math.sqrt(tension / m / (1.0 + tension / stiffness))  # along the unstretched length
    span = length * (1.0 + tension / stiffness)
    scene = {
        "cable": {"length": length, "mass_per_length": m, "axial_stiffness": stiffness},
        "environment": {"gravity": 0.0},
        "solver": {"nodes": 161, "time_step": 0.001, "grading": 1.0, "lambda_infinity": -1.0, "slack_damping": 0.0},
        **DRIVEN,
    }
    height, duration = 0.02, 0.2

    def low(t):
        s = min(t, duration) / duration * 2.0 * np.pi
        k = 2.0 * np.pi / duration
        if t >= duration:
            return np.array([height, 0.0, -span, *[0.0] * 6])
        x, v, a = (height * (s - math.sin(s)) / (2.0 * np.pi), height / duration * (1.0 - math.cos(s)), height / duration * k * math.sin(s))
        return np.array([x, 0.0, -span, v, 0.0, 0.0, a, 0.0, 0.0])

    rows = run(make(scene), inputs(still((0.0, 0.0, 0.0)), low), 0.001, 800)
    times = 0.001 * np.arange(801)
    arrives = length / c
    rate = np.array([low(t - arrives)[3] if t >= arrives else 0.0 for t in times])
    impedance = m * c
    expected = 2.0 * impedance * rate
    assert np.abs(rows[:, TOP[0]] - expected).max() < 5e-3 * expected.max()
    at_low = np.array([-impedance * low(t)[3] for t in times])
    assert np.abs(rows[:, LOW[0]] - at_low).max() < 5e-3 * expected.max()


def test_the_impulses_of_both_ends_and_the_weight_are_the_change_of_momentum():
    motion = inputs(lambda t: along((0.0, 0.0, 0.0), (2.0, 0.0, 0.0), 2.0, t), lambda t: along((30.0, 0.0, -10.0), (0.0, 0.0, 1.5), 1.4, t))
    step, count, mass = 0.02, 500, 1.5 * 50.0
    model = make(AIR)
    rows = run(model, motion, step, count)
    impulse = -step * (rows[1:, TOP_MEAN] + rows[1:, LOW_MEAN]).sum(axis=0) - [0.0, 0.0, mass * 9.80665 * step * count]
    v = view(model).y[26:]
    momentum = mass / 25 * (0.5 * v[0] + v[1:-1].sum(axis=0) + 0.5 * v[-1])
    assert np.abs(impulse[[0, 2]] - momentum).max() < 2e-3 * mass * 4.0


def test_a_driven_end_does_not_drift_away_from_where_it_is_said_to_be():
    circle = lambda t: np.array(  # noqa: E731
        [90.0 + 3.0 * math.cos(0.5 * t), 3.0 * math.sin(0.5 * t), -5.0, -1.5 * math.sin(0.5 * t), 1.5 * math.cos(0.5 * t), 0.0,
         -0.75 * math.cos(0.5 * t), -0.75 * math.sin(0.5 * t), 0.0]
    )  # fmt: skip
    model = make(LINE, solver__space=True, solver__time_step=0.1, solver__nodes=11)
    motion = inputs(lambda t: along((0.0, 0.0, 0.0), (2.0, 1.0, 1.0), 0.7, t), circle)
    run(model, motion, 0.1, 10000)
    assert np.abs(model.positions()[0] - circle(1000.0)[:3]).max() < 1e-3


@pytest.mark.parametrize("order", [0, 1, 2])
@pytest.mark.parametrize("at_end", [0, 1])
def test_inputs_of_communication_steps_are_followed_at_either_end_alike(order, at_end):
    moved, fixed = (lambda t: along((0.0, 0.0, -2.0), (0.8, 0.0, 0.6), 0.6, t)), still(FAR)
    changes = {"solver__time_step": 0.025, "top__motion_order": order, "top__inputs_at": at_end}
    found = []
    for motion in (inputs(moved, fixed), inputs(fixed, moved)):
        model = make(LINE, **changes)
        model.initialize(motion(0.0))
        rows = []
        for k, step in enumerate([0.1, 0.05, 0.1, 0.1, 1e-7, 0.1] * 20):
            time = sum(([0.1, 0.05, 0.1, 0.1, 1e-7, 0.1] * 20)[:k])
            model.step(time, step, motion(time + at_end * step))
            rows.append(model.outputs.copy())
        found.append(np.array(rows))
    one, other = found
    for here, there in ((TOP, LOW), (LOW, TOP), (TOP_MEAN, LOW_MEAN), (LOW_MEAN, TOP_MEAN)):
        assert np.abs(one[:, here] - other[:, there]).max() < 5e-4 * np.abs(one[:, here]).max()


def test_inputs_of_the_end_of_a_step_are_reached():
    motion = inputs(still((0.0, 0.0, 0.0)), lambda t: along(FAR, (1.0, 0.0, 1.0), 1.0, t))
    model = make(LINE, top__inputs_at=1)
    model.initialize(motion(0.0))
    for k in range(100):
        model.step(0.1 * k, 0.1, motion(0.1 * (k + 1)))
        assert np.abs(model.outputs[[OUTPUTS.index(f"body.{axis}") for axis in "xyz"]] - motion(0.1 * (k + 1))[10:13]).max() < 1e-4


@pytest.mark.parametrize(
    "changes", [{}, *(pytest.param(more, marks=pytest.mark.long) for more in ({"solver__space": True}, {"cable__bending_stiffness": 2e3}))]
)
def test_energy_and_momentum_close_at_second_order(changes):
    motion = inputs(lambda t: along((0.0, 0.0, -2.0), (0.5, 0.0, 0.3), 0.7, t), lambda t: along(FAR, (0.7, 0.0, 0.4), 0.5, t))
    found = []
    for step in (0.04, 0.02):
        model = make(LINE, solver__audit=True, solver__time_step=step, solver__slack_damping=0.0, **changes)
        run(model, motion, step, round(12.0 / step))
        found.append(model.audit)
    assert found[1].energy_share < 1e-3
    assert found[1].momentum_share < 1e-4
    assert found[0].energy / found[1].energy > 3.0


def test_slivers_change_nothing_and_a_restored_state_goes_on_bit_for_bit():
    motion = inputs(lambda t: along((0.0, 0.0, -2.0), (0.5, 0.0, 0.3), 0.7, t), lambda t: along(FAR, (0.7, 0.0, 0.4), 0.5, t))
    regular, broken = (make(LINE, top__inputs_at=1, top__motion_order=2) for _ in range(2))
    regular.initialize(motion(0.0))
    broken.initialize(motion(0.0))
    steady = []
    for k in range(101):
        regular.step(0.05 * k, 0.05, motion(0.05 * k + 0.05))
        steady.append(regular.outputs[LOW])
    saved, rows = np.zeros(0), []
    times = np.cumsum([0.0, *[0.05] * 60, 1e-4, 1e-9, 0.05 - 1e-4 - 1e-9, *[0.05] * 40])
    for k in (*range(len(times) - 1), *range(62, len(times) - 1)):  # the second time from what was saved in the middle of a sliver
        if k == 62 and not len(saved):
            saved = broken.state.copy()
        elif k == 62:
            broken.state[:] = saved
        broken.step(times[k], times[k + 1] - times[k], motion(times[k + 1]))
        rows.append(broken.outputs.copy())
    first, again = rows[62 : len(times) - 1], rows[len(times) - 1 :]
    assert np.array_equal(first, again)
    assert np.abs(broken.outputs[LOW] - steady[-1]).max() < 0.01 * np.ptp(np.array(steady), axis=0).max()


def warned(motion, **changes):
    model = make(LINE, **changes)
    model.initialize(motion(0.0))
    for k in range(100):
        model.step(0.1 * k, 0.1, motion(0.1 * k))
    return model.warnings()


def test_what_is_doubtful_about_its_motion_is_told():
    swaying = inputs(still((0.0, 0.0, 0.0)), lambda t: along(FAR, (0.7, 0.0, 0.4), 0.5, t))

    def changed(change):
        def motion(t):
            given = swaying(t)
            change(t, given[10:])
            return given

        return motion

    def jump(t, low):
        low[2] -= 2.0 if t > 5.0 else 0.0

    def stop(t, low):
        low[3:] = 0.0

    assert not [text for text in warned(swaying) if "lower end" in text]
    assert any(text.startswith("lower end = ") and "it jumps" in text for text in warned(changed(jump)))
    assert any(text.startswith("way of the lower end = ") for text in warned(changed(stop)))
    assert any(
        text.startswith("velocity of the lower end changed")
        for text in warned(changed(lambda t, low: low[6:].fill(0.0)), top__motion_order=2)
    )

    def at_once(t):
        low = np.array([*FAR, 3.0, 0.0, 0.0, 0.0, 0.0, 0.0])
        low[0] += 3.0 * t
        return np.concatenate([np.zeros(10), low])

    assert any(text.startswith("an end starts at ") for text in warned(at_once, cable__length=100.5))


def rung(end, mass):
    """coupling.growth and warnings after 6 s of a vessel at one end of a taut line, which it feels a step late; the other end is fixed."""
    model = make({**AIR, "environment": {"gravity": 0.0}}, cable__axial_stiffness=2e6, cable__mass_per_length=20.0, solver__time_step=0.05)
    own, force = (0, TOP[0]) if end == "top" else (10, LOW[0])
    given = np.zeros(19)
    given[own] = 50.05
    model.initialize(given)
    rest, x, v = model.outputs[force], 0.0, 0.005
    held = rest
    for k in range(120):
        given[[own, own + 3]] = 50.05 + x, v
        model.step(0.05 * k, 0.05, given)
        a = (held - rest) / mass
        held, x, v = model.outputs[force], x + 0.05 * (v + 0.025 * a), v + 0.05 * a
    return model.outputs[OUTPUTS.index("coupling.growth")], [text for text in model.warnings() if text.startswith("ringing")]


def test_a_light_host_at_the_lower_end_rings_as_at_the_top_and_is_told():
    (growth, told), (same, as_well) = (rung(end, 1000.0) for end in ("top", "lower"))
    assert growth > 0.05
    assert same == pytest.approx(growth, rel=1e-2)
    assert len(told) == len(as_well) == 1
    assert rung("lower", 1e5) == (0.0, [])


def test_a_scene_moves_both_ends():
    sway = {"kind": "sinusoid", "axis": "x", "amplitude": 1.0, "angular_frequency": 1.0, "ramp_time": 5.0}
    scene = from_dict({**LINE, "lower": {"position": [*FAR], "motion": [sway]}, "run": {"duration": 10.0, "output_step": 0.1}})
    result = simulate(CableChain(scene))
    assert result["lower.x"] == pytest.approx(result["body.x"], abs=1e-4)
    assert np.ptp(result["lower.x"]) > 1.5
    assert np.ptp(result["lower.force_x"]) > 100.0
    assert np.linalg.norm([result[f"lower.force_{axis}"][-1] for axis in "xz"]) == pytest.approx(result["body.tension"][-1], rel=0.05)


def test_what_does_not_have_it_refuses_it():
    scene = from_dict({**LINE, "lower": {"position": [*FAR]}})
    with pytest.raises(ParameterError, match=r"lower_end\.(anchored|driven) = True: must be false for TowCable"):
        TowCable(scene)
    with pytest.raises(ParameterError, match=r'lower_end\.driven = True: must be false on the box grid\. Set solver\.grid = "staggered"\.'):
        with_values(scene, {"solver.grid": "box"})
    for changes, text in (
        ({"lower_end.anchored": False}, "must be false for an end that nothing holds"),
        ({"lower_end.released": True}, "must be false for an end that is let go"),
        ({"lower_end.x": 5.0}, "must be false beside lower_end.x, y or z"),
        ({"lower_end.driven": False}, "must be true for a lower end that \\[lower\\] moves"),
    ):
        with pytest.raises(ParameterError, match=rf"lower_end\.driven = .*: {text}"):
            with_values(scene, changes)


@pytest.mark.parametrize("kind", [CableChain, TowCable])
@pytest.mark.parametrize("at_start", [True, False])
def test_inputs_of_a_lower_end_that_nothing_drives_are_refused(kind, at_start):
    scene = from_dict({**{k: v for k, v in LINE.items() if k != "lower_end"}, "body": {"mass": 300.0}, "current": {}})
    model = kind(scene)
    for name in INPUTS[10:]:
        given = np.zeros(19)
        model.initialize(given)
        given[INPUTS.index(name)] = 1e-3
        with pytest.raises(SolverError, match="the inputs lower"):
            if at_start:
                model.initialize(given)
            else:
                model.step(0.0, 0.1, given)


def test_a_lower_end_that_leaves_the_plane_is_refused():
    model = CableChain(from_dict(LINE))
    start = inputs(still((0.0, 0.0, 0.0)), still(FAR))(0.0)
    model.initialize(start)
    start[INPUTS.index("lower.y")] = 0.5
    with pytest.raises(SolverError, match="left the vertical plane"):
        model.step(0.0, 0.1, start)
    with pytest.raises(ParameterError, match=r"lower\.y = 0\.5 m: must be top\.y = 0 in the plane"):
        CableChain(from_dict(LINE)).initialize(start)


def test_a_driven_end_that_is_told_nothing_stays_where_the_scene_has_it():
    scene = from_dict({**LINE, "lower": {"position": [*FAR]}})
    model = CableChain(dataclasses.replace(scene))
    model.initialize(np.zeros(9))
    model.step(0.0, 0.1, np.zeros(10))
    assert model.positions()[0] == pytest.approx([*FAR], abs=1e-6)


# -- the FMUs

IN_FMUS = {
    "lower_end.anchored": True, "lower_end.driven": True, "water.surface": False, "cable.length": 120.0, "solver.time_step": 0.02,
    "body.mass": 0.0, "body.volume": 0.0, "body.drag_area": 0.0, "body.added_mass": 0.0,
}  # fmt: skip
SWAYING = inputs(lambda t: along((0.0, 0.0, -2.0), (0.5, 0.0, 0.3), 0.7, t), lambda t: along(FAR, (0.7, 0.0, 0.4), 0.5, t))


@pytest.fixture(params=FLAVOURS)
def chain_fmu(request: pytest.FixtureRequest) -> Fmu:
    return request.getfixturevalue(request.param)["chain"]


def test_every_fmu_gives_what_the_library_gives_and_restores_it(chain_fmu):
    model = CableChain(scene_from_values(generic_scene(), IN_FMUS, "chain"))
    model.initialize(SWAYING(0.0))
    instance = chain_fmu.instance()
    instance.initialize(IN_FMUS, SWAYING(0.0))
    assert "lower end moved by inputs" in instance.get("effects.active")
    found, expected = [instance.outputs()], [model.outputs.copy()]
    for k in range(60):
        if k == 30:
            saved = instance.slave.getFMUstate()
        found.append(instance.step(0.05 * k, 0.05, SWAYING(0.05 * k)))
        model.step(0.05 * k, 0.05, SWAYING(0.05 * k))
        expected.append(model.outputs.copy())
    assert_same(np.array(found), np.array(expected))
    instance.slave.setFMUstate(saved)
    again = [instance.step(0.05 * k, 0.05, SWAYING(0.05 * k)) for k in range(30, 60)]
    assert np.array_equal(np.array(again), np.array(found)[31:])
    instance.close()


def test_an_fmu_that_drives_none_refuses_its_inputs_and_one_that_does_its_place(chain_fmu):
    given = np.zeros(19)
    instance = chain_fmu.instance()
    instance.initialize({}, given)
    given[INPUTS.index("lower.vx")] = 0.1
    with pytest.raises(FMICallException):
        instance.step(0.0, 0.1, given)
    assert "the inputs lower.* say where the lower end is, but they do not drive it" in instance.errors[-1]
    instance.close()
    instance = chain_fmu.instance()
    with pytest.raises(FMICallException):
        instance.initialize({**IN_FMUS, "lower_end.x": 5.0}, SWAYING(0.0))
    assert "Give the place by lower.position, in an FMU by lower.x, y and z." in instance.errors[-1]
    instance.close()


def test_the_native_fmu_takes_derivatives_of_the_lower_ends_inputs(native):
    """Positions are set by fmi2SetReal, velocities as their derivatives: the same run."""
    rows = []
    for by_derivatives in (False, True):
        instance = native["chain"].instance()
        instance.initialize(IN_FMUS, SWAYING(0.0))
        ends = [f"{end}.{{}}{axis}" for end in ("top", "lower") for axis in "xyz"]
        places, velocities = ([instance.fmu.references[name.format(kind)] for name in ends] for kind in ("", "v"))
        for k in range(20):
            given = dict(zip(INPUTS, SWAYING(0.05 * k).tolist(), strict=True))
            speeds = [given[name.format("v")] for name in ends]
            instance.slave.setReal(places, [given[name.format("")] for name in ends])
            if by_derivatives:
                instance.slave.setRealInputDerivatives(places, [1] * 6, speeds)
            else:
                instance.slave.setReal(velocities, speeds)
            instance.slave.doStep(0.05 * k, 0.05)
        rows.append(instance.outputs())
        instance.close()
    assert np.array_equal(*rows)


def test_the_guides_tug_pulls_its_barge(native, monkeypatch, tmp_path):
    """The block of docs/how_to/both_ends.md: in the end the thrust is the drag of ships and line, and the barge feels its own."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "CableChain.fmu").write_bytes(native["chain"].path.read_bytes())
    (block,) = re.findall(r"```python\n(.*?)```", GUIDE.read_text(encoding="utf-8"), re.DOTALL)
    names: dict[str, object] = {}
    exec(compile(block, str(GUIDE), "exec"), names)
    tug, barge = names["speeds"]
    drag = names["drag"]
    assert tug == pytest.approx(barge, rel=1e-3)
    assert names["pull"] == pytest.approx(drag[names["barge"]] * barge**2, rel=5e-3)
    line = names["thrust"] - drag[names["tug"]] * tug**2 - drag[names["barge"]] * barge**2
    along_it = 0.5 * 1025.0 * 0.02 * 0.056 * 300.0 * tug**2  # tangential drag
    assert 0.5 * along_it < line < 0.02 * names["thrust"]


@pytest.mark.parametrize("step", [0.05, 0.025])
def test_two_vessels_on_a_dry_cable_keep_their_momentum(step):
    """Each gets the mean force of the step that the cable made: what it gives both is what it loses, whatever the step."""
    model = make({**AIR, "environment": {"gravity": 0.0}}, solver__time_step=step, cable__length=50.0)
    masses, places, speeds = np.array([2e4, 5e4]), np.array([50.02, 0.0]), np.array([0.3, -0.1])
    given = np.zeros(19)
    given[[0, 10]] = places
    model.initialize(given)
    start = masses @ speeds
    for k in range(round(20.0 / step)):
        given[[0, 10]], given[[3, 13]] = places, speeds
        model.step(k * step, step, given)
        forces = model.outputs[[TOP_MEAN[0], LOW_MEAN[0]]]
        places = places + step * (speeds + 0.5 * step * forces / masses)
        speeds = speeds + step * forces / masses
    v = view(model).y[26:, 0]
    cable = 1.5 * 2.0 * (0.5 * v[0] + v[1:-1].sum() + 0.5 * v[-1])
    assert speeds[0] < 0.0
    assert masses @ speeds + cable == pytest.approx(start, abs=2e-3 * start)
