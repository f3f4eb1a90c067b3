"""The shape of the seabed: level; a plane that slopes; or heights over a profile or a grid, joined by cubics.

A node feels how far it is from the bottom along the bottom's normal, and is pushed along it:

    gap = c (z - b(x, y)),   n = c (-b_x, -b_y, 1),   c = 1/sqrt(1 + b_x^2 + b_y^2)

which is the distance to a plane, and to a bottom whose radius of curvature is large beside the depth to which cables sink in.
b and its slope are continuous: cubics by heights and slopes at the points, products of them on a grid, straight on beyond the table.
"""

import math
from typing import NamedTuple

from cable_model.kernels.choice import by_presence
from cable_model.kernels.contact import NORMAL
from cable_model.kernels.jit import kernel
from cable_model.kernels.vector import (
    add_matrix,
    apply_transposed,
    axpy,
    diagonal,
    dot,
    load_from,
    multiply,
    outer,
    scale,
    scale_matrix,
    upward,
    zero,
)

Z, Z_X, Z_Y, Z_XY = 2, 3, 4, 5  # columns of the table after x and y: height and slopes; its first row has the number of places along y


@kernel
def _piece(table, column, first, stride, count, x):
    """The place k of the piece [k, k + 1] of `count` places, `stride` rows apart, in which x lies, or of the piece next to it."""
    low, high = 0, count - 1
    while high - low > 1:
        middle = (low + high) // 2
        if table[first + middle * stride, column] <= x:
            low = middle
        else:
            high = middle
    return low


@kernel
def _weights(x, low, high):
    """Of the heights and slopes at both ends of a piece: in the height at x, in the slope there and in the curvature."""
    h = high - low
    if x < low:
        return (1.0, 0.0, x - low, 0.0), (0.0, 0.0, 1.0, 0.0), (0.0, 0.0, 0.0, 0.0)
    if x > high:
        return (0.0, 1.0, 0.0, x - high), (0.0, 0.0, 0.0, 1.0), (0.0, 0.0, 0.0, 0.0)
    s = (x - low) / h
    r = 1.0 - s
    rise, bend = 6.0 * s * r / h, (6.0 - 12.0 * s) / (h * h)
    return (
        (r * r * (1.0 + 2.0 * s), s * s * (3.0 - 2.0 * s), h * s * r * r, -h * s * s * r),
        (-rise, rise, r * (1.0 - 3.0 * s), s * (3.0 * s - 2.0)),
        (-bend, bend, (6.0 * s - 4.0) / h, (6.0 * s - 2.0) / h),
    )


@kernel
def _over(table, low, high, column, slope, w):
    """A quantity by its column and that of its slope, in rows `low` and `high`, with these weights."""
    return w[0] * table[low, column] + w[1] * table[high, column] + w[2] * table[low, slope] + w[3] * table[high, slope]


@kernel
def shape_at(table, x, y):
    """Height of a bottom, m, its slopes by x and y, and its second derivatives by x twice, by both and by y twice, 1/m."""
    across = int(table[0, 0])
    along = (table.shape[0] - 1) // across
    i = _piece(table, 0, 1, across, along, x)
    j = _piece(table, 1, 1, 1, across, y) if across > 1 else 0
    low = 1 + i * across + j
    high = low + across
    w, dw, ddw = _weights(x, table[low, 0], table[high, 0])
    here, here_x = _over(table, low, high, Z, Z_X, w), _over(table, low, high, Z, Z_X, dw)
    here_xx = _over(table, low, high, Z, Z_X, ddw)
    if across == 1:
        return here, here_x, 0.0, here_xx, 0.0, 0.0
    turned, turned_x = _over(table, low, high, Z_Y, Z_XY, w), _over(table, low, high, Z_Y, Z_XY, dw)
    turned_xx = _over(table, low, high, Z_Y, Z_XY, ddw)
    low, high = low + 1, high + 1
    there, there_x = _over(table, low, high, Z, Z_X, w), _over(table, low, high, Z, Z_X, dw)
    there_xx = _over(table, low, high, Z, Z_X, ddw)
    twisted, twisted_x = _over(table, low, high, Z_Y, Z_XY, w), _over(table, low, high, Z_Y, Z_XY, dw)
    twisted_xx = _over(table, low, high, Z_Y, Z_XY, ddw)
    u, du, ddu = _weights(y, table[low - 1, 1], table[low, 1])
    return (
        u[0] * here + u[1] * there + u[2] * turned + u[3] * twisted,
        u[0] * here_x + u[1] * there_x + u[2] * turned_x + u[3] * twisted_x,
        du[0] * here + du[1] * there + du[2] * turned + du[3] * twisted,
        u[0] * here_xx + u[1] * there_xx + u[2] * turned_xx + u[3] * twisted_xx,
        du[0] * here_x + du[1] * there_x + du[2] * turned_x + du[3] * twisted_x,
        ddu[0] * here + ddu[1] * there + ddu[2] * turned + ddu[3] * twisted,
    )


@kernel
def _shape_under(relief, place):
    return shape_at(relief, place[0], place[1] if len(place) == 3 else 0.0)


@kernel
def _upright(slope, ground, like):
    return upward(1.0, like)


@kernel
def _sloping(slope, ground, like):
    return ground.normal


_facing = by_presence(_upright, _sloping)  # the normal of a plane bottom


@kernel
def _over_plane(relief, ground, place):
    n = _facing(ground.slope, ground, place)
    return dot(place, n) - ground.level, n


@kernel
def _over_relief(relief, ground, place):
    b, bx, by, _, _, _ = _shape_under(relief, place)
    c = 1.0 / (1.0 + bx * bx + by * by) ** 0.5
    gap = c * (place[len(place) - 1] - b)
    if len(place) == 2:
        return gap, (-c * bx, c)
    return gap, (-c * bx, -c * by, c)


over_bottom = by_presence(_over_plane, _over_relief)  # how far a place is from the bottom along its normal, m; that normal


@kernel
def _one_normal(relief, ground, contact, i, like):
    return _facing(ground.slope, ground, like)


@kernel
def _own_normal(relief, ground, contact, i, like):
    return load_from(contact, i, NORMAL, like)


normal_under = by_presence(_one_normal, _own_normal)  # of node i, as the contact table was last told


class Turning(NamedTuple):
    """How a bottom's normal, and its upward part, change with the place."""

    normal: object  # (D, D), 1/m
    upward: object  # c's gradient over c, 1/m


@kernel
def _never(relief, place, n):
    return Turning(diagonal(0.0, n), zero(n))


@kernel
def _as_shaped(relief, place, n):
    """dn = (1 - n n) c (-H dr), as the normal stays of length 1 while the slopes change by H; dc = -c^3 b' H dr."""
    _, bx, by, bxx, bxy, byy = _shape_under(relief, place)
    c = n[len(n) - 1]
    across = add_matrix(diagonal(c, n), scale_matrix(-c, outer(n, n)))
    if len(n) == 2:
        return Turning(multiply(across, (-bxx, 0.0, 0.0, 0.0)), (-c * c * bx * bxx, 0.0))
    turned = (-bxx, -bxy, 0.0, -bxy, -byy, 0.0, 0.0, 0.0, 0.0)
    return Turning(multiply(across, turned), (-c * c * (bx * bxx + by * bxy), -c * c * (bx * bxy + by * byy), 0.0))


turning = by_presence(_never, _as_shaped)  # Turning of the bottom under a place with the normal n


@kernel
def _plane_approach(relief, turns, gains, lag, n, height, v):
    return scale(gains.r + lag * gains.v, n)


@kernel
def _curved_approach(relief, turns, gains, lag, n, height, v):
    ahead = axpy(height, turns.upward, n)
    return axpy(lag * gains.v, n, scale(gains.r, axpy(lag, apply_transposed(turns.normal, v), ahead)))


by_approach = by_presence(_plane_approach, _curved_approach)  # derivative of gap + lag v.n by the velocity that Newton's method seeks


@kernel
def _stays(relief, turns, size, matrix):
    return matrix


@kernel
def _with_turn(relief, turns, size, matrix):
    return add_matrix(matrix, scale_matrix(size, turns.normal))


add_turn = by_presence(_stays, _with_turn)  # a matrix, and `size` times the derivative of the normal by the place


@kernel
def _no_tilt(relief, turns, size, across, n, w, matrix):
    return matrix


@kernel
def _with_tilt(relief, turns, size, across, n, w, matrix):
    by_place = add_matrix(scale_matrix(dot(n, w), turns.normal), outer(n, apply_transposed(turns.normal, w)))
    return add_matrix(matrix, scale_matrix(-size, multiply(across, by_place)))


# a matrix, and `size` times the derivative by the place of the part of w along the bottom, of which `across` takes its share
add_tilt = by_presence(_no_tilt, _with_tilt)


@kernel
def _level_at(slope, p, x, y):
    return p[0].seabed.level


@kernel
def _slope_at(slope, p, x, y):
    along_x, along_y = slope_of(p)
    return p[0].seabed.level + along_x * x + along_y * y


_plane_at = by_presence(_level_at, _slope_at)


@kernel
def _as_plane(relief, slope, p, x, y):
    return _plane_at(slope, p, x, y)


@kernel
def _as_relief(relief, slope, p, x, y):
    return shape_at(relief, x, y)[0]


bottom_at = by_presence(_as_plane, _as_relief)  # height of the seabed under a place, m


@kernel
def slope_of(p):
    """Rise of a sloping bottom by x and by y."""
    bed = p[0].seabed
    return bed.slope * math.cos(bed.slope_direction), bed.slope * math.sin(bed.slope_direction)
