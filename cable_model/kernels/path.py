"""The prescribed path of the cable's ends within one communication step: a quintic polynomial per axis, continuous to the acceleration.

`path` is (9, 9): coefficients of s^0 ... s^5 with s = (t - t_start)/H, then position, velocity and acceleration where it ends, which
the coefficients of a sliver give no better than rounding over H and H^2.  Its columns are x, y, z of the top, the length of cable that
the winch has paid out, a parabola (its speed changes linearly), x, y, z of the lower end, 0 where nothing drives it, and x, y of where
the current that inputs give carries the water since the path's start, parabolas too.
"""

import math
from typing import NamedTuple

from cable_model.kernels.header import LOWER, STREAM, TOP
from cable_model.kernels.jit import kernel

WINCH = 3  # column of the path, and of the inputs that are kept
CARRIED = 7  # likewise, the first of two
GIVEN_STREAM = 19  # place of water.current_x in the inputs
GIVEN_CUT = 21  # and of lower_end.let_go
ROWS, COLUMNS = 9, 9
PATH = ROWS * COLUMNS  # numbers of a path
ARRIVAL = 6  # first row of where it ends


class Ends(NamedTuple):
    """A vector at the top, and at a held lower end."""

    top: object
    lower: object


class End(NamedTuple):
    """An end of the cable that is moved: where its numbers are."""

    column: int  # x in the path, and in the inputs that are kept
    given: int  # x in the inputs
    motion: int  # position, velocity and acceleration now, in the state's head


UPPER_END, LOWER_END = End(0, 0, TOP), End(4, 10, LOWER)


@kernel
def quintic(start, end, h, path, column):
    """Path from `start` to `end`, (9,) each: position, velocity, acceleration at both ends of a step of h; into three columns."""
    for k in range(3):
        j = column + k
        p0 = start[k]
        v0 = start[3 + k] * h
        a0 = 0.5 * start[6 + k] * h * h
        gap = end[k] - p0 - v0 - a0
        gap_v = end[3 + k] * h - v0 - 2.0 * a0
        gap_a = end[6 + k] * h * h - 2.0 * a0
        path[0, j] = p0
        path[1, j] = v0
        path[2, j] = a0
        path[3, j] = 10.0 * gap - 4.0 * gap_v + 0.5 * gap_a
        path[4, j] = -15.0 * gap + 7.0 * gap_v - gap_a
        path[5, j] = 6.0 * gap - 3.0 * gap_v + 0.5 * gap_a
        for i in range(3):
            path[ARRIVAL + i, j] = end[3 * i + k]


@kernel
def glide(column, place, speed, end_speed, h, path):
    """A column of the path whose speed changes linearly, from its speeds at both ends of a step of h."""
    path[0, column] = place
    path[1, column] = speed * h
    path[2, column] = 0.5 * (end_speed - speed) * h
    for i in range(3, ARRIVAL):
        path[i, column] = 0.0
    path[ARRIVAL, column] = place + 0.5 * (speed + end_speed) * h
    path[ARRIVAL + 1, column] = end_speed
    path[ARRIVAL + 2, column] = (end_speed - speed) / h


@kernel
def wind(paid_out, speed, end_speed, h, path):
    """The winch's column of the path, from its speeds at both ends of a step of h."""
    glide(WINCH, paid_out, speed, end_speed, h, path)


@kernel
def carry(state, x, y, h, path):
    """The stream's columns of the path, from that of the state to (x, y) at the end of a step of h."""
    glide(CARRIED, 0.0, state[STREAM], x, h, path)
    glide(CARRIED + 1, 0.0, state[STREAM + 1], y, h, path)


@kernel
def wind_between(paid_out, speed, end_paid_out, h, path):
    """The same from the length paid out at both ends and the speed at the start."""
    wind(paid_out, speed, 2.0 * (end_paid_out - paid_out) / h - speed, h, path)


@kernel
def go_on(state, which, h, path):
    """The path of an end over a step of h under the acceleration that it has."""
    for k in range(3):
        j, at = which.column + k, which.motion + k
        position, velocity, acceleration = state[at], state[at + 3], state[at + 6]
        path[0, j] = position
        path[1, j] = h * velocity
        path[2, j] = 0.5 * h * h * acceleration
        for i in range(3, ARRIVAL):
            path[i, j] = 0.0
        path[ARRIVAL, j] = path[0, j] + path[1, j] + path[2, j]
        path[ARRIVAL + 1, j] = velocity + h * acceleration
        path[ARRIVAL + 2, j] = acceleration


@kernel
def take_stream(path, state):
    """The stream at the end of a path."""
    for k in range(2):
        _, state[STREAM + k], state[STREAM + 2 + k] = arrival(path, CARRIED + k)


@kernel
def stream_crosses(path):
    """Whether a path has a stream out of the plane y = const."""
    return path[1, CARRIED + 1] != 0.0 or path[2, CARRIED + 1] != 0.0


@kernel
def winch_turns(path):
    return path[1, WINCH] != 0.0 or path[2, WINCH] != 0.0


@kernel
def evaluate(path, h, s, k):
    """Position, velocity and acceleration of axis k at the fraction s of a step of h."""
    c = path[:, k]
    position = c[0] + s * (c[1] + s * (c[2] + s * (c[3] + s * (c[4] + s * c[5]))))
    velocity = (c[1] + s * (2.0 * c[2] + s * (3.0 * c[3] + s * (4.0 * c[4] + s * 5.0 * c[5])))) / h
    acceleration = (2.0 * c[2] + s * (6.0 * c[3] + s * (12.0 * c[4] + s * 20.0 * c[5]))) / (h * h)
    return position, velocity, acceleration


@kernel
def arrival(path, k):
    """Position, velocity and acceleration of axis k at the end of a path."""
    return path[ARRIVAL, k], path[ARRIVAL + 1, k], path[ARRIVAL + 2, k]


@kernel
def arrive(which, path, state):
    """Take an end to the end of a path."""
    for k in range(3):
        position, velocity, acceleration = arrival(path, which.column + k)
        state[which.motion + k] = position
        state[which.motion + 3 + k] = velocity
        state[which.motion + 6 + k] = acceleration


@kernel
def shorten(path, share, h):
    """Keep the first part, a time of h, of a path."""
    power = share
    for i in range(1, ARRIVAL):
        for k in range(path.shape[1]):
            path[i, k] *= power
        power *= share
    for k in range(path.shape[1]):
        path[ARRIVAL, k], path[ARRIVAL + 1, k], path[ARRIVAL + 2, k] = evaluate(path, h, 1.0, k)


@kernel
def leaves_plane(path, y, length, which):
    """Whether an end departs from the vertical plane at y by more than rounding of a motion in a scene of that length."""
    drift = abs(path[0, which.column + 1] - y)
    for i in range(1, 6):
        drift += abs(path[i, which.column + 1])
    return drift > 1e-9 * (length + abs(y))


@kernel
def _mean_speed(path, column, h):
    """Distance between where a path begins and where it ends over the time h between them."""
    square = 0.0
    for k in range(column, column + 3):
        square += (path[1, k] + path[2, k] + path[3, k] + path[4, k] + path[5, k]) ** 2
    return math.sqrt(square) / h


@kernel
def fastest_end(path, h):
    """The larger of both ends' mean speeds on a path."""
    return max(_mean_speed(path, UPPER_END.column, h), _mean_speed(path, LOWER_END.column, h))
