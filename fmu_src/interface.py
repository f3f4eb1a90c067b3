"""The one interface table of the FMUs: every variable with its facts.  XML, value references, getters, docs and C derive from it.

Both FMUs have the same table.  The value reference of a variable is its place in it: append, never insert.  Facts of parameters
come from the scene's data classes, those of inputs and outputs from cable_model.facts; only what FMI adds is written here.
"""

from __future__ import annotations

import functools
from collections.abc import Mapping
from dataclasses import dataclass

from cable_model.condition import Given
from cable_model.effects import FMU_PARAMETERS, used_by
from cable_model.errors import refuse, unknown
from cable_model.facts import CPU_TIME, facts_of
from cable_model.parameters import field_of, holder_of, value_of
from cable_model.quantity import types_of
from cable_model.scene import Scene, from_dict, with_values
from cable_model.sections import SHARED
from cable_model.signals import INPUTS, OUTPUTS, SHAPE
from cable_model.simulated import TYPES, true

GENERIC = {
    "title": "Body on a 100 m steel wire in still water",
    "cable": {
        "length": 100.0,
        "diameter": 0.013,
        "mass_per_length": 0.68,
        "axial_stiffness": 9.5e6,
        "normal_drag_coefficient": 1.2,
        "tangential_drag_coefficient": 0.02,
        "added_mass_coefficient": 1.0,
    },
    "body": {"mass": 500.0, "volume": 0.1, "drag_area": 0.5, "added_mass": 50.0},
    "water": {"density": 1025.0},
    "run": {"duration": 60.0, "output_step": 0.05},
}

EFFECTS = "effects.active"
BOOLEAN_INPUTS = ("lower_end.let_go",)

# What released FMUs have beyond their inputs, after which it comes in this order: value references never change.  What signals.OUTPUTS and
# the table of effects have beyond it follows.  Parameters are named as in scenes, but for `wave`, which is the scene's [waves].
RELEASED = (
    "top.force_x",
    "top.force_y",
    "top.force_z",
    "top.tension",
    "top.declination",
    "body.x",
    "body.y",
    "body.z",
    "body.vx",
    "body.vy",
    "body.vz",
    "body.tension",
    "cable.tension_max",
    "cable.tension_min",
    "cable.slack_fraction",
    "solver.steps",
    "solver.newton_iterations",
    "solver.rejected_steps",
    CPU_TIME,
    EFFECTS,
    "top.motion_order",
    "cable.length",
    "cable.diameter",
    "cable.mass_per_length",
    "cable.axial_stiffness",
    "cable.bending_stiffness",
    "cable.axial_damping",
    "cable.normal_drag_coefficient",
    "cable.tangential_drag_coefficient",
    "cable.added_mass_coefficient",
    "cable.compressible",
    "cable.inextensible",
    "body.mass",
    "body.volume",
    "body.drag_area",
    "body.added_mass",
    "lower_end.anchored",
    "lower_end.x",
    "lower_end.y",
    "lower_end.z",
    "lower_end.release_force",
    "environment.gravity",
    "water.density",
    "current.speed",
    "current.direction",
    "wave.amplitude",
    "wave.period",
    "wave.direction",
    "wave.phase",
    "solver.grid",
    "solver.nodes",
    "solver.grading",
    "solver.time_step",
    "solver.lambda_infinity",
    "solver.integrator",
    "solver.tolerance",
    "solver.slack_smoothing",
    "solver.slack_damping",
    "solver.space",
    "tow.poisson_ratio",
    "tow.reference_tension",
    "tow.drag_segments",
    "tow.minimum_tension",
    "tow.cable_mass",
    "tow.body_angle",
    "tow.drag_area_axial",
    "tow.added_mass_vertical",
    "tow.as_printed",
    "tow.explicit",
    "seabed.level",
    "seabed.stiffness",
    "seabed.damping_ratio",
    "seabed.friction_coefficient",
    "seabed.friction_velocity",
    "cable.volume_per_length",
    "winch.fitted",
    "water.surface",
    "cable.quadratic_damping",
)


def scene_name(name: str) -> str:
    """The dotted name in scenes of an FMU parameter."""
    part, _, field = name.partition(".")
    return f"waves.{field}" if part == "wave" else name


def fmu_name(name: str) -> str:
    """The inverse of `scene_name`."""
    return name.replace("waves.", "wave.")


_FIRST, _LATER = INPUTS[:10], INPUTS[10:]  # inputs: at the head, and those that came later
# in the order of their value references
_NAMES = tuple(dict.fromkeys((*_FIRST, *RELEASED, *OUTPUTS, *_LATER, *SHAPE, *map(fmu_name, FMU_PARAMETERS))))
_PARAMETERS = tuple(name for name in _NAMES if name not in (*INPUTS, *OUTPUTS, *SHAPE, CPU_TIME, EFFECTS))


@dataclass(frozen=True)
class Variable:
    """One row: what FMI says of a variable, and the name of the scene's value behind it (parameters only).

    `kind` is the FMI type: "Real", "Integer", "Boolean" or "String".  `minimum_excluded` says that `minimum` itself is refused; with a
    `gap`, so is what lies between its ends.
    A parameter with `choices` is a text in scenes; its Integer is the place of the text.  `starts_from`: the inputs that an output's value
    at the end of initialization depends on, beside all parameters; none: it depends on nothing.
    """

    name: str
    causality: str
    variability: str
    kind: str
    unit: str
    description: str
    start: float | int | bool | None = None
    minimum: float | None = None
    maximum: float | None = None
    minimum_excluded: bool = False
    gap: tuple[float, float] | None = None
    nominal: float | None = None
    scene_name: str = ""
    choices: tuple[str, ...] = ()
    starts_from: tuple[str, ...] = ()


def _input(scene: Scene, name: str) -> Variable:
    end, _, axis = name.partition(".")
    start = getattr(scene, end).position["xyz".index(axis)] if axis in ("x", "y", "z") else 0.0
    facts = facts_of(name)
    if name in BOOLEAN_INPUTS:
        return Variable(name, "input", "discrete", "Boolean", "", facts.description, False)
    return Variable(name, "input", "continuous", "Real", facts.unit, facts.description, start, nominal=facts.size)


def _output(name: str) -> Variable:
    unit, text, nominal, starts_from = facts_of(name)
    return Variable(name, "output", "continuous", "Real", unit, text, nominal=nominal, starts_from=starts_from)


def _start(scene: Scene, name: str) -> float | int | bool:
    """The value in a scene as FMI gives it: choices by their code; no water has density 0."""
    value, choices = value_of(scene, scene_name(name)), field_of(scene_name(name)).metadata["choices"]
    return choices.index(value) if choices else value


def _parameter(scene: Scene, name: str) -> Variable:
    kind, facts = types_of(holder_of(scene_name(name)))[name.partition(".")[2]], field_of(scene_name(name)).metadata
    start = _start(scene, name)
    text = facts["description"]
    users = used_by(scene_name(name))
    if len(users) == 1:
        text += f" ({TYPES[users[0]]} only)"
    common = ("parameter", "fixed")
    if kind is bool:
        return Variable(name, *common, "Boolean", "", text, start, scene_name=scene_name(name))
    if kind is str:
        choices = facts["choices"]
        listed = ", ".join(f"{code} {choice}" for code, choice in enumerate(choices))
        return Variable(
            name, *common, "Integer", "", f"{text}: {listed}", start, 0, len(choices) - 1,
            scene_name=scene_name(name), choices=choices,
        )  # fmt: skip
    least = facts["least"] if facts["above"] is None else facts["above"]
    return Variable(
        name, *common, "Integer" if kind is int else "Real", "" if kind is int else facts["unit"], text, start, least, facts["most"],
        minimum_excluded=facts["above"] is not None, gap=facts["gap"], scene_name=scene_name(name),
    )  # fmt: skip


def _row(scene: Scene, name: str) -> Variable:
    if name in INPUTS:
        return _input(scene, name)
    if name == EFFECTS:
        return Variable(name, "local", "fixed", "String", "", "effects that are simulated, and the value that switched each on")
    return _parameter(scene, name) if name in _PARAMETERS else _output(name)


@functools.lru_cache(maxsize=8)
def table(scene: Scene | None = None) -> tuple[Variable, ...]:
    """The interface, with the start values of a scene (None: the generic one); place = value reference = index in the XML - 1."""
    scene = generic_scene() if scene is None else scene
    return tuple(_row(scene, name) for name in _NAMES)


def in_variables(text: str) -> str:
    """A text about values of a scene, with the names that FMUs have for them."""
    for row in table():
        if row.scene_name and row.scene_name != row.name:
            text = text.replace(row.scene_name, row.name)
    return text


def generic_scene() -> Scene:
    """The scene of an FMU that has none baked in: it initializes as it is."""
    return from_dict(GENERIC)


OF_SECTIONS = (*(f"cable.{name}" for name in ("length", *SHARED)), "solver.nodes")
_REPLACED = (  # what a baked table or spectrum takes the place of
    ("current.levels", "a table of the current", ("current.speed", "current.direction")),
    ("current.table", "a current over time", ("current.speed", "current.direction")),
    ("waves.spectrum", "a spectrum of waves", ("wave.amplitude", "wave.period", "wave.phase")),
    ("waves.table", "a table of waves", ("wave.amplitude", "wave.period", "wave.direction", "wave.phase")),
    ("waves.record", "a record of waves", ("wave.amplitude", "wave.period", "wave.phase")),
    ("cable.stiffness_curve", "a table of the stiffness", ("cable.axial_stiffness",)),
    ("cable.section", "a cable of sections", OF_SECTIONS),
    ("cable.body", "a cable with bodies on it", OF_SECTIONS),
    ("lower_end.released", "a lower end that is let go", ("lower_end.anchored",)),
)


def kept(base_scene: Scene, model: str) -> dict[str, tuple[str, str]]:
    """The parameters of a model's FMU that must keep their start values over a base scene: what each must be, and what to do."""

    def start(name: str) -> str:
        value = _start(base_scene, name)
        return str(value).lower() if isinstance(value, bool) else f"{value:g}"

    found = {}
    for name in _PARAMETERS:
        users = used_by(scene_name(name))
        if users and model not in users:
            found[name] = (f"{start(name)} for {TYPES[model]}, which has no use for it", f"Leave it, or use {TYPES[users[0]]}.")
    for table_name, words, names in _REPLACED:
        if true(Given(table_name), base_scene, model):
            remedy = "Bake the scene with the other value." if names is OF_SECTIONS else f"Bake a scene without {table_name}."
            found |= {name: (f"{start(name)} where {words} is baked in", remedy) for name in names}
    return found


def in_scenes(row: Variable, value: float | int | bool) -> float | int | bool | str:
    """A parameter's value as scenes have it: a choice by its text.  Raises ParameterError for a code that is none."""
    if not row.choices:
        return value
    if value not in range(len(row.choices)):
        raise refuse(row.name, value, "", f"a whole number from 0 to {len(row.choices) - 1}", f"Codes: {row.description}.")
    return row.choices[int(value)]


def scene_from_values(base_scene: Scene, values: Mapping[str, float | int | bool], model: str) -> Scene:
    """The scene that the parameter values of a model's FMU describe; what they do not name, such as a table, is the base scene's.

    Raises ParameterError for a name that is no parameter, a value that the model has no use for, a value that breaks its rule, and
    values that do not go together.
    """
    changed: dict[str, float | int | bool | str] = {}
    held = kept(base_scene, model)
    for name, value in values.items():
        if name not in _PARAMETERS:
            raise unknown(name, _PARAMETERS, "parameter")
        if value == _start(base_scene, name):
            continue
        row = _parameter(base_scene, name)
        if name in held:
            raise refuse(name, value, field_of(row.scene_name).metadata["unit"], *held[name])
        changed[row.scene_name] = in_scenes(row, value)
    return with_values(base_scene, changed) if changed else base_scene
