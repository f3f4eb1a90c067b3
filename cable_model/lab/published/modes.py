"""The modes of a chain hanging at rest (m = g = L = 1): let go from a sideways pull at its tip, and shifted at its top."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from cable_model.motion import fade_in


@dataclass(frozen=True)
class Series:
    """Tip motion sum of amplitudes (modes,) times cos(frequencies (modes,) t)."""

    frequencies: np.ndarray
    amplitudes: np.ndarray

    def tip(self, times: np.ndarray) -> np.ndarray:
        return np.cos(np.outer(times, self.frequencies)) @ self.amplitudes


def bessel_series(count: int, pull: float = 0.001) -> Series:
    """Without bending: roots of J0(2 omega), and the catenary pull (asinh(1/pull) - asinh(s/pull)) in modes J0(2 omega sqrt(s)).

    [Gobat 2002, eqs 27-32]
    """
    from scipy.special import j0, j1, jn_zeros

    frequencies = jn_zeros(0, count) / 2.0
    x, weights = np.polynomial.legendre.leggauss(600)
    x, weights = 0.5 * (x + 1.0), 0.5 * weights
    start = pull * (np.arcsinh(1.0 / pull) - np.arcsinh(x * x / pull)) * 2.0 * x * weights  # s = x^2
    return Series(frequencies, np.array([np.dot(start, j0(2.0 * w * x)) / j1(2.0 * w) ** 2 for w in frequencies]))


def displaced_tip(times: np.ndarray, ramp_time: float, count: int = 80) -> np.ndarray:
    """Tip of the chain without bending, over the shift of its top, which is moved aside within ramp_time as motion.fade_in moves it.

    Modes J0(2 omega sqrt(s)) under the top's acceleration, the convolution by Gauss's rule.
    """
    from scipy.special import j1, jn_zeros

    omega = jn_zeros(0, count) / 2.0
    share = 1.0 / (omega**2 * j1(2.0 * omega))  # of a rigid shift in each mode, 1/(omega J1), over omega
    x, weights = np.polynomial.legendre.leggauss(400)
    tip = np.array([fade_in(t, ramp_time)[0] for t in times])
    for k, t in enumerate(times):
        half = 0.5 * min(t, ramp_time)
        moments = half * (x + 1.0)
        pushed = half * weights * [fade_in(moment, ramp_time)[2] for moment in moments]
        tip[k] -= share @ np.sin(np.outer(omega, t - moments)) @ pushed
    return tip


def beam_series(count: int, bending: float, pull: float = 0.001, elements: int = 80) -> Series:
    """With bending stiffness and a hinged top: Hermite beam elements, finer towards the free end, pulled aside at rest."""
    from scipy.linalg import eigh

    stiffness, mass = _beam(elements, bending)
    squares, modes = eigh(stiffness, mass)
    force = np.zeros(len(mass))
    force[0] = pull
    start = np.linalg.solve(stiffness, force)
    return Series(np.sqrt(squares[:count]), (modes[0] * (modes.T @ mass @ start))[:count])


def _beam(elements: int, bending: float) -> tuple[np.ndarray, np.ndarray]:
    """Stiffness and mass of deflections and slopes from the free end up; the deflection of the top is left out."""
    nodes = (np.arange(elements + 1) / elements) ** 1.5
    xi, weights = np.polynomial.legendre.leggauss(5)
    xi, weights = 0.5 * (xi + 1.0), 0.5 * weights
    size = 2 * (elements + 1)
    stiffness, mass = np.zeros((size, size)), np.zeros((size, size))
    for e in range(elements):
        h = nodes[e + 1] - nodes[e]
        shape = np.array([1 - 3 * xi**2 + 2 * xi**3, h * (xi - 2 * xi**2 + xi**3), 3 * xi**2 - 2 * xi**3, h * (xi**3 - xi**2)])
        slope = np.array([-6 * xi + 6 * xi**2, h * (1 - 4 * xi + 3 * xi**2), 6 * xi - 6 * xi**2, h * (3 * xi**2 - 2 * xi)]) / h
        bend = np.array([-6 + 12 * xi, h * (-4 + 6 * xi), 6 - 12 * xi, h * (6 * xi - 2)]) / h**2
        at = slice(2 * e, 2 * e + 4)
        tension = nodes[e] + h * xi
        stiffness[at, at] += h * ((slope * weights * tension) @ slope.T + bending * (bend * weights) @ bend.T)
        mass[at, at] += h * (shape * weights) @ shape.T
    free = [k for k in range(size) if k != size - 2]
    return stiffness[np.ix_(free, free)], mass[np.ix_(free, free)]
