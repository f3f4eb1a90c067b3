"""Running a scene in the library: the top's motion is known exactly, results come back as a table of numbers."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from cable_model.driving import follow, output_steps
from cable_model.errors import SolverError
from cable_model.model import Model
from cable_model.motion import MotionLike, top_motion
from cable_model.signals import INPUTS, OUTPUTS


@dataclass(frozen=True)
class Result:
    """Time series of a run: `table` (rows, 1 + 10 + outputs) with the names in `columns`; `shapes` (rows, points, 3)."""

    columns: tuple[str, ...]
    table: np.ndarray
    shapes: np.ndarray

    def __getitem__(self, name: str) -> np.ndarray:
        return self.table[:, self.columns.index(name)]


class RunStopped(SolverError):
    """The SolverError of a run; `result` has the rows before it."""

    def __init__(self, text: str, result: Result) -> None:
        super().__init__(text)
        self.result = result


COLUMNS = ("time", *INPUTS, *OUTPUTS)


def write_csv(path: Path, columns: tuple[str, ...], table: np.ndarray) -> None:
    """Write a table with a header line; 12 significant digits."""
    np.savetxt(path, table, fmt="%.12g", delimiter=",", header=",".join(columns), comments="")


def read_csv(path: Path) -> tuple[tuple[str, ...], np.ndarray]:
    """Columns and numbers of a CSV file with a header line."""
    with path.open(encoding="utf-8") as file:
        columns = tuple(name.strip() for name in file.readline().split(","))
        return columns, np.loadtxt(file, delimiter=",", ndmin=2)


def simulate(
    model: Model,
    duration: float | None = None,
    output_step: float | None = None,
    motion: MotionLike | None = None,
    progress: Callable[[float], None] | None = None,
    keep: Callable[[np.ndarray], None] | None = None,
) -> Result:
    """Run a model over its scene's duration and return the series at its output step, and at the end where that is no output time.

    The top's motion is followed between outputs too (driving.pieces).  `motion` replaces the scene's; `progress` is told the time after
    every step, `keep` every row as soon as it is there, so that a failed run keeps what came before.  Raises RunStopped, which has the
    rows so far.
    """
    scene = model.scene
    duration = scene.run.duration if duration is None else duration
    step = scene.run.output_step if output_step is None else output_step
    motion = motion or top_motion(scene.top, scene.winch)
    rows: list[np.ndarray] = []
    shapes: list[np.ndarray] = []

    def record(time: float, inputs: np.ndarray) -> None:
        row = np.concatenate(([time], inputs, np.zeros(len(INPUTS) - len(inputs)), model.outputs))
        rows.append(row)
        shapes.append(model.positions())
        if keep is not None:
            keep(row)

    start = motion(0.0, 1)
    model.initialize(start)
    record(0.0, start)
    try:
        for output in output_steps(duration, step):
            follow(model.advance, motion, output, scene.solver.time_step)
            record(output.end, motion(output.end, 1))
            if progress is not None:
                progress(output.end)
    except SolverError as error:
        raise RunStopped(str(error), Result(COLUMNS, np.array(rows), np.array(shapes))) from error
    return Result(COLUMNS, np.array(rows), np.array(shapes))
