"""Water on cells and body of the staggered grid that are wet all through: loads and their derivatives."""

from cable_model.kernels.choice import by_presence
from cable_model.kernels.fluid import body_drag, element_drag, water_motion_of
from cable_model.kernels.jit import inlined, kernel
from cable_model.kernels.vector import (
    add_matrix,
    apply,
    axpy,
    diagonal,
    dot,
    mix,
    multiply,
    norm,
    outer,
    scale,
    scale_matrix,
    sub,
    upward,
    zero,
)

SHARE = 1.0 / 12.0  # of a cell's inertia that couples its two nodes


@kernel
def _no_water(water, parts, i, speed, position, time):
    return zero(position), zero(position), diagonal(0.0, position)


@kernel
def _some_water(water, parts, i, speed, position, time):
    return water_motion_of(parts, i, speed, position, time)


_water_at = by_presence(_no_water, _some_water)


def _element_water(water, medium, cable, h, split, q, motion, speed, low, up, gains):
    """Added mass, Froude-Krylov force and drag of a cell that moves at `speed` where the water has this motion.

    Returns residual shares of the lower and the upper node, their derivatives by q, by the cell's velocity and by its
    position, and the cell's inertia matrix per unit acceleration and length.
    """
    inertia = diagonal(cable.mass, q)
    none = diagonal(0.0, q)
    if water is None:
        return zero(q), zero(q), none, none, none, none, inertia
    stretch = norm(q)
    t = scale(1.0 / stretch, q)
    flow, flow_rate, flow_gradient = motion
    normal = add_matrix(diagonal(1.0, t), scale_matrix(-1.0, outer(t, t)))
    inertia = add_matrix(inertia, scale_matrix(medium.added_mass, normal))
    # added mass times (a - a_w) per length on the shares: only its normal part counts, so it turns with the cable
    low_load = scale(medium.added_mass, axpy(-split, flow_rate, low))
    up_load = scale(medium.added_mass, axpy(split - 1.0, flow_rate, up))
    low_q = scale_matrix(-h / stretch, turned_normal(normal, low_load, t))
    up_q = scale_matrix(-h / stretch, turned_normal(normal, up_load, t))
    # the cable's share of that is in the inertia matrix, the water's is a load; and the displaced mass feels all of a_w: T is the
    # effective tension, which takes the pressure's axial part in full, dynamic as static
    pressed = axpy(medium.displaced_mass, flow_rate, scale(medium.added_mass, apply(normal, flow_rate)))
    low_r = scale(-h * split, pressed)
    up_r = scale(h * (split - 1.0), pressed)
    drag, by_v, by_q = element_drag(medium, sub(speed, flow), t, stretch)
    low_r = axpy(-h * split, drag, low_r)
    up_r = axpy(h * (split - 1.0), drag, up_r)
    low_q = add_matrix(low_q, scale_matrix(-h * split, by_q))
    up_q = add_matrix(up_q, scale_matrix(h * (split - 1.0), by_q))
    # through the velocity (mean of both nodes) and through the place of the cell in the flow
    by_motion = add_matrix(scale_matrix(gains.v, by_v), scale_matrix(-gains.r, multiply(by_v, flow_gradient)))
    low_v = scale_matrix(-0.5 * h * split, by_motion)
    up_v = scale_matrix(0.5 * h * (split - 1.0), by_motion)
    return low_r, up_r, low_q, up_q, low_v, up_v, inertia


element_water = kernel(_element_water)
_element_water_here = inlined(_element_water)


@kernel
def turned_normal(normal, x, t):
    """-l d(N x)/dq at fixed x: N (t.x) + t (N x)."""
    return add_matrix(scale_matrix(dot(t, x), normal), outer(t, apply(normal, x)))


@inlined
def deep_cell(surface, parts, medium, cable, h, split, q, i, middle, speed, low, up, v_low, v_up, time, gains):
    """A cell that is wet all through, or in air."""
    motion = _water_at(parts.water, parts, i, mix(0.5, v_low, 0.5, v_up), middle, time)
    low_r, up_r, low_q, up_q, low_v, up_v, inertia = _element_water_here(
        parts.water, medium, cable, h, split, q, motion, speed, low, up, gains
    )
    return low_r, up_r, low_q, up_q, low_v, up_v, low_v, up_v, inertia


@kernel
def deep_body(surface, parts, body, cable, gains, i, position, v, a, time):
    mass = body.mass + body.added_mass
    residual = axpy(mass, a, upward(body.weight, v))
    jacobian = diagonal(mass * gains.a, v)
    if parts.water is None:
        return residual, jacobian
    flow, flow_rate, flow_gradient = water_motion_of(parts, i, v, position, time)
    drag, by_v = body_drag(body.drag, sub(v, flow))
    residual = sub(axpy(-(body.displaced_mass + body.added_mass), flow_rate, residual), drag)
    jacobian = add_matrix(jacobian, scale_matrix(-gains.v, by_v))
    return residual, add_matrix(jacobian, scale_matrix(gains.r, multiply(by_v, flow_gradient)))
