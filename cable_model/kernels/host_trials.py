"""The force of a step whose top has a mass: Newton's method by trials, each of them the whole step from a copy of the state.

The unknown x is the force at the end and its mean, see host.py.  A trial along the path that a guess of x makes gives x as it is caused.
The slope, by which guess less caused changes with the guess, comes from differences, and is kept from step to step: one correction is
enough where it is right.  It is renewed where steps are of another length, and where a correction leaves too much.

A communication step is a loop: `begin_trials`, and after each trial `judge`, until it says something other than AGAIN.
"""

from cable_model.kernels.exchange import MEANS
from cable_model.kernels.header import OK, PENDING
from cable_model.kernels.host import (
    FORCE,
    FORCE_STEP,
    GUESS,
    KEPT,
    OWN,
    SLOPE,
    SLOPE_STEP,
    START,
    STEP,
    TIME,
    close_on_host,
    foretell,
    guess_first,
    keep,
    lay_path,
    lead_outer_force_on,
    learn_outer_force,
    rest_of_path,
    restore,
    settle,
)
from cable_model.kernels.jit import kernel
from cable_model.kernels.vector import add, add_matrix, apply, inverse, load, load_matrix, multiply, scale_matrix, store, sub

AGAIN = -2  # status of a trial that is followed by another, beside those of header and calls

# in the room
AHEAD = OWN  # whether it is the step after this one that is tried
TRIAL = OWN + 1  # which one it is
PASSES = OWN + 2  # corrections so far
RENEWED = OWN + 3  # whether the slope is of this communication step
MISSED = OWN + 4  # largest number of what was missed before the last correction, N
DIFFERENCE = OWN + 5  # of a guess, for a column of the slope, N
CAUSED = OWN + 6  # x as a trial caused it; where one differs, as the trial caused it from which it does

FIRST, CORRECTED = -2.0, -1.0  # trials; 0 to 5: where this number of the guess differs

ALIKE = 1.1  # ratio of steps beyond which the slope is another's
MOST_PASSES = 4
POOR = 0.1  # what a correction may leave of what was missed
LOUD = 1e-3  # of the force: what is missed below it is let be
SHARE = 1e-3  # of the force, by which a guess differs for a column of the slope
MOVED = 1e-6  # of the cable's length, by which the top differs then at least


@kernel
def begin_trials(space, p, time, h, state, outputs, inputs, room, path):
    """The first trial of a step of h under inputs (22,); `path` is that which follows the inputs, of which lay_path leaves a part."""
    learn_outer_force(p[0].host.mass, state, inputs)
    room[TIME], room[STEP], room[AHEAD], room[RENEWED] = time, h, 0.0, 0.0
    lead_outer_force_on(state, room)
    close_on_host(p[0].host.mass, state, inputs, room)
    _begin(space, p, state, outputs, room, path)


@kernel
def _begin(space, p, state, outputs, room, path):
    room[TRIAL], room[PASSES] = FIRST, 0.0
    guess_first(state, room)
    keep(state, outputs, room)
    lay_path(space, p, state, room, path)


@kernel
def judge(space, p, status, state, outputs, room, path):
    """After a trial that has left a status and, where that is OK, state and outputs: AGAIN with the path of the next, or how it ended."""
    if status != OK:
        return status if room[AHEAD] == 0.0 else _end(state, outputs, room, outputs[MEANS : MEANS + 3])
    if state[PENDING] > 0.0 and room[AHEAD] == 0.0:  # no step of the cable's own: nothing to be found, or foretold
        settle(state, outputs, room)
        return OK
    if room[TRIAL] >= 0.0:
        if _fill_column(space, outputs, room):
            _correct(room)
        return _again(space, p, state, outputs, room, path)
    missed, largest = _compare(space, outputs, room)
    if state[PENDING] > 0.0 or (room[TRIAL] == CORRECTED and _is_good(missed, largest, room)):
        return _accept(space, p, state, outputs, room, path)
    known = room[RENEWED] > 0.0 or (room[TRIAL] == FIRST and _holds_for(room[KEPT + SLOPE_STEP], room[STEP]))
    room[MISSED] = missed
    if known:
        _correct(room)
    else:
        _begin_slope(p, largest, room)
    return _again(space, p, state, outputs, room, path)


@kernel
def _again(space, p, state, outputs, room, path):
    restore(state, outputs, room)
    lay_path(space, p, state, room, path)
    return AGAIN


@kernel
def _caused(outputs, k):
    """Number k of x: force at the end, or mean."""
    return outputs[k if k < 3 else MEANS + k - 3]


@kernel
def _compare(space, outputs, room):
    """Keep what the trial caused; how far from the guess it is, and how large."""
    missed = 0.0
    largest = 0.0
    for k in range(6):
        room[CAUSED + k] = _caused(outputs, k)
        if space or k % 3 != 1:
            missed = max(missed, abs(room[CAUSED + k] - room[GUESS + k]))
            largest = max(largest, abs(room[CAUSED + k]), abs(room[GUESS + k]))
    return missed, largest


@kernel
def _is_good(missed, largest, room):
    return missed <= max(POOR * room[MISSED], LOUD * largest) or room[PASSES] >= MOST_PASSES


@kernel
def _holds_for(step, h):
    return step < ALIKE * h and h < ALIKE * step


@kernel
def _accept(space, p, state, outputs, room, path):
    """Go on to the step after this one; or, where that was tried, end."""
    if room[AHEAD] > 0.0:
        return _end(state, outputs, room, room[CAUSED + 3 : CAUSED + 6])
    settle(state, outputs, room)
    for k in range(3):
        state[FORCE + k] = room[START + k]
    state[FORCE_STEP] = room[STEP]
    room[TIME] += room[STEP]
    room[AHEAD] = 1.0
    lead_outer_force_on(state, room)
    rest_of_path(state, room[STEP], path)
    _begin(space, p, state, outputs, room, path)
    return AGAIN


@kernel
def _end(state, outputs, room, mean):
    restore(state, outputs, room)
    foretell(state, outputs, mean, room[STEP])
    return OK


@kernel
def _begin_slope(p, largest, room):
    """Differ in the first number of the guess; in a plane nothing else depends on y."""
    slope = room[KEPT + SLOPE : KEPT + SLOPE + 36].reshape((2, 2, 9))
    for i in range(2):
        for j in range(2):
            for k in range(9):
                slope[i, j, k] = 1.0 if i == j and k % 4 == 0 else 0.0
    h = room[STEP]
    room[KEPT + SLOPE_STEP] = h
    room[DIFFERENCE] = max(SHARE * largest, MOVED * p[0].host.mass * p[0].cable.length / (h * h))
    room[RENEWED], room[TRIAL] = 1.0, 0.0
    room[GUESS] += room[DIFFERENCE]


@kernel
def _fill_column(space, outputs, room):
    """Keep a column of the slope, and differ in the next number; whether all are there."""
    j = int(room[TRIAL])
    slope = room[KEPT + SLOPE : KEPT + SLOPE + 36].reshape((2, 2, 9))
    for k in range(6):
        own = room[DIFFERENCE] if k == j else 0.0
        slope[k // 3, j // 3, 3 * (k % 3) + j % 3] = (own - _caused(outputs, k) + room[CAUSED + k]) / room[DIFFERENCE]
    room[GUESS + j] -= room[DIFFERENCE]
    j += 2 if j % 3 == 0 and not space else 1
    if j > 5:
        return True
    room[GUESS + j] += room[DIFFERENCE]
    room[TRIAL] = float(j)
    return False


@kernel
def _correct(room):
    """Newton's correction of the guess: the slope's blocks, eliminated."""
    room[TRIAL] = CORRECTED
    room[PASSES] += 1.0
    like = (0.0, 0.0, 0.0)
    slope = room[KEPT + SLOPE : KEPT + SLOPE + 36].reshape((2, 2, 9))
    guess, caused = room[GUESS : GUESS + 6].reshape((2, 3)), room[CAUSED : CAUSED + 6].reshape((2, 3))
    first = sub(load(caused, 0, like), load(guess, 0, like))
    second = sub(load(caused, 1, like), load(guess, 1, like))
    above = load_matrix(slope, 0, 1, like)
    pivot = inverse(load_matrix(slope, 0, 0, like))
    lower = multiply(load_matrix(slope, 1, 0, like), pivot)
    rest = inverse(add_matrix(load_matrix(slope, 1, 1, like), scale_matrix(-1.0, multiply(lower, above))))
    mean = apply(rest, sub(second, apply(lower, first)))
    end = apply(pivot, sub(first, apply(above, mean)))
    store(guess, 0, add(load(guess, 0, like), end))
    store(guess, 1, add(load(guess, 1, like), mean))
