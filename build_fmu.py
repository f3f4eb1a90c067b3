"""Builds the FMUs: `python build_fmu.py` makes all into dist/, `python build_fmu.py SCENE.toml -o My.fmu` bakes a scene into one."""

import typer

from fmu_src.build import main

if __name__ == "__main__":
    typer.run(main)
