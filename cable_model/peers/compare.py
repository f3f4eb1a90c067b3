"""Ours against peers at equal accuracy: each code at its cheapest setting that meets it against its own converged reference."""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import partial

from cable_model.peers import cabledyn, deck, moordyn
from cable_model.scene import Scene, load, with_values
from cable_model.studies.advice import advise
from cable_model.studies.timed import SIGNALS, Scale, Timed, errors, timed, worst
from cable_model.studies.work_precision import machine

ACCURACIES = (0.01, 0.003)
SEGMENTS = (5, 10, 20, 40, 80, 160)
COURANT = (1.6, 0.8)  # of 1/(highest frequency of MoorDyn's lumped masses): its steps, the longest first
CALLS = (20, 400)  # an output step, by which MoorDyn's top is moved, but no more than it has steps
IMPLICIT_STEPS = (1, 2, 5, 10, 20)  # an output step: those of CableDyn, which is implicit
REPETITIONS = 5
LONGEST = 15.0  # processor seconds of a run: finer settings of that code are not tried
PROBE = 0.01  # of a run, by which its time is judged beforehand
HEAVE = [{"kind": "sinusoid", "axis": "z", "amplitude": 1.0, "angular_frequency": 0.2 * math.pi, "ramp_time": 10.0}]
SHIFT, SHIFT_TIME = 1e-3, 2.2  # m, s: of the free chain's top, which then stands still
SHIFTED: Mapping[str, object] = {
    "cable.bending_stiffness": 0.0, "lower_end.release_force": 0.0, "run.output_step": 0.1,
    "top.motion": [
        {"kind": "sinusoid", "axis": "x", "amplitude": SHIFT, "angular_frequency": 0.0, "phase": 0.5 * math.pi, "ramp_time": SHIFT_TIME}
    ],
}  # fmt: skip
CIRCLE = {"cable.bending_stiffness": 0.0, "current.levels": (), "run.duration": 690.0}
WIRE = {"cable.axial_damping": 0.0, "top.motion": HEAVE, "run.duration": 60.0, "run.output_step": 0.1, "solver.lambda_infinity": -0.9}
Changes = Mapping[str, object]
Simulate = Callable[[Scene], Timed]


@dataclass(frozen=True)
class Case:
    """A scene with changes, and the signals in which it is judged."""

    scene: str
    changes: Changes
    signals: tuple[str, ...] = SIGNALS

    def load(self) -> Scene:
        return with_values(load(self.scene), self.changes)


CASES: Mapping[str, Case] = {
    # the tension of a freely swinging chain changes by 1e-5 only
    "C1 free chain, EA 1e4 weights": Case("free_chain", {**SHIFTED, "cable.axial_stiffness": 1e4}, ("position",)),
    "C2 free chain, EA 1e9 weights": Case("free_chain", SHIFTED, ("position",)),
    "C3 sphere, EA 22 N": Case("dale_sphere", {"cable.axial_stiffness": 22.0, "run.duration": 60.0}),
    "C3 sphere, EA 4448 N": Case("dale_sphere", {"run.duration": 60.0}),
    "C4 wire, 1 m at 10 s": Case("hard/snap", WIRE),
    "C5 tow in a circle": Case("hard/tow_circle", CIRCLE),
    "forced chain, EA 1e4 weights": Case("hanging_chain", {}),
}  # fmt: skip


@dataclass(frozen=True)
class Run:
    """One setting of a code, what it gave, and how to run it again."""

    words: str
    again: Callable[[], Timed]
    result: Timed


@dataclass(frozen=True)
class Row:
    """One accuracy of one code on one case; a cost is processor seconds per simulated second, infinite where it was not reached."""

    case: str
    accuracy: float
    ours: str
    our_cost: float
    code: str
    setting: str
    cost: float
    apart: float  # largest difference of the two codes' references, over the dynamic rms
    why: str = ""  # it was not reached


def _highest_frequency(scene: Scene, segments: int) -> float:
    cable = scene.cable
    return 2.0 * math.sqrt(cable.axial_stiffness / cable.mass_per_length) * segments / cable.length


def _moordyn_settings(scene: Scene, segments: int) -> Iterator[tuple[str, Simulate]]:
    every = scene.run.output_step
    for share in COURANT:
        step = share / _highest_frequency(scene, segments)
        most = max(1, math.floor(every / step))
        for calls in dict.fromkeys(min(calls, most) for calls in CALLS):
            words = f"{segments} segments, step {step:.2g} s, top moved every {every / calls:.2g} s"
            yield words, partial(moordyn.run, segments=segments, step=step, calls=calls)


def _cabledyn_settings(scene: Scene, segments: int) -> Iterator[tuple[str, Simulate]]:
    for calls in IMPLICIT_STEPS:
        words = f"{segments} segments, step {scene.run.output_step / calls:.2g} s"
        yield words, partial(cabledyn.run, segments=segments, calls=calls)


CODES: Mapping[str, Callable[[Scene, int], Iterable[tuple[str, Simulate]]]] = {
    "MoorDyn": _moordyn_settings,
    "CableDyn": _cabledyn_settings,
}


def _runs(code: str, scene: Scene, numbers: Sequence[int], told: Callable[[str], None]) -> tuple[list[Run], str]:
    """All runs of a code that take no longer than LONGEST, and how long the first too long one would have taken, or why it cannot run."""
    done: list[Run] = []
    left_out = ""
    short = with_values(scene, {"run.duration": max(PROBE * scene.run.duration, 2.0 * scene.run.output_step)})
    for words, run in itertools.chain.from_iterable(CODES[code](scene, n) for n in numbers):
        told(f"{code}: {words}")
        try:
            expected = run(short).seconds * scene.run.duration / short.run.duration
        except deck.NotTranslated as reason:
            return [], str(reason)
        if expected > LONGEST:
            left_out = left_out or f"{words} would take {expected / scene.run.duration:.2g} s/s"
            continue
        again = partial(run, scene)
        done.append(Run(words, again, again()))
    return done, left_out


def _cheapest(runs: Sequence[Run], accuracy: float, signals: tuple[str, ...]) -> tuple[str, float, str]:
    """Setting and seconds, medians of REPETITIONS, of the cheapest run that is accurate against the finest; or why there is none."""
    finest = max((run for run in runs if not run.result.error), key=lambda run: run.result.seconds, default=None)
    if finest is None:
        return "", math.inf, runs[0].result.error if runs else ""
    scale = Scale.of(finest.result)
    found = [(worst(errors(run.result, finest.result, scale), signals), run) for run in runs if run is not finest]
    for _, run in sorted(found, key=lambda pair: pair[1].result.seconds):
        if worst(errors(run.result, finest.result, scale), signals) <= accuracy:
            return run.words, sorted(run.again().seconds for _ in range(REPETITIONS))[REPETITIONS // 2], ""
    if not found:
        return "", math.inf, f"nothing but {finest.words} ran"
    least = min(error for error, _ in found)
    return "", math.inf, f"its runs differ from its finest ({finest.words}) by {100.0 * least:.2g} % or more"


def compare(
    case: str, accuracies: Sequence[float] = ACCURACIES, segments: Sequence[int] = SEGMENTS, told: Callable[[str], None] = print
) -> list[Row]:
    """Rows of a case, the peers with `segments`.  Times are medians of REPETITIONS runs, of the steps alone, all in this process."""
    chosen = CASES[case]
    scene, signals = chosen.load(), chosen.signals
    theirs = {code: _runs(code, scene, segments, told) for code in CODES}
    rows = []
    for accuracy in accuracies:
        advice = advise(scene, accuracy, signals, progress=told)
        ours, our_cost = "none", math.inf
        if advice.choice is not None:
            seconds = sorted(timed(advice.scene).seconds for _ in range(REPETITIONS))[REPETITIONS // 2]
            ours, our_cost = f"{advice.choice.setting.method}, {advice.choice.setting.label}", seconds / scene.run.duration
        for code, (runs, left_out) in theirs.items():
            setting, seconds, why = _cheapest(runs, accuracy, signals)
            good = [run.result for run in runs if not run.result.error]
            finest = max(good, key=lambda run: run.seconds, default=None)
            apart = worst(errors(finest, advice.reference.run, advice.reference.scale), signals) if finest is not None else math.nan
            why = "; ".join(text for text in (why, left_out) if text) if not setting else ""
            rows.append(Row(case, accuracy, ours, our_cost, code, setting, seconds / scene.run.duration, apart, why))
    return rows


def markdown(rows: Sequence[Row]) -> str:
    """The rows as a table, with what they were measured on."""
    lines = [
        "# Cost at equal accuracy, beside MoorDyn and CableDyn",
        "",
        "Written by `python -m cable_model peers -o docs/peers.md` (extra `peers`).  Accuracy: rms error of top tension and of the lower",
        f"end's position ({' and '.join(SIGNALS)}, the larger; position alone in C1 and C2), over their dynamic rms, each code against",
        "its own finest run; the last column is how far that is from our converged reference: where this is more than the accuracy, a code",
        "agrees with itself only.  In C1 and C2 the top moves 1 mm aside and stands still.  Processor seconds per simulated second of the",
        f"steps alone, medians of {REPETITIONS} runs in one process; settings of a peer that take more than {LONGEST:g} s are not",
        "run.  MoorDyn: RK4, its top moved at constant velocity from call to call; CableDyn: its coupled point, which is what its Python",
        "interface moves.",
        f"{machine()}.",
        "",
        "| case | accuracy | ours | CPU s/s | code | its setting | CPU s/s | times ours | references apart |",
        "|---|---:|---|---:|---|---|---:|---:|---:|",
    ]
    for r in rows:
        cost, ratio = (f"{r.cost:.2g}", f"{r.cost / r.our_cost:.1f}") if math.isfinite(r.cost) else ("-", "not reached")
        lines.append(
            f"| {r.case} | {100 * r.accuracy:g} % | {r.ours} | {r.our_cost:.2g} | {r.code} | {r.setting or r.why} | {cost} | {ratio} "
            f"| {r.apart:.1e} |"
        )
    return "\n".join(lines) + "\n"
