"""Where a run has brought the cable, looked at with its outputs: what is doubtful there, see doubt.py."""

import math
from typing import NamedTuple

from cable_model.kernels.bottom import bottom_at
from cable_model.kernels.choice import by_presence
from cable_model.kernels.doubt import (
    ABOVE,
    ANY_PLACE,
    ANY_SHAPE,
    BELOW,
    BENT,
    BLOW,
    BURIED,
    CLAMP_COARSE,
    CURVED,
    CUTS,
    FEWEST,
    FEWEST_STEPS,
    GRAVITY,
    KICK,
    OVERSHOOTS,
    PASSED,
    PERIODS,
    PRESSED,
    STEEP,
    STRAIN,
    TOGETHER,
    TOUCHED,
    WAVES_COARSE,
    note,
)  # fmt: skip
from cable_model.kernels.family import GENERALIZED_ALPHA
from cable_model.kernels.fluid import current_motion, flows
from cable_model.kernels.header import FRONT, PENDING, STEP, STEPS, SUNK, TIME, TOP
from cable_model.kernels.jit import kernel
from cable_model.kernels.problem import NEUTRAL, cable_part, is_neutral, total_weight
from cable_model.kernels.vector import add, axpy, dot, mix, norm, scale, sub, unit
from cable_model.kernels.watch import MOVING, RATES, SIDEWAYS, SPEEDS, WAVES_SEEN
from cable_model.kernels.wave_sums import AMPLITUDE, DEPTH, FREQUENCY, NUMBER

EMERGED = 0.01  # of the cable's length: a top that heaves by less about the surface is no matter
TOGETHER_WITHIN = 1e-3  # of the cable's length, from one end to the other at the start
PUSHED = 1e-3  # of the weight
LARGEST_SAG = 0.03  # of the length: the ends of a cable with it lean 7 degrees to either side of the straight line between them
FELT = 0.95  # of the variance of the waves' velocity: what the shortest waves add beyond it does not count
BREAKING = 0.142 * math.pi  # of amplitude times wave number: Michell's limit, height over length, which no wave in deep water exceeds
LARGEST_STRAIN = 0.1  # of steel 0.002, of ropes some hundredths; beyond it length and diameter are not what the scene says
CUT = 0.1  # of a cell, by which its middle may lie deeper in a bottom than its ends
BENDS_IN = 0.65  # of sqrt(EI/T), in which a clamped cable bends: in cells of that length the moment is 5 % too small
TURNED = 0.01  # by which it has to bend there, rad
SHARP = 0.3  # and by which it bends too much for half a cell, whatever the tension, rad


class Seen(NamedTuple):
    """What the outputs do not tell of sections and of bodies on the cable."""

    strain: float  # the largest
    under: float  # the tension there, N
    highest: float  # z of the highest body, m
    nearest: float  # z of the one that is nearest to the surface, m


NOTHING = Seen(0.0, 0.0, -1e300, 1e300)


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
