"""The components of a sea: one regular wave, a table, a record, or a spectrum in bands; the table that the kernels sum."""

from __future__ import annotations

import math

import numpy as np

from cable_model.parameters import Waves

PERIODS = np.linspace(0.0, 2.4, 2401)  # over the peak's: on longer waves the spectra have 1e-18 of their energy
GAUSS = np.polynomial.legendre.leggauss(4)
LOWER = 0.75  # share of the lower wave in the energy of the last band
GOLDEN = 0.5 * (math.sqrt(5.0) - 1.0)
KEPT = 0.9999  # of a record's variance: the largest components that together have it; the rest is 1 % of its deviation
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


def _moments(waves: Waves, periods: np.ndarray) -> np.ndarray:
    """Integrals of S, S omega and S omega^2 (3, k), not scaled, over the intervals between periods (k + 1,), over the peak's period.

    Over the period T = 1/r in place of the frequency r, both over the peak's, S omega^n d omega ~ T^(3-n) exp(-5/4 T^4) dT is smooth
    down to T = 0: what is integrated has no tail.
    """
    half = 0.5 * np.diff(periods)[:, None]
    t = periods[:-1, None] + half * (1.0 + GAUSS[0])
    peak = 2.0 * math.pi / waves.peak_period
    share = half * GAUSS[1] * spectral_density(waves, peak / t) * peak / t**2
    return np.array([np.sum(share * (peak / t) ** n, axis=1) for n in range(3)])


def _bands(waves: Waves, count: int) -> np.ndarray:
    """Moments 0, 1, 2 (3, count), not scaled, of bands of equal integral of S omega, from long waves to short."""
    first = np.concatenate(([0.0], np.cumsum(_moments(waves, PERIODS)[1])))
    edges = np.interp(np.linspace(0.0, first[-1], count + 1), first, PERIODS)
    points = np.union1d(PERIODS, edges)
    return np.add.reduceat(_moments(waves, points), np.searchsorted(points, edges[:-1]), axis=1)[:, ::-1]


def _energies(waves: Waves) -> tuple[np.ndarray, np.ndarray]:
    """Energy a^2/2, m2, and angular frequency, rad/s, of each component (k,); together they have the moments of the whole spectrum.

    A band of moments m0, m1, m2 is one wave of energy m0 and frequency sqrt(m2/m0): height and zero-crossing period are exact, and the
    band's mean frequency is too high by half its relative variance.  That is little but in the last band, which reaches to infinity
    (6 %), so this one is two waves about its mean m1/m0 that keep all three; unequal ones, or the lower would be among the band below.
    The sea's m1 is then within 0.04, 0.011, 0.003 % with 20, 60, 200 components.  As the bands differ in width, the sea does not repeat:
    within three hours its autocorrelation returns to 0.70, 0.42, 0.29 at most, as of independent frequencies (tests/test_sea.py).
    """
    m0, m1, m2 = _bands(waves, max(waves.components - 1, 1))
    frequencies = np.sqrt(m2 / m0)
    if waves.components > 1:
        mean = m1[-1] / m0[-1]
        deviation = math.sqrt(m2[-1] / m0[-1] - mean**2)
        off = math.sqrt((1.0 - LOWER) / LOWER)
        pair = (mean - deviation * off, mean + deviation / off)
        frequencies = np.append(frequencies[:-1], pair)
        m0 = np.append(m0[:-1], (LOWER * m0[-1], (1.0 - LOWER) * m0[-1]))
    return m0 * (waves.significant_height**2 / 16.0 / np.sum(m0)), frequencies


def _directions(waves: Waves, energies: np.ndarray, start: float) -> np.ndarray:
    """Direction of each component (k,), rad: energy spreads as cos^n(theta - theta_0), at most a right angle from the main theta_0.

    This is cos^2s with 2s = n, as offshore codes have it [OrcaFlex, data for random waves; DeepLines theory, wave directional spreading],
    not the cos^2s of half the angle, to which n = (s - 1)/2 comes near.  Each component gets the middle of its own share of the
    distribution.  Which share it gets goes by the golden section from one frequency to the next, from `start` (0..1): so the waves of any
    part of the spectrum spread alike, which a random order leaves to chance.
    """
    if waves.spreading_exponent == 0.0:
        return np.full(len(energies), waves.direction)
    order = np.argsort((start + GOLDEN * np.arange(len(energies))) % 1.0)
    ordered = energies[order]
    angles = np.linspace(-0.5 * math.pi, 0.5 * math.pi, 20001)
    below = np.concatenate(([0.0], np.cumsum(np.cos(0.5 * (angles[1:] + angles[:-1])) ** waves.spreading_exponent)))
    middles = (np.cumsum(ordered) - 0.5 * ordered) / np.sum(energies)
    directions = np.empty(len(energies))
    directions[order] = waves.direction + np.interp(middles * below[-1], below, angles)
    return directions


def _from_spectrum(waves: Waves) -> np.ndarray:
    """Rows of amplitude, angular frequency, direction, phase."""
    random = np.random.default_rng(waves.seed)
    energies, frequencies = _energies(waves)
    phases = random.uniform(0.0, 2.0 * math.pi, waves.components)
    return np.column_stack((np.sqrt(2.0 * energies), frequencies, _directions(waves, energies, random.uniform()), phases))


def _from_record(waves: Waves) -> np.ndarray:
    """Rows of amplitude, angular frequency, direction, phase: the Fourier series of a record, less its mean.

    It is the record at its times, but for what KEPT leaves out, and repeats after it; its step from the last row to the first is in it too.
    """
    rows = np.array(waves.record)
    count = len(rows)
    step = (rows[-1, 0] - rows[0, 0]) / (count - 1)
    terms = np.fft.rfft(rows[:, 1])[1:] * (2.0 / count)
    if count % 2 == 0:
        terms[-1] *= 0.5  # the highest is there once
    frequencies = 2.0 * math.pi / (count * step) * np.arange(1, len(terms) + 1)
    amplitudes = np.abs(terms)
    phases = frequencies * rows[0, 0] - np.angle(terms)
    order = np.argsort(-amplitudes, kind="stable")
    variance = np.cumsum(amplitudes[order] ** 2)
    kept = np.sort(order[: 1 + int(np.searchsorted(variance, KEPT * variance[-1]))])
    return np.column_stack((amplitudes[kept], frequencies[kept], np.full(len(kept), waves.direction), phases[kept]))


def components(waves: Waves, gravity: float, depth: float) -> np.ndarray | None:
    """Rows (k, 6) of amplitude, angular frequency, wave number, direction, phase, depth (0: deep); None where there are no waves."""
    if waves.spectrum != "none" and waves.significant_height > 0.0:
        rows = _from_spectrum(waves)
    elif waves.table:
        given = np.array(waves.table)
        rows = np.column_stack((given[:, 0], 2.0 * math.pi / given[:, 1], given[:, 2], given[:, 3]))
    elif waves.record:
        rows = _from_record(waves)
    elif waves.amplitude > 0.0:
        rows = np.array([[waves.amplitude, 2.0 * math.pi / waves.period, waves.direction, waves.phase]])
    else:
        return None
    numbers = [wave_number(omega, depth, gravity) for omega in rows[:, 1]]
    return np.column_stack((rows[:, 0], rows[:, 1], numbers, rows[:, 2], rows[:, 3], np.full(len(rows), depth)))


def table_of(rows: np.ndarray) -> np.ndarray:
    """The table (10, k) of kernels.wave_sums from rows of `components`: by rising wave number."""
    amplitude, frequency, number, direction, phase, depth = rows[np.argsort(rows[:, 2], kind="stable")].T
    cosine = np.cos(direction)
    deep = 1.0 - np.exp(-2.0 * number * np.where(depth > 0.0, depth, np.inf))
    speed = amplitude * frequency / deep
    highest = np.full_like(amplitude, amplitude.sum())
    table = (amplitude, frequency, number, cosine, np.sin(direction), np.copysign(1.0, cosine), phase, depth, speed, highest)
    return np.ascontiguousarray(table)


def rows_of(table: np.ndarray) -> np.ndarray:
    """The inverse of `table_of`, but for the order."""
    amplitude, frequency, number, cosine, sine, _, phase, depth, _, _ = table
    return np.column_stack((amplitude, frequency, number, np.arctan2(sine, cosine), phase, depth))
