"""Advice for a scene: the cheapest model, effects, nodes, step or tolerance that meet a wanted accuracy, found by measured refinement."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace

from cable_model.scene import Scene, with_values
from cable_model.studies import settings
from cable_model.studies.cost import expected
from cable_model.studies.reference import Reference, converge
from cable_model.studies.timed import SIGNALS, Setting, errors, timed, worst
from cable_model.studies.validity import Check, straight_enough
from cable_model.studies.work_precision import Point, measure

MARGIN = 0.8  # of the wanted accuracy that a choice may use up
LEFT_OUT_SHARE = 0.25  # of the wanted accuracy that leaving out effects may cost
DEARER = 2.0  # settings expected to cost up to this many times the first good one are tried too
CLOSE = 1.5  # good settings within this factor of the cheapest are timed again
AGAIN = 3  # repetitions then
SEARCHED = ("chain, lambda -0.9", "chain, lambda -0.5", "chain, uniform mesh")
Told = Callable[[str], None]


@dataclass(frozen=True)
class Advice:
    """What to run, and why; `choice` is None where nothing that was tried is accurate enough, or the reference did not converge."""

    scene: Scene  # with the choice in place
    choice: Point | None
    reference: Reference
    accuracy: float
    signals: tuple[str, ...]
    checks: tuple[Check, ...]
    left_out: Mapping[str, float]  # effects, and the error that leaving each out made
    kept: Mapping[str, float]
    points: tuple[Point, ...]  # all that was tried


def cheapest(points: list[Point], accuracy: float, signals: tuple[str, ...]) -> Point | None:
    """The cheapest point that uses up MARGIN of the accuracy at most."""
    good = [p for p in points if worst(p.errors, signals) <= MARGIN * accuracy]
    return min(good, key=lambda p: p.cost) if good else None


def _leave_out(scene: Scene, reference: Reference, accuracy: float, signals: tuple[str, ...], told: Told) -> tuple[Scene, dict, dict]:
    """The scene without what makes no difference, with the difference that each effect makes: on one grid, so that its error cancels."""
    left_out: dict[str, float] = {}
    kept: dict[str, float] = {}
    level = reference.levels[-2]
    for name, changes in settings.leave_out(scene).items():
        told(f"without {name}")
        without = with_values(scene, changes)
        made = worst(errors(timed(without, level.setting), level.run, reference.scale), signals)
        if made <= LEFT_OUT_SHARE * accuracy:
            left_out[name] = made
            scene = without
        else:
            kept[name] = made
    return scene, left_out, kept


def _candidates(scene: Scene, reference: Reference) -> list[Setting]:
    """Fixed steps on ladders about the scene's own nodes and step and about every refinement but the last; cheap ones first."""
    found: dict[tuple[object, ...], Setting] = {}
    for level in reference.levels[:-1]:
        base = with_values(scene, level.setting.changes)
        for method in SEARCHED:
            for setting in settings.of_method(base, method):
                if settings.allowed(scene, setting):
                    found.setdefault((method, *setting.changes.values()), setting)
    return sorted(found.values(), key=lambda s: expected(scene, s))


def _search(scene: Scene, reference: Reference, accuracy: float, signals: tuple[str, ...], told: Told) -> list[Point]:
    """Try fixed steps from the cheapest on, until one is good and those up to DEARER times dearer are tried."""
    points: list[Point] = []
    first_good = math.inf
    for setting in _candidates(scene, reference):
        cost = expected(scene, setting)
        if cost > DEARER * first_good:
            break
        told(f"{setting.method}: {setting.label}")
        points.append(measure(scene, setting, reference))
        if worst(points[-1].errors, signals) <= MARGIN * accuracy:
            first_good = min(first_good, cost)
    return points


def _controlled(scene: Scene, reference: Reference, best: Point, accuracy: float, signals: tuple[str, ...], told: Told) -> list[Point]:
    """Error control on the nodes of the best fixed step, from the loosest tolerance on, while it could be cheaper."""
    points: list[Point] = []
    for setting in settings.of_method(with_values(scene, best.setting.changes), settings.CONTROLLED):
        if setting.changes["solver.nodes"] != best.setting.changes["solver.nodes"]:
            continue
        told(f"{setting.method}: {setting.label}")
        points.append(measure(scene, setting, reference))
        if worst(points[-1].errors, signals) <= MARGIN * accuracy or points[-1].cost > CLOSE * best.cost:
            break
    return points


def _timed_again(scene: Scene, points: list[Point], accuracy: float, signals: tuple[str, ...], told: Told) -> list[Point]:
    """The points with those that may be the cheapest good one timed again: short runs are noisy."""
    best = cheapest(points, accuracy, signals)
    if best is None:
        return points
    told("the cheapest ones again")

    def once_more(p: Point) -> Point:
        if worst(p.errors, signals) > MARGIN * accuracy or p.cost > CLOSE * best.cost:
            return p
        run = timed(scene, p.setting, AGAIN)
        return replace(p, cost=min(p.cost, run.seconds / float(run.times[-1])))

    return [once_more(p) for p in points]


def advise(scene: Scene, accuracy: float, signals: tuple[str, ...] = SIGNALS, progress: Told | None = None) -> Advice:
    """The cheapest way found to run a scene with rms errors of `signals` below `accuracy` of their dynamic rms.

    Measured errors decide, on TowCable too; its `checks` say whether the scales of the scene speak for it.
    """
    told = progress if progress is not None else lambda text: None
    reference = converge(scene, accuracy, signals, progress)
    if not reference.converged:
        return Advice(scene, None, reference, accuracy, signals, (), {}, {}, ())
    lean, left_out, kept = _leave_out(scene, reference, accuracy, signals, told)
    points: list[Point] = []
    if settings.TOW in settings.methods(lean):
        for setting in settings.of_method(lean, settings.TOW):
            told(f"TowCable: {setting.label}")
            points.append(measure(lean, setting, reference))
    checks = straight_enough(lean, accuracy)
    points += _search(lean, reference, accuracy, signals, told)
    best = cheapest([p for p in points if p.setting.model == "chain"], accuracy, signals)
    if best is not None:
        points += _controlled(lean, reference, best, accuracy, signals, told)
    points = _timed_again(lean, points, accuracy, signals, told)
    choice = cheapest(points, accuracy, signals)
    placed = lean if choice is None else with_values(lean, {**choice.setting.changes, "run.model": choice.setting.model})
    return Advice(placed, choice, reference, accuracy, signals, tuple(checks), left_out, kept, tuple(points))
