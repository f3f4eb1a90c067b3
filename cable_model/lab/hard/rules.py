"""The five rules by which a run of a hard case is judged; each gives the number that decides and whether it holds."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from cable_model.lab.hard.record import Record

SMALL_STEP = 1e-4  # of the base step: smaller ones are allowed for SLOW_SHARE of the run
SLOW_SHARE = 0.01
ENERGY = 0.01  # of W L
ARC = 1e-6  # of L
DRIFT, DRIFT_IN_CHAOS = 1e-3, 2e-2  # of L
COMPRESSION = 0.01  # of W
STATISTICS = 0.10
SAMPLING = 1e-3  # of L: what communication steps of several internal steps may change before chaos


@dataclass(frozen=True)
class Finding:
    """One rule applied to a run: its letter, what was measured against what, and whether it holds."""

    rule: str
    value: float
    limit: float
    holds: bool
    words: str


def _below(rule: str, value: float, limit: float, words: str) -> Finding:
    return Finding(rule, float(value), limit, bool(value <= limit), words)


def finishes(run: Record, duration: float) -> Finding:
    """(a) It reaches its end; steps below 1e-4 of the base step take no more than 1 % of the run."""
    slow = float(np.mean(run.substeps > 1.0 / SMALL_STEP))
    done = not run.error and run.reached >= duration * (1.0 - 1e-9) and bool(np.isfinite(run.outputs).all())
    words = "share of the run in tiny steps" if done else f"stopped at {run.reached:.4g} s: {run.error}"
    return Finding("a", slow, SLOW_SHARE, done and slow <= SLOW_SHARE, words)


def keeps_energy(run: Record) -> Finding:
    """(b) Energy never exceeds its start plus the work done on the cable, less what damping took, by more than 1 % of W L."""
    return _below("b", run.excess.max() / (run.force_scale * run.scene.cable.length), ENERGY, "energy excess over W L")


def keeps_geometry(run: Record, chaos: float) -> list[Finding]:
    """(c) The top is where it should be, the length is true, both ways to the lower end agree, nothing is pushed.

    A cable that bends may be pressed in each cell by what bending holds there, 2 EI/h^2: a beam shorter than its buckling length.
    """
    length = run.scene.cable.length
    before = run.times <= chaos
    found = [
        _below("c", run.top_error / length, 1e-12, "top off its place over L"),
        _below("c", run.arc_error / length, ARC, "length error over L"),
        _below("c", run.drift[before].max() / length, DRIFT, "drift of the lower end over L, before chaos"),
    ]
    if not before.all():
        found.append(_below("c", run.drift.max() / length, DRIFT_IN_CHAOS, "drift of the lower end over L"))
    push = run.pressed if run.scene.cable.bending_stiffness > 0.0 else max(0.0, -float(run["cable.tension_min"].min()))
    scale = max(run.weight, 1e-3 * float(run["top.tension"].max()))
    return [*found, _below("c", push / scale, COMPRESSION, "compression over W")]


def _gap(a: Record, b: Record, until: float) -> float:
    """Largest distance between the paths of two runs at common times up to `until`, over the length."""
    stop = min(until, a.reached, b.reached)
    times = a.times[a.times <= stop * (1.0 + 1e-9)]
    path = np.array([np.interp(times, b.times, b.followed[:, k]) for k in range(3)]).T
    return float(np.linalg.norm(a.followed[: len(times)] - path, axis=1).max() / a.scene.cable.length)


def converges(run: Record, finer: Record, finest: Record, chaos: float, tolerance: float) -> list[Finding]:
    """(d) Twice the nodes and a quarter of the step change the path of the lower end, or middle, little until chaos, and again less.

    A difference of a tenth of the tolerance need not fall any more: there the statics' own tolerance shows.
    """
    first, second = _gap(run, finer, chaos), _gap(finer, finest, chaos)
    return [
        _below("d", first, tolerance, "path against a finer run, over L"),
        _below("d", second, max(first, 0.1 * tolerance), "and the finer run against the next"),
    ]


def keeps_statistics(run: Record, finer: Record, chaos: float) -> list[Finding]:
    """(d) After chaos began: rms position of the lower end about the resting one and mean tension, against a finer run of equal length."""
    found = []
    late, fine = run.times > chaos, finer.times > chaos
    for words, of in (("rms of the lower end", _rms), ("mean tension", _mean)):
        a, b = of(run, late), of(finer, fine)
        found.append(_below("d", abs(a / b - 1.0) if b else 0.0, STATISTICS, f"{words} after chaos, against a finer run"))
    return found


def _rms(run: Record, late: np.ndarray) -> float:
    return float(np.sqrt(np.mean(np.sum((run.body[late] - run.body[0]) ** 2, axis=1))))


def _mean(run: Record, late: np.ndarray) -> float:
    return float(run["top.tension"][late].mean())


def ignores_communication(run: Record, coarser: Record, chaos: float) -> Finding:
    """(e) Communication steps of several internal steps change nothing but how the top's motion is interpolated."""
    return _below("e", _gap(coarser, run, chaos), SAMPLING, "path with five times the communication step, over L")
