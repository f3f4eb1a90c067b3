"""Currents over time, by inputs and from a start: against closed forms, invariances, and one another."""

import itertools
import math

import numpy as np
import pytest
from chain_support import drive, every, make, scene_of
from changing_water_support import BOTH, BY_INPUT, DEEP, LINE, WAY, changing, stream

from cable_model.effects import Parts
from cable_model.kernels.fluid import Stream, current_motion
from cable_model.kernels.waves import Ramp
from cable_model.models import MODELS
from cable_model.signals import INPUTS, OUTPUTS
from cable_model.tables import current_over_time


@pytest.mark.parametrize(("model", "way"), WAY)
def test_a_steady_current_by_inputs_is_that_of_the_scene(model, way):
    aside = 0.3 if "solver__space" in way else 0.0
    motion = stream(DEEP, lambda t: [0.8 * math.cos(aside), 0.8 * math.sin(aside)])
    given = drive(MODELS[model](scene_of(LINE, **way, **BY_INPUT)), every(0.1, 5.0), motion)
    known = drive(MODELS[model](scene_of(LINE, **way, current__speed=0.8, current__direction=aside)), every(0.1, 5.0), DEEP)
    for name in OUTPUTS[:12]:
        assert given[name] == pytest.approx(known[name], rel=1e-9, abs=1e-7), name


@pytest.mark.parametrize(("model", "way"), WAY)
def test_all_that_moves_with_the_water_hangs_along_gravity_less_the_waters_acceleration(model, way):
    """In water that accelerates by a, a top that moves with it: weight less buoyancy points along (-a, -g), and nothing drags or is added.

    The wire swings about that direction until drag has ended it.
    """
    a, duration = 0.8, 300.0

    def top(t):
        return np.array([0.5 * a * t * t, 0.0, -20.0, a * t, 0.0, 0.0, a, 0.0, 0.0])

    heavy = {"body__mass": 150.0, "body__drag_area": 4.0, "solver__time_step": 0.1, **way, **BY_INPUT}
    if model == "tow":  # whose cable has its added mass over the ground, not through the water: a limit of the report's model
        heavy["cable__added_mass_coefficient"] = 0.0
    series = drive(MODELS[model](scene_of(LINE, **heavy)), every(0.5, duration), stream(top, lambda t: [a * t, 0.0]))
    gravity, density = 9.80665, 1025.0
    wet = 150.0 - density * 0.1 + (1.5 - density * math.pi / 4.0 * 0.02**2) * 60.0
    late = series["time"] > duration - 20.0
    assert series["top.force_x"][late] == pytest.approx(-a * wet, rel=1e-3)
    assert series["top.force_z"][late] == pytest.approx(-gravity * wet, rel=2e-3)
    assert series["top.declination"][late] == pytest.approx(math.atan(a / gravity), rel=2e-3)


TAUT = {  # a neutral line between two held ends
    "cable": {**LINE["cable"], "volume_per_length": 1.5 / 1025.0, "axial_damping": 1e4},
    "water": {"density": 1025.0, "surface": False},
    "lower_end": {"anchored": True, "driven": True},
    "solver": {"nodes": 21, "time_step": 0.02},
}


@pytest.mark.parametrize("space", [False, True])
def test_a_neutral_line_in_a_current_that_changes_is_one_that_is_carried_the_other_way(space):
    """Galilei's invariance with acceleration: mass less displaced mass is nothing, so the frame's own acceleration is not felt."""
    x, y = 0.9, 0.4 if space else 0.0

    def carried(t):
        s, c = math.sin(0.5 * t), math.cos(0.5 * t)
        return t - 2.0 * s, 1.0 - c, 0.5 * s  # way, velocity, acceleration

    def end(place, sign, t):
        way, velocity, acceleration = carried(t)
        at = np.array([*place, *[0.0] * 6])
        for k, rate in enumerate((way, velocity, acceleration)):
            at[3 * k] += sign * x * rate
            at[3 * k + 1] += sign * y * rate
        return at

    low, high = (0.0, 0.0, -20.0), (60.3, 0.0, -20.0)
    changes = {"solver__space": space}
    runs = []
    for sign, flow in ((0.0, 1.0), (-1.0, 0.0)):

        def motion(t, sign=sign, flow=flow):
            return np.concatenate([end(high, sign, t), [0.0], end(low, sign, t), [flow * x * carried(t)[1], flow * y * carried(t)[1]]])

        runs.append(drive(make(TAUT, **changes, **BY_INPUT), every(0.02, 12.0), motion))
    for name in [f"{which}.force_{axis}" for which in ("top", "lower") for axis in ("xyz" if space else "xz")]:
        size = np.ptp(runs[1]["top.force_x"])
        assert runs[0][name] == pytest.approx(runs[1][name], abs=3e-4 * size), name


OF_TABLE = [*WAY[:2], pytest.param("chain", {"solver__space": True}, id="chain in space", marks=pytest.mark.long), WAY[3],
            pytest.param("tow", {"solver__space": True}, id="tow in space", marks=pytest.mark.long)]  # fmt: skip


@pytest.mark.parametrize(("model", "way"), OF_TABLE)  # a table is in no shipped object code
def test_a_table_that_changes_linearly_is_the_current_that_inputs_change_linearly(model, way):
    aside = math.pi / 3.0 if "solver__space" in way else 0.0
    rows = [[0.0, 0.0, 0.2, aside], [10.0, 0.0, 1.2, aside]]
    table = drive(MODELS[model](scene_of(LINE, **way, current__table=rows)), every(0.1, 8.0), DEEP)

    def flow(t):
        return [(0.2 + 0.1 * t) * math.cos(aside), (0.2 + 0.1 * t) * math.sin(aside)]

    given = drive(MODELS[model](scene_of(LINE, **way, **BY_INPUT)), every(0.1, 8.0), stream(DEEP, flow))
    for name in OUTPUTS[:12]:
        assert given[name] == pytest.approx(table[name], rel=1e-8, abs=1e-6), name
    assert np.ptp(table["body.x"]) > 0.05


def test_a_table_is_interpolated_in_time_and_height():
    rows = [[t, z, 1.0 + 0.1 * t - 0.02 * z + 0.004 * t * z, 0.3 * z] for t in (0.0, 5.0, 20.0) for z in (0.0, -10.0, -50.0)]
    table = current_over_time(scene_of(LINE, solver__space=True, current__table=rows))
    parts = Parts(current_table=table)
    rng = np.random.default_rng(3)
    for t, z in zip(rng.uniform(-2.0, 25.0, 60), rng.uniform(-60.0, 5.0, 60), strict=True):
        place = (1.0, 2.0, z)
        v, rate, gradient = current_motion(parts, place, t)
        blocks = table.reshape(3, 3, 4)
        for k in (0, 1):
            at_times = [np.interp(z, block[:, 1], block[:, 2 + k]) for block in blocks]
            assert v[k] == pytest.approx(np.interp(t, [0.0, 5.0, 20.0], at_times), abs=1e-12)
        assert v[2] == 0.0
        d = 1e-6
        later, before = (np.array(current_motion(parts, place, t + sign * d)[0]) for sign in (1.0, -1.0))
        assert rate == pytest.approx((later - before) / (2.0 * d), abs=1e-8)
        up, down = (np.array(current_motion(parts, (1.0, 2.0, z + sign * d), t)[0]) for sign in (1.0, -1.0))
        assert np.reshape(gradient, (3, 3))[:, 2] == pytest.approx((up - down) / (2.0 * d), abs=1e-8)


@pytest.mark.parametrize(("model", "way"), WAY)
def test_a_current_that_grows_begins_in_still_water_and_ends_as_that_of_the_scene(model, way):
    slow = {"solver__time_step": 0.1, "current__speed": 0.5}
    began = drive(MODELS[model](scene_of(LINE, **way, **slow, current__ramp_time=100.0)), every(1.0, 300.0), DEEP)
    still_water = drive(MODELS[model](scene_of(LINE, **way)), every(0.1, 0.1), DEEP)
    there = drive(MODELS[model](scene_of(LINE, **way, **slow)), every(1.0, 1.0), DEEP)
    for name in ("top.force_x", "top.force_z", "body.x", "body.z"):
        assert began[name][0] == pytest.approx(still_water[name][0], rel=1e-12, abs=1e-9), name
        assert began[name][-1] == pytest.approx(there[name][0], rel=1e-5, abs=1e-3), name


@BOTH
def test_inputs_that_are_held_lead_a_current_on(model):
    """By a line through the last two: the error is of order 2 in the communication step."""
    exact = drive(model(scene_of(LINE, **BY_INPUT)), every(0.01, 6.0), stream(DEEP, changing))
    errors = []
    for step in (0.4, 0.2, 0.1):
        cable = model(scene_of(LINE, **BY_INPUT))
        motion = stream(DEEP, changing)
        cable.initialize(motion(0.0))
        rows = []
        for k in range(round(6.0 / step)):
            cable.step(k * step, step, motion(k * step))
            rows.append(cable.outputs[OUTPUTS.index("body.x")])
        errors.append(np.abs(np.array(rows) - exact["body.x"][round(step / 0.01) :: round(step / 0.01)]).max())
    assert np.log2(errors[0] / errors[2]) / 2.0 > 1.6
    assert errors[2] < 5e-3 * np.ptp(exact["body.x"])


@BOTH
@pytest.mark.parametrize("at_end", [0, 1])
def test_unequal_steps_and_slivers_give_the_run_of_equal_ones(model, at_end):
    def run(times):
        cable = model(scene_of(LINE, **BY_INPUT, top__inputs_at=at_end))
        motion = stream(DEEP, changing)
        cable.initialize(motion(0.0))
        for start, end in itertools.pairwise(times):
            cable.step(start, end - start, motion(end if at_end else start))
        return cable.outputs[:12].copy()

    rng = np.random.default_rng(5)
    equal = run(every(0.05, 4.0))
    cuts = np.cumsum(10.0 ** rng.uniform(-6.0, -1.3, 2000))
    unequal = run(np.append(np.concatenate(([0.0], cuts[cuts < 4.0])), 4.0))
    assert unequal == pytest.approx(equal, rel=2e-3, abs=2e-3 * np.abs(equal[:3]).max())


@BOTH
def test_a_state_that_is_restored_goes_on_bit_for_bit(model):
    values = {
        **BY_INPUT, "current__speed": 0.3, "current__ramp_time": 5.0, "waves__amplitude": 0.5, "waves__period": 4.0,
        "waves__ramp_time": 3.0,
    }  # fmt: skip
    motion = stream(DEEP, changing)
    cable, other = model(scene_of(LINE, **values)), model(scene_of(LINE, **values))
    for each in (cable, other):
        each.initialize(motion(1.0), 1.0)
    for k in range(20):
        cable.step(1.0 + 0.1 * k, 0.1, motion(1.0 + 0.1 * k))
    cable.step(3.0, 1e-5, motion(3.0))  # one that waits
    other.state[:] = cable.state
    for each in (cable, other):
        for k in range(10):
            each.step(3.00001 + 0.1 * k, 0.1, motion(3.00001 + 0.1 * k))
    assert (cable.outputs[:12] == other.outputs[:12]).all()


def test_what_is_not_there_adds_nothing():
    """A stream of nothing and ramps that have ended: the numbers of the water without them."""
    levels = np.array([[-10.0, 0.4, 0.1], [0.0, 0.9, -0.2]])
    place, t = (3.0, -1.0, -4.0), 50.0
    plain = current_motion(Parts(current=levels), place, t)
    parts = Parts(current=levels, stream=Stream(0.0, 0.0, 0.0, 0.0, t), current_ramp=Ramp(0.0, 10.0), wave_ramp=Ramp(0.0, 0.0))
    assert current_motion(parts, place, t) == plain
    assert INPUTS[19:21] == ("water.current_x", "water.current_y")
