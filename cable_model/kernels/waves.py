"""Linear waves: velocity, acceleration and gradient of the water, and the surface, under a sum of components.

Above z = 0 the values of z = 0 hold, unless the part `stretched` (Wheeler: heights are measured from the surface as it is, and scaled to
the depth) or `cut` (as held, but nothing above the surface as it is) is present.  With the part `wave_ramp` the waves grow from the start.
"""

from typing import NamedTuple

from cable_model.kernels.choice import by_presence
from cable_model.kernels.jit import kernel
from cable_model.kernels.surface_records import surface_at
from cable_model.kernels.vector import add_matrix, axpy, diagonal, dot, mix, outer, scale, scale_matrix, upward, zero
from cable_model.kernels.wave_records import NOBODY, water_at
from cable_model.kernels.wave_sums import DEPTH, HIGHEST, heights

TAPER = 0.05  # of the sum of the amplitudes: height above the surface within which cut waves fade out


class Ramp(NamedTuple):
    """Growth from nothing: by a quintic, so that velocities and accelerations are smooth."""

    start: float  # s
    time: float  # s; 0: all is there from the start


@kernel
def ramp_at(ramp, t):
    """The share that is there at a time, and its rate, 1/s."""
    since = t - ramp.start
    if since >= ramp.time:
        return 1.0, 0.0
    s = max(since, 0.0) / ramp.time
    return s * s * s * (10.0 - s * (15.0 - 6.0 * s)), 30.0 * s * s * (1.0 - s) * (1.0 - s) / ramp.time


@kernel
def _whole(ramp, velocity, acceleration, gradient, t):
    return velocity, acceleration, gradient


@kernel
def _growing(ramp, velocity, acceleration, gradient, t):
    share, growth = ramp_at(ramp, t)
    return scale(share, velocity), mix(share, acceleration, growth, velocity), scale_matrix(share, gradient)


grown = by_presence(_whole, _growing)  # the part of a motion that is there at a time


@kernel
def _rising(ramp, height, rate, gradient, t):
    share, growth = ramp_at(ramp, t)
    return share * height, share * rate + growth * height, scale(share, gradient)


_raised = by_presence(_whole, _rising)


@kernel
def elevation(waves, ramp, position, t):
    """Height of the surface over a place, m, its rate, m/s, and its gradient; `ramp` is the part wave_ramp."""
    height, rate, gradient = heights(waves, position, t)
    return _raised(ramp, height, rate, gradient, t)


@kernel
def elevation_over(parts, waves, i, speed, position, t):
    """As `elevation`, for the point i of wave_records.py."""
    height, rate, gradient = surface_at(parts.followed, waves, i, speed, position, t)
    return _raised(parts.wave_ramp, height, rate, gradient, t)


@kernel
def _effective_height(stretched, waves, parts, i, speed, position, t):
    """The height at which the profiles are read, and its gradient and rate; no higher than still water."""
    z = position[len(position) - 1]
    if stretched is None:
        if z >= 0.0:
            return 0.0, zero(position), 0.0
        return z, upward(1.0, position), 0.0
    surface, rate, slope = elevation_over(parts, waves, i, speed, position, t)
    depth = waves[DEPTH, 0]
    if z >= surface:
        return 0.0, zero(position), 0.0
    if depth <= 0.0:
        return z - surface, axpy(-1.0, slope, upward(1.0, position)), -rate
    # z' = h (z - eta)/(h + eta)
    share = depth / (depth + surface)
    by_surface = -share * (depth + z) / (depth + surface)
    return share * (z - surface), axpy(by_surface, slope, upward(share, position)), by_surface * rate


@kernel
def _faded(cut, waves, parts, i, speed, position, t):
    """Share of the waves' motion at a place, and its gradient: 1 below the surface, 0 above it, a smooth step between."""
    if cut is None:
        return 1.0, zero(position)
    height = waves[HIGHEST, 0]
    if position[len(position) - 1] <= -height:
        return 1.0, zero(position)
    surface, _, slope = elevation_over(parts, waves, i, speed, position, t)
    s = (position[len(position) - 1] - surface) / (TAPER * height)
    if s <= 0.0:
        return 1.0, zero(position)
    if s >= 1.0:
        return 0.0, zero(position)
    by_height = -6.0 * s * (1.0 - s) / (TAPER * height)
    return 1.0 - s * s * (3.0 - 2.0 * s), scale(by_height, axpy(-1.0, slope, upward(1.0, position)))


@kernel
def wave_motion(parts, position, t):
    """Velocity, acceleration and velocity gradient (rows: components; columns: places) of the waves."""
    return _motion(parts.waves, parts, NOBODY, zero(position), position, t)


@kernel
def wave_motion_of(parts, i, speed, position, t):
    """The same for a point that records follow, see wave_records.py, and that moves at a velocity."""
    return _motion(parts.waves, parts, i, speed, position, t)


@kernel
def _calm(waves, parts, i, speed, position, t):
    return zero(position), zero(position), diagonal(0.0, position)


@kernel
def _rough(waves, parts, i, speed, position, t):
    z, by_place, z_rate = _effective_height(parts.stretched, waves, parts, i, speed, position, t)
    height = position[len(position) - 1]
    at = axpy(z - height, upward(1.0, position), position)
    moves = axpy(dot(by_place, speed) + z_rate - speed[len(speed) - 1], upward(1.0, position), speed)
    velocity, acceleration, up, gradient = water_at(parts.followed, parts.finite_depth, waves, i, moves, at, t)
    acceleration = axpy(z_rate, up, acceleration)
    gradient = add_matrix(gradient, outer(up, by_place))
    share, fading = _faded(parts.cut, waves, parts, i, speed, position, t)
    gradient = add_matrix(scale_matrix(share, gradient), outer(velocity, fading))
    velocity, acceleration = scale(share, velocity), scale(share, acceleration)
    return grown(parts.wave_ramp, velocity, acceleration, gradient, t)


_motion = by_presence(_calm, _rough)
