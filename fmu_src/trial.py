"""Simulating built FMUs on a scene through fmpy: the result table, CSV files and picture that show that they work."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

import numpy as np

from cable_model.effects import used_by
from cable_model.fmu_check import sampled_motion, simulate_fmu
from cable_model.models import MODELS
from cable_model.motion import motion_of
from cable_model.plots import picture
from cable_model.scene import load
from cable_model.simulation import Result, write_csv
from fmu_src.interface import table


def _ends(run: Result) -> np.ndarray:
    """What an FMU says of its shape: the top and the lower end, (rows, 2, 3)."""
    return np.stack([np.column_stack([run[f"{end}.{axis}"] for axis in "xyz"]) for end in ("body", "top")], axis=1)


def simulate(fmus: Mapping[str, Path], scene_name: str, folder: Path) -> dict[str, Result]:
    """Simulate FMUs, by the keys of their models, under the scene's top motion; writes CSV files and a picture to `folder`.

    Parameters are the scene's values that the FMU's model has a use for.  Results go by the models' names.
    """
    scene = load(scene_name)
    times, inputs = sampled_motion(motion_of(scene), scene.run.duration, scene.run.output_step)
    stem = Path(scene_name).stem
    folder.mkdir(parents=True, exist_ok=True)
    results = {}
    for key, path in fmus.items():
        name = MODELS[key].__name__
        asked = [row for row in table(scene) if row.causality == "parameter" and key in used_by(row.scene_name)]
        columns, numbers = simulate_fmu(path, times, inputs, {row.name: row.start for row in asked})
        run = Result(columns, numbers, np.empty((0, 0, 3)))
        results[name] = Result(columns, numbers, _ends(run))
        write_csv(folder / f"{stem}_{name}.csv", columns, numbers)
    picture(results, scene, f"{scene.title}\nFMUs simulated through fmpy", folder / f"{stem}_fmu.png")
    return results
