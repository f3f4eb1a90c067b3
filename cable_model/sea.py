"""The components of a sea: one regular wave, a table, or a spectrum in bins of equal energy; the table that the kernels sum."""

from __future__ import annotations

import math

import numpy as np

from cable_model.parameters import Waves

LOWEST, HIGHEST = 0.3, 6.0  # of the peak frequency: beyond them the spectra hold less than 1 % of the energy
DEEP = 40.0  # k depth beyond which water is deep


def wave_number(omega: float, depth: float, gravity: float) -> float:
    """k of omega^2 = g k tanh(k depth), 1/m, by Newton's method; depth 0: deep water."""
    deep = omega * omega / gravity
    if depth <= 0.0 or deep * depth > DEEP:
        return deep
    y = deep * depth
    x = y / math.sqrt(math.tanh(y))  # k depth; within 6 % everywhere
    for _ in range(20):
        t = math.tanh(x)
        step = (x * t - y) / (t + x * (1.0 - t * t))
        x -= step
        if abs(step) <= 1e-15 * x:
            break
    return x / depth


def spectral_density(waves: Waves, omega: np.ndarray) -> np.ndarray:
    """Pierson-Moskowitz or JONSWAP density at angular frequencies (k,), m2 s, not yet scaled to the significant height.

    omega^-5 exp(-5/4 (omega_p/omega)^4), times gamma^exp(-(omega/omega_p - 1)^2/(2 sigma^2)) with sigma 0.07 below and 0.09 above
    the peak [Hasselmann et al. 1973].
    """
    ratio = omega * waves.peak_period / (2.0 * math.pi)
    density = ratio**-5.0 * np.exp(-1.25 * ratio**-4.0)
    if waves.spectrum == "jonswap":
        width = np.where(ratio <= 1.0, 0.07, 0.09)
        density = density * waves.peakedness ** np.exp(-((ratio - 1.0) ** 2) / (2.0 * width**2))
    return density


def _from_spectrum(waves: Waves) -> np.ndarray:
    """Rows of amplitude, angular frequency, direction, phase: equal amplitudes, frequencies at the middle of each bin's energy.

    The frequencies have no common period, so the sea does not repeat itself.
    """
    from scipy.integrate import cumulative_simpson  # here only: FMUs do without scipy

    peak = 2.0 * math.pi / waves.peak_period
    omega = peak * np.geomspace(LOWEST, HIGHEST, 20001)
    energy = cumulative_simpson(spectral_density(waves, omega), x=omega, initial=0.0)
    middles = (np.arange(waves.components) + 0.5) / waves.components
    frequencies = np.interp(middles * energy[-1], energy, omega)
    amplitude = waves.significant_height / math.sqrt(8.0 * waves.components)  # sum of a^2/2 = Hs^2/16
    phases = np.random.default_rng(waves.seed).uniform(0.0, 2.0 * math.pi, waves.components)
    return np.column_stack((np.full(waves.components, amplitude), frequencies, np.full(waves.components, waves.direction), phases))


def components(waves: Waves, gravity: float, depth: float) -> np.ndarray | None:
    """The table (k, 6) of kernels.waves, or None where there are no waves."""
    if waves.spectrum != "none" and waves.significant_height > 0.0:
        rows = _from_spectrum(waves)
    elif waves.table:
        given = np.array(waves.table)
        rows = np.column_stack((given[:, 0], 2.0 * math.pi / given[:, 1], given[:, 2], given[:, 3]))
    elif waves.amplitude > 0.0:
        rows = np.array([[waves.amplitude, 2.0 * math.pi / waves.period, waves.direction, waves.phase]])
    else:
        return None
    numbers = [wave_number(omega, depth, gravity) for omega in rows[:, 1]]
    table = np.column_stack((rows[:, 0], rows[:, 1], numbers, rows[:, 2], rows[:, 3], np.full(len(rows), depth)))
    return np.ascontiguousarray(table)
