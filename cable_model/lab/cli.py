"""The laboratory's command line: bench, hard, advise-trial, published, peers, targets, limits, docs."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Annotated

import typer
from rich.progress import Progress, TaskID
from rich.table import Table

from cable_model import cli
from cable_model.cli_console import check_output, console, progress, save, say
from cable_model.errors import unknown

app = typer.Typer(add_completion=False, no_args_is_help=True, rich_markup_mode=None, help="What measures and judges the models.")


def _teller(bar: Progress, task: TaskID, before: str = "") -> Callable[[str], None]:
    """Shows what is being done beside the bar."""

    def told(text: str) -> None:
        bar.update(task, description=before + text)

    return told


@app.command()
def bench(
    repetitions: Annotated[int, typer.Option(help="repetitions; medians are shown")] = 7,
    output: Annotated[Path | None, typer.Option("-o", "--output", help="write the table as Markdown too")] = None,
    case: Annotated[list[str] | None, typer.Option(help="rows by their names, the first one is the measure; default: all")] = None,
    absent: Annotated[bool, typer.Option("--absent", help="time kernels without the code of absent effects beside")] = False,
) -> None:
    """Measure what each effect costs on this machine, switched on alone; beside it the object code of `cable-fmu prepare`."""
    from cable_model.lab.bench import CASES, markdown, measure, ratio

    check_output(output)
    for name in case or []:
        if name not in CASES:
            raise unknown(name, CASES, "case")

    table = Table(title="Cost of the chain's kernels, forced chain of 101 nodes")
    for column in ("effects", "us per node and step", "iterations per step", "ratio to the bare chain", "object code for every scene"):
        table.add_column(column, justify="left" if column == "effects" else "right")
    costs = measure(case, repetitions)
    for cost in costs:
        table.add_row(cost.name, f"{cost.microseconds:.3f}", f"{cost.iterations:.2f}", f"{cost.ratio:.2f}", ratio(cost.every))
    console.print(table)
    proof = ""
    if absent:
        from cable_model.lab.limits import absent as without

        proof = without.sentence(without.measure(told=say))
        say(proof)
    if output is not None:
        save(output, markdown(costs, proof))


@app.command()
def hard(
    case: Annotated[list[str] | None, typer.Option(help="cases to run, such as H1; default: all")] = None,
    output: Annotated[Path, typer.Option("-o", "--output", help="folder for the table and the pictures")] = Path("results/hard"),
    jobs: Annotated[int, typer.Option(help="processes")] = 2,
) -> None:
    """Run the hard cases, judge each by the five rules, and write table and pictures; exit status 1 when one fails."""
    from cable_model.lab.hard import report, runner
    from cable_model.lab.hard.bad_input import bad_input

    check_output(output, folder=True)
    cases = runner.chosen(case or [])
    if not cases and case != ["H15"]:
        raise unknown(", ".join(case or []), [known.key for known in runner.CASES], "case")
    order = {(chosen.key, variant.label): k for k, (chosen, variant) in enumerate((c, v) for c in cases for v in c.variants)}
    verdicts: list[runner.Verdict] = []
    table = Table(title="Hard cases")
    for column in report.HEAD:
        table.add_column(column)
    with progress() as bar:
        task = bar.add_task("hard cases", total=len(order))
        for verdict in runner.run_all(cases, jobs):
            verdicts.append(verdict)
            done = [v for v in verdicts if v.case.key == verdict.case.key]
            if len(done) == len(verdict.case.variants):  # kept, whatever comes after
                done.sort(key=lambda v: order[v.case.key, v.variant.label])
                report.draw(output / report.picture_name(verdict.case.key), done)
            bar.update(task, advance=1, description=f"{verdict.case.key} {verdict.variant.label}")
    verdicts.sort(key=lambda v: order[v.case.key, v.variant.label])
    further = {c.key: runner.further(c, [v for v in verdicts if v.case is c or v.case.key == c.key]) for c in cases}
    for verdict in verdicts:
        table.add_row(*report.row(verdict))
    console.print(table)
    for key, findings in further.items():
        for f in findings:
            say(f"{key}: {'holds' if f.holds else 'FAILS'}: {f.words}: {f.value:.3g} (limit {f.limit:g})")
    if not case or "H15" in case:
        further["H15"] = bad_input()
        say(f"H15: {sum(f.holds for f in further['H15'])} of {len(further['H15'])} bad inputs give one clear error")
    report.write(output, verdicts, further)
    say(f"wrote {output / 'README.md'}, table.csv and pictures")
    failed = [v for v in verdicts if v.variant.judged and not v.passed]
    if failed or any(not f.holds for findings in further.values() for f in findings):
        raise typer.Exit(1)


@app.command("advise-trial")
def advise_trial(
    scene: Annotated[list[str] | None, typer.Option(help="scenes of the trial by their names; default: all")] = None,
    output: Annotated[Path | None, typer.Option("-o", "--output", help="write the table as Markdown")] = None,
    quick: Annotated[bool, typer.Option("--quick", help="few settings of the study")] = False,
) -> None:
    """Try the adviser on ten scenes that it was not made with: accuracy against a finer run, cost against the full study."""
    from cable_model.lab import advice_scenes, advice_trial

    check_output(output)
    names = scene or list(advice_scenes.SCENES)
    for name in names:
        if name not in advice_scenes.SCENES:
            raise unknown(name, advice_scenes.SCENES, "scene of the trial")
    rows = []
    with progress() as bar:
        task = bar.add_task("trial", total=len(names))
        for name in names:
            rows.append(advice_trial.trial(name, advice_scenes.scene(name), _teller(bar, task, f"{name}: "), quick))
            bar.update(task, advance=1)
            say(" | ".join(advice_trial.cells(rows[-1])))
    if output is not None:
        save(output, advice_trial.markdown(rows))
    if not all(row.accurate and row.cheap for row in rows):
        raise typer.Exit(1)


@app.command()
def published(
    only: Annotated[list[str] | None, typer.Option(help="studies by their names; default: all")] = None,
    output: Annotated[Path, typer.Option("-o", "--output", help="folder for pictures, tables and README.md")] = Path("results/published"),
    quick: Annotated[bool, typer.Option("--quick", help="few and short runs")] = False,
) -> None:
    """Compute the published figures and tables anew, and where the shortcuts hold; pictures, tables and an index."""
    from cable_model.lab.published import catalogue

    check_output(output, folder=True)
    with progress() as bar:
        task = bar.add_task("published", total=1.0)
        written = catalogue.write_all(output, only or (), quick, lambda text, done: bar.update(task, description=text, completed=done))
    for path in written:
        say(f"wrote {path} and {path.with_suffix('.csv').name}")
    say(f"wrote {output / 'README.md'}")


@app.command()
def peers(
    case: Annotated[list[str] | None, typer.Option(help="cases by their names; default: all")] = None,
    output: Annotated[Path | None, typer.Option("-o", "--output", help="write the table as Markdown")] = None,
    quick: Annotated[bool, typer.Option("--quick", help="one accuracy, and few segments of the other codes")] = False,
) -> None:
    """Compare cost at equal accuracy with MoorDyn and CableDyn (extra "peers")."""
    from cable_model.lab.peers import compare as comparing

    check_output(output)
    for name in case or []:
        if name not in comparing.CASES:
            raise unknown(name, comparing.CASES, "case")
    accuracies, segments = comparing.ACCURACIES[: 1 if quick else None], comparing.SEGMENTS[: 2 if quick else None]
    rows = []
    with progress() as bar:
        task = bar.add_task("peers", total=None)
        for name in case or comparing.CASES:
            rows += comparing.compare(name, accuracies, segments, _teller(bar, task, f"{name}: "))
            if output is not None:  # every case that is done is kept
                save(output, comparing.markdown(rows))
    say(comparing.markdown(rows))


@app.command()
def targets(
    output: Annotated[Path, typer.Option("-o", "--output", help="the table to write, Markdown")] = Path("results/targets.md"),
    quick: Annotated[bool, typer.Option("--quick", help="the free chain only")] = False,
) -> None:
    """Measure what the chain reaches in the cases of four other codes, at costs set beside theirs (extra "peers")."""
    from cable_model.lab.peers import targets as sought

    check_output(output)
    with progress() as bar:
        task = bar.add_task("targets", total=None)
        text = sought.markdown(sought.measure(quick, _teller(bar, task)))
    say(text)
    save(output, text)


@app.command()
def limits(
    output: Annotated[Path, typer.Option("-o", "--output", help="the note to write, Markdown")] = Path("results/limits.md"),
    quick: Annotated[bool, typer.Option("--quick", help="the bare chain only")] = False,
) -> None:
    """Count the kernels' operations, time them, and set both beside what the machine can do."""
    from cable_model.lab.limits import report

    check_output(output)
    with progress() as bar:
        task = bar.add_task("limits", total=None)
        text = report.markdown(report.measure(quick, _teller(bar, task)))
    say(text)
    save(output, text)


def main() -> None:
    """Run the laboratory's command line."""
    cli.guarded(app)
