"""What a run shows to be doubtful, seen once a communication step: how its ends are moved, and where the cable has come to.

Nothing here changes a number of the model.  Each kind of doubt has a pair of numbers in the state's head, both 0 until it is seen; then
they are what was seen and what it was held against.  doubts.SEEN has the words.
"""

import math
from typing import NamedTuple

from cable_model.kernels.bottom import bottom_at
from cable_model.kernels.choice import by_presence
from cable_model.kernels.ends import horizon
from cable_model.kernels.family import GENERALIZED_ALPHA
from cable_model.kernels.fluid import current_motion, flows
from cable_model.kernels.header import (
    AUDIT,
    DOUBT,
    DOUBTS,
    FRONT,
    LOWER_WATCH,
    PARTED,
    PENDING,
    STEP,
    STEPS,
    STREAM,
    SUNK,
    TIME,
    TOP,
    WATCH,
    WHOLE,
)
from cable_model.kernels.jit import kernel
from cable_model.kernels.path import LOWER_END, UPPER_END
from cable_model.kernels.problem import NEUTRAL, cable_part, is_neutral, total_weight
from cable_model.kernels.vector import add, axpy, dot, mix, norm, scale, sub, unit
from cable_model.kernels.waves import AMPLITUDE, DEPTH, FREQUENCY, NUMBER

JUMP, VELOCITY, ACCELERATION, ABOVE, BELOW, STRAIN, ANY_PLACE, ANY_SHAPE, KICKED, COARSE, CURVED, PRESSED, STEEP, RINGS = range(14)  # kinds
BLOW, BENT, PASSED, WAVES_COARSE, SWINGS, LOWER_JUMP, LOWER_VELOCITY, LOWER_ACCELERATION, BURIED, TOGETHER, PARTS = range(14, 25)
ALL_GONE, OVERSHOOTS, CLAMP_COARSE, CUTS = range(25, 29)
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

GRAVITY = 9.81  # m/s2, the scale of what ships and cranes do to a cable
SOON = 5.0  # m/s, at which a top may set off that has stood still
UNEXPLAINED = 0.5  # share of the way: a sine at five steps a period has 0.14, a rate that stays 0 has 1, one of the wrong sign 2
CUT = 0.1  # of a cell, by which its middle may lie deeper in a bottom than its ends
BENDS_IN = 0.65  # of sqrt(EI/T), in which a clamped cable bends: in cells of that length the moment is 5 % too small
TURNED = 0.01  # by which it has to bend there, rad
SHARP = 0.3  # and by which it bends too much for half a cell, whatever the tension, rad
FEWEST = 1e-4  # of the cable's length: ways below it say nothing
SLOWEST = 1e-2  # of sqrt(g length): changes of velocity below it say nothing
EMERGED = 0.01  # of the cable's length: a top that heaves by less about the surface is no matter
SEVERAL = 6.0  # times the longest of a step: a motion that begins by a power of time goes farther in each step than in all before
TOGETHER_WITHIN = 1e-3  # of the cable's length, from one end to the other at the start
TOUCHED = 1e-6  # of the cable's length: before the first step the top is where the inputs say, but for rounding
RESTING = 1e-9  # of a free fall over the cable's length: a top with a mass that rests is moved by rounding
KICK = 0.2  # of the motion's own inertia
FEWEST_STEPS = 20.0  # a period: the phase of a second-order method of this family errs by (omega h)^2/12, here 0.8 %
PERIODS = 2.0  # that a motion must have lasted to have a frequency
PUSHED = 1e-3  # of the weight
LARGEST_SAG = 0.03  # of the length: the ends of a cable with it lean 7 degrees to either side of the straight line between them
FELT = 0.95  # of the variance of the waves' velocity: what the shortest waves add beyond it does not count
BREAKING = 0.142 * math.pi  # of amplitude times wave number: Michell's limit, height over length, which no wave in deep water exceeds
LARGEST_STRAIN = 0.1  # of steel 0.002, of ropes some hundredths; beyond it length and diameter are not what the scene says


class Seen(NamedTuple):
    """What the outputs do not tell of sections and of bodies on the cable."""

    strain: float  # the largest
    under: float  # the tension there, N
    highest: float  # z of the highest body, m
    nearest: float  # z of the one that is nearest to the surface, m


NOTHING = Seen(0.0, 0.0, -1e300, 1e300)


@kernel
def note(state, kind, seen, other):
    """Keep the first pair of a kind."""
    pair = state[DOUBT + 2 * kind : DOUBT + 2 * kind + 2]
    if pair[0] == 0.0 and pair[1] == 0.0:
        pair[0] = seen
        pair[1] = other
        state[DOUBTS] += 1.0


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


@kernel
def open_bottom(finite_depth, seabed, waves):
    """Depth of a bottom that waves feel and the cable does not; 0 without."""
    if finite_depth is None:
        return 0.0
    if seabed is not None:
        return 0.0
    return waves[DEPTH, 0]


@kernel
def _watch_rest(parts, p, state, largest):
    """Whether the state that a run starts from is the only one at rest; `largest` is the largest tension in it."""
    neutral, weight, mass = is_neutral(parts, p)
    if not neutral:
        return
    if parts.anchor is not None:
        if largest <= 2.0 * NEUTRAL * mass * p[0].environment.gravity:
            note(state, ANY_SHAPE, weight, mass)
    elif not flows(parts):
        note(state, ANY_PLACE, weight, mass)


@kernel
def _watch_waves(waves, state):
    if waves is None:
        return
    for j in range(waves.shape[1]):
        if waves[AMPLITUDE, j] * waves[NUMBER, j] > BREAKING:
            note(state, STEEP, 2.0 * waves[AMPLITUDE, j], 2.0 * math.pi / waves[NUMBER, j])


@kernel
def _watch_wave_steps(waves, p, state):
    """The waves that matter, against the first internal step."""
    if waves is None or state[WAVES_SEEN] > 0.0 or p[0].solver.tolerance > 0.0:
        return
    state[WAVES_SEEN] = 1.0
    variance = 0.0
    for j in range(waves.shape[1]):
        variance += (waves[AMPLITUDE, j] * waves[FREQUENCY, j]) ** 2
    fastest = 0.0
    for j in range(waves.shape[1]):
        slower = 0.0
        for i in range(waves.shape[1]):
            if waves[FREQUENCY, i] < waves[FREQUENCY, j]:
                slower += (waves[AMPLITUDE, i] * waves[FREQUENCY, i]) ** 2
        if slower < FELT * variance:
            fastest = max(fastest, waves[FREQUENCY, j])
    if FEWEST_STEPS * state[STEP] * fastest > 2.0 * math.pi:
        note(state, WAVES_COARSE, state[STEP], 2.0 * math.pi / fastest)


@kernel
def _rise(waves):
    """How far waves lift the water: the amplitude of one, half of the significant height of many."""
    if waves is None:
        return 0.0
    square = 0.0
    for j in range(waves.shape[1]):
        square += waves[AMPLITUDE, j] ** 2
    return math.sqrt(square)


@kernel
def _watch_level(parts, state, z):
    """Waves that are held do not move the surface: an end or a body among them, at `z`, comes out of the water, and does not here."""
    if parts.surface is None or parts.stretched is not None or parts.cut is not None:
        return
    rise = _rise(parts.waves)
    if abs(z) < rise:
        note(state, PASSED, rise, z)


@kernel
def watch_set_off(parts, p, state, along, outputs):
    """Ends that part at a speed `along` the cable, m/s, that is not 0 when the cable is still at rest."""
    cable = p[0].cable
    mass = cable.mass_per_length * cable.length
    if parts.anchor is None:
        mass += p[0].body.mass + max(p[0].body.added_mass, 0.0)
    blow = math.sqrt(cable.axial_stiffness / cable.length * mass) * abs(along)
    allowed = max(KICK * max(outputs[12], total_weight(parts, p)), FEWEST * mass * GRAVITY)
    if state[STEPS] == 0.0 and state[PENDING] == 0.0 and blow > allowed:
        note(state, BLOW, along, blow)


@kernel
def _no_bottom(seabed, parts, p, state, lower):
    return


@kernel
def _bottom(seabed, parts, p, state, lower):
    """An end that is pushed into the seabed: the top, a driven one; on a bottom that is not level, where no rule sees to it, an anchor."""
    allowed = SUNK * p[0].cable.diameter
    under = bottom_at(parts.relief, parts.slope, p, state[TOP], state[TOP + 1])
    if state[TOP + 2] < under - allowed:
        note(state, BURIED, state[TOP + 2], under)
    held = parts.driven is not None
    if parts.slope is not None or parts.relief is not None:
        held = parts.anchor is not None
    under = bottom_at(parts.relief, parts.slope, p, lower[0], lower[1])
    if held and lower[2] < under - allowed:
        note(state, BURIED, lower[2], under)


_watch_bottom = by_presence(_no_bottom, _bottom)


@kernel
def _watch_ends(parts, p, state, lower):
    """Ends that inputs move, the lower one at `lower` (3,): one that they push into the seabed, both where they begin in one place."""
    _watch_bottom(parts.seabed, parts, p, state, lower)
    if parts.driven is None or state[STEPS] > 0.0 or state[PENDING] > 0.0:
        return
    apart = norm(sub((state[TOP], state[TOP + 1], state[TOP + 2]), (lower[0], lower[1], lower[2])))
    if apart < TOGETHER_WITHIN * p[0].cable.length:
        note(state, TOGETHER, max(apart, 1e-300), p[0].cable.length)


@kernel
def watch_clamp(state, angle, bending, tension, cell):
    """A clamped end under this tension, N, whose first cell of this length, m, turns by this angle; `bending` is EI."""
    if angle > SHARP or (angle > TURNED and tension * cell * cell > BENDS_IN * BENDS_IN * bending):
        note(state, CLAMP_COARSE, angle, cell)


@kernel
def watch_cell(state, height, height_of_ends, cell):
    """A cell of this length, m, whose middle and, on average, ends lie at these heights over the bottom, m."""
    if height < 0.0 and height < height_of_ends - CUT * cell:
        note(state, CUTS, height_of_ends - height, cell)


@kernel
def watch_outputs(parts, p, state, outputs, seen=NOTHING):
    """Look at the outputs, in the order of signals.OUTPUTS, that a state has, and at what was seen of sections and bodies on the cable."""
    if state[STEPS] == 0.0:
        _watch_rest(parts, p, state, outputs[12])
        _watch_waves(parts.waves, state)
    else:
        _watch_wave_steps(parts.waves, p, state)
    if state[FRONT] != 0.0 and int(p[0].solver.integrator) == GENERALIZED_ALPHA and p[0].solver.lambda_infinity > 0.0:
        note(state, OVERSHOOTS, p[0].solver.lambda_infinity, 0.0)
    _watch_level(parts, state, outputs[7] if abs(outputs[7]) < abs(seen.nearest) else seen.nearest)
    _watch_ends(parts, p, state, outputs[5:8])
    begun = state[STEPS] > 0.0 or state[PENDING] > 0.0
    allowed = (EMERGED if begun else TOUCHED) * p[0].cable.length  # where a run starts above the water, it is meant to
    lower_z = outputs[7]
    highest = max(state[TOP + 2], lower_z, seen.highest)
    if parts.water is not None and parts.surface is None and highest > allowed:
        note(state, ABOVE, highest, allowed)
    depth = open_bottom(parts.finite_depth, parts.seabed, parts.waves)
    if depth > 0.0 and lower_z < -depth:
        note(state, BELOW, lower_z, -depth)
    strain, under = seen.strain, seen.under
    if parts.sections is None:
        strain, under = outputs[12] / p[0].cable.axial_stiffness, outputs[12]
    if parts.inextensible is None and parts.curve is None and strain > LARGEST_STRAIN:
        note(state, STRAIN, strain, under)


@kernel
def _sag(parts, p, state, outputs):
    """Of a cable that was not straight, as a share of its length: what drag and weight put across it, over 8 times its tension."""
    top = (state[TOP], state[TOP + 1], state[TOP + 2])
    low = (outputs[5], outputs[6], outputs[7])
    middle = mix(0.5, top, 0.5, low)
    if parts.surface is not None and middle[2] > 0.0:
        return 0.0
    t = unit(sub(top, low))
    flow, _, _ = current_motion(parts, middle, state[TIME])
    u = sub(flow, mix(0.5, (state[TOP + 3], state[TOP + 4], state[TOP + 5]), 0.5, (outputs[8], outputs[9], outputs[10])))
    across = axpy(-dot(u, t), t, u)
    cable = cable_part(parts.water, p)
    load = scale(0.5 * p[0].water.density * p[0].cable.normal_drag_coefficient * cable.diameter * norm(across), across)
    load = add(load, axpy(cable.weight * t[2], t, (0.0, 0.0, -cable.weight)))
    tension = 0.5 * (outputs[3] + outputs[11])
    return norm(load) * cable.length / (8.0 * max(tension, PUSHED * total_weight(parts, p)))


@kernel
def watch_straight(parts, p, state, outputs):
    """What the tow model takes for granted: a cable that is straight, and pulls.

    Drag lets a top that moves to and fro across the cable be felt down to delta = sqrt(2 T/(c omega)), c = 4/(3 pi) rho C_D d v: derived,
    and tried against a converged chain.  Steady loads across it bend it too.
    """
    force = total_weight(parts, p)
    lowest = outputs[13]
    if lowest < -PUSHED * force:
        note(state, PRESSED, lowest, force)
    if parts.water is None:
        return
    sag = _sag(parts, p, state, outputs)
    if sag > LARGEST_SAG and lowest > 0.0:
        note(state, BENT, sag * p[0].cable.length, p[0].cable.length)
    if state[SIDEWAYS] == 0.0 or state[RATES] == 0.0:
        return
    omega = math.sqrt(state[RATES] / state[SPEEDS])
    if omega * state[MOVING] < 2.0 * math.pi * PERIODS:
        return
    cable = p[0].cable
    amplitude = math.sqrt(2.0 * state[SIDEWAYS] / state[MOVING])
    drag = 4.0 / (3.0 * math.pi) * p[0].water.density * cable.normal_drag_coefficient * cable.diameter * amplitude
    if 2.0 * force < drag * omega * cable.length**2:
        note(state, CURVED, math.sqrt(2.0 * force / (drag * omega)), cable.length)
