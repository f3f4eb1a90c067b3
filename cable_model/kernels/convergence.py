"""When Newton's method has converged: both grids ask here after each iteration.

The next change is estimated from how fast changes shrink.  Within a step that is quadratic convergence.  After the first iteration
it is the contraction of the last step that took two: smooth motion changes it slowly, so that most steps need one iteration only.
"""

from cable_model.kernels.jit import kernel

SAFETY = 10.0  # on the contraction of an earlier step
FADING = 1.3  # by which it is taken for worse with every step that did not measure it
ROUGH = 0.01  # contraction from which on motion is not smooth
LEAST_CONTRACTION = 1e-9  # below it, what is measured is rounding


@kernel
def is_rough(contraction):
    """Whether Newton's method found the last steps hard: snaps and whips, where the past does not tell what comes."""
    return contraction[0] > ROUGH


@kernel
def has_converged(iteration, change, previous, numeric, contraction):
    """Whether `change`, the largest of this iteration, leaves less than numeric.tolerance to the next one.

    `previous` is the change before; `contraction` (1,) is kept from step to step, 0 at first: not known.  Changes below
    numeric.rounding that no longer shrink are rounding errors: more iterations would not help.
    """
    tolerance = numeric.tolerance
    if iteration == 1:
        rest = SAFETY * contraction[0] * change
        contraction[0] = min(FADING * contraction[0], 1.0)
        return change <= tolerance or 0.0 < rest <= tolerance
    if iteration == 2:
        contraction[0] = min(max(change / previous, LEAST_CONTRACTION), 1.0)
    if iteration > 2 and change <= numeric.rounding and change > 0.3 * previous:
        return True
    # quadratic: the next change would be about change^3/previous^2
    return change <= tolerance or (change < 0.1 * previous and 100.0 * change * (change / previous) ** 2 <= tolerance)
