"""Wang's two-degree-of-freedom tow model: a straight cable that swings and stretches uniformly, with a body at its end.

Inside, the report's axes and names: x right, y DOWN, phi > 0 when the body is at x < x of the top, u the stretch of the
lower end.  Equations of [Wang 1971] with its errors corrected; `as_printed` keeps what the report computed.
"""

import math
from typing import NamedTuple

from cable_model.kernels.exchange import tell_exchange
from cable_model.kernels.header import HEADER, NEWTON, PENDING, REJECTED, STEPS, TIME, TOP
from cable_model.kernels.jit import kernel
from cable_model.kernels.path import PATH
from cable_model.kernels.problem import body_part, cable_part, displaced_area, total_weight
from cable_model.kernels.tow_water import added_masses, body_water, cable_water, turned

ANGLE = HEADER  # phi
ANGLE_RATE = HEADER + 1
STRETCH = HEADER + 2  # u
STRETCH_RATE = HEADER + 3
PLANE = HEADER + 4  # y (FMI axes) of the plane of motion
EVALUATIONS = HEADER + 5  # right-hand sides computed so far
STATE = HEADER + 6
JOINED = 40  # in work, after what tow_schemes keeps there: path that begins with the pending time, and the top at its end
COUNTED = JOINED + PATH + 9  # impulse of the cable's force so far, over time that waited and over the communication step
WORK = COUNTED + 6
SLIVER = 1e-5  # of the times in which the cable swings and stretches by a radian: what is shorter waits for the next step


class Tow(NamedTuple):
    """Constants of the model; those of absent parts are zero."""

    reference_length: float  # l_r
    length: float  # l_0, at zero tension
    spring: float  # k = EA/l_r
    damper: float  # C_I/l_r
    floor: float  # least mean tension (TENS)
    contraction: float  # p/l_r: the diameter is d_0 (1 - contraction u)
    mass: float  # M_c in the forces
    mass_inertia: float  # M_c in A1 and A3
    added: float  # gamma rho pi d_0^2/4, kg/m, in the forces
    added_inertia: float  # the same in A1
    displaced: float  # mass of water that the cable displaces, kg
    weight: float  # W_c in the medium
    normal_drag: float  # 1/2 rho C_D d_0
    tangential_drag: float  # 1/2 rho C_t d_0
    segments: int
    mass_x: float  # M_x, body and its added mass
    mass_y: float
    pushed_x: float  # mass of water that the waves' acceleration pushes along with the body: displaced and added
    pushed_y: float
    body_weight: float  # W_b in the medium
    body_drag: float  # 1/2 rho (C_D A)_n
    body_drag_axial: float  # 1/2 rho (C_D A)_t
    sphere: bool  # drag along the flow, instead of a disk's
    body_sin: float
    body_cos: float
    force: float  # force scale: weights in the medium
    pendulum: float  # frequency scale of swinging, 1/s
    axial: float  # frequency of stretching, 1/s
    added_x: float  # of M_x and M_y what is added mass
    added_y: float
    lift: float  # buoyancy of the whole cable, N, and of the body
    body_lift: float
    radius: float  # of the cable
    body_radius: float  # of the sphere of the body's volume, no less than the cable's


@kernel
def zero_tension_diameter(as_printed, diameter, strain_contraction):
    """d_0 from the diameter at the reference tension; the report's eq 4 multiplies where eq 3 asks to divide."""
    if as_printed is None:
        return diameter / (1.0 - strain_contraction)
    return diameter * (1.0 - strain_contraction)


@kernel
def kept_mass(cable_mass, mass):
    if cable_mass is None:
        return 0.0
    return mass


@kernel
def kept_inertia(cable_mass, as_printed, mass):
    """Cable mass in A1 and A3: without cable mass (CBMAS < 0) the report leaves it there, and energy drifts."""
    if as_printed is None:
        return kept_mass(cable_mass, mass)
    return mass


@kernel
def density_of(water, p):
    if water is None:
        return 0.0
    return p[0].water.density


@kernel
def body_masses(body, water, p):
    """Of the body: mass, added mass for horizontal and vertical motion, displaced mass, weight, 1/2 rho C_D A across and along its axis,
    radius."""
    if body is None:
        return 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    b = body_part(body, water, p)
    density = density_of(water, p)
    vertical = p[0].tow.added_mass_vertical if density > 0.0 else 0.0
    return b.mass, b.added_mass, vertical, b.displaced_mass, b.weight, b.drag, 0.5 * density * p[0].tow.drag_area_axial, b.radius


@kernel
def voigt_coefficient(voigt, p):
    if voigt is None:
        return 0.0
    return p[0].cable.axial_damping


@kernel
def constants(parts, p):
    """Constants of a run [Wang 1971, eqs 1-7, 16, 24, 42-46].

    Length, diameter and mass per length of the cable are those at the reference tension.  The report's C_t multiplies d, not
    pi d (eq 44), so it is cable.tangential_drag_coefficient itself; the drag is that of the stretched length and thinned diameter.
    |tow.body_angle| > pi selects the sphere's drag law (the report's |PHIBD| > 180 degrees).
    """
    cable = cable_part(parts.water, p)
    density = density_of(parts.water, p)
    spring = cable.stiffness / cable.length
    stretch = p[0].tow.reference_tension / spring
    contraction = p[0].tow.poisson_ratio / cable.length
    diameter = zero_tension_diameter(parts.as_printed, cable.diameter, contraction * stretch)
    mass = cable.mass * cable.length
    added = p[0].cable.added_mass_coefficient * density * 0.25 * math.pi * diameter * diameter
    own, added_x, added_y, displaced, body_weight, drag, drag_axial, body_radius = body_masses(parts.body, parts.water, p)
    mass_x, mass_y = own + added_x, own + added_y
    inertia = kept_inertia(parts.cable_mass, parts.as_printed, mass)
    return Tow(
        cable.length,
        cable.length - stretch,
        spring,
        voigt_coefficient(parts.voigt, p) / cable.length,
        p[0].tow.minimum_tension,
        contraction,
        kept_mass(parts.cable_mass, mass),
        inertia,
        kept_mass(parts.cable_mass, added),
        kept_inertia(parts.cable_mass, parts.as_printed, added),
        density * displaced_area(p[0].cable) * cable.length,
        cable.weight * cable.length,
        0.5 * density * p[0].cable.normal_drag_coefficient * diameter,
        0.5 * density * p[0].cable.tangential_drag_coefficient * diameter,
        max(1, int(p[0].tow.drag_segments)),
        mass_x,
        mass_y,
        displaced + added_x,
        displaced + added_y,
        body_weight,
        drag,
        drag_axial,
        abs(p[0].tow.body_angle) > math.pi,
        math.sin(p[0].tow.body_angle),
        math.cos(p[0].tow.body_angle),
        total_weight(parts, p),
        max(math.sqrt(abs(cable.gravity) / cable.length), 1e-3),
        math.sqrt(spring / max(min(mass_x, mass_y) + inertia / 3.0, 1e-300)),
        added_x,
        added_y,
        density * displaced_area(p[0].cable) * cable.length * cable.gravity,
        displaced * cable.gravity,
        0.5 * cable.diameter,
        body_radius,
    )


@kernel
def excess_tension(c, motion):
    """k u + C_I u'/l_r - TENS: the cable is slack where it is negative."""
    return c.spring * motion[2] + c.damper * motion[3] - c.floor


@kernel
def mean_tension(tension_floor, c, motion, slack):
    """F_bc [Wang 1971, eq 54]; `slack` (0 or 1) says on which branch of the floor."""
    if tension_floor is None:
        return c.spring * motion[2] + c.damper * motion[3]
    if slack > 0.5:
        return c.floor
    return c.spring * motion[2] + c.damper * motion[3]


@kernel
def cable_inertia(cable_mass, c, top, motion, wet):
    """Forces of the cable's mass and added mass on phi and u, without those in A1 and A3; `wet` as tow_surface.Wet."""
    if cable_mass is None:
        return 0.0, 0.0
    phi, w, u, ud = motion
    length = c.length + u
    vn, vt = turned(top[1], top[4], math.sin(phi), math.cos(phi))
    an, at = turned(top[2], top[5], math.sin(phi), math.cos(phi))
    ma, ma_rate = added_masses(c, u)
    moved, turning = 0.5 * length * an, 2.0 / 3.0 * length * ud * w
    wet_swing = wet.first * moved + wet.second * turning + wet.first * (0.5 * vn * ud) + wet.whole * (vn * vt)
    wet_turn = wet.first * (0.5 * vn) + wet.second * (length * w / 3.0)
    r1 = -c.mass * (moved + turning) - ma * wet_swing - ma_rate * ud * length * wet_turn
    r2 = (
        -c.mass * (0.5 * at - length * w * w / 3.0)
        + ma * w * wet_turn
        + 0.5 * ma_rate * (wet.whole * (vn * vn) + wet.first * (vn * w * length) + wet.second * (length * length * w * w / 3.0))
    )
    return r1, r2


@kernel
def accelerations(parts, c, top, time, motion, slack):
    """phi'' and u'' [Wang 1971, eqs 47-49, corrected].

    top: x, x', x'', y, y', y'' (y down); motion: phi, phi', u, u'.
    """
    phi, w, u, ud = motion
    sin = math.sin(phi)
    cos = math.cos(phi)
    length = c.length + u
    q1, q2, _, _, wet = cable_water(parts.water, parts, c, top, time, motion)
    dx, dy, mass_x, mass_y = body_water(parts.body, parts.water, parts, c, top, time, motion)
    i1, i2 = cable_inertia(parts.cable_mass, c, top, motion, wet)
    alpha = mass_x * (top[2] - 2.0 * ud * w * cos + length * w * w * sin)
    beta = mass_y * (top[5] - 2.0 * ud * w * sin - length * w * w * cos)
    weight = c.body_weight + 0.5 * c.weight
    # body drag turns and pulls as eq 37; both equations of phi are divided by L
    r1 = cos * alpha + sin * beta - sin * weight - dx * cos - dy * sin + (i1 + q1) / length
    r2 = sin * alpha - cos * beta + cos * weight - dx * sin + dy * cos + i2 + q2
    r2 -= mean_tension(parts.tension_floor, c, motion, slack)
    thin = 1.0 - c.contraction * u
    a1 = (c.mass_inertia + wet.second * (c.added_inertia * thin * thin * length)) / 3.0 + mass_x * cos * cos + mass_y * sin * sin
    a2 = sin * cos * (mass_x - mass_y)
    a3 = c.mass_inertia / 3.0 + mass_x * sin * sin + mass_y * cos * cos
    det = 1.0 / (a1 * a3 - a2 * a2)
    return (a3 * r1 - a2 * r2) * det / length, (a1 * r2 - a2 * r1) * det


@kernel
def end_forces(parts, c, top, time, motion, slack):
    """Force of the support on the cable (x, y down), and the tensions at the top, in the mean and at the body."""
    wd, udd = accelerations(parts, c, top, time, motion, slack)
    return moving_forces(parts, c, top, time, motion, wd, udd, slack)


@kernel
def moving_forces(parts, c, top, time, motion, wd, udd, slack):
    """The same where phi'' and u'' are known.  From the momentum of cable and body; the report does not give it."""
    phi, w, u, ud = motion
    sin = math.sin(phi)
    cos = math.cos(phi)
    length = c.length + u
    _, _, cx, cy, wet = cable_water(parts.water, parts, c, top, time, motion)
    dx, dy, mass_x, mass_y = body_water(parts.body, parts.water, parts, c, top, time, motion)
    ax = top[2] - udd * sin - 2.0 * ud * w * cos - length * (cos * wd - sin * w * w)
    ay = top[5] + udd * cos - 2.0 * ud * w * sin - length * (sin * wd + cos * w * w)
    # force of the cable on the body
    bx = mass_x * ax - dx
    by = mass_y * ay - dy - c.body_weight
    vn, vt = turned(top[1], top[4], sin, cos)
    an, at = turned(top[2], top[5], sin, cos)
    ma, ma_rate = added_masses(c, u)
    half = wet.whole * vn + wet.first * (0.5 * length * w)
    along = c.mass * (at + 0.5 * udd - 0.5 * length * w * w) - ma * w * half
    turn = ud * w + 0.5 * length * wd
    wet_across = wet.whole * (an - w * vt) + wet.first * (0.5 * ud * w) + wet.first * (0.5 * length * wd)
    across = c.mass * (an + turn) + ma_rate * ud * half + ma * wet_across
    fx = bx - along * sin - across * cos - cx
    fy = by + along * cos - across * sin - cy - c.weight
    return fx, fy, fx * sin - fy * cos, mean_tension(parts.tension_floor, c, motion, slack), bx * sin - by * cos


@kernel
def slack_share(tension_floor, c, motion):
    if tension_floor is None:
        return 0.0
    if excess_tension(c, motion) <= 0.0:
        return 1.0
    return 0.0


@kernel
def shortest_step(c):
    return SLIVER / max(c.pendulum, c.axial)


@kernel
def motion_now(state):
    """phi, phi', u, u' led on over the pending time."""
    turning, stretching = state[ANGLE_RATE], state[STRETCH_RATE]
    return state[ANGLE] + state[PENDING] * turning, turning, state[STRETCH] + state[PENDING] * stretching, stretching


@kernel
def work_size(parts, p):
    return WORK


@kernel
def outputs_in_plane(space, parts, p, state, work, out):
    """Fill `out` in the order of signals.OUTPUTS; forces are those of the cable on the attachment, z up."""
    c = constants(parts, p)
    top = (state[TOP], state[TOP + 3], state[TOP + 6], -state[TOP + 2], -state[TOP + 5], -state[TOP + 8])
    motion = motion_now(state)
    slack = slack_share(parts.tension_floor, c, motion)
    fx, fy, t_top, t_mean, t_body = end_forces(parts, c, top, state[TIME], motion, slack)
    phi, w, u, ud = motion
    sin = math.sin(phi)
    cos = math.cos(phi)
    length = c.length + u
    out[0] = -fx
    out[1] = 0.0
    out[2] = fy
    out[3] = t_top
    out[4] = math.atan2(abs(sin), cos)
    out[5] = top[0] - length * sin
    out[6] = state[PLANE]
    out[7] = -top[3] - length * cos
    out[8] = top[1] - ud * sin - length * cos * w
    out[9] = 0.0
    out[10] = -top[4] - ud * cos + length * sin * w
    out[11] = t_body
    out[12] = max(t_top, t_mean, t_body)
    out[13] = min(t_top, t_mean, t_body)
    out[14] = slack
    out[15] = state[STEPS]
    out[16] = state[NEWTON]
    out[17] = state[REJECTED]
    tell_exchange(state, out)
