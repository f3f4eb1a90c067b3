"""The command `cable-fmu`: that of the package cable_model, and `build`."""

from cable_model import cli
from fmu_src.build import main as build


def main() -> None:
    """Run the command line."""
    cli.app.command("build")(build)
    cli.main()
