"""Linear waves: dispersion, and velocity, acceleration and gradient of the water under a sum of components.

A component's elevation is a cos(k s - omega t + phase), s along its direction.  The table of components has the columns amplitude,
angular frequency, wave number, direction, phase, depth (0: deep water).  Above z = 0 the values of z = 0 hold, unless the part
`stretched` (Wheeler: heights are measured from the surface as it is, and scaled to the depth) or `cut` (as held, but nothing above
the surface as it is) is present.  With the part `wave_ramp` the waves grow from the start of the run.
"""

import math
from typing import NamedTuple

from cable_model.kernels.choice import by_presence
from cable_model.kernels.jit import kernel
from cable_model.kernels.vector import add, add_matrix, axpy, diagonal, dot, mix, outer, scale, scale_matrix, upward, zero

AMPLITUDE, FREQUENCY, NUMBER, DIRECTION, PHASE, DEPTH = range(6)
TAPER = 0.05  # of the sum of the amplitudes: height above the surface within which cut waves fade out
DEEP = 40.0  # k depth and k |z| beyond which exponentials are negligible


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
def wave_axes(direction, like):
    """Unit vector of propagation as a D-vector; in the plane its sign only."""
    if len(like) == 2:
        return (math.copysign(1.0, math.cos(direction)), 0.0)
    return (math.cos(direction), math.sin(direction), 0.0)


@kernel
def elevation(waves, ramp, position, t):
    """Height of the surface over a place, m, its rate, m/s, and its gradient; `ramp` is the part wave_ramp."""
    height = 0.0
    rate = 0.0
    gradient = zero(position)
    for j in range(waves.shape[0]):
        along = wave_axes(waves[j, DIRECTION], position)
        k = waves[j, NUMBER]
        angle = k * dot(along, position) - waves[j, FREQUENCY] * t + waves[j, PHASE]
        height += waves[j, AMPLITUDE] * math.cos(angle)
        s = waves[j, AMPLITUDE] * math.sin(angle)
        rate += waves[j, FREQUENCY] * s
        gradient = axpy(-k * s, along, gradient)
    return _raised(ramp, height, rate, gradient, t)


@kernel
def _profile(finite_depth, k, depth, z):
    """cosh k(z+h)/sinh kh and sinh k(z+h)/sinh kh: in deep water both are exp(kz)."""
    e = math.exp(k * z)
    if finite_depth is None:
        return e, e
    if depth <= 0.0 or k * depth > DEEP:
        return e, e
    mirrored = math.exp(-k * (z + 2.0 * depth))
    bottom = 1.0 / (1.0 - math.exp(-2.0 * k * depth))
    return (e + mirrored) * bottom, (e - mirrored) * bottom


@kernel
def _effective_height(stretched, waves, ramp, position, t):
    """The height at which the profiles are read, and its gradient and rate; no higher than still water."""
    z = position[len(position) - 1]
    if stretched is None:
        if z >= 0.0:
            return 0.0, zero(position), 0.0
        return z, upward(1.0, position), 0.0
    surface, rate, slope = elevation(waves, ramp, position, t)
    depth = waves[0, DEPTH]
    if z >= surface:
        return 0.0, zero(position), 0.0
    if depth <= 0.0:
        return z - surface, axpy(-1.0, slope, upward(1.0, position)), -rate
    # z' = h (z - eta)/(h + eta)
    share = depth / (depth + surface)
    by_surface = -share * (depth + z) / (depth + surface)
    return share * (z - surface), axpy(by_surface, slope, upward(share, position)), by_surface * rate


@kernel
def _faded(cut, waves, ramp, position, t):
    """Share of the waves' motion at a place, and its gradient: 1 below the surface, 0 above it, a smooth step between."""
    if cut is None:
        return 1.0, zero(position)
    surface, _, slope = elevation(waves, ramp, position, t)
    height = 0.0
    for j in range(waves.shape[0]):
        height += waves[j, AMPLITUDE]
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
    return _sum(parts.waves, parts, position, t)


@kernel
def _sum(waves, parts, position, t):
    velocity = zero(position)
    acceleration = zero(position)
    gradient = diagonal(0.0, position)
    if waves is None:
        return velocity, acceleration, gradient
    z, by_place, z_rate = _effective_height(parts.stretched, waves, parts.wave_ramp, position, t)
    up = upward(1.0, position)
    for j in range(waves.shape[0]):
        k = waves[j, NUMBER]
        if k * z < -DEEP:
            continue
        omega = waves[j, FREQUENCY]
        along = wave_axes(waves[j, DIRECTION], position)
        angle = k * dot(along, position) - omega * t + waves[j, PHASE]
        across, rise = _profile(parts.finite_depth, k, waves[j, DEPTH], z)
        size = waves[j, AMPLITUDE] * omega
        c = size * math.cos(angle)
        s = size * math.sin(angle)
        velocity = add(velocity, mix(across * c, along, rise * s, up))
        by_height = mix(k * rise * c, along, k * across * s, up)
        acceleration = add(acceleration, mix(omega * across * s, along, -omega * rise * c, up))
        acceleration = axpy(z_rate, by_height, acceleration)
        by_along = mix(-k * across * s, along, k * rise * c, up)
        gradient = add_matrix(gradient, add_matrix(outer(by_along, along), outer(by_height, by_place)))
    share, fading = _faded(parts.cut, waves, parts.wave_ramp, position, t)
    gradient = add_matrix(scale_matrix(share, gradient), outer(velocity, fading))
    velocity, acceleration = scale(share, velocity), scale(share, acceleration)
    return grown(parts.wave_ramp, velocity, acceleration, gradient, t)
