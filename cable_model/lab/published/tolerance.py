"""Whether the observed error follows solver.tolerance: five cases, two lambdas, each against a far finer fixed step on the same grid."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass

import matplotlib.pyplot as plt
import numpy as np

from cable_model.lab.cost_cases import SHIFTED, WIRE
from cable_model.lab.published.bounded import STEPS, run
from cable_model.lab.published.page import Page
from cable_model.scene import Scene, load, with_values
from cable_model.signals import OUTPUTS
from cable_model.studies.timed import SIGNALS, Scale, errors

NAME = "tolerance"
TOLERANCES = (1e-1, 3e-2, 1e-2, 3e-3, 1e-3, 3e-4, 1e-4, 3e-5, 1e-5)
LAMBDAS = (-0.9, -0.5)
MOST_STEPS = 150_000  # of a run under error control, before it is given up
MARGIN = 3.0  # an error below this many of the reference's own is not judged
NEWTON, REJECTED = OUTPUTS.index("solver.newton_iterations"), OUTPUTS.index("solver.rejected_steps")


@dataclass(frozen=True)
class Case:
    """A scene with changes, long communication steps among them so that they do not limit the steps, and the reference's step."""

    scene: str
    changes: Mapping[str, object]
    fine: float  # s
    signals: tuple[str, ...] = SIGNALS

    def load(self) -> Scene:
        return with_values(load(self.scene), self.changes)


FREE: Mapping[str, object] = {"solver.nodes": 51, "run.duration": 20.0}
CASES: Mapping[str, Case] = {
    # the tension of a freely swinging chain changes by 1e-5 only
    "A1 free chain, let go": Case("free_chain", {**FREE, "run.output_step": 0.25}, 2.5e-5, ("position",)),
    "A1 free chain, top shifted": Case("free_chain", {**SHIFTED, **FREE, "run.output_step": 0.25}, 1e-4, ("position",)),
    "A2 forced chain": Case("hanging_chain", {"run.output_step": 0.1}, 1e-4),
    "C3 sphere": Case("dale_sphere", {"run.duration": 60.0, "run.output_step": 0.5}, 4e-4),
    "C4 wire": Case("hard/snap", {**WIRE, "run.output_step": 0.5}, 4e-4),
}


@dataclass(frozen=True)
class Point:
    tolerance: float
    errors: dict[str, float]  # infinite where the run was given up
    steps: int
    rejected: int
    iterations: int


@dataclass(frozen=True)
class Line:
    """One case and lambda: points by falling tolerance, and what halving the reference's step changed."""

    case: str
    lambda_infinity: float
    points: tuple[Point, ...]
    own_error: dict[str, float]

    def judged(self, signal: str) -> list[Point]:
        """Points whose steps the tolerance rules, and whose error the reference can tell."""
        ruled = [p for k, p in enumerate(self.points) if k + 1 == len(self.points) or self.points[k + 1].steps > 1.05 * p.steps]
        return [p for p in ruled if MARGIN * self.own_error[signal] < p.errors[signal] < 1.0]

    def slope(self, signal: str) -> float:
        """Of the error over the tolerance, both logarithmic; not a number with fewer than three points."""
        kept = self.judged(signal)
        if len(kept) < 3:
            return math.nan
        return float(np.polyfit(np.log([p.tolerance for p in kept]), np.log([p.errors[signal] for p in kept]), 1)[0])

    def ratio(self, signal: str) -> float:
        """Geometric mean of error over tolerance."""
        kept = self.judged(signal)
        return math.exp(float(np.mean([math.log(p.errors[signal] / p.tolerance) for p in kept]))) if kept else math.nan


def line(name: str, case: Case, lambda_infinity: float, tolerances: tuple[float, ...], fine: float) -> Line:
    base = with_values(case.load(), {"solver.lambda_infinity": lambda_infinity, "solver.tolerance": 0.0})
    coarser, _ = run(with_values(base, {"solver.time_step": 2.0 * fine}))
    reference, _ = run(with_values(base, {"solver.time_step": fine}))
    scale = Scale.of(reference)
    points = []
    for tolerance in tolerances:
        controlled = {"solver.tolerance": tolerance, "solver.time_step": 0.1 * base.run.duration}
        found, last = run(with_values(base, controlled), MOST_STEPS)
        counts = (int(last[k]) for k in (STEPS, REJECTED, NEWTON))
        points.append(Point(tolerance, errors(found, reference, scale), *counts))
    return Line(name, lambda_infinity, tuple(points), errors(coarser, reference, scale))


def measure(quick: bool = False, told: Callable[[str], None] | None = None) -> list[Line]:
    """All cases and lambdas (quick: the forced chain at lambda -0.9 and three tolerances)."""
    found = []
    for name, case in CASES.items():
        for lam in LAMBDAS:
            if quick and (name, lam) != ("A2 forced chain", -0.9):
                continue
            if told is not None:
                told(f"{name}, lambda {lam:g}")
            found.append(line(name, case, lam, (1e-1, 1e-2, 1e-3) if quick else TOLERANCES, (10.0 if quick else 1.0) * case.fine))
    return found


def page(found: list[Line]) -> Page:
    cases = list(dict.fromkeys(each.case for each in found))
    figure, panels = plt.subplots(1, len(cases), figsize=(max(4.5, 3.6 * len(cases)), 4.8), sharey=True, squeeze=False)
    for axis, name in zip(panels[0], cases, strict=True):
        for each in (each for each in found if each.case == name):
            for signal in CASES[name].signals:
                shade, mark = ("C0" if each.lambda_infinity < -0.7 else "C1"), ("o-" if signal == "position" else "s--")
                shown = [p for p in each.points if math.isfinite(p.errors[signal])]
                label = f"{signal}, lambda {each.lambda_infinity:g}"
                axis.plot([p.tolerance for p in shown], [p.errors[signal] for p in shown], mark, color=shade, markersize=4, label=label)
                for p in each.points:
                    if not math.isfinite(p.errors[signal]):
                        axis.plot(p.tolerance, 1.5e-6 if each.lambda_infinity < -0.7 else 3e-6, "x", color=shade, markersize=7)
        axis.plot(TOLERANCES, TOLERANCES, "k:", linewidth=1.2, label="error = tolerance")
        axis.set(xscale="log", yscale="log", title=name, xlabel="solver.tolerance", ylim=(1e-6, 1.0))
        axis.invert_xaxis()
        axis.grid(alpha=0.3, which="major")
        axis.legend(fontsize=7)
    panels[0][0].set_ylabel("error in time: rms over dynamic rms")
    head = ("case", "lambda", "tolerance", "error position", "error tension", "steps", "rejected", "iterations", "own position",
            "own tension")  # fmt: skip
    rows = [
        (each.case, each.lambda_infinity, p.tolerance, p.errors["position"], p.errors["tension"], p.steps, p.rejected, p.iterations,
         each.own_error["position"], each.own_error["tension"])
        for each in found for p in each.points
    ]  # fmt: skip
    return Page(NAME, "Observed error and solver.tolerance", _caption(found), figure, head, rows, _summary(found))


def _caption(found: list[Line]) -> str:
    def spread(signal: str) -> str:
        lines = [each for each in found if signal in CASES[each.case].signals]
        ratios, slopes = [each.ratio(signal) for each in lines], [each.slope(signal) for each in lines]
        between = f"{min(ratios):.2g} to {max(ratios):.2g} times the tolerance"
        if np.isnan(slopes).all():
            return f"{between} (too few points for a slope)"
        return f"{between} (slopes {np.nanmin(slopes):.2f} to {np.nanmax(slopes):.2f})"

    lost = sum(not math.isfinite(p.errors["position"]) for each in found for p in each.points)
    runs = sum(len(each.points) for each in found)
    return (
        f"Error against a fixed step far finer on the same grid: of the position {spread('position')}, of the tension {spread('tension')}; "
        f"a slope of 1 follows it.  Geometric means where the tolerance, not the communication step, rules the steps, and where the "
        f"error is more than {MARGIN:g} times the reference's own.  {lost} of {runs} runs were given up after {MOST_STEPS} steps "
        "(crosses at the foot)."
    )


def _summary(found: list[Line]) -> list[tuple[object, ...]]:
    table: list[tuple[object, ...]] = [
        ("case, lambda", "signal", "error / tolerance", "slope", "points", "steps at the finest", "given up at")
    ]
    for each in found:
        lost = ", ".join(f"{p.tolerance:.0e}" for p in each.points if not math.isfinite(p.errors["position"]))
        steps = [p.steps for p in each.points if math.isfinite(p.errors["position"])]
        for signal in CASES[each.case].signals:
            name = f"{each.case}, {each.lambda_infinity:g}"
            count = len(each.judged(signal))
            table.append(
                (name, signal, f"{each.ratio(signal):.2g}", f"{each.slope(signal):.2f}", count, steps[-1] if steps else 0, lost or "-")
            )
    return table
