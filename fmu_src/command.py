"""The command `cable-fmu`: that of the package cable_model, `build`, and `prepare`."""

from cable_model import cli
from fmu_src.build import main as build
from fmu_src.prepare import main as prepare


def main() -> None:
    """Run the command line."""
    cli.app.command("build")(build)
    cli.app.command("prepare")(prepare)
    cli.main()
