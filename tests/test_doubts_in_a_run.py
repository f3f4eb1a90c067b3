"""Warnings of what the kernels see while a run goes on: told once, in one form, and where nothing is, nothing is told."""

from __future__ import annotations

import math
import re

import numpy as np
import pytest
from chain_support import swing
from doubts_support import ACCELERATION, FORM, OMEGA, POSITION, VELOCITY, all_told, heaving, moved, times, told
from native_support import FLAVOURS

from cable_model import CableChain, TowCable
from cable_model.model import Model
from cable_model.scene import with_values


def test_a_wave_beyond_breaking_is_told():
    """H/L = 0.142 at most [Michell 1893]: 6 s and 56.2 m allow 7.98 m."""
    values = {"water.density": 1025.0, "waves.period": 6.0, "solver.time_step": 0.1}
    still = moved(heaving(0.0)[1], z=-20.0)
    (text,) = told(heaving(0.0, {**values, "waves.amplitude": 4.05})[0], still, steps=1)
    assert re.match(r"wave = 8\.1 m high, 56\.\d+ m long: ", text)
    assert not told(heaving(0.0, {**values, "waves.amplitude": 3.95})[0], still, steps=1)


@pytest.mark.parametrize("order", [0, 1, 2])
@pytest.mark.parametrize("step", [0.01, 0.1])
def test_a_motion_that_goes_with_its_velocities_leaves_no_doubt(order: int, step: float):
    scene, inputs = heaving(1.0, order=order)
    assert not told(scene, inputs, step)
    assert not told(scene, lambda time: inputs(time + 1.25), step)  # from rest, at once with its acceleration
    assert not told(scene, lambda time: np.array([3.0 * time, 0.0, 0.0, 3.0, *[0.0] * 6]), step)


@pytest.mark.parametrize("order", [0, 1, 2])
@pytest.mark.parametrize("length", [10.0, 100.0, 3000.0])
def test_a_top_that_jumps_is_told_with_how_far(order: int, length: float):
    scene, inputs = heaving(0.1, {"cable.length": length}, order)
    for since in (0.0, 0.75):
        (text,) = told(scene, moved(inputs, x=1.0, since=since))
        assert text.startswith("top = 1 m from where its inputs led, in a step of 0.1 s:")


@pytest.mark.parametrize("order", [0, 1, 2])
@pytest.mark.parametrize("offset", [10.0, 0.05])
def test_the_jump_of_a_host_that_connects_nothing_at_the_start_is_told(offset: float, order: int):
    scene, _ = heaving(0.0, order=order)
    model = TowCable(scene)
    model.initialize(np.zeros(10))
    model.step(0.0, 0.1, np.array([0.0, 0.0, offset, *[0.0] * 7]))
    assert model.warnings()[0].startswith(f"top = {offset:.3g} m from where its inputs led")


@pytest.mark.parametrize("order", [0, 1, 2])
def test_inputs_at_the_start_of_a_tenth_of_a_period_are_told_to_kick(order: int):
    """There the tension errs by more than its range; inputs of the end are right to some per cent."""
    scene, inputs = heaving(1.0, order=order)
    assert [text for text in told(scene, inputs, 0.5, 60) if text.startswith("motion led on from input to input = ")]
    at_end = with_values(scene, {"top.inputs_at": 1})
    assert not told(at_end, inputs, 0.5, 60)


@pytest.mark.parametrize("order", [1, 2])
@pytest.mark.parametrize("inputs_at", [0, 1])
@pytest.mark.parametrize(("period", "ramp", "step"), [(12.0, 6.0, 1.0), (8.0, 20.0, 0.5), (5.0, 10.0, 0.5), (8.0, 3.0, 0.2)])
def test_a_motion_that_fades_in_over_a_few_steps_goes_with_its_rates(order: int, inputs_at: int, period: float, ramp: float, step: float):
    """It goes farther in each of its first steps than in all before, and the trapezoidal rule errs by as much."""
    scene, _ = heaving(0.0, {"top.inputs_at": inputs_at}, order)
    fading = swing((0.0, 0.0, 1.0), 2.0 * math.pi / period, ramp_time=ramp)
    texts = told(scene, lambda time: np.append(fading(time), 0.0), step, 40)
    # what long steps do to the force where the top is led on, not what the motion is
    led_on = ("motion led on", "force at the end of a communication step") if inputs_at == 0 else ()
    assert not [text for text in texts if not text.startswith(led_on)]


def test_an_internal_step_too_long_for_the_motion_is_told():
    scene, inputs = heaving(0.2, {"solver.time_step": 0.5, "top.inputs_at": 1})
    (text,) = told(scene, inputs, 0.5, 40)
    assert text.startswith("internal step = 0.5 s under a motion of ")
    assert not told(with_values(scene, {"solver.tolerance": 1e-3}), inputs, 0.5, 40)
    assert not told(with_values(scene, {"solver.time_step": 0.2}), inputs, 0.2, 100)


@pytest.mark.parametrize(("share", "doubtful"), [(1.3, False), (0.7, True)])
@pytest.mark.parametrize("space", [False, True])
def test_a_straight_cable_that_drag_would_bend_is_told(space: bool, share: float, doubtful: bool):
    """The top's motion reaches sqrt(2 T/(c omega)), c = 8/(3 pi) 1/2 rho C_D d v."""
    mass, drag = 500.0, 4.0 / (3.0 * math.pi) * 1025.0 * 1.2 * 0.01 * OMEGA
    reach = math.sqrt(2.0 * 9.80665 * (mass + 0.5 * 30.0) / (drag * OMEGA))
    values = {"body.mass": mass, "water.density": 1025.0, "cable.normal_drag_coefficient": 1.2, "solver.space": space}
    scene, _ = heaving(0.0, {**values, "cable.length": reach / share, "environment.gravity": 9.80665})
    swaying = swing((1.0, 0.0, 0.0), OMEGA, ramp_time=5.0)
    texts = [text for text in told(scene, lambda time: np.append(swaying(time), 0.0), 0.05, 400) if text.startswith("motion across")]
    assert bool(texts) == doubtful


def test_a_straight_cable_that_pushes_is_told():
    """A float above a cable that is heavier than it lifts: the chain goes slack there, the straight cable stands on it."""
    scene, _ = heaving(0.0, {"cable.length": 30.0, "body.mass": 82.5, "body.volume": 0.1, "water.density": 1025.0})
    (text,) = all_told(scene, lambda time: np.array([0.0, 0.0, -60.0, *[0.0] * 7]), steps=1)
    assert text.startswith("tension = -")
    assert not all_told(with_values(scene, {"body.mass": 110.0}), lambda time: np.array([0.0, 0.0, -60.0, *[0.0] * 7]), steps=1)


def test_slivers_at_the_surface_leave_no_doubt():
    scene, _ = heaving(0.0, {"water.density": 1025.0, "current.speed": 0.1})
    model = TowCable(scene)
    model.initialize(np.zeros(10))
    for k in range(5):
        model.step(k * 1e-9, 1e-9, np.array([0.0, 0.0, 4e-16 * k, *[0.0] * 7]))
    assert not model.warnings()


@pytest.mark.parametrize(("order", "step", "doubtful"), [(1, 0.4, True), (1, 0.05, False), (2, 0.6, True), (2, 0.2, False), (1, 0.6, True)])
def test_inputs_that_kick_a_heavy_body_on_a_light_rope_are_told(order: int, step: float, doubtful: bool):
    """20 m of 0.25 kg/m and EA = 5 MN under 6 t: sqrt(EA m) sees nothing, the spring of the rope gives 1.8 to 11 times the force."""
    values = {"cable.length": 20.0, "cable.mass_per_length": 0.25, "cable.axial_stiffness": 5e6, "body.mass": 6000.0}
    scene, _ = heaving(0.0, {**values, "solver.time_step": 0.05}, order)
    heave = swing((0.0, 0.0, 0.5), 0.25 * math.pi, ramp_time=16.0)
    texts = all_told(scene, lambda time: np.append(heave(time), 0.0), step, round(80.0 / step))
    assert [text.partition(" = ")[0] for text in texts] == ["motion led on from input to input"] * doubtful


@pytest.mark.parametrize("order", [1, 2])
@pytest.mark.parametrize("inputs_at", [0, 1])
def test_a_smooth_move_from_rest_leaves_no_doubt(order: int, inputs_at: int):
    """A quintic of 5 m in 8 s; and a top at rest whose acceleration is rounding."""

    def lowered(time: float) -> np.ndarray:
        s = min(max((time - 2.0) / 8.0, 0.0), 1.0)
        place, speed = s**3 * (10.0 - 15.0 * s + 6.0 * s**2), 30.0 * s**2 * (1.0 - s) ** 2 / 8.0
        rate = 60.0 * s * (1.0 - s) * (1.0 - 2.0 * s) / 64.0
        return np.array([0.0, 0.0, -5.0 * place, 0.0, 0.0, -5.0 * speed, 0.0, 0.0, -5.0 * rate, 0.0])

    scene, still = heaving(0.0, {"top.inputs_at": inputs_at}, order)
    assert not all_told(scene, lowered, 0.05, 240)
    assert not all_told(scene, lambda time: still(time) + 1e-12 * ACCELERATION * math.sin(7.0 * time), 0.05, 60)


def test_a_start_with_speed_along_a_cable_at_rest_is_told():
    """1 m/s: a mass of 150 kg on a spring of 10 kN/m gives sqrt(k m) v = 1.2 kN, over 1.5 kN of weight."""
    scene, inputs = heaving(1.0 / OMEGA)
    (text,) = all_told(scene, inputs, steps=1, kind=CableChain)
    assert text.startswith("an end starts at 1 m/s along a cable that is still at rest: a blow of some 1.22e+03 N. ")
    assert not all_told(scene, lambda time: inputs(time + 1.25), steps=1, kind=CableChain)
    assert not all_told(*heaving(0.1 / OMEGA), steps=1, kind=CableChain)
    assert not all_told(scene, lambda time: np.array([time, 0.0, 0.0, 1.0, *[0.0] * 6]), steps=1, kind=CableChain)  # across it
    assert not all_told(scene, inputs, steps=1)  # the straight cable moves with its top


def test_a_start_with_speed_along_a_cable_that_weighs_little_in_water_is_told():
    """A tenth of the speed of the test above, against a hundredth of its weight."""
    share = 0.99 / 1025.0
    base, inputs = heaving(0.1 / OMEGA)
    light = {
        "water.density": 1025.0, "water.surface": False, "cable.diameter": 0.01, "body.volume": share * base.body.mass,
        "cable.volume_per_length": share * base.cable.mass_per_length,
    }  # fmt: skip
    assert not all_told(base, inputs, steps=1, kind=CableChain)
    (text,) = all_told(with_values(base, light), inputs, steps=1, kind=CableChain)
    assert text.startswith("an end starts at 0.1 m/s along a cable that is still at rest: a blow of some 122 N. ")


@pytest.mark.parametrize(("speed", "doubtful"), [(0.4, False), (2.0, True)])
def test_a_straight_cable_that_a_current_bends_is_told(speed: float, doubtful: bool):
    """The load across over 8 T: 0.6 rho d C_D u^2 L/(8 W) of the length."""
    values = {
        "water.density": 1025.0,
        "cable.normal_drag_coefficient": 1.2,
        "current.speed": speed,
        "body.mass": 600.0,
        "cable.length": 400.0,
    }
    scene, _ = heaving(0.0, values)
    texts = all_told(scene, lambda time: np.array([0.0, 0.0, -5.0, *[0.0] * 7]), steps=1)
    assert [text.partition(" = ")[0] for text in texts] == ["drag and weight across the cable"] * doubtful


@pytest.mark.parametrize("kind", [CableChain, TowCable])
def test_a_lower_end_among_waves_that_move_no_surface_is_told(kind: type[Model]):
    values = {"water.density": 1025.0, "waves.amplitude": 2.0, "waves.period": 8.0, "body.volume": 0.01}
    scene, still = heaving(0.0, values)
    (text,) = all_told(scene, moved(still, z=100.7), steps=1, kind=kind)
    assert re.match(r"waves = 2 m high over still water, the lower end or a body at z = 0\.[67]\d* m: ", text)
    assert not all_told(scene, moved(still, z=97.0), steps=1, kind=kind)
    if kind is CableChain:
        assert not all_told(with_values(scene, {"waves.surface": "cut"}), moved(still, z=100.7), steps=1, kind=kind)


@pytest.mark.parametrize("kind", [CableChain, TowCable])
def test_an_internal_step_too_long_for_the_waves_is_told_by_the_kernels(kind: type[Model]):
    values = {"water.density": 1025.0, "waves.amplitude": 0.5, "waves.period": 4.0, "solver.time_step": 1.0}
    scene, still = heaving(0.0, values)
    steps = [[text for text in all_told(scene, moved(still, z=-20.0), h, 2, kind) if "cells" not in text] for h in (1.0, 0.1)]
    assert steps[0][0].startswith("internal step = 1 s under waves of 4 s: ")
    assert [len(texts) for texts in steps] == [1, 0]


@pytest.mark.parametrize("order", [1, 2])
def test_velocities_that_do_not_go_with_the_positions_are_told(order: int):
    scene, inputs = heaving(1.0, order=order)
    (text,) = told(scene, times(inputs, POSITION))  # only positions are connected
    assert re.match(r"way of the top = (\S+) m, of which its velocities miss \1 m: ", text)
    assert text.endswith("or set top.motion_order = 0.")
    velocities = "of which its velocities miss"
    assert velocities in told(scene, times(inputs, 1.0 - 2.0 * VELOCITY))[0]  # with z down
    assert velocities in told(scene, times(inputs, 1.0 + 2.6 * VELOCITY))[0]  # in km/h
    assert velocities in told(scene, times(inputs, VELOCITY))[0]  # only velocities are connected
    assert not told(heaving(1.0, order=0)[0], times(inputs, POSITION))


def test_accelerations_that_do_not_go_with_the_velocities_are_told_where_they_count():
    scene, inputs = heaving(1.0, order=2)
    (text,) = told(scene, times(inputs, POSITION | VELOCITY))
    assert "its accelerations miss" in text
    assert not told(heaving(1.0, order=1)[0], times(inputs, POSITION | VELOCITY))


def test_ends_above_the_water_are_told_where_the_surface_is_not_simulated():
    wet = {"water.density": 1025.0, "water.surface": False}
    scene, inputs = heaving(2.0, wet)
    (text,) = told(scene, inputs)
    assert re.match(r"an end of the cable or a body at z = 1\.\d+ m, above 1 m: ", text)  # a hundredth of the length is let pass
    assert not told(*heaving(0.9, wet))
    assert not told(*heaving(2.0))
    assert not told(*heaving(2.0, {"water.density": 1025.0}), steps=5)
    assert told(scene, moved(inputs, z=0.1), steps=1)[0].startswith("an end of the cable or a body at z = 0.1 m, above 0.0001 m: ")
    assert not told(scene, moved(inputs, z=-2.0))


def test_a_strain_beyond_a_tenth_is_told():
    (text,) = told(*heaving(0.0, {"cable.axial_stiffness": 5000.0}), steps=1)
    assert re.match(r"strain = 0\.\d+ under \d+(\.\d+)? N, beyond 0\.1: ", text)
    assert not told(*heaving(0.0, {"cable.axial_stiffness": 50000.0}), steps=1)


def test_a_cable_through_the_bottom_of_the_waves_is_told():
    waves = {"water.density": 1025.0, "waves.amplitude": 0.1, "water.depth": 101.0}
    scene, _ = heaving(0.0, waves)

    def lowered(time: float) -> np.ndarray:
        return np.array([0.0, 0.0, -time, 0.0, 0.0, -1.0, *[0.0] * 4])

    assert told(scene, lowered)[0].startswith("lower end at z = -101")
    assert not told(with_values(scene, {"water.depth": 110.0}), lowered)


def test_the_chain_sees_what_the_tow_model_sees():
    scene, inputs = heaving(1.0)
    only = times(inputs, POSITION)
    assert told(scene, only, steps=5, kind=CableChain) == told(scene, only, steps=5)


@pytest.mark.parametrize("flavour", FLAVOURS)
@pytest.mark.parametrize("key", ["chain", "tow"])
def test_every_fmu_logs_each_doubt_once(request: pytest.FixtureRequest, flavour: str, key: str):
    instance = request.getfixturevalue(flavour)[key].instance()
    instance.initialize(None, np.zeros(10))
    instance.step(0.0, 0.1, [10.0, *[0.0] * 9])
    for k in range(1, 5):
        instance.step(0.1 * k, 0.1, [10.0 + 0.1 * k, *[0.0] * 9])
    texts = [text for status, text in instance.messages if status == 1]
    aside = ["tension", "drag and weight across the cable"] if key == "tow" else []  # a straight cable that is thrown aside
    assert sorted(text.partition(" = ")[0] for text in texts) == sorted(["top", "way of the top", *aside])
    assert texts[0].startswith("top = 10 m from where its inputs led, in a step of 0.1 s: it jumps")
    assert all(FORM.fullmatch(text) for text in texts)
    instance.close()
