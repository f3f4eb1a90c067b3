"""The battery's scenes and runs: random scenes from the table of effects, and what a scene in other units, elsewhere or turned is."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Callable, Mapping
from typing import Any

import numpy as np
from hypothesis import strategies as st

from cable_model.effects import CHAIN, COST_CASES, TOW
from cable_model.errors import ParameterError, SolverError
from cable_model.model import Model
from cable_model.models import MODELS
from cable_model.parameters import value_of
from cable_model.scene import Scene, from_dict, with_values
from cable_model.signals import OUTPUTS
from cable_model.simulated import refused_by
from fmu_src.interface import generic_scene, table
from fmu_src.model_description import base_units

BASE = {
    "cable": {"length": 1.75, "mass_per_length": 0.1, "axial_stiffness": 17167.5, "diameter": 0.01},
    "environment": {"gravity": 9.81},
    "solver": {"nodes": 7, "time_step": 0.02},
}
# what rows of the table have no cost case for
OTHER_CASES: Mapping[str, Mapping[str, Any]] = {
    "anchored": {"lower_end.anchored": True, "lower_end.x": 0.7, "lower_end.z": -1.4},
    "lying": {"lower_end.anchored": True, "lower_end.x": 1.4, "lower_end.z": -0.8, "seabed.level": -0.8, "seabed.stiffness": 1e6},
    "held aside": {"lower_end.release_force": 1.0},
    "let go": {"lower_end.anchored": True, "lower_end.released": True, "lower_end.x": 0.7, "lower_end.z": -1.4},
    "no cable mass": {"tow.cable_mass": False, "body.mass": 0.1},
    "floor": {"tow.minimum_tension": 0.1, "body.mass": 0.1},
    "thinning": {"tow.poisson_ratio": 0.3},
    "float": {"body.mass": 0.1, "body.volume": 2e-4, "body.drag_area": 1e-3, "body.added_mass": 0.1, "water.density": 1000.0},
    "on a host": {"host.mass": 2.0},
    "top in air": {"top.position": (0.0, 0.0, 0.3), "water.density": 1000.0},
}
CASES = {**COST_CASES, **OTHER_CASES}
ARITHMETIC = ("math domain error", "math range error", "division by zero", "float division by zero")
VARIED = (
    "cable.length", "cable.mass_per_length", "cable.axial_stiffness", "cable.diameter", "body.mass", "environment.gravity",
    "cable.bending_stiffness", "seabed.stiffness", "current.speed", "waves.amplitude", "waves.period", "cable.axial_damping",
)  # fmt: skip
UNITS = [row.unit for row in table(generic_scene()) if row.name in OUTPUTS]


@st.composite
def scenes(draw: st.DrawFn) -> tuple[str, Scene]:
    """A model, and a scene that it takes: some cases of the table together, with numbers off their own by up to a factor of four."""
    values: dict[str, Any] = {}
    for name in draw(st.lists(st.sampled_from(sorted(CASES)), max_size=4, unique=True)):
        values |= CASES[name]
    scene = from_dict(BASE)
    for name in VARIED:
        own = values.get(name, value_of(scene, name))
        values[name] = own * 2.0 ** draw(st.floats(-2.0, 2.0, width=32))
    joints = "cable.section" in values or "cable.body" in values
    if "cable.section" in values:
        for name in ("cable.length", "cable.mass_per_length"):  # its sections'
            values.pop(name)
    if "cable.body" in values:
        at = values["cable.body"][0]["at"] * values.get("cable.length", value_of(scene, "cable.length")) / value_of(scene, "cable.length")
        values["cable.body"] = [{**values["cable.body"][0], "at": at}]
    values["solver.nodes"] = draw(st.integers(7, 9) if joints else st.integers(3, 6))
    values["solver.grading"] = draw(st.sampled_from([0.0, 1.0, 2.0]))
    values["solver.lambda_infinity"] = draw(st.sampled_from([-0.9, -0.5, 0.0]))
    values["top.motion_order"] = draw(st.integers(0, 2))
    model = draw(st.sampled_from([CHAIN, CHAIN, CHAIN, TOW]))
    try:
        scene = with_values(scene, values)
    except ParameterError:
        return draw(scenes())
    if next(refused_by(scene, model), None) is not None:
        return draw(scenes())
    return model, scene


def is_calm(scene: Scene) -> bool:
    """Whether nothing but the top moves the cable: no waves, no current that changes, and no end that is let go."""
    waves = scene.waves.amplitude or scene.waves.spectrum != "none" or scene.waves.table or scene.waves.record
    return not (waves or scene.current.table or scene.current.ramp_time or scene.lower_end.released or scene.lower_end.release_force)


def unit_factor(unit: str, mass: float, length: float, time: float) -> float:
    """By how much a number of that unit grows where the units of mass, length and time shrink by these factors."""
    if unit in ("", "1", "rad"):
        return 1.0
    powers = base_units(unit)
    return float(mass ** powers.get("kg", 0) * length ** powers.get("m", 0) * time ** powers.get("s", 0))


def _of_fields(holder: Any, factors: tuple[float, float, float]) -> dict[str, Any]:
    return {f.name: _scaled(getattr(holder, f.name), f.metadata["unit"], factors) for f in dataclasses.fields(holder)}


def _scaled(value: Any, units: str, factors: tuple[float, float, float]) -> Any:
    if isinstance(value, tuple) and value and dataclasses.is_dataclass(value[0]):
        return tuple(dataclasses.replace(row, **_of_fields(row, factors)) for row in value)
    if isinstance(value, tuple):
        columns = units.split(", ")
        if value and isinstance(value[0], tuple):
            return tuple(tuple(x * unit_factor(unit, *factors) for x, unit in zip(row, columns, strict=True)) for row in value)
        return tuple(x * unit_factor(units, *factors) for x in value)
    if isinstance(value, bool | int | str):
        return value
    return value * unit_factor(units, *factors) if value not in (-1.0,) or units in ("", "1", "rad") else value


def _without_use(part: str, holder: Any) -> set[str]:
    """Values of a part of a scene that must stay as they usually are, and the motion, which no battery has."""
    if part == "waves":
        return ({"period"} if not holder.amplitude else set()) | ({"peak_period"} if holder.spectrum == "none" else set())
    return {"motion"} if part in ("top", "lower") else set()


def in_other_units(scene: Scene, mass: float, length: float, time: float) -> Scene:
    """The same scene, its numbers as they are in smaller units of mass, length and time."""
    parts = {}
    for part in dataclasses.fields(scene):
        holder = getattr(scene, part.name)
        if not dataclasses.is_dataclass(holder) or isinstance(holder, type):
            continue
        if part.name == "seabed" and not holder.stiffness:
            continue  # there is none, and its values must be the usual ones
        usual = _without_use(part.name, holder)
        parts[part.name] = dataclasses.replace(
            holder,
            **{name: value for name, value in _of_fields(holder, (mass, length, time)).items() if name not in usual},
        )
    return dataclasses.replace(scene, **parts)


Inputs = Callable[[float], np.ndarray]


def motion_of_ends(scene: Scene) -> Inputs:
    """A smooth motion of the scene's own scale, from rest: of the top a twentieth of the length at the pace of its pendulum."""
    size = 0.05 * scene.cable.length
    omega = 2.0 * math.sqrt(scene.environment.gravity / scene.cable.length)

    def end(place: tuple[float, float, float], ways: tuple[float, float, float], omega: float, time: float) -> np.ndarray:
        phase, along = omega * time, size * np.array(ways) * [1.0, scene.solver.space, 1.0]
        rates = (phase - math.sin(phase), omega * (1.0 - math.cos(phase)), omega**2 * math.sin(phase))
        return np.concatenate([place + along * rates[0], along * rates[1], along * rates[2]])

    def inputs(time: float) -> np.ndarray:
        winch = 0.1 * size * omega * (1.0 - math.cos(omega * time)) if scene.winch.fitted else 0.0
        lower = end(scene.lower.position, (-0.5, 0.4, 0.3), 1.3 * omega, time) if scene.lower_end.driven else np.zeros(9)
        return np.concatenate([end(scene.top.position, (1.0, 0.7, -0.4), omega, time), [winch], lower])

    return inputs


class Run:
    """A model that goes on by communication steps of `step`."""

    def __init__(self, model: str, scene: Scene, inputs: Inputs | None = None, step: float | None = None) -> None:
        self.model: Model = MODELS[model](scene)
        self.inputs = inputs or motion_of_ends(scene)
        self.step = step or 2.5 * min(scene.solver.time_step, 0.2 * math.sqrt(scene.cable.length / scene.environment.gravity))
        self.steps = 0
        self.rows: list[np.ndarray] = []
        self.failed = ""
        self._try(self.model.initialize, self.inputs(0.0))

    def _try(self, call: Callable[..., None], *arguments: object) -> None:
        if self.failed:
            return
        try:
            call(*arguments)
        except (ParameterError, SolverError) as error:
            self.failed = str(error)
        except (ArithmeticError, ValueError) as error:  # where compiled code goes on with a NaN, to try a smaller step
            if str(error) not in ARITHMETIC:
                raise
            self.failed = str(error)
        else:
            self.rows.append(self.model.outputs.copy())
            assert np.isfinite(self.rows[-1]).all()

    def go(self, steps: int) -> Run:
        for _ in range(steps):
            time = self.steps * self.step
            self._try(self.model.step, time, self.step, self.inputs(time))
            self.steps += 1
        return self

    @property
    def table(self) -> np.ndarray:
        return np.array(self.rows)
