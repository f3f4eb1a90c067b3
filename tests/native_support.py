"""What the tests of native FMUs share."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from fmu_support import Fmu, Instance, assert_same

from cable_model.effects import used_by
from cable_model.models import MODELS
from cable_model.scene import Scene, load, with_values
from cable_model.simulated import left_out_for
from fmu_src.interface import generic_scene, scene_from_values, table
from fmu_src.native import build, link
from fmu_src.native.targets import LINUX

KEYS = {identifier: key for key, identifier in build.IDENTIFIERS.items()}  # of the generic FMUs' files
only_where_they_run = [
    pytest.mark.skipif(LINUX not in link.available(), reason="native FMUs need 64-bit x86 Linux and a C compiler"),
    pytest.mark.xdist_group("native"),  # one worker compiles the FMUs, once
]

ANCHORED = {  # parameters of an FMU
    "lower_end.anchored": True, "lower_end.x": 60.0, "lower_end.z": -60.0, "body.mass": 0.0, "body.volume": 0.0,
    "body.drag_area": 0.0, "body.added_mass": 0.0,
}  # fmt: skip
SEABED = {"seabed.level": -60.0, "seabed.stiffness": 1e5, "seabed.friction_coefficient": 0.5, "seabed.laid_from_anchor": True}

FLAVOURS = [pytest.param("fmus", marks=only_where_they_run[1]), pytest.param("native", marks=only_where_they_run)]  # fixtures, by name


WATER = {"density": 1025.0, "depth": 60.0}
# scenes with what no parameter of an FMU asks for, and their models
BAKED: dict[str, tuple[str, dict[str, Any]]] = {
    "chain let go in a stretched sea that grows, in a current over time and by inputs, with a stiffness table and the audit": ("chain", {
        "cable": {
            "length": 50.0, "mass_per_length": 2.0, "diameter": 0.03, "stiffness_curve": [[0.0, 0.0], [0.05, 5e3], [0.2, 8e4]],
            "axial_stiffness": 1e5, "normal_drag_coefficient": 1.2,
        },
        "water": {**WATER, "current_input": True}, "top": {"position": [0.0, 0.0, 2.0]},
        "current": {"table": [[0.0, 0.0, 0.5, 0.0], [0.0, -40.0, 0.1, 0.0], [1.0, 0.0, 0.9, 0.0], [1.0, -40.0, 0.2, 0.0]]},
        "waves": {
            "spectrum": "jonswap", "significant_height": 1.0, "peak_period": 5.0, "components": 12, "surface": "wheeler", "ramp_time": 0.5,
        },
        "lower_end": {"anchored": True, "released": True, "x": 30.0, "z": -30.0}, "solver": {"nodes": 21, "audit": True},
    }),
    "chain of sections with bodies on it, moored in space on a bottom by a grid, with friction": ("chain", {
        "cable": {
            "section": [
                {"length": 40.0, "mass_per_length": 8.0, "axial_stiffness": 1e6, "diameter": 0.03, "volume_per_length": 1e-3},
                {"length": 30.0, "mass_per_length": 1.0, "axial_stiffness": 2e5, "diameter": 0.04},
            ],
            "normal_drag_coefficient": 1.2, "added_mass_coefficient": 1.0,
            "body": [{"at": 55.0, "mass": 20.0, "volume": 0.04, "drag_area": 0.1, "added_mass": 15.0}],
        },
        "water": {}, "current": {"speed": 0.2, "direction": 0.4}, "lower_end": {"anchored": True, "x": -50.0, "z": -30.0},
        "seabed": {
            "grid": [[x, y, -30.0 + 0.04 * (x + 50.0) + 0.002 * y * x] for x in (-80.0, -40.0, -10.0, 30.0) for y in (-20.0, 0.0, 30.0)],
            "stiffness": 1e5, "friction_coefficient": 0.3,
        },
        "solver": {"nodes": 27, "space": True},
    }),
    "chain on the box grid": ("chain", {
        "cable": {"length": 50.0, "mass_per_length": 2.0, "diameter": 0.03, "axial_stiffness": 1e5, "normal_drag_coefficient": 1.2},
        "water": {"density": 1025.0}, "body": {"mass": 50.0}, "solver": {"nodes": 21, "grid": "box"},
        "top": {"position": [0.0, 0.0, -1.0]},
    }),
    "tow in space, in a spread sea that is cut, over a bottom, and a current of a table": ("tow", {
        "cable": {"length": 50.0, "mass_per_length": 2.0, "diameter": 0.03, "axial_stiffness": 1e5, "normal_drag_coefficient": 1.2},
        "body": {"mass": 200.0, "volume": 0.02}, "water": WATER, "solver": {"space": True},
        "current": {"levels": [[-60.0, 0.1, 0.0], [0.0, 0.5, 1.0]]},
        "waves": {
            "spectrum": "pierson-moskowitz", "significant_height": 1.0, "peak_period": 6.0, "components": 15, "surface": "cut",
            "direction": 0.4, "spreading_exponent": 4.0,
        },
    }),
}  # fmt: skip


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


def library_run(key: str, scene: Scene, inputs: np.ndarray, step: float) -> np.ndarray:
    """Outputs of the library under inputs (steps, 9) as FMI gives them, with the start first."""
    model = MODELS[key](scene)
    model.initialize(inputs[0])
    rows = [model.outputs.copy()]
    for k, row in enumerate(inputs):
        model.step(k * step, step, row)
        rows.append(model.outputs.copy())
    return np.array(rows)


def native_run(instance: Instance, values: dict[str, Any], inputs: np.ndarray, step: float) -> np.ndarray:
    instance.initialize(values, inputs[0])
    return np.array([instance.outputs(), *(instance.step(k * step, step, row) for k, row in enumerate(inputs))])


def gives_what_the_library_gives(fmu: Fmu, model: str, values: dict[str, Any], inputs: np.ndarray, step: float) -> Instance:
    """An instance of a generic FMU that has run with these values as the library does, and goes on alike from a saved state."""
    instance = fmu.instance()
    found = native_run(instance, values, inputs, step)
    assert_same(found, library_run(model, scene_from_values(generic_scene(), values, model), inputs, step))
    saved = instance.slave.getFMUstate()
    count = len(inputs)
    ahead = [instance.step((count + k) * step, step, inputs[k]) for k in range(5)]
    instance.slave.setFMUstate(saved)
    assert np.array_equal([instance.step((count + k) * step, step, inputs[k]) for k in range(5)], ahead)
    return instance
