"""The seabed under a cable: a flat elastic bottom that pushes upwards only, with damping, and Coulomb friction along it.

Per node with the length l of cable that it carries, at height z above the bottom, with vertical velocity w and velocity u along it:

    f = -K d l (z + lag w),   N = (f + sqrt(f^2 + w0^2))/2,   friction = -mu N u / sqrt(|u|^2 + u0^2)

K the stiffness in Pa/m, lag = 2 zeta sqrt(m/(K d)) but at least one time step (in statics none).  f is taken at the new time,
not at the averaged one: a node that lands is then at rest after a step, while the average of its velocities would let it ring
with lambda_infinity.
N is an unknown in the barrier form of slack.py; as it belongs to one node it is condensed there.
"""

from typing import NamedTuple

from cable_model.kernels.choice import by_presence
from cable_model.kernels.jit import kernel
from cable_model.kernels.slack import constitutive, iterate, step_tension
from cable_model.kernels.vector import add_matrix, axpy, diagonal, dot, load, outer, scale, scale_matrix, sub, upward, zero

FORCE = 0  # columns of the contact table: N
CHANGE = 1  # its Newton change at fixed velocities
SLOPE = 2  # its derivative by the vertical velocity
HEIGHT = 3  # height and vertical velocity of the node at the old time
SPEED = 4
COLUMNS = 5


class Ground(NamedTuple):
    """Constants of the seabed."""

    level: float  # m
    stiffness: float  # K d, N/m2
    lag: float  # damping over stiffness, s
    least_lag: float  # in time steps
    friction: float
    friction_velocity: float  # u0, m/s
    body_length: float  # of cable that would weigh as much as the body, m: the body sinks in as deep as the cable
    smoothing: float  # w0 of a unit length, N/m


@kernel
def _carried(ground, mesh, i):
    """Unstretched length of cable that node i carries; at the lower end the body's share too."""
    if i == 0:
        return mesh[0, 1] * mesh[0, 0] + ground.body_length
    return mesh[i, 1] * mesh[i, 0] + (1.0 - mesh[i - 1, 1]) * mesh[i - 1, 0]


@kernel
def under_body(present, ground, mesh):
    """Share of the seabed's force on node 0 that the body there takes: the rest lifts the cable's part of the node."""
    if present is None:
        return 0.0
    return ground.body_length / (ground.body_length + mesh[0, 1] * mesh[0, 0])


@kernel
def _no_start(present, ground, mesh, y0, top_row, h, like, contact):
    return


@kernel
def _start(present, ground, mesh, y0, top_row, h, like, contact):
    n = mesh.shape[0] + 1
    position = load(y0, top_row, like)
    for i in range(n - 2, -1, -1):
        position = axpy(-mesh[i, 0], load(y0, i, like), position)
        height = position[len(like) - 1] - ground.level
        speed = y0[n + i, len(like) - 1]
        length = _carried(ground, mesh, i)
        w0 = ground.smoothing * length
        f = -ground.stiffness * length * (height + max(ground.lag, ground.least_lag * h) * speed)
        root = (f * f + w0 * w0) ** 0.5
        contact[i, FORCE] = 0.5 * (f + root) if f > 0.0 else 0.5 * w0 * w0 / (root - f)
        contact[i, HEIGHT] = height
        contact[i, SPEED] = speed


start_contacts = by_presence(_no_start, _start)  # heights, velocities and forces of all nodes at the start of a step of length h


@kernel
def _no_load(present, friction, ground, gains, mesh, i, position, v, contact):
    return zero(v), diagonal(0.0, v)


@kernel
def _rub(friction, ground, gains, force, along):
    """Friction per N against the velocity `along` the bottom, and the derivative of N times it by the velocity."""
    if friction is None:
        return zero(along), diagonal(0.0, along)
    speed = (dot(along, along) + ground.friction_velocity**2) ** 0.5
    share = scale(ground.friction / speed, along)
    level = add_matrix(diagonal(1.0, along), scale_matrix(-1.0, outer(upward(1.0, along), upward(1.0, along))))
    steep = add_matrix(scale_matrix(ground.friction, level), scale_matrix(-1.0 / ground.friction, outer(share, share)))
    return share, scale_matrix(force * gains.v / speed, steep)


@kernel
def _load(present, friction, ground, gains, mesh, i, position, v, contact):
    up = upward(1.0, v)
    length = _carried(ground, mesh, i)
    stiffness = ground.stiffness * length
    w0 = ground.smoothing * length
    lag = max(ground.lag, ground.least_lag * gains.step)
    now = 1.0 / gains.v if gains.v > 0.0 else 0.0  # from the average to the new time
    height = contact[i, HEIGHT] + now * (dot(position, up) - ground.level - contact[i, HEIGHT])
    speed = contact[i, SPEED] + now * (dot(v, up) - contact[i, SPEED])
    f = -stiffness * (height + lag * speed)
    force = iterate(present, w0, f, contact[i, FORCE])
    slope, misfit = constitutive(present, w0, f, force)
    change = gains.law * slope * misfit
    by_speed = -gains.law * slope * stiffness * now * (gains.r + lag * gains.v)
    contact[i, FORCE] = force
    contact[i, CHANGE] = change
    contact[i, SLOPE] = by_speed
    share, by_velocity = _rub(friction, ground, gains, force, axpy(-dot(v, up), up, v))
    along = sub(share, up)  # of the seabed's force, per N and negative
    residual = scale(force + change, along)
    jacobian = outer(scale(by_speed, along), up)
    return residual, add_matrix(jacobian, by_velocity)


node_load = by_presence(_no_load, _load)  # what the seabed adds to the residual of a node, and its derivative by the velocity


@kernel
def update_contacts(present, ground, mesh, x, contact):
    """Newton's change of the contact forces from that of the velocities; whether one was cut by more than a trifle."""
    if present is None:
        return False
    cut = False
    last = x.shape[1] - 1
    for i in range(mesh.shape[0]):
        change = contact[i, CHANGE] + contact[i, SLOPE] * x[i, last]
        contact[i, FORCE], limited = step_tension(present, ground.smoothing * _carried(ground, mesh, i), contact[i, FORCE], change)
        cut = cut or limited
    return cut
