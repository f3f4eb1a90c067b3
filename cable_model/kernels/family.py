"""The generalized-alpha family: the three coefficients of each member [Gobat 2002, eqs 17-21 and table 1, corrected].

    (1-alpha_m) M Y'_i + alpha_m M Y'_(i-1) + (1-alpha_k) K Y_i + alpha_k K Y_(i-1) + ... = 0
    Y_i = Y_(i-1) + dt [(1-gamma) Y'_(i-1) + gamma Y'_i]

Y'_i approximates the derivative at t_i + (alpha_m - alpha_k) dt.
"""

from typing import NamedTuple

from cable_model.kernels.jit import kernel

GENERALIZED_ALPHA = 0  # every lambda_infinity in [-1, 1); -1 is the box method
BACKWARD_DIFFERENCE = 1
TRAPEZOIDAL = 2
GENERALIZED_TRAPEZOIDAL = 3
CORNWELL_MALKUS = 4
WBZ = 5

CHANGING = -0.5  # least lambda_infinity of a generalized-alpha step of another size than the one before


class Coefficients(NamedTuple):
    alpha_k: float
    alpha_m: float
    gamma: float


@kernel
def coefficients(integrator, lambda_infinity):
    """Coefficients of a member; lambda_infinity is its eigenvalue at infinite frequency.

    The paper's table 1 prints gamma = 1/2 - alpha (Cornwell-Malkus) and 1/2 + alpha (WBZ); its own second-order condition,
    eq 19, asks for the opposite signs, which are used here.
    """
    lam = lambda_infinity
    if integrator == 1:
        return Coefficients(0.0, 0.0, 1.0)
    if integrator == 2:
        return Coefficients(0.0, 0.0, 0.5)
    if integrator == 3:
        return Coefficients(0.0, 0.0, 1.0 / (1.0 - lam))
    if integrator == 4:
        return Coefficients(lam / (lam - 1.0), 0.0, 0.5 + lam / (lam - 1.0))
    if integrator == 5:
        return Coefficients(0.0, 0.5 - 1.0 / (1.0 - lam), 1.0 / (1.0 - lam))
    alpha_k = lam / (lam - 1.0)
    alpha_m = (3.0 * lam + 1.0) / (2.0 * lam - 2.0)
    return Coefficients(alpha_k, alpha_m, 0.5 - alpha_m + alpha_k)


@kernel
def coefficients_of_change(integrator, lambda_infinity):
    """Coefficients for a step of another size than the one before: those of the member, but of one that damps what the change excites.

    A member that hardly damps what no step resolves lets random changes of the step feed it: at lambda_infinity = -0.9 by some per cent a
    step.  Both members are of second order, so that a step of one may follow a step of the other.
    """
    if integrator == 0 and lambda_infinity < CHANGING:
        return coefficients(integrator, CHANGING)
    return coefficients(integrator, lambda_infinity)
