"""Trial of the adviser on scenes that it was not made with: is its choice accurate, and how much cheaper could it be?"""

from __future__ import annotations

import itertools
import statistics
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass

from cable_model.machine import machine
from cable_model.scene import Scene
from cable_model.studies import settings
from cable_model.studies.advice import Advice, advise
from cable_model.studies.price import Price, price
from cable_model.studies.reference import Reference, chain_setting
from cable_model.studies.timed import SIGNALS, Scale, Setting, Timed, errors, timed, worst
from cable_model.studies.work_precision import Point, all_settings

ACCURACY = 0.01
PRUNED = 3.0  # a ladder of the study is left where a run of it takes this many times the choice's time
AGAIN = 3  # interleaved repetitions, of which medians are compared
LEAST_PATIENCE = 0.2  # s of processor time that a run of the study may take in any case: short runs are noisy
RIVALS = 4  # cheapest settings of the study that are compared so
FACTOR = 10.0  # of accuracy, whose price is checked
HEAD = ("scene", "choice", "its errors", "cheapest of the study", "ratio", "run", "effects", "straight", "price", "verdict")
Told = Callable[[str], None]


@dataclass(frozen=True)
class Row:
    """What the trial of a scene found; errors are against a reference twice as fine in space and time as the adviser's finest."""

    name: str
    scene: Scene
    advice: Advice
    errors: dict[str, float]  # of the chosen scene
    cheapest: Point | None  # of the study, with its error against the same reference
    ratio: float  # of the medians of processor time: the choice over the cheapest
    tried: int  # settings of the study that ran, of `of`
    of: int
    straight: dict[str, float]  # the best errors of TowCable; empty where the scene has what it lacks
    price: Price | None
    gain: float  # measured accuracy gained by the price's setting, and its measured cost
    dearer: float

    @property
    def accurate(self) -> bool:
        return worst(self.errors) <= ACCURACY

    @property
    def cheap(self) -> bool:
        return self.ratio <= 3.0


class Judge:
    """A reference of its own for the adviser's: twice as fine in space and time."""

    def __init__(self, scene: Scene, reference: Reference) -> None:
        finest = reference.levels[-1].setting.changes
        cells, step = 2 * (int(str(finest["solver.nodes"])) - 1), 0.5 * float(str(finest["solver.time_step"]))
        self.run = timed(scene, chain_setting(scene, cells, step, solver__grid="staggered", cable__inextensible=False))
        self.scale = Scale.of(self.run)

    def errors(self, run: Timed) -> dict[str, float]:
        return errors(run, self.run, self.scale)


def _ladders(scene: Scene, quick: bool) -> Iterator[list[Setting]]:
    """The settings of the full study as ladders of rising cost: one a method and number of nodes."""
    for _, ladder in itertools.groupby(all_settings(scene, quick), key=lambda s: (s.method, s.changes.get("solver.nodes"))):
        yield list(ladder)


def study(scene: Scene, judge: Judge, ceiling: float, told: Told, quick: bool = False) -> tuple[list[Point], int]:
    """Points of the full study, and the number of its settings; a ladder ends where it costs more than `ceiling`."""
    points: list[Point] = []
    count = 0
    for ladder in _ladders(scene, quick):
        count += len(ladder)
        for setting in ladder:
            told(f"study: {setting.method}: {setting.label}")
            run = timed(scene, setting, longest=max(LEAST_PATIENCE, ceiling * scene.run.duration))
            cost = run.seconds / float(run.times[-1]) if not run.error else float("inf")
            points.append(Point(setting, cost, judge.errors(run), run.error))
            if (cost > ceiling and not run.error) or "given up" in run.error:
                break
    return points, count


def _medians(runs: Sequence[tuple[Scene, Setting | None]]) -> list[float]:
    """Processor seconds per simulated second, medians of runs that take turns."""
    seen: list[list[float]] = [[] for _ in runs]
    for _ in range(AGAIN):
        for (scene, setting), costs in zip(runs, seen, strict=True):
            run = timed(scene, setting)
            costs.append(run.seconds / float(run.times[-1]))
    return [statistics.median(costs) for costs in seen]


def trial(name: str, scene: Scene, told: Told, quick: bool = False) -> Row:
    """Advise on a scene, then judge the choice against a finer reference and against the full study; quick: the study's few settings."""
    advice = advise(scene, ACCURACY, progress=told)
    nothing = dict.fromkeys(SIGNALS, float("inf"))
    if advice.choice is None:
        return Row(name, scene, advice, nothing, None, float("inf"), 0, 0, {}, None, 0.0, 0.0)
    told("reference of the trial")
    judge = Judge(scene, advice.reference)
    own = judge.errors(timed(advice.scene))
    points, count = study(scene, judge, PRUNED * advice.choice.cost, told, quick)
    good = sorted((p for p in points if worst(p.errors) <= ACCURACY), key=lambda p: p.cost)[:RIVALS]
    told("the cheapest ones again")
    priced = price(advice, scene, FACTOR)
    again: list[tuple[Scene, Setting | None]] = [(advice.scene, None), *((scene, p.setting) for p in good)]
    choice_cost, *costs = _medians(again if priced is None else [*again, (scene, priced.setting)])
    gain = dearer = float("nan")
    if priced is not None:
        gain, dearer = worst(own) / worst(judge.errors(timed(scene, priced.setting))), costs.pop() / choice_cost
    best = min(range(len(good)), key=costs.__getitem__, default=None)
    tow = [p.errors for p in points if p.setting.method == settings.TOW]
    straight = min(tow, key=worst) if tow else {}
    cheapest = None if best is None else Point(good[best].setting, costs[best], good[best].errors, "")
    ratio = float("inf") if best is None else choice_cost / costs[best]
    return Row(name, scene, advice, own, cheapest, ratio, len(points), count, straight, priced, gain, dearer)


def _words(setting: Setting) -> str:
    return f"{setting.method}, {setting.label}"


def _percent(found: Mapping[str, float]) -> str:
    return " / ".join(f"{100.0 * found[name]:.2g} %" for name in SIGNALS)


def _straight(row: Row) -> str:
    if not row.straight:
        return "not possible"
    against = [check.words for check in row.advice.checks if not check.holds]
    return f"{_percent(row.straight)}; " + ("; ".join(f"against it: {words}" for words in against) or "its scales speak for it")


def _priced(row: Row) -> str:
    if row.price is None:
        return "-"
    how = "measured by the adviser" if row.price.measured else "expected"
    return f"{row.price.factor:.2g} times for {row.price.dearer:.2g} times the time ({how}); is {row.gain:.2g} for {row.dearer:.2g}"


def cells(row: Row) -> tuple[str, ...]:
    """One line of the table, as of HEAD."""
    if row.advice.choice is None:
        return (row.name, "none", *("-",) * (len(HEAD) - 3), "no choice")
    best = "none" if row.cheapest is None else f"{_words(row.cheapest.setting)}: {_percent(row.cheapest.errors)}"
    effects = [f"without {name}" for name in row.advice.left_out] + [f"with {name}" for name in row.advice.kept]
    verdict = "holds" if row.accurate and row.cheap else " and ".join(["not accurate"] * (not row.accurate) + ["dear"] * (not row.cheap))
    return (
        row.name, f"{_words(row.advice.choice.setting)}: {1e3 * row.advice.choice.cost:.2g} ms/s", _percent(row.errors), best,
        f"{row.ratio:.2f}", f"{row.tried} of {row.of}", "; ".join(effects) or "-", _straight(row), _priced(row), verdict,
    )  # fmt: skip


def markdown(rows: Sequence[Row]) -> str:
    """The rows as a table, with the rules and what the times were measured on."""
    held = sum(row.accurate and row.cheap for row in rows)
    lines = [
        "# The adviser on scenes that it was not made with",
        "",
        f"Written by `python -m cable_model.lab advise-trial`; scenes in `cable_model/lab/advice_scenes.py`.  {held} of {len(rows)} hold.",
        "",
        f"Asked: rms errors of top tension and of the lower end's position of {100.0 * ACCURACY:g} % of their dynamic rms at most.",
        "Judged: the chosen scene's errors (tension / position) against a reference twice as fine in space and time as the adviser's",
        "finest; and its processor time over that of the cheapest setting of the full study that meets the accuracy against the",
        f"same reference, 3 at most (medians of {AGAIN} runs that take turns, of the steps alone).  Pruned: a ladder of steps or",
        "tolerances of the study, one a method and number of nodes, ends where a run takes more than",
        f"{PRUNED:g} times the choice's time, as what follows is dearer still; the column run says how many settings that leaves.",
        "A ratio below 1 is a choice that leaves effects out, or noise.  Straight: TowCable's errors, and the scales against it.",
        f"Price: what {FACTOR:g} times the accuracy was said to cost, and what that setting then gave.",
        "",
        f"{machine()}.",
        "",
        "| " + " | ".join(HEAD) + " |",
        "|" + "---|" * len(HEAD),
    ]
    return "\n".join(lines + ["| " + " | ".join(cells(row)) + " |" for row in rows]) + "\n"
