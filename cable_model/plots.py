"""Pictures of runs: tension and body motion over time, the body's path, and the shape of the cable at several moments."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.ticker import MaxNLocator

from cable_model.errors import ParameterError, writing
from cable_model.scene import Scene
from cable_model.simulation import Result
from cable_model.surroundings import has, seabed_between

COLOURS = ("#1f5a99", "#d1602b", "#3b8f5a", "#7a4fa3")  # told apart by colour-blind readers too
STYLES = ("-", "--", "-.", ":")
SEA, SEABED, GREY = "#3f8fcb", "#b08d55", "#6b7580"
STEADY = 1e-3  # of the largest value: an axis that spans less shows rounding as motion
STEADY_WAY = 1e-4  # the same of ways, of the cable's length


def check_kind(path: Path) -> None:
    """Refuse a file that no picture can be written to."""
    kinds = FigureCanvasAgg.filetypes
    if path.is_dir() or path.suffix.removeprefix(".").lower() not in kinds:
        raise ParameterError(f"{path}: no name of a picture file. Give one that ends in one of .{', .'.join(sorted(kinds))}.")


def picture(results: dict[str, Result], scene: Scene, title: str, path: Path) -> None:
    """Draw one or more runs of a scene over each other and save the picture."""
    figure = Figure(figsize=(13, 9))
    FigureCanvasAgg(figure)
    axes = figure.subplot_mosaic([["tension", "tension", "shape"], ["body", "body", "shape"], ["body2", "body2", "path"]])
    for (label, run), colour, style in zip(results.items(), COLOURS, STYLES, strict=False):
        line: dict[str, Any] = {"color": colour, "linestyle": style, "linewidth": 1.4, "label": label}
        axes["tension"].plot(run["time"], run["top.tension"], **line)
        axes["body"].plot(run["time"], run["body.x"], **line)
        axes["body2"].plot(run["time"], run["body.z"], **line)
        axes["path"].plot(run["body.x"], run["body.z"], **line)
    _shapes(axes["shape"], results)
    _label(axes)
    _around(axes["shape"], scene, results)
    way = STEADY_WAY * max(length_of(run) for run in results.values())
    open_axis(axes["tension"], STEADY * max(np.abs(run["top.tension"]).max() for run in results.values()))
    for key in ("body", "body2"):
        open_axis(axes[key], way)
    figure.suptitle(title, parse_math=False)
    figure.tight_layout()
    path.parent.mkdir(parents=True, exist_ok=True)
    with writing(path):
        figure.savefig(path, dpi=110)


def length_of(run: Result) -> float:
    """Of the cable as it lies at the start, m."""
    return float(np.sum(np.linalg.norm(np.diff(run.shapes[0], axis=0), axis=1)))


def opened(low: float, high: float, least: float) -> tuple[float, float]:
    """Limits about the same middle, at least `least` apart."""
    half = 0.5 * max(high - low, least)
    return 0.5 * (low + high) - half, 0.5 * (low + high) + half


def open_axis(axis: Axes, least: float) -> None:
    """Let the upright axis span at least `least`."""
    axis.set_ylim(opened(*axis.get_ylim(), least))


def _shapes(axis: Axes, results: dict[str, Result]) -> None:
    """Six snapshots of the last quarter of every run, darker as time goes on; an FMU tells its two ends only."""
    for (label, run), colour, style in zip(results.items(), COLOURS, STYLES, strict=False):
        count = len(run.shapes)
        moments = np.unique(np.linspace(0.75 * (count - 1), count - 1, 6).astype(int))
        for shade, k in zip(np.linspace(0.3, 1.0, len(moments)), moments, strict=True):
            shape = run.shapes[k]
            name = label if k == moments[-1] else None
            axis.plot(shape[:, 0], shape[:, 2], color=colour, linestyle=style, alpha=shade, linewidth=1.2, label=name)
            axis.plot(shape[0, 0], shape[0, 2], "o", color=colour, alpha=shade, markersize=3)


def _around(axis: Axes, scene: Scene, results: dict[str, Result]) -> None:
    """Still water and bottom in the plane of the shapes, where they are near, with the same scale both ways."""
    low, high = (reach([reach(run.shapes, axis=(0, 1)) for run in results.values()], axis=0) for reach in (np.min, np.max))
    far = float(np.max(high - low))
    axis.set_aspect("equal", adjustable="datalim")
    if has("surface", scene) and low[2] - far < 0.0 < high[2] + far:
        axis.axhline(0.0, color=SEA, linewidth=1.0, zorder=0)
    low[0], high[0] = low[0] - far, high[0] + far
    bed = seabed_between(scene, low, high)
    if bed is not None and bed.heights.max() > low[2] - far:
        axis.add_artist(Line2D(bed.x, bed.at(0)[len(bed.y) // 2], color=SEABED, linewidth=1.5, zorder=0))  # does not ask for room


def _label(axes: dict[str, Axes]) -> None:
    for key, ylabel in (("tension", "top tension [N]"), ("body", "lower end x [m]"), ("body2", "lower end z [m]")):
        axes[key].set(xlabel="time [s]", ylabel=ylabel)
    axes["path"].set(xlabel="x [m]", ylabel="z [m]", title="path of the lower end")
    axes["shape"].set(xlabel="x [m]", ylabel="z [m]", title="shape, last quarter")
    for key, axis in axes.items():
        axis.grid(alpha=0.3)
        if key in ("path", "shape"):
            axis.xaxis.set_major_locator(MaxNLocator(4))
    axes["tension"].legend(loc="upper right")
    axes["shape"].legend(loc="best")
