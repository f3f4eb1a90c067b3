"""The tow model in space: the straight cable swings in every direction (the first extension that [Wang 1971] proposes).

Axes of the FMU, z up.  R = L e points from the top to the lower end: e its direction, L = l_0 + u its length.  Lagrange's equations
in the components of R have no singular direction.  With v the top's velocity, P = I - e e^T and B the body's virtual masses,

    K = M_c (v.v + v.R' + R'.R'/3)/2 + M_a(u) (v.Pv + v.PR' + R'.PR'/3)/2 + (v + R').B(v + R')/2.

Within a step the direction is e = cos|xi| e_0 + sin|xi| xi/|xi| with xi in the plane across the direction e_0 at its start: a
motion in one vertical plane is then that of tow.py, and a scene turned about the vertical gives the answer turned.
"""

import math
from typing import NamedTuple

from cable_model.kernels.exchange import tell_exchange
from cable_model.kernels.header import NEWTON, PENDING, REJECTED, STEPS, TIME, TOP
from cable_model.kernels.jit import kernel
from cable_model.kernels.path import evaluate
from cable_model.kernels.tow import (
    STATE,
    STRETCH,
    STRETCH_RATE,
    constants,
    mean_tension,
    slack_share,
)
from cable_model.kernels.tow_water import added_masses
from cable_model.kernels.tow_water_space import body_water_in_space, cable_water_in_space
from cable_model.kernels.vector import (
    add,
    add_matrix,
    apply,
    axpy,
    diagonal,
    dot,
    inverse,
    load,
    mix,
    outer,
    scale,
    scale_matrix,
    store,
    sub,
    unit,
    zero,
)

DIRECTION = STATE  # e, 3 numbers
TURNING = STATE + 3  # e'
STATE_IN_SPACE = STATE + 6


class Frame(NamedTuple):
    """The direction at the start of a step, and two directions across it."""

    e: tuple
    a: tuple
    b: tuple


class Swing(NamedTuple):
    """Direction of the cable and its rate; the directions along and across the way it has turned since the start of the step."""

    e: tuple
    rate: tuple
    along: tuple
    across: tuple


@kernel
def cross(a, b):
    return (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])


@kernel
def frame_of(e):
    axis = (1.0, 0.0, 0.0) if abs(e[2]) > 0.7 else (0.0, 0.0, 1.0)
    a = unit(axpy(-dot(axis, e), e, axis))
    return Frame(e, a, cross(e, a))


@kernel
def swing_of(frame, y):
    """Where the cable points, and how it turns; y = (xi_1, xi_1', u, u', xi_2, xi_2')."""
    angle = math.sqrt(y[0] * y[0] + y[4] * y[4])
    c1, c2 = (y[0] / angle, y[4] / angle) if angle > 0.0 else (1.0, 0.0)
    sin, cos = math.sin(angle), math.cos(angle)
    sinc = sin / angle if angle > 0.0 else 1.0
    outward = mix(c1, frame.a, c2, frame.b)
    across = mix(c1, frame.b, -c2, frame.a)
    along = mix(cos, outward, -sin, frame.e)
    rate = mix(c1 * y[1] + c2 * y[5], along, sinc * (c1 * y[5] - c2 * y[1]), across)
    return Swing(mix(cos, frame.e, sin, outward), rate, along, across)


@kernel
def _curvature(y):
    """Of the chart at y: the direction outward in it, sin|xi|/|xi|, and what its curvature adds to accelerations along and across."""
    angle = math.sqrt(y[0] * y[0] + y[4] * y[4])
    c1, c2 = (y[0] / angle, y[4] / angle) if angle > 0.0 else (1.0, 0.0)
    outward = c1 * y[1] + c2 * y[5]
    sideways = c1 * y[5] - c2 * y[1]
    square = angle * angle
    sinc = math.sin(angle) / angle if angle > 0.0 else 1.0
    if angle < 1e-2:
        bent = angle * (-2.0 / 3.0 + square * 2.0 / 15.0)
        curled = angle * (2.0 / 3.0 + square * 2.0 / 45.0)
    else:
        bent = (sinc * math.cos(angle) - 1.0) / angle
        curled = 2.0 * (1.0 - math.cos(angle) / sinc) / angle
    return c1, c2, sinc, bent * sideways * sideways, curled * outward * sideways


@kernel
def chart_accelerations(y, swing, turning):
    """xi_1'' and xi_2'' of the direction's second derivative (only its part across e counts)."""
    c1, c2, sinc, bent, curled = _curvature(y)
    first = dot(turning, swing.along) + bent
    second = dot(turning, swing.across) / sinc + curled
    return c1 * first - c2 * second, c2 * first + c1 * second


@kernel
def turning_of(y, swing, x1, x2):
    """The direction's second derivative from xi_1'' and xi_2''."""
    c1, c2, sinc, bent, curled = _curvature(y)
    across = mix(c1 * x1 + c2 * x2 - bent, swing.along, sinc * (c1 * x2 - c2 * x1 - curled), swing.across)
    return axpy(-dot(swing.rate, swing.rate), swing.e, across)


@kernel
def across_only(e, a):
    return axpy(-dot(e, a), e, a)


@kernel
def added_mass_forces(cable_mass, c, top, swing, u, ud, wet):
    """What the cable's added mass puts on the right-hand side of R's equations; M_a = M_a(u) sees velocities across the cable only.

    `wet` as tow_surface.Wet: moments of its wet part over those of the whole.
    """
    if cable_mass is None:
        return zero(swing.e)
    _, v, a = top
    e, w = swing.e, swing.rate
    length = c.length + u
    mass, by_stretch = added_masses(c, u)
    v_along = dot(v, e)
    v_across = across_only(e, v)
    squared = wet.first * dot(v_across, w) + wet.second * (length * dot(w, w) / 3.0)
    squared = wet.whole * dot(v_across, v_across) + length * squared
    # -d/dt of the momentum without R''
    force = scale(-by_stretch * ud, mix(wet.first * 0.5, v_across, wet.second * (length / 3.0), w))
    turning = add(scale(v_along, w), scale(dot(v, w), e))
    force = axpy(wet.first * (-0.5 * mass), sub(across_only(e, a), turning), force)
    force = axpy(wet.second * (mass / 3.0), mix(ud, w, length * dot(w, w), e), force)
    # dK/dR
    force = axpy(0.5 * by_stretch * squared, e, force)
    by_w = length * (wet.first * v_along + wet.second * (2.0 / 3.0 * ud))
    sum_across = mix(wet.whole * (2.0 * v_along) + wet.first * ud, v_across, by_w, w)
    return axpy(-0.5 * mass / length, sum_across, force)


@kernel
def turning_and_stretching(parts, c, top, time, swing, u, ud, slack):
    """Second derivatives of e and of u [Lagrange's equations of Wang's cable]; top: position, velocity, acceleration."""
    _, _, a = top
    e, w = swing.e, swing.rate
    length = c.length + u
    arm, _, wet = cable_water_in_space(parts.water, parts, c, top, time, swing, u, ud)
    drag, mass_x, mass_y = body_water_in_space(parts.body, parts.water, parts, c, top, time, swing, u, ud)
    force = add(arm, drag)
    force = axpy(-0.5 * c.mass, a, force)
    force = (force[0] - mass_x * a[0], force[1] - mass_x * a[1], force[2] - mass_y * a[2] - c.body_weight - 0.5 * c.weight)
    force = add(force, added_mass_forces(parts.cable_mass, c, top, swing, u, ud, wet))
    force = axpy(-mean_tension(parts.tension_floor, c, (0.0, 0.0, u, ud), slack), e, force)
    mass, _ = added_masses(c, u)
    mass *= wet.second
    inertia = add_matrix(diagonal((c.mass_inertia + mass) / 3.0, e), scale_matrix(-mass / 3.0, outer(e, e)))
    inertia = add_matrix(inertia, (mass_x, 0.0, 0.0, 0.0, mass_x, 0.0, 0.0, 0.0, mass_y))
    r = apply(inverse(inertia), force)
    stretching = dot(r, e) + length * dot(w, w)
    turning = scale(1.0 / length, axpy(-stretching, e, axpy(-2.0 * ud, w, r)))
    return turning, stretching


@kernel
def top_in_space(drive, elapsed):
    """Position, velocity and acceleration of the top."""
    s = elapsed / drive.h
    x, vx, ax = evaluate(drive.path, drive.h, s, 0)
    y, vy, ay = evaluate(drive.path, drive.h, s, 1)
    z, vz, az = evaluate(drive.path, drive.h, s, 2)
    return (x, y, z), (vx, vy, vz), (ax, ay, az)


@kernel
def derivative_in_space(space, parts, c, drive, elapsed, y, slack):
    """Rates of y = (xi_1, xi_1', u, u', xi_2, xi_2'); NaN where the cable has shrunk to nothing, turned round or run away."""
    wild = not (abs(y[0]) + abs(y[4]) < 2.5 and abs(y[1]) + abs(y[5]) < 1e12)
    if wild or not (c.length + y[2] > 1e-6 * c.length and y[2] < 1e12 and abs(y[3]) < 1e12):
        return (math.nan, math.nan, math.nan, math.nan, math.nan, math.nan)
    top = top_in_space(drive, elapsed)
    swing = swing_of(drive.frame, y)
    turning, stretching = turning_and_stretching(parts, c, top, drive.time + elapsed, swing, y[2], y[3], slack)
    first, second = chart_accelerations(y, swing, turning)
    return (y[1], first, y[3], stretching, y[5], second)


@kernel
def motion_in_space(space, state):
    """The motion in the chart at the state's direction, and that chart."""
    row = state[DIRECTION : DIRECTION + 6].reshape(2, 3)
    frame = frame_of(load(row, 0, (0.0, 0.0, 0.0)))
    rate = load(row, 1, frame.e)
    return (0.0, dot(rate, frame.a), state[STRETCH], state[STRETCH_RATE], 0.0, dot(rate, frame.b)), frame


@kernel
def recharted_in_space(space, y, frame):
    """The same motion in the chart at where the cable points now."""
    swing = swing_of(frame, y)
    new = frame_of(unit(swing.e))
    return (0.0, dot(swing.rate, new.a), y[2], y[3], 0.0, dot(swing.rate, new.b)), new


@kernel
def keep_in_space(space, y, frame, state):
    swing = swing_of(frame, y)
    row = state[DIRECTION : DIRECTION + 6].reshape(2, 3)
    store(row, 0, swing.e)
    store(row, 1, swing.rate)
    state[STRETCH] = y[2]
    state[STRETCH_RATE] = y[3]


@kernel
def top_of(state):
    row = state[TOP : TOP + 9].reshape(3, 3)
    like = (0.0, 0.0, 0.0)
    return load(row, 0, like), load(row, 1, like), load(row, 2, like)


@kernel
def swing_now(state):
    """The swing, the stretch and its rate, led on over the pending time."""
    y, frame = motion_in_space(True, state)
    pending = state[PENDING]
    u = y[2] + pending * y[3]
    return swing_of(frame, (pending * y[1], y[1], u, y[3], pending * y[5], y[5])), u, y[3]


@kernel
def end_forces_in_space(parts, c, top, time, swing, u, ud, slack):
    """Force of the support on the cable, and the tensions at the top, in the mean and at the body; as tow.end_forces."""
    turning, stretching = turning_and_stretching(parts, c, top, time, swing, u, ud, slack)
    return moving_forces_in_space(parts, c, top, time, swing, u, ud, turning, stretching, slack)


@kernel
def moving_forces_in_space(parts, c, top, time, swing, u, ud, turning, stretching, slack):
    """The same where the second derivatives of e and of u are known."""
    _, v, a = top
    e, w = swing.e, swing.rate
    length = c.length + u
    r = add(mix(stretching, e, 2.0 * ud, w), scale(length, turning))
    _, drag, wet = cable_water_in_space(parts.water, parts, c, top, time, swing, u, ud)
    pull, mass_x, mass_y = body_water_in_space(parts.body, parts.water, parts, c, top, time, swing, u, ud)
    b = add(a, r)
    b = sub((mass_x * b[0], mass_x * b[1], mass_y * b[2] + c.body_weight), pull)
    mass, by_stretch = added_masses(c, u)
    f = axpy(c.mass, axpy(0.5, r, a), b)
    f = axpy(by_stretch * ud, axpy(wet.first * (0.5 * length), w, scale(wet.whole, across_only(e, v))), f)
    carried = add(scale(dot(e, v), w), scale(dot(w, v), e))
    swept = axpy(wet.first * 0.5, mix(ud, w, length, turning), scale(wet.whole, across_only(e, a)))
    f = axpy(mass, sub(swept, scale(wet.whole, carried)), f)
    f = sub(f, drag)
    f = (f[0], f[1], f[2] + c.weight)
    return f, -dot(f, e), mean_tension(parts.tension_floor, c, (0.0, 0.0, u, ud), slack), -dot(b, e)


@kernel
def outputs_in_space(space, parts, p, state, work, out):
    """Fill `out` in the order of signals.OUTPUTS; forces are those of the cable on the attachment."""
    c = constants(parts, p)
    top = top_of(state)
    swing, u, ud = swing_now(state)
    length = c.length + u
    slack = slack_share(parts.tension_floor, c, (0.0, 0.0, u, ud))
    f, t_top, t_mean, t_body = end_forces_in_space(parts, c, top, state[TIME], swing, u, ud, slack)
    place = axpy(length, swing.e, top[0])
    velocity = add(top[1], mix(ud, swing.e, length, swing.rate))
    for k in range(3):
        out[k] = -f[k]
        out[5 + k] = place[k]
        out[8 + k] = velocity[k]
    out[3] = t_top
    out[4] = math.atan2(math.sqrt(swing.e[0] ** 2 + swing.e[1] ** 2), -swing.e[2])
    out[11] = t_body
    out[12] = max(t_top, t_mean, t_body)
    out[13] = min(t_top, t_mean, t_body)
    out[14] = slack
    out[15] = state[STEPS]
    out[16] = state[NEWTON]
    out[17] = state[REJECTED]
    tell_exchange(state, out)
