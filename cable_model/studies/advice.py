"""Advice for a scene: the cheapest model, effects, nodes, step or tolerance that meet a wanted accuracy, found by measured refinement."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass

from cable_model.scene import Scene, with_values
from cable_model.studies import settings
from cable_model.studies.reference import Reference, converge
from cable_model.studies.timed import SIGNALS, Setting, worst
from cable_model.studies.validity import Check, straight_enough
from cable_model.studies.work_precision import Point, measure

MARGIN = 0.8  # of the wanted accuracy that a choice may use up
LEFT_OUT_SHARE = 0.25  # of the wanted accuracy that leaving out one effect may cost
DEARER = 2.0  # settings predicted to cost up to this many times the first good one are tried too
SEARCHED = ("chain, lambda -0.9", "chain, lambda -0.5")


@dataclass(frozen=True)
class Advice:
    """What to run, and why; `choice` is None where nothing that was tried is accurate enough, or the reference did not converge."""

    scene: Scene  # with the choice in place
    choice: Point | None
    reference: Reference
    checks: tuple[Check, ...]
    left_out: Mapping[str, float]  # effects, and the error that leaving each out made
    kept: Mapping[str, float]
    finer: tuple[Point, ...]  # cheapest points found for ever smaller errors, the choice first
    tried: int


def _predicted(setting: Setting, scene: Scene) -> float:
    nodes, step = float(str(setting.changes["solver.nodes"])), float(str(setting.changes["solver.time_step"]))
    return (nodes + 20.0) * scene.run.duration / step


def _cheapest(points: list[Point], accuracy: float, signals: tuple[str, ...]) -> Point | None:
    good = [p for p in points if worst(p.errors, signals) <= MARGIN * accuracy]
    return min(good, key=lambda p: p.cost) if good else None


def _search(
    scene: Scene, reference: Reference, accuracy: float, signals: tuple[str, ...], told: Callable[[str], None], points: list[Point]
) -> None:
    """Try fixed steps from the cheapest prediction on, until one is good and those up to DEARER times dearer are tried."""
    candidates = [s for method in SEARCHED for s in settings.of_method(scene, method) if settings.allowed(scene, s)]
    found = math.inf
    for setting in sorted(candidates, key=lambda s: _predicted(s, scene)):
        if _predicted(setting, scene) > DEARER * found:
            return
        told(f"{setting.method}: {setting.label}")
        points.append(measure(scene, setting, reference))
        if worst(points[-1].errors, signals) <= MARGIN * accuracy:
            found = min(found, _predicted(setting, scene))


def advise(scene: Scene, accuracy: float, signals: tuple[str, ...] = SIGNALS, progress: Callable[[str], None] | None = None) -> Advice:
    """The cheapest way found to run a scene with rms errors of `signals` below `accuracy` of their dynamic rms."""

    def told(text: str) -> None:
        if progress is not None:
            progress(text)

    reference = converge(scene, accuracy, signals, progress)
    if not reference.converged:
        return Advice(scene, None, reference, (), {}, {}, (), 0)
    left_out: dict[str, float] = {}
    kept: dict[str, float] = {}
    lean = scene
    finest = reference.levels[-2].setting
    for name, changes in settings.leave_out(scene).items():
        told(f"without {name}")
        error = worst(measure(with_values(lean, changes), finest, reference).errors, signals)
        if error <= LEFT_OUT_SHARE * accuracy:
            left_out[name] = error
            lean = with_values(lean, changes)
        else:
            kept[name] = error
    points: list[Point] = []
    checks = straight_enough(scene)
    if all(check.holds for check in checks):
        for setting in settings.of_method(lean, settings.TOW):
            told(f"TowCable: {setting.label}")
            points.append(measure(lean, setting, reference))
    _search(lean, reference, accuracy, signals, told, points)
    choice = _cheapest(points, accuracy, signals)
    if choice is not None:  # timed again, and error control on the same grid beside it
        if choice.setting.model == "chain":
            nodes = choice.setting.changes["solver.nodes"]
            same = [s for s in settings.of_method(lean, settings.CONTROLLED) if s.changes["solver.nodes"] == nodes]
            for setting in same:
                told(f"{setting.method}: {setting.label}")
                points.append(measure(lean, setting, reference))
                if worst(points[-1].errors, signals) <= MARGIN * accuracy or points[-1].cost > 3.0 * choice.cost:
                    break
        choice = _cheapest(points, accuracy, signals)
    finer = [p for p in (_cheapest(points, accuracy / 10.0**k, signals) for k in (0.0, 0.5, 1.0)) if p is not None]
    chosen = lean if choice is None else with_values(lean, {**choice.setting.changes, "run.model": choice.setting.model})
    return Advice(chosen, choice, reference, tuple(checks), left_out, kept, tuple(finer), len(points))


def price(advice: Advice, factor: float = 10.0) -> str:
    """What a further `factor` of accuracy would cost: measured where the search met it, else by the methods' second order."""
    if advice.choice is None:
        return ""
    for point in advice.finer[1:]:
        if point.setting != advice.choice.setting:
            gain = worst(advice.choice.errors) / worst(point.errors)
            if gain >= 2.0:
                dearer = point.cost / advice.choice.cost
                return f"measured: {gain:.2g} times the accuracy for {dearer:.2g} times the time ({point.setting.label})"
    if advice.choice.setting.model == "tow":
        return "TowCable's error is that of a straight cable: more accuracy needs the chain"
    return f"expected: {factor:g} times the accuracy for about {factor:g} times the time (second order in nodes and step)"
