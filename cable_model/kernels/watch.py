"""How the ends of a cable are moved, looked at once a communication step: see doubt.py."""

import math

from cable_model.kernels.doubt import COARSE, FEWEST, FEWEST_STEPS, GRAVITY, JUMP, KICK, KICKED, LOWER_JUMP, PERIODS, TOUCHED, note
from cable_model.kernels.ends import horizon
from cable_model.kernels.header import AUDIT, DOUBT, DOUBTS, LOWER_WATCH, PARTED, STEP, STREAM, WATCH, WHOLE
from cable_model.kernels.jit import kernel
from cable_model.kernels.path import LOWER_END, UPPER_END

# of the top; those of a driven lower end, all but SPAN and WAVES_SEEN, lie TO_LOWER after them: `end` in what follows is 0 or TO_LOWER
TO_LOWER = LOWER_WATCH - WATCH
LAST = WATCH  # 9 numbers: the inputs of the last communication step
SPAN = WATCH + 9  # its length, s; 0 before the first
FASTEST = WATCH + 10  # speed of the end so far, m/s
GONE = WATCH + 11  # how far position and velocity went, in sum
MISSED = WATCH + 13  # and what their rates do not explain of it
FARTHEST = WATCH + 15  # and the longer of both in a step
MOVING = WATCH + 17  # time in which it has moved, s
SPEEDS = WATCH + 18  # squares of its velocity, summed over that time, m2/s
RATES = WATCH + 19  # and of its acceleration, m2/s3
MISSING = WATCH + 20  # time in which what was led on missed the inputs by more than KICK
SIDEWAYS = WATCH + 21  # as SPEEDS, across the cable of the tow model
WAVES_SEEN = WATCH + 22  # whether the waves have been held against the internal step

SOON = 5.0  # m/s, at which a top may set off that has stood still
UNEXPLAINED = 0.5  # share of the way: a sine at five steps a period has 0.14, a rate that stays 0 has 1, one of the wrong sign 2
SLOWEST = 1e-2  # of sqrt(g length): changes of velocity below it say nothing
SEVERAL = 6.0  # times the longest of a step: a motion that begins by a power of time goes farther in each step than in all before
RESTING = 1e-9  # of a free fall over the cable's length: a top with a mass that rests is moved by rounding


@kernel
def _apart(inputs, last, first, h, share):
    """Way of three signals in h, and how far it is from h times their rates, the signals three places on: `share` of the new ones."""
    way = 0.0
    missed = 0.0
    for k in range(3):
        moved = inputs[first + k] - last[first + k]
        rate = share * inputs[first + 3 + k] + (1.0 - share) * last[first + 3 + k]
        way += moved * moved
        missed += (moved - h * rate) ** 2
    return math.sqrt(way), math.sqrt(missed)


@kernel
def watch_start(state, inputs):
    """Begin with the inputs (22,) of the initialization, after it."""
    for k in range(DOUBTS, AUDIT):
        state[k] = 0.0
    for k in range(LOWER_WATCH, STREAM):
        state[k] = 0.0
    for k in range(9):
        state[LAST + k] = inputs[k]
        state[TO_LOWER + LAST + k] = inputs[LOWER_END.given + k]


@kernel
def watch_inputs(order, p, state, inputs, step):
    """Compare the inputs (22,) of a step with the last ones: top.motion_order `order` says which of them are given."""
    _watch_end(UPPER_END, 0, JUMP, order, p, state, inputs, step)
    if p[0].lower_end.driven > 0.0 and state[PARTED] == WHOLE:
        _watch_end(LOWER_END, TO_LOWER, LOWER_JUMP, order, p, state, inputs, step)
    state[SPAN] = step


@kernel
def _watch_end(which, end, jump, order, p, state, inputs, step):
    """The same for one end; `jump` is the first of its three kinds of doubt, the others follow it."""
    length = p[0].cable.length
    last = state[end + LAST : end + LAST + 9]
    given = inputs[which.given : which.given + 9]
    fastest, gone, missed_at, farthest = end + FASTEST, end + GONE, end + MISSED, end + FARTHEST
    h = step if p[0].top.inputs_at > 0.0 else state[SPAN]
    reach = max(h, step)
    way, gap = _apart(given, last, 0, h, 0.0)
    if order == 0:
        gap = way
    else:
        state[fastest] = max(state[fastest], math.sqrt(given[3] ** 2 + given[4] ** 2 + given[5] ** 2))
    unknown = SOON if state[fastest] == 0.0 else 0.0
    allowed = reach * (3.0 * state[fastest] + unknown + 0.5 * GRAVITY * reach) + FEWEST * length
    if h == 0.0:
        allowed = TOUCHED * length
    if gap > allowed:
        note(state, jump, gap, reach)
    elif h > 0.0:
        state[fastest] = max(state[fastest], way / h)
        for level in range(order):
            way, missed = _apart(given, last, 3 * level, h, 0.5)
            state[gone + level] += way
            state[missed_at + level] += missed
            state[farthest + level] = max(state[farthest + level], way, missed)
            scale = FEWEST * length if level == 0 else SLOWEST * math.sqrt(GRAVITY * length)
            enough = max(UNEXPLAINED * state[gone + level], scale)
            if state[missed_at + level] > enough and state[gone + level] + state[missed_at + level] > SEVERAL * state[farthest + level]:
                note(state, jump + 1 + level, state[gone + level], state[missed_at + level])
        _watch_motion(which, end, jump, order, p, state, given, step)
    for k in range(9):
        last[k] = given[k]


@kernel
def _watch_motion(which, end, jump, order, p, state, given, step):
    """The motion that was led on to these inputs: its frequency against the internal step, and by how much it missed them.

    A velocity that is missed by dv, and caught up with within a step of h, sends a wave of sqrt(EA m) dv through the cable, or stretches
    all of it by what it is behind, h dv/8 on average, whichever is more; but no more than what moves all of its mass.
    """
    motion = which.motion
    speed = 0.0
    rate = 0.0
    missed = 0.0
    whole = horizon(state, step)
    for k in range(3):
        speed += state[motion + 3 + k] ** 2
        rate += state[motion + 6 + k] ** 2
        missed += ((given[k] - state[motion + k]) / whole) ** 2
        if order > 0:
            missed += (given[3 + k] - state[motion + 3 + k]) ** 2
    before = state[SPAN]
    still = RESTING * GRAVITY * p[0].cable.length
    if before == 0.0 or (speed <= RESTING * still and rate <= (RESTING * GRAVITY) ** 2):
        return
    state[end + MOVING] += before
    state[end + SPEEDS] += before * speed
    state[end + RATES] += before * rate
    state[end + SIDEWAYS] += before * (state[motion + 3] ** 2 + state[motion + 4] ** 2)
    moving = state[end + MOVING]
    mass = p[0].cable.mass_per_length * p[0].cable.length + p[0].body.mass + max(p[0].body.added_mass, 0.0)
    impedance = math.sqrt(p[0].cable.axial_stiffness * p[0].cable.mass_per_length)
    stretched = p[0].cable.axial_stiffness / p[0].cable.length * whole / 8.0
    kick = min(max(impedance, stretched), mass / whole) * math.sqrt(missed)
    inertia = mass * math.sqrt(state[end + RATES] / moving)
    leads = p[0].top.inputs_at == 0.0 and (end == TO_LOWER or p[0].host.mass == 0.0)
    if leads and kick > max(KICK * inertia, FEWEST * mass * GRAVITY):
        state[end + MISSING] += before
        rates_differ = state[DOUBT + 2 * (jump + 1)] + state[DOUBT + 2 * (jump + 2)] > 0.0
        if state[end + MISSING] > 0.5 * moving and moving > FEWEST_STEPS * before and not rates_differ:
            note(state, KICKED, kick, inertia)
    if state[end + RATES] > 0.0 and p[0].solver.tolerance == 0.0:
        period = 2.0 * math.pi * math.sqrt(state[end + SPEEDS] / state[end + RATES])
        matters = state[end + RATES] / moving > (FEWEST * GRAVITY) ** 2 and moving > SEVERAL * max(before, step)
        if matters and moving > PERIODS * period and FEWEST_STEPS * state[STEP] > period:
            note(state, COARSE, state[STEP], period)
