"""Linear waves: velocity, acceleration and gradient of the water, and the surface, under a sum of components.

A component's elevation is cos(k s - omega t + phase) times its amplitude, s along its direction.  A table has a row a quantity and a column
a component, by rising wave number: so sums run over a row, several components at a time, and end where the waves reach no deeper.
Above z = 0 the values of z = 0 hold, unless the part `stretched` (Wheeler: heights are measured from the surface as it is, and scaled to
the depth) or `cut` (as held, but nothing above the surface as it is) is present.  With the part `wave_ramp` the waves grow from the start.
"""

from typing import NamedTuple

from cable_model.kernels.choice import by_presence
from cable_model.kernels.jit import kernel, summand, summing
from cable_model.kernels.vector import add, add_matrix, axpy, diagonal, mix, outer, scale, scale_matrix, upward, zero

# rows of a table: m, rad/s, 1/m, the direction's cosine and sine, and the sign of its cosine, which is the direction in the plane; rad, m,
# and amplitude times frequency, over 1 - exp(-2 k depth), m/s
AMPLITUDE, FREQUENCY, NUMBER, COSINE, SINE, SIGN, PHASE, DEPTH, SPEED = range(9)
TAPER = 0.05  # of the sum of the amplitudes: height above the surface within which cut waves fade out
FELT = 20.0  # k |z| beyond which a component is not felt: 2e-9 of what it is at the surface
# 2 pi in parts, of which the first times a whole number below 2^20 is exact
TURN, REST_OF_TURN, TURNS = 6.2831853069365025, 2.430840202602477e-10, 0.15915494309189535
TO_WHOLE = 6755399441055744.0  # 1.5 * 2^52: what is added to it is rounded to a whole number


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


@summand
def _circle(angle):
    """Cosine and sine without a branch or a call, to 1e-15: series of a quarter of the angle less its turns, doubled twice."""
    turns = (angle * TURNS + TO_WHOLE) - TO_WHOLE
    q = 0.25 * ((angle - turns * TURN) - turns * REST_OF_TURN)
    y = q * q
    s = 1.0 - y * (1.0 / 210.0)
    s = 1.0 - y * (1.0 / 156.0) * s
    s = 1.0 - y * (1.0 / 110.0) * s
    s = 1.0 - y * (1.0 / 72.0) * s
    s = 1.0 - y * (1.0 / 42.0) * s
    s = 1.0 - y * (1.0 / 20.0) * s
    s = q * (1.0 - y * (1.0 / 6.0) * s)
    c = 1.0 - y * (1.0 / 240.0)
    c = 1.0 - y * (1.0 / 182.0) * c
    c = 1.0 - y * (1.0 / 132.0) * c
    c = 1.0 - y * (1.0 / 90.0) * c
    c = 1.0 - y * (1.0 / 56.0) * c
    c = 1.0 - y * (1.0 / 30.0) * c
    c = 1.0 - y * (1.0 / 12.0) * c
    c = 1.0 - y * (1.0 / 2.0) * c
    s, c = 2.0 * s * c, (c - s) * (c + s)
    return (c - s) * (c + s), 2.0 * s * c


@summand
def _power(x):
    """exp(x) for x from -FELT to 0, likewise, to 1e-14: the series of a 64th, squared six times."""
    w = x * 0.015625
    e = 1.0 + w * (1.0 / 12.0)
    e = 1.0 + w * (1.0 / 11.0) * e
    e = 1.0 + w * (1.0 / 10.0) * e
    e = 1.0 + w * (1.0 / 9.0) * e
    e = 1.0 + w * (1.0 / 8.0) * e
    e = 1.0 + w * (1.0 / 7.0) * e
    e = 1.0 + w * (1.0 / 6.0) * e
    e = 1.0 + w * (1.0 / 5.0) * e
    e = 1.0 + w * (1.0 / 4.0) * e
    e = 1.0 + w * (1.0 / 3.0) * e
    e = 1.0 + w * (1.0 / 2.0) * e
    e = 1.0 + w * e
    e = e * e
    e = e * e
    e = e * e
    e = e * e
    e = e * e
    return e * e


@summand
def _angle(number, to_x, to_y, x, y, frequency, t, phase):
    return number * (to_x * x + to_y * y) - frequency * t + phase


@summand
def _product(a, b):
    """As it is written, in a function whose sums are not."""
    return a * b


@kernel
def count_until(rising, most):
    """How many of rising numbers are not above the most."""
    low, high = 0, rising.shape[0]
    if high == 0 or rising[high - 1] <= most:
        return high
    while low < high:
        middle = (low + high) // 2
        if rising[middle] <= most:
            low = middle + 1
        else:
            high = middle
    return low


@summand
def _height(size, frequency, number, angle):
    """Elevation of a component, its rate, and its slope along its direction."""
    c, s = _circle(angle)
    return size * c, frequency * (size * s), -number * (size * s)


@summing
def _heights_in_plane(waves, x, y, t):
    """Sums of elevations, of their rates and of their slopes."""
    number, along, frequency, phase, size = waves[NUMBER], waves[SIGN], waves[FREQUENCY], waves[PHASE], waves[AMPLITUDE]
    height = rate = slope = 0.0
    for j in range(waves.shape[1]):
        h, r, g = _height(size[j], frequency[j], number[j], _angle(number[j], along[j], 0.0, x, 0.0, frequency[j], t, phase[j]))
        height += h
        rate += r
        slope += _product(g, along[j])
    return height, rate, (slope, 0.0)


@summing
def _heights_in_space(waves, x, y, t):
    number, frequency, phase, size = waves[NUMBER], waves[FREQUENCY], waves[PHASE], waves[AMPLITUDE]
    to_x, to_y = waves[COSINE], waves[SINE]
    height = rate = slope_x = slope_y = 0.0
    for j in range(waves.shape[1]):
        h, r, g = _height(size[j], frequency[j], number[j], _angle(number[j], to_x[j], to_y[j], x, y, frequency[j], t, phase[j]))
        height += h
        rate += r
        slope_x += _product(g, to_x[j])
        slope_y += _product(g, to_y[j])
    return height, rate, (slope_x, slope_y, 0.0)


@kernel
def elevation(waves, ramp, position, t):
    """Height of the surface over a place, m, its rate, m/s, and its gradient; `ramp` is the part wave_ramp."""
    if len(position) == 2:
        height, rate, gradient = _heights_in_plane(waves, position[0], 0.0, t)
    else:
        height, rate, gradient = _heights_in_space(waves, position[0], position[1], t)
    return _raised(ramp, height, rate, gradient, t)


@summand
def _component(sign, speed, frequency, number, z, angle):
    """Of a component at a height: velocity along its direction and upwards, their rates, and their changes with height."""
    across = _power(number * z)
    rise = sign * across
    c, s = _circle(angle)
    c *= speed
    s *= speed
    u, w = across * c, rise * s
    return u, w, frequency * (across * s), -frequency * (rise * c), number * (rise * c), number * (across * s)


@summing
def _sums_in_plane(sign, waves, count, x, y, z, t):
    """Sums over the components that are felt: velocity, acceleration, change of the velocity with height, and with the place (matrix).

    `sign` -1 is for what a bottom mirrors, at its mirrored height.  Only the sums are in any order, not what makes a component.
    """
    number, along, frequency, phase = waves[NUMBER], waves[SIGN], waves[FREQUENCY], waves[PHASE]
    speed = waves[SPEED]
    u = w = u_rate = w_rate = u_up = w_up = 0.0
    for j in range(count):
        angle = _angle(number[j], along[j], 0.0, x, 0.0, frequency[j], t, phase[j])
        across, rise, across_rate, rise_rate, across_up, rise_up = _component(sign, speed[j], frequency[j], number[j], z, angle)
        u += _product(across, along[j])
        w += rise
        u_rate += _product(across_rate, along[j])
        w_rate += rise_rate
        u_up += _product(across_up, along[j])
        w_up += rise_up
    return (u, w), (u_rate, w_rate), (u_up, w_up), (-w_up, 0.0, u_up, 0.0)


@summand
def _component_in_space(sign, speed, frequency, number, to_x, to_y, z, angle):
    """The same by axes, and what waves steepen by: -du/dx, -du/dy and -dv/dy."""
    across, rise, across_rate, rise_rate, across_up, rise_up = _component(sign, speed, frequency, number, z, angle)
    x_share, y_share = rise_up * to_x, rise_up * to_y
    return (
        across * to_x, across * to_y, rise, across_rate * to_x, across_rate * to_y, rise_rate, across_up * to_x, across_up * to_y,
        x_share * to_x, x_share * to_y, y_share * to_y,
    )  # fmt: skip


@summing
def _sums_in_space(sign, waves, count, x, y, z, t):
    number, frequency, phase, to_x, to_y = waves[NUMBER], waves[FREQUENCY], waves[PHASE], waves[COSINE], waves[SINE]
    speed = waves[SPEED]
    u = v = w = u_rate = v_rate = w_rate = u_up = v_up = xx = xy = yy = 0.0
    for j in range(count):
        angle = _angle(number[j], to_x[j], to_y[j], x, y, frequency[j], t, phase[j])
        each = _component_in_space(sign, speed[j], frequency[j], number[j], to_x[j], to_y[j], z, angle)
        u += each[0]
        v += each[1]
        w += each[2]
        u_rate += each[3]
        v_rate += each[4]
        w_rate += each[5]
        u_up += each[6]
        v_up += each[7]
        xx += each[8]
        xy += each[9]
        yy += each[10]
    return (u, v, w), (u_rate, v_rate, w_rate), (u_up, v_up, xx + yy), (-xx, -xy, 0.0, -xy, -yy, 0.0, u_up, v_up, 0.0)


@kernel
def _effective_height(stretched, waves, ramp, position, t):
    """The height at which the profiles are read, and its gradient and rate; no higher than still water."""
    z = position[len(position) - 1]
    if stretched is None:
        if z >= 0.0:
            return 0.0, zero(position), 0.0
        return z, upward(1.0, position), 0.0
    surface, rate, slope = elevation(waves, ramp, position, t)
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
def sum_of_amplitudes(waves):
    """In m: no wave is higher, or deeper."""
    height = 0.0
    for j in range(waves.shape[1]):
        height += waves[AMPLITUDE, j]
    return height


@kernel
def _faded(cut, waves, ramp, position, t):
    """Share of the waves' motion at a place, and its gradient: 1 below the surface, 0 above it, a smooth step between."""
    if cut is None:
        return 1.0, zero(position)
    height = sum_of_amplitudes(waves)
    if position[len(position) - 1] <= -height:
        return 1.0, zero(position)
    surface, _, slope = elevation(waves, ramp, position, t)
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
    return _motion(parts.waves, parts, position, t)


@kernel
def _calm(waves, parts, position, t):
    return zero(position), zero(position), diagonal(0.0, position)


@kernel
def _family(sign, waves, position, z, t):
    count = count_until(waves[NUMBER], FELT / -z) if z < 0.0 else waves.shape[1]
    if len(position) == 2:
        return _sums_in_plane(sign, waves, count, position[0], 0.0, z, t)
    return _sums_in_space(sign, waves, count, position[0], position[1], z, t)


@kernel
def _deep(finite_depth, waves, position, z, t):
    return _family(1.0, waves, position, z, t)


@kernel
def _over_bottom(finite_depth, waves, position, z, t):
    """cosh k(z+h)/sinh kh and sinh k(z+h)/sinh kh are the waves of deep water and their mirror images, times what SPEED has."""
    velocity, acceleration, up, gradient = _family(1.0, waves, position, z, t)
    depth = waves[DEPTH, 0]
    if depth <= 0.0:
        return velocity, acceleration, up, gradient
    v, a, u, g = _family(-1.0, waves, position, min(-(z + 2.0 * depth), 0.0), t)
    return add(velocity, v), add(acceleration, a), add(up, u), add_matrix(gradient, g)


_both_families = by_presence(_deep, _over_bottom)


@kernel
def _rough(waves, parts, position, t):
    z, by_place, z_rate = _effective_height(parts.stretched, waves, parts.wave_ramp, position, t)
    velocity, acceleration, up, gradient = _both_families(parts.finite_depth, waves, position, z, t)
    acceleration = axpy(z_rate, up, acceleration)
    gradient = add_matrix(gradient, outer(up, by_place))
    share, fading = _faded(parts.cut, waves, parts.wave_ramp, position, t)
    gradient = add_matrix(scale_matrix(share, gradient), outer(velocity, fading))
    velocity, acceleration = scale(share, velocity), scale(share, acceleration)
    return grown(parts.wave_ramp, velocity, acceleration, gradient, t)


_motion = by_presence(_calm, _rough)
