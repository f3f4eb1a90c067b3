"""Water that changes: currents over time and by inputs, ramps, a record of waves; against closed forms, or told another way."""

import itertools
import math

import numpy as np
import pytest
from chain_support import drive, every, make, still

from cable_model import CableChain, TowCable, scene, simulate
from cable_model.effects import Parts
from cable_model.errors import ParameterError, SolverError
from cable_model.kernels.fluid import Stream, current_motion
from cable_model.kernels.waves import Ramp, elevation, wave_motion
from cable_model.models import MODELS
from cable_model.sea import rows_of, table_of
from cable_model.signals import INPUTS, OUTPUTS
from cable_model.tables import current_over_time, waves

pytestmark = pytest.mark.shipped

LINE = {  # a wire with a sphere, all of it deep
    "cable": {
        "length": 60.0, "diameter": 0.02, "mass_per_length": 1.5, "axial_stiffness": 4e6, "normal_drag_coefficient": 1.2,
        "tangential_drag_coefficient": 0.02, "added_mass_coefficient": 1.0,
    },
    "body": {"mass": 400.0, "volume": 0.1, "drag_area": 0.4, "added_mass": 50.0},
    "water": {"density": 1025.0},
    "top": {"position": [0.0, 0.0, -20.0], "motion_order": 2},
    "solver": {"nodes": 21, "time_step": 0.02},
}  # fmt: skip
BY_INPUT = {"water__current_input": True}
DEEP = still((0.0, 0.0, -20.0))
BOTH = pytest.mark.parametrize("model", [CableChain, TowCable])
WAY = [  # model, and what makes it another grid or dimension; numba compiles the box grid for each set of parts: in the long run
    pytest.param("chain", {}, id="staggered"),
    pytest.param("chain", {"solver__grid": "box"}, id="box", marks=pytest.mark.long),
    pytest.param("chain", {"solver__space": True}, id="chain in space"),
    pytest.param("tow", {}, id="tow"),
    pytest.param("tow", {"solver__space": True}, id="tow in space"),
]


def made(base, **changes):
    """A scene from a nested dictionary; changes are by name, `water__density=1e3`."""
    tables = {part: dict(values) for part, values in base.items()}
    for name, value in changes.items():
        part, _, field = name.partition("__")
        tables.setdefault(part, {})[field] = value
    return scene.from_dict(tables)


def stream(motion, current):
    """All inputs, from the motion of the top and the current (x, y) at a time."""
    return lambda t: np.concatenate([motion(t), np.zeros(10), current(t)])


def off(one, other, names=OUTPUTS[:12]):
    """The largest difference of the outputs of two runs, each over the largest value that all of its kind reach."""
    worst = 0.0
    for name in names:
        scale = max(np.abs(other[f"{name[:-1]}{axis}"]).max() if name[-1] in "xyz" else np.abs(other[name]).max() for axis in "xz")
        worst = max(worst, np.abs(one[name] - other[name]).max() / max(scale, 1e-300))
    return worst


@pytest.mark.parametrize(("model", "way"), WAY)
def test_a_steady_current_by_inputs_is_that_of_the_scene(model, way):
    aside = 0.3 if "solver__space" in way else 0.0
    motion = stream(DEEP, lambda t: [0.8 * math.cos(aside), 0.8 * math.sin(aside)])
    given = drive(MODELS[model](made(LINE, **way, **BY_INPUT)), every(0.1, 5.0), motion)
    known = drive(MODELS[model](made(LINE, **way, current__speed=0.8, current__direction=aside)), every(0.1, 5.0), DEEP)
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
    series = drive(MODELS[model](made(LINE, **heavy)), every(0.5, duration), stream(top, lambda t: [a * t, 0.0]))
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
    table = drive(MODELS[model](made(LINE, **way, current__table=rows)), every(0.1, 8.0), DEEP)

    def flow(t):
        return [(0.2 + 0.1 * t) * math.cos(aside), (0.2 + 0.1 * t) * math.sin(aside)]

    given = drive(MODELS[model](made(LINE, **way, **BY_INPUT)), every(0.1, 8.0), stream(DEEP, flow))
    for name in OUTPUTS[:12]:
        assert given[name] == pytest.approx(table[name], rel=1e-8, abs=1e-6), name
    assert np.ptp(table["body.x"]) > 0.05


def test_a_table_is_interpolated_in_time_and_height():
    rows = [[t, z, 1.0 + 0.1 * t - 0.02 * z + 0.004 * t * z, 0.3 * z] for t in (0.0, 5.0, 20.0) for z in (0.0, -10.0, -50.0)]
    table = current_over_time(made(LINE, solver__space=True, current__table=rows))
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
    began = drive(MODELS[model](made(LINE, **way, **slow, current__ramp_time=100.0)), every(1.0, 300.0), DEEP)
    still_water = drive(MODELS[model](made(LINE, **way)), every(0.1, 0.1), DEEP)
    there = drive(MODELS[model](made(LINE, **way, **slow)), every(1.0, 1.0), DEEP)
    for name in ("top.force_x", "top.force_z", "body.x", "body.z"):
        assert began[name][0] == pytest.approx(still_water[name][0], rel=1e-12, abs=1e-9), name
        assert began[name][-1] == pytest.approx(there[name][0], rel=1e-5, abs=1e-3), name


def test_a_ramp_counts_from_the_start_of_the_run():
    one, later = (
        drive(
            make(LINE, current__speed=0.5, current__ramp_time=10.0, waves__amplitude=1.0, waves__period=5.0, waves__ramp_time=10.0),
            times,
            DEEP,
        )
        for times in (every(0.1, 4.0), 35.0 + every(0.1, 4.0))
    )  # seven periods later
    for name in OUTPUTS[:12]:
        assert later[name] == pytest.approx(one[name], rel=1e-8, abs=1e-6), name


@pytest.mark.parametrize("t", [-1.0, 0.0, 2.0, 4.9, 8.0, 10.0, 30.0])
@pytest.mark.parametrize("parts", [Parts(), Parts(stretched=True), Parts(cut=True)], ids=["held", "stretched", "cut"])
def test_waves_that_grow_have_the_acceleration_and_the_gradient_of_their_velocity(parts, t):
    wave = table_of(np.array([[0.8, 1.1, 1.1**2 / 9.81, 0.6, 0.3, 0.0], [0.3, 1.9, 1.9**2 / 9.81, -0.4, 1.3, 0.0]]))
    ramp = Ramp(0.0, 10.0)
    parts = parts._replace(waves=wave, wave_ramp=ramp)
    place = np.array([2.0, -1.0, -0.4])
    s = min(max(t / 10.0, 0.0), 1.0)
    share = 10.0 * s**3 - 15.0 * s**4 + 6.0 * s**5
    velocity, acceleration, gradient = wave_motion(parts, tuple(place), t)
    if parts.stretched is None and parts.cut is None:
        whole = wave_motion(parts._replace(wave_ramp=None), tuple(place), t)
        assert velocity == pytest.approx(share * np.array(whole[0]), abs=1e-13)
    height, rate, slope = elevation(wave, ramp, tuple(place), t)
    assert height == pytest.approx(share * elevation(wave, None, tuple(place), t)[0], abs=1e-13)
    d = 1e-5
    ahead, behind = (elevation(wave, ramp, tuple(place), t + sign * d)[0] for sign in (1.0, -1.0))
    assert rate == pytest.approx((ahead - behind) / (2.0 * d), abs=1e-8)
    later, before = (np.array(wave_motion(parts, tuple(place), t + sign * d)[0]) for sign in (1.0, -1.0))
    if parts.cut is None:  # where it is cut the edge moves, and its own speed is no acceleration of the water
        assert acceleration == pytest.approx((later - before) / (2.0 * d), abs=1e-7)
    for k in range(3):
        step = d * np.eye(3)[k]
        up, down = (np.array(wave_motion(parts, tuple(place + sign * step), t)[0]) for sign in (1.0, -1.0))
        assert np.reshape(gradient, (3, 3))[:, k] == pytest.approx((up - down) / (2.0 * d), rel=1e-6, abs=1e-7)
        over, under = (elevation(wave, ramp, tuple(place + sign * step), t)[0] for sign in (1.0, -1.0))
        assert slope[k] == pytest.approx((over - under) / (2.0 * d), abs=1e-8)


@pytest.mark.parametrize(("model", "way"), WAY)
def test_waves_that_grow_begin_at_rest_and_end_as_the_whole_waves(model, way):
    wave = {
        "waves__amplitude": 1.5, "waves__period": 5.0, "solver__time_step": 0.05, "top__position": [0.0, 0.0, -4.0],
        "cable__axial_damping": 1e4,
    }  # fmt: skip
    motion = still((0.0, 0.0, -4.0))
    grown = drive(MODELS[model](made(LINE, **way, **wave, waves__ramp_time=20.0)), every(0.1, 500.0), motion)
    full = drive(MODELS[model](made(LINE, **way, **wave)), every(0.1, 500.0), motion)
    assert grown["top.force_x"][0] == pytest.approx(0.0, abs=1e-9)
    for name in ("top.force_x", "top.force_z"):
        steady = full[name][-50:]
        size = np.ptp(steady)
        assert np.ptp(grown[name][:10]) < 2e-3 * size, name  # growth by the third power of time
        assert grown[name][-50:] == pytest.approx(steady, abs=0.03 * size), name


def test_a_record_of_waves_is_what_they_do_at_its_place():
    t = 30.0 + 0.5 * np.arange(600)
    known = [(0.9, 10.0, 0.4), (0.5, 7.5, 2.0), (0.2, 300.0 / 71.0, -1.0)]  # all of which fit into 300 s
    heights = sum(a * np.cos(phase - 2.0 * math.pi * t / period) for a, period, phase in known)
    rows = [[float(time), float(height) + 0.7] for time, height in zip(t, heights, strict=True)]  # with a tide
    components = waves(made(LINE, waves__record=rows))
    assert components.shape[1] == 3
    for (a, period, phase), row in zip(known, rows_of(components), strict=True):
        assert row[0] == pytest.approx(a, rel=1e-9)
        assert row[1] == pytest.approx(2.0 * math.pi / period, rel=1e-12)
        assert row[4] % (2.0 * math.pi) == pytest.approx(phase % (2.0 * math.pi), abs=1e-9)
    assert [elevation(components, None, (0.0, 0.0), time)[0] for time in t] == pytest.approx(heights, abs=1e-9)


@pytest.mark.parametrize("count", [400, 401])
def test_a_record_of_noise_is_kept_but_for_a_hundredth_of_its_deviation(count):
    rng = np.random.default_rng(1)
    t = 0.7 * np.arange(count)
    noise = np.convolve(rng.standard_normal(count + 40), np.hanning(41), mode="valid")[:count]
    components = waves(made(LINE, waves__record=np.column_stack((t, noise)).tolist()))
    heights = np.array([elevation(components, None, (0.0, 0.0), time)[0] for time in t])
    assert np.std(heights - (noise - noise.mean())) <= 0.0101 * np.std(noise)
    assert components.shape[1] < count // 2


@BOTH
def test_a_run_in_a_record_is_the_run_in_its_components(model):
    t = 0.5 * np.arange(240)
    rows = np.column_stack((t, 0.8 * np.cos(0.3 - 2.0 * math.pi * t / 8.0))).tolist()
    recorded = simulate(model(made(LINE, waves__record=rows, run__duration=5.0)))
    known = simulate(model(made(LINE, waves__amplitude=0.8, waves__period=8.0, waves__phase=0.3, run__duration=5.0)))
    assert recorded["top.tension"] == pytest.approx(known["top.tension"], rel=1e-9)


def _changing(t):
    return [0.6 * math.sin(0.9 * t) + 0.2 * t, 0.0]


@BOTH
def test_inputs_that_are_held_lead_a_current_on(model):
    """By a line through the last two: the error is of order 2 in the communication step."""
    exact = drive(model(made(LINE, **BY_INPUT)), every(0.01, 6.0), stream(DEEP, _changing))
    errors = []
    for step in (0.4, 0.2, 0.1):
        cable = model(made(LINE, **BY_INPUT))
        motion = stream(DEEP, _changing)
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
        cable = model(made(LINE, **BY_INPUT, top__inputs_at=at_end))
        motion = stream(DEEP, _changing)
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
    motion = stream(DEEP, _changing)
    cable, other = model(made(LINE, **values)), model(made(LINE, **values))
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


@BOTH
def test_a_current_that_nothing_asks_for_is_refused(model):
    cable = model(made(LINE))
    inputs = stream(DEEP, lambda t: [0.1, 0.0])(0.0)
    with pytest.raises(SolverError, match=r"the inputs water\.current_x and y give a current, but are not asked for\. Leave both at 0"):
        cable.initialize(inputs)
    cable.initialize(stream(DEEP, lambda t: [0.0, 0.0])(0.0))
    with pytest.raises(SolverError, match=r"water\.current_input = true"):
        cable.step(0.0, 0.1, inputs)
    with pytest.raises(SolverError, match=r"water\.current_input = true"):
        cable.advance(0.0, 0.1, DEEP(0.0), inputs)


@BOTH
def test_a_current_across_the_plane_is_refused(model):
    cable = model(made(LINE, **BY_INPUT))
    across = stream(DEEP, lambda t: [0.0, 0.1])(0.0)
    with pytest.raises(SolverError, match=r"left the vertical plane.*water\.current_y at 0"):
        cable.initialize(across)
    cable.initialize(DEEP(0.0))
    with pytest.raises(SolverError, match="left the vertical plane"):
        cable.step(0.0, 0.1, across)


@pytest.mark.parametrize(
    ("changes", "text"),
    [
        ({"current__ramp_time": 5.0}, "current.ramp_time = 5 s: must be 0 without a current. Give a current, or remove it."),
        ({"waves__ramp_time": 5.0}, "waves.ramp_time = 5 s: must be 0 without waves. Give waves, or remove it."),
        (
            {"current__table": [[0.0, 0.0, 1.0, 0.0]], "current__speed": 1.0},
            "current.speed = 1 m/s: must be 0 beside current.table. Keep one of them.",
        ),
        (
            {"current__table": [[0.0, 0.0, 1.0, 0.0], [0.0, -5.0, 1.0, 0.0], [9.0, 0.0, 1.0, 0.0]]},
            "current.table = 3 rows: must be the same levels at every time, each once. Give every level at every time.",
        ),
        ({"current__table": [[0.0, 0.0, 1.0, 0.4]]}, "current.table[0] = 0.4 rad: must be 0 or pi in the plane."),
        (
            {"waves__record": [[float(k), 0.1 * (k % 3)] for k in (0, 1, 2, 3, 5, 6, 7, 8, 9)]},
            "waves.record = 9 rows: must be at least 8 rows of time that rises by equal steps, and of heights that differ. "
            "Sort the rows, and fill gaps.",
        ),
        ({"waves__record": [[float(k), 0.5] for k in range(9)]}, "waves.record = 9 rows: must be at least 8 rows of time that rises by"),
        ({"waves__surface": "wheeler"}, "waves.surface = 'wheeler': must be held without waves. Give waves, or remove it."),
        (
            {"waves__record": [[float(k), 0.1 * (k % 3)] for k in range(9)], "waves__amplitude": 1.0},
            "waves = 2 kinds: must be one of amplitude, spectrum, table and record. Keep one of them.",
        ),
        ({"water__density": 0.0, "water__current_input": True}, "water.current_input = True: must be false without water."),
    ],
)  # fmt: skip
def test_what_does_not_go_together_is_refused(changes, text):
    with pytest.raises(ParameterError) as error:
        made(LINE, **changes)
    assert str(error.value).startswith(text)


def test_what_is_not_there_adds_nothing():
    """A stream of nothing and ramps that have ended: the numbers of the water without them."""
    levels = np.array([[-10.0, 0.4, 0.1], [0.0, 0.9, -0.2]])
    place, t = (3.0, -1.0, -4.0), 50.0
    plain = current_motion(Parts(current=levels), place, t)
    parts = Parts(current=levels, stream=Stream(0.0, 0.0, 0.0, 0.0, t), current_ramp=Ramp(0.0, 10.0), wave_ramp=Ramp(0.0, 0.0))
    assert current_motion(parts, place, t) == plain
    assert INPUTS[19:] == ("water.current_x", "water.current_y")


@pytest.mark.parametrize(
    ("changes", "text"),
    [
        (
            {"current__table": [[0.0, 0.0, 0.1, 0.0], [0.1, 0.0, 0.3, 0.0]]},
            "rows of current.table 0.1 s apart, internal step = 0.02 s: the push of water that changes within a few steps is lost in part. "
            "Set solver.time_step = 0.01, or give smoother rows.",
        ),
        (
            {"current__table": [[0.0, 10.0, 0.5, 0.0], [0.0, 50.0, 0.1, 0.0]]},
            "levels of current.table from z = 10 to 50 m: all above the water. z points up from still water: give depths as negative z.",
        ),
        (
            {"waves__record": [[0.5 * k, 0.05 * k] for k in range(40)]},
            "waves.record = 1.95 m from its last row to its first, at most 0.05 m from any other row to the next: it repeats with a jump, "
            "which its waves have all the time. Cut or fade it so that both ends meet.",
        ),
    ],
)
def test_what_a_run_does_not_follow_is_told(changes, text):
    model = make(LINE, **changes)
    model.initialize(DEEP(0.0))
    assert text in model.warnings()


def test_a_current_that_nothing_gives_in_a_run_is_told():
    run = simulate(CableChain(made(LINE, **BY_INPUT, run__duration=0.2)))
    assert any(text.startswith("water.current_input = true in a run without a host") for text in run.warnings)
    assert not any("current" in text for text in simulate(CableChain(made(LINE, run__duration=0.2))).warnings)
