"""The command line of accuracy and cost: study, advise, sweep."""

from __future__ import annotations

import os
from enum import StrEnum
from pathlib import Path
from typing import Annotated

import typer
from rich.table import Table

from cable_model.cli_console import check_output, console, load_scene, progress, save, say
from cable_model.errors import ParameterError, refuse
from cable_model.scene import to_toml
from cable_model.studies.timed import SIGNALS, worst

FACTORS = (3.0, 10.0)  # of further accuracy, whose prices are told


class Of(StrEnum):
    tension = "tension"
    position = "position"
    both = "both"

    @property
    def signals(self) -> tuple[str, ...]:
        return SIGNALS if self is Of.both else (self.value,)


def fraction(text: str) -> float:
    """An accuracy such as "1%" or "0.003" as a number between 0 and 1."""
    try:
        value = float(text.strip().removesuffix("%")) / (100.0 if text.strip().endswith("%") else 1.0)
    except ValueError:
        value = -1.0
    if not 0.0 < value < 1.0:
        raise refuse("accuracy", text, "", "between 0 and 100 %", "Give one such as 1% or 0.003.")
    return value


def study(
    scene: Annotated[str, typer.Argument(help="a scene file, or the name of a shipped scene")],
    output: Annotated[Path, typer.Option("-o", "--output", help="folder for the CSV and the picture")] = Path("results/study"),
    quick: Annotated[bool, typer.Option("--quick", help="few settings, a coarser reference")] = False,
) -> None:
    """Measure what accuracy costs on a scene: error against processor time of every method, as CSV and picture."""
    from cable_model.studies import work_precision

    check_output(output, folder=True)
    loaded = load_scene(scene)
    with progress() as bar:
        task = bar.add_task("reference", total=1.0)
        reference, points = work_precision.study(loaded, quick, lambda text, done: bar.update(task, description=text, completed=done))
    name = Path(scene).name.removesuffix(".toml")
    rows, picture = output / f"{name}.csv", output / f"{name}.png"
    work_precision.write_csv(rows, loaded, reference, points)
    work_precision.picture(picture, loaded, reference, points)
    if not reference.converged:
        say("The reference did not converge: the errors below are against a run that may be wrong itself.", "bold red")
    for signal in SIGNALS:
        table = Table(title=f"Cheapest ways to an error of the {signal} (reference's own: {reference.own_error[signal]:.1e})")
        for column in ("error", "CPU s per simulated s", "method", "setting"):
            table.add_column(column, justify="left" if column in ("method", "setting") else "right")
        for p in work_precision.front(points, signal):
            table.add_row(f"{p.errors[signal]:.1e}", f"{p.cost:.2e}", p.setting.method, p.setting.label)
        console.print(table)
    say(f"wrote {rows} and {picture}")


def advise(
    scene: Annotated[str, typer.Argument(help="a scene file, or the name of a shipped scene")],
    accuracy: Annotated[str, typer.Option(help="wanted error over the dynamic rms, such as 1%")] = "1%",
    of: Annotated[Of, typer.Option(help="of the top's tension, of the lower end's position, or of both")] = Of.both,
    output: Annotated[Path | None, typer.Option("-o", "--output", help="write the scene with the choice in place")] = None,
) -> None:
    """Find the cheapest model, effects, nodes and step that meet an accuracy, by measured refinement."""
    from cable_model.studies import advice as found
    from cable_model.studies.price import price

    check_output(output)
    wanted = fraction(accuracy)
    loaded = load_scene(scene)
    with progress() as bar:
        task = bar.add_task("reference", total=None)
        advice = found.advise(loaded, wanted, of.signals, lambda text: bar.update(task, description=text))
    if not advice.reference.converged:
        if advice.reference.run.error:
            raise ParameterError(f"{scene}: no advice: the finest run stopped: {advice.reference.run.error}")
        changes = ", ".join(f"{name} {value:.2g}" for name, value in advice.reference.own_error.items())
        raise ParameterError(
            f"{scene}: no advice: the finest runs still differ ({changes}). Motion is chaotic, or the scene's own nodes and step are far "
            "too coarse: shorten run.duration, or refine solver.nodes and solver.time_step."
        )
    for check in advice.checks:
        say(f"straight cable: {'yes' if check.holds else 'no'}  {check.words}", "green" if check.holds else "red")
    straight = [worst(p.errors, of.signals) for p in advice.points if p.setting.model == "tow"]
    if straight:
        say(f"straight cable: its measured error is {min(straight):.1e}, and that decides")
    for name, error in advice.left_out.items():
        say(f"left out: {name} (changes the answer by {error:.1e})")
    for name, error in advice.kept.items():
        say(f"kept: {name} (without it the error is {error:.1e})")
    sure = ", ".join(f"{name} {value:.1e}" for name, value in advice.reference.own_error.items())
    if advice.choice is None:
        raise ParameterError(
            f"{scene}: none of {len(advice.points)} settings reaches {accuracy}. Refine the scene's solver.nodes and time_step."
        )
    choice = advice.choice
    shown = ", ".join(f"{name} {value:.1e}" for name, value in choice.errors.items())
    say(f"{choice.setting.method}: {choice.setting.label}: {choice.cost:.2g} CPU s per simulated s", "bold")
    say(f"measured error: {shown}; against a reference that is itself sure to: {sure}; {len(advice.points)} settings tried")
    for factor in FACTORS:
        priced = price(advice, loaded, factor)
        if priced is not None:
            say(priced.words)
    if output is not None:
        save(output, to_toml(advice.scene))


def sweep(
    file: Annotated[Path, typer.Argument(help="a TOML file with `scene` and lists of values in [vary]")],
    output: Annotated[Path, typer.Option("-o", "--output", help="folder for the results; runs that are there are not repeated")] = Path(
        "results/sweep"
    ),
    workers: Annotated[int, typer.Option(help="processes (0: as many as there are cores)")] = 0,
    scheduler: Annotated[str | None, typer.Option(help="address of a dask.distributed scheduler, instead of this machine")] = None,
) -> None:
    """Run a scene at every combination of values; resumes where it stopped."""
    from cable_model.studies import sweep as sweeping

    check_output(output, folder=True)
    wanted = sweeping.jobs(*sweeping.read(file))
    count = workers or os.cpu_count() or 1
    for path in sweeping.damaged(wanted, output):
        say(f"{path}: damaged; its run is done again")
    try:
        with progress() as bar:
            task = bar.add_task(f"{len(wanted)} runs", total=len(wanted))
            summaries = sweeping.run(wanted, output, count, lambda done: bar.update(task, completed=done), scheduler)
    except KeyboardInterrupt:
        left = len(sweeping.missing(wanted, output))
        say(f"interrupted: {len(wanted) - left} of {len(wanted)} runs are in {output}; the same command does the rest")
        raise typer.Exit(130) from None
    sweeping.write_table(output / "table.csv", summaries)
    failed = [summary for summary in summaries if summary["error"]]
    say(f"{len(summaries)} runs, {len(failed)} of them stopped early; wrote {output / 'table.csv'} and the series beside it")
    for summary in failed:
        say(f"stopped: {summary['key']}: {summary['error']}")
