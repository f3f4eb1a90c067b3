"""The tension law of a cell with and without slack, and the rules by which Newton's method moves a tension.

Tension is an unknown of its own, T.  With f = EA e + C e' the law without compression is T = (f + sqrt(f^2 + w0^2))/2; its inverse,
f = T - w0^2/(4 T) with T > 0, is the barrier form of an interior-point method, on which Newton's method does not see the kink.
It is monotone in e', so damping only dissipates.
"""

from cable_model.kernels.jit import kernel


@kernel
def constitutive(slack, smoothing, f, force):
    """Slope dT/df at the iterate `force`, and the misfit of the law there."""
    if slack is None:
        return 1.0, f - force
    barrier = 0.25 * smoothing * smoothing / force
    return force / (force + barrier), f - force + barrier


@kernel
def iterate(slack, smoothing, f, force):
    """The tension to linearise about: the iterate, but the law's at f = 0 where a slack cell has become taut.

    The barrier form raises a small tension by a factor of 2 an iteration only.
    """
    if slack is None:
        return force
    if f > 0.0 and force < 1e-3 * smoothing:
        return 0.5 * smoothing
    return force


@kernel
def step_tension(slack, smoothing, force, change):
    """Tension after a Newton change; with slack it stays positive.  Also whether that cut the change by more than a trifle."""
    if slack is None:
        return force + change, False
    if change < -0.999 * force:
        return 0.001 * force, force > 1e-5 * smoothing
    return force + change, False


@kernel
def shortfall(slack, cells, i):
    """What the averaged strain of a cell leaves out of the strain before the step, where that was deep in slack."""
    if slack is None:
        return 0.0
    return cells[i, cells.shape[1] - 1]
