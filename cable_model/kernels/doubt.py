"""Kinds of what a run shows to be doubtful, and how it is kept.

Nothing of it changes a number of the model.  Each kind has a pair of numbers in the state's head, both 0 until it is seen; then they are
what was seen and what it was held against.  doubts.SEEN has the words.
"""

from cable_model.kernels.header import DOUBT, DOUBTS
from cable_model.kernels.jit import kernel

JUMP, VELOCITY, ACCELERATION, ABOVE, BELOW, STRAIN, ANY_PLACE, ANY_SHAPE, KICKED, COARSE, CURVED, PRESSED, STEEP, RINGS = range(14)  # kinds
BLOW, BENT, PASSED, WAVES_COARSE, SWINGS, LOWER_JUMP, LOWER_VELOCITY, LOWER_ACCELERATION, BURIED, TOGETHER, PARTS = range(14, 25)
ALL_GONE, OVERSHOOTS, CLAMP_COARSE, CUTS = range(25, 29)

GRAVITY = 9.81  # m/s2, the scale of what ships and cranes do to a cable
FEWEST = 1e-4  # of the cable's length, of an acceleration of gravity: what is below it says nothing
KICK = 0.2  # of the motion's own inertia
FEWEST_STEPS = 20.0  # a period: the phase of a second-order method of this family errs by (omega h)^2/12, here 0.8 %
PERIODS = 2.0  # that a motion must have lasted to have a frequency
TOUCHED = 1e-6  # of the cable's length: before the first step the top is where the inputs say, but for rounding


@kernel
def note(state, kind, seen, other):
    """Keep the first pair of a kind."""
    pair = state[DOUBT + 2 * kind : DOUBT + 2 * kind + 2]
    if pair[0] == 0.0 and pair[1] == 0.0:
        pair[0] = seen
        pair[1] = other
        state[DOUBTS] += 1.0
