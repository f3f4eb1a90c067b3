"""Water on the cells and on the body of the staggered grid, wet all through or crossing the surface: loads and their derivatives.

Added mass that depends on the place has the kinetic energy 1/2 m_a lambda(z) w.N w, w the velocity relative to the water, lambda the wet
share, N what cuts off the part along a cell (of a body the identity).  By Lagrange's equations it resists with

    m_a [lambda N (a - a_w) + lambda' z_t N w - 1/2 lambda' (w.N w) e_z],        z_t the rate of the height above the level,

of which the last two exchange energy with the water's surface but neither make nor lose any.  For the water's velocity and the level, w and
z_t are those of linear waves: products with their slopes are left out, and so are these slopes in the derivatives.
"""

from cable_model.kernels.choice import by_presence
from cable_model.kernels.fluid import body_drag, element_drag, water_motion
from cable_model.kernels.jit import kernel
from cable_model.kernels.surface import cell_share, centre, level_over, share
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

SHARE = 1.0 / 12.0  # of a cell's inertia that couples its two nodes


@kernel
def _element_water(water, parts, medium, cable, h, split, q, position, speed, low, up, time, gains):
    """Added mass, Froude-Krylov force and drag of a cell.

    Returns residual shares of the lower and the upper node, their derivatives by q, by the cell's velocity and by its
    position, and the cell's inertia matrix per unit acceleration and length.
    """
    inertia = diagonal(cable.mass, q)
    none = diagonal(0.0, q)
    if water is None:
        return zero(q), zero(q), none, none, none, none, inertia
    stretch = norm(q)
    t = scale(1.0 / stretch, q)
    flow, flow_rate, flow_gradient = water_motion(parts, position, time)
    normal = add_matrix(diagonal(1.0, t), scale_matrix(-1.0, outer(t, t)))
    inertia = add_matrix(inertia, scale_matrix(medium.added_mass, normal))
    # added mass times (a - a_w) per length on the shares: only its normal part counts, so it turns with the cable
    low_load = scale(medium.added_mass, axpy(-split, flow_rate, low))
    up_load = scale(medium.added_mass, axpy(split - 1.0, flow_rate, up))
    low_q = scale_matrix(-h / stretch, _turned(normal, low_load, t))
    up_q = scale_matrix(-h / stretch, _turned(normal, up_load, t))
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


@kernel
def _turned(normal, x, t):
    """-l d(N x)/dq at fixed x: N (t.x) + t (N x)."""
    return add_matrix(scale_matrix(dot(t, x), normal), outer(t, apply(normal, x)))


@kernel
def _deep(surface, parts, medium, cable, h, split, q, middle, speed, low, up, v_low, v_up, time, gains):
    """A cell that is wet all through, or in air."""
    low_r, up_r, low_q, up_q, low_v, up_v, inertia = _element_water(
        parts.water, parts, medium, cable, h, split, q, middle, speed, low, up, time, gains
    )
    return low_r, up_r, low_q, up_q, low_v, up_v, low_v, up_v, inertia


@kernel
def _crossing(surface, parts, medium, cable, h, split, q, middle, speed, low, up, v_low, v_up, time, gains):
    """A cell of which only a share may be wet: that share of drag, added mass and Froude-Krylov force, in the flow at its middle."""
    height = middle[len(q) - 1]
    half = 0.5 * h * q[len(q) - 1]
    r = 0.5 * cable.diameter
    level, level_rate = level_over(parts, middle, time, -height - abs(half) - r)
    if height + abs(half) <= level - r:
        return _deep(surface, parts, medium, cable, h, split, q, middle, speed, low, up, v_low, v_up, time, gains)
    cell = cell_share(height - half - level, height + half - level, r, split)
    e = upward(1.0, q)
    place = axpy((cell.wet - 1.0) * abs(half), e, middle)
    low_r, up_r, low_q, up_q, low_v, up_v, inertia = _element_water(
        parts.water, parts, medium, cable, h, split, q, place, speed, low, up, time, gains
    )
    added = add_matrix(inertia, diagonal(-cable.mass, q))
    lift = medium.displaced_mass * cable.gravity * h
    steep_low = axpy(h, apply(added, low), low_r)
    steep_up = axpy(h, apply(added, up), up_r)
    flow, _, _ = water_motion(parts, place, time)
    rises = (v_low[len(q) - 1] - level_rate, v_up[len(q) - 1] - level_rate)
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


cell_water = by_presence(_deep, _crossing)
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
    low_q = add_matrix(scale_matrix(-rate, _turned(normal, low, t)), outer(scale(0.5 * cell.w1, e), turn))
    up_q = add_matrix(scale_matrix(-rate, _turned(normal, up, t)), outer(scale(0.5 * cell.w2, e), turn))
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
def _deep_body(surface, parts, body, cable, gains, position, v, a, time):
    mass = body.mass + body.added_mass
    residual = axpy(mass, a, upward(body.weight, v))
    jacobian = diagonal(mass * gains.a, v)
    if parts.water is None:
        return residual, jacobian
    flow, flow_rate, flow_gradient = water_motion(parts, position, time)
    drag, by_v = body_drag(body.drag, sub(v, flow))
    residual = sub(axpy(-(body.displaced_mass + body.added_mass), flow_rate, residual), drag)
    jacobian = add_matrix(jacobian, scale_matrix(-gains.v, by_v))
    return residual, add_matrix(jacobian, scale_matrix(gains.r, multiply(by_v, flow_gradient)))


@kernel
def _bobbing_body(surface, parts, body, cable, gains, position, v, a, time):
    """A body of which only a share may be wet: that of the sphere of its volume."""
    r = body.radius
    height = position[len(v) - 1]
    level, level_rate = level_over(parts, position, time, -height - r)
    if height <= level - r:
        return _deep_body(surface, parts, body, cable, gains, position, v, a, time)
    wet, slope, bend = share(height - level, r)
    drop, by_height = centre(height - level, r)
    e = upward(1.0, v)
    flow, flow_rate, flow_gradient = water_motion(parts, axpy(-drop, e, position), time)
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


_body_terms = by_presence(_deep_body, _bobbing_body)


@kernel
def lower_end_terms(present, parts, body, cable, gains, position, v, a, time):
    """Residual of the body on the lower end, and its derivative by the end's velocity."""
    if present is None:
        return zero(v), diagonal(0.0, v)
    return _body_terms(parts.surface, parts, body, cable, gains, position, v, a, time)
