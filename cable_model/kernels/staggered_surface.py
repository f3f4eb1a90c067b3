"""Cells and body of the staggered grid at the water's surface: the wet share of what the water does, and what that share's change does.

Added mass that depends on the place has the kinetic energy 1/2 m_a lambda(z) w.N w, w the velocity relative to the water, lambda the wet
share, N what cuts off the part along a cell (of a body the identity).  By Lagrange's equations it resists with

    m_a [lambda N (a - a_w) + lambda' z_t N w - 1/2 lambda' (w.N w) e_z],        z_t the rate of the height above the level,

of which the last two exchange energy with the water's surface but neither make nor lose any.  For the water's velocity and the level, w and
z_t are those of linear waves: products with their slopes are left out, and so are these slopes in the derivatives.
"""

from cable_model.kernels.choice import by_presence
from cable_model.kernels.fluid import body_drag, water_motion_of
from cable_model.kernels.jit import inlined, kernel
from cable_model.kernels.staggered_water import SHARE, deep_body, deep_cell, element_water, turned_normal
from cable_model.kernels.surface import cell_share, centre, level_over, level_over_point, share
from cable_model.kernels.vector import (
    add,
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


@inlined
def _crossing(surface, parts, medium, cable, h, split, q, i, middle, speed, low, up, v_low, v_up, time, gains):
    """A cell that may be wet in part."""
    height = middle[len(q) - 1]
    half = 0.5 * h * q[len(q) - 1]
    r = 0.5 * cable.diameter
    level, level_rate = level_over_point(parts, i, mix(0.5, v_low, 0.5, v_up), middle, time, -height - abs(half) - r)
    if height + abs(half) <= level - r:
        return deep_cell(surface, parts, medium, cable, h, split, q, i, middle, speed, low, up, v_low, v_up, time, gains)
    return _partly_wet(parts, medium, cable, h, split, q, i, middle, speed, low, up, v_low, v_up, time, gains, level, level_rate)


@kernel
def _partly_wet(parts, medium, cable, h, split, q, i, middle, speed, low, up, v_low, v_up, time, gains, level, level_rate):
    """The wet share of a cell's drag, added mass and Froude-Krylov force, in the flow at the middle of that share."""
    height = middle[len(q) - 1]
    half = 0.5 * h * q[len(q) - 1]
    cell = cell_share(height - half - level, height + half - level, 0.5 * cable.diameter, split)
    e = upward(1.0, q)
    place = axpy((cell.wet - 1.0) * abs(half), e, middle)
    rises = (v_low[len(q) - 1] - level_rate, v_up[len(q) - 1] - level_rate)
    drowns = abs(half) * (cell.w1 * rises[0] + cell.w2 * rises[1])
    motion = water_motion_of(parts, i, axpy(drowns, e, mix(0.5, v_low, 0.5, v_up)), place, time)
    low_r, up_r, low_q, up_q, low_v, up_v, inertia = element_water(
        parts.water, medium, cable, h, split, q, motion, speed, low, up, gains
    )
    added = add_matrix(inertia, diagonal(-cable.mass, q))
    lift = medium.displaced_mass * cable.gravity * h
    steep_low = axpy(h, apply(added, low), low_r)
    steep_up = axpy(h, apply(added, up), up_r)
    flow, _, _ = motion
    moved = _added_energy(cell, medium.added_mass * h, split, q, sub(v_low, flow), sub(v_up, flow), rises, gains)
    low_low = add_matrix(moved[4], outer(mix(cell.w1, steep_low, -lift * cell.e11, e), upward(gains.r, q)))
    low_up = add_matrix(moved[5], outer(mix(cell.w2, steep_low, -lift * cell.e12, e), upward(gains.r, q)))
    up_low = add_matrix(moved[6], outer(mix(cell.w1, steep_up, -lift * cell.e12, e), upward(gains.r, q)))
    up_up = add_matrix(moved[7], outer(mix(cell.w2, steep_up, -lift * cell.e22, e), upward(gains.r, q)))
    low_v = scale_matrix(cell.wet, low_v)
    up_v = scale_matrix(cell.wet, up_v)
    return (
        add(moved[0], axpy(cell.wet, low_r, upward(lift * (split - cell.e1), q))),
        add(moved[1], axpy(cell.wet, up_r, upward(lift * (1.0 - split - cell.e2), q))),
        add_matrix(moved[2], scale_matrix(cell.wet, low_q)),
        add_matrix(moved[3], scale_matrix(cell.wet, up_q)),
        add_matrix(low_low, low_v),
        add_matrix(up_up, up_v),
        add_matrix(low_up, low_v),
        add_matrix(up_low, up_v),
        add_matrix(diagonal(cable.mass, q), scale_matrix(cell.wet, added)),
    )


cell_water = by_presence(deep_cell, _crossing)
cell_water.__doc__ = """Added mass, Froude-Krylov force and drag of a cell, and what its buoyancy lacks.

Residual shares of the lower and the upper node; their derivatives by q; the lower's by the lower node, the upper's by the upper,
the lower's by the upper, the upper's by the lower; the cell's inertia matrix per unit acceleration and length.
"""


@kernel
def _added_energy(cell, mass, split, q, u_low, u_up, rises, gains):
    """What added mass that depends on the place adds to a cell; `mass` is that of a wet cell, u the nodes' velocities in the
    water, `rises` their vertical ones above the level.

    Residual shares of the lower and upper node, derivatives of both by q, and those of low by low, low by up, up by low, up by up.
    """
    stretch = norm(q)
    t = scale(1.0 / stretch, q)
    normal = add_matrix(diagonal(1.0, t), scale_matrix(-1.0, outer(t, t)))
    e = upward(1.0, q)
    low = mix(split - SHARE, u_low, SHARE, u_up)
    up = mix(1.0 - split - SHARE, u_up, SHARE, u_low)
    n_low = apply(normal, low)
    n_up = apply(normal, up)
    square = dot(u_low, n_low) + dot(u_up, n_up)
    z1, z2 = rises
    rate = cell.w1 * z1 + cell.w2 * z2
    rate1 = gains.r * (cell.w11 * z1 + cell.w12 * z2)
    rate2 = gains.r * (cell.w12 * z1 + cell.w22 * z2)
    bent = -0.5 * gains.r * square
    # by q: N x turns with the cell
    turn = mix(dot(u_low, t), n_low, dot(low, t), apply(normal, u_low))
    turn = add(turn, mix(dot(u_up, t), n_up, dot(up, t), apply(normal, u_up)))
    low_q = add_matrix(scale_matrix(-rate, turned_normal(normal, low, t)), outer(scale(0.5 * cell.w1, e), turn))
    up_q = add_matrix(scale_matrix(-rate, turned_normal(normal, up, t)), outer(scale(0.5 * cell.w2, e), turn))
    v = gains.v
    e1 = scale(v * cell.w1, e)
    e2 = scale(v * cell.w2, e)
    low_low = add_matrix(_swapped(n_low, e1, e1, n_low), outer(mix(rate1, n_low, bent * cell.w11, e), e))
    low_up = add_matrix(_swapped(n_low, e2, e1, n_up), outer(mix(rate2, n_low, bent * cell.w12, e), e))
    up_low = add_matrix(_swapped(n_up, e1, e2, n_low), outer(mix(rate1, n_up, bent * cell.w12, e), e))
    up_up = add_matrix(_swapped(n_up, e2, e2, n_up), outer(mix(rate2, n_up, bent * cell.w22, e), e))
    near = v * rate * SHARE
    return (
        scale(mass, mix(rate, n_low, -0.5 * cell.w1 * square, e)),
        scale(mass, mix(rate, n_up, -0.5 * cell.w2 * square, e)),
        scale_matrix(mass / stretch, low_q),
        scale_matrix(mass / stretch, up_q),
        scale_matrix(mass, add_matrix(low_low, scale_matrix(v * rate * (split - SHARE), normal))),
        scale_matrix(mass, add_matrix(low_up, scale_matrix(near, normal))),
        scale_matrix(mass, add_matrix(up_low, scale_matrix(near, normal))),
        scale_matrix(mass, add_matrix(up_up, scale_matrix(v * rate * (1.0 - split - SHARE), normal))),
    )


@kernel
def _swapped(a, b, c, d):
    """a b^T - c d^T."""
    return add_matrix(outer(a, b), scale_matrix(-1.0, outer(c, d)))


@kernel
def _whole_weight(surface, parts, medium, cable, h, split, q, position, time):
    return cable.weight * split * h


@kernel
def _weight_at_surface(surface, parts, medium, cable, h, split, q, position, time):
    r = 0.5 * cable.diameter
    z = position[len(q) - 1]
    level, _ = level_over(parts, position, time, -z - h * norm(q) - r)
    cell = cell_share(z - level, z + h * q[len(q) - 1] - level, r, split)
    return cable.weight * split * h + medium.displaced_mass * cable.gravity * h * (split - cell.e1)


lower_weight = by_presence(_whole_weight, _weight_at_surface)  # of the lower node's share of a cell above `position`, N


@kernel
def _bobbing_body(surface, parts, body, cable, gains, i, position, v, a, time):
    """A body of which only a share may be wet: that of the sphere of its volume."""
    r = body.radius
    height = position[len(v) - 1]
    level, level_rate = level_over_point(parts, i, v, position, time, -height - r)
    if height <= level - r:
        return deep_body(surface, parts, body, cable, gains, i, position, v, a, time)
    wet, slope, bend = share(height - level, r)
    drop, by_height = centre(height - level, r)
    e = upward(1.0, v)
    sinks = axpy(-by_height * (v[len(v) - 1] - level_rate), e, v)
    flow, flow_rate, flow_gradient = water_motion_of(parts, i, sinks, axpy(-drop, e, position), time)
    u = sub(v, flow)
    drag, by_v = body_drag(body.drag, u)
    lift = body.displaced_mass * cable.gravity
    load = sub(mix(body.added_mass, a, -(body.displaced_mass + body.added_mass), flow_rate), drag)
    rise = v[len(v) - 1] - level_rate
    exchange = mix(rise, u, -0.5 * dot(u, u), e)  # of the added mass, over its slope by the height
    residual = axpy(body.mass, a, upward(body.weight + lift * (1.0 - wet), v))
    residual = axpy(wet, load, axpy(body.added_mass * slope, exchange, residual))
    jacobian = add_matrix(diagonal((body.mass + wet * body.added_mass) * gains.a, v), scale_matrix(-wet * gains.v, by_v))
    by_flow = multiply(by_v, flow_gradient)
    by_flow = add_matrix(by_flow, outer(apply(by_flow, e), upward(-by_height, v)))
    jacobian = add_matrix(jacobian, scale_matrix(wet * gains.r, by_flow))
    turned = add_matrix(diagonal(rise, v), _swapped(u, e, e, u))
    jacobian = add_matrix(jacobian, scale_matrix(body.added_mass * slope * gains.v, turned))
    steep = axpy(slope, load, axpy(body.added_mass * bend, exchange, upward(-lift * slope, v)))
    return residual, add_matrix(jacobian, outer(steep, upward(gains.r, v)))


_body_terms = by_presence(deep_body, _bobbing_body)


@kernel
def lower_end_terms(present, parts, body, cable, gains, i, position, v, a, time):
    """Residual of the body on the lower end, and its derivative by the end's velocity; `i` is its number for wave_records.py."""
    if present is None:
        return zero(v), diagonal(0.0, v)
    return _body_terms(parts.surface, parts, body, cable, gains, i, position, v, a, time)
