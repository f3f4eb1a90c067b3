"""The rules of a scene's tables, which have no place in FMUs: what their rows must be."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from itertools import pairwise
from typing import Any

from cable_model.errors import refuse
from cable_model.parameters import value_of

FEWEST_OF_A_RECORD = 8  # rows
EVEN = 1e-3  # of a step, by which times that a file has rounded may be off


def rising(rows: Sequence[Sequence[float]], columns: int = 1) -> bool:
    """Whether each of the first columns rises from row to row."""
    return all(low[k] < high[k] for low, high in pairwise(rows) for k in range(columns))


def _is_grid(rows: Sequence[Sequence[float]]) -> bool:
    """Whether rows of [time, z, ...] have the same z at every time, each once."""
    levels: dict[float, list[float]] = {}
    for time, z, *_ in rows:
        levels.setdefault(time, []).append(z)
    grids = [sorted(each) for each in levels.values()]
    return all(grid == grids[0] and rising([[z] for z in grid]) for grid in grids)


def _is_rectangular(rows: Sequence[Sequence[float]]) -> bool:
    """Whether there are no rows, or heights at two or more x, each of which has the same two or more y, each once."""
    if not rows:
        return True
    x, y = ({row[k] for row in rows} for k in (0, 1))
    return len(x) > 1 and len(y) > 1 and len({tuple(row[:2]) for row in rows}) == len(rows) == len(x) * len(y)


def _is_even(rows: Sequence[Sequence[float]]) -> bool:
    """Whether there are no rows, or some whose first values rise by equal steps, and whose second ones are not all the same."""
    if not rows:
        return True
    steps = [high[0] - low[0] for low, high in pairwise(rows)]
    return (
        len(rows) >= FEWEST_OF_A_RECORD
        and any(row[1] != rows[0][1] for row in rows)
        and all(step > 0.0 and abs(step - steps[0]) <= EVEN * steps[0] for step in steps)
    )


# the name, whether its rows are right, what they must be and what to do
TABLES: Sequence[tuple[str, Callable[[Any], bool], str, str]] = (
    ("winch.speeds", rising, "sorted by time without repeats", "Sort the rows by time."),
    (
        "cable.stiffness_curve", lambda rows: not rows or (len(rows) > 1 and tuple(rows[0]) == (0.0, 0.0) and rising(rows, 2)),
        "[0, 0] and rows of rising strain and tension", "Sort the rows by strain.",
    ),
    ("current.levels", lambda rows: rising(rows) or rising(rows[::-1]), "sorted by z without repeats", "Sort the table by z."),
    ("current.table", _is_grid, "the same levels at every time, each once", "Give every level at every time."),
    (
        "seabed.profile", lambda rows: not rows or (len(rows) > 1 and (rising(rows) or rising(rows[::-1]))),
        "at least two rows, sorted by x without repeats", "Sort the rows by x.",
    ),
    (
        "seabed.grid", _is_rectangular, "at least two x, each with the same two or more y, each once",
        "Give a height at every y of every x.",
    ),
    (
        "waves.record", _is_even, f"at least {FEWEST_OF_A_RECORD} rows of time that rises by equal steps, and of heights that differ",
        "Sort the rows, and fill gaps.",
    ),
)  # fmt: skip


def check(scene: Any) -> None:
    """Raises the ParameterError of the first table whose rows are not what they must be."""
    for k, (amplitude, period, *_) in enumerate(scene.waves.table):
        if not (amplitude >= 0.0 and period > 0.0):
            shown = f"{amplitude:g} m, {period:g} s"
            raise refuse(f"waves.table[{k}]", shown, "", "an amplitude >= 0 and a period > 0", "Mend the row.")
    for name, right, must, remedy in TABLES:
        rows = value_of(scene, name)
        if not right(rows):
            raise refuse(name, len(rows), "rows", must, remedy)
