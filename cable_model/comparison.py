"""Comparing two tables of signals: which differ, when and by how much, and whether their times are the same.  For people and for CI."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from cable_model.errors import ParameterError

SAME_TIME = 1e-9  # of the reference's span


@dataclass(frozen=True)
class Difference:
    """The largest difference of one signal, when it occurs, and what is allowed there."""

    signal: str
    largest: float
    time: float
    allowed: float
    share_of_range: float

    @property
    def passed(self) -> bool:
        return self.largest <= self.allowed


def times_of(name: str, columns: tuple[str, ...], table: np.ndarray) -> np.ndarray:
    """The column `time`, refused where nothing can be compared along it."""
    if "time" not in columns:
        raise ParameterError(f"{name} has no column 'time'. Write it with `python -m cable_model run`.")
    times = table[:, columns.index("time")]
    if len(times) < 2:
        raise ParameterError(f"{name} has {len(times)} row{'s' if len(times) != 1 else ''}: must be at least 2. Simulate longer.")
    if not np.all(np.diff(times) > 0.0):
        raise ParameterError(f"{name} has times that do not rise, in row {int(np.argmin(np.diff(times) > 0.0)) + 2}. Write it again.")
    return times


def compare(
    columns: tuple[str, ...], table: np.ndarray, reference_columns: tuple[str, ...], reference: np.ndarray, rtol: float, atol: float
) -> list[Difference]:
    """Compare every signal that both tables have, at the reference's times; solver counters are left out.

    A signal passes when |a - b| <= atol + rtol * (range of the reference signal, or its largest size where it is constant).  A
    result that goes on after the reference's end, or begins before it, differs in `time`; one that does not cover it is refused.
    """
    t, t_ref = times_of("the result", columns, table), times_of("the reference", reference_columns, reference)
    span = float(np.ptp(t_ref))
    slack = SAME_TIME * span
    if t[0] > t_ref[0] + slack or t[-1] < t_ref[-1] - slack:
        spans = f"times {t[0]:g} to {t[-1]:g} s do not cover the reference's {t_ref[0]:g} to {t_ref[-1]:g} s"
        raise ParameterError(f"{spans}. Simulate longer.")
    shared = [c for c in reference_columns if c in columns and c != "time" and not c.startswith("solver.")]
    if not shared:
        raise ParameterError("the two tables share no signal. Check the column names.")
    found = [_difference(c, t, table[:, columns.index(c)], t_ref, reference[:, reference_columns.index(c)], rtol, atol) for c in shared]
    unjudged = max(t_ref[0] - t[0], t[-1] - t_ref[-1])
    if unjudged > slack:
        found.append(Difference("time", float(unjudged), float(t_ref[-1]), slack, float(unjudged) / span))
    return found


def remarks(columns: tuple[str, ...], table: np.ndarray, reference_columns: tuple[str, ...], reference: np.ndarray) -> list[str]:
    """What `compare` did not judge, or only by interpolation: other times, rows that no other row stands beside, signals of one table."""
    t, t_ref = times_of("the result", columns, table), times_of("the reference", reference_columns, reference)
    found = []
    if len(t) != len(t_ref) or np.abs(t - t_ref).max() > SAME_TIME * np.ptp(t_ref):
        spans = [f"{len(times)} rows from {times[0]:g} to {times[-1]:g} s" for times in (t, t_ref)]
        at = np.searchsorted(t, t_ref - SAME_TIME * np.ptp(t_ref)).clip(max=len(t) - 1)
        lines = "" if np.abs(t[at] - t_ref).max() <= SAME_TIME * np.ptp(t_ref) else ", by straight lines between the result's"
        found.append(f"other times than the reference's ({spans[0]} against {spans[1]}): compared at the reference's{lines}")
    for words, names, others in (("the reference", reference_columns, columns), ("the result", columns, reference_columns)):
        lone = [name for name in names if name not in others and not name.startswith("solver.")]
        if lone:
            found.append(f"only {words} has {', '.join(lone)}: not compared")
    return found


def _difference(name: str, t: np.ndarray, a: np.ndarray, t_ref: np.ndarray, b: np.ndarray, rtol: float, atol: float) -> Difference:
    gap = np.abs(np.interp(t_ref, t, a) - b)
    gap[~np.isfinite(gap)] = np.inf
    worst = int(np.argmax(gap))
    span = float(np.ptp(b)) or float(np.max(np.abs(b)))
    return Difference(name, float(gap[worst]), float(t_ref[worst]), atol + rtol * span, float(gap[worst]) / span if span else 0.0)
