"""Whether the exchange with a host rings: a force that is held while the host moves, and a motion that is led on, can feed the cable.

From each communication step forces and velocities are kept, of the cable's top and of the host.  Their kinks, what they differ by from the
line through the two steps before, leave the smooth motion out.  A host that rings follows the force: of the three forces that it may hold
over a step, it is taken to hold the one that the kinks of its accelerations go with best.  The energy that the exchange then makes of
kinks, in a window, over that of the kinks of the force in the cable (their mean square times L/EA) is twice a rate of growth.  It is taken
as the host moves and as the top does, and the larger one counts: where steps are long, each misses what happens within them.  A host whose
motion is given feeds a cable too, with what its inputs do not resolve; it follows no force, but short irregular motions may seem to.  The
slow swing of a vessel on the cable's own spring has no kinks, and is not seen.  Nothing here changes a number of the model.

Both ends are looked at where the lower one is driven; `kept` is what the state keeps of one of them.
"""

import math

from cable_model.kernels import watch
from cable_model.kernels.doubt import RINGS, note
from cable_model.kernels.exchange import GROWTH, MEAN, NEXT, TO_LOWER, TOLD
from cable_model.kernels.header import LOWER_RINGING, PAID_OUT, PARTED, RINGING, WHOLE
from cable_model.kernels.jit import kernel
from cable_model.kernels.path import LOWER_END, UPPER_END
from cable_model.kernels.watch import LAST, SPAN

HELD = 3  # forces that a host may hold: that told before the step, the mean of the step (the cable steps first), that of the one before
END_SPEED = 3 * HELD  # places in a row: velocity of the cable's end, that of the host, the step
HOST_SPEED = END_SPEED + 3
LENGTH = END_SPEED + 6
ROW = LENGTH + 1  # numbers of a step: the forces that may be held come first
ROWS = 4  # steps, the newest first
BEGUN = ROWS * ROW  # force told and place of the end at the start of the step that is made
SUMS = BEGUN + 6  # of the window, PER_FORCE for each of the forces that may be held
PER_FORCE = 4  # energy by the host's way, by the top's; products of the kinks of force and acceleration, and of the force with itself
HURRIED = SUMS + PER_FORCE * HELD  # product of the kinks of the host's acceleration with themselves
KINKED = HURRIED + 1  # square of the kinks of the force
SIZE = HURRIED + 2  # of the force
TIME = HURRIED + 3
COUNT = HURRIED + 4
HITS = HURRIED + 5  # windows in a row that ring
KNOWN = HURRIED + 6  # steps in a row whose lengths are alike
GROWS = HURRIED + 7  # rate of growth over the last window, 1/s
KEPT = GROWS + 1  # numbers that are kept of an end

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
def _fed(kept):
    """Energy that the exchange makes of kinks where the host follows one of the forces; 0 where it follows none."""
    best = COHERENT
    found = 0.0
    for j in range(HELD):
        of = kept[SUMS + PER_FORCE * j : SUMS + PER_FORCE * (j + 1)]
        share = of[2] / max(math.sqrt(of[3] * kept[HURRIED]), 1e-300)
        if share > best:
            best = share
            found = max(of[0], of[1])
    return found


@kernel
def _close_window(p, kept, state):
    """Growth over the window, and whether it has rung long enough."""
    time = kept[TIME]
    square = kept[KINKED] / time
    share = math.sqrt(square) * time / max(kept[SIZE], 1e-300)
    compliance = (p[0].cable.length + state[PAID_OUT]) / p[0].cable.axial_stiffness
    kept[GROWS] = 0.0
    if share > LOUD:
        kept[GROWS] = _fed(kept) / (2.0 * square * compliance * time)
    kept[HITS] = kept[HITS] + 1.0 if kept[GROWS] > FED else 0.0
    if kept[HITS] >= IN_A_ROW:
        note(state, RINGS, share, kept[GROWS])
    for k in range(SUMS, HITS):
        kept[k] = 0.0


@kernel
def _add_kinks(p, kept, told, force, state):
    """Count the newest step, and close the window where it is full; `told` (3,) is the force that is held from now on, `force` that now."""
    new = kept[0:ROW]
    before = kept[ROW : 2 * ROW]
    older = kept[2 * ROW : 3 * ROW]
    oldest = kept[3 * ROW : 4 * ROW]
    h = new[LENGTH]
    reach = (h + before[LENGTH]) / (before[LENGTH] + older[LENGTH])
    size = 0.0
    for k in range(3):
        i = HOST_SPEED + k
        host = _kink(new[i], before[i], older[i], reach)
        hurried = _kink(new[i] - before[i], before[i] - older[i], older[i] - oldest[i], reach)
        i = END_SPEED + k
        end = _kink(new[i], before[i], older[i], reach)
        mean = _kink(new[3 + k], before[3 + k], older[3 + k], reach)
        kink = _kink(told[k], new[k], before[k], h / before[LENGTH])
        for j in range(HELD):
            i = 3 * j + k
            held = _kink(new[i], before[i], older[i], reach)
            pulled = _kink(new[i] + before[i], before[i] + older[i], older[i] + oldest[i], reach)
            at = SUMS + PER_FORCE * j
            kept[at] += h * (held * host - mean * end)
            kept[at + 1] += h * (held - mean) * end
            kept[at + 2] += pulled * hurried
            kept[at + 3] += pulled * pulled
        kept[HURRIED] += hurried * hurried
        kept[KINKED] += h * kink * kink
        size += force[k] ** 2
    kept[SIZE] += h * math.sqrt(size)
    kept[TIME] += h
    kept[COUNT] += 1.0
    if kept[TIME] >= WINDOW * (1.0 - 1e-9) and kept[COUNT] >= FEWEST:
        _close_window(p, kept, state)


@kernel
def _watch_end(which, kept, told, force, means, last, p, state, inputs):
    """Look at an end: forces (3,) to be held from now on, now, and in the mean of the last step; `last` (9,) the inputs of that step."""
    h = state[SPAN]
    motion, given = state[which.motion : which.motion + 9], inputs[which.given : which.given + 9]
    if h > 0.0:
        at_end = p[0].top.inputs_at > 0.0  # then the end moved as the host did
        row = kept[0:ROW]
        before = kept[ROW : 2 * ROW]
        row[LENGTH] = h
        for k in range(3):
            moved = motion[k] - kept[BEGUN + 3 + k]
            row[k] = kept[BEGUN + k]
            row[3 + k] = means[k]
            row[6 + k] = before[3 + k]
            row[END_SPEED + k] = moved / h
            row[HOST_SPEED + k] = moved / h if at_end else (given[k] - last[k]) / h
        alike = before[LENGTH] < ALIKE * h and h < ALIKE * before[LENGTH]
        kept[KNOWN] = kept[KNOWN] + 1.0 if alike else 0.0
        if kept[KNOWN] >= ROWS:
            _add_kinks(p, kept, told, force, state)
        for k in range(ROWS * ROW - 1, ROW - 1, -1):
            kept[k] = kept[k - ROW]
    for k in range(3):
        kept[BEGUN + k] = told[k]
        kept[BEGUN + 3 + k] = motion[k]


@kernel
def watch_ringing(p, state, inputs):
    """Look at the last communication step, now that inputs (22,) say how the hosts moved in it; before watch_inputs."""
    top, last = state[RINGING : RINGING + KEPT], state[LAST : LAST + 9]
    _watch_end(UPPER_END, top, state[NEXT : NEXT + 3], state[TOLD : TOLD + 3], state[MEAN : MEAN + 3], last, p, state, inputs)
    state[GROWTH] = top[GROWS]
    if p[0].lower_end.driven > 0.0 and state[PARTED] == WHOLE:
        lower, at, mean, before = state[LOWER_RINGING : LOWER_RINGING + KEPT], TO_LOWER + TOLD, TO_LOWER + MEAN, watch.TO_LOWER + LAST
        force, last = state[at : at + 3], state[before : before + 9]
        _watch_end(LOWER_END, lower, force, force, state[mean : mean + 3], last, p, state, inputs)
        state[GROWTH] = max(state[GROWTH], lower[GROWS])
