"""Sweeps: a scene at every combination of given values, on all cores or a dask cluster; results are files, so nothing is done twice."""

from __future__ import annotations

import csv
import hashlib
import itertools
import json
import os
import tomllib
from collections.abc import Callable, Collection, Sequence
from concurrent.futures import as_completed
from concurrent.futures.process import BrokenProcessPool
from dataclasses import dataclass
from importlib import metadata
from pathlib import Path
from typing import Any

from cable_model.errors import ParameterError, SolverError, reading, writing
from cable_model.kernel_cache import mended
from cable_model.kernels.jit import source_hash
from cable_model.models import MODELS
from cable_model.scene import Scene, load, to_toml, with_values
from cable_model.simulation import simulate, write_csv
from cable_model.workers import pool

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
ATTEMPTS = 3  # of a run whose worker died


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
        with reading(path):
            table = tomllib.loads(path.read_text(encoding="utf-8"))
    except (tomllib.TOMLDecodeError, UnicodeDecodeError) as error:
        raise ParameterError(f"{path}: not a valid TOML file ({error}). Mend the line that is named.") from error
    if set(table) != {"scene", "vary"} or not isinstance(table["vary"], dict):
        raise ParameterError(f"{path}: must have `scene` and [vary], nothing else. Found: {', '.join(table) or 'nothing'}.")
    beside = path.parent / str(table["scene"])
    scene = load(beside if beside.is_file() else table["scene"])
    lists = {name: values if isinstance(values, list) else [values] for name, values in table["vary"].items()}
    return scene, lists


def jobs(scene: Scene, lists: dict[str, list[Any]]) -> list[Job]:
    """Every combination; a value that breaks a rule is refused here, before anything runs.

    The key of a job tells its scene and the code: what another version has left is not taken for its result.  Two jobs of one key
    would write one file.
    """
    for name, given in lists.items():
        if not given:
            raise ParameterError(f"vary: {name} has no values. Give at least one, or leave it out.")
    found = []
    for combination in itertools.product(*lists.values()):
        values = dict(zip(lists, combination, strict=True))
        with reading("vary"):
            changed = with_values(scene, values)
        key = hashlib.sha256(f"{metadata.version('cable-fmu')} {source_hash()}\n{to_toml(changed)}".encode()).hexdigest()[:12]
        found.append(Job(key, changed, values))
    keys = [job.key for job in found]
    for k, key in enumerate(keys):
        if key in keys[:k]:
            told = ", ".join(f"{name} = {value!r}" for name, value in found[k].values.items())
            raise ParameterError(f"vary: {told}: must be there once only. Remove the repetition.")
    return found


def perform(job: Job, folder: str) -> dict[str, Any]:
    """Run a job and write its series, then its summary: the summary is there only if the series are complete.

    A run that stops, or is refused, is a result too: it would do so again.
    """
    target = Path(folder)
    result, error = None, ""
    try:
        result = simulate(MODELS[job.scene.run.model](job.scene))
    except (SolverError, ParameterError) as failure:
        error, result = str(failure), getattr(failure, "result", None)
    summary: dict[str, Any] = {"key": job.key, **job.values, "error": error}
    if result is not None:
        write_csv(target / f"{job.key}.csv", result.columns, result.table)
        for measure in MEASURES:
            name, statistic = measure.split()
            summary[measure] = float(getattr(result[name], statistic)())
    partial = target / f"{job.key}.{os.getpid()}.part"
    with writing(partial):
        partial.write_text(json.dumps(summary), encoding="utf-8")
    partial.replace(target / f"{job.key}.json")
    return summary


def _read_summary(job: Job, folder: Path) -> dict[str, Any] | None:
    """The summary of a run; None where it is not there, or damaged."""
    try:
        summary = json.loads((folder / f"{job.key}.json").read_text(encoding="utf-8"))
    except (FileNotFoundError, ValueError):
        return None
    return summary if isinstance(summary, dict) and summary.get("key") == job.key else None


def missing(wanted: Sequence[Job], folder: Path) -> list[Job]:
    """Runs without a summary that can be read."""
    return [job for job in wanted if _read_summary(job, folder) is None]


def damaged(wanted: Sequence[Job], folder: Path) -> list[Path]:
    """Summaries that are there and cannot be read; their runs are missing."""
    return [path for job in missing(wanted, folder) if (path := folder / f"{job.key}.json").is_file()]


def run(
    wanted: Sequence[Job], folder: Path, workers: int, progress: Callable[[int], None] | None = None, scheduler: str | None = None
) -> list[dict[str, Any]]:
    """Run what has no result yet and return all summaries in order.

    `scheduler` is the address of a dask.distributed scheduler; without one the machine's own cores are used.  What a worker was doing
    that died is tried again, ATTEMPTS times in all; then its summary says so, and is not kept: the next call tries it again.
    """
    folder.mkdir(parents=True, exist_ok=True)

    for path in damaged(wanted, folder):
        path.unlink()
    left = missing(wanted, folder)

    def told() -> None:
        if progress is not None:
            progress(sum((folder / f"{job.key}.json").is_file() for job in wanted))

    told()
    died = _over_cluster(left, folder, scheduler, told) if scheduler else _over_cores(left, folder, workers, told)
    return [_summary(job, folder, died) for job in wanted]


def _summary(job: Job, folder: Path, died: Collection[str]) -> dict[str, Any]:
    if job.key in died:
        return {"key": job.key, **job.values, "error": f"its worker died {ATTEMPTS} times: out of memory?"}
    summary = _read_summary(job, folder)
    if summary is None:
        raise ParameterError(f"{folder / job.key}.json: gone or damaged since its run ended. Call the sweep again.")
    return summary


def _begun(job: Job, folder: Path) -> Path:
    """A file that is there while a job runs, and stays if its worker dies."""
    return folder / f"{job.key}.begun"


def _attempt(job: Job, folder: str) -> None:
    mark = _begun(job, Path(folder))
    mark.touch()
    with mended():
        perform(job, folder)
    mark.unlink()


def _pool(left: Sequence[Job], folder: Path, workers: int, told: Callable[[], None]) -> list[Job]:
    """Run jobs until all are done or a worker dies; those that were running then."""
    for job in left:
        _begun(job, folder).unlink(missing_ok=True)
    try:
        with pool(workers) as processes:
            for future in as_completed([processes.submit(_attempt, job, str(folder)) for job in left]):
                future.result()
                told()
    except BrokenProcessPool:
        return [job for job in missing(left, folder) if _begun(job, folder).exists()] or list(left[:1])
    return []


def _over_cores(left: Sequence[Job], folder: Path, workers: int, told: Callable[[], None]) -> set[str]:
    """The keys of jobs whose workers died; after a death each that was running is run alone, to tell which it was."""
    died: set[str] = set()
    while left:
        for job in _pool(left, folder, workers, told):
            tries = 1
            while tries < ATTEMPTS and _pool([job], folder, 1, told):
                tries += 1
            if tries == ATTEMPTS:
                died.add(job.key)
            _begun(job, folder).unlink(missing_ok=True)
        left = [job for job in missing(left, folder) if job.key not in died]
    return died


def _over_cluster(left: Sequence[Job], folder: Path, scheduler: str, told: Callable[[], None]) -> set[str]:
    """The keys of jobs whose workers died; dask.distributed schedules, and repeats what a lost worker was doing."""
    try:
        from distributed import Client, KilledWorker
        from distributed import as_completed as completed
    except ImportError as absent:
        raise ParameterError("scheduler: dask.distributed is not installed. Install it with pip install 'cable-fmu[cluster]'.") from absent
    died: set[str] = set()
    shared = f"{folder}: a worker of the cluster writes elsewhere. Give a folder that this machine and all workers share."
    with Client(scheduler) as client:
        running = {client.submit(perform, job, str(folder.resolve()), key=f"cable-{job.key}", retries=ATTEMPTS - 1): job for job in left}
        for future in completed(running):
            try:
                future.result()
            except KilledWorker:
                died.add(running[future].key)
            except FileNotFoundError as absent:
                raise ParameterError(shared) from absent
            told()
    if {job.key for job in missing(left, folder)} - died:
        raise ParameterError(shared)
    return died


def write_table(path: Path, summaries: Sequence[dict[str, Any]]) -> None:
    """All summaries as one CSV, a row a run."""
    with writing(path), path.open("w", encoding="utf-8", newline="") as file:
        columns = list(dict.fromkeys(name for summary in summaries for name in summary))
        rows = csv.DictWriter(file, columns, lineterminator="\n")
        rows.writeheader()
        rows.writerows(summaries)
