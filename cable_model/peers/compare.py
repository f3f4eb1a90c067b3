"""Ours against peers at equal accuracy: each code at its cheapest setting that meets it against its own converged reference."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass

from cable_model.peers import moordyn
from cable_model.scene import Scene, load, with_values
from cable_model.studies.advice import advise
from cable_model.studies.timed import SIGNALS, Scale, Timed, errors, timed, worst
from cable_model.studies.work_precision import machine

ACCURACIES = (0.01, 0.003)
SEGMENTS = (5, 10, 20, 40, 80)  # of the peer; the last is its reference
COURANT = (1.6, 0.8)  # of 1/(highest frequency of its lumped masses): steps that are tried, the longest first
REPETITIONS = 5
HEAVE = [{"kind": "sinusoid", "axis": "z", "amplitude": 1.0, "angular_frequency": 0.2 * math.pi, "ramp_time": 10.0}]
CASES: Mapping[str, tuple[str, Mapping[str, object]]] = {
    "forced chain, EA 1e4 weights": ("hanging_chain", {}),
    "C3 sphere, EA 22 N": ("dale_sphere", {"cable.axial_stiffness": 22.0, "run.duration": 60.0}),
    "C3 sphere, EA 4448 N": ("dale_sphere", {"run.duration": 60.0}),
    "C4 wire, 1 m at 10 s": ("hard/snap", {"cable.axial_damping": 0.0, "top.motion": HEAVE, "run.duration": 60.0, "run.output_step": 0.1,
                                           "solver.lambda_infinity": -0.9}),
}  # fmt: skip


@dataclass(frozen=True)
class Row:
    """One accuracy on one case; a cost is processor seconds per simulated second, infinite where the code did not get there."""

    case: str
    accuracy: float
    ours: str
    our_cost: float
    peer: str
    peer_cost: float
    apart: float  # largest difference of the two codes' references, over the dynamic rms


def _highest_frequency(scene: Scene, segments: int) -> float:
    cable = scene.cable
    length = cable.length / segments
    return 2.0 * math.sqrt(cable.axial_stiffness / cable.mass_per_length) / length


def _peer_runs(scene: Scene, told: Callable[[str], None]) -> Iterator[tuple[str, Timed]]:
    for segments in SEGMENTS:
        for share in COURANT:
            step = share / _highest_frequency(scene, segments)
            told(f"MoorDyn: {segments} segments, step {step:.2g} s")
            runs = [moordyn.run(scene, segments, step)]
            if segments < SEGMENTS[-1]:
                runs += [moordyn.run(scene, segments, step) for _ in range(REPETITIONS - 1)]
            best = sorted(runs, key=lambda run: run.seconds)[len(runs) // 2]
            yield f"{segments} segments, RK4 {step:.2g} s", best


def compare(case: str, accuracies: Sequence[float] = ACCURACIES, told: Callable[[str], None] = print) -> list[Row]:
    """Rows of a case.  Times are medians of REPETITIONS runs, of the steps alone, all in this process."""
    name, changes = CASES[case]
    scene = with_values(load(name), changes)
    peers = list(_peer_runs(scene, told))
    good = [run for _, run in peers if not run.error]
    rows = []
    for accuracy in accuracies:
        advice = advise(scene, accuracy, progress=told)
        ours, our_cost = "none", math.inf
        if advice.choice is not None:
            seconds = sorted(timed(advice.scene).seconds for _ in range(REPETITIONS))[REPETITIONS // 2]
            ours, our_cost = f"{advice.choice.setting.method}, {advice.choice.setting.label}", seconds / scene.run.duration
        peer, peer_cost, apart = "none", math.inf, math.nan
        if good:
            finest, scale = good[-1], Scale.of(good[-1])
            apart = worst(errors(finest, advice.reference.run, advice.reference.scale))
            met = [(run.seconds, label) for label, run in peers if run is not finest and worst(errors(run, finest, scale)) <= accuracy]
            if met:
                seconds, peer = min(met)
                peer_cost = seconds / scene.run.duration
        rows.append(Row(case, accuracy, ours, our_cost, peer, peer_cost, apart))
    return rows


def markdown(rows: Sequence[Row]) -> str:
    """The rows as a table, with what they were measured on."""
    lines = [
        "# Cost at equal accuracy, beside MoorDyn",
        "",
        "Written by `python -m cable_model peers -o docs/peers.md` (extra `peers`).  Accuracy: rms error of top tension and of the lower",
        f"end's position ({' and '.join(SIGNALS)}, the larger), over their dynamic rms, each code against its own converged reference; the",
        "last column is how far the two references are apart.  Processor seconds per simulated second of the steps alone, medians of",
        f"{REPETITIONS} runs in one process; MoorDyn's top is moved in pieces of an output step.",
        f"{machine()}.",
        "",
        "| case | accuracy | ours | CPU s/s | MoorDyn | CPU s/s | MoorDyn / ours | references apart |",
        "|---|---:|---|---:|---|---:|---:|---:|",
    ]
    for r in rows:
        ratio = f"{r.peer_cost / r.our_cost:.1f}" if math.isfinite(r.peer_cost) else "not reached"
        lines.append(
            f"| {r.case} | {100 * r.accuracy:g} % | {r.ours} | {r.our_cost:.2g} | {r.peer} | {r.peer_cost:.2g} | {ratio} | {r.apart:.1e} |"
        )
    return "\n".join(lines) + "\n"
