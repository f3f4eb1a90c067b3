"""Many waves at points that move: a record of what they do along a point's path, made anew where it ends.

All components are summed once for many steps.  About a moment and along a straight path of velocity v, a component E exp(a s) with
a = k v_z + i (k d.v - omega) is a polynomial in the time s since, and so is any sum of them; the point stays near the path, and the first
two derivatives by the place lead to it.  The motion has a potential without sources, so that few of the derivatives are of their own:

    w = sum Im E,  w_z = sum k Im E,  w_zz = sum k^2 Im E;  one along x instead of z takes another factor i d_x before E.

A record serves as long as the first terms that it lacks, in time and away from the path, are less than TOLERANCE of the water's own
motion.  Records are part of the state, so that what comes next does not depend on how it was reached.
"""

import math
from typing import NamedTuple

from cable_model.kernels.choice import by_presence, given
from cable_model.kernels.jit import kernel
from cable_model.kernels.vector import axpy, norm, sub
from cable_model.kernels.wave_sums import DEPTH, FELT, NUMBER, SPEED, count_until, water_sums
from cable_model.kernels.wave_terms import (
    ORDER,
    add_in_plane,
    add_in_space,
    raise_terms,
    row_of_directions,
    set_terms,
    square_sums,
    square_sums_at_surface,
)

MANY = 16  # components: fewer are summed
FACTORIAL = 5040.0  # of the order after
MOST_TURNED = 2.0**7  # that power of the largest angle
TOLERANCE = 2e-5  # of the root mean square of the acceleration; a fifth of it of that of the velocity
NOBODY = -1  # instead of the number of a point: no record is to be used
MOST_TRIES = 3  # to make a record, of which the last is about now
AHEAD = 0.8  # of the last record's reach: how far from now the moment of the next is
LEAST = 1e-4  # of what the waves are at the surface: what is less counts as so much
RISE = 1.0  # by how many exponents the shortest component that is felt may grow along a record's path, and as many beside it
# a record: moment, s; how far it serves in time, s, and from its path, m; place and velocity; then one polynomial after the other
MOMENT, SPAN, WIDTH, PLACE = 0, 1, 2, 3
IN_PLANE, IN_SPACE = 6, 15  # polynomials of the water: two or three components, and the derivatives of their own
SURFACE_IN_PLANE, SURFACE_IN_SPACE = 3, 6  # of the surface: its height, slopes and curvatures


class Records(NamedTuple):
    """What the part `followed` is in a step: records of all points, and room for the terms of a sum."""

    water: object  # (points, .)
    surface: object  # (points, .)
    terms: object  # (TERMS, components): E and a of a sum's components, real and imaginary


with_records = given("followed")


@kernel
def without_records(parts, state):
    """The parts with records of no point, so that all components are summed."""
    nothing = state[0:0].reshape((0, 1))
    return with_records(parts, Records(nothing, nothing, nothing))


@kernel
def record_sizes(like):
    """How many numbers a record of the water and one of the surface have."""
    head = PLACE + 2 * len(like)
    if len(like) == 2:
        return head + IN_PLANE * (ORDER + 1), head + SURFACE_IN_PLANE * (ORDER + 1) + 1
    return head + IN_SPACE * (ORDER + 1), head + SURFACE_IN_SPACE * (ORDER + 1) + 1


@kernel
def begin_record(record, place, velocity, moment):
    for k in range(record.shape[0]):
        record[k] = 0.0
    record[MOMENT] = moment
    for k in range(len(place)):
        record[PLACE + k] = place[k]
        record[PLACE + len(place) + k] = velocity[k]


@kernel
def limit_reach(record, squares, missing, least, speed, tolerance):
    """Set how far a record serves.  In time the acceleration lacks (n + 1) E_(n+1) s^n; at a distance e from the path it lacks
    k^3 |v| E e^2/2 and omega k^3 E e^3/6, the velocity k^3 E e^3/6.  `speed` is |v|, and of the water more by
    what it does itself, by which stretched heights move.
    Nor does it serve where these terms, of waves of the mean size, are not the first of series that fall.
    """
    tiny = 1e-300
    size, third, both = math.sqrt(squares[0] + tiny), math.sqrt(squares[2] + tiny), math.sqrt(squares[3] + tiny)
    swift = tolerance * math.sqrt(max(squares[1], LEAST * LEAST * least[1]) + tiny)
    quick = 0.2 * tolerance * math.sqrt(max(squares[0], LEAST * LEAST * least[0]) + tiny)
    last = math.sqrt(missing + tiny)
    span = (swift / ((ORDER + 1) * last)) ** (1.0 / ORDER)
    turned = FACTORIAL * last * (span * span * span) * (span * span * span) * span  # E times the angle by which the mean wave turns, ^(n+1)
    if turned > MOST_TURNED * size:
        span *= (MOST_TURNED * size / turned) ** (1.0 / (ORDER + 1))
    record[SPAN] = span
    width = min(6.0 * swift / both, min(6.0 * quick, size) / third) ** (1.0 / 3.0)
    record[WIDTH] = min(width, math.sqrt(2.0 * swift / (third * speed + tiny)))


@kernel
def ahead_of(record):
    """How far from now the moment of a new record is, by how far the last one served; 0 where that is no number."""
    ahead = AHEAD * record[SPAN]
    return ahead if 0.0 <= ahead < 1e3 else 0.0


@kernel
def serves(record, position, t):
    """Whether a record holds for a place and time; one of nothing does not."""
    since = t - record[MOMENT]
    if not abs(since) < record[SPAN]:
        return False
    far = 0.0
    for k in range(len(position)):
        away = position[k] - record[PLACE + k] - since * record[PLACE + len(position) + k]
        far += away * away
    return far < record[WIDTH] * record[WIDTH]


@kernel
def _polynomial(record, first, k, s):
    """Value and rate of the polynomial k."""
    at = first + k * (ORDER + 1)
    value, rate = record[at + ORDER], 0.0
    for order in range(ORDER - 1, -1, -1):
        rate = rate * s + value
        value = value * s + record[at + order]
    return value, rate


@kernel
def polynomials(record, first, k, s):
    """Values and rates of three polynomials from k on."""
    x, x_rate = _polynomial(record, first, k, s)
    y, y_rate = _polynomial(record, first, k + 1, s)
    z, z_rate = _polynomial(record, first, k + 2, s)
    return (x, y, z), (x_rate, y_rate, z_rate)


@kernel
def path_of(record, like):
    """Where a record's path is at its moment, and its velocity."""
    if len(like) == 2:
        return (record[PLACE], record[PLACE + 1]), (record[PLACE + 2], record[PLACE + 3])
    return (record[PLACE], record[PLACE + 1], record[PLACE + 2]), (record[PLACE + 3], record[PLACE + 4], record[PLACE + 5])


@kernel
def _add_family(sign, waves, along, count, place, z, velocity, t, records, record):
    """Add what deep water's waves do (`sign` 1), or what a bottom mirrors (-1), to the polynomials; squares of terms, and the first one's
    that is not there."""
    terms = records.terms
    rise = sign * velocity[len(velocity) - 1]
    set_terms(waves, SPEED, along, count, place, z, t, velocity, rise, terms)
    squares = square_sums(waves, count, terms)
    first = PLACE + 2 * len(place)
    for order in range(ORDER + 2):
        if order > 0:
            raise_terms(count, 1.0 / order, terms)
        if order <= ORDER and len(place) == 2:
            add_in_plane(sign, waves, along, count, terms, record, first + order)
        elif order <= ORDER:
            add_in_space(sign, waves, along, count, terms, record, first + order)
    missing, _, _, _ = square_sums(waves, count, terms)
    return squares, missing


@kernel
def _in_deep_water(finite_depth, waves, along, count, place, velocity, t, records, record):
    return _add_family(1.0, waves, along, count, place, place[len(place) - 1], velocity, t, records, record)


@kernel
def _over_bottom(finite_depth, waves, along, count, place, velocity, t, records, record):
    squares, missing = _in_deep_water(None, waves, along, count, place, velocity, t, records, record)
    depth = waves[DEPTH, 0]
    if depth <= 0.0:
        return squares, missing
    z = min(-(place[len(place) - 1] + 2.0 * depth), 0.0)
    deep = count_until(waves[NUMBER], FELT / -z) if z < 0.0 else waves.shape[1]
    more, more_missing = _add_family(-1.0, waves, along, deep, place, z, velocity, t, records, record)
    total = (squares[0] + more[0], squares[1] + more[1], squares[2] + more[2], squares[3] + more[3])
    return total, missing + more_missing


_both_families = by_presence(_in_deep_water, _over_bottom)


@kernel
def _renew_water(finite_depth, waves, records, record, position, velocity, t):
    least = square_sums_at_surface(waves, SPEED)
    along = row_of_directions(position)
    ahead = ahead_of(record)
    tries = 0
    while True:
        place = axpy(ahead, velocity, position)
        z = place[len(place) - 1]
        if z > 0.0:  # where the waves do not end with z = 0 short ones would grow without end
            ahead, place, z = 0.0, position, position[len(position) - 1]
        begin_record(record, place, velocity, t + ahead)
        count = count_until(waves[NUMBER], FELT / -z) if z < 0.0 else waves.shape[1]
        squares, missing = _both_families(finite_depth, waves, along, count, place, velocity, t + ahead, records, record)
        limit_reach(record, squares, missing, least, norm(velocity) + math.sqrt(0.5 * squares[0]), TOLERANCE)
        rise = RISE / waves[NUMBER, min(count, waves.shape[1] - 1)]
        record[SPAN] = min(record[SPAN], rise / (abs(velocity[len(place) - 1]) + 1e-300))
        record[WIDTH] = min(record[WIDTH], rise)
        tries += 1
        if ahead < record[SPAN] or tries == MOST_TRIES:
            return
        ahead = ahead_of(record) if tries < MOST_TRIES - 1 else 0.0


@kernel
def _read_in_plane(record, position, t):
    """As wave_sums.water_sums.  The derivatives make complex numbers: u + iw falls with z as (u_z + i w_z)."""
    s = t - record[MOMENT]
    place, speed = path_of(record, position)
    ex, ez = sub(position, axpy(s, speed, place))
    first = PLACE + 4
    (u, w, b), (u_rate, w_rate, b_rate) = polynomials(record, first, 0, s)
    (c, d, e), (c_rate, d_rate, e_rate) = polynomials(record, first, 3, s)
    # b: u_z = w_x; c: w_z = -u_x; d: u_zz = w_xz = -u_xx; e: w_zz = -u_xz = -w_xx
    far_b, far_c = d * ez - e * ex, e * ez + d * ex
    by_b, by_c = b + 0.5 * far_b, c + 0.5 * far_c
    rate_b, rate_c = b_rate + 0.5 * (d_rate * ez - e_rate * ex), c_rate + 0.5 * (e_rate * ez + d_rate * ex)
    b += far_b
    c += far_c
    velocity = (u - by_c * ex + by_b * ez, w + by_b * ex + by_c * ez)
    acceleration = (
        u_rate - rate_c * ex + rate_b * ez + c * speed[0] - b * speed[1],
        w_rate + rate_b * ex + rate_c * ez - b * speed[0] - c * speed[1],
    )
    return velocity, acceleration, (b, c), (-c, 0.0, b, 0.0)


@kernel
def _quadratic(zzz, xzz, yzz, xxz, xyz, xxx, xxy, e):
    """The change of the gradient over a distance: its xx, xy, xz, yz, zz."""
    return (
        xxx * e[0] + xxy * e[1] + xxz * e[2],
        xxy * e[0] - (xzz + xxx) * e[1] + xyz * e[2],
        xxz * e[0] + xyz * e[1] + xzz * e[2],
        xyz * e[0] - (zzz + xxz) * e[1] + yzz * e[2],
        xzz * e[0] + yzz * e[1] + zzz * e[2],
    )


@kernel
def _applied(h, e):
    """A gradient, symmetric and without divergence, as xx, xy, xz, yz, zz, times a vector."""
    return (
        h[0] * e[0] + h[1] * e[1] + h[2] * e[2],
        h[1] * e[0] - (h[0] + h[4]) * e[1] + h[3] * e[2],
        h[2] * e[0] + h[3] * e[1] + h[4] * e[2],
    )


@kernel
def _sum(share, a, b):
    return (share * a[0] + b[0], share * a[1] + b[1], share * a[2] + b[2], share * a[3] + b[3], share * a[4] + b[4])


@kernel
def _read_in_space(record, position, t):
    s = t - record[MOMENT]
    place, speed = path_of(record, position)
    e = sub(position, axpy(s, speed, place))
    first = PLACE + 6
    own, own_rate = polynomials(record, first, 0, s)
    (xz, yz, zz), (xz_rate, yz_rate, zz_rate) = polynomials(record, first, 3, s)
    (xx, xy, zzz), (xx_rate, xy_rate, zzz_rate) = polynomials(record, first, 6, s)
    (xzz, yzz, xxz), (xzz_rate, yzz_rate, xxz_rate) = polynomials(record, first, 9, s)
    (xyz, xxx, xxy), (xyz_rate, xxx_rate, xxy_rate) = polynomials(record, first, 12, s)
    near = (-xx, -xy, xz, yz, zz)
    far = _quadratic(zzz, xzz, yzz, -xxz, -xyz, -xxx, -xxy, e)
    gradient = _sum(1.0, far, near)
    near_rate = (-xx_rate, -xy_rate, xz_rate, yz_rate, zz_rate)
    far_rate = _quadratic(zzz_rate, xzz_rate, yzz_rate, -xxz_rate, -xyz_rate, -xxx_rate, -xxy_rate, e)
    velocity = axpy(1.0, _applied(_sum(0.5, far, near), e), own)
    acceleration = axpy(1.0, _applied(_sum(0.5, far_rate, near_rate), e), own_rate)
    acceleration = axpy(-1.0, _applied(gradient, speed), acceleration)
    xx, xy, xz, yz, zz = gradient
    return velocity, acceleration, (xz, yz, zz), (xx, xy, 0.0, xy, -(xx + zz), 0.0, xz, yz, 0.0)


@kernel
def _summed(followed, finite_depth, waves, i, velocity, position, t):
    return water_sums(finite_depth, waves, position, position[len(position) - 1], t)


@kernel
def _followed(followed, finite_depth, waves, i, velocity, position, t):
    if i < 0 or i >= followed.water.shape[0]:
        return water_sums(finite_depth, waves, position, position[len(position) - 1], t)
    record = followed.water[i]
    if not serves(record, position, t):
        _renew_water(finite_depth, waves, followed, record, position, velocity, t)
    if len(position) == 2:
        return _read_in_plane(record, position, t)
    return _read_in_space(record, position, t)


water_at = by_presence(_summed, _followed)
"""As wave_sums.water_sums, at a place not above z = 0, for the point i that moves at a velocity; or for NOBODY."""
