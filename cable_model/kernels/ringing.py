"""Whether the exchange with a host rings: a force that is held while the host moves, and a motion that is led on, can feed the cable.

From each communication step forces and velocities are kept, of the cable's top and of the host.  Their kinks, what they differ by from the
line through the two steps before, leave the smooth motion out.  A host that rings follows the force: of the three forces that it may hold
over a step, it is taken to hold the one that the kinks of its accelerations go with best.  The energy that the exchange then makes of
kinks, in a window, over that of the kinks of the force in the cable (their mean square times L/EA) is twice a rate of growth.  It is taken
as the host moves and as the top does, and the larger one counts: where steps are long, each misses what happens within them.  A host whose
motion is given feeds a cable too, with what its inputs do not resolve; it follows no force, but short irregular motions may seem to.  The
slow swing of a vessel on the cable's own spring has no kinks, and is not seen.  Nothing here changes a number of the model.
"""

import math

from cable_model.kernels.exchange import GROWTH, MEAN, NEXT, TOLD
from cable_model.kernels.header import PAID_OUT, RINGING, TOP
from cable_model.kernels.jit import kernel
from cable_model.kernels.watch import LAST, RINGS, SPAN, note

HELD = 3  # forces that a host may hold: that told before the step, the mean of the step (the cable steps first), that of the one before
TOP_SPEED = 3 * HELD  # places in a row: velocity of the top, that of the host, the step
HOST_SPEED = TOP_SPEED + 3
LENGTH = TOP_SPEED + 6
ROW = LENGTH + 1  # numbers of a step: the forces that may be held come first
ROWS = 4  # steps, the newest first
BEGUN = RINGING + ROWS * ROW  # force told and place of the top at the start of the step that is made
SUMS = BEGUN + 6  # of the window, PER_FORCE for each of the forces that may be held
PER_FORCE = 4  # energy by the host's way, by the top's; products of the kinks of force and acceleration, and of the force with itself
HURRIED = SUMS + PER_FORCE * HELD  # product of the kinks of the host's acceleration with themselves
KINKED = HURRIED + 1  # square of the kinks of the force
SIZE = HURRIED + 2  # of the force
TIME = HURRIED + 3
COUNT = HURRIED + 4
HITS = HURRIED + 5  # windows in a row that ring
KNOWN = HURRIED + 6  # steps in a row whose lengths are alike

WINDOW = 2.0  # s
FEWEST = 8  # steps in a window
LOUD = 0.02  # of the force: kinks below it are those of a smooth motion
FED = 0.05  # 1/s: what a cable damps by itself
COHERENT = 0.5  # of 1, the most, where all of the acceleration is the force's
IN_A_ROW = 2  # windows
ALIKE = 2.0  # ratio of steps that follow one another: beyond it, kinks are those of the steps


@kernel
def _kink(now, before, older, reach):
    return 0.25 * (now - before - reach * (before - older))


@kernel
def _fed(state):
    """Energy that the exchange makes of kinks where the host follows one of the forces; 0 where it follows none."""
    best = COHERENT
    found = 0.0
    for j in range(HELD):
        of = state[SUMS + PER_FORCE * j : SUMS + PER_FORCE * (j + 1)]
        share = of[2] / max(math.sqrt(of[3] * state[HURRIED]), 1e-300)
        if share > best:
            best = share
            found = max(of[0], of[1])
    return found


@kernel
def _close_window(p, state):
    """Growth over the window, and whether it has rung long enough."""
    time = state[TIME]
    square = state[KINKED] / time
    share = math.sqrt(square) * time / max(state[SIZE], 1e-300)
    compliance = (p[0].cable.length + state[PAID_OUT]) / p[0].cable.axial_stiffness
    state[GROWTH] = 0.0
    if share > LOUD:
        state[GROWTH] = _fed(state) / (2.0 * square * compliance * time)
    state[HITS] = state[HITS] + 1.0 if state[GROWTH] > FED else 0.0
    if state[HITS] >= IN_A_ROW:
        note(state, RINGS, share, state[GROWTH])
    for k in range(SUMS, HITS):
        state[k] = 0.0


@kernel
def _add_kinks(p, state):
    """Count the newest step, and close the window where it is full."""
    new = state[RINGING : RINGING + ROW]
    before = state[RINGING + ROW : RINGING + 2 * ROW]
    older = state[RINGING + 2 * ROW : RINGING + 3 * ROW]
    oldest = state[RINGING + 3 * ROW : RINGING + 4 * ROW]
    h = new[LENGTH]
    reach = (h + before[LENGTH]) / (before[LENGTH] + older[LENGTH])
    size = 0.0
    for k in range(3):
        i = HOST_SPEED + k
        host = _kink(new[i], before[i], older[i], reach)
        hurried = _kink(new[i] - before[i], before[i] - older[i], older[i] - oldest[i], reach)
        i = TOP_SPEED + k
        top = _kink(new[i], before[i], older[i], reach)
        mean = _kink(new[3 + k], before[3 + k], older[3 + k], reach)
        force = _kink(state[NEXT + k], new[k], before[k], h / before[LENGTH])
        for j in range(HELD):
            i = 3 * j + k
            held = _kink(new[i], before[i], older[i], reach)
            pulled = _kink(new[i] + before[i], before[i] + older[i], older[i] + oldest[i], reach)
            at = SUMS + PER_FORCE * j
            state[at] += h * (held * host - mean * top)
            state[at + 1] += h * (held - mean) * top
            state[at + 2] += pulled * hurried
            state[at + 3] += pulled * pulled
        state[HURRIED] += hurried * hurried
        state[KINKED] += h * force * force
        size += state[TOLD + k] ** 2
    state[SIZE] += h * math.sqrt(size)
    state[TIME] += h
    state[COUNT] += 1.0
    if state[TIME] >= WINDOW * (1.0 - 1e-9) and state[COUNT] >= FEWEST:
        _close_window(p, state)


@kernel
def watch_ringing(p, state, inputs):
    """Look at the last communication step, now that inputs (19,) say how the host moved in it; before watch_inputs."""
    h = state[SPAN]
    if h > 0.0:
        at_end = p[0].top.inputs_at > 0.0  # then the top moved as the host did
        row = state[RINGING : RINGING + ROW]
        before = state[RINGING + ROW : RINGING + 2 * ROW]
        row[LENGTH] = h
        for k in range(3):
            moved = state[TOP + k] - state[BEGUN + 3 + k]
            row[k] = state[BEGUN + k]
            row[3 + k] = state[MEAN + k]
            row[6 + k] = before[3 + k]
            row[TOP_SPEED + k] = moved / h
            row[HOST_SPEED + k] = moved / h if at_end else (inputs[k] - state[LAST + k]) / h
        alike = before[LENGTH] < ALIKE * h and h < ALIKE * before[LENGTH]
        state[KNOWN] = state[KNOWN] + 1.0 if alike else 0.0
        if state[KNOWN] >= ROWS:
            _add_kinks(p, state)
        for k in range(ROWS * ROW - 1, ROW - 1, -1):
            state[RINGING + k] = state[RINGING + k - ROW]
    for k in range(3):
        state[BEGUN + k] = state[NEXT + k]
        state[BEGUN + 3 + k] = state[TOP + k]
