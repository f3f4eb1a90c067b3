"""What a run shows to be doubtful, seen once a communication step: how the top is moved, and where the cable has come to.

Nothing here changes a number of the model.  Each kind of doubt has a pair of numbers in the state's head, both 0 until it is seen; then
they are what was seen and what it was held against.  doubts.SEEN has the words.
"""

import math

from cable_model.kernels.header import DOUBT, DOUBTS, HEADER, STEPS, TOP, WATCH
from cable_model.kernels.jit import kernel
from cable_model.kernels.problem import NEUTRAL, is_neutral
from cable_model.kernels.waves import DEPTH

JUMP, VELOCITY, ACCELERATION, ABOVE, BELOW, STRAIN, ANY_PLACE, ANY_SHAPE, RINGS = range(9)  # kinds of doubt
LAST = WATCH  # 9 numbers: the inputs of the last communication step
SPAN = WATCH + 9  # its length, s; 0 before the first
FASTEST = WATCH + 10  # speed of the top so far, m/s
GONE = WATCH + 11  # how far position and velocity went, in sum
MISSED = WATCH + 13  # and what their rates do not explain of it

GRAVITY = 9.81  # m/s2, the scale of what ships and cranes do to a cable
SOON = 5.0  # m/s, at which a top may set off that has stood still
UNEXPLAINED = 0.5  # share of the way: a sine at five steps a period has 0.14, a rate that stays 0 has 1, one of the wrong sign 2
FEWEST = 1e-4  # of the cable's length: ways below it say nothing
SLOWEST = 1e-2  # of sqrt(g length): changes of velocity below it say nothing
EMERGED = 0.01  # of the cable's length: a top that heaves by less about the surface is no matter
LARGEST_STRAIN = 0.1  # of steel 0.002, of ropes some hundredths; beyond it length and diameter are not what the scene says


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
    """Begin with the inputs (10,) of the initialization, after it."""
    for k in range(DOUBTS, HEADER):
        state[k] = 0.0
    for k in range(9):
        state[LAST + k] = inputs[k]


@kernel
def watch_inputs(order, p, state, inputs, step):
    """Compare the inputs (10,) of a step with the last ones: top.motion_order `order` says which of them are given."""
    length = p[0].cable.length
    last = state[LAST : LAST + 9]
    h = step if p[0].top.inputs_at > 0.0 else state[SPAN]
    reach = max(h, step)
    way, gap = _apart(inputs, last, 0, h, 0.0)
    if order == 0:
        gap = way
    else:
        state[FASTEST] = max(state[FASTEST], math.sqrt(inputs[3] ** 2 + inputs[4] ** 2 + inputs[5] ** 2))
    unknown = SOON if state[FASTEST] == 0.0 else 0.0
    allowed = reach * (3.0 * state[FASTEST] + unknown + 0.5 * GRAVITY * reach) + FEWEST * length
    if gap > allowed:
        note(state, JUMP, gap, reach)
    elif h > 0.0:
        state[FASTEST] = max(state[FASTEST], way / h)
        for level in range(order):
            way, missed = _apart(inputs, last, 3 * level, h, 0.5)
            state[GONE + level] += way
            state[MISSED + level] += missed
            scale = FEWEST * length if level == 0 else SLOWEST * math.sqrt(GRAVITY * length)
            if state[MISSED + level] > max(UNEXPLAINED * state[GONE + level], scale):
                note(state, VELOCITY + level, state[GONE + level], state[MISSED + level])
    for k in range(9):
        last[k] = inputs[k]
    state[SPAN] = step


@kernel
def open_bottom(finite_depth, seabed, waves):
    """Depth of a bottom that waves feel and the cable does not; 0 without."""
    if finite_depth is None:
        return 0.0
    if seabed is not None:
        return 0.0
    return waves[0, DEPTH]


@kernel
def _watch_rest(parts, p, state, largest):
    """Whether the state that a run starts from is the only one at rest; `largest` is the largest tension in it."""
    neutral, weight, mass = is_neutral(parts, p)
    if not neutral:
        return
    if parts.anchor is not None:
        if largest <= 2.0 * NEUTRAL * mass * p[0].environment.gravity:
            note(state, ANY_SHAPE, weight, mass)
    elif parts.current is None:
        note(state, ANY_PLACE, weight, mass)


@kernel
def watch_outputs(parts, p, state, outputs):
    """Look at the outputs, in the order of signals.OUTPUTS, that a state has."""
    if state[STEPS] == 0.0:
        _watch_rest(parts, p, state, outputs[12])
    allowed = EMERGED * p[0].cable.length if state[STEPS] > 0.0 else 0.0  # where a run starts above the water, it is meant to
    lower_z = outputs[7]
    highest = max(state[TOP + 2], lower_z)
    if parts.water is not None and parts.surface is None and highest > allowed:
        note(state, ABOVE, highest, allowed)
    depth = open_bottom(parts.finite_depth, parts.seabed, parts.waves)
    if depth > 0.0 and lower_z < -depth:
        note(state, BELOW, lower_z, -depth)
    if parts.inextensible is None and parts.curve is None and outputs[12] > LARGEST_STRAIN * p[0].cable.axial_stiffness:
        note(state, STRAIN, outputs[12] / p[0].cable.axial_stiffness, outputs[12])
