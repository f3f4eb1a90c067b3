"""How long the next internal step may be, where solver.tolerance is above 0: from the truncation error of the last one.

The error is that of an acceleration, as the cable feels it (see the grids' rate_error), against the largest motion so far.  An error that
falls from step to step, or does not fall with the step, is what earlier steps left to ring, and smaller steps would excite more of it.
"""

import math
from typing import NamedTuple

from cable_model.kernels.header import LARGEST_MOTION, LAST_ERROR
from cable_model.kernels.jit import kernel

TOLERATED = 0.025  # such that tips and bodies keep within solver.tolerance of their motion, and tensions within a few times it
LEAST_MOTION = 0.01  # of g: errors are relative to the motion, but not to next to nothing
SOLVED = 0.1  # share of the allowed error of a step that Newton's method may leave
MOST_STEPS = 1000000  # in a communication step, of both models: a host that waits for more waits for ever
REJECTED = 2.0  # allowed errors above which a step is taken again
RINGING = 0.4  # share of an error that is left with a smaller step, above which it is no truncation error
AIM = 0.92  # of the step that would have the allowed error
STEADY = 1.25  # factors nearer to 1 change nothing: every change of the step costs its rates some of their accuracy
GROWTH = 2.0  # of the internal step from one to the next: what the mesh does not resolve rings on with 1 - (r - 1)/2 of it at a ratio of r


class Trials(NamedTuple):
    """What trials of the same step found before, 0 where there was none."""

    error: float  # of the last, m/s2
    first: float  # size of the first, s


@kernel
def allowed_error(state, tolerance, gravity):
    """m/s2."""
    state[LARGEST_MOTION] = max(state[LARGEST_MOTION], LEAST_MOTION * max(gravity, 1e-3))
    return TOLERATED * tolerance * state[LARGEST_MOTION]


@kernel
def see_motion(state, moving, gravity):
    """Keep the largest motion: a shock counts as g at most, where there is gravity."""
    state[LARGEST_MOTION] = max(state[LARGEST_MOTION], min(moving, gravity) if gravity > 0.0 else moving)


@kernel
def judge(state, error, allowed, used, smallest, trials):
    """Factor for the step `used` with that error, whether it must be taken again, and the trials of the next."""
    resists = trials.error > 0.0 and error > RINGING * trials.error
    rings = error < state[LAST_ERROR] or resists
    if error > REJECTED * allowed and used > smallest and not rings:
        return max(0.3, 0.8 * math.sqrt(allowed / error)), True, Trials(error, used if trials.error == 0.0 else trials.first)
    state[LAST_ERROR] = max(error, trials.error) if resists else error
    if resists:  # the smaller steps were of no use
        return min(GROWTH, trials.first / used), False, Trials(0.0, 0.0)
    return growth(min(error / allowed, 0.5) if rings else error / allowed), False, Trials(0.0, 0.0)


@kernel
def growth(ratio):
    """Factor for the next step from the error over the allowed one."""
    factor = min(GROWTH, max(0.3, AIM / math.sqrt(max(ratio, 1e-6))))
    return 1.0 if 1.0 / STEADY <= factor <= STEADY else factor
