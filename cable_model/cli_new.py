"""The command line of one's own scenes: new."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer
from rich.table import Table

from cable_model.cli_console import check_output, console, save, say
from cable_model.errors import ParameterError, unknown
from cable_model.scene import load, shipped

EXAMPLES = "examples/"


def new(
    name: Annotated[
        str | None, typer.Argument(help="the name of a shipped scene; of examples/NAME the NAME is enough; default: list them")
    ] = None,
    output: Annotated[
        Path | None, typer.Option("-o", "--output", help="the scene to write; default: the name of the copied one, in this folder")
    ] = None,
) -> None:
    """Write a copy of a shipped scene, comments included, to make your own of; without a name, list them with their titles."""
    if name is None and output is not None:
        raise ParameterError(f"{output}: of which scene? Name one before -o; `cable-fmu new` lists them.")
    if name is None:
        _list()
        return
    known = shipped()
    source = known.get(name) or known.get(EXAMPLES + name)
    if source is None:
        raise unknown(name, known, "scene")
    target = output or Path(source.name)
    check_output(target)
    if target.exists():
        raise ParameterError(f"{target}: is there already. Give another name with -o, or move it away.")
    save(target, source.read_text(encoding="utf-8"))


def _list() -> None:
    table = Table()
    for column in ("scene", "title"):
        table.add_column(column, no_wrap=column == "scene")
    known = shipped()
    examples = [name for name in known if name.startswith(EXAMPLES)]
    plain = [name for name in known if "/" not in name]
    for name in (*examples, *plain):
        table.add_row(name, load(name).title)
    console.print(table)
    say(f"hard cases: {', '.join(name for name in known if name not in (*examples, *plain))}")
