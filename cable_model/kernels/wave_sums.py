"""Sums over the components of linear waves: the water's motion at a height, and the surface.

A component's elevation is cos(k s - omega t + phase) times its amplitude, s along its direction.  A table has a row a quantity and a column
a component, by rising wave number: so sums run over a row, several components at a time, and end where the waves reach no deeper.
"""

from cable_model.kernels.choice import by_presence
from cable_model.kernels.jit import kernel, summand, summing
from cable_model.kernels.vector import add, add_matrix

# rows of a table: m, rad/s, 1/m, the direction's cosine and sine, and the sign of its cosine, which is the direction in the plane; rad, m,
# amplitude times frequency, over 1 - exp(-2 k depth), m/s; and the sum of all amplitudes, m
AMPLITUDE, FREQUENCY, NUMBER, COSINE, SINE, SIGN, PHASE, DEPTH, SPEED, HIGHEST = range(10)
FELT = 20.0  # k |z| beyond which a component is not felt: 2e-9 of what it is at the surface
# 2 pi in parts, of which the first times a whole number below 2^20 is exact
TURN, REST_OF_TURN, TURNS = 6.2831853069365025, 2.430840202602477e-10, 0.15915494309189535
TO_WHOLE = 6755399441055744.0  # 1.5 * 2^52: what is added to it is rounded to a whole number


@summand
def circle(angle):
    """Cosine and sine without a branch or a call, to 1e-15: series of a quarter of the angle less its turns, doubled twice."""
    turns = (angle * TURNS + TO_WHOLE) - TO_WHOLE
    q = 0.25 * ((angle - turns * TURN) - turns * REST_OF_TURN)
    y = q * q
    s = 1.0 / 6227020800.0 - y * (1.0 / 1307674368000.0)
    s = 1.0 / 39916800.0 - y * s
    s = 1.0 / 362880.0 - y * s
    s = 1.0 / 5040.0 - y * s
    s = 1.0 / 120.0 - y * s
    s = 1.0 / 6.0 - y * s
    s = q * (1.0 - y * s)
    c = 1.0 / 87178291200.0 - y * (1.0 / 20922789888000.0)
    c = 1.0 / 479001600.0 - y * c
    c = 1.0 / 3628800.0 - y * c
    c = 1.0 / 40320.0 - y * c
    c = 1.0 / 720.0 - y * c
    c = 1.0 / 24.0 - y * c
    c = 1.0 / 2.0 - y * c
    c = 1.0 - y * c
    s, c = 2.0 * s * c, (c - s) * (c + s)
    return (c - s) * (c + s), 2.0 * s * c


@summand
def power(x):
    """exp(x) for x from -FELT to 0, likewise, to 1e-14: the series of a 64th, squared six times."""
    w = x * 0.015625
    e = 1.0 / 39916800.0 + w * (1.0 / 479001600.0)
    e = 1.0 / 3628800.0 + w * e
    e = 1.0 / 362880.0 + w * e
    e = 1.0 / 40320.0 + w * e
    e = 1.0 / 5040.0 + w * e
    e = 1.0 / 720.0 + w * e
    e = 1.0 / 120.0 + w * e
    e = 1.0 / 24.0 + w * e
    e = 1.0 / 6.0 + w * e
    e = 1.0 / 2.0 + w * e
    e = 1.0 + w * e
    e = 1.0 + w * e
    e = e * e
    e = e * e
    e = e * e
    e = e * e
    e = e * e
    return e * e


@summand
def angle_of(number, to_x, to_y, x, y, frequency, t, phase):
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
    c, s = circle(angle)
    return size * c, frequency * (size * s), -number * (size * s)


@summing
def _heights_in_plane(waves, x, y, t):
    """Sums of elevations, of their rates and of their slopes."""
    number, along, frequency, phase, size = waves[NUMBER], waves[SIGN], waves[FREQUENCY], waves[PHASE], waves[AMPLITUDE]
    height = rate = slope = 0.0
    for j in range(waves.shape[1]):
        h, r, g = _height(size[j], frequency[j], number[j], angle_of(number[j], along[j], 0.0, x, 0.0, frequency[j], t, phase[j]))
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
        h, r, g = _height(size[j], frequency[j], number[j], angle_of(number[j], to_x[j], to_y[j], x, y, frequency[j], t, phase[j]))
        height += h
        rate += r
        slope_x += _product(g, to_x[j])
        slope_y += _product(g, to_y[j])
    return height, rate, (slope_x, slope_y, 0.0)


@kernel
def heights(waves, position, t):
    """Height of the surface over a place, m, its rate, m/s, and its gradient."""
    if len(position) == 2:
        return _heights_in_plane(waves, position[0], 0.0, t)
    return _heights_in_space(waves, position[0], position[1], t)


@summand
def _component(sign, speed, frequency, number, z, angle):
    """Of a component at a height: velocity along its direction and upwards, their rates, and their changes with height."""
    across = power(number * z)
    rise = sign * across
    c, s = circle(angle)
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
        angle = angle_of(number[j], along[j], 0.0, x, 0.0, frequency[j], t, phase[j])
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
        angle = angle_of(number[j], to_x[j], to_y[j], x, y, frequency[j], t, phase[j])
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


water_sums = by_presence(_deep, _over_bottom)
