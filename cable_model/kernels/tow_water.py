"""The water on the tow model in the plane: drag of cable and body, and what the waves' acceleration does to them.

Axes of tow.py: x right, y DOWN.  T is the effective tension, which takes static buoyancy in full, and so the dynamic pressure too: the
load is the displaced mass times the whole acceleration of the water, and the added mass times its part across the cable.
"""

import math

from cable_model.kernels.choice import by_presence
from cable_model.kernels.fluid import current_motion, is_steady
from cable_model.kernels.jit import kernel
from cable_model.kernels.tow_surface import (
    Wet,
    body_forces,
    is_deep,
    no_loads,
    segment,
    sphere,
    surface_forces,
    virtual_masses,
    wet_segment,
    wetness,
    with_segment,
)
from cable_model.kernels.waves import wave_motion


@kernel
def wave_flow(parts, x, y, time):
    """Orbital velocity of the waves and its acceleration in (x, y down).

    As printed, eq 26b of the report has the vertical velocity upside down, and waves act through drag only.
    """
    if parts.waves is None:
        return 0.0, 0.0, 0.0, 0.0
    v, a, _ = wave_motion(parts, (x, -y), time)
    if parts.as_printed is None:
        return v[0], -v[1], a[0], -a[1]
    return v[0], v[1], 0.0, 0.0


@kernel
def water_flow(parts, x, y, time):
    """Velocity of current and waves, and the acceleration."""
    flow, rate, _ = current_motion(parts, (x, -y), time)
    vx, vy, ax, ay = wave_flow(parts, x, y, time)
    return flow[0] + vx, vy, rate[0] + ax, ay


@kernel
def tangential_weight(as_printed, middle):
    """Virtual work of a segment's tangential drag on the stretch; eq 45 of the report leaves it out."""
    if as_printed is None:
        return middle
    return 1.0


@kernel
def turned(x, y, sin, cos):
    """Components along n = (-cos, -sin) and t = (-sin, cos)."""
    return -x * cos - y * sin, -x * sin + y * cos


@kernel
def added_masses(c, u):
    """M_a and M_a' = dM_a/du of the cable."""
    thin = 1.0 - c.contraction * u
    length = c.length + u
    return c.added * thin * thin * length, c.added * thin * (thin - 2.0 * c.contraction * length)


@kernel
def _add_push(parts, wet, middle, rate, pushed):
    """Sums over the segments' wet shares of the water's acceleration along n and t, and of its moments, from those so far."""
    if is_steady(parts):
        return pushed
    n, t = wet * rate[0], wet * rate[1]
    return (pushed[0] + n, pushed[1] + t, pushed[2] + middle * n, pushed[3] + middle * t)


@kernel
def _wet_forces(surface, c, added, loads, sin, cos, length, forces):
    return forces


@kernel
def _wet_in_part(surface, c, added, loads, sin, cos, length, forces):
    arm, total = surface_forces(surface, c, added, loads)
    across, along = turned(arm[0], -arm[1], sin, cos)
    return forces[0] + length * across, forces[1] + along, forces[2] + total[0], forces[3] - total[1]


_at_surface = by_presence(_wet_forces, _wet_in_part)


@kernel
def cable_water(water, parts, c, top, time, motion):
    """Generalized forces of the water on phi and u, its force (x, y down), and how wet the cable is [Wang 1971, eqs 38-45]."""
    if water is None:
        return 0.0, 0.0, 0.0, 0.0, Wet(1.0, 1.0, 1.0)
    phi, phi_rate, u, u_rate = motion
    sin = math.sin(phi)
    cos = math.cos(phi)
    length = c.length + u
    across_top, along_top = turned(top[1], top[4], sin, cos)
    moment = 0.0
    pull = 0.0
    normal = 0.0
    tangential = 0.0
    pushed = (0.0, 0.0, 0.0, 0.0)
    # z up, as the surface asks for them
    e = (-sin, -cos)
    velocity = (top[1], -top[4])
    turning = (-u_rate * sin - length * cos * phi_rate, -u_rate * cos + length * sin * phi_rate)
    loads = no_loads(e)
    start, reach = (top[0], -top[3]), (length * e[0], length * e[1])
    deep = is_deep(parts.surface, parts, c, start, reach)
    for i in range(c.segments):
        seg = wet_segment(c, i) if deep else segment(parts.surface, parts, c, i, start, reach, time)
        middle = seg.middle
        s = middle * length
        vx, vy, ax, ay = water_flow(parts, top[0] - s * sin, top[3] + s * cos, time)
        if not deep:
            loads = with_segment(parts.surface, loads, seg, velocity, (vx, -vy), turning, e)
        across, along = turned(vx, vy, sin, cos)
        across -= across_top + s * phi_rate
        along -= along_top + middle * u_rate
        fn = seg.wet * (abs(across) * across)
        ft = seg.wet * (abs(along) * along)
        normal += fn
        tangential += ft
        moment += middle * fn
        pull += tangential_weight(parts.as_printed, middle) * ft
        pushed = _add_push(parts, seg.wet, middle, turned(ax, ay, sin, cos), pushed)
    area = (1.0 - c.contraction * u) * length / c.segments
    added, _ = added_masses(c, u)
    kn = c.normal_drag * area
    kt = c.tangential_drag * area
    push_t = c.displaced / c.segments
    push_n = push_t + added / c.segments
    fn = kn * normal + push_n * pushed[0]
    ft = kt * tangential + push_t * pushed[1]
    moment = kn * length * moment + push_n * length * pushed[2]
    forces = (moment, kt * pull + push_t * pushed[3], -fn * cos - ft * sin, -fn * sin + ft * cos)
    moment, pull, fx, fy = _at_surface(parts.surface, c, added, loads, sin, cos, length, forces)
    return moment, pull, fx, fy, wetness(parts.surface, loads)


@kernel
def _deep_body(surface, c, ball, velocity, flow, force):
    return force


@kernel
def _bobbing_body(surface, c, ball, velocity, flow, force):
    change = body_forces(surface, c, ball, velocity, flow)
    return ball.wet * force[0] + change[0], ball.wet * force[1] - change[1]


_body_at_surface = by_presence(_deep_body, _bobbing_body)


@kernel
def body_water(body, water, parts, c, top, time, motion):
    """Force of the water (x, y down) on the body: drag by the law of spheres or of disks [Wang 1971, eqs 32-35], the waves' push, and
    what the surface changes; and its virtual masses."""
    if body is None or water is None:
        return 0.0, 0.0, c.mass_x, c.mass_y
    phi, phi_rate, u, u_rate = motion
    sin = math.sin(phi)
    cos = math.cos(phi)
    length = c.length + u
    x, y = top[0] - length * sin, top[3] + length * cos
    ball = sphere(parts.surface, parts, c, (x, -y), time)
    flow_x, flow_y, ax, ay = water_flow(parts, x, y + ball.drop, time)
    body_x = top[1] - u_rate * sin - length * cos * phi_rate
    body_y = top[4] + u_rate * cos - length * sin * phi_rate
    mass_x, mass_y = virtual_masses(parts.surface, c, ball)
    vx, vy = flow_x - body_x, flow_y - body_y
    push_x = c.pushed_x * ax
    push_y = c.pushed_y * ay
    if c.sphere:
        k = c.body_drag * math.sqrt(vx * vx + vy * vy)
        fx, fy = k * vx + push_x, k * vy + push_y
    else:
        across, along = turned(vx, vy, c.body_sin, c.body_cos)
        dt = c.body_drag_axial * abs(along) * along
        dn = c.body_drag * abs(across) * across
        fx, fy = push_x - c.body_sin * dt - c.body_cos * dn, push_y + c.body_cos * dt - c.body_sin * dn
    fx, fy = _body_at_surface(parts.surface, c, ball, (body_x, -body_y), (flow_x, -flow_y), (fx, fy))
    return fx, fy, mass_x, mass_y
