"""The prescribed path of the top within one communication step: a quintic polynomial per axis, continuous to the acceleration.

`path` is (6, 3): coefficients of s^0 ... s^5 with s = (t - t_start)/H.
"""

from cable_model.kernels.header import INPUT, INPUT_STEP, TOP
from cable_model.kernels.jit import kernel


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


@kernel
def evaluate(path, h, s, k):
    """Position, velocity and acceleration of axis k at the fraction s of a step of h."""
    c = path[:, k]
    position = c[0] + s * (c[1] + s * (c[2] + s * (c[3] + s * (c[4] + s * c[5]))))
    velocity = (c[1] + s * (2.0 * c[2] + s * (3.0 * c[3] + s * (4.0 * c[4] + s * 5.0 * c[5])))) / h
    acceleration = (2.0 * c[2] + s * (6.0 * c[3] + s * (12.0 * c[4] + s * 20.0 * c[5]))) / (h * h)
    return position, velocity, acceleration


@kernel
def predict(order, state, inputs, h, end):
    """Where the top will be at the end of a step of h, into `end` (9,), from the inputs (9,) at its start.

    order: 0 only positions are given, 1 positions and velocities, 2 accelerations too.  What is not given is estimated from the
    last inputs, so that position, velocity and acceleration are right to h^3, h^2 and h for smooth motion.
    """
    last = state[INPUT_STEP]
    for k in range(3):
        p = inputs[k]
        v = inputs[3 + k]
        a = inputs[6 + k]
        if order == 0:
            v = 0.0
            a = 0.0
            if last > 0.0:
                # state[INPUT + 3 ...] holds the mean velocity over the step before
                mean = (p - state[INPUT + k]) / last
                a = 0.0
                if state[INPUT + 6 + k] > 0.0:
                    before = state[INPUT + 6 + k]
                    a = 2.0 * (mean - state[INPUT + 3 + k]) / (last + before)
                v = mean + 0.5 * last * a
        elif order == 1:
            a = 0.0
            if last > 0.0:
                a = (v - state[INPUT + 3 + k]) / last
        end[k] = p + h * (v + 0.5 * h * a)
        end[3 + k] = v + h * a
        end[6 + k] = a


@kernel
def remember(order, state, inputs, h):
    """Keep what `predict` needs of these inputs for the next step, and where the top now is."""
    last = state[INPUT_STEP]
    for k in range(3):
        if order == 0:
            if last > 0.0:
                state[INPUT + 3 + k] = (inputs[k] - state[INPUT + k]) / last
                state[INPUT + 6 + k] = last
            state[INPUT + k] = inputs[k]
        else:
            state[INPUT + k] = inputs[k]
            state[INPUT + 3 + k] = inputs[3 + k]
            state[INPUT + 6 + k] = inputs[6 + k]
    state[INPUT_STEP] = h


@kernel
def start_top(order, state, inputs):
    """The top's motion at initialization, from the start values of the inputs."""
    for k in range(9):
        state[TOP + k] = inputs[k]
        state[INPUT + k] = 0.0
    if order < 2:
        for k in range(3):
            state[TOP + 6 + k] = 0.0
    if order < 1:
        for k in range(3):
            state[TOP + 3 + k] = 0.0
    state[INPUT_STEP] = 0.0
