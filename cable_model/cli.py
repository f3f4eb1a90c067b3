"""The command line: run, plot, view, describe, compare, check; cli_studies has study, advise and sweep, cli_import import, cli_new new."""

from __future__ import annotations

import contextlib
from enum import StrEnum
from pathlib import Path
from typing import Annotated

import numpy as np
import typer
from rich.table import Table
from rich.text import Text

from cable_model import __version__, cli_import, cli_new, cli_studies
from cable_model.cli_console import check_output, console, fail, load_scene, progress, say, warn, words_of
from cable_model.comparison import Difference, compare, remarks
from cable_model.errors import ParameterError, SolverError
from cable_model.kernel_cache import mended
from cable_model.model import Model
from cable_model.models import MODELS
from cable_model.motion import MotionLike, motion_of
from cable_model.result_files import check_profiles, check_results, is_netcdf, write_netcdf, write_profiles
from cable_model.scene import Scene, shipped, with_values
from cable_model.simulated import effects, left_out_for, refused_by, refused_for_good, unknowns_per_node
from cable_model.simulation import CsvRows, Result, RunStopped, read_csv, simulate, write_csv

app = typer.Typer(no_args_is_help=True, rich_markup_mode=None)
SceneArgument = Annotated[
    str,
    typer.Argument(
        help=f"a scene file, or the name of a shipped scene: {', '.join(name for name in shipped() if '/' not in name)}; "
        "`cable-fmu new` lists all"
    ),
]


def _version(asked: bool) -> None:
    if asked:
        say(f"cable-fmu {__version__}")
        raise typer.Exit


@app.callback()
def _main(
    version: Annotated[bool, typer.Option("--version", callback=_version, is_eager=True, help="show the version and leave")] = False,
) -> None:
    """Underwater and hanging cables under a moving top end."""


class Choice(StrEnum):
    chain = "chain"
    tow = "tow"
    both = "both"


def run_with_progress(model: Model, csv: Path | None = None) -> Result:
    """Run a model's scene with a progress bar; rows go to `csv` as they come, so that a failed run keeps them."""
    scene = model.scene
    with progress() as bar, CsvRows(csv) if csv is not None else contextlib.nullcontext() as keep:
        task = bar.add_task(f"{type(model).__name__}: {scene.title}", total=scene.run.duration)
        try:
            result = simulate(model, progress=lambda t: bar.update(task, completed=t), keep=keep)
        except RunStopped as stopped:
            warn(stopped.result.warnings)
            raise
        warn(result.warnings)
    return result


def _models(choice: Choice | None, scene: Scene) -> list[str]:
    if choice is Choice.both:
        return list(MODELS)
    return [choice.value if choice is not None else scene.run.model]


def _models_with_scenes(choice: Choice | None, scene: Scene) -> dict[str, Scene]:
    """The scene for each model; of both, one goes without what it lacks if that can be left out, or is left out itself, and it is said."""
    if choice is not Choice.both:
        return dict.fromkeys(_models(choice, scene), scene)
    found = {}
    for name in MODELS:
        refused = next(refused_for_good(scene, name), None)
        if refused is not None:
            say(f"{type_name(name)} is left out: {refused}")
            continue
        words, changes = left_out_for(scene, name)
        lean = with_values(scene, changes) if changes else scene
        if words:
            say(f"{type_name(name)} goes without {', '.join(words)}")
        found[name] = lean
    if not found:
        raise ParameterError("neither model has all that the scene asks for. Remove what each was left out for.")
    return found


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
    if any(r.audit is not None for r in results.values()):
        rows.append(("audit: largest energy missing (J), of that exchanged", _energy))
        rows.append(("audit: force missing, rms (N), of those acting", _force))
    for label in results:
        table.add_column(label, justify="right")
    for name, value in rows:
        table.add_row(name, *(value(r) for r in results.values()))
    return table


def _energy(result: Result) -> str:
    if result.audit is None:
        return "-"
    missing = float(np.abs(result["audit.energy"]).max())
    return f"{missing:.2g}, {per_cent(missing / result.audit.exchanged)}"


def _force(result: Result) -> str:
    return "-" if result.audit is None else f"{result.audit.momentum:.2g}, {per_cent(result.audit.momentum_share)}"


_COUNTERS = ("solver.steps", "solver.newton_iterations", "solver.rejected_steps")


@app.command()
def run(
    scene: SceneArgument,
    output: Annotated[
        Path | None, typer.Option("-o", "--output", help="CSV file, or .nc: netCDF (with --model both: the model's name is added)")
    ] = None,
    model: Annotated[Choice | None, typer.Option(help="chain, tow or both; default: what the scene is meant for")] = None,
    profiles: Annotated[Path | None, typer.Option(help="also a CSV of places, tensions and curvature along the cable")] = None,
) -> None:
    """Simulate a scene, write its time series as CSV, or with profiles as netCDF, and print a short result table."""
    check_output(output)
    check_output(profiles)
    loaded = load_scene(scene)
    file = output or Path("results") / f"{Path(scene).stem}.csv"
    check_results(file)
    runs = {}
    for name, its in _models_with_scenes(model, loaded).items():
        both = model is Choice.both
        target = _named(file, name) if both or (output is None and name != loaded.run.model) else file
        along = _named(profiles, name) if both and profiles is not None else profiles
        if along is not None:
            check_profiles(along, target)
        runs[name] = its, target, along
    results = {}
    for name, (its, target, along) in runs.items():
        try:
            results[name] = run_with_progress(MODELS[name](its), None if is_netcdf(target) else target)
        except RunStopped as stopped:
            _write(stopped.result, target, along)
            raise
        _write(results[name], target, along)
        say(f"wrote {target}" if along is None else f"wrote {target} and {along}")
    console.print(summary(results))


def _named(path: Path, model: str) -> Path:
    """The path with the model's name in it: it serves several."""
    return path.with_stem(f"{path.stem}_{model}")


def _write(result: Result, target: Path, profiles: Path | None) -> None:
    """What is written when a run has ended: a CSV of its series has come with it."""
    if is_netcdf(target):
        write_netcdf(target, result)
    if profiles is not None:
        write_profiles(profiles, result)


@app.command()
def plot(
    scene: SceneArgument,
    output: Annotated[Path | None, typer.Option("-o", "--output", help="picture file")] = None,
    model: Annotated[Choice, typer.Option(help="chain, tow or both, drawn over each other")] = Choice.both,
) -> None:
    """Simulate a scene and draw tension, motion, path and shapes."""
    from cable_model.plots import check_kind, picture

    loaded = load_scene(scene)
    target = output or Path("results") / f"{Path(scene).stem}.png"
    check_kind(target)  # before minutes are spent
    results = {name: run_with_progress(MODELS[name](its)) for name, its in _models_with_scenes(model, loaded).items()}
    picture({type_name(name): r for name, r in results.items()}, loaded, loaded.title, target)
    say(f"wrote {target}")


@app.command()
def view(
    scene: SceneArgument,
    output: Annotated[Path | None, typer.Option("-o", "--output", help="page (.html)")] = None,
    model: Annotated[Choice, typer.Option(help="chain, tow or both, in one picture")] = Choice.both,
    movie: Annotated[Path | None, typer.Option(help="also a moving picture, .gif or .mp4")] = None,
) -> None:
    """Simulate a scene and write a page on which the cable can be watched."""
    from cable_model.movie import check_movie, write_movie
    from cable_model.page import check_page, write_page

    if Path(scene).suffix.lower() == ".csv":
        raise ParameterError(f"{scene}: a table of results has no shapes of the cable. Give the scene that it is of.")
    loaded = load_scene(scene)
    target = output or Path("results") / f"{Path(scene).stem}.html"
    check_page(target)  # before minutes are spent
    if movie is not None:
        check_movie(movie)
    results: dict[str, Result] = {}
    stopped: list[RunStopped] = []
    for name, its in _models_with_scenes(model, loaded).items():
        try:
            results[type_name(name)] = run_with_progress(MODELS[name](its))
        except RunStopped as stop:
            results[type_name(name)] = stop.result
            stopped.append(stop)
    write_page(results, loaded, target, [str(stop) for stop in stopped])
    say(f"wrote {target}")
    if movie is not None:
        write_movie(results, loaded, movie)
        say(f"wrote {movie}")
    if stopped:
        for other in stopped[1:]:
            say(str(other))
        raise stopped[0]


def type_name(model: str) -> str:
    return MODELS[model].__name__


@app.command()
def describe(scene: SceneArgument, model: Annotated[Choice, typer.Option(help="chain, tow or both")] = Choice.both) -> None:
    """List which effects a scene switches on and why, and what is solved for."""
    loaded = load_scene(scene)
    say(loaded.title, "bold")
    say(f"{loaded.source.strip()}\n")
    for name in _models(model, loaded):
        table = Table(title=type_name(name))
        for column in ("effect", "active", "because"):
            table.add_column(column)
        for effect in effects(loaded, name):
            table.add_row(effect.name, "yes" if effect.active else "-", effect.why, style="" if effect.active else "dim")
        console.print(table)
        refused = [str(error) for error in refused_by(loaded, name)]
        if refused:
            say("\n".join([f"{type_name(name)} refuses the scene:", *refused]) + "\n")
        elif name == "chain":
            each = unknowns_per_node(loaded, name)
            say(f"{loaded.solver.nodes} nodes, {each} unknowns a node: {each * loaded.solver.nodes} unknowns\n")
        else:
            say(f"{unknowns_per_node(loaded, name)} degrees of freedom: swing and stretch of one straight cable\n")


def per_cent(share: float) -> str:
    return f"{100.0 * share:.3g} %"


def _print_differences(found: list[Difference]) -> bool:
    """The table and its verdict; whether all agree."""
    table = Table(title="Comparison with the reference")
    for column in ("signal", "largest difference", "of its range", "at (s)", "allowed", ""):
        table.add_column(column, justify="left" if column in ("signal", "") else "right", no_wrap=column == "signal")
    for d in found:
        share = "-" if d.largest > 0.0 and d.share_of_range == 0.0 else per_cent(d.share_of_range)  # - where the reference is always 0
        verdict = Text("ok", "green") if d.passed else Text("DIFFERS", "bold red")
        table.add_row(d.signal, f"{d.largest:.3g}", share, f"{d.time:.4g}", f"{d.allowed:.3g}", verdict)
    console.print(table)
    failed = [d for d in found if not d.passed]
    if failed:
        worst = max(failed, key=lambda d: d.share_of_range)
        say(f"{len(failed)} of {len(found)} signals differ: {', '.join(d.signal for d in failed)}")
        say(f"the most: {worst.signal} by {per_cent(worst.share_of_range)} of its range, at {worst.time:.4g} s")
    else:
        say(f"all {len(found)} signals agree")
    return not failed


FINER = 8  # communication steps in one, against which the holding of inputs is measured
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
    tables = (*read_csv(a), *read_csv(b))
    found = compare(*tables, rtol, atol)
    for remark in remarks(*tables):
        say(remark)
    if not _print_differences(found):
        raise typer.Exit(1)


@app.command()
def check(
    fmu: Annotated[Path, typer.Argument(help="a built FMU")],
    reference: Annotated[Path, typer.Option(help="CSV to compare with, or to write with --write")],
    scene: Annotated[str | None, typer.Option(help="take the top's motion from this scene, not from the reference's inputs")] = None,
    write: Annotated[bool, typer.Option("--write", help="write the FMU's results as the new reference")] = False,
    rtol: RelativeTolerance = 1e-6,
    atol: AbsoluteTolerance = 1e-9,
) -> None:
    """Simulate an FMU through fmpy and compare it with a reference; exit status 1 when they differ.

    An FMU knows its inputs at the starts of its communication steps only. Against a run with prescribed motion, the check says what that
    costs: it simulates the FMU again with shorter steps.
    """
    from cable_model.fmu_check import coarsened, divided, recorded_motion, rows_of_inputs, sampled_motion, simulate_fmu

    motion: MotionLike
    check_output(reference)
    if not reference.is_file() and not (scene is not None and write):
        raise ParameterError(f"{reference}: no such file. Give --scene and --write to make this reference.")
    if scene is not None:
        loaded = load_scene(scene)
        motion = motion_of(loaded)
        times, inputs = sampled_motion(motion, loaded.run.duration, loaded.run.output_step)
    else:
        times, inputs = rows_of_inputs(reference, *read_csv(reference))
        motion = recorded_motion(times, inputs)
    if write:
        columns, result = simulate_fmu(fmu, times, inputs, told=say)
        reference.parent.mkdir(parents=True, exist_ok=True)
        write_csv(reference, columns, result)
        say(f"wrote {reference}")
        return
    expected = read_csv(reference)
    columns, result = simulate_fmu(fmu, times, inputs, told=say)
    found = compare(columns, result, *expected, rtol, atol)
    for remark in remarks(columns, result, *expected):
        say(remark)
    if not _print_differences(found):
        finer = coarsened(simulate_fmu(fmu, *divided(times, inputs, motion, FINER))[1], FINER)
        held, left = compare(columns, result, columns, finer, rtol, atol), compare(columns, finer, *expected, rtol, atol)
        say(holding(found, held, left))
        raise typer.Exit(1)


def holding(found: list[Difference], held: list[Difference], left: list[Difference]) -> str:
    """What holding the inputs costs, and whether that is the difference; with steps FINER times shorter `left` remains."""
    before, cost, after = (max(group, key=lambda d: d.share_of_range) for group in (found, held, left))
    costs = f"{per_cent(cost.share_of_range)} of the range of {cost.signal}"
    words = f"Holding the inputs over communication steps costs up to {costs}; with steps {FINER} times shorter the FMU differs "
    words += f"from the reference by {per_cent(after.share_of_range)} ({after.signal}) instead of {per_cent(before.share_of_range)}: "
    if after.share_of_range < 0.5 * before.share_of_range:
        words += "most of the difference is the holding's, not the FMU's. "
        return words + "Take a reference that an FMU wrote (--write), or a larger --rtol."
    return words + "holding does not explain the difference."


for command in (cli_studies.study, cli_studies.advise, cli_studies.sweep):
    app.command()(command)
app.command("import")(cli_import.import_deck)
app.command()(cli_new.new)


def guarded(commands: typer.Typer) -> None:
    """Run a command line; the package's own errors end it with one clear line and exit status 2."""
    try:
        with mended():
            commands()
    except (ParameterError, SolverError) as error:
        fail(str(error))
    except OSError as error:
        fail(words_of(error))


def main() -> None:
    """Run the command line."""
    guarded(app)
