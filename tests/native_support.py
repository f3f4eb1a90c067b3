"""What the tests of native FMUs share."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest
from fmu_support import Fmu

from cable_model.effects import used_by
from cable_model.scene import Scene, load, with_values
from cable_model.simulated import left_out_for
from fmu_src.interface import table
from fmu_src.native import build, link
from fmu_src.native.targets import LINUX

KEYS = {identifier: key for key, identifier in build.IDENTIFIERS.items()}  # of the generic FMUs' files
only_where_they_run = [
    pytest.mark.skipif(LINUX not in link.available(), reason="native FMUs need 64-bit x86 Linux and a C compiler"),
    pytest.mark.xdist_group("native"),  # one worker compiles the FMUs, once
]

FLAVOURS = [pytest.param("fmus", marks=only_where_they_run[1]), pytest.param("native", marks=only_where_they_run)]  # fixtures, by name


def values_of(scene: Scene, model: str) -> dict[str, Any]:
    """The parameter values that make a model's generic FMU simulate a scene: those that the model has a use for."""
    rows = [row for row in table(scene) if row.causality == "parameter"]
    return {row.name: row.start for row in rows if model in used_by(row.scene_name)}


def lean(name: str, model: str) -> Scene:
    """A shipped scene without what the model lacks."""
    scene = load(name)
    return with_values(scene, left_out_for(scene, model)[1])


def library_of(fmu: Fmu) -> Path:
    return Path(fmu.folder) / "binaries" / "linux64" / f"{fmu.path.stem}.so"
