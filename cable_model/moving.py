"""What a moving picture of runs shows: few enough moments and points, the water's surface and the seabed around them, one box in space."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from cable_model.plots import STEADY, STEADY_WAY
from cable_model.scene import Scene
from cable_model.simulation import Result
from cable_model.surroundings import Surface, has, seabed_between, surface_between

MOST_POINTS = 61  # along a cable
WIDTH = 0.25  # of the box's longest side: what a side has at least
FRAME = (0.05, 0.1)  # s that a moment is shown at least and at most: shorter hurries, longer is dull
GRAVITY = 9.81  # m/s2, for a scale of speeds
NEAR = 1.0  # of the longest side: how far from the cable water's surface and seabed still belong in the picture


@dataclass(frozen=True)
class Moving:
    """One model's cable at moments: places (moments, points, 3), m, lower end first, and tensions (moments, points), N, where told."""

    run: Result
    places: np.ndarray
    tensions: np.ndarray | None


@dataclass(frozen=True)
class Picture:
    """Runs of one scene at common moments (k,), s, in the box between two corners (3,), m; what is None is absent or far away."""

    times: np.ndarray
    cables: dict[str, Moving]
    low: np.ndarray
    high: np.ndarray
    surface: Surface | None
    seabed: Surface | None
    output_steps: float  # of the run, from one moment to the next, on average

    @property
    def pace(self) -> float:
        """How long a moment is shown, s: as long as it lasted, within FRAME."""
        lasted = float(np.ptp(self.times)) / max(1, len(self.times) - 1)
        return min(max(lasted, FRAME[0]), FRAME[1])

    @property
    def speed(self) -> float:
        """Of what is shown over that of the run."""
        return float(np.ptp(self.times)) / (self.pace * max(1, len(self.times) - 1))

    @property
    def size(self) -> float:
        """The longest side, m."""
        return float(np.max(self.high - self.low))


@dataclass(frozen=True)
class Panel:
    """Time series of a run on one axis: its label, lines by their names, (rows,) each, and what the axis spans at least."""

    label: str
    lines: dict[str, np.ndarray]
    least: float


def is_held(scene: Scene) -> bool:
    """Whether the lower end is anchored, or moved by inputs."""
    return has("anchor", scene)


def word_of_lower_end(scene: Scene) -> str:
    """What is there."""
    if is_held(scene):
        return "driven end" if has("driven", scene) else "anchor"
    return "body" if scene.body.mass > 0.0 else "free end"


def panels(run: Result, scene: Scene) -> tuple[Panel, Panel, Panel]:
    """What tells most about a run: the tension above, that below or, of a free end, its speed, and where the end that moves is."""
    pull, way = STEADY * float(np.abs(run["top.tension"]).max()), STEADY_WAY * scene.cable.length
    below = Panel(f"tension at the {word_of_lower_end(scene)} [N]", {"": run["body.tension"]}, pull)
    if not is_held(scene) and scene.body.mass == 0.0:
        speed = np.sqrt(sum(run[f"body.v{axis}"] ** 2 for axis in "xyz"))
        below = Panel("speed of the free end [m/s]", {"": speed}, STEADY_WAY * math.sqrt(GRAVITY * scene.cable.length))
    end, word = ("top", "top") if is_held(scene) else ("body", "lower end")
    axes = "xyz" if scene.solver.space else "xz"
    moved = {axis: run[f"{end}.{axis}"] - run[f"{end}.{axis}"][0] for axis in axes}
    return Panel("top tension [N]", {"": run["top.tension"]}, pull), below, Panel(f"{word} from its start [m]", moved, way)


def evenly(count: int, most: int) -> np.ndarray:
    """At most `most` indices of `count`, evenly spread, the first and the last among them."""
    return np.unique(np.linspace(0, count - 1, min(count, most)).round().astype(int))


def keeping_peaks(series: np.ndarray, most: int) -> np.ndarray:
    """At most `most` indices of a series: the smallest and the largest value of each of equal parts, so that no peak is lost."""
    if len(series) <= most:
        return np.arange(len(series))
    parts = np.array_split(np.arange(len(series)), most // 2)
    return np.unique([part[pick(series[part])] for part in parts for pick in (np.argmin, np.argmax)])


def arrange(results: Mapping[str, Result], scene: Scene, most_moments: int) -> Picture:
    """The picture of one or more runs of a scene; a run that stopped early stays where it stopped."""
    longest = max(results.values(), key=lambda run: len(run.table))
    moments = evenly(len(longest.table), most_moments)
    times = longest["time"][moments]
    cables = {label: _thinned(run, moments, k == 0) for k, (label, run) in enumerate(results.items())}
    low = np.min([moving.places.min(axis=(0, 1)) for moving in cables.values()], axis=0)
    high = np.max([moving.places.max(axis=(0, 1)) for moving in cables.values()], axis=0)
    reach = NEAR * float(np.max(high - low))
    seabed = seabed_between(scene, low, high)
    if seabed is not None and seabed.heights.max() <= low[2] - reach:
        seabed = None
    near = has("surface", scene) and low[2] - reach < 0.0 < high[2] + reach
    levels = [low[2], high[2], *(seabed.heights.ravel() if seabed is not None else []), *([0.0] if near else [])]
    low[2], high[2] = min(levels), max(levels)
    low, high = _roomy(low, high)
    if seabed is not None:
        seabed = seabed_between(scene, low, high) or seabed
        low[2], high[2] = min(low[2], seabed.heights.min()), max(high[2], seabed.heights.max())
    surface = surface_between(scene, times, low, high) if near else None
    if surface is not None:
        low[2], high[2] = min(low[2], surface.heights.min()), max(high[2], surface.heights.max())
    return Picture(times, cables, low, high, surface, seabed, (len(longest.table) - 1) / max(1, len(moments) - 1))


def _thinned(run: Result, moments: np.ndarray, coloured: bool) -> Moving:
    """A run at moments; only one of several is coloured by its tensions, or none could be read."""
    rows = np.minimum(moments, len(run.table) - 1)
    points = evenly(run.shapes.shape[1], MOST_POINTS)
    tensions = run.tensions[rows][:, points] if run.tensions is not None and coloured else None
    return Moving(run, run.shapes[rows][:, points], tensions)


def _roomy(low: np.ndarray, high: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The box with some air, and no side of it so short that a plane motion would be shown in a slit."""
    longest = float(np.max(high - low))
    half = np.maximum(0.5 * (high - low) + 0.03 * longest, 0.5 * WIDTH * longest)
    middle = 0.5 * (low + high)
    return middle - half, middle + half
