"""What the command line shows: every text whole, whatever is in it, and an error as one line."""

from __future__ import annotations

import errno
import sys
from collections.abc import Iterable
from pathlib import Path
from typing import NoReturn

from rich.console import Console
from rich.progress import BarColumn, Progress, TaskProgressColumn, TextColumn, TimeRemainingColumn
from rich.text import Text

from cable_model.errors import ParameterError, reading, writing
from cable_model.scene import Scene, load

console = Console(markup=False, emoji=False)  # titles, paths and errors have brackets and colons of their own

_REMEDIES = {
    errno.ENOSPC: "Free some space, or write elsewhere with -o.",
    errno.EFBIG: "Raise the limit of file sizes, or write elsewhere with -o.",
    errno.EISDIR: "Give the name of a file.",
    errno.ENOENT: "Give a path that is there.",
}


def say(text: str, style: str = "") -> None:
    """A line, not broken at the width of the terminal."""
    console.print(text, style=style or None, soft_wrap=True)


def warn(texts: Iterable[str]) -> None:
    """Each as a line on stderr: what was asked for is not disturbed."""
    for text in texts:
        Console(stderr=True, markup=False, emoji=False).print(f"warning: {text}", style="yellow", soft_wrap=True)


def progress() -> Progress:
    """A bar that is gone when it is done; its description is shown as it is."""
    columns = (TextColumn("{task.description}", style="progress.description", markup=False), BarColumn(), TaskProgressColumn())
    return Progress(*columns, TimeRemainingColumn(), console=console, transient=True)


def load_scene(scene: str) -> Scene:
    """The scene of that file or name, as the command line reads it."""
    with reading(scene):
        return load(scene)


def save(path: Path, text: str) -> None:
    """Write a text, in a folder that is made where it is missing."""
    path.parent.mkdir(parents=True, exist_ok=True)
    with writing(path):
        path.write_text(text, encoding="utf-8")
    say(f"wrote {path}")


def check_output(path: Path | None, folder: bool = False) -> None:
    """Refuse, before minutes are spent, a folder where a file will be written, or a file where a folder will."""
    if path is not None and path.exists() and path.is_dir() is not folder:
        wanted, found = ("folder", "file") if folder else ("file", "folder")
        raise ParameterError(f"{path}: is a {found}. Give the name of a {wanted}.")


def words_of(error: OSError) -> str:
    """What the system says of a file, with its name and what to do."""
    remedy = _REMEDIES.get(error.errno or 0, "Write elsewhere with -o, or change the rights of the file.")
    return f"{error.filename or 'standard output'}: {error.strerror or error}. {remedy}"


def fail(text: str, status: int = 2) -> NoReturn:
    """End the program with an error of one line."""
    line = " ".join(text.splitlines())
    try:
        console.print(Text.assemble(("error:", "bold red"), " ", line), soft_wrap=True)
    except OSError:  # nothing can be written there
        sys.stderr.write(f"error: {line}\n")
    raise SystemExit(status)
