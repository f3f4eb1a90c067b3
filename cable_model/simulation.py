"""Running a scene in the library: the top's motion is known exactly, results come back as a table of numbers."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, TextIO

import numpy as np
from numpy.typing import ArrayLike

from cable_model.audit import Audit
from cable_model.doubts import under_a_given_motion
from cable_model.driving import follow, output_steps
from cable_model.errors import ParameterError, SolverError, refuse, unknown, writing
from cable_model.model import Model
from cable_model.motion import MotionLike, motion_of
from cable_model.profiles import Profiles
from cable_model.scene import Scene
from cable_model.signals import INPUTS, OUTPUTS

if TYPE_CHECKING:
    import xarray


@dataclass(frozen=True)
class Result:
    """Time series of a run: `table` (rows, 1 + 22 + outputs) with the names in `columns`; `shapes` (rows, points, 3).

    `shapes` are positions of the nodes from the lower end to the top, m, `tensions` (rows, points) those there, N, and `arc_lengths`
    (rows, points) where they are on the unstretched cable, from the lower end, m; None where the result is not of a model.

    `warnings` say what is doubtful about it, `audit` how well its balances close, where it was audited; `scene` is what was simulated (a
    motion that was given in place of its own is not in it), and `model` the name of the model's type.
    """

    columns: tuple[str, ...]
    table: np.ndarray
    shapes: np.ndarray
    warnings: tuple[str, ...] = ()
    audit: Audit | None = None
    tensions: np.ndarray | None = None
    arc_lengths: np.ndarray | None = None
    scene: Scene | None = None
    model: str = ""

    def __getitem__(self, name: str) -> np.ndarray:
        """The series of a column.  Raises ParameterError with the nearest name for one that is not there."""
        if name not in self.columns:
            raise unknown(name, self.columns, "column")
        return self.table[:, self.columns.index(name)]

    def profiles(self, times: ArrayLike | None = None) -> Profiles:
        """Places, tensions and curvature along the cable at the output steps nearest to `times` (k,), s; at all of them by default.

        Raises ParameterError where the result has none, and for times that are not within the run.
        """
        if self.arc_lengths is None or self.tensions is None:
            raise ParameterError(
                "profiles: must be of a model's run, and this result has time series only. Use simulate, or connect shape.* of the FMU."
            )
        rows = slice(None) if times is None else self._nearest(np.asarray(times, dtype=float).ravel())
        return Profiles(self["time"][rows], self.arc_lengths[rows], self.shapes[rows], self.tensions[rows])

    def _nearest(self, times: np.ndarray) -> np.ndarray:
        """Rows of the output steps that are nearest to times."""
        known = self["time"]
        outside = ~((times >= known[0]) & (times <= known[-1]))  # nan is nowhere
        if outside.any():
            within = f">= {known[0]:g} and <= {known[-1]:g}, the times of the run"
            raise refuse("times", float(times[outside][0]), "s", within, "Ask for others, or simulate longer.")
        return np.array([np.abs(known - time).argmin() for time in times], dtype=int)

    def to_xarray(self) -> xarray.Dataset:
        """All of it as one dataset, with units, meanings, warnings and the scene.  Raises ParameterError where xarray is not installed.

        Series go over `time`, and by their names as in `columns`; profiles, where the result has them, over `time` and `arc_length`, by
        those of facts.PROFILE.  Where a winch changes the lengths, or the cable parts, the second dimension is `point`, and
        `arc_length` goes over both.
        """
        from cable_model.result_files import dataset

        return dataset(self)


class RunStopped(SolverError):
    """The SolverError of a run; `result` has the rows before it."""

    def __init__(self, text: str, result: Result) -> None:
        super().__init__(text)
        self.result = result


COLUMNS = ("time", *INPUTS, *OUTPUTS)
_MEANS = [k for k, name in enumerate(OUTPUTS) if ".force_mean_" in name]  # over the output step, however it is followed


def write_csv(path: Path, columns: tuple[str, ...], table: np.ndarray) -> None:
    """Write a table with a header line, in digits from which the same numbers are read."""
    lines = [",".join(columns), *map(csv_row, table)]
    with writing(path):
        path.write_text("\n".join(lines) + "\n", encoding="utf-8")


def csv_row(row: np.ndarray) -> str:
    """The shortest digits that read back as the same numbers, with commas between them."""
    return ",".join(repr(number).removesuffix(".0") for number in row.tolist())


class CsvRows:
    """Writes rows of a run as they come.  The file is not touched before the first: a run that cannot begin leaves what was there."""

    def __init__(self, path: Path) -> None:
        self._path = path
        self._file: TextIO | None = None

    def __call__(self, row: np.ndarray) -> None:
        with writing(self._path):
            if self._file is None:
                self._path.parent.mkdir(parents=True, exist_ok=True)
                self._file = self._path.open("w", encoding="utf-8")
                self._file.write(",".join(COLUMNS) + "\n")
            self._file.write(csv_row(row) + "\n")

    def __enter__(self) -> CsvRows:
        return self

    def __exit__(self, *why: object) -> None:
        if self._file is not None:
            with writing(self._path):
                self._file.close()


def read_csv(path: Path) -> tuple[tuple[str, ...], np.ndarray]:
    """Columns and numbers of a CSV file with a header line; ParameterError names the line that is none."""
    if not path.is_file():
        raise ParameterError(f"{path}: no such file. Write it with `python -m cable_model run`.")
    try:
        header, *lines = path.read_text(encoding="utf-8").splitlines()
    except ValueError as error:  # an empty file, or no text
        raise ParameterError(f"{path}: no CSV file with a header line. Write it with `python -m cable_model run`.") from error
    columns = tuple(name.strip() for name in header.split(","))
    if len(set(columns)) < len(columns):
        raise ParameterError(f"{path}, line 1: two columns have one name. Give each column a name of its own.")
    rows = []
    for k, line in enumerate(lines, start=2):
        if not line.strip():
            continue
        try:
            rows.append([float(text) for text in line.split(",")])
        except ValueError as error:
            raise ParameterError(f"{path}, line {k}: {error}. Mend the line, or write the file again.") from error
        if len(rows[-1]) != len(columns):
            raise ParameterError(f"{path}, line {k}: {len(rows[-1])} numbers under {len(columns)} names. Mend it, or write the file again.")
    return columns, np.array(rows).reshape(-1, len(columns))


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
    motion = motion or motion_of(scene)
    rows: list[np.ndarray] = []
    shapes: list[np.ndarray] = []
    tensions: list[np.ndarray] = []
    arc_lengths: list[np.ndarray] = []
    impulse = np.zeros(len(_MEANS))
    changing = scene.winch.fitted or model.parts.parting is not None  # the lengths of its cells

    def advance(time: float, length: float, first: np.ndarray, last: np.ndarray) -> None:
        model.advance(time, length, first, last)
        impulse[:] += length * model.outputs[_MEANS]

    def record(time: float, inputs: np.ndarray, mean: np.ndarray) -> None:
        row = np.concatenate(([time], model.complete(inputs), model.outputs))
        row[1 + len(INPUTS) + np.array(_MEANS)] = mean
        impulse[:] = 0.0
        rows.append(row)
        nodes = model.nodes()
        shapes.append(nodes[:, :3])
        tensions.append(nodes[:, 3])
        if changing or not arc_lengths:
            arc_lengths.append(model.arc_lengths())
        if keep is not None:
            keep(row)

    def result() -> Result:
        told = (*model.warnings(), *under_a_given_motion(scene))
        pulls = np.array(tensions)
        arcs = np.broadcast_to(np.array(arc_lengths), pulls.shape)  # one row serves all where they do not change
        done = replace(scene, run=replace(scene.run, duration=duration, output_step=step))
        return Result(COLUMNS, np.array(rows), np.array(shapes), told, model.audit, pulls, arcs, done, type(model).__name__)

    start = motion(0.0, 1)
    model.initialize(start)
    record(0.0, start, model.outputs[_MEANS])
    try:
        for output in output_steps(duration, step):
            follow(advance, motion, output, scene.solver.time_step)
            record(output.end, motion(output.end, 1), impulse / output.length)
            if progress is not None:
                progress(output.end)
    except SolverError as error:
        raise RunStopped(str(error), result()) from error
    return result()
