"""The command that writes every generated figure and table of docs/ again, by the commands that write each."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from importlib.util import find_spec
from pathlib import Path
from typing import Annotated

import typer

from cable_model import cli_studies
from cable_model.cli import Choice, plot
from cable_model.cli_console import console, say
from cable_model.errors import ParameterError, SolverError, unknown
from cable_model.lab import cli

PICTURED = ("dale_sphere", "hanging_chain", "towed_body")
STUDIED = ("hanging_chain", "towed_body")
QUICK_PEER = "C3 sphere, EA 22 N"


def _pictures(folder: Path, quick: bool) -> None:
    for scene in PICTURED[: 1 if quick else None]:
        plot(scene, folder / f"{scene}.png", Choice.both)


def _effects(folder: Path, quick: bool) -> None:
    cli.bench(1 if quick else 7, folder / "cost_of_effects.md", ["bare chain", "bending"] if quick else None, absent=not quick)


def _limits(folder: Path, quick: bool) -> None:
    cli.limits(folder / "limits.md", quick)


def _study(folder: Path, quick: bool) -> None:
    for scene in STUDIED[: 1 if quick else None]:
        cli_studies.study(scene, folder / "studies", quick)


def _advice(folder: Path, quick: bool) -> None:
    cli.advise_trial(["heavy sphere, slow"] if quick else None, folder / "studies" / "advice.md", quick)


def _published(folder: Path, quick: bool) -> None:
    cli.published(None, folder / "published", quick)


def _must_have(*packages: str) -> None:
    for package in packages:
        if find_spec(package) is None:
            raise ParameterError(f"{package}: not installed. Install it with pip install 'cable-fmu[peers]'.")


def _targets(folder: Path, quick: bool) -> None:
    _must_have("moordyn")
    cli.targets(folder / "targets.md", quick)


def _peers(folder: Path, quick: bool) -> None:
    _must_have("moordyn", "cabledyn")
    cli.peers([QUICK_PEER] if quick else None, folder / "peers.md", quick)


def _hard(folder: Path, quick: bool) -> None:
    cli.hard(["H7"] if quick else None, folder / "hard", 2)


WRITERS: Mapping[str, Callable[[Path, bool], None]] = {
    "pictures": _pictures, "effects": _effects, "limits": _limits, "study": _study, "advice": _advice, "published": _published,
    "peers": _peers, "targets": _targets, "hard": _hard,
}  # fmt: skip


@cli.app.command()
def docs(
    only: Annotated[list[str] | None, typer.Option(help=f"parts by their names: {', '.join(WRITERS)}; default: all")] = None,
    output: Annotated[Path, typer.Option("-o", "--output", help="folder to write to")] = Path("docs"),
    quick: Annotated[bool, typer.Option("--quick", help="the smallest of each, to see that it runs")] = False,
) -> None:
    """Write the generated figures and tables of docs/ again; what fails is named at the end, and the rest is written."""
    for name in only or []:
        if name not in WRITERS:
            raise unknown(name, WRITERS, "part")
    failed = []
    for name in only or WRITERS:
        console.rule(name)
        try:
            WRITERS[name](output, quick)
        except (ParameterError, SolverError) as error:
            failed.append(f"{name}: {error}")
        except typer.Exit as ended:
            if ended.exit_code:
                failed.append(f"{name}: ended with status {ended.exit_code}")
    for line in failed:
        say(f"not written or not passed: {line}", "bold red")
    if failed:
        raise typer.Exit(1)
