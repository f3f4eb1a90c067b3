"""Records of many waves along the paths of points are the sums of all components, within a stated share, wherever and whenever one asks."""

import dataclasses
import math

import numpy as np
import pytest
from chain_support import drive, every, make, scene_of, swing

from cable_model.cable_chain import CableChain
from cable_model.effects import Parts
from cable_model.errors import ParameterError
from cable_model.kernels import wave_records, wave_terms
from cable_model.kernels.wave_sums import circle, power
from cable_model.kernels.waves import wave_motion, wave_motion_of
from cable_model.model import compiled
from cable_model.parameters import Waves
from cable_model.sea import components, table_of
from cable_model.signals import OUTPUTS

G = 9.81
SEA = {"spectrum": "jonswap", "significant_height": 3.0, "peak_period": 9.0, "components": 200, "seed": 4}
# of the root mean square of what the sea does at the height: velocity, acceleration and gradient; the last only steers Newton's method
SHARES = np.array([4e-5, 1e-4, 2.5e-3])


def rows(depth: float, spreading: float, **changes: object) -> np.ndarray:
    waves = dataclasses.replace(Waves(), **{**SEA, "direction": 0.4 if spreading else 0.0, "spreading_exponent": spreading, **changes})
    return components(waves, G, depth)


def followed(table: np.ndarray, dimension: int, points: int = 1, **parts: object) -> Parts:
    water, surface = wave_records.record_sizes((0.0,) * dimension)
    records = wave_records.Records(
        np.zeros((points, water)), np.zeros((points, surface)), np.zeros((wave_terms.TERMS, table.shape[1])),
    )  # fmt: skip
    return Parts(water=True, waves=table, followed=records, **parts)


def summed(sea: np.ndarray, place: np.ndarray, t: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Velocity, acceleration and gradient (rows: components) in space of waves over any depth: linear theory, the test's own."""
    amplitude, omega, k, direction, phase, depth = sea.T
    across = np.column_stack((np.cos(direction), np.sin(direction)))
    angle = k * (across @ place[:2]) - omega * t + phase
    z = place[2]
    bottom = np.where(depth > 0.0, depth, math.inf)  # cosh k(z + h)/sinh kh and sinh k(z + h)/sinh kh, which grow too large apart
    direct, mirrored, share = np.exp(k * z), np.exp(-k * (z + 2.0 * bottom)), 1.0 - np.exp(-2.0 * k * bottom)
    cosh, sinh = (direct + mirrored) / share, (direct - mirrored) / share
    potential = amplitude * omega  # times cosh sin/k: its gradient is the velocity
    c, s = np.cos(angle), np.sin(angle)
    velocity = np.concatenate(((potential * cosh * c) @ across, [np.sum(potential * sinh * s)]))
    rate = np.concatenate(((potential * omega * cosh * s) @ across, [-np.sum(potential * omega * sinh * c)]))
    level = -np.einsum("j,ja,jb->ab", potential * k * cosh * s, across, across)
    up = (potential * k * sinh * c) @ across
    gradient = np.block([[level, up[:, None]], [up[None, :], np.array([[np.sum(potential * k * cosh * s)]])]])
    return velocity, rate, gradient


def path(depth: float, speed: float, t: float, dimension: int) -> tuple[np.ndarray, np.ndarray]:
    """A point about a depth that sways, heaves and drifts; its velocity."""
    x = np.array([2.0 * math.sin(0.57 * t) + 0.5 * t, 1.3 * math.sin(0.8 * t), 1.5 * math.sin(0.7 * t)]) * speed
    v = np.array([1.14 * math.cos(0.57 * t) + 0.5, 1.04 * math.cos(0.8 * t), 1.05 * math.cos(0.7 * t)]) * speed
    x[2] -= depth
    keep = [0, 2] if dimension == 2 else [0, 1, 2]
    return x[keep], v[keep]


def scales(sea: np.ndarray, z: float) -> np.ndarray:
    """Root mean squares at a height, of velocity, acceleration and gradient; at least LEAST of those at the surface."""
    amplitude, omega, k, _, _, depth = sea.T
    bottom = np.where(depth > 0.0, depth, math.inf)
    each = [amplitude * omega * factor for factor in (1.0, omega, math.sqrt(2.0) * k)]
    here, above = (
        np.sqrt([np.sum(np.square(one) * (np.exp(2.0 * k * at) + np.exp(-2.0 * k * (at + 2.0 * bottom)))) for one in each])
        for at in (min(z, 0.0), 0.0)
    )
    return np.maximum(here, wave_records.LEAST * above)


def errors(parts: Parts, sea: np.ndarray, right, depth: float, speed: float, step: float, count: int) -> tuple[np.ndarray, float]:
    """Largest errors of velocity, acceleration and gradient over their scales; and steps per record."""
    off, made, moment = [], 0, math.nan
    dimension = 2 if parts.space is None else 3
    for k in range(count):
        place, velocity = path(depth, speed, 100.0 + k * step, dimension)
        got = wave_motion_of(parts, 0, tuple(velocity), tuple(place), 100.0 + k * step)
        want = right(place, 100.0 + k * step)
        off.append([np.linalg.norm(np.subtract(a, np.ravel(b))) for a, b in zip(got, want, strict=True)] / scales(sea, place[-1]))
        made += parts.followed.water[0, 0] != moment
        moment = parts.followed.water[0, 0]
    return np.max(off, axis=0), count / made


LASTS = {3.0: (0.18, 0.02), 20.0: (0.6, 0.15), 100.0: (0.9, 0.25), 300.0: (1.2, 0.5)}  # s, a record in the mean: slow points and fast ones


@pytest.mark.parametrize("step", [0.01, 0.05])
@pytest.mark.parametrize("speed", [0.0, 1.0, 6.0])
@pytest.mark.parametrize(("bottom", "depth"), [(b, d) for b in (0.0, 320.0, 110.0) for d in (3.0, 20.0, 100.0, 300.0) if b == 0.0 or d < b])
@pytest.mark.parametrize("spreading", [0.0, 4.0])
def test_a_record_is_the_sum_of_all_components(spreading, bottom, depth, speed, step):
    """Where the water feels the waves least as well: it is a share of what they do there."""
    sea = rows(bottom, spreading)
    parts = followed(table_of(sea), 3 if spreading else 2, finite_depth=True if bottom else None, space=True if spreading else None)

    def right(place, t):
        at = place if spreading else np.array([place[0], 0.0, place[1]])
        velocity, rate, gradient = summed(sea, np.array([at[0], at[1], min(at[2], 0.0)]), t)
        if at[2] >= 0.0:  # as at z = 0
            gradient[:, 2] = 0.0
        if spreading:
            return velocity, rate, gradient
        return velocity[[0, 2]], rate[[0, 2]], gradient[np.ix_([0, 2], [0, 2])]

    shares, steps = errors(parts, sea, right, depth, speed, step, 400)
    assert np.all(shares < SHARES), str(shares)
    assert steps * step > LASTS[depth][speed > 1.0], steps


@pytest.mark.parametrize("speed", [0.0, 1.0, 6.0])
@pytest.mark.parametrize("depth", [-1.0, 3.0, 20.0, 60.0])
@pytest.mark.parametrize("bottom", [0.0, 110.0])
@pytest.mark.parametrize("surface", ["stretched", "cut"])
@pytest.mark.parametrize("spreading", [0.0, 4.0])
def test_with_the_surface_as_it_is(spreading, surface, bottom, depth, speed):
    """Against the sums over all components, which test_waves.py judges; above still water the scales are those at it."""
    sea = rows(bottom, spreading)
    table = table_of(sea)
    present = {surface: True, "finite_depth": True if bottom else None, "space": True if spreading else None}
    parts, plain = followed(table, 3 if spreading else 2, **present), Parts(water=True, waves=table, **present)
    shares, _ = errors(parts, sea, lambda place, t: wave_motion(plain, tuple(place), t), depth, speed, 0.02, 400)
    assert np.all(shares < SHARES), str(shares)


# -- runs

WIRE = {
    "cable": {
        "length": 60.0, "mass_per_length": 3.0, "diameter": 0.025, "axial_stiffness": 5e7, "axial_damping": 1e5,
        "normal_drag_coefficient": 1.2, "added_mass_coefficient": 1.0,
    },
    "body": {"mass": 1000.0, "volume": 0.4, "drag_area": 1.0, "added_mass": 200.0},
    "water": {"density": 1025.0},
    "waves": SEA,
    "solver": {"nodes": 26, "time_step": 0.05, "lambda_infinity": -0.5},
}  # fmt: skip
MOORING = {
    **WIRE,
    "cable": {**WIRE["cable"], "length": 130.0, "normal_drag_coefficient": 2.0},
    "lower_end": {"anchored": True, "x": 110.0, "z": -50.0},
    "seabed": {"level": -50.0, "stiffness": 1e5, "friction_coefficient": 0.3},
    "body": {},
}
RUNS = {
    "wire": (WIRE, {}),
    "in space": (WIRE, {"solver__space": True, "waves__direction": 0.7, "waves__spreading_exponent": 2.0}),
    "over a bottom": (WIRE, {"water__depth": 80.0}),
    "stretched": (WIRE, {"waves__surface": "wheeler"}),
    "stretched over a bottom, in space": (WIRE, {"waves__surface": "wheeler", "water__depth": 80.0, "solver__space": True}),
    "cut": (WIRE, {"waves__surface": "cut"}),
    "that grow": (WIRE, {"waves__ramp_time": 5.0}),
    "mooring": (MOORING, {}),
    "bodies on it": (WIRE, {"cable__body": [{"at": 20.0, "mass": 50.0, "volume": 0.1, "drag_area": 0.2}, {"at": 45.0, "mass": 80.0}]}),
    "sections": (WIRE, {"cable__section": [{"length": 20.0, "diameter": 0.1}, {"length": 40.0}]}),
    "bending": (WIRE, {"cable__bending_stiffness": 1e3}),
    "current": (WIRE, {"current__levels": [[0.0, 1.0, 0.0], [-60.0, 0.2, 0.0]]}),
    "error control": (WIRE, {"solver__tolerance": 1e-3}),
    "parting": (WIRE, {"parting__time": 6.3, "parting__place": 30.0}),
    "a few": (WIRE, {"waves__components": 16}),
}
ENDS = swing((2.0, 0.0, 1.5), 0.7, ramp_time=2.0)


@pytest.mark.parametrize("case", RUNS)
def test_runs_are_those_of_all_components(case):
    """Within 2e-5 of the standard deviation of each output, or where steps are chosen a share of what they are chosen for.

    A cable that has parted whips, and doubles what it is off by time and again.
    """
    base, changes = RUNS[case]
    exact, fast = (drive(make(base, **changes, waves__exact=on), every(0.1, 12.0), ENDS) for on in (True, False))
    assert make(base, **changes).parts.followed is True
    until = 60 if case == "parting" else None
    for name in ("top.tension", "top.force_x", "top.force_z", "body.x", "body.z", "cable.tension_max"):
        off, spread = np.abs(fast[name] - exact[name])[:until].max(), exact[name][:until].std()
        assert off < (2e-4 if case == "error control" else 2e-5) * spread + 1e-9, (name, off, spread)
    assert fast["solver.steps"][-1] == pytest.approx(exact["solver.steps"][-1], rel=0.02 if case == "error control" else 0.0)
    assert not np.array_equal(fast["top.tension"], exact["top.tension"])


def test_whatever_the_communication_steps():
    random = np.random.default_rng(3)
    uneven = np.concatenate(([0.0], np.cumsum(random.choice([0.001, 0.05, 0.13, 0.2], 80))))
    exact, fast = (drive(make(WIRE, waves__exact=on), uneven, ENDS) for on in (True, False))
    for name in ("top.tension", "body.x", "body.z"):
        assert np.abs(fast[name] - exact[name]).max() < 2e-5 * exact[name].std(), name


@pytest.mark.parametrize("kernels", [None, compiled], ids=["object code", "numba"])
@pytest.mark.parametrize("surface", ["held", "wheeler"])
def test_a_restored_run_goes_on_bit_for_bit(kernels, surface):
    """Records are part of the state, and nothing else is: what room for sums holds does not matter."""
    model = CableChain(scene_of(WIRE, waves__surface=surface), kernels)
    times = every(0.07, 7.0)
    states: list[np.ndarray] = []
    first = drive(model, times, ENDS, lambda t: states.append(model.state.copy()))
    for k in (3, 51):
        model.state[:] = states[k]
        model._work[:] = 1e9
        for start, end in zip(times[k:-1], times[k + 1 :], strict=True):
            model.advance(start, end - start, ENDS(start), ENDS(end))
        assert np.array_equal(model.state, states[-1])
        assert model.outputs[OUTPUTS.index("top.tension")] == first["top.tension"][-1]


@pytest.mark.parametrize("forged", [1e300, -1.0, 1e9, 25.5, -1e300])
@pytest.mark.parametrize("place", ["all", *range(7), "reads"])
def test_a_state_from_outside_cannot_lead_astray_for_good(place, forged):
    """Whatever it says of when, where and how far its records serve: that shows for a while at most, and none reads what is not there."""
    model = make(WIRE, waves__surface="wheeler")
    right = drive(model, every(0.1, 3.0), ENDS)["top.tension"][-1]
    model.initialize(ENDS(0.0))
    water, surface = wave_records.record_sizes((0.0, 0.0))
    records = model.state[-26 * (water + surface) :]
    for k in range(30):
        if k == 5:
            if place == "all":
                records[:] = forged
            elif place == "reads":
                records[26 * water :][surface - 1 :: surface] = forged
            else:
                for size, some in ((water, records[: 26 * water]), (surface, records[26 * water :])):
                    some[place::size] = forged
            if forged > 0.0 and place in ("all", wave_records.SPAN, wave_records.WIDTH):
                records[0 :: water] = -1e3  # such a record would serve for good: nothing can tell that it is none of the run's
                records[1 :: water] = 0.0
        model.advance(0.1 * k, 0.1, ENDS(0.1 * k), ENDS(0.1 * (k + 1)))
    assert model.outputs[OUTPUTS.index("top.tension")] == pytest.approx(right, rel=1e-3)


def test_records_are_made_seldom():
    """Each cell's, and the body's, for many steps; what is told of the ends asks for none."""
    model = make(WIRE)
    size, _ = wave_records.record_sizes((0.0, 0.0))
    made, moments = np.zeros(26), np.full(26, math.nan)

    def count(t):
        nonlocal moments
        now = model.state[-26 * size :: size].copy()
        made[:] += now != moments
        moments = now

    drive(model, every(0.05, 6.0), ENDS, count)
    assert model.outputs[OUTPUTS.index("solver.steps")] == 120
    assert made[-1] <= made[0] + 1  # the body is beside the lowest cell
    assert np.all(made[:20] <= 15) and made.sum() < 400, made


# waves of 20 s, which are felt everywhere, and of 2 s, which are felt near the surface only
PEAKS = np.array([[0.35, 20.0 + 0.1 * k, 0.0, 0.7 * k] for k in range(8)] + [[0.05, 2.0 + 0.03 * k, 0.0, 1.1 * k] for k in range(8)])


@pytest.mark.parametrize("z", [-3.0, -8.0, -17.4, -30.0])
@pytest.mark.parametrize("speed", [0.0, 1.0, 4.0])
def test_short_waves_that_are_not_felt_yet_are_not_forgotten(z, speed):
    """At the edge of where a record serves, in time and beside its path, up and down."""
    omega = 2.0 * math.pi / PEAKS[:, 1]
    sea = np.column_stack((PEAKS[:, 0], omega, omega**2 / G, np.zeros(16), PEAKS[:, 3], np.zeros(16)))
    table = table_of(sea)
    plain, shares = Parts(water=True, waves=table), []
    for t in np.linspace(0.0, 40.0, 21):
        parts = followed(table, 2)
        velocity = (speed, speed)
        wave_motion_of(parts, 0, velocity, (3.0, z), t)
        record = parts.followed.water[0].copy()
        for late in (-0.97, 0.5, 0.97):
            for aside in (-0.97, 0.0, 0.97):
                s, e = late * record[wave_records.SPAN], aside * record[wave_records.WIDTH]
                place = (3.0 + speed * s, z + speed * s + e)
                if place[1] < 0.0:
                    got, want = wave_motion_of(parts, 0, velocity, place, t + s), wave_motion(plain, place, t + s)
                    assert np.array_equal(parts.followed.water[0], record)
                    shares.append([np.linalg.norm(np.subtract(a, b)) for a, b in zip(got, want, strict=True)] / scales(sea, place[1]))
    assert np.all(np.max(shares, axis=0) < SHARES), str(np.max(shares, axis=0))


def test_few_waves_are_summed():
    plain = len(make({**WIRE, "waves": {"amplitude": 1.0, "period": 6.0}}).state)
    many = wave_records.MANY
    table = [[0.1, 4.0 + 0.1 * k, 0.0, 0.3 * k] for k in range(many)]
    for waves, are in (
        ({**SEA, "components": many - 1}, False), ({**SEA, "components": many}, True), ({**SEA, "exact": True}, False),
        ({"table": table}, True), ({"table": table[1:]}, False), ({"table": table, "exact": True}, False),
    ):  # fmt: skip
        assert (len(make({**WIRE, "waves": waves}).state) > plain) == are, waves


def test_exactly_is_asked_of_waves_alone():
    with pytest.raises(ParameterError, match=r"waves\.exact = True: must be false without waves\. Give waves, or remove it\."):
        scene_of({**WIRE, "waves": {"exact": True}})


def test_the_series_of_a_component():
    random = np.random.default_rng(0)
    for angle in (*random.uniform(-1e4, 1e4, 300), 0.0, math.pi, -1e-9):
        assert circle(angle) == pytest.approx((math.cos(angle), math.sin(angle)), abs=1e-15 + 1e-16 * abs(angle))
    for x in (*random.uniform(-20.0, 0.0, 300), 0.0):
        assert power(x) == pytest.approx(math.exp(x), rel=2e-14)
