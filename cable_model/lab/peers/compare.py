"""Ours against peers at equal accuracy: each code at its cheapest setting that meets it against its own converged reference."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property, partial
from statistics import median

from cable_model.lab.cost_cases import CIRCLE, SHIFTED, WIRE
from cable_model.lab.peers import cabledyn, deck, moordyn
from cable_model.machine import machine
from cable_model.scene import Scene, load, with_values
from cable_model.studies.advice import advise
from cable_model.studies.timed import SIGNALS, Scale, Timed, errors, timed, worst

ACCURACIES = (0.01, 0.003)
SEGMENTS = (5, 10, 20, 40, 80, 160)
COURANT = (1.6, 0.8)  # of 1/(highest frequency of MoorDyn's lumped masses): its steps, the longest first
CALLS = (20, 400)  # an output step, by which MoorDyn's top is moved, but no more than it has steps
IMPLICIT_STEPS = (1, 2, 5, 10, 20)  # an output step: those of CableDyn, which is implicit
REPETITIONS = 5
LONGEST = 30.0  # processor seconds of a run: finer settings of that code are not tried
PROBE = 0.01  # of a run, by which its time is judged beforehand
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

    segments: int
    words: str
    again: Callable[[], Timed]
    result: Timed

    @cached_property
    def seconds(self) -> float:
        """Median of REPETITIONS."""
        return median(self.again().seconds for _ in range(REPETITIONS))


@dataclass(frozen=True)
class Reached:
    """The cheapest setting that is accurate and its processor seconds per simulated second; or why there is none, at infinite cost."""

    setting: str
    cost: float
    why: str = ""


@dataclass(frozen=True)
class Row:
    """One accuracy of one code on one case, by the code's own finest run and by our converged reference."""

    case: str
    accuracy: float
    ours: Reached
    code: str
    by_itself: Reached
    by_ours: Reached
    apart: float  # largest difference of the two references, over the dynamic rms


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
    for segments in numbers:
        before = len(done)
        for words, run in CODES[code](scene, segments):
            told(f"{code}: {words}")
            try:
                expected = run(short).seconds * scene.run.duration / short.run.duration
            except deck.NotTranslated as reason:
                return [], str(reason)
            if expected > LONGEST:
                left_out = left_out or f"{words} would take {expected / scene.run.duration:.2g} s/s"
                continue
            again = partial(run, scene)
            done.append(Run(segments, words, again, again()))
        if len(done) == before:  # more segments take longer still
            break
    return done, left_out


def _cheapest(runs: Sequence[Run], reference: Timed, duration: float, accuracy: float, signals: tuple[str, ...]) -> Reached:
    """The cheapest of the runs that is accurate against a reference."""
    scale = Scale.of(reference)
    least = math.inf
    for run in sorted(runs, key=lambda run: run.result.seconds):
        found = worst(errors(run.result, reference, scale), signals)
        if found <= accuracy:
            return Reached(run.words, run.seconds / duration)
        least = min(least, found)
    if not runs:
        return Reached("", math.inf, "no coarser mesh ran")
    return Reached(
        "", math.inf, f"none of its runs is nearer than {100.0 * least:.2g} %" if math.isfinite(least) else "none of its runs ended"
    )


def compare(
    case: str, accuracies: Sequence[float] = ACCURACIES, segments: Sequence[int] = SEGMENTS, told: Callable[[str], None] = print
) -> list[Row]:
    """Rows of a case, the peers with `segments`.  Times are medians of REPETITIONS runs, of the steps alone, all in this process."""
    chosen = CASES[case]
    scene, signals = chosen.load(), chosen.signals
    duration = scene.run.duration
    theirs = {code: _runs(code, scene, segments, told) for code in CODES}
    rows = []
    for accuracy in accuracies:
        advice = advise(scene, accuracy, signals, progress=told)
        ours = Reached("", math.inf, "none")
        if advice.choice is not None:
            seconds = median(timed(advice.scene).seconds for _ in range(REPETITIONS))
            ours = Reached(f"{advice.choice.setting.method}, {advice.choice.setting.label}", seconds / duration)
        reference = advice.reference.run
        for code, (runs, left_out) in theirs.items():
            finest = max((run for run in runs if not run.result.error), key=lambda run: run.result.seconds, default=None)
            if finest is None:
                nothing = Reached("", math.inf, runs[0].result.error if runs else left_out)
                rows.append(Row(case, accuracy, ours, code, nothing, nothing, math.nan))
                continue
            coarser = [run for run in runs if run.segments < finest.segments]
            by_itself = _cheapest(coarser, finest.result, duration, accuracy, signals)
            by_ours = _cheapest(runs, reference, duration, accuracy, signals)
            apart = worst(errors(finest.result, reference, Scale.of(reference)), signals)
            told(f"{code}: finest {finest.words}; left out: {left_out or 'nothing'}")
            rows.append(Row(case, accuracy, ours, code, by_itself, by_ours, apart))
    return rows


def _cells(found: Reached, ours: Reached) -> str:
    if not math.isfinite(found.cost):
        return f"{found.why} | - | not reached"
    return f"{found.setting} | {found.cost:.2g} | {found.cost / ours.cost:.1f}"


def markdown(rows: Sequence[Row]) -> str:
    """The rows as a table, with what they were measured on."""
    lines = [
        "# Cost at equal accuracy, beside MoorDyn and CableDyn",
        "",
        "Written by `python -m cable_model.lab peers -o docs/peers.md` (extra `peers`)."
        "  Accuracy: rms error of top tension and of the lower",
        f"end's position ({' and '.join(SIGNALS)}, the larger; position alone in C1 and C2), over their dynamic rms.  Another code is",
        "judged twice: by its own finest run, which has more segments than those that it judges, and by our converged reference, whose",
        "own error is a fifth of the accuracy at most; ours by the latter.  The last column is how far the other code's finest run is",
        "from our reference: where this is more than the accuracy, it agrees with itself only.",
        "",
        f"Processor seconds per simulated second of the steps alone, medians of {REPETITIONS} runs in one process; settings of a peer that",
        f"take more than {LONGEST:g} s are not run.  MoorDyn: RK4, its top moved at constant velocity from call to call.  CableDyn: its",
        "coupled point, which is what its Python interface moves.  Both get a tenth of a segment's critical damping along the cable",
        "(MoorDyn's errors with ten times as much are about the same); ours has none.",
        "",
        "- C1, C2: chain of 1 m, the top moves 1 mm aside and then stands still.",
        "- C3: Wang's sphere of table 1 on a soft and on a steel-like cable.",
        "- C4: 200 m wire with a body of 1000 kg, heave of 1 m at 10 s, never slack, no damping in the wire.",
        "- C5: scene `hard/tow_circle` in still water and without bending, neither of which the other codes can be told here.  MoorDyn",
        "  starts a little off its equilibrium and rings along the cable: that, not the tow, is how far it is apart there.",
        "- Forced chain: scene `hanging_chain`.",
        "",
        f"{machine(('moordyn', 'cabledyn'))}.",
        "",
        "| case | accuracy | ours | CPU s/s | code | by its own finest | CPU s/s | times ours | by our reference | CPU s/s | times ours "
        "| apart |",
        "|---|---:|---|---:|---|---|---:|---:|---|---:|---:|---:|",
    ]
    for r in rows:
        lines.append(
            f"| {r.case} | {100 * r.accuracy:g} % | {r.ours.setting or r.ours.why} | {r.ours.cost:.2g} | {r.code} "
            f"| {_cells(r.by_itself, r.ours)} | {_cells(r.by_ours, r.ours)} | {r.apart:.1e} |"
        )
    return "\n".join(lines) + "\n"
