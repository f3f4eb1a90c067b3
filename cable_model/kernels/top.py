"""The prescribed path of the top within one communication step: a quintic polynomial per axis, continuous to the acceleration.

`path` is (9, 4): coefficients of s^0 ... s^5 with s = (t - t_start)/H, then position, velocity and acceleration where it ends, which
the coefficients of a sliver give no better than rounding over H and H^2.  Its columns are x, y, z and the length of cable that the
winch has paid out, a parabola: its speed changes linearly.
"""

import math

from cable_model.kernels.header import CLOSING, INPUT_STEPS, INPUTS, PAID_OUT, SHORTEST, STEP, TOP, WINCH_ACCELERATION, WINCH_SPEED
from cable_model.kernels.jit import kernel

WINCH = 3  # column of the path, and of the inputs that are kept
ROWS = 9
PATH = 4 * ROWS  # numbers of a path
ARRIVAL = 6  # first row of where it ends
KEPT = 4  # inputs, see header.INPUTS
NEAR = 0.1  # of the time that is extrapolated over: inputs that are nearer to one another tell little about it, and rounding much


@kernel
def quintic(start, end, h, path):
    """Path from `start` to `end`, (9,) each: position, velocity, acceleration at both ends of a step of h."""
    for k in range(3):
        p0 = start[k]
        v0 = start[3 + k] * h
        a0 = 0.5 * start[6 + k] * h * h
        gap = end[k] - p0 - v0 - a0
        gap_v = end[3 + k] * h - v0 - 2.0 * a0
        gap_a = end[6 + k] * h * h - 2.0 * a0
        path[0, k] = p0
        path[1, k] = v0
        path[2, k] = a0
        path[3, k] = 10.0 * gap - 4.0 * gap_v + 0.5 * gap_a
        path[4, k] = -15.0 * gap + 7.0 * gap_v - gap_a
        path[5, k] = 6.0 * gap - 3.0 * gap_v + 0.5 * gap_a
        for i in range(3):
            path[ARRIVAL + i, k] = end[3 * i + k]


@kernel
def wind(paid_out, speed, end_speed, h, path):
    """The winch's column of the path, from its speeds at both ends of a step of h."""
    path[0, WINCH] = paid_out
    path[1, WINCH] = speed * h
    path[2, WINCH] = 0.5 * (end_speed - speed) * h
    path[3, WINCH] = 0.0
    path[4, WINCH] = 0.0
    path[5, WINCH] = 0.0
    path[ARRIVAL, WINCH] = paid_out + 0.5 * (speed + end_speed) * h
    path[ARRIVAL + 1, WINCH] = end_speed
    path[ARRIVAL + 2, WINCH] = (end_speed - speed) / h


@kernel
def wind_between(paid_out, speed, end_paid_out, h, path):
    """The same from the length paid out at both ends and the speed at the start."""
    wind(paid_out, speed, 2.0 * (end_paid_out - paid_out) / h - speed, h, path)


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
def leaves_plane(path, y, length):
    """Whether the path departs from the vertical plane at y by more than rounding of a motion in a scene of that length."""
    drift = abs(path[0, 1] - y)
    for i in range(1, 6):
        drift += abs(path[i, 1])
    return drift > 1e-9 * (length + abs(y))


@kernel
def mean_speed(path, h):
    """Distance between the ends of a path over the time h between them."""
    square = 0.0
    for k in range(3):
        square += (path[1, k] + path[2, k] + path[3, k] + path[4, k] + path[5, k]) ** 2
    return math.sqrt(square) / h


@kernel
def horizon(state, h):
    """Time over which the top closes on where its inputs lead: a communication step of h, or what is left of an earlier, longer plan.

    Closed within a sliver, the least mismatch would be a shock.
    """
    planned = max(state[CLOSING], state[SHORTEST])
    return planned if planned > h * (1.0 + 1e-9) else h


@kernel
def _told_over(state, at_end, h):
    """Time that inputs must tell something about: that of a plan; where they are given at the end, of an internal step too."""
    planned = horizon(state, h)
    return max(planned, state[STEP]) if at_end else planned


@kernel
def _first_kept(state, h):
    """The newest of the inputs kept that tells something about a time of h: 0, or 1 where the very newest is too near to those now."""
    return 1 if 0.0 < state[INPUT_STEPS] < NEAR * h else 0


@kernel
def _ages(state, newest):
    """Times between the inputs now and up to three before it, from one to the next; 0 where there is none."""
    if newest == 0:
        return state[INPUT_STEPS], state[INPUT_STEPS + 1], state[INPUT_STEPS + 2]
    if state[INPUT_STEPS + 1] == 0.0:
        return 0.0, 0.0, 0.0
    return state[INPUT_STEPS] + state[INPUT_STEPS + 1], state[INPUT_STEPS + 2], state[INPUT_STEPS + 3]


@kernel
def _differences(state, inputs, first, newest, k):
    """Divided differences of order 0 to 3 of axis k over these inputs and up to three before them; 0 where there are too few."""
    h1, h2, h3 = _ages(state, newest)
    row = INPUTS + KEPT * newest + k
    f0 = inputs[first + k]
    f1 = state[row]
    f2 = state[row + KEPT]
    f3 = state[row + 2 * KEPT]
    d1 = 0.0
    d2 = 0.0
    d3 = 0.0
    if h1 > 0.0:
        d1 = (f0 - f1) / h1
    if h2 > 0.0:
        before = (f1 - f2) / h2
        d2 = (d1 - before) / (h1 + h2)
        if h3 > 0.0:
            d3 = (d2 - (before - (f2 - f3) / h3) / (h2 + h3)) / (h1 + h2 + h3)
    return f0, d1, d2, d3


@kernel
def _smoothness(state, inputs, first, newest, low, factor, h):
    """1 where the differences of a signal fall with their order, down to 0 at noise and jumps, which must not be extrapolated."""
    rough = 0.0
    plain = 0.0
    for k in range(3):
        differences = _differences(state, inputs, first, newest, k)
        plain += differences[low] ** 2
        rough += differences[low + 1] ** 2
    if rough == 0.0:
        return 1.0
    ratio = factor * h * math.sqrt(rough)
    plain = math.sqrt(plain)
    return 1.0 - (ratio / plain) ** 8 if ratio < plain else 0.0


@kernel
def predict(order, state, inputs, newest, h, end):
    """Where the top will be a time h after the inputs (9,), into `end` (9,); 0: where it is, what is not given from what is.

    order: 0 only positions are given, 1 positions and velocities, 2 accelerations too.  The highest that is given is extrapolated by
    the polynomial through its last values (Newton's divided differences; cubic for positions, parabola for velocities, line for
    accelerations), by one degree less where they are not smooth.  Then position, velocity and acceleration are right to h^4, h^3 and h^2.
    """
    first = 3 * order
    a, b, _ = _ages(state, newest)
    b += a
    smooth = 1.0
    if h > 0.0:
        smooth = _smoothness(state, inputs, first, newest, 2 - order, 3.0 - order, h)
    for k in range(3):
        f, d1, d2, d3 = _differences(state, inputs, first, newest, k)
        p = inputs[k]
        if order == 0:
            d3 *= smooth
            end[k] = f + h * (d1 + (h + a) * (d2 + (h + b) * d3))
            end[3 + k] = d1 + (2.0 * h + a) * d2 + (3.0 * h * h + 2.0 * (a + b) * h + a * b) * d3
            end[6 + k] = 2.0 * d2 + (6.0 * h + 2.0 * (a + b)) * d3
        elif order == 1:
            d2 *= smooth
            end[k] = p + h * (f + 0.5 * h * (d1 + a * d2) + h * h / 3.0 * d2)
            end[3 + k] = f + h * (d1 + (h + a) * d2)
            end[6 + k] = d1 + (2.0 * h + a) * d2
        else:
            d1 *= smooth
            v = inputs[3 + k]
            end[k] = p + h * (v + 0.5 * h * (f + h / 3.0 * d1))
            end[3 + k] = v + h * (f + 0.5 * h * d1)
            end[6 + k] = f + h * d1


@kernel
def follow_inputs(order, p, state, inputs, h, end, path):
    """The path over a step of h that inputs (10,) ask for, given at its start or, by top.inputs_at, at its end; `end` (9,) is scratch."""
    if p[0].top.inputs_at > 0.0:
        _arrive(order, state, inputs, h, end, path)
    else:
        _lead_on(order, state, inputs, h, end, path)


@kernel
def _arrive(order, state, inputs, h, end, path):
    """The path that ends exactly where the inputs are; those kept get older by the step."""
    state[INPUT_STEPS] += h
    predict(order, state, inputs, _first_kept(state, _told_over(state, True, h)), 0.0, end)
    quintic(state[TOP : TOP + 9], end, h, path)
    wind(state[PAID_OUT], state[WINCH_SPEED], inputs[9], h, path)


@kernel
def _lead_on(order, state, inputs, h, end, path):
    """The path to where the top will be after `horizon`, of which a shorter step goes a part.

    The winch's speed goes on to where the line through its last two inputs leads.
    """
    whole = horizon(state, h)
    newest = _first_kept(state, whole)
    predict(order, state, inputs, newest, whole, end)
    quintic(state[TOP : TOP + 9], end, whole, path)
    age, _, _ = _ages(state, newest)
    ahead = 0.0
    if age > 0.0:
        ahead = (inputs[9] - state[INPUTS + KEPT * newest + WINCH]) * whole / age
    wind(state[PAID_OUT], state[WINCH_SPEED], inputs[9] + ahead, whole, path)
    if whole > h:
        _shorten(path, h / whole, h)


@kernel
def _shorten(path, share, h):
    """Keep the first part, a time of h, of a path."""
    power = share
    for i in range(1, ARRIVAL):
        for k in range(path.shape[1]):
            path[i, k] *= power
        power *= share
    for k in range(path.shape[1]):
        path[ARRIVAL, k], path[ARRIVAL + 1, k], path[ARRIVAL + 2, k] = evaluate(path, h, 1.0, k)


@kernel
def remember(order, p, state, inputs, h):
    """Keep what `predict` needs of these inputs for the steps after this one of h, and how much of its plan is left."""
    at_end = p[0].top.inputs_at > 0.0
    since = 0.0 if at_end else h  # from these inputs to the next step's, or to the next step
    near = _first_kept(state, _told_over(state, at_end, h)) == 1
    state[CLOSING] = max(horizon(state, h) - h, h)
    if near:  # to those kept, which stay
        state[INPUT_STEPS] += since
        return
    for i in range(3, 0, -1):
        state[INPUT_STEPS + i] = state[INPUT_STEPS + i - 1]
        for k in range(KEPT):
            state[INPUTS + KEPT * i + k] = state[INPUTS + KEPT * (i - 1) + k]
    state[INPUT_STEPS] = since
    _keep_newest(order, state, inputs)


@kernel
def _keep_newest(order, state, inputs):
    for k in range(3):
        state[INPUTS + k] = inputs[3 * order + k]
    state[INPUTS + WINCH] = inputs[9]


@kernel
def start_top(order, p, state, inputs):
    """The top's motion at initialization, from the start values of the inputs."""
    for k in range(9):
        state[TOP + k] = inputs[k]
    if order < 2:
        for k in range(3):
            state[TOP + 6 + k] = 0.0
    if order < 1:
        for k in range(3):
            state[TOP + 3 + k] = 0.0
    state[PAID_OUT] = 0.0
    state[WINCH_SPEED] = inputs[9]
    state[WINCH_ACCELERATION] = 0.0
    for k in range(INPUTS, INPUT_STEPS + KEPT):
        state[k] = 0.0
    if p[0].top.inputs_at > 0.0:
        _keep_newest(order, state, inputs)
    state[CLOSING] = 0.0
    state[SHORTEST] = 0.0
