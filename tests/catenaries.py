"""Elastic catenaries in closed form: what cables at rest are held against."""

import numpy as np
from scipy.optimize import brentq, fsolve


def between_points(length: float, weight: float, stiffness: float, span: float, rise: float) -> tuple[float, float]:
    """Horizontal and vertical force at the top, N, of a cable of `weight` N/m between (0, 0) and (span, rise), by Irvine's closed form."""

    def miss(unknown: np.ndarray) -> list[float]:
        h, v = np.exp(unknown[0]), unknown[1]
        low = v - weight * length
        x = h * length / stiffness + h / weight * (np.arcsinh(v / h) - np.arcsinh(low / h))
        z = (v * v - low * low) / (2.0 * stiffness * weight) + (np.hypot(h, v) - np.hypot(h, low)) / weight
        return [x - span, z - rise]

    logarithm, v = fsolve(miss, [np.log(0.5 * weight * length), 0.7 * weight * length], xtol=1e-13)
    return float(np.exp(logarithm)), float(v)


def touchdown(length: float, weight: float, stiffness: float, span: float, rise: float, friction: float = 0.0) -> tuple[float, float]:
    """Horizontal force, N, and suspended length, m, of a cable that comes to lie on a floor, where it is anchored.

    Coulomb friction takes `friction` times the weight that lies there from the tension, of which something must be left at the anchor.
    """

    def miss(s: float, pull: float) -> float:
        return pull / weight * (np.hypot(1.0, weight * s / pull) - 1.0) + weight * s * s / (2.0 * stiffness) - rise

    def suspended(pull: float) -> float:
        return brentq(miss, 1e-9 * length, length, args=(pull,))

    def across(pull: float) -> float:
        s = suspended(pull)
        lies = length - s
        held = 0.5 * friction * weight * lies**2 / stiffness  # of the stretch
        return pull / weight * np.arcsinh(weight * s / pull) + pull * s / stiffness + lies * (1.0 + pull / stiffness) - held

    least = 1e-6 * weight * rise
    most = brentq(lambda pull: miss(length, pull), least, 1e6 * weight * rise)  # where all of it hangs
    pull = brentq(lambda pull: across(pull) - span, least, (1.0 - 1e-9) * most)
    return pull, suspended(pull)
