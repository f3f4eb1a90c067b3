"""Whether the exchange with a host rings: a force that is held while the host moves, and a motion that is led on, can feed the cable.

From each communication step three histories are kept: the force that the host was told, its mean as it then was, and the velocities of the
cable's top and of the host.  Their kinks, what they differ by from the line through the two steps before, leave the smooth motion out.
The energy that the exchange makes of kinks, in a window, over that of the kinks of the force in the cable (their mean square times
L/EA) is twice a rate of growth.  It is taken as the host moves and as the top does, and the larger one counts: where steps are long, each
misses what happens within them.  A host whose motion is given feeds a cable too, with what its inputs do not resolve; one that rings
follows the force: the kinks of its accelerations go with those of the force.  Nothing here changes a number of the model.
"""

import math

from cable_model.kernels.exchange import GROWTH, MEAN, TOLD
from cable_model.kernels.header import PAID_OUT, RINGING, TOP
from cable_model.kernels.jit import kernel
from cable_model.kernels.watch import LAST, RINGS, SPAN, note

ROW = 13  # of a step: force told, its mean, velocity of the top, that of the host (3 each), and its length
ROWS = 4  # of steps, the newest first
BEGUN = RINGING + ROWS * ROW  # force told and place of the top at the start of the step that is made
SUMS = BEGUN + 6  # of the window: energy by the host's way and by the top's, squared kinks of the force, force, time, steps,
FOLLOWED = SUMS + 6  # and products of kinks of the force told and of the host's acceleration: of both, of each with itself
HITS = SUMS + 9  # windows in a row that ring
KNOWN = SUMS + 10  # steps in a row whose lengths are alike

WINDOW = 2.0  # s
FEWEST = 8  # steps in a window
LOUD = 0.02  # of the force: kinks below it are those of a smooth motion
FED = 0.05  # 1/s: what a cable damps by itself
COHERENT = 0.4  # of 1, the most, where all of the acceleration is the force's
IN_A_ROW = 2  # windows
ALIKE = 2.0  # ratio of steps that follow one another: beyond it, kinks are those of the steps


@kernel
def _kink(now, before, older, reach):
    return 0.25 * (now - before - reach * (before - older))


@kernel
def _close_window(p, state):
    """Growth over the window, and whether it has rung long enough."""
    time = state[SUMS + 4]
    square = state[SUMS + 2] / time
    share = math.sqrt(square) * time / max(state[SUMS + 3], 1e-300)
    compliance = (p[0].cable.length + state[PAID_OUT]) / p[0].cable.axial_stiffness
    state[GROWTH] = 0.0
    if share > LOUD:
        state[GROWTH] = max(state[SUMS], state[SUMS + 1]) / (2.0 * square * compliance * time)
    size = math.sqrt(state[FOLLOWED + 1] * state[FOLLOWED + 2])
    if state[FOLLOWED] <= COHERENT * size:
        state[GROWTH] = 0.0
    state[HITS] = state[HITS] + 1.0 if state[GROWTH] > FED else 0.0
    if state[HITS] >= IN_A_ROW:
        note(state, RINGS, share, state[GROWTH])
    for k in range(HITS - SUMS):
        state[SUMS + k] = 0.0


@kernel
def _add_kinks(p, state):
    """Count the newest step, and close the window where it is full."""
    new = state[RINGING : RINGING + ROW]
    before = state[RINGING + ROW : RINGING + 2 * ROW]
    older = state[RINGING + 2 * ROW : RINGING + 3 * ROW]
    oldest = state[RINGING + 3 * ROW : RINGING + 4 * ROW]
    h = new[ROW - 1]
    reach = (h + before[ROW - 1]) / (before[ROW - 1] + older[ROW - 1])
    size = 0.0
    for k in range(3):
        told = _kink(new[k], before[k], older[k], reach)
        mean = _kink(new[3 + k], before[3 + k], older[3 + k], reach)
        top = _kink(new[6 + k], before[6 + k], older[6 + k], reach)
        host = _kink(new[9 + k], before[9 + k], older[9 + k], reach)
        force = _kink(state[TOLD + k], new[k], before[k], h / before[ROW - 1])
        state[SUMS] += h * (told * host - mean * top)
        state[SUMS + 1] += h * (told - mean) * top
        state[SUMS + 2] += h * force * force
        size += state[TOLD + k] ** 2
        pulled = _kink(new[k] + before[k], before[k] + older[k], older[k] + oldest[k], reach)
        hurried = _kink(new[9 + k] - before[9 + k], before[9 + k] - older[9 + k], older[9 + k] - oldest[9 + k], reach)
        state[FOLLOWED] += pulled * hurried
        state[FOLLOWED + 1] += pulled * pulled
        state[FOLLOWED + 2] += hurried * hurried
    state[SUMS + 3] += h * math.sqrt(size)
    state[SUMS + 4] += h
    state[SUMS + 5] += 1.0
    if state[SUMS + 4] >= WINDOW * (1.0 - 1e-9) and state[SUMS + 5] >= FEWEST:
        _close_window(p, state)


@kernel
def watch_ringing(p, state, inputs):
    """Look at the last communication step, now that inputs (10,) say how the host moved in it; before watch_inputs."""
    h = state[SPAN]
    if h > 0.0:
        at_end = p[0].top.inputs_at > 0.0  # then the top moved as the host did
        state[RINGING + ROW - 1] = h
        for k in range(3):
            moved = state[TOP + k] - state[BEGUN + 3 + k]
            state[RINGING + k] = state[BEGUN + k]
            state[RINGING + 3 + k] = state[MEAN + k]
            state[RINGING + 6 + k] = moved / h
            state[RINGING + 9 + k] = moved / h if at_end else (inputs[k] - state[LAST + k]) / h
        last = state[RINGING + 2 * ROW - 1]
        alike = last < ALIKE * h and h < ALIKE * last
        state[KNOWN] = state[KNOWN] + 1.0 if alike else 0.0
        if state[KNOWN] >= ROWS - 1:
            _add_kinks(p, state)
        for k in range(ROWS * ROW - 1, ROW - 1, -1):
            state[RINGING + k] = state[RINGING + k - ROW]
    for k in range(3):
        state[BEGUN + k] = state[TOLD + k]
        state[BEGUN + 3 + k] = state[TOP + k]
