"""The command `cable-fmu`: that of the package cable_model, and what compiles and builds."""

from cable_model import cli
from fmu_src.build import main as build
from fmu_src.prepare import main as prepare

COMPILING = {"build": build, "prepare": prepare}


def main() -> None:
    """Run the command line."""
    for name, command in COMPILING.items():
        cli.app.command(name)(command)
    cli.main()
