"""What the tests of native FMUs share."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Any

import pytest
from fmu_support import Fmu

from cable_model.scene import Scene
from fmu_src.interface import table
from fmu_src.native import build

KEYS = {identifier: key for key, identifier in build.IDENTIFIERS.items()}  # of the generic FMUs' files
only_where_they_run = [
    pytest.mark.skipif(build.compiler() is None or sys.platform != "linux", reason="native FMUs need Linux and a C compiler"),
    pytest.mark.xdist_group("native"),  # one worker compiles the FMUs, once
]


def values_of(scene: Scene) -> dict[str, Any]:
    """The parameter values that make a generic FMU simulate a scene."""
    return {row.name: row.start for row in table(scene) if row.causality == "parameter"}


def library_of(fmu: Fmu) -> Path:
    return Path(fmu.folder) / "binaries" / "linux64" / f"{fmu.path.stem}.so"
