"""The work-precision study of a scene: error against processor time of every method, as rows, CSV and picture."""

from __future__ import annotations

import csv
import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt

from cable_model.errors import writing
from cable_model.machine import machine
from cable_model.scene import Scene, with_values
from cable_model.studies import settings
from cable_model.studies.reference import Reference, converge
from cable_model.studies.timed import SIGNALS, Setting, timed

TARGET = 1e-3  # accuracy that the reference must be good for
PATIENCE = 3.0  # times the finest reference's processor time that a run may take
HEAD = (
    "method", "model", "nodes", "time_step_s", "tolerance", "lambda_infinity", "grid", "grading", "cpu_s_per_s",
    "error_tension", "error_position", "stopped",
)  # fmt: skip
WITHOUT = "chain without "


@dataclass(frozen=True)
class Point:
    """One run of the study."""

    setting: Setting
    cost: float  # processor seconds per simulated second
    errors: dict[str, float]
    stopped: str


def measure(scene: Scene, setting: Setting, reference: Reference, repetitions: int = 1) -> Point:
    """A point of a setting; a run that takes much longer than the reference, as where steps collapse, is given up."""
    run = timed(scene, setting, repetitions, max(1.0, PATIENCE * reference.run.seconds))
    simulated = float(run.times[-1]) if len(run.times) > 1 else math.inf
    return Point(setting, run.seconds / simulated, reference.errors(run), run.error)


def all_settings(scene: Scene, quick: bool = False) -> Iterator[Setting]:
    """Every setting of every method, and the scene's own without each of its optional effects."""
    for method in settings.methods(scene):
        yield from settings.of_method(scene, method, quick)
    if not quick:
        own = {"solver.nodes": scene.solver.nodes, "solver.time_step": scene.solver.time_step, "solver.tolerance": 0.0}
        for name, changes in settings.leave_out(scene).items():
            yield Setting(WITHOUT + name, "chain", {**settings.BASE, **own, **changes})


def study(scene: Scene, quick: bool = False, progress: Callable[[str, float], None] | None = None) -> tuple[Reference, list[Point]]:
    """The reference and all points; `progress` is told what runs and the share that is done.  Kernels are compiled before timing."""
    told = (lambda text: progress(text, 0.0)) if progress is not None else None
    reference = converge(scene, 10.0 * TARGET if quick else TARGET, progress=told)
    wanted = list(all_settings(scene, quick))
    points: list[Point] = []
    warm: set[object] = set()
    for k, setting in enumerate(wanted):
        if progress is not None:
            progress(f"{setting.method}: {setting.label}", k / len(wanted))
        if setting.method not in warm:
            warm.add(setting.method)
            timed(with_values(scene, {"run.duration": 2.0 * scene.run.output_step}), setting)
        points.append(measure(scene, setting, reference, 1 if quick else 2))
    return reference, points


def front(points: Sequence[Point], signal: str) -> list[Point]:
    """The points that no other beats in both cost and error, cheap ones first."""
    kept: list[Point] = []
    for point in sorted((p for p in points if math.isfinite(p.errors[signal])), key=lambda p: (p.cost, p.errors[signal])):
        if not kept or point.errors[signal] < kept[-1].errors[signal]:
            kept.append(point)
    return kept


def write_csv(path: Path, scene: Scene, reference: Reference, points: Sequence[Point]) -> None:
    path.parent.mkdir(parents=True, exist_ok=True)
    with writing(path), path.open("w", encoding="utf-8", newline="") as file:
        file.write(f"# {scene.title}; {machine()}\n")
        own = ", ".join(f"{name} {reference.own_error[name]:.1e}" for name in SIGNALS)
        finest = reference.levels[-1].setting.label
        file.write(f"# reference: {finest}; {'its own error: ' + own if reference.converged else 'NOT CONVERGED: ' + own}\n")
        rows = csv.writer(file, lineterminator="\n")
        rows.writerow(HEAD)
        for p in points:
            c = p.setting.changes
            rows.writerow([
                p.setting.method, p.setting.model, c.get("solver.nodes", ""), c.get("solver.time_step", ""), c.get("solver.tolerance", ""),
                c.get("solver.lambda_infinity", ""), c.get("solver.grid", ""), c.get("solver.grading", ""), f"{p.cost:.4g}",
                *(f"{p.errors[name]:.4g}" for name in SIGNALS), p.stopped,
            ])  # fmt: skip


def picture(path: Path, scene: Scene, reference: Reference, points: Sequence[Point]) -> None:
    """Log-log, a panel a signal: each method's best, every run as a dot, the cheapest front with its settings, and what effects matter."""
    chosen = list(dict.fromkeys(p.setting.method for p in points if not p.setting.method.startswith(WITHOUT)))
    figure, panels = plt.subplots(1, 2, figsize=(12, 5.5), sharey=False)
    titles = {"tension": "top tension", "position": "position of the lower end"}
    for axis, signal in zip(panels, SIGNALS, strict=True):
        for k, method in enumerate(chosen):
            own = [p for p in points if p.setting.method == method]
            good = [p for p in own if 0.0 < p.errors[signal] < 3.0]
            best = [p for p in front(own, signal) if p.errors[signal] < 3.0]
            colour = f"C{k % 10}"
            axis.plot([p.errors[signal] for p in good], [p.cost for p in good], ".", color=colour, markersize=2, alpha=0.5)
            axis.plot(
                [p.errors[signal] for p in best], [p.cost for p in best], "-o", color=colour, markersize=3, linewidth=1.0, label=method
            )
        cheapest = [p for p in front(points, signal) if p.errors[signal] < 0.3 and not p.setting.method.startswith(WITHOUT)]
        axis.plot(
            [p.errors[signal] for p in cheapest], [p.cost for p in cheapest], color="black", linewidth=4, alpha=0.15, label="cheapest front"
        )
        marked: float = math.inf
        for p in cheapest:
            if p.errors[signal] < 0.45 * marked:
                marked = p.errors[signal]
                axis.annotate(p.setting.label or p.setting.method, (p.errors[signal], p.cost), fontsize=6, xytext=(3, -8),
                              textcoords="offset points")  # fmt: skip
        for p in points:
            if p.setting.method.startswith(WITHOUT) and 0.0 < p.errors[signal] < 3.0:
                axis.plot(p.errors[signal], p.cost, "D", color="black", markersize=4)
                axis.annotate(p.setting.method.removeprefix("chain "), (p.errors[signal], p.cost), fontsize=6, xytext=(4, 4),
                              textcoords="offset points")  # fmt: skip
        if reference.converged:
            axis.axvline(reference.own_error[signal], color="grey", linestyle=":", linewidth=1, label="reference's own error")
        axis.set(
            xscale="log", yscale="log", xlabel=f"error of the {titles[signal]}, rms over its dynamic rms", ylabel="CPU s per simulated s"
        )
        axis.invert_xaxis()
        axis.grid(alpha=0.3, which="both")
    panels[0].legend(fontsize=6, loc="upper left")
    figure.suptitle(f"{scene.title}: what accuracy costs" + ("" if reference.converged else " (reference not converged)"), fontsize=10)
    figure.tight_layout()
    path.parent.mkdir(parents=True, exist_ok=True)
    figure.savefig(path, dpi=90)
    plt.close(figure)
