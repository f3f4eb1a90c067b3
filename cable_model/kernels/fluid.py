"""Water around a cable: velocity and acceleration of current and waves, and the Morison drag of a cable element and of a body.

The current is that of levels, or of a table over time and height; it may grow from the start, and inputs may add to it.  Parts that need
to know more than the numbers of a scene are told so by `in_water_now`: when the run began, and what inputs say.
"""

import math
from typing import NamedTuple

from cable_model.kernels.choice import by_presence, given
from cable_model.kernels.header import START, STREAM, TIME
from cable_model.kernels.jit import kernel
from cable_model.kernels.vector import add, add_matrix, axpy, diagonal, dot, mix, norm, outer, scale, scale_matrix, zero
from cable_model.kernels.wave_records import without_records
from cable_model.kernels.wave_sums import count_until
from cable_model.kernels.waves import Ramp, grown, wave_motion, wave_motion_of


class Stream(NamedTuple):
    """A current that is the same everywhere and changes linearly."""

    x: float  # m/s, at the time `at`
    y: float
    rate_x: float  # m/s2
    rate_y: float
    at: float  # s


with_stream = given("stream")
_with_flow = given("stream", "current_ramp", "wave_ramp")


@kernel
def in_water_now(parts, p, state):
    """The parts with the start of the run, and the current that inputs give now; no records of waves, see layout.with_waves_followed."""
    stream = Stream(state[STREAM], state[STREAM + 1], state[STREAM + 2], state[STREAM + 3], state[TIME])
    known = _with_flow(parts, stream, Ramp(state[START], p[0].current.ramp_time), Ramp(state[START], p[0].waves.ramp_time))
    return without_records(known, state)


@kernel
def is_steady(parts):
    """Whether the water never accelerates."""
    return parts.waves is None and parts.current_table is None and parts.current_ramp is None and parts.stream is None


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
def _is_fast(table, first):
    """Whether any of the velocities in columns from `first` on is not 0."""
    if table is None:
        return False
    fastest = 0.0
    for i in range(table.shape[0]):
        fastest = max(fastest, abs(table[i, first]), abs(table[i, first + 1]))
    return fastest > 0.0


@kernel
def _streams(stream):
    if stream is None:
        return False
    return stream.x != 0.0 or stream.y != 0.0


@kernel
def flows(parts):
    """Whether there is a current: a table may be at rest, as those of FMUs that have the part always are by default."""
    return _streams(parts.stream) or _is_fast(parts.current, 1) or _is_fast(parts.current_table, 2)


@kernel
def _between_levels(table, column, first, beyond, position):
    """Velocity of the current and its gradient from rows of z, vx, vy in columns from `column` on: linear, held beyond the ends."""
    z = position[len(position) - 1]
    last = beyond - 1
    if z <= table[first, column]:
        return horizontal(table[first, column + 1], table[first, column + 2], position), diagonal(0.0, position)
    if z >= table[last, column]:
        return horizontal(table[last, column + 1], table[last, column + 2], position), diagonal(0.0, position)
    i = first + 1
    while table[i, column] < z:
        i += 1
    dz = table[i, column] - table[i - 1, column]
    sx = (table[i, column + 1] - table[i - 1, column + 1]) / dz
    sy = (table[i, column + 2] - table[i - 1, column + 2]) / dz
    above = z - table[i - 1, column]
    velocity = horizontal(table[i - 1, column + 1] + sx * above, table[i - 1, column + 2] + sy * above, position)
    return velocity, horizontal_by_height(sx, sy, position)


@kernel
def _by_height(current, position):
    """Velocity of a steady current and its gradient."""
    if current is None:
        return zero(position), diagonal(0.0, position)
    return _between_levels(current, 0, 0, current.shape[0], position)


@kernel
def _by_time(table, current, position, t):
    """From rows of time, z, vx, vy, as many at each time: linear, held before and after."""
    count = count_until(table[:, 0], table[0, 0])
    until = max(count_until(table[:, 0], t), count)
    v, g = _between_levels(table, 1, until - count, until, position)
    if t <= table[0, 0] or until == table.shape[0]:
        return v, zero(position), g
    w, k = _between_levels(table, 1, until, until + count, position)
    span = table[until, 0] - table[until - 1, 0]
    share = (t - table[until - 1, 0]) / span
    rate = mix(1.0 / span, w, -1.0 / span, v)
    return mix(1.0 - share, v, share, w), rate, add_matrix(scale_matrix(1.0 - share, g), scale_matrix(share, k))


@kernel
def _steady(table, current, position, t):
    velocity, gradient = _by_height(current, position)
    return velocity, zero(position), gradient


_by_table = by_presence(_steady, _by_time)  # velocity, acceleration and gradient of the current at a position


@kernel
def _alone(stream, velocity, rate, position, t):
    return velocity, rate


@kernel
def _added(stream, velocity, rate, position, t):
    since = t - stream.at
    velocity = add(velocity, horizontal(stream.x + since * stream.rate_x, stream.y + since * stream.rate_y, position))
    return velocity, add(rate, horizontal(stream.rate_x, stream.rate_y, position))


_in_stream = by_presence(_alone, _added)


@kernel
def current_motion(parts, position, t):
    """Velocity, acceleration and velocity gradient of the current at a position."""
    velocity, rate, gradient = _by_table(parts.current_table, parts.current, position, t)
    velocity, rate, gradient = grown(parts.current_ramp, velocity, rate, gradient, t)
    velocity, rate = _in_stream(parts.stream, velocity, rate, position, t)
    return velocity, rate, gradient


@kernel
def water_motion(parts, position, t):
    """Velocity, acceleration and velocity gradient of the water at a position: current plus waves."""
    w, a, gw = wave_motion(parts, position, t)
    return _with_current(parts, w, a, gw, position, t)


@kernel
def water_motion_of(parts, i, speed, position, t):
    """The same for a point that records of waves follow, see wave_records.py, and that moves at a velocity."""
    w, a, gw = wave_motion_of(parts, i, speed, position, t)
    return _with_current(parts, w, a, gw, position, t)


@kernel
def _with_current(parts, w, a, gw, position, t):
    u, b, g = current_motion(parts, position, t)
    if parts.current_table is None and parts.current_ramp is None and parts.stream is None:
        return add(u, w), a, add_matrix(g, gw)
    return add(u, w), add(b, a), add_matrix(g, gw)


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
