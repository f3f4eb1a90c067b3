"""What single cases ask for beyond the five rules: closed forms, convergence of peaks, one motion at every stiffness."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np
from scipy.integrate import solve_ivp

from cable_model.lab.hard import basin
from cable_model.lab.hard.record import Record
from cable_model.lab.hard.rules import Finding

Runs = Mapping[str, Record]  # the judged runs of a case by their labels
DRAGGED, DRAGGED_IN = 0.3, 30.0  # m, s: of the chain of H20


def folded_fall(runs: Runs) -> list[Finding]:
    """The falling end against x'^2 = g x (2L - x)/(L - x), its energy balance, until x = 0.95 L."""
    found = []
    for label, run in runs.items():
        length, g = run.scene.cable.length, run.scene.environment.gravity

        def rate(t: float, x: np.ndarray, length: float = length, g: float = g) -> list[float]:
            return [np.sqrt(g * x[0] * (2.0 * length - x[0]) / (length - x[0]))]

        small = 1e-8 * length  # at rest the root has a second branch
        path = solve_ivp(rate, (np.sqrt(small / g), 1.0), [small], events=_Reaches(0.95 * length), rtol=1e-9, atol=1e-12, dense_output=True)
        end = path.t_events[0][0]
        times = run.times[(run.times > 0.02) & (run.times <= end)]
        fallen = run.body[0, 2] - np.interp(times, run.times, run.body[:, 2])
        miss = np.abs(fallen - path.sol(times)[0]).max() / length
        peak = run["top.tension"].max() / run.weight
        found.append(
            Finding("+", miss, 0.02, bool(miss <= 0.02), f"{label}: fall against the closed form over L; peak tension {peak:.3g} W")
        )
    return found


@dataclass(frozen=True)
class _Reaches:
    """The event that ends an integration where x comes to a place."""

    place: float
    terminal: bool = True  # as solve_ivp asks

    def __call__(self, t: float, x: np.ndarray) -> float:
        return float(x[0] - self.place)


def peaks(runs: Runs) -> list[Finding]:
    """Largest top tension of every cycle after two cycles: between one grid and the next it changes by 5 % at most."""
    values = []
    for run in runs.values():
        late = run.times > 20.0
        values.append(float(run["top.tension"][late].max()))
    least = min(float(run["cable.tension_min"].min()) for run in runs.values())
    change = abs(values[-2] / values[-1] - 1.0)
    words = "peak tension, N: " + ", ".join(f"{value:.5g}" for value in values) + f"; least tension {least:.3g} N"
    return [Finding("+", change, 0.05, change <= 0.05, words)]


def one_motion(runs: Runs) -> list[Finding]:
    """From 1e4 weights up the lower end moves alike; Newton's iterations differ by a factor of two at most."""
    labels = [label for label in runs if float(label.split()[-1]) >= 1e4]
    first = runs[labels[0]]
    gaps = [np.linalg.norm(runs[label].body - first.body, axis=1).max() / first.scene.cable.length for label in labels[1:]]
    work = [run["solver.newton_iterations"][-1] for run in runs.values()]
    return [
        Finding("+", max(gaps), 0.01, max(gaps) <= 0.01, "path against that of EA/W 1e4, over L"),
        Finding("+", max(work) / min(work), 2.0, max(work) / min(work) <= 2.0, "largest over smallest number of iterations"),
    ]


def bounces(runs: Runs) -> list[Finding]:
    """Twenty times up and down again."""
    found = []
    for label, run in runs.items():
        z = run.body[:, 2]
        middle = 0.5 * (z.max() + z.min())
        count = int(np.sum((z[:-1] < middle) & (z[1:] >= middle)))
        found.append(Finding("+", count, 20, count >= 20, f"{label}: bounces"))
    return found


def no_drift(runs: Runs) -> list[Finding]:
    """Mean position of the body in the last ten minutes against that in the first ten."""
    (run,) = runs.values()
    early, late = run.times <= 600.0, run.times > run.reached - 600.0
    drift = float(np.linalg.norm(run.body[late].mean(axis=0) - run.body[early].mean(axis=0))) / run.scene.cable.length
    return [Finding("+", drift, 1e-3, drift <= 1e-3, "mean position of the body, last ten minutes against the first, over L")]


def held(runs: Runs) -> list[Finding]:
    """A chain dragged over the bottom and held: sqrt(2 EA mu w u) at its top but for the half cell there, and no change ever after."""
    found = []
    for label, run in runs.items():
        cable = run.scene.cable
        right = float(np.sqrt(2.0 * cable.axial_stiffness * run.weight / cable.length * DRAGGED))
        tension = run["top.tension"][run.times >= DRAGGED_IN]
        off, change = abs(float(tension[-1]) / right - 1.0), float(np.ptp(tension)) / right
        found.append(Finding("+", off, 0.02, off <= 0.02, f"{label}: tension at the top against {right:.0f} N"))
        found.append(Finding("+", change, 1e-4, change <= 1e-4, f"{label}: its change while held, over it"))
    return found


def touchdown(runs: Runs) -> list[Finding]:
    """Where the cable leaves the bottom, by the weight that the top carries: mean over the last ten minutes against the second ten.

    The motion repeats every ten minutes; in the first ten the cable finds its place.
    """
    (run,) = runs.values()
    second, last = (run.times > 600.0) & (run.times <= 1200.0), run.times > run.reached - 600.0
    lifted = -run["top.force_z"] / run.weight  # of L
    drift = abs(float(lifted[last].mean() - lifted[second].mean()))
    return [Finding("+", drift, 1e-3, drift <= 1e-3, "mean place of touchdown, last ten minutes against the second, over L")]


def crossing(runs: Runs) -> list[Finding]:
    """Through the surface: where nothing goes slack, three Newton iterations a step at most; energy at order 2 in runs of several steps."""
    found = []
    smooth = {label: run for label, run in runs.items() if "slack" not in label}
    for label, run in smooth.items():
        most = float((np.diff(run["solver.newton_iterations"]) / np.maximum(run.substeps[1:], 1.0)).max())
        found.append(Finding("+", most, 3.0, most <= 3.0, f"{label}: most Newton iterations of a step"))
    for name in dict.fromkeys(label.partition(", dt ")[0] for label in smooth if ", dt " in label):
        own = [run for label, run in smooth.items() if label.startswith(f"{name}, dt ")]
        coarse, fine = own[0], own[-1]
        steps = coarse.scene.solver.time_step / fine.scene.solver.time_step
        order = float(np.log(np.abs(coarse.excess).max() / np.abs(fine.excess).max()) / np.log(steps))
        found.append(Finding("+", order, 1.8, order >= 1.8, f"{name}: order of the energy's error in the step, at least"))
    return found


def loops(runs: Runs) -> list[Finding]:
    """The length of the drawn cable stays the unstretched one to 1e-5 at all times, and no cell turns back on its neighbour."""
    found = []
    for label, run in runs.items():
        off, turn = float(np.abs(run.lengths / run.scene.cable.length - 1.0).max()), float(np.degrees(run.turn))
        found.append(Finding("+", off, 1e-5, off <= 1e-5, f"{label}: length against the unstretched, over it"))
        found.append(Finding("+", turn, 90.0, turn <= 90.0, f"{label}: largest turn between cells, degrees"))
    return found


CHECKS: dict[str, Callable[[Runs], list[Finding]]] = {
    "folded fall": folded_fall,
    "peaks": peaks,
    "one motion": one_motion,
    "bounces": bounces,
    "basin": basin.findings,
    "drift": no_drift,
    "held": held,
    "crossing": crossing,
    "loops": loops,
    "touchdown": touchdown,
}
