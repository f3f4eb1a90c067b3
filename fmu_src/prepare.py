"""The command `cable-fmu prepare`: kernels for every scene, compiled once, so that runs start at once."""

from __future__ import annotations

import typer

from cable_model.ready import EVERY, is_recent
from fmu_src.native.export import ExportError
from fmu_src.native.object_code import can_export, object_code, prepare
from fmu_src.native.targets import LIBRARY


def main() -> None:
    """Compile the kernels for every scene once, so that all runs start at once; it takes two minutes, and a wheel has them already."""
    if not (can_export() and is_recent()):
        needs = "Kernels can be compiled ahead on 64-bit x86 Linux with AVX2 only. Numba compiles them for each scene when it runs."
        typer.echo(needs, err=True)
        raise typer.Exit(2)
    try:
        prepare(EVERY, LIBRARY)
        for model, variants in EVERY.items():
            typer.echo(f"{model}: {len(object_code(model, variants, LIBRARY))} bytes of object code")
    except ExportError as error:
        typer.echo(str(error), err=True)
        raise typer.Exit(2) from None
