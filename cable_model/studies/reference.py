"""A converged reference of a scene, with an estimate of its own error: the chain, twice as fine in space and time until it stands."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

from cable_model.scene import Scene
from cable_model.studies.timed import SIGNALS, Scale, Setting, Timed, errors, timed, worst

MOST_WORK = 3e8  # nodes times steps of the finest run
MOST_LEVELS = 6
SLOWEST = 0.7  # fall of a change from one level to the next, above which nothing is expected of further ones
Progress = Callable[[str], None]


@dataclass(frozen=True)
class Level:
    """One refinement: what it cost, and how far it is from the one before."""

    setting: Setting
    run: Timed
    change: dict[str, float]


@dataclass(frozen=True)
class Reference:
    """The finest run; `own_error` is what its last change leaves to expect by the rate at which the changes fell."""

    run: Timed
    scale: Scale
    levels: tuple[Level, ...]
    own_error: dict[str, float]
    converged: bool

    def order(self, signals: tuple[str, ...]) -> float:
        """Of the refinements, as the last two changes show it: 2 where the motion is smooth, less with contact; 2 at most."""
        before, last = (worst(level.change, signals) for level in self.levels[-2:])
        return max(0.5, min(2.0, math.log2(before / last))) if 0.0 < last < before else 2.0

    def errors(self, run: Timed) -> dict[str, float]:
        return errors(run, self.run, self.scale)


def chain_setting(scene: Scene, cells: int, step: float, method: str = "chain", **changes: object) -> Setting:
    """A chain of so many cells and a fixed step; further changes with `__` for the dot."""
    table = {"solver.nodes": cells + 1, "solver.time_step": step, "solver.tolerance": 0.0}
    return Setting(method, "chain", table | {name.replace("__", "."): value for name, value in changes.items()})


def remaining(before: float, last: float) -> float:
    """All further changes over the last one, if they fall as it fell: a third at second order, infinite without a fall."""
    if not math.isfinite(before):
        return math.inf
    fall = max(0.25, last / before) if before > 0.0 else 0.25
    return fall / (1.0 - fall) if fall < SLOWEST else math.inf


def converge(scene: Scene, accuracy: float, signals: tuple[str, ...] = SIGNALS, progress: Progress | None = None) -> Reference:
    """Refine the scene's own grid and step until the expected error of `signals` is a fifth of `accuracy`.

    `converged` is false where the changes do not fall before the runs become too long: motion there is chaotic, or the scene's own
    grid far too coarse; nothing can then be said about errors.
    """
    output = scene.run.output_step
    cells, step = max(scene.solver.nodes - 1, 10), output / math.ceil(output / scene.solver.time_step - 1e-9)
    levels: list[Level] = []
    before: Timed | None = None
    for _ in range(MOST_LEVELS):
        setting = chain_setting(scene, cells, step, "reference", solver__grid="staggered", cable__inextensible=False)
        if progress is not None:
            progress(f"reference: {setting.label}")
        run = timed(scene, setting)
        scale = Scale.of(run) if not run.error else Scale(1.0, 1.0)
        change = errors(before, run, scale) if before is not None else dict.fromkeys(SIGNALS, float("inf"))
        levels.append(Level(setting, run, change))
        if len(levels) > 2:
            left = remaining(worst(levels[-2].change, signals), worst(change, signals))
            if left * worst(change, signals) <= 0.2 * accuracy:
                return Reference(run, scale, tuple(levels), {name: value * left for name, value in change.items()}, True)
        if 8.0 * cells * scene.run.duration / step > MOST_WORK:
            break
        if not run.error:
            before = run
        cells, step = 2 * cells, 0.5 * step
    return Reference(run, scale, tuple(levels), change, False)
