"""Time that waits: communication steps too short for an internal step of their own are pending, and join the next internal step.

Over a sliver the differences of velocities and tensions that the chain predicts from are rounding, and every step far shorter than the one
before excites what the mesh does not resolve.  So nothing is integrated over pending time.  Outputs lead on from the last internal step by
its rates; the step that ends the waiting begins where the last one ended, with the ends on quintics (the bridge) from there to where they
are.
"""

import math

from cable_model.kernels.error_control import GROWTH
from cable_model.kernels.header import (
    KEPT_LOWER,
    KEPT_PAID_OUT,
    KEPT_STREAM,
    KEPT_TOP,
    KEPT_WINCH_SPEED,
    LAG,
    LAG_BEFORE,
    LOWER,
    PAID_OUT,
    PENDING,
    SHORTEST,
    STEP,
    STREAM,
    TOP,
    WINCH_SPEED,
)
from cable_model.kernels.jit import kernel
from cable_model.kernels.path import CARRIED, LOWER_END, UPPER_END, arrival, evaluate, glide, quintic, wind_between

SHORT = 0.6  # of an internal step: what is shorter than that waits; at a half, a host that halves its steps would lead the chain to slivers

EXCEEDED = 0.25  # of solver.time_step: by so much a step may be longer to which pending time is added
HALVED = math.sqrt(1.6)  # internal steps: pending time and a communication step that are longer together are two steps
LAST = 1.0 - 1e-9  # of a path: from there on it has ended


@kernel
def is_short(state, total, step):
    """Whether time of `total` waits, after or instead of an internal step of `step`."""
    return total < max(state[SHORTEST], SHORT * step)


@kernel
def equal_step(time_step, last, pending, span):
    """The fewest equal parts of the pending time and a communication step that are not longer than an internal step may be.

    Two parts where they are nearer to the last step, in their squares, than the whole is: as the truncation errors go, so are the kicks.
    """
    if pending == 0.0:
        return span / max(1, math.ceil(span / time_step - 1e-9))
    total = pending + span
    fewest = 2 if HALVED * last < total < GROWTH * last else 1
    return total / max(fewest, math.ceil(total / time_step - EXCEEDED))


@kernel
def wait(state, span, path):
    """Count a communication step as pending; the first one says where the ends were when the waiting began."""
    if state[PENDING] == 0.0:
        for kept, column in ((KEPT_TOP, UPPER_END.column), (KEPT_LOWER, LOWER_END.column)):
            for k in range(3):
                state[kept + k], state[kept + 3 + k], state[kept + 6 + k] = evaluate(path, span, 0.0, column + k)
        state[KEPT_PAID_OUT] = state[PAID_OUT]
        state[KEPT_WINCH_SPEED] = state[WINCH_SPEED]
        for k in range(2):
            state[KEPT_STREAM + k] = state[STREAM + k]
    state[PENDING] += span


@kernel
def build_bridge(state, bridge):
    """Path of the ends, the winch and the stream over the pending time."""
    pending = state[PENDING]
    if pending > 0.0:
        quintic(state[KEPT_TOP : KEPT_TOP + 9], state[TOP : TOP + 9], pending, bridge, UPPER_END.column)
        quintic(state[KEPT_LOWER : KEPT_LOWER + 9], state[LOWER : LOWER + 9], pending, bridge, LOWER_END.column)
        wind_between(state[KEPT_PAID_OUT], state[KEPT_WINCH_SPEED], state[PAID_OUT], pending, bridge)
        for k in range(2):
            glide(CARRIED + k, 0.0, state[KEPT_STREAM + k], state[STREAM + k], pending, bridge)


@kernel
def followed(path, span, bridge, pending, time, k):
    """Position, velocity and acceleration of axis k at `time` from the start of the path; before it the bridge leads there."""
    if time < 0.0:
        return evaluate(bridge, pending, 1.0 + time / pending, k)
    if time >= LAST * span:
        return arrival(path, k)
    return evaluate(path, span, time / span, k)


@kernel
def tensions_ahead(state, c):
    """From the averaged time of the last internal step to now, over the time between the averaged times of the last two; 0 before it."""
    last, lag, lag_before, pending = state[STEP], state[LAG], state[LAG_BEFORE], state[PENDING]
    if lag == lag_before == c.alpha_k * last and pending == 0.0:
        return c.alpha_k
    if last == 0.0:
        return 0.0
    return (lag + pending) / (last - lag + lag_before)


@kernel
def ahead_to_end(state, c, h):
    """The same to the end of a step of h that is not taken yet: from its averaged time, over that from the step before's."""
    lag = c.alpha_k * h
    return lag / (h - lag + state[LAG])
