"""The water on the tow model in space: as tow_water.py, in the axes of the FMU."""

from cable_model.kernels.choice import by_presence
from cable_model.kernels.fluid import is_steady, water_motion
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
from cable_model.kernels.tow_water import added_masses, tangential_weight
from cable_model.kernels.vector import add, axpy, dot, mix, norm, scale, sub, upward, zero


@kernel
def _wet_forces(surface, c, added, loads, arm, total):
    return arm, total


@kernel
def _wet_in_part(surface, c, added, loads, arm, total):
    more_arm, more = surface_forces(surface, c, added, loads)
    return add(arm, more_arm), add(total, more)


_at_surface = by_presence(_wet_forces, _wet_in_part)


@kernel
def cable_water_in_space(water, parts, c, top, time, swing, u, ud):
    """Generalized force of the water on R, its force on the whole cable, and how wet that is; segments as tow_water.cable_water's."""
    if water is None:
        return zero(swing.e), zero(swing.e), Wet(1.0, 1.0, 1.0)
    x, v, _ = top
    length = c.length + u
    area = (1.0 - c.contraction * u) * length / c.segments
    added, _ = added_masses(c, u)
    arm = zero(swing.e)
    total = zero(swing.e)
    motion = mix(ud, swing.e, length, swing.rate)
    loads = no_loads(swing.e)
    reach = scale(length, swing.e)
    deep = is_deep(parts.surface, parts, c, x, reach)
    for i in range(c.segments):
        seg = wet_segment(c, i) if deep else segment(parts.surface, parts, c, i, x, reach, time)
        middle = seg.middle
        flow, rate, _ = water_motion(parts, axpy(middle * length, swing.e, x), time)
        if not deep:
            loads = with_segment(parts.surface, loads, seg, v, flow, motion, swing.e)
        flow = sub(flow, axpy(middle, motion, v))
        along = dot(flow, swing.e)
        across = axpy(-along, swing.e, flow)
        fn = scale(seg.wet * (c.normal_drag * area * norm(across)), across)
        ft = scale(seg.wet * (c.tangential_drag * area * abs(along) * along), swing.e)
        total = add(total, add(fn, ft))
        arm = add(arm, mix(middle, fn, tangential_weight(parts.as_printed, middle), ft))
        if not is_steady(parts):
            push = scale(seg.wet * ((c.displaced + added) / c.segments), rate)
            push = axpy(seg.wet * (-added / c.segments * dot(rate, swing.e)), swing.e, push)
            total = add(total, push)
            arm = axpy(middle, push, arm)
    arm, total = _at_surface(parts.surface, c, added, loads, arm, total)
    return arm, total, wetness(parts.surface, loads)


@kernel
def _deep_body(surface, c, ball, velocity, flow, force):
    return force


@kernel
def _bobbing_body(surface, c, ball, velocity, flow, force):
    return axpy(ball.wet, force, body_forces(surface, c, ball, velocity, flow))


_body_at_surface = by_presence(_deep_body, _bobbing_body)


@kernel
def body_water_in_space(body, water, parts, c, top, time, swing, u, ud):
    """Force of the water on the body: drag by the law of spheres or of disks, the waves' push, and what the surface changes; and its
    virtual masses.

    A disk's axis keeps its attitude in the plane of x and z.
    """
    if body is None or water is None:
        return zero(swing.e), c.mass_x, c.mass_y
    x, v, _ = top
    length = c.length + u
    place = axpy(length, swing.e, x)
    ball = sphere(parts.surface, parts, c, place, time)
    water_v, rate, _ = water_motion(parts, axpy(-ball.drop, upward(1.0, place), place), time)
    velocity = add(v, mix(ud, swing.e, length, swing.rate))
    mass_x, mass_y = virtual_masses(parts.surface, c, ball)
    flow = sub(water_v, velocity)
    push = (c.pushed_x * rate[0], c.pushed_x * rate[1], c.pushed_y * rate[2])
    if c.sphere:
        force = axpy(c.body_drag * norm(flow), flow, push)
    else:
        axis = (-c.body_sin, 0.0, -c.body_cos)
        along = dot(flow, axis)
        across = axpy(-along, axis, flow)
        force = add(push, mix(c.body_drag * norm(across), across, c.body_drag_axial * abs(along) * along, axis))
    return _body_at_surface(parts.surface, c, ball, velocity, water_v, force), mass_x, mass_y
