"""The measured basin chain of case H13: the measurements, how far the runs are from them, and both drawn over each other."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from importlib import resources
from pathlib import Path

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np

from cable_model.lab.hard.cases import BASIN_CYCLES, BASIN_RADII, basin_label
from cable_model.lab.hard.record import Record
from cable_model.lab.hard.rules import Finding

LAST = 6  # cycles that are compared
WITH_SERIES = (1.25, 3.5)  # periods at the largest radius of which the measured series is known
Runs = Mapping[str, Record]


def _data(name: str) -> np.ndarray:
    with resources.files("cable_model").joinpath("lab", "hard", "data", name).open(encoding="utf-8") as file:
        return np.loadtxt(file, delimiter=",")


def maxima() -> np.ndarray:
    """Rows (18, 3) of radius m, period s and measured mean cycle maximum of the upper end's tension N [Bergdahl et al. 2016, table 8]."""
    return _data("basin_maxima.csv")


def series(period: float) -> tuple[np.ndarray, np.ndarray]:
    """Times s and measured tensions N at radius 0.2 m."""
    table = _data("basin_series.csv")
    return table[:, 0], table[:, 1 + WITH_SERIES.index(period)]


def scatter(period: float, harmonics: int = 14) -> float:
    """Rms distance of a measured series from its own periodic part, over its range: no periodic answer comes nearer."""
    times, measured = series(period)
    angles = 2.0 * np.pi * np.outer(times, np.arange(harmonics + 1)) / period
    waves = np.hstack([np.cos(angles), np.sin(angles[:, 1:])])
    rest = measured - waves @ np.linalg.lstsq(waves, measured, rcond=None)[0]
    return float(np.sqrt(np.mean(rest**2)) / np.ptp(measured))


def cycles(tension: np.ndarray) -> np.ndarray:
    """Tension of the last cycles, a row each, N."""
    return tension[1:].reshape(BASIN_CYCLES, -1)[-LAST:]


def overlay(tension: np.ndarray, period: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Times, measured series and the run's mean cycle at the phase that fits best: where the measurement began is not known."""
    times, measured = series(period)
    cycle = cycles(tension).mean(axis=0)
    phase = np.arange(1, cycle.size + 1) / cycle.size
    shifts = np.linspace(0.0, 1.0, 500, endpoint=False)
    ours = [np.interp((times / period + shift) % 1.0, phase, cycle, period=1.0) for shift in shifts]
    misses = [np.mean((values - measured) ** 2) for values in ours]
    return times, measured, ours[int(np.argmin(misses))]


def miss(tension: np.ndarray, period: float) -> float:
    """Rms difference of a run from the measured series, over its range."""
    _, measured, ours = overlay(tension, period)
    return float(np.sqrt(np.mean((ours - measured) ** 2)) / np.ptp(measured))


def maxima_error(tension_at: Callable[[float, float], np.ndarray]) -> float:
    """Rms error over all conditions of the mean cycle maximum, N, of a tension given by radius and period."""
    found = [cycles(tension_at(radius, period)).max(axis=1).mean() - measured for radius, period, measured in maxima()]
    return float(np.sqrt(np.mean(np.square(found))))


def findings(runs: Runs) -> list[Finding]:
    """Mean cycle maxima at all measured conditions; the tension is lost in fast cycles; the series against the measured ones."""
    error = maxima_error(lambda radius, period: runs[basin_label(radius, period)]["top.tension"])
    lost = float(cycles(runs[basin_label(0.2, 1.25)]["top.tension"]).min(axis=1).max())
    found = [
        Finding("+", error, 1.5, error <= 1.5, "rms error of the mean cycle maximum over 18 conditions, N"),
        Finding("+", lost, 1.0, lost <= 1.0, "largest of the cycle minima at 0.2 m and 1.25 s, N"),
    ]
    for period, limit in zip(WITH_SERIES, (0.077, 0.048), strict=True):
        apart = miss(runs[basin_label(0.2, period)]["top.tension"], period)
        found.append(
            Finding(
                "+",
                apart,
                limit,
                apart <= limit,
                f"rms difference from the measured series at {period:g} s over its range (published for MoorDyn: {limit:g})",
            )
        )
    return found


def draw(path: Path, runs: Runs) -> None:
    """Both measured series with the runs over them, and all mean cycle maxima against the measured ones."""
    figure, axes = plt.subplot_mosaic([["1.25", "1.25"], ["3.5", "3.5"], ["maxima", "text"]], figsize=(9, 8))
    for period in WITH_SERIES:
        times, measured, values = overlay(runs[basin_label(0.2, period)]["top.tension"], period)
        shown = times <= 6.0 * min(period, 2.5)
        axis = axes[f"{period:g}"]
        axis.plot(times[shown], measured[shown], color="black", linewidth=1.0, label="measured")
        axis.plot(times[shown], values[shown], color="tab:red", linewidth=1.0, label="CableChain, mean cycle")
        axis.set(xlabel="time [s]", ylabel="tension at the upper end [N]", title=f"radius 0.2 m, period {period:g} s")
        axis.legend(fontsize=7, loc="upper right")
        axis.grid(alpha=0.3)
    axis = axes["maxima"]
    for radius, marker in zip(BASIN_RADII, "o^s", strict=True):
        rows = [row for row in maxima() if row[0] == radius]
        axis.plot(
            [row[1] for row in rows], [row[2] for row in rows], color="black", marker=marker, linestyle="none", markerfacecolor="none"
        )
        ours = [cycles(runs[basin_label(radius, row[1])]["top.tension"]).max(axis=1).mean() for row in rows]
        axis.plot([row[1] for row in rows], ours, color="tab:red", marker=".", linewidth=0.8)
    axis.set(xlabel="period [s]", ylabel="mean cycle maximum [N]", title="open: measured; red: CableChain")
    axis.grid(alpha=0.3)
    axes["text"].axis("off")
    words = "\n".join(f"{f.words}: {f.value:.3g}" for f in findings(runs))
    axes["text"].text(0.0, 0.9, words, fontsize=7, verticalalignment="top", wrap=True)
    figure.tight_layout()
    figure.savefig(path, dpi=75)
    plt.close(figure)
