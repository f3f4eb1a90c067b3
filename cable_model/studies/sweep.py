"""Sweeps: a scene at every combination of given values, on all cores or a dask cluster; results are files, so nothing is done twice."""

from __future__ import annotations

import csv
import hashlib
import itertools
import json
import os
import tomllib
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor, as_completed
from concurrent.futures.process import BrokenProcessPool
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from cable_model.errors import ParameterError, SolverError
from cable_model.models import MODELS
from cable_model.scene import Scene, load, to_toml, with_values
from cable_model.simulation import simulate, write_csv

MEASURES = (
    "top.tension mean",
    "top.tension std",
    "top.tension min",
    "top.tension max",
    "body.x min",
    "body.x max",
    "body.z min",
    "body.z max",
)
ATTEMPTS = 3  # of a pool whose worker died


@dataclass(frozen=True)
class Job:
    """One run: the values that it sets, and the file that its series go to."""

    key: str
    scene: Scene
    values: dict[str, Any]


def read(path: Path) -> tuple[Scene, dict[str, list[Any]]]:
    """A sweep file: `scene = "NAME or FILE"`, and a table [vary] of lists by dotted name, such as "cable.length" = [100, 200]."""
    if not path.is_file():
        raise ParameterError(f"{path}: no such file. Write one with `scene = ...` and a table [vary].")
    try:
        table = tomllib.loads(path.read_text(encoding="utf-8"))
    except tomllib.TOMLDecodeError as error:
        raise ParameterError(f"{path}: not a valid TOML file ({error}). Mend the line that is named.") from error
    if set(table) != {"scene", "vary"} or not isinstance(table["vary"], dict):
        raise ParameterError(f"{path}: must have `scene` and [vary], nothing else. Found: {', '.join(table) or 'nothing'}.")
    beside = path.parent / str(table["scene"])
    scene = load(beside if beside.is_file() else table["scene"])
    lists = {name: values if isinstance(values, list) else [values] for name, values in table["vary"].items()}
    return scene, lists


def jobs(scene: Scene, lists: dict[str, list[Any]]) -> list[Job]:
    """Every combination; a value that breaks a rule is refused here, before anything runs."""
    found = []
    for combination in itertools.product(*lists.values()):
        values = dict(zip(lists, combination, strict=True))
        changed = with_values(scene, values)
        key = hashlib.sha256(to_toml(changed).encode()).hexdigest()[:12]
        found.append(Job(key, changed, values))
    return found


def perform(job: Job, folder: str) -> dict[str, Any]:
    """Run a job and write its series, then its summary: the summary is there only if the series are complete."""
    target = Path(folder)
    result, error = None, ""
    try:
        result = simulate(MODELS[job.scene.run.model](job.scene))
    except SolverError as failure:
        error, result = str(failure), getattr(failure, "result", None)
    summary: dict[str, Any] = {"key": job.key, **job.values, "error": error}
    if result is not None:
        write_csv(target / f"{job.key}.csv", result.columns, result.table)
        for measure in MEASURES:
            name, statistic = measure.split()
            summary[measure] = float(getattr(result[name], statistic)())
    partial = target / f"{job.key}.{os.getpid()}.part"
    partial.write_text(json.dumps(summary), encoding="utf-8")
    partial.replace(target / f"{job.key}.json")
    return summary


def missing(wanted: Sequence[Job], folder: Path) -> list[Job]:
    return [job for job in wanted if not (folder / f"{job.key}.json").is_file()]


def run(
    wanted: Sequence[Job], folder: Path, workers: int, progress: Callable[[int], None] | None = None, scheduler: str | None = None
) -> list[dict[str, Any]]:
    """Run what has no result yet and return all summaries in order.

    `scheduler` is the address of a dask.distributed scheduler; without one the machine's own cores are used.  A worker that dies
    costs its own run, which is tried again; what is done stays.
    """
    folder.mkdir(parents=True, exist_ok=True)
    for attempt in range(ATTEMPTS):
        left = missing(wanted, folder)
        if progress is not None:
            progress(len(wanted) - len(left))
        if not left:
            break
        try:
            for _ in _over_cluster(left, folder, scheduler) if scheduler else _over_cores(left, folder, workers):
                if progress is not None:
                    progress(len(wanted) - len(missing(wanted, folder)))
        except BrokenProcessPool as broken:
            if attempt == ATTEMPTS - 1:
                names = ", ".join(str(job.values) for job in missing(wanted, folder)[:workers])
                raise SolverError(
                    f"a worker died {ATTEMPTS} times, last at one of: {names}. Finished runs are kept in {folder}."
                ) from broken
    return [json.loads((folder / f"{job.key}.json").read_text(encoding="utf-8")) for job in wanted]


def _over_cores(left: Sequence[Job], folder: Path, workers: int) -> Iterator[dict[str, Any]]:
    with ProcessPoolExecutor(max_workers=workers) as pool:
        for future in as_completed([pool.submit(perform, job, str(folder)) for job in left]):
            yield future.result()


def _over_cluster(left: Sequence[Job], folder: Path, scheduler: str) -> Iterator[dict[str, Any]]:
    """dask.distributed schedules, and repeats what a lost worker was doing; workers write to the same folder."""
    try:
        from distributed import Client
        from distributed import as_completed as completed
    except ImportError as absent:
        raise ParameterError("scheduler: dask.distributed is not installed. Install it with pip install 'cable-fmu[cluster]'.") from absent
    with Client(scheduler) as client:
        for future in completed([client.submit(perform, job, str(folder.resolve()), key=f"cable-{job.key}", retries=2) for job in left]):
            yield future.result()


def write_table(path: Path, summaries: Sequence[dict[str, Any]]) -> None:
    """All summaries as one CSV, a row a run."""
    with path.open("w", encoding="utf-8", newline="") as file:
        columns = list(dict.fromkeys(name for summary in summaries for name in summary))
        rows = csv.DictWriter(file, columns, lineterminator="\n")
        rows.writeheader()
        rows.writerows(summaries)
