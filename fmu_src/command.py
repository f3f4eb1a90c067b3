"""The command `cable-fmu`: that of the package cable_model, and `build`; runs start at once where FMUs were built before."""

import sys

from cable_model import cli
from cable_model.model import Model
from fmu_src import quick_start
from fmu_src.build import main as build

QUICK = ("run", "plot", "view")  # the others measure the kernels that numba compiles for a scene, or have processes of their own


def main() -> None:
    """Run the command line."""
    cli.app.command("build")(build)
    if sys.argv[1:2] and sys.argv[1] in QUICK:
        Model.offered = staticmethod(quick_start.calls)
    cli.main()
