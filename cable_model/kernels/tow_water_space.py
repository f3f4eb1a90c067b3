"""The water on the tow model in space: as tow_water.py, in the axes of the FMU."""

from cable_model.kernels.fluid import water_motion
from cable_model.kernels.jit import kernel
from cable_model.kernels.tow_water import added_masses, tangential_weight
from cable_model.kernels.vector import add, axpy, dot, mix, norm, scale, sub, zero


@kernel
def cable_water_in_space(water, parts, c, top, time, swing, u, ud):
    """Generalized force of the water on R, and its force on the whole cable; segments as tow_water.cable_water's."""
    if water is None:
        return zero(swing.e), zero(swing.e)
    x, v, _ = top
    length = c.length + u
    area = (1.0 - c.contraction * u) * length / c.segments
    added, _ = added_masses(c, u)
    arm = zero(swing.e)
    total = zero(swing.e)
    for i in range(c.segments):
        middle = (i + 0.5) / c.segments
        flow, rate, _ = water_motion(parts, axpy(middle * length, swing.e, x), time)
        flow = sub(flow, axpy(middle, mix(ud, swing.e, length, swing.rate), v))
        along = dot(flow, swing.e)
        across = axpy(-along, swing.e, flow)
        fn = scale(c.normal_drag * area * norm(across), across)
        ft = scale(c.tangential_drag * area * abs(along) * along, swing.e)
        total = add(total, add(fn, ft))
        arm = add(arm, mix(middle, fn, tangential_weight(parts.as_printed, middle), ft))
        if parts.waves is not None:
            push = scale((c.displaced + added) / c.segments, rate)
            push = axpy(-added / c.segments * dot(rate, swing.e), swing.e, push)
            total = add(total, push)
            arm = axpy(middle, push, arm)
    return arm, total


@kernel
def body_water_in_space(body, water, parts, c, top, time, swing, u, ud):
    """Force of the water on the body: drag by the law of spheres or of disks, and the waves' push.

    A disk's axis keeps its attitude in the plane of x and z.
    """
    if body is None or water is None:
        return zero(swing.e)
    x, v, _ = top
    length = c.length + u
    flow, rate, _ = water_motion(parts, axpy(length, swing.e, x), time)
    flow = sub(flow, add(v, mix(ud, swing.e, length, swing.rate)))
    push = (c.pushed_x * rate[0], c.pushed_x * rate[1], c.pushed_y * rate[2])
    if c.sphere:
        return axpy(c.body_drag * norm(flow), flow, push)
    axis = (-c.body_sin, 0.0, -c.body_cos)
    along = dot(flow, axis)
    across = axpy(-along, axis, flow)
    return add(push, mix(c.body_drag * norm(across), across, c.body_drag_axial * abs(along) * along, axis))
