"""The command line of other programs' files: import."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from cable_model import moordyn
from cable_model.cli_console import check_output, save, say
from cable_model.moordyn_scene import scene_of
from cable_model.scene import to_toml


def import_deck(
    file: Annotated[Path, typer.Argument(help="a MoorDyn v2 input file")],
    output: Annotated[
        Path | None, typer.Option("-o", "--output", help="the scene to write; default: the file's name, in this folder")
    ] = None,
    line: Annotated[int | None, typer.Option(help="the line to take, with those that hang together with it; default: the only one")] = None,
) -> None:
    """Write a line of a MoorDyn v2 input file as a scene, with lines that go on at free points, and say what was left out or changed.

    That stands in the scene too.
    """
    target = output or Path(f"{file.stem}.toml" if line is None else f"{file.stem}_line{line}.toml")
    check_output(target)
    scene, told = scene_of(moordyn.read(file), line)
    for text in told:
        say(text)
    save(target, "".join(f"# {text}\n" for text in told) + "\n" + to_toml(scene))
