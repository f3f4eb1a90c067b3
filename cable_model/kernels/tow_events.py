"""Where the tow model's cable goes slack or taut: the branch of its tension that holds, and steps that end where it changes."""

import math

from cable_model.kernels.jit import kernel
from cable_model.kernels.tow import excess_tension
from cable_model.kernels.tow_schemes import CUBIC, merson_step, radau_step

MAX_EVENTS = 60  # trials to end a step on an event


@kernel
def attempt(explicit, parts, c, drive, elapsed, h, y, f, j, slack, scale, tolerance, work):
    if explicit:
        return merson_step(parts, c, drive, elapsed, h, y, f, slack, scale, work)
    return radau_step(parts, c, drive, elapsed, h, y, f, j, slack, scale, tolerance, work)


@kernel
def on_floor(tension_floor, c, y, f, graze):
    """1.0 where the cable is slack, else 0.0; on the corner itself the rate of the excess tension decides."""
    if tension_floor is None:
        return 0.0
    excess = excess_tension(c, y)
    if abs(excess) <= graze:
        excess = c.spring * f[2] + c.damper * f[3]
    return 1.0 if excess < 0.0 else 0.0


@kernel
def first_crossing(tension_floor, work, slack, graze):
    """Fraction of the step at which the excess tension first leaves its branch by more than `graze`; 2 where it stays."""
    if tension_floor is None:
        return 2.0
    sign = 1.0 - 2.0 * slack
    a0, a1, a2, a3 = sign * work[CUBIC], sign * work[CUBIC + 1], sign * work[CUBIC + 2], sign * work[CUBIC + 3]
    low, high = 2.0, 2.0  # where the cubic is stationary
    under = a2 * a2 - 3.0 * a1 * a3
    if under > 0.0:
        q = -a2 - math.copysign(math.sqrt(under), a2)
        if abs(3.0 * a3) > abs(0.5 * q):
            low = q / (3.0 * a3)
        if q != 0.0:
            high = a1 / q
    start = 0.0
    for point in (min(low, high), max(low, high), 1.0):
        if start < point <= 1.0:
            if a0 + point * (a1 + point * (a2 + point * a3)) < -graze:
                if a0 + start * (a1 + start * (a2 + start * a3)) <= 0.0:
                    return start
                for _ in range(50):
                    middle = 0.5 * (start + point)
                    if a0 + middle * (a1 + middle * (a2 + middle * a3)) > 0.0:
                        start = middle
                    else:
                        point = middle
                return point
            start = point
    return 2.0


@kernel
def step_to_event(explicit, parts, c, drive, elapsed, h, share, y, f, j, slack, scale, tolerance, graze, work):
    """Step that ends where the excess tension is zero, near the fraction `share` of h; returns its size and as radau_step does."""
    low, high, size = 0.0, h, share * h
    newton, evaluations = 0, 0
    for _ in range(MAX_EVENTS):
        iterations, end, error, spent = attempt(explicit, parts, c, drive, elapsed, size, y, f, j, slack, scale, tolerance, work)
        evaluations += spent
        if iterations < 0:
            return size, -1, y, 0.0, evaluations
        newton += iterations
        sign = 1.0 - 2.0 * slack
        excess = sign * excess_tension(c, end)
        if abs(excess) <= graze or high - low < 1e-13 * h:
            break
        if excess > 0.0:
            low = size
        else:
            high = size
        slope = sign * (work[CUBIC + 1] + 2.0 * work[CUBIC + 2] + 3.0 * work[CUBIC + 3])  # by the fraction of this step, at its end
        size = size - size * excess / slope if slope < 0.0 else low
        if not low < size < high:
            size = 0.5 * (low + high)
    return size, newton, end, error, evaluations
