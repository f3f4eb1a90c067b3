"""Case H15: what is no scene, no step and no motion is refused by one clear error each, and the model that got it runs again."""

from __future__ import annotations

import contextlib
import math
import tempfile
from collections.abc import Callable
from pathlib import Path

import numpy as np

from cable_model.cable_chain import CableChain
from cable_model.errors import ParameterError
from cable_model.lab.hard.rules import Finding
from cable_model.scene import Scene, load, with_values


def _scene(**changes: object) -> Callable[[], object]:
    return lambda: with_values(load("hanging_chain"), {name.replace("__", "."): value for name, value in changes.items()})


def _empty() -> Scene:
    with tempfile.TemporaryDirectory() as folder, contextlib.chdir(folder):  # the report names the file, not a machine's folder
        path = Path("empty.toml")
        path.write_text("", encoding="utf-8")
        return load(path)


def _started() -> CableChain:
    model = CableChain(load("hanging_chain"))
    model.initialize(np.zeros(9))
    return model


def _stepped(step: float, top: float = 0.0, velocity: float = 0.0) -> Callable[[], object]:
    inputs = np.zeros(9)
    inputs[0], inputs[3] = top, velocity
    return lambda: _started().step(0.0, step, inputs)


BAD: dict[str, Callable[[], object]] = {
    "length NaN": _scene(cable__length=math.nan),
    "length infinite": _scene(cable__length=math.inf),
    "length negative": _scene(cable__length=-1.0),
    "no nodes": _scene(solver__nodes=0),
    "solver step 0": _scene(solver__time_step=0.0),
    "solver step negative": _scene(solver__time_step=-0.01),
    "unknown key": _scene(cable__lenght=1.0),
    "wrong type": _scene(cable__length="long"),
    "missing file": lambda: load("nowhere.toml"),
    "empty scene": _empty,
    "communication step 0": _stepped(0.0),
    "communication step negative": _stepped(-0.1),
    "top NaN": _stepped(0.1, top=math.nan),
    "top at 1e6 m/s": _stepped(0.1, velocity=1e6),
}


def bad_input() -> list[Finding]:
    """For each bad input whether it gives one line that says what must be; and whether a refused model then runs as a new one."""
    found = []
    for label, attempt in BAD.items():
        text = ""
        try:
            attempt()
        except ParameterError as error:
            text = str(error)
        clear = bool(text) and "\n" not in text
        found.append(Finding("+", float(clear), 1.0, clear, f"{label}: {text or 'not refused'}"))
    fresh, refused = _started(), _started()
    try:
        refused.step(0.0, math.nan, np.zeros(9))
    except ParameterError:
        refused.initialize(np.zeros(9))
    for model in (fresh, refused):
        model.step(0.0, 0.1, np.zeros(9))
    same = bool(np.array_equal(fresh.state, refused.state))
    return [*found, Finding("+", float(same), 1.0, same, "a model that refused a step runs on as a new one")]
