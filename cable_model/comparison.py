"""Comparing two tables of signals: which differ, when and by how much.  For people and for CI."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from cable_model.errors import ParameterError


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


def compare(
    columns: tuple[str, ...], table: np.ndarray, reference_columns: tuple[str, ...], reference: np.ndarray, rtol: float, atol: float
) -> list[Difference]:
    """Compare every signal that both tables have, at the reference's times; solver counters are left out.

    A signal passes when |a - b| <= atol + rtol * (range of the reference signal, or its largest size where it is constant).
    """
    for name, names in (("the result", columns), ("the reference", reference_columns)):
        if "time" not in names:
            raise ParameterError(f"{name} has no column 'time'. Write it with `python -m cable_model run`.")
    t, t_ref = table[:, columns.index("time")], reference[:, reference_columns.index("time")]
    slack = 1e-9 * max(1.0, abs(t_ref[-1]))
    if t[0] > t_ref[0] + slack or t[-1] < t_ref[-1] - slack:
        spans = f"times {t[0]:g} to {t[-1]:g} s do not cover the reference's {t_ref[0]:g} to {t_ref[-1]:g} s"
        raise ParameterError(f"{spans}. Simulate longer.")
    shared = [c for c in reference_columns if c in columns and c != "time" and not c.startswith("solver.")]
    if not shared:
        raise ParameterError("the two tables share no signal. Check the column names.")
    return [_difference(c, t, table[:, columns.index(c)], t_ref, reference[:, reference_columns.index(c)], rtol, atol) for c in shared]


def _difference(name: str, t: np.ndarray, a: np.ndarray, t_ref: np.ndarray, b: np.ndarray, rtol: float, atol: float) -> Difference:
    gap = np.abs(np.interp(t_ref, t, a) - b)
    gap[~np.isfinite(gap)] = np.inf
    worst = int(np.argmax(gap))
    span = float(np.ptp(b)) or float(np.max(np.abs(b)))
    return Difference(name, float(gap[worst]), float(t_ref[worst]), atol + rtol * span, float(gap[worst]) / span if span else 0.0)
