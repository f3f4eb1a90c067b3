"""Free release of a hanging chain: spectra of its tip against the modal series [Gobat 2002, figures 3-5]."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from itertools import pairwise

import matplotlib.pyplot as plt
import numpy as np

from cable_model.lab.published.bounded import run
from cable_model.lab.published.modes import Series, beam_series, bessel_series
from cable_model.lab.published.page import Page
from cable_model.scene import load, with_values

NAME = "figures_3_to_5_free_chain"
MODES = 20
RATE = 20.0  # Hz
WINDOW = 256  # samples, not overlapping
MOST_WORK = 1.5  # times the steps asked for, before a run is given up
SIX: Mapping[str, Mapping[str, object]] = {
    "box method": {"solver.lambda_infinity": -1.0},
    "trapezoidal rule": {"solver.integrator": "trapezoidal"},
    "backward differences": {"solver.integrator": "backward-difference"},
    "lambda -0.5": {"solver.lambda_infinity": -0.5},
    "lambda 0": {"solver.lambda_infinity": 0.0},
    "lambda 0.25": {"solver.lambda_infinity": 0.25},
}
GRIDS: Mapping[str, Mapping[str, object]] = {
    "box grid": {"solver.grid": "box", "solver.grading": 1.0},
    "staggered grid": {"solver.grid": "staggered", "solver.grading": 0.0},
}
Key = tuple[str, str, int, float]  # grid, member, nodes, step


@dataclass(frozen=True)
class Spectra:
    """Peaks (modes,) of the tip's power spectrum at each mode: of the beam's series, of Bessel's, and of every run."""

    beam: Series
    bessel: Series
    of_beam: np.ndarray
    of_bessel: np.ndarray
    of_runs: dict[Key, np.ndarray]
    accurate: tuple[np.ndarray, np.ndarray]  # frequencies and amplitudes of the first five modes of the most accurate run
    accurate_run: Key


def power(tip: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Angular frequencies and mean power spectrum of windows that do not overlap.

    Each is weighted by Hann's function: unweighted, the first mode leaks over all from about the tenth on, and every run would agree there.
    """
    hann = np.hanning(WINDOW)
    windows = tip[: len(tip) // WINDOW * WINDOW].reshape(-1, WINDOW)
    spectrum = np.mean(np.abs(np.fft.rfft(hann * (windows - windows.mean()), axis=1)) ** 2, axis=0) / (RATE * np.sum(hann**2))
    return 2.0 * np.pi * np.fft.rfftfreq(WINDOW, 1.0 / RATE), spectrum


def peaks(tip: np.ndarray, frequencies: np.ndarray) -> np.ndarray:
    """Largest power nearer to each mode than to its neighbours."""
    omega, spectrum = power(tip)
    edges = np.concatenate(([0.2], 0.5 * (frequencies[1:] + frequencies[:-1]), [1.5 * frequencies[-1] - 0.5 * frequencies[-2]]))
    return np.array([spectrum[(omega >= low) & (omega < high)].max() for low, high in pairwise(edges)])


def fitted(tip: np.ndarray, near: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Frequencies and amplitudes of the spectral lines near the given ones, over the whole series under a Hann window."""
    from scipy.optimize import minimize_scalar

    window = np.hanning(len(tip))
    times = np.arange(len(tip)) / RATE

    def amplitude(omega: float) -> float:
        return 2.0 * float(abs(np.sum(window * tip * np.exp(-1j * omega * times)))) / float(window.sum())

    found = [
        minimize_scalar(lambda w: -amplitude(w), bounds=(w0 - 0.05, w0 + 0.05), method="bounded", options={"xatol": 1e-9}) for w0 in near
    ]
    return np.array([f.x for f in found]), np.array([-f.fun for f in found])


def tip_of(key: Key, duration: float) -> np.ndarray:
    """The tip's motion at RATE, (rows,); not numbers from where the run was given up."""
    grid, member, nodes, step = key
    changes = {**GRIDS[grid], **SIX[member], "solver.nodes": nodes, "solver.time_step": step}
    scene = with_values(load("free_chain"), {**changes, "run.duration": duration, "run.output_step": 1.0 / RATE})
    found, _ = run(scene, MOST_WORK * duration / step)
    tip = np.full(round(duration * RATE) + 1, np.nan)
    tip[: len(found.times)] = found.position[:, 0]
    return tip


def wanted(quick: bool) -> list[Key]:
    """Figure 3 on both grids; figure 4 on the staggered; figure 5: the box grid's nodes, and ours."""
    if quick:
        return [("staggered grid", member, 26, 0.01) for member in SIX]
    keys: list[Key] = [(grid, member, 50, 0.01) for grid in GRIDS for member in SIX]
    keys += [("staggered grid", member, 50, 0.001) for member in SIX if member != "trapezoidal rule"]  # unstable
    keys += [("box grid", "lambda -0.5", nodes, 0.005) for nodes in (50, 100, 200, 400, 800)]
    return keys + [("staggered grid", "lambda -0.5", nodes, 0.001) for nodes in (26, 100, 200, 400, 800)]


def measure(quick: bool = False, told: Callable[[str], None] | None = None) -> Spectra:
    duration = 60.0 if quick else 400.0
    times = np.arange(round(duration * RATE) + 1) / RATE
    beam, bessel = beam_series(MODES, load("free_chain").cable.bending_stiffness), bessel_series(MODES)
    of_runs = {}
    accurate: Key = ("staggered grid", "lambda -0.5", 26, 0.01) if quick else ("staggered grid", "lambda -0.5", 800, 0.001)
    lines = (np.zeros(5), np.zeros(5))
    for key in wanted(quick):
        if told is not None:
            told(f"{key[0]}, {key[1]}, {key[2]} nodes, step {key[3]:g} s")
        tip = tip_of(key, duration)
        of_runs[key] = peaks(tip, beam.frequencies)
        if key == accurate:
            lines = fitted(tip, beam.frequencies[:5])
    return Spectra(
        beam, bessel, peaks(beam.tip(times), beam.frequencies), peaks(bessel.tip(times), bessel.frequencies), of_runs, lines, accurate
    )


def kept(found: Spectra, key: Key, within: float = 2.0) -> int:
    """Modes from the first on whose peaks are within a factor of the series'."""
    ratio = found.of_runs[key] / found.of_beam
    wrong = ~((ratio < within) & (ratio > 1.0 / within))
    return int(np.argmax(wrong)) if wrong.any() else len(ratio)


def _told(found: Spectra, key: Key) -> str:
    return "given up" if np.isnan(found.of_runs[key]).all() else str(kept(found, key))


def _panel(axis: plt.Axes, found: Spectra, keys: list[Key], label: Callable[[Key], str], title: str) -> None:
    axis.plot(
        found.beam.frequencies, found.of_beam, "o-", color="black", markerfacecolor="none", markersize=7, linewidth=0.6, label="modes"
    )
    single = len({key[1] for key in keys}) == 1
    for i, key in enumerate(keys):
        k = i if single else list(SIX).index(key[1])  # a member looks the same in every panel
        words = label(key) + (" (given up)" if np.isnan(found.of_runs[key]).all() else "")
        axis.plot(found.beam.frequencies, found.of_runs[key], "xv+sd^*<>ph"[k], color=f"C{k}", markersize=5, label=words)
    axis.set(yscale="log", ylim=(1e-3 * found.of_beam.min(), 5.0 * found.of_beam[0]), title=title, xlabel="frequency [rad/s]")
    axis.grid(alpha=0.3)
    axis.legend(fontsize=7)


def page(found: Spectra) -> Page:
    groups: dict[str, list[Key]] = {}
    for key in found.of_runs:
        groups.setdefault(f"{key[0]}, {key[2]} nodes, dt {key[3]:g} s", []).append(key)
    sixes = {title: keys for title, keys in groups.items() if len(keys) > 4}
    finer = [key for key in found.of_runs if key[1] == "lambda -0.5" and key[3] < 0.01]
    count = len(sixes) + bool(finer)
    figure, panels = plt.subplots(1, count, figsize=(4.6 * count, 5), sharey=True, squeeze=False)
    for axis, (title, keys) in zip(panels[0], sixes.items(), strict=False):
        _panel(axis, found, keys, lambda key: key[1], title)
    if finer:
        _panel(panels[0][-1], found, finer, lambda key: f"{key[0]}, {key[2]} nodes, dt {key[3]:g}", "lambda -0.5, finer")
    panels[0][0].set_ylabel("peak of the tip's power spectrum [m2/Hz]")
    best = found.accurate_run
    apart = np.abs(found.accurate[0] / found.beam.frequencies[:5] - 1.0).max()
    modes = "; ".join(f"{title}: " + ", ".join(f"{key[1]} {_told(found, key)}" for key in keys) for title, keys in sixes.items())
    nodes = ", ".join(f"{key[0]} {key[2]} nodes {_told(found, key)}" for key in finer)
    caption = (
        f"[Gobat 2002, figures 3-5]: peaks of the tip's power spectrum (Hann windows of {WINDOW} samples at {RATE:g} Hz) against the "
        f"series of the first {MODES} modes with bending.  Modes from the first on within a factor of 2 of the series: {modes}.  "
        + (f"Finer, lambda -0.5: {nodes}.  " if finer else "")
        + f"{best[0].capitalize()}, {best[1]}, {best[2]} nodes, dt {best[3]:g} s: first five frequencies within {apart:.1e} of the beam's."
    )
    shown: list[tuple[object, ...]] = [("mode", "beam [rad/s]", "without bending", "found", "beam's amplitude [m]", "found")]
    for k in range(5):
        of = (found.beam.frequencies[k], found.bessel.frequencies[k], found.accurate[0][k])
        size = (found.beam.amplitudes[k], found.accurate[1][k])
        shown.append((str(k + 1), *(f"{w:.5f}" for w in of), *(f"{abs(a):.4e}" for a in size)))
    head = ("grid", "member", "nodes", "step s", *(f"mode {k + 1}" for k in range(MODES)))
    rows: list[tuple[object, ...]] = [("series", "with bending", "", "", *map(float, found.of_beam))]
    rows.append(("series", "without bending", "", "", *map(float, found.of_bessel)))
    rows += [(*key, *map(float, values)) for key, values in found.of_runs.items()]
    return Page(NAME, "Figures 3 to 5: free release of a hanging chain", caption, figure, head, rows, shown)
