"""Runs the hard cases and judges them: one process a variant, results as they come; nothing here prints."""

from __future__ import annotations

import functools
import math
from collections.abc import Iterator, Sequence
from concurrent.futures import as_completed
from dataclasses import dataclass

from cable_model.lab.hard import rules
from cable_model.lab.hard.cases import CASES, Case, Variant
from cable_model.lab.hard.checks import CHECKS
from cable_model.lab.hard.record import Record, record
from cable_model.lab.hard.rules import Finding
from cable_model.scene import Scene, load, with_values
from cable_model.workers import pool


@dataclass(frozen=True)
class Verdict:
    """A run of a variant with what the rules found; `run.shapes` and series are for the picture."""

    case: Case
    variant: Variant
    run: Record
    findings: tuple[Finding, ...]

    @property
    def passed(self) -> bool:
        return all(finding.holds for finding in self.findings)


def scene_of(case: Case, variant: Variant) -> Scene:
    return with_values(load(case.scene), variant.changes)


def _refined(scene: Scene, factor: int) -> Scene:
    """A finer scene: `factor` times the cells, and its square less the step."""
    nodes = factor * (scene.solver.nodes - 1) + 1
    return with_values(scene, {"solver.nodes": nodes, "solver.time_step": scene.solver.time_step / factor**2})


def judge(case: Case, variant: Variant) -> Verdict:
    """Run a variant, and finer ones where the rules ask for them."""
    scene = scene_of(case, variant)
    step, duration = scene.solver.time_step, scene.run.duration
    run = record(scene)
    found = [rules.finishes(run, duration)]
    if len(run.excess):
        found += [rules.keeps_energy(run), *rules.keeps_geometry(run, case.chaos)]
    if variant.judged and variant.refined and not run.error:
        found += _against_finer(case, scene, run, min(case.chaos, duration))
        found.append(_against_coarser_communication(case, scene, run, step, min(case.chaos, duration)))
    return Verdict(case, variant, run, tuple(found))


@functools.cache
def _reference(scene: Scene, step: float, duration: float) -> Record:
    """The run that the statistics of every variant of a case are held against; once a process."""
    return record(scene, step=step, duration=duration, watch=False)


def _against_finer(case: Case, scene: Scene, run: Record, until: float) -> list[Finding]:
    step = scene.solver.time_step
    until = step * math.floor(until / step + 1e-9)
    finer = record(_refined(scene, 2), step=step, duration=until, watch=False)
    finest = record(_refined(scene, 4), step=step, duration=until, watch=False)
    found = rules.converges(run, finer, finest, case.chaos, case.tolerance)
    if case.statistics:
        sampling = 0.01
        long = record(scene, step=max(step, sampling), duration=case.statistics, watch=False)
        reference = _reference(with_values(load(case.scene), case.reference), sampling, case.statistics)
        found += rules.keeps_statistics(long, reference, case.chaos)
    return found


def _against_coarser_communication(case: Case, scene: Scene, run: Record, step: float, until: float) -> Finding:
    count = max(1, math.floor(until / (5.0 * step) + 1e-9))
    return rules.ignores_communication(run, record(scene, step=5.0 * step, duration=5.0 * step * count, watch=False), case.chaos)


def chosen(keys: Sequence[str]) -> list[Case]:
    """Cases by their keys ("H2" takes "H2 step" too); none named: all."""
    return [case for case in CASES if not keys or case.key in keys or case.key.split()[0] in keys]


def run_all(cases: Sequence[Case], jobs: int) -> Iterator[Verdict]:
    """Verdicts of all variants in the order in which they are ready."""
    with pool(jobs) as workers:
        waiting = [workers.submit(judge, case, variant) for case in cases for variant in case.variants]
        for future in as_completed(waiting):
            yield future.result()


def further(case: Case, verdicts: Sequence[Verdict]) -> list[Finding]:
    """The case's own check over its judged runs."""
    runs = {verdict.variant.label: verdict.run for verdict in verdicts if verdict.variant.judged}
    ordered = {variant.label: runs[variant.label] for variant in case.variants if variant.label in runs}
    return CHECKS[case.check](ordered) if case.check else []
