"""The tow model at the water's surface: its Lagrangian with the wet part's energies, Archimedes, and what the chain says."""

from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
from scipy.optimize import brentq
from test_surface import HEAVED as CROSSED
from tow_reference import DRY, NUMBERS, SHEAR, WAVES, WET, Reference, circling, follow, still, tow, turned_sea

from cable_model.cable_chain import CableChain
from cable_model.effects import PARAMETERS, record
from cable_model.kernels import tow as plane
from cable_model.kernels import tow_space
from cable_model.kernels.problem import body_part, cable_part
from cable_model.kernels.staggered_step import Gains
from cable_model.kernels.staggered_surface import _bobbing_body
from cable_model.kernels.tow_water_space import body_water_in_space
from cable_model.kernels.wave_records import NOBODY
from cable_model.scene import from_dict, load, with_values
from cable_model.simulated import numbers_of
from cable_model.tow_cable import TowCable

DATA = Path(__file__).parent / "data"
G, RHO = NUMBERS["environment.gravity"], NUMBERS["water.density"]
FLAT = WET._replace(surface=True)
SPACE = FLAT._replace(space=True)
NO_DRAG = {
    "cable.normal_drag_coefficient": 0.0, "cable.tangential_drag_coefficient": 0.0, "body.drag_area": 0.0, "tow.drag_area_axial": 0.0,
}  # fmt: skip
AT, WEIGHT = (np.polynomial.legendre.leggauss(6)[0] + 1.0) / 2.0, np.polynomial.legendre.leggauss(6)[1] / 2.0
CALM = np.array([[0.0, 0.0, 0.0]])
NO_GAINS = Gains(*[0.0] * len(Gains._fields))
THICK = {"cable.diameter": 0.4, "cable.mass_per_length": 100.0}


def constants(parts, **changes):
    values = NUMBERS | {"tow.body_angle": 18.0, "cable.volume_per_length": -1.0} | {k.replace("__", "."): v for k, v in changes.items()}
    return plane.constants(parts, record(values)), values


def share(z, r):
    """Of a sphere, its middle z above the level; complex numbers allowed."""
    x = z / r
    return 0.0 if x.real > 1.0 else 1.0 if x.real < -1.0 else 0.5 - 0.75 * x + 0.25 * x**3


def submerged(z, r):
    """The integral of the share from z up."""
    x = z / r
    return 0.0 if x.real > 1.0 else -z if x.real < -1.0 else r * (0.1875 - 0.5 * x + 0.375 * x**2 - 0.0625 * x**4)


class Surfaced:
    """Energies and momenta of cable and body in space by quadrature between where the surface cuts; nothing from the kernels."""

    def __init__(self, values):
        self.p, self.base = values, Reference(WET, values)
        self.r = 0.5 * values["cable.diameter"]
        self.big = max((0.75 / np.pi * values["body.volume"]) ** (1.0 / 3.0), self.r)
        self.heavy = values["cable.mass_per_length"] * values["cable.length"]
        self.displaced = RHO * np.pi / 4.0 * values["cable.diameter"] ** 2 * values["cable.length"]

    def points(self, x, reach):
        """Places along the cable, from 0 at the top, and their weights: Gauss points of the pieces."""
        z, rise = x[2].real, reach[2].real
        cuts = [0.0, 1.0]
        if rise != 0.0:
            cuts += [f for f in ((-self.r - z) / rise, (self.r - z) / rise) if 0.0 < f < 1.0]
        cuts.sort()
        for low, high in pairwise(cuts):
            for at, weight in zip(AT, WEIGHT, strict=True):
                yield low + (high - low) * at, weight * (high - low)

    def added(self, reach):
        base, length = self.base, np.sqrt(reach @ reach)
        return base.gamma * RHO * np.pi / 4.0 * base.diameter(length - base.l0) ** 2 * length

    def body(self, x, reach):
        wet, p = share((x + reach)[2], self.big), self.p
        return p["body.mass"] + wet * np.array([p["body.added_mass"]] * 2 + [p["tow.added_mass_vertical"]])

    def energies(self, x, v, reach, rate):
        """Kinetic energy, and that of weights and buoyancy; the spring is left out."""
        e = reach / np.sqrt(reach @ reach)
        moving, height, added, p = 0.0, 0.0, self.added(reach), self.p
        for f, weight in self.points(x, reach):
            at, w = x + f * reach, v + f * rate
            moving = moving + 0.5 * weight * (self.base.mc * (w @ w) + added * share(at[2], self.r) * (w @ w - (w @ e) ** 2))
            height = height + weight * G * (self.heavy * at[2] + self.displaced * submerged(at[2], self.r))
        end, w = x + reach, v + rate
        height = height + G * (p["body.mass"] * end[2] + RHO * p["body.volume"] * submerged(end[2], self.big))
        return moving + 0.5 * (self.body(x, reach) @ w**2), height

    def lagrangian(self, *state):
        moving, height = self.energies(*state)
        return moving - height

    def momenta(self, x, v, reach, rate):
        """The Lagrangian's derivatives by `rate` and by v."""
        e = reach / np.sqrt(reach @ reach)
        on_reach = on_top = self.body(x, reach) * (v + rate)
        added = self.added(reach)
        for f, weight in self.points(x, reach):
            w = v + f * rate
            carried = weight * (self.base.mc * w + added * share((x + f * reach)[2], self.r) * (w - (w @ e) * e))
            on_reach, on_top = on_reach + f * carried, on_top + carried
        return on_reach, on_top


def rate_of(function, *moved):
    """Derivative of a function along (argument, its rate), by a complex step."""
    found = function(*(np.array(x) + 1e-30j * np.array(rate) for x, rate in moved))
    return np.array(found).imag / 1e-30


def crossings(count, seed, sizes=(1.0, 0.3, 0.5)):
    """Tops, directions and stretches at random, such that most cables cross the surface, and some lie in it or stand in it."""
    random = np.random.default_rng(seed)
    for k in range(count):
        e = random.normal(size=3)
        e = np.array([[0.8, 0.6, 1e-4], [0.0, 0.0, -1.0], [0.6, -0.8, 0.0]][k]) if k < 3 else e
        e /= np.linalg.norm(e)
        u = 0.3 + random.normal() * 0.2
        z = random.normal() * 0.1 if k < 3 else -random.uniform(0.0, 1.0) * (60.0 + u) * e[2]
        if k % 2:
            z = -(60.0 + u) * e[2] + random.normal() * 0.3  # the body in the surface
        top = (np.array([*random.normal(size=2), z]), random.normal(size=3) * sizes[0], random.normal(size=3))
        rate = np.cross(random.normal(size=3) * sizes[1] / 3.0, e)
        yield tuple(map(tuple, top)), tow_space.Swing(tuple(e), tuple(rate), tuple(e), tuple(e)), u, random.normal() * sizes[2]


@pytest.mark.plain
@pytest.mark.parametrize("cable_mass", [True, None])
def test_motion_and_force_are_those_of_the_wet_parts_lagrangian(cable_mass):
    parts = SPACE._replace(cable_mass=cable_mass, current=CALM)
    c, values = constants(parts, **NO_DRAG, **THICK)
    reference = Surfaced(values)
    if cable_mass is None:
        reference.base.mc = reference.base.gamma = 0.0
    seen = 0
    for top, swing, u, ud in crossings(24, 1):
        turning, stretching = tow_space.turning_and_stretching(parts, c, top, 0.0, swing, u, ud, 0.0)
        force, *_ = tow_space.end_forces_in_space(parts, c, top, 0.0, swing, u, ud, 0.0)
        e, w, length = np.array(swing.e), np.array(swing.rate), c.length + u
        x, v, a = map(np.array, top)
        reach, rate = length * e, ud * e + length * w
        second = (stretching - length * w @ w) * e + 2.0 * ud * w + length * (np.array(turning) - np.array(turning) @ e * e)
        gained = rate_of(reference.momenta, (x, v), (v, a), (reach, rate), (rate, second))
        zero = np.zeros(3)
        slopes = [
            [rate_of(reference.lagrangian, (x, k), (v, zero), (reach, j), (rate, zero)) for j, k in rows]
            for rows in ([(one, zero) for one in np.eye(3)], [(zero, one) for one in np.eye(3)])
        ]
        scale = np.abs(gained).sum() + np.abs(slopes).sum()
        tension = c.spring * u + c.damper * ud
        assert gained[0] - slopes[0] == pytest.approx(-tension * e, abs=1e-12 * scale)
        assert gained[1] - slopes[1] == pytest.approx(force, abs=1e-12 * scale)
        seen += abs(x[2] + reach[2]) < reference.big
    assert seen > 8


@pytest.mark.plain
@pytest.mark.parametrize("waves", ["stretched", "cut"])
def test_a_motion_in_the_plane_is_that_in_space_and_its_mirror_image_too(waves):
    parts = FLAT._replace(waves=WAVES, **{waves: True})
    c, _ = constants(parts, **THICK)
    turned = parts._replace(waves=turned_sea(WAVES, np.pi), current=SHEAR * [1.0, -1.0, 1.0])
    random = np.random.default_rng(4)
    for top, _, u, ud in crossings(12, 3):
        phi, w = random.uniform(-3.0, 3.0), random.normal() * 0.2
        z = (c.length + u) * np.cos(phi) * random.choice([1.0, random.uniform()]) + random.normal()
        flat = (top[0][0], top[1][0], top[2][0], -z, -top[1][2], -top[2][2])
        upward = tuple((x, 0.0, -y) for x, y in zip(flat[:3], flat[3:], strict=True))
        swing = tow_space.Swing((-np.sin(phi), 0.0, -np.cos(phi)), (-np.cos(phi) * w, 0.0, np.sin(phi) * w), (), ())
        found = plane.accelerations(parts, c, flat, 2.3, (phi, w, u, ud), 0.0)
        turning, stretching = tow_space.turning_and_stretching(parts._replace(space=True), c, upward, 2.3, swing, u, ud, 0.0)
        across = np.array(turning) @ [-np.cos(phi), 0.0, np.sin(phi)]
        assert found == pytest.approx((across, stretching), rel=1e-9, abs=1e-11)
        fx, fy, *tensions = plane.end_forces(parts, c, flat, 2.3, (phi, w, u, ud), 0.0)
        force, *others = tow_space.end_forces_in_space(parts._replace(space=True), c, upward, 2.3, swing, u, ud, 0.0)
        size = abs(fx) + abs(fy) + c.force
        assert (fx, 0.0, -fy) == pytest.approx(force, abs=1e-12 * size)
        assert tensions == pytest.approx(others, abs=1e-12 * size)
        mirrored = (*(-x for x in flat[:3]), *flat[3:])
        image = plane.accelerations(turned, c, mirrored, 2.3, (-phi, -w, u, ud), 0.0)
        assert image == pytest.approx((-found[0], found[1]), rel=1e-9, abs=1e-11)


@pytest.mark.plain
@pytest.mark.parametrize("waves", ["stretched", "cut"])
def test_a_body_in_waves_takes_from_the_surface_what_it_takes_on_the_chain(waves):
    """Mass times acceleration less all forces, as the staggered grid has them: the level and its rate are those of the waves."""
    parts = SPACE._replace(waves=WAVES, **{waves: True})
    c, values = constants(parts, tow__added_mass_vertical=60.0)
    numbers = record(values)
    body, cable = body_part(True, True, numbers), cable_part(True, numbers)
    random = np.random.default_rng(8)
    seen = 0
    for _ in range(20):
        e, v, w, a = (random.normal(size=3) for _ in range(4))
        e /= np.linalg.norm(e)
        length, place, u = c.length + 0.3, np.array([*random.normal(size=2) * 5.0, random.normal() * 0.6]), 0.3
        w -= w @ e * e
        top = (tuple(place - length * e), tuple(v - length * w), (0.0, 0.0, 0.0))
        swing = tow_space.Swing(tuple(e), tuple(w), (), ())
        force, mass_x, mass_z = body_water_in_space(True, True, parts, c, top, 1.3, swing, u, 0.0)
        chain, _ = _bobbing_body(True, parts, body, cable, NO_GAINS, NOBODY, tuple(place), tuple(v), tuple(a), 1.3)
        straight = np.array([mass_x, mass_x, mass_z]) * a - force + [0.0, 0.0, c.body_weight]
        assert straight == pytest.approx(chain, rel=1e-9, abs=1e-9)
        seen += mass_x < c.mass_x
    assert seen > 5


@pytest.mark.plain
def test_above_the_surface_there_is_no_water_and_below_it_no_surface():
    seas = {"waves": WAVES, "stretched": True}
    c, _ = constants(FLAT)
    dry, _ = constants(DRY)
    for top, _, u, ud in crossings(5, 6):
        motion = (np.tanh(top[0][1]), top[1][1], u, ud)
        flown, sunk = ((0.0, top[1][0], top[2][0], y, 0.3, top[2][2]) for y in (-90.0, 3.0))
        in_air = plane.accelerations(DRY._replace(voigt=True), dry._replace(damper=c.damper), flown, 1.0, motion, 0.0)
        assert plane.accelerations(FLAT._replace(**seas), c, flown, 1.0, motion, 0.0) == pytest.approx(in_air, rel=1e-12, abs=1e-13)
        in_water = plane.accelerations(WET._replace(**seas), c, sunk, 1.0, motion, 0.0)
        assert plane.accelerations(FLAT._replace(**seas), c, sunk, 1.0, motion, 0.0) == in_water


@pytest.mark.plain
@pytest.mark.parametrize("segments", [1.0, 4.0])
def test_drag_and_buoyancy_are_those_of_the_wet_length_however_few_the_segments(segments):
    """A cable at rest at an angle, its lower 23 m in a uniform current: by hand, moment about the top and pull along it included."""
    speed, wet, phi = 1.5, 23.0, 0.4
    parts = FLAT._replace(current=np.array([[0.0, speed, 0.0]]), body=None)
    c, _ = constants(parts, tow__drag_segments=segments, cable__added_mass_coefficient=0.0, tow__reference_tension=0.0)
    top = (0.0, 0.0, 0.0, -(60.0 - wet) * np.cos(phi), 0.0, 0.0)
    moment, pull, fx, fy, _ = plane.cable_water(True, parts, c, top, 0.0, (phi, 0.0, 0.0, 0.0))
    normal, along = ((0.5 * RHO * 0.02 * wet) * np.array([1.2, 0.03])) * (speed * np.array([np.cos(phi), np.sin(phi)])) ** 2
    lost = RHO * np.pi / 4.0 * 0.02**2 * G * np.array([60.0 - wet, 0.5 * (60.0 - wet) ** 2 / 60.0])  # in all, and on the lower end
    arm = 60.0 - 0.5 * wet
    assert fx == pytest.approx(normal * np.cos(phi) + along * np.sin(phi), rel=1e-12)
    assert fy == pytest.approx(normal * np.sin(phi) - along * np.cos(phi) + lost[0], rel=1e-12)
    assert moment == pytest.approx(-normal * arm - lost[1] * 60.0 * np.sin(phi), rel=1e-6)  # but for the thickness at the surface
    assert pull == pytest.approx(-along * arm / 60.0 + lost[1] * np.cos(phi), rel=1e-6)


FLOAT = {"body__mass": 300.0, "body__volume": 0.5, "cable__length": 30.0, "tow__reference_tension": 0.0, "tow__poisson_ratio": 0.0}


@pytest.mark.plain
@pytest.mark.parametrize("parts", [FLAT, SPACE])
@pytest.mark.parametrize("stiffness", [2e5, 2e4])
def test_a_taut_float_rests_by_archimedes(parts, stiffness):
    """Straight above its anchor: buoyancy of its wet share = its weight + half the cable's in water + the tension of the stretch."""
    model = tow(parts._replace(current=CALM), cable__axial_stiffness=stiffness, **FLOAT)
    model.initialize(still(z=-30.2))
    weight = 300.0 * G + 0.5 * (0.9 - RHO * np.pi / 4.0 * 0.02**2) * 30.0 * G
    big = (0.75 / np.pi * 0.5) ** (1.0 / 3.0)
    z = brentq(lambda z: RHO * 0.5 * G * share(z, big) - weight - stiffness / 30.0 * (z + 30.2 - 30.0), -5.0, 5.0, xtol=1e-13)
    assert model["body.z"] == pytest.approx(z, abs=1e-9)
    assert model["body.x"] == pytest.approx(0.0, abs=1e-9)
    assert model["cable.tension_max"] > 100.0


@pytest.mark.plain
@pytest.mark.parametrize("parts", [FLAT, SPACE])
@pytest.mark.parametrize("top", [-10.0, 2.0])
def test_a_float_on_a_longer_line_rests_at_the_surface_aside(parts, top):
    """The line carries nothing: the sphere's wet share lifts it and the line's half; of all places around, the one at larger x."""
    model = tow(parts._replace(current=CALM), **FLOAT)
    model.initialize(still(z=top))
    cable, big = RHO * np.pi / 4.0 * 0.02**2 * 30.0 * G, (0.75 / np.pi * 0.5) ** (1.0 / 3.0)

    def load(z):
        dry = max(0.0, top) / (top - z)
        return RHO * 0.5 * G * share(z, big) - 300.0 * G - 0.5 * 27.0 * G + 0.5 * cable * (1.0 - dry * dry)

    z = brentq(load, -0.9 * big, 0.9 * big, xtol=1e-13)
    assert model["body.z"] == pytest.approx(z, abs=1e-5)  # but for the line's half thickness
    assert model["body.x"] == pytest.approx(np.sqrt(30.0**2 - (z - top) ** 2), abs=1e-4)
    assert abs(model.state[plane.STRETCH]) < 1e-9


@pytest.mark.plain
def test_a_float_is_carried_to_where_the_current_goes():
    for speed in (-0.3, 0.3):
        for parts in (FLAT, SPACE):
            model = tow(parts._replace(current=np.array([[0.0, speed, 0.0]])), **FLOAT)
            model.initialize(still(z=-10.0))
            assert np.sign(speed) * model["body.x"] == pytest.approx(28.3, abs=0.1)
            assert model.state[plane.STRETCH] > 0.0


def of_scene(scene, parts):
    """A model of the numbers of a scene, with parts that other tests have compiled."""
    numbers = numbers_of(scene)[0]
    return TowCable.from_numbers({name: float(numbers[name.partition(".")[0]][name.partition(".")[2]]) for name in PARAMETERS}, parts)


@pytest.mark.plain
@pytest.mark.parametrize("parts", [FLAT, SPACE])
@pytest.mark.parametrize(
    ("name", "weight", "top"),
    [
        ("F1_chain_half_dry", 181202.8, 30.0),  # source: found by users, see each file
        ("F1_body_in_air", (500.0 + 1.0 * 30.0) * 9.80665, 60.0),
        ("F1_wire_in_air_in_current", 20.0 * 30.0 * 9.80665, 35.0),
    ],
)
def test_reported_scenes_at_their_right_values(name, weight, top, parts):
    model = of_scene(load(DATA / f"{name}.toml"), parts._replace(current=np.array([[0.0, 2.0 * ("current" in name), 0.0]])))
    model.initialize(still(z=top))
    assert model["top.force_z"] == pytest.approx(-weight, rel=2e-5)
    assert abs(model["top.force_x"]) < 1e-6 * weight
    assert abs(model["body.x"]) < 1e-6


def apart(height, mass, diameter):
    """Ways of a circled body on the chain, and how far the straight cable is from them: x, z, the tension at the top, over their ranges."""
    changes = {"cable.mass_per_length": mass, "cable.diameter": diameter, "top.position": (0.0, 0.0, height), "top.motion": ()}
    stiff = {"cable.axial_stiffness": 1e6, "solver.time_step": 0.01, "solver.slack_damping": 0.1}
    scene = with_values(CROSSED, {**changes, **stiff})
    circle, runs = circling(1.6, 0.9, 6.0), []
    for model in (CableChain(scene), TowCable(scene)):
        rows = []

        def see(_, model=model, rows=rows):
            rows.append(model.outputs[[5, 7, 3]].copy())

        model.initialize(circle(0.0) + still(z=height))
        follow(model, lambda t: circle(t) + still(z=height), 0.05, 240, see=see)
        runs.append(rows)
    chain, straight = np.array(runs)
    return chain, np.max(np.abs(chain - straight), axis=0) / np.ptp(chain, axis=0)


def test_a_body_goes_through_the_surface_as_on_the_chain():
    """A light wire: what is left is its axial ringing in the tension."""
    chain, differs = apart(7.0, 0.4, 0.05)
    assert chain[:, 1].min() < -2.0 and chain[:, 1].max() > 0.7
    assert np.all(differs < (1e-3, 5e-4, 2e-2))


def test_a_heavy_cable_through_the_surface_differs_from_the_chain_as_much_as_a_deep_one():
    """By what a straight cable leaves out: its bow."""
    assert np.all(apart(3.0, 20.0, 0.07)[1] < 1.2 * apart(-12.0, 20.0, 0.07)[1])


CABLE = {"length": 5.0, "mass_per_length": 0.5, "axial_stiffness": 1e4, "diameter": 0.02}
NO_REFERENCE = {"tow.reference_tension": 0.0, "tow.poisson_ratio": 0.0}
BOB = NO_DRAG | {
    "cable.length": 5.0, "cable.mass_per_length": 0.5, "cable.axial_stiffness": 1e4, "cable.diameter": 0.02, "body.mass": 600.0,
    "cable.added_mass_coefficient": 1.0, "body.volume": 0.3, "body.added_mass": 150.0, "tow.added_mass_vertical": 250.0,
    "water.density": RHO, "environment.gravity": G,
}  # fmt: skip


def bobbing(step, duration, kick):
    """Energies and heights of a body that is hung from a spring above the water, kicked aside and down."""
    model = TowCable(with_values(from_dict({"cable": CABLE, "water": {}}), BOB | {"solver.time_step": step}))
    reference = Surfaced(NO_REFERENCE | BOB)
    model.initialize(still(z=7.19))
    phi, _, u, _ = model.motion
    model.set_state(phi, kick / (5.0 + u), u, kick)
    energies, heights = [], []

    def see(_):
        phi, w, u, ud = model.motion
        e, n, top = np.array([-np.sin(phi), 0.0, -np.cos(phi)]), np.array([-np.cos(phi), 0.0, np.sin(phi)]), np.array([0.0, 0.0, 7.19])
        moving, height = reference.energies(top, np.zeros(3), (5.0 + u) * e, ud * e + (5.0 + u) * w * n)
        energies.append(moving + height + 0.5 * 1e4 / 5.0 * u * u)
        heights.append(top[2] + (5.0 + u) * e[2])

    see(0.0)
    follow(model, lambda t: still(z=7.19), step, round(duration / step), see=see)
    return np.array(energies), np.array(heights)


def drift(step, kick):
    energies, heights = bobbing(step, 20.48, kick)
    return np.max(np.abs(energies - energies[0])) / (300.0 * 2.0 * kick**2), heights


def test_a_bobbing_sphere_keeps_its_energy_at_the_order_of_the_scheme():
    """Radau's 5 while the surface cuts the sphere all the time; 2 where it dips under and comes out: the share is not smooth there."""
    errors = {step: drift(step, 0.4)[0] for step in (0.32, 0.04)}
    assert np.log2(errors[0.32] / errors[0.04]) / 3.0 == pytest.approx(5.0, abs=0.1)
    radius = (0.75 / np.pi * 0.3) ** (1.0 / 3.0)
    coarse, heights = drift(0.16, 1.5)
    assert heights.min() < -radius and heights.max() > radius
    assert drift(0.01, 1.5)[0] < 2e-5
    assert coarse / drift(0.0025, 1.5)[0] > 64.0**2
