"""Water around a cable: velocity and acceleration of current and waves, and the Morison drag of a cable element and of a body."""

import math

from cable_model.kernels.jit import kernel
from cable_model.kernels.vector import add, add_matrix, axpy, diagonal, dot, mix, norm, outer, scale, scale_matrix, zero
from cable_model.kernels.waves import wave_motion


@kernel
def horizontal(vx, vy, like):
    if len(like) == 2:
        return (vx, 0.0)
    return (vx, vy, 0.0)


@kernel
def horizontal_by_height(vx, vy, like):
    """Gradient matrix of a horizontal velocity that changes with height at the rates vx, vy."""
    if len(like) == 2:
        return (0.0, vx, 0.0, 0.0)
    return (0.0, 0.0, vx, 0.0, 0.0, vy, 0.0, 0.0, 0.0)


@kernel
def flows(current):
    """Whether there is a current: a table may be at rest, as those of FMUs that have the part always are by default."""
    if current is None:
        return False
    fastest = 0.0
    for i in range(current.shape[0]):
        fastest = max(fastest, abs(current[i, 1]), abs(current[i, 2]))
    return fastest > 0.0


@kernel
def current_velocity(current, position):
    """Velocity of the current and its gradient; linear between the levels of the table, held beyond its ends."""
    if current is None:
        return zero(position), diagonal(0.0, position)
    z = position[len(position) - 1]
    last = current.shape[0] - 1
    if z <= current[0, 0]:
        return horizontal(current[0, 1], current[0, 2], position), diagonal(0.0, position)
    if z >= current[last, 0]:
        return horizontal(current[last, 1], current[last, 2], position), diagonal(0.0, position)
    i = 1
    while current[i, 0] < z:
        i += 1
    dz = current[i, 0] - current[i - 1, 0]
    sx = (current[i, 1] - current[i - 1, 1]) / dz
    sy = (current[i, 2] - current[i - 1, 2]) / dz
    above = z - current[i - 1, 0]
    velocity = horizontal(current[i - 1, 1] + sx * above, current[i - 1, 2] + sy * above, position)
    return velocity, horizontal_by_height(sx, sy, position)


@kernel
def water_motion(parts, position, t):
    """Velocity, acceleration and velocity gradient of the water at a position: current plus waves."""
    u, g = current_velocity(parts.current, position)
    w, a, gw = wave_motion(parts, position, t)
    return add(u, w), a, add_matrix(g, gw)


@kernel
def element_drag(water, u, t, stretch):
    """Drag per unstretched length on a cable element of tangent t moving at u through the water, and its derivatives.

    f = -sqrt(stretch) (Kn |u_n| u_n + Kt |u_t| u_t t).  Returns f, df/du, and df/dq at fixed u, where q = stretch t.
    """
    root = math.sqrt(stretch)
    along = dot(u, t)
    across = axpy(-along, t, u)
    speed = norm(across)
    kn = water.normal_drag * root
    kt = water.tangential_drag * root
    f = mix(-kn * speed, across, -kt * abs(along) * along, t)
    tt = outer(t, t)
    normal = add_matrix(diagonal(1.0, t), scale_matrix(-1.0, tt))
    shape = scale_matrix(speed, normal)
    turned = scale(0.0, t)
    if speed > 1e-300:
        turned = scale(1.0 / speed, across)
        shape = add_matrix(shape, outer(turned, across))
    by_velocity = add_matrix(scale_matrix(-kn, shape), scale_matrix(-2.0 * kt * abs(along), tt))
    # turning the tangent by dt (normal to t): d(u_n) = -(u_n.dt) t - u_t dt
    by_turn = add_matrix(
        scale_matrix(kn * along, shape),
        add_matrix(
            scale_matrix(-kt * abs(along) * along, normal),
            scale_matrix(kn * speed - 2.0 * kt * abs(along), outer(t, across)),
        ),
    )
    by_q = add_matrix(scale_matrix(1.0 / stretch, by_turn), scale_matrix(0.5 / stretch, outer(f, t)))
    return f, by_velocity, by_q


@kernel
def body_drag(coefficient, u):
    """Drag -K |u| u on a body moving at u through the water, and its derivative: a vector law, the same in every direction."""
    speed = norm(u)
    by_velocity = diagonal(-coefficient * speed, u)
    if speed > 1e-300:
        by_velocity = add_matrix(by_velocity, scale_matrix(-coefficient / speed, outer(u, u)))
    return scale(-coefficient * speed, u), by_velocity
