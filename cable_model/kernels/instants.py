"""Whether the force at the end of a communication step stands for the force about it, or swings within the step.

A smooth force is at the end of a step what lies between the means of the steps on either side, but for a small part of what these means
differ by.  A force that swings once or more within a step is anywhere about them: where inputs are led on, kicks at every step that
comes in time with a swing of the cable's own add up, and the means stay right.  Nothing here changes a number of the model.
"""

import math

from cable_model.kernels.doubt import GRAVITY, KICKED, SWINGS, note
from cable_model.kernels.exchange import MEAN, TOLD
from cable_model.kernels.header import DOUBT, INSTANTS
from cable_model.kernels.jit import kernel
from cable_model.kernels.ringing import ALIKE, IN_A_ROW, WINDOW
from cable_model.kernels.watch import SPAN

FORCE = INSTANTS  # at the start of the last communication step, N; three numbers
BEFORE = INSTANTS + 3  # mean force of the step before it, N; three numbers
LENGTH = INSTANTS + 6  # of the step before it, s; 0: there is none
OFF = INSTANTS + 7  # squares of what the forces at instants are off, times the steps; of the window, as all that follow
CHANGED = INSTANTS + 8  # squares of what means differ by from step to step, likewise
SIZE = INSTANTS + 9  # of the force, times the steps
TIME = INSTANTS + 10
COUNT = INSTANTS + 11
HITS = INSTANTS + 12  # windows in a row in which it swings

FEWEST = 16  # steps in a window
LOUD = 0.005  # of the force
FAINTEST = 0.02  # of the weight in air: where the force is less, as of what is neutral, it is held against that


@kernel
def _close_window(state):
    off = math.sqrt(state[OFF] / state[TIME])
    swings = state[OFF] > state[CHANGED] and off > LOUD * state[SIZE] / state[TIME]
    state[HITS] = state[HITS] + 1.0 if swings else 0.0
    if state[HITS] >= IN_A_ROW and state[DOUBT + 2 * KICKED] == 0.0:
        note(state, SWINGS, off, math.sqrt(state[CHANGED] / state[TIME]))
    for k in range(OFF, HITS):
        state[k] = 0.0


@kernel
def watch_instants(p, state):
    """Look at the last communication step, where inputs are led on; before watch_inputs.

    Where the end's are given, a force that swings is the cable's own vibration, and right at every instant.
    """
    h = state[SPAN]
    if h == 0.0 or p[0].top.inputs_at > 0.0:
        return
    before = state[LENGTH]
    if before < ALIKE * h and h < ALIKE * before:
        size = 0.0
        for k in range(3):
            change = state[MEAN + k] - state[BEFORE + k]
            off = state[FORCE + k] - state[BEFORE + k] - change * before / (before + h)
            state[OFF] += h * off * off
            state[CHANGED] += h * change * change
            size += state[MEAN + k] ** 2
        cable = p[0].cable
        mass = cable.mass_per_length * cable.length + p[0].body.mass
        state[SIZE] += h * max(math.sqrt(size), FAINTEST * mass * GRAVITY)
        state[TIME] += h
        state[COUNT] += 1.0
        if state[TIME] >= WINDOW * (1.0 - 1e-9) and state[COUNT] >= FEWEST:
            _close_window(state)
    for k in range(3):
        state[FORCE + k] = state[TOLD + k]
        state[BEFORE + k] = state[MEAN + k]
    state[LENGTH] = h
