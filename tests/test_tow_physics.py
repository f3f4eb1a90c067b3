"""Physics of the tow model: its Lagrangian, its power balance, and the closed forms that [Wang 1971] checked his program with."""

import numpy as np
import pytest
from scipy.special import ellipk
from tow_reference import DRY, NUMBERS, SHEAR, SLOW, WAVES, WET, Reference, circling, follow, still, tow

from cable_model.effects import Parts, record
from cable_model.errors import SolverError
from cable_model.kernels import header, tow_step, tow_water
from cable_model.kernels import tow as kernels

VARIANTS = {
    "all": ({}, WET._replace(waves=WAVES)),
    "disk": ({"tow.body_angle": -0.6}, WET),
    "dry": ({}, DRY),
    "no cable mass": ({}, WET._replace(cable_mass=None)),
}


def states(count, seed):
    """Random tops (x, x', x'', y, y', y'' with y down) and motions, large angles and rates included."""
    random = np.random.default_rng(seed)
    for _ in range(count):
        top = random.normal(size=6) * [5.0, 1.0, 1.0, 5.0, 1.0, 1.0]
        yield tuple(top), (random.uniform(-2.5, 2.5), random.normal() * 0.3, 0.3 + random.normal() * 0.2, random.normal() * 0.5)


def kernel_numbers(changes):
    values = NUMBERS | {"tow.body_angle": 18.0, "cable.volume_per_length": -1.0} | changes
    return record(values)


def force_and_tensions(parts, c, top, time, motion):
    fx, fy, t_top, t_mean, t_body = kernels.end_forces(parts, c, top, time, motion, 0.0)
    return np.array([fx, fy]), t_top, t_mean, t_body


@pytest.mark.parametrize("variant", VARIANTS)
def test_accelerations_are_those_of_the_lagrangian(variant):
    changes, parts = VARIANTS[variant]
    c = kernels.constants(parts, kernel_numbers(changes))
    reference = Reference(parts, NUMBERS | changes)
    for top, motion in states(20, 1):
        got = kernels.accelerations(parts, c, top, 2.3, motion, 0.0)
        assert got == pytest.approx(reference.accelerations(top, 2.3, motion), rel=1e-8, abs=1e-9)


@pytest.mark.parametrize("variant", VARIANTS)
def test_power_balance_closes_at_any_state(variant):
    """d(K + V_g)/dt = F.v_top + sum D.v - T u', which the force at the top must satisfy."""
    changes, parts = VARIANTS[variant]
    c = kernels.constants(parts, kernel_numbers(changes))
    reference = Reference(parts, NUMBERS | changes)
    for top, motion in states(20, 2):
        rates = kernels.accelerations(parts, c, top, 2.3, motion, 0.0)
        force, _, tension, _ = force_and_tensions(parts, c, top, 2.3, motion)
        powers = [force[0] * top[1], force[1] * top[4], -tension * motion[3]]
        powers += [drag @ velocity for drag, velocity, _, _ in reference.drags(top, 2.3, motion)]
        assert sum(powers) == pytest.approx(reference.energy_rate(top, motion, rates), abs=1e-11 * sum(map(abs, powers)))


def test_the_printed_rule_of_tangential_drag_breaks_the_power_balance():
    """[Wang 1971, eq 45] lets the whole tangential drag work on the stretch; its virtual work is less."""
    c = kernels.constants(WET, kernel_numbers({}))
    reference = Reference(WET)
    top, motion = next(states(1, 3))
    printed = WET._replace(as_printed=True)
    rates = kernels.accelerations(printed, c, top, 0.0, motion, 0.0)
    force, _, tension, _ = force_and_tensions(printed, c, top, 0.0, motion)
    powers = [force[0] * top[1], force[1] * top[4], -tension * motion[3]]
    powers += [drag @ velocity for drag, velocity, _, _ in reference.drags(top, 0.0, motion)]
    gap = sum(powers) - reference.energy_rate(top, motion, rates)
    assert abs(gap) > 1e-4 * sum(map(abs, powers))


def test_energy_of_a_run_in_current_closes_to_one_part_in_1e9():
    """The energy gained between two times is the integral of all powers, Gauss points of every 0.1 s visited by the stepper."""
    parts = WET._replace(current=np.array([[0.0, 1.5, 0.0]]))
    model = tow(parts, solver__tolerance=1e-11)
    reference = Reference(parts)
    motion = circling(0.12, 0.9, 4.0)
    model.initialize(motion(0.0))
    at, weight = np.polynomial.legendre.leggauss(6)
    duration, step = (1.0 if SLOW else 10.0), 0.1

    def top_now():
        t = model.state[header.TOP : header.TOP + 9]
        return (t[0], t[3], t[6], -t[2], -t[5], -t[8])

    def energy():
        phi, w, u, ud = model.motion
        top = top_now()
        return reference.kinetic(phi, w, u, ud, top[1], top[4]) + reference.height(phi, u, top[3])

    start, gained, moved, time = energy(), 0.0, 0.0, 0.0
    for i in range(round(duration / step)):
        for share, part in zip((at + 1.0) / 2.0, weight / 2.0, strict=True):
            then = (i + share) * step
            model.advance(time, then - time, motion(time), motion(then))
            time = then
            top = top_now()
            power = -model["top.force_x"] * top[1] + model["top.force_z"] * top[4]
            power -= reference.tension(model.motion) * model.motion[3]
            power += sum(drag @ velocity for drag, velocity, _, _ in reference.drags(top, then, tuple(model.motion)))
            gained += part * step * power
            moved += part * step * abs(power)
    model.advance(time, duration - time, motion(time), motion(duration))
    assert energy() - start == pytest.approx(gained, abs=1e-9 * moved)


def test_resonance_after_fifty_cycles_is_fifty_pi_times_the_top_amplitude():
    """[Wang 1971, Direct Checks]: about 150; y'' + w^2 y = w^2 a sin(w t) gives 157.0796."""
    parts = Parts(body=True)
    model = tow(parts, tow__reference_tension=0.0, solver__tolerance=1e-10, solver__time_step=0.05)
    omega = np.sqrt(NUMBERS["cable.axial_stiffness"] / NUMBERS["cable.length"] / NUMBERS["body.mass"])
    amplitude, period = 1e-3, 2.0 * np.pi / omega

    def motion(t):
        z, vz = amplitude * np.sin(omega * t), amplitude * omega * np.cos(omega * t)
        return np.array([0, 0, z, 0, 0, vz, 0, 0, -(omega**2) * z])

    model.initialize(motion(0.0))
    model.set_state(0.0, 0.0, model.motion[2], amplitude * omega)  # the body itself at rest
    rest = model["body.z"]
    cycles = 5 if SLOW else 50
    follow(model, motion, period / 20, 20 * cycles)
    assert (model["body.z"] - rest) / amplitude == pytest.approx(-np.pi * cycles, rel=1e-6)


def test_axial_frequency_includes_a_third_of_the_cable_mass():
    model = tow(DRY, tow__reference_tension=0.0, solver__tolerance=1e-10)
    mass = NUMBERS["body.mass"] + NUMBERS["cable.mass_per_length"] * NUMBERS["cable.length"] / 3.0
    period = 2.0 * np.pi * np.sqrt(mass * NUMBERS["cable.length"] / NUMBERS["cable.axial_stiffness"])
    model.initialize(still())
    rest = model.motion[2]
    model.set_state(0.0, 0.0, rest + 0.1, 0.0)
    cycles = 2 if SLOW else 20
    follow(model, lambda t: still(), period, cycles)
    assert model.motion[2] - rest == pytest.approx(0.1, rel=1e-7)
    follow(model, lambda t: still(), period / 4, 1, start=cycles * period)
    assert (model.motion[2] - rest) / 0.1 == pytest.approx(0.0, abs=1e-6)


@pytest.mark.parametrize("cable_mass", [True, None])
@pytest.mark.parametrize("swing", [0.02, 1.2])
def test_pendulum_period_is_that_of_the_compound_or_simple_pendulum(swing, cable_mass):
    """A stiff cable: I phi'' = -G sin phi, with the closed form of large swings."""
    model = tow(DRY._replace(cable_mass=cable_mass), tow__reference_tension=0.0, cable__axial_stiffness=1e12, solver__tolerance=1e-10)
    body, cable = NUMBERS["body.mass"], NUMBERS["cable.mass_per_length"] * NUMBERS["cable.length"]
    carried = cable if cable_mass else 0.0
    rate = np.sqrt(NUMBERS["environment.gravity"] * (body + cable / 2) / (body + carried / 3) / NUMBERS["cable.length"])
    period = 4.0 * ellipk(np.sin(swing / 2.0) ** 2) / rate
    model.initialize(still())
    model.set_state(swing, 0.0, model.motion[2] * np.cos(swing), 0.0)
    cycles = 1 if SLOW else 10
    follow(model, lambda t: still(), period / 8, 8 * cycles + 2)
    assert model.motion[0] / swing == pytest.approx(0.0, abs=1e-6)


@pytest.mark.parametrize("variant", ["wet", "dry"])
def test_the_top_carries_weights_and_tension_falls_to_the_bodys_weight(variant):
    parts = WET._replace(current=None) if variant == "wet" else DRY
    model, reference = tow(parts), Reference(parts)
    model.initialize(still())
    assert model["top.force_z"] == pytest.approx(-(reference.wb + reference.wc), rel=1e-12)
    assert model["cable.tension_max"] == model["top.tension"] == pytest.approx(reference.wb + reference.wc, rel=1e-12)
    assert model["cable.tension_min"] == model["body.tension"] == pytest.approx(reference.wb, rel=1e-12)
    assert model["top.declination"] == pytest.approx(0.0, abs=1e-9)


def test_the_cable_stays_where_it_is_put_in_a_sheared_current():
    model = tow(WET)
    model.initialize(still())
    before = model.motion
    assert before[0] < -0.05  # the current flows to +x and takes the body there
    follow(model, lambda t: still(), 1.0, 2 if SLOW else 20)
    assert model.motion == pytest.approx(before, abs=1e-10)


def test_a_buoyant_body_floats_above_its_anchor():
    model = tow(WET._replace(current=None), body__volume=0.5)
    model.initialize(still(z=-200.0))
    assert model["body.z"] > -200.0 + 59.0
    assert model["top.declination"] == pytest.approx(np.pi, abs=1e-6)
    assert model["top.force_z"] > 0.0


def test_no_equilibrium_where_the_tension_floor_is_above_the_weight():
    model = tow(DRY._replace(tension_floor=True), tow__minimum_tension=1e5)
    with pytest.raises(SolverError, match=f"status {header.NO_EQUILIBRIUM}"):
        model.initialize(still())


@pytest.mark.parametrize(
    "added_mass",
    [
        0.0,
        pytest.param(
            1.0,
            marks=pytest.mark.xfail(
                strict=True,
                reason="the report's added mass moves with the absolute velocity of the cable, so a current exerts no Munk moment on it: "
                "phi = 0.65956 towed, 0.65965 held in the current",
            ),
        ),
    ],
)
def test_a_tow_through_still_water_equals_a_current_past_a_still_top(added_mass):
    speed, step, count = 1.4, 0.25, 8 if SLOW else 80
    sway = circling(0.4, 0.8, 3.0)
    towed = tow(WET._replace(current=None), cable__added_mass_coefficient=added_mass)
    held = tow(WET._replace(current=np.array([[0.0, -speed, 0.0]])), cable__added_mass_coefficient=added_mass)

    def drift(t):
        return sway(t) + np.array([speed * t, 0, 0, speed, 0, 0, 0, 0, 0])

    held.initialize(sway(0.0))
    towed.initialize(drift(0.0))
    towed.set_state(*held.motion)
    follow(towed, drift, step, count)
    follow(held, sway, step, count)
    assert towed.motion == pytest.approx(held.motion, rel=1e-8, abs=1e-9)
    for name in ("top.force_x", "top.force_z", "top.tension", "body.tension"):
        assert towed[name] == pytest.approx(held[name], rel=1e-8)
    assert towed["body.vx"] - speed == pytest.approx(held["body.vx"], abs=1e-8)


def test_the_mirror_image_of_a_motion_is_a_motion():
    flip = np.array([-1, 1, 1, -1, 1, 1, -1, 1, 1])
    sway = circling(0.4, 0.8, 3.0)
    plain, mirrored = tow(WET), tow(WET._replace(current=SHEAR * [1, -1, 1]))
    plain.initialize(sway(0.0))
    mirrored.initialize(sway(0.0) * flip)
    count = 4 if SLOW else 40
    follow(plain, sway, 0.25, count)
    follow(mirrored, lambda t: sway(t) * flip, 0.25, count)
    assert mirrored.motion == pytest.approx(plain.motion * [-1, -1, 1, 1], rel=1e-9, abs=1e-12)
    assert mirrored["top.force_x"] == pytest.approx(-plain["top.force_x"], rel=1e-9)


def test_the_diameter_at_the_reference_tension_is_the_given_one():
    """[Wang 1971, eq 4] must divide; as printed it multiplies, and the cable comes out too thin."""
    numbers = kernel_numbers({"tow.reference_tension": 2e4})
    wanted = 0.5 * 1025.0 * NUMBERS["cable.normal_drag_coefficient"] * NUMBERS["cable.diameter"]

    def at_reference(parts):
        c = kernels.constants(parts, numbers)
        return c.normal_drag * (1.0 - c.contraction * 2e4 / c.spring)

    assert at_reference(WET) == pytest.approx(wanted, rel=1e-14)
    assert at_reference(WET._replace(as_printed=True)) < 0.999 * wanted


def test_waves_are_free_of_divergence_and_the_printed_ones_are_not():
    def divergence(as_printed):
        d, parts = 1e-4, Parts(waves=WAVES, as_printed=as_printed)
        x1 = tow_water.wave_flow(parts, 3.0 + d, 4.0, 1.0)[0] - tow_water.wave_flow(parts, 3.0 - d, 4.0, 1.0)[0]
        y1 = tow_water.wave_flow(parts, 3.0, 4.0 + d, 1.0)[1] - tow_water.wave_flow(parts, 3.0, 4.0 - d, 1.0)[1]
        return (x1 + y1) / (2.0 * d), abs(x1) / (2.0 * d)

    gap, size = divergence(None)
    assert abs(gap) < 1e-7 * size
    gap, size = divergence(True)
    assert abs(gap) > size


def test_wangs_tangential_coefficient_multiplies_the_diameter():
    """[Wang 1971, eq 44] without a pi; half of a hoist's drag works on the stretch, its point being in the middle on average."""
    c = kernels.constants(WET, kernel_numbers({"tow.poisson_ratio": 0.0, "tow.reference_tension": 0.0}))
    hoist = (0.0, 0.0, 0.0, 0.0, -2.0, 0.0)
    q_phi, q_u, fx, fy, _ = tow_water.cable_water(True, Parts(), c, hoist, 0.0, (0.0, 0.0, 0.0, 0.0))
    assert fy == pytest.approx(0.5 * 1025.0 * 0.02 * 60.0 * 0.03 * 2.0**2, rel=1e-12)
    assert q_u == pytest.approx(0.5 * fy, rel=1e-12)
    assert (q_phi, fx) == (0.0, 0.0)


def test_a_top_that_leaves_the_plane_is_refused():
    model = tow(DRY)
    model.initialize(still())
    aside = still()
    aside[1] = 1e-3
    before = model.state.copy()
    with pytest.raises(SolverError, match="the top, the lower end or a current that inputs give left the vertical plane"):
        model.advance(0.0, 0.1, still(), aside)
    assert np.array_equal(model.state[: header.ERROR_TIME], before[: header.ERROR_TIME])
    assert np.array_equal(model.state[header.HEADER :], before[header.HEADER :])
    moving = still()
    moving[4] = 0.1
    with pytest.raises(SolverError, match="the top, the lower end or a current that inputs give left the vertical plane"):
        tow(DRY).initialize(moving)


def test_nodes_lie_on_the_straight_line_from_body_to_top():
    model = tow(DRY)
    model.initialize(still(x=3.0, z=-2.0))
    model.set_state(0.5, 0.0, 0.2, 0.0)
    points = np.zeros((5, 4))
    tow_step.points(model.parts, model.numbers, model.state, model._work, model.outputs, True, points)
    assert points[0] == pytest.approx([model["body.x"], 0.0, model["body.z"], model["body.tension"]])
    assert points[-1] == pytest.approx([3.0, 0.0, -2.0, model["top.tension"]])
    assert np.diff(points, axis=0) == pytest.approx(np.tile((points[-1] - points[0]) / 4.0, (4, 1)))
