"""The command line: run, plot, describe, compare, check, bench, hard; the rest is in cli_studies and cli_docs."""

from __future__ import annotations

from enum import StrEnum
from pathlib import Path
from typing import Annotated

import numpy as np
import typer
from rich.console import Console
from rich.progress import Progress
from rich.table import Table

from cable_model import cli_docs, cli_studies
from cable_model.comparison import Difference, compare
from cable_model.errors import ParameterError, SolverError, unknown
from cable_model.model import Model
from cable_model.models import MODELS
from cable_model.motion import top_motion
from cable_model.scene import Scene, load, shipped
from cable_model.simulated import effects, unknowns_per_node
from cable_model.simulation import COLUMNS, Result, read_csv, simulate, write_csv

app = typer.Typer(add_completion=False, no_args_is_help=True, help="Underwater and hanging cables under a moving top end.")
console = Console()
SceneArgument = Annotated[
    str, typer.Argument(help="a scene file, or the name of a shipped scene: " + ", ".join(name for name in shipped() if "/" not in name))
]


class Choice(StrEnum):
    chain = "chain"
    tow = "tow"
    both = "both"


def run_with_progress(model: Model, csv: Path | None = None) -> Result:
    """Run a model's scene with a progress bar; rows go to `csv` as they come, so that a failed run keeps them."""
    scene = model.scene
    with Progress(console=console, transient=True) as bar:
        task = bar.add_task(f"{type(model).__name__}: {scene.title}", total=scene.run.duration)
        if csv is None:
            return simulate(model, progress=lambda t: bar.update(task, completed=t))
        csv.parent.mkdir(parents=True, exist_ok=True)
        with csv.open("w", encoding="utf-8") as file:
            file.write(",".join(COLUMNS) + "\n")

            def keep(row: np.ndarray) -> None:
                file.write(",".join(f"{x:.12g}" for x in row) + "\n")

            return simulate(model, progress=lambda t: bar.update(task, completed=t), keep=keep)


def _models(choice: Choice | None, scene: Scene) -> list[str]:
    if choice is Choice.both:
        return list(MODELS)
    return [choice.value if choice is not None else scene.run.model]


def summary(results: dict[str, Result]) -> Table:
    """What a person asks first: tensions, where the lower end went, and what it cost."""
    table = Table(title="Results")
    table.add_column("")
    rows = [
        ("top tension, mean (N)", lambda r: f"{r['top.tension'].mean():.5g}"),
        ("top tension, smallest .. largest (N)", lambda r: f"{r['top.tension'].min():.5g} .. {r['top.tension'].max():.5g}"),
        ("lower end x (m)", lambda r: f"{r['body.x'].min():.5g} .. {r['body.x'].max():.5g}"),
        ("lower end z (m)", lambda r: f"{r['body.z'].min():.5g} .. {r['body.z'].max():.5g}"),
        ("largest slack share of the length", lambda r: f"{r['cable.slack_fraction'].max():.3g}"),
        ("internal steps / Newton iterations / rejected", lambda r: " / ".join(f"{r[c][-1]:.0f}" for c in _COUNTERS)),
    ]
    for label in results:
        table.add_column(label, justify="right")
    for name, value in rows:
        table.add_row(name, *(value(r) for r in results.values()))
    return table


_COUNTERS = ("solver.steps", "solver.newton_iterations", "solver.rejected_steps")


@app.command()
def run(
    scene: SceneArgument,
    output: Annotated[Path | None, typer.Option("-o", "--output", help="CSV file (with --model both: the model's name is added)")] = None,
    model: Annotated[Choice | None, typer.Option(help="chain, tow or both; default: what the scene is meant for")] = None,
) -> None:
    """Simulate a scene, write its time series as CSV and print a short result table."""
    loaded = load(scene)
    results = {}
    for name in _models(model, loaded):
        target = output or Path("results") / f"{Path(scene).stem}.csv"
        if model is Choice.both or (output is None and name != loaded.run.model):
            target = target.with_stem(f"{target.stem}_{name}")
        results[name] = run_with_progress(MODELS[name](loaded), target)
        console.print(f"wrote {target}")
    console.print(summary(results))


@app.command()
def plot(
    scene: SceneArgument,
    output: Annotated[Path | None, typer.Option("-o", "--output", help="picture file")] = None,
    model: Annotated[Choice, typer.Option(help="chain, tow or both, drawn over each other")] = Choice.both,
) -> None:
    """Simulate a scene and draw tension, motion, path and shapes."""
    from cable_model.plots import picture

    loaded = load(scene)
    results = {name: run_with_progress(MODELS[name](loaded)) for name in _models(model, loaded)}
    target = output or Path("results") / f"{Path(scene).stem}.png"
    picture({type_name(name): r for name, r in results.items()}, loaded.title, target)
    console.print(f"wrote {target}")


def type_name(model: str) -> str:
    return MODELS[model].__name__


@app.command()
def describe(scene: SceneArgument, model: Annotated[Choice, typer.Option(help="chain, tow or both")] = Choice.both) -> None:
    """List which effects a scene switches on and why, and what is solved for."""
    loaded = load(scene)
    console.print(f"[bold]{loaded.title}[/bold]\n{loaded.source.strip()}\n")
    for name in _models(model, loaded):
        table = Table(title=type_name(name))
        for column in ("effect", "active", "because"):
            table.add_column(column)
        for effect in effects(loaded, name):
            table.add_row(effect.name, "yes" if effect.active else "-", effect.why, style="" if effect.active else "dim")
        console.print(table)
        if name == "chain":
            each = unknowns_per_node(loaded, name)
            console.print(f"{loaded.solver.nodes} nodes, {each} unknowns a node: {each * loaded.solver.nodes} unknowns\n")
        else:
            console.print(f"{unknowns_per_node(loaded, name)} degrees of freedom: swing and stretch of one straight cable\n")


def _print_differences(found: list[Difference]) -> None:
    table = Table(title="Comparison with the reference")
    for column in ("signal", "largest difference", "of its range", "at (s)", "allowed", ""):
        table.add_column(column, justify="left" if column in ("signal", "") else "right")
    for d in found:
        verdict = "[green]ok[/green]" if d.passed else "[bold red]DIFFERS[/bold red]"
        table.add_row(d.signal, f"{d.largest:.3g}", f"{d.share_of_range:.2e}", f"{d.time:.4g}", f"{d.allowed:.3g}", verdict)
    console.print(table)
    failed = [d.signal for d in found if not d.passed]
    if failed:
        console.print(f"{len(failed)} of {len(found)} signals differ: {', '.join(failed)}")
        raise typer.Exit(1)
    console.print(f"all {len(found)} signals agree")


RelativeTolerance = Annotated[float, typer.Option(help="allowed difference as a share of the signal's range")]
AbsoluteTolerance = Annotated[float, typer.Option(help="allowed difference in the signal's unit, added")]


@app.command("compare")
def compare_files(
    a: Annotated[Path, typer.Argument(help="CSV of a run")],
    b: Annotated[Path, typer.Argument(help="CSV of the reference")],
    rtol: RelativeTolerance = 1e-6,
    atol: AbsoluteTolerance = 1e-9,
) -> None:
    """Compare two CSV files signal by signal; exit status 1 when they differ."""
    for path in (a, b):
        if not path.is_file():
            raise ParameterError(f"{path}: no such file. Write it with `python -m cable_model run`.")
    columns, table = read_csv(a)
    reference_columns, reference = read_csv(b)
    _print_differences(compare(columns, table, reference_columns, reference, rtol, atol))


@app.command()
def check(
    fmu: Annotated[Path, typer.Argument(help="a built FMU")],
    reference: Annotated[Path, typer.Option(help="CSV to compare with, or to write with --write")],
    scene: Annotated[str | None, typer.Option(help="take the top's motion from this scene, not from the reference's inputs")] = None,
    write: Annotated[bool, typer.Option("--write", help="write the FMU's results as the new reference")] = False,
    rtol: RelativeTolerance = 1e-6,
    atol: AbsoluteTolerance = 1e-9,
) -> None:
    """Simulate an FMU through fmpy and compare it with a reference; exit status 1 when they differ."""
    from cable_model.fmu_check import sampled_motion, simulate_fmu
    from cable_model.signals import INPUTS

    if not fmu.is_file():
        raise ParameterError(f"{fmu}: no such file. Build it with `python build_fmu.py`.")
    if scene is not None:
        loaded = load(scene)
        times, inputs = sampled_motion(top_motion(loaded.top, loaded.winch), loaded.run.duration, loaded.run.output_step)
    elif reference.is_file():
        columns, table = read_csv(reference)
        times = table[:, columns.index("time")]
        inputs = table[:, [columns.index(name) for name in INPUTS]]
    else:
        raise ParameterError(f"{reference}: no such file. Give --scene to simulate, and --write to make this reference.")
    result_columns, result = simulate_fmu(fmu, times, inputs)
    if write:
        reference.parent.mkdir(parents=True, exist_ok=True)
        write_csv(reference, result_columns, result)
        console.print(f"wrote {reference}")
        return
    if not reference.is_file():
        raise ParameterError(f"{reference}: no such file. Make it with --write.")
    _print_differences(compare(result_columns, result, *read_csv(reference), rtol, atol))


@app.command()
def bench(
    repetitions: Annotated[int, typer.Option(help="repetitions; medians are shown")] = 7,
    output: Annotated[Path | None, typer.Option("-o", "--output", help="write the table as Markdown too")] = None,
    case: Annotated[list[str] | None, typer.Option(help="rows by their names, the first one is the measure; default: all")] = None,
    absent: Annotated[bool, typer.Option("--absent", help="time kernels without the code of absent effects beside")] = False,
) -> None:
    """Measure what each effect costs on this machine, switched on alone."""
    from cable_model.benchmark import CASES, markdown, measure

    for name in case or []:
        if name not in CASES:
            raise unknown(name, CASES, "case")

    table = Table(title="Cost of the chain's kernels, forced chain of 101 nodes")
    for column in ("effects", "us per node and step", "iterations per step", "ratio to the bare chain"):
        table.add_column(column, justify="left" if column == "effects" else "right")
    costs = measure(case, repetitions)
    for cost in costs:
        table.add_row(cost.name, f"{cost.microseconds:.3f}", f"{cost.iterations:.2f}", f"{cost.ratio:.2f}")
    console.print(table)
    proof = ""
    if absent:
        from cable_model.limits import absent as without

        proof = without.sentence(without.measure(told=console.print))
        console.print(proof)
    if output is not None:
        output.parent.mkdir(parents=True, exist_ok=True)
        output.write_text(markdown(costs, proof), encoding="utf-8")
        console.print(f"wrote {output}")


@app.command()
def hard(
    case: Annotated[list[str] | None, typer.Option(help="cases to run, such as H1; default: all")] = None,
    output: Annotated[Path, typer.Option("-o", "--output", help="folder for the table and the pictures")] = Path("results/hard"),
    jobs: Annotated[int, typer.Option(help="processes")] = 2,
) -> None:
    """Run the hard cases, judge each by the five rules, and write table and pictures; exit status 1 when one fails."""
    from cable_model.hard import report, runner
    from cable_model.hard.bad_input import bad_input

    cases = runner.chosen(case or [])
    if not cases and case != ["H15"]:
        raise unknown(", ".join(case or []), [known.key for known in runner.CASES], "case")
    order = {(chosen.key, variant.label): k for k, (chosen, variant) in enumerate((c, v) for c in cases for v in c.variants)}
    verdicts: list[runner.Verdict] = []
    table = Table(title="Hard cases")
    for column in report.HEAD:
        table.add_column(column)
    with Progress(console=console, transient=True) as bar:
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
            console.print(f"{key}: {'holds' if f.holds else 'FAILS'}: {f.words}: {f.value:.3g} (limit {f.limit:g})")
    if not case or "H15" in case:
        further["H15"] = bad_input()
        console.print(f"H15: {sum(f.holds for f in further['H15'])} of {len(further['H15'])} bad inputs give one clear error")
    report.write(output, verdicts, further)
    console.print(f"wrote {output / 'README.md'}, table.csv and pictures")
    failed = [v for v in verdicts if v.variant.judged and not v.passed]
    if failed or any(not f.holds for findings in further.values() for f in findings):
        raise typer.Exit(1)


STUDIES = (
    cli_studies.study, cli_studies.advise, cli_studies.sweep, cli_studies.published, cli_studies.peers, cli_studies.targets,
    cli_studies.limits, cli_docs.docs,
)  # fmt: skip
for command in STUDIES:
    app.command()(command)
app.command("advise-trial")(cli_studies.advise_trial)


def main() -> None:
    """Run the command line; the package's own errors end it with one clear line and exit status 2."""
    try:
        app()
    except (ParameterError, SolverError) as error:
        console.print(f"[bold red]error:[/bold red] {error}", highlight=False, markup=True, soft_wrap=True)
        raise SystemExit(2) from error
