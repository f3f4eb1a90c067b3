"""What a person reads of the hard cases: a table in Markdown, the same in CSV, and one picture a case."""

from __future__ import annotations

import csv
from collections.abc import Mapping, Sequence
from pathlib import Path

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np
from matplotlib.axes import Axes

from cable_model.errors import writing
from cable_model.lab.hard import basin
from cable_model.lab.hard.rules import Finding
from cable_model.lab.hard.runner import Verdict

HEAD = ("case", "run", "reached", "steps", "rejected", "energy excess / W L", "drift / L", "refined: path / L, then", "verdict")
MOST_LINES = 6  # runs that a picture overlays
AT_REST = 1e-3  # of L: what a picture of places shows at least, so that rounding does not look like motion


def _number(verdict: Verdict, words: str) -> str:
    found = [f.value for f in verdict.findings if f.words.startswith(words)]
    return f"{found[-1]:.1e}" if found else "-"


def row(verdict: Verdict) -> tuple[str, ...]:
    """One line of the table."""
    run, last = verdict.run, verdict.run.outputs[-1]
    steps, rejected = f"{last[15]:.0f}", f"{last[17]:.0f}"
    refined = f"{_number(verdict, 'path against a finer run')}, {_number(verdict, 'and the finer run')}"
    if verdict.variant.judged:
        failed = [f for f in verdict.findings if not f.holds]
        judged = "passes" if not failed else "fails: " + "; ".join(f"({f.rule}) {f.words} {f.value:.2g} > {f.limit:.2g}" for f in failed)
    else:
        broken = sorted({f.rule for f in verdict.findings if not f.holds})
        judged = "reported: " + (f"breaks {', '.join(broken)}" if broken else "keeps every rule asked")
    if run.error:
        judged += f" (stopped at {run.reached:.3g} s)"
    return (
        verdict.case.key, verdict.variant.label, f"{run.reached:.4g} s", steps, rejected,
        _number(verdict, "energy"), _number(verdict, "drift"), refined if verdict.variant.refined else "-", judged,
    )  # fmt: skip


def write(folder: Path, verdicts: Sequence[Verdict], further: Mapping[str, Sequence[Finding]]) -> None:
    """Table (README.md and table.csv) and pictures of all verdicts into a folder."""
    folder.mkdir(parents=True, exist_ok=True)
    rows = [row(verdict) for verdict in verdicts]
    table = folder / "table.csv"
    with writing(table), table.open("w", encoding="utf-8", newline="") as file:
        csv.writer(file, lineterminator="\n").writerows([HEAD, *rows])
    keys = list(dict.fromkeys(verdict.case.key for verdict in verdicts))
    text = ["# The hard cases", ""]
    text += [
        "Written by `python -m cable_model.lab hard -o docs/hard`;"
        " rules in `cable_model/lab/hard/rules.py`, scenes in `cable_model/scenes/hard/`.",
        "",
    ]
    for key in keys:
        own = [verdict for verdict in verdicts if verdict.case.key == key]
        text += [f"## {key}: {own[0].run.scene.title}", "", f"![{key}]({picture_name(key)})", ""]
        text += ["| " + " | ".join(HEAD[1:]) + " |", "|" + "---|" * (len(HEAD) - 1)]
        text += ["| " + " | ".join(line[1:]) + " |" for line in rows if line[0] == key]
        text += [
            "",
            *(f"- {'holds' if f.holds else 'FAILS'}: {f.words}: {f.value:.3g} (limit {f.limit:g})" for f in further.get(key, ())),
            "",
        ]
        draw(folder / picture_name(key), own)
        if own[0].case.check == "basin":
            basin.draw(folder / "basin_measured.png", {verdict.variant.label: verdict.run for verdict in own})
            text += ["![Basin chain, measured and computed](basin_measured.png)", ""]
    if "H15" in further:
        text += ["## H15: bad input", ""]
        text += [f"- {'refused' if f.holds else 'FAILS'}: {f.words}" for f in further["H15"]]
    (folder / "README.md").write_text("\n".join(text).replace("\n\n\n", "\n\n") + "\n", encoding="utf-8")


def picture_name(key: str) -> str:
    return key.replace(" ", "_").lower() + ".png"


def _widen(axis: Axes, least: float) -> None:
    """Let an axis span at least so much, m, both ways."""
    for limits, set_limits in ((axis.get_xlim(), axis.set_xlim), (axis.get_ylim(), axis.set_ylim)):
        low, high = limits
        if high - low < least:
            middle = 0.5 * (low + high)
            set_limits(middle - 0.5 * least, middle + 0.5 * least)


def draw(path: Path, verdicts: Sequence[Verdict]) -> None:
    """Top tension, the path that is compared, shapes and the energy excess of the first runs of a case."""
    path.parent.mkdir(parents=True, exist_ok=True)
    shown = [v for v in verdicts if len(v.run.times) > 2]
    judged = [v for v in shown if v.variant.judged]
    shown = (judged or shown)[:MOST_LINES]
    weightless = bool(shown) and shown[0].run.is_weightless
    figure, axes = plt.subplot_mosaic([["tension", "shape"], ["energy", "path"]], figsize=(9, 6))
    for verdict in shown:
        run = verdict.run
        thin = slice(None, None, max(1, len(run.times) // 2000))
        per = 1.0 if weightless else run.weight
        axes["tension"].plot(run.times[thin], run["top.tension"][thin] / per, linewidth=0.8, label=verdict.variant.label)
        axes["path"].plot(run.followed[thin, 0], run.followed[thin, 2], linewidth=0.6)
        if len(run.excess):
            axes["energy"].plot(run.times[thin], run.excess[thin] / (run.force_scale * run.scene.cable.length), linewidth=0.8)
    if shown:
        shapes = shown[0].run.shapes
        for shade, shape in zip(np.linspace(0.15, 1.0, len(shapes)), shapes, strict=True):
            axes["shape"].plot(shape[:, 0], shape[:, 2], color="tab:blue", alpha=shade, linewidth=0.8)
        axes["tension"].legend(fontsize=6)
        for name in ("path", "shape"):
            _widen(axes[name], AT_REST * shown[0].run.scene.cable.length)
    axes["tension"].set(xlabel="time [s]", ylabel="top tension [N]" if weightless else "top tension / W")
    force = "largest top tension" if weightless else "W"
    axes["energy"].set(xlabel="time [s]", ylabel=f"(energy - start - work) / {force} L")
    axes["path"].set(xlabel="x [m]", ylabel="z [m]", title=f"path of the {'middle' if shown and shown[0].run.held else 'lower end'}")
    axes["shape"].set(xlabel="x [m]", ylabel="z [m]", title="shapes of the first run")
    for axis in axes.values():
        axis.grid(alpha=0.3)
    figure.suptitle(verdicts[0].run.scene.title, fontsize=10)
    figure.tight_layout()
    figure.savefig(path, dpi=75)
    plt.close(figure)
