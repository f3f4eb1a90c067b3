"""THE table of effects: one row an effect, from which everything that must know of an effect derives.  Data only; no physics.

To add an effect: a row here, its values in parameters.py, a kernel that is called where the equation has it, and its tests.  From the
row follow the kernels' parts and numbers, what a scene switches on and why, what a model or grid refuses, parameters and variants of
FMUs, what `advise` may leave out, what a peer is not told of, and the cost table.
"""

from __future__ import annotations

import itertools
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from cable_model import tables
from cable_model.condition import Changed, Chosen, Condition, Given, On
from cable_model.kernels.parts import parts_type

CHAIN, TOW = "chain", "tow"
STAGGERED, BOX = "staggered", "box"


@dataclass(frozen=True)
class Effect:
    """One row."""

    name: str
    words: str  # in lists of effects; rows with the same words are told as one, "" is not told
    on: Condition | None  # what a scene must say, in a model and on a grid that has the effect, with all that it needs; None: nothing
    because: tuple[str, ...]  # the values that decide: lists name the first that is given
    needs: tuple[str, ...] = ()  # effects without which it is off
    models: tuple[str, ...] = (CHAIN, TOW)
    grids: tuple[str, ...] = (STAGGERED, BOX)  # of the chain
    asked: Condition | None = None  # what a model or grid without it refuses; None: `on`
    instead: str = ""  # what a grid without it does, which is then no reason to refuse
    remedy: str = 'Set solver.grid = "staggered".'  # where the grid has it not
    part: bool = True  # whether kernels are compiled with it or without it
    table: Callable[[Any], Any] | None = None  # makes what kernels get in place of True
    numbers: tuple[str, ...] = ()  # values that kernels get; FMUs have them as parameters
    parameters: tuple[str, ...] = ()  # FMU parameters beside these
    native: str = "either"  # in a native FMU without a baked scene: either; always, where zeros give its absence; present; absent
    left_out: Mapping[str, Any] = field(default_factory=dict)  # the values without it, where a scene makes sense without it
    called: str = ""  # what `advise` calls it; "": as `words`
    costs: Mapping[str, Mapping[str, Any]] = field(default_factory=dict)  # cases of the cost table
    told_to_peers: bool = False  # whether every code that we are compared with simulates it, or its absence changes no physics
    goes: bool = False  # with what is below the place where a cable parts
    inverse: bool = False  # `words` name what its absence leaves in
    missing: str = ""  # why this effect, and one that needs it, is off in a scene without its table


_WATER = {"water.density": 1000.0, "cable.normal_drag_coefficient": 1.2, "cable.added_mass_coefficient": 1.0}
_SEA = {**_WATER, "waves.spectrum": "jonswap", "waves.significant_height": 0.02, "waves.peak_period": 1.0, "waves.components": 20}
_SEABED = {"seabed.level": -1.8, "seabed.stiffness": 1e6}
_SECTIONS = [{"length": 0.75}, {"length": 1.0, "mass_per_length": 0.05}]
_UNCLAMPED = {
    end: {f"{end}.clamped": False, f"{end}.clamp_declination": 0.0, f"{end}.clamp_direction": 0.0} for end in ("top", "lower_end")
}
_HELD = {"lower_end.anchored": True, "lower_end.z": -1.6}
_CURVE = [[0.0, 0.0], [0.01, 171.675], [0.1, 1716.75]]

EFFECTS = (
    Effect(
        "body", "body", Given("body.mass"), ("body.mass",), told_to_peers=True, goes=True,
        numbers=("body.mass", "body.volume", "body.drag_area", "body.added_mass"),
        costs={"body": {"body.mass": 0.1}},
    ),
    Effect(
        "anchor", "anchored lower end", Given("lower_end.anchored") & ~On("released"), ("lower_end.anchored",), models=(CHAIN,), goes=True,
        numbers=("lower_end.x", "lower_end.y", "lower_end.z"), parameters=("lower_end.anchored",),
    ),
    Effect(
        "driven", "lower end moved by inputs", Given("lower_end.driven"), ("lower_end.driven",), needs=("anchor",), models=(CHAIN,),
        grids=(STAGGERED,), goes=True, asked=Given("lower_end.driven"), numbers=("lower_end.driven",),
        costs={"lower end moved by inputs": {"lower_end.anchored": True, "lower_end.driven": True, "lower.position": [0.0, 0.0, -1.6]}},
    ),
    Effect(
        "released", "lower end let go at the start", Given("lower_end.released"), ("lower_end.released",), models=(CHAIN,),
        grids=(STAGGERED,), part=False, told_to_peers=True,
    ),
    Effect(
        "held_aside", "lower end held aside until the start", Given("lower_end.release_force"), ("lower_end.release_force",),
        models=(CHAIN,), part=False, told_to_peers=True,
        numbers=("lower_end.release_force",),
    ),
    Effect(
        "water", "water: buoyancy, drag, added mass", Given("water.density"), ("water.density",), told_to_peers=True, missing="no [water]",
        numbers=(
            "water.density", "cable.diameter", "cable.normal_drag_coefficient", "cable.tangential_drag_coefficient",
            "cable.added_mass_coefficient", "cable.volume_per_length",
        ),
        costs={"water": _WATER},
    ),
    Effect(
        "surface", "water surface: dry above it", Given("water.surface"), ("water.surface",), needs=("water",),
        told_to_peers=True,
        parameters=("water.surface",), left_out={"water.surface": False},
        costs={"water without a surface": {**_WATER, "water.surface": False}},
    ),
    Effect(
        "current", "current", Given("current.levels", column=1) | Given("current.speed") & ~Given("current.levels"),
        ("current.levels", "current.speed"), needs=("water",), table=tables.current, native="always",
        parameters=("current.speed", "current.direction"), left_out={"current.speed": 0.0, "current.levels": (), "current.ramp_time": 0.0},
        costs={"water and current": {**_WATER, "current.speed": 0.1}},
    ),
    Effect(
        "current_table", "current that changes over time", Given("current.table", column=2), ("current.table",), needs=("water",),
        table=tables.current_over_time, native="absent", left_out={"current.table": (), "current.ramp_time": 0.0},
        costs={"water and current over time": {**_WATER, "current.table": [[0.0, 0.0, 0.1, 0.0], [100.0, 0.0, 0.2, 0.0]]}},
    ),
    Effect(
        "current_ramp", "current that grows from the start", Given("current.ramp_time"), ("current.ramp_time",), needs=("water",),
        numbers=("current.ramp_time",), native="always", left_out={"current.ramp_time": 0.0},
        costs={"water and current that grows": {**_WATER, "current.speed": 0.1, "current.ramp_time": 100.0}},
    ),
    Effect(
        "stream", "current that inputs give", Given("water.current_input"), ("water.current_input",), needs=("water",),
        numbers=("water.current_input",), native="always", left_out={"water.current_input": False},
        costs={"water and current by inputs": {**_WATER, "water.current_input": True}},
    ),
    Effect(
        "waves", "waves", Given("waves.amplitude") | Given("waves.spectrum") | Given("waves.table") | Given("waves.record"),
        ("waves.spectrum", "waves.table", "waves.record", "waves.amplitude"), needs=("water",), table=tables.waves, native="always",
        parameters=("waves.amplitude", "waves.period", "waves.direction", "waves.phase"),
        left_out={
            "waves.amplitude": 0.0, "waves.period": 10.0, "waves.direction": 0.0, "waves.phase": 0.0, "waves.spectrum": "none",
            "waves.significant_height": 0.0, "waves.peak_period": 10.0, "waves.peakedness": 3.3, "waves.components": 60, "waves.seed": 1,
            "waves.spreading_exponent": 0.0, "waves.table": (), "waves.record": (), "waves.ramp_time": 0.0,
            "waves.surface": "held", "waves.exact": False, "water.depth": 0.0,
        },
        costs={
            "water and waves": {**_WATER, "waves.amplitude": 0.01, "waves.period": 1.0},
            "water and 20 waves": _SEA,
            "water and 60 waves": {**_SEA, "waves.components": 60},
        },
    ),
    Effect(
        "wave_ramp", "waves that grow from the start", Given("waves.ramp_time"), ("waves.ramp_time",), needs=("water", "waves"),
        numbers=("waves.ramp_time",), native="always", left_out={"waves.ramp_time": 0.0},
        costs={"water and 20 waves that grow": {**_SEA, "waves.ramp_time": 100.0}},
    ),
    Effect(
        "followed", "", (Given("waves.spectrum") | Given("waves.table") | Given("waves.record")) & ~Given("waves.exact"), ("waves.exact",),
        needs=("water", "waves"), models=(CHAIN,), grids=(STAGGERED,), instead="all components are summed",
        native="absent", told_to_peers=True,
        costs={
            "water and 200 waves": {**_SEA, "waves.components": 200},
            "water and 200 waves, exact": {**_SEA, "waves.components": 200, "waves.exact": True},
        },
    ),
    Effect(
        "finite_depth", "finite depth of the waves", Given("water.depth"), ("water.depth",), needs=("water", "waves"), native="absent",
        left_out={"water.depth": 0.0}, costs={"water and 20 waves, finite depth": {**_SEA, "water.depth": 10.0}},
    ),
    Effect(
        "stretched", "waves up to the surface as it is", Chosen("waves.surface", "wheeler"), ("waves.surface",), needs=("water", "waves"),
        native="absent", left_out={"waves.surface": "held"}, called="surface of the waves",
        costs={"water and 20 waves, stretched": {**_SEA, "waves.surface": "wheeler"}},
    ),
    Effect(
        "cut", "waves up to the surface as it is", Chosen("waves.surface", "cut"), ("waves.surface",), needs=("water", "waves"),
        native="absent", costs={"water and 20 waves, cut": {**_SEA, "waves.surface": "cut"}},
    ),
    Effect(
        "voigt", "material axial damping", Given("cable.axial_damping"), ("cable.axial_damping",), told_to_peers=True,
        numbers=("cable.axial_damping",), native="always", left_out={"cable.axial_damping": 0.0}, called="material damping",
        costs={"material damping": {"cable.axial_damping": 10.0}},
    ),
    Effect(
        "quadratic_damping", "quadratic axial damping", Given("cable.quadratic_damping"), ("cable.quadratic_damping",), models=(CHAIN,),
        grids=(STAGGERED,), numbers=("cable.quadratic_damping",), left_out={"cable.quadratic_damping": 0.0},
        costs={"quadratic axial damping": {"cable.quadratic_damping": 10.0}},
    ),
    Effect(
        "space", "motion out of the vertical plane", Given("solver.space"), ("solver.space",), grids=(STAGGERED,), told_to_peers=True,
        remedy='Set solver.grid = "staggered" for motion in space.', parameters=("solver.space",), native="absent",
        left_out={"solver.space": False}, costs={"space": {"solver.space": True}},
    ),
    Effect(
        "bending", "bending", Given("cable.bending_stiffness"), ("cable.bending_stiffness",), models=(CHAIN,),
        numbers=("cable.bending_stiffness",), left_out={"cable.bending_stiffness": 0.0},
        costs={"bending": {"cable.bending_stiffness": 5e-6}},
    ),
    Effect(
        "top_clamp", "clamped top", Given("top.clamped"), ("top.clamped",), needs=("bending",), models=(CHAIN,), grids=(STAGGERED,),
        asked=Given("top.clamped"), numbers=("top.clamp_declination", "top.clamp_direction"), parameters=("top.clamped",),
        left_out=_UNCLAMPED["top"], costs={"bending and a clamped top": {"cable.bending_stiffness": 5e-6, "top.clamped": True}},
    ),
    Effect(
        "lower_clamp", "clamped lower end", Given("lower_end.clamped"), ("lower_end.clamped",), needs=("anchor", "bending"),
        models=(CHAIN,), grids=(STAGGERED,), goes=True, asked=Given("lower_end.clamped"),
        numbers=("lower_end.clamp_declination", "lower_end.clamp_direction"), parameters=("lower_end.clamped",),
        left_out=_UNCLAMPED["lower_end"],
        costs={"bending and a clamped anchor": {"cable.bending_stiffness": 5e-6, **_HELD, "lower_end.clamped": True}},
    ),
    Effect(
        "box", "", Given("solver.grid"), ("solver.grid",), models=(CHAIN,), grids=(BOX,), told_to_peers=True, parameters=("solver.grid",),
        native="absent", costs={"box grid": {"solver.grid": "box"}},
    ),
    Effect(
        "inextensible", "stretch", Given("cable.inextensible"), ("cable.inextensible",), models=(CHAIN,), grids=(BOX,), told_to_peers=True,
        remedy='Set solver.grid = "box", or raise axial_stiffness.', parameters=("cable.inextensible",), native="absent", inverse=True,
        costs={"box grid, inextensible": {"solver.grid": "box", "cable.inextensible": True}},
    ),
    Effect(
        "slack", "slack (no compression)", ~Given("cable.compressible"), ("cable.compressible",), models=(CHAIN,), grids=(STAGGERED,),
        asked=Given("cable.compressible") | Changed("solver.slack_smoothing") | Changed("solver.slack_damping"),
        instead="the box grid uses the linear law", numbers=("solver.slack_smoothing", "solver.slack_damping"),
        parameters=("cable.compressible",), told_to_peers=True, costs={"linear law instead of slack": {"cable.compressible": True}},
    ),
    Effect(
        "seabed", "seabed", Given("seabed.stiffness"), ("seabed.stiffness",), models=(CHAIN,), grids=(STAGGERED,),
        numbers=("seabed.level", "seabed.stiffness", "seabed.damping_ratio"), costs={"seabed": _SEABED},
    ),
    Effect(
        "slope", "seabed that slopes", Given("seabed.slope"), ("seabed.slope",), needs=("seabed",), models=(CHAIN,), grids=(STAGGERED,),
        numbers=("seabed.slope", "seabed.slope_direction"), left_out={"seabed.slope": 0.0, "seabed.slope_direction": 0.0},
        costs={"seabed that slopes": {**_SEABED, "seabed.slope": 0.05}},
    ),
    Effect(
        "relief", "seabed by heights", Given("seabed.profile") | Given("seabed.grid"), ("seabed.profile", "seabed.grid"),
        needs=("seabed",), models=(CHAIN,), grids=(STAGGERED,), table=tables.relief, native="absent",
        costs={"seabed by a profile": {**_SEABED, "seabed.level": 0.0, "seabed.profile": [[-1.0, -1.8], [0.0, -1.75], [1.0, -1.8]]}},
    ),
    Effect(
        "friction", "friction along the seabed", Given("seabed.friction_coefficient"), ("seabed.friction_coefficient",), needs=("seabed",),
        models=(CHAIN,), grids=(STAGGERED,),
        numbers=("seabed.friction_coefficient", "seabed.friction_displacement", "seabed.friction_velocity"),
        left_out={"seabed.friction_coefficient": 0.0, "seabed.laid_from_anchor": False},
        costs={"seabed and friction": {**_SEABED, "seabed.friction_coefficient": 0.3}},
    ),
    Effect(
        "laid", "cable laid out from its anchor", Given("seabed.laid_from_anchor"), ("seabed.laid_from_anchor",),
        needs=("seabed", "friction"), models=(CHAIN,), grids=(STAGGERED,), part=False,
        numbers=("seabed.laid_from_anchor",), left_out={"seabed.laid_from_anchor": False},
    ),
    Effect(
        "host", "mass of the host", Given("host.mass"), ("host.mass",), part=False, told_to_peers=True, numbers=("host.mass",),
        left_out={"host.mass": 0.0},
    ),
    Effect(
        "winch", "winch", Given("winch.fitted"), ("winch.fitted",), models=(CHAIN,), grids=(STAGGERED,), parameters=("winch.fitted",),
        costs={"winch": {"winch.fitted": True}},
    ),
    Effect(
        "curve", "table of the axial stiffness", Given("cable.stiffness_curve"), ("cable.stiffness_curve",), models=(CHAIN,),
        grids=(STAGGERED,), table=tables.stiffness_curve, native="absent", left_out={"cable.stiffness_curve": ()},
        costs={"table of the axial stiffness": {"cable.stiffness_curve": _CURVE}},
    ),
    Effect(
        "sections", "joints in the cable", Given("cable.section") | Given("cable.body"), ("cable.section", "cable.body"),
        models=(CHAIN,), grids=(STAGGERED,), table=tables.sections, native="absent", costs={"two sections": {"cable.section": _SECTIONS}},
    ),
    Effect(
        "line_bodies", "bodies on the cable", Given("cable.body"), ("cable.body",), models=(CHAIN,), grids=(STAGGERED,),
        table=tables.line_bodies, native="absent", costs={"a body on the cable": {"cable.body": [{"at": 0.875, "mass": 0.05}]}},
    ),
    Effect(
        "parting", "parting", Given("parting.time") | Given("parting.by_input") | Given("cable.breaking_tension"),
        ("parting.time", "parting.by_input", "cable.breaking_tension"), models=(CHAIN,), grids=(STAGGERED,),
        numbers=("cable.breaking_tension", "parting.time", "parting.place", "parting.by_input"),
        left_out={"cable.breaking_tension": 0.0, "parting.time": 0.0, "parting.place": 0.0, "parting.by_input": False},
        costs={"a cable that may part": {"cable.breaking_tension": 1e9}},
    ),
    Effect(
        "cable_mass", "cable mass", Given("tow.cable_mass"), ("tow.cable_mass",), models=(TOW,), asked=~Given("tow.cable_mass"),
        parameters=("tow.cable_mass",),
    ),
    Effect(
        "tension_floor", "tension floor", None, ("tow.minimum_tension",), models=(TOW,), asked=Given("tow.minimum_tension"),
        numbers=("tow.minimum_tension",), native="present",
    ),
    Effect(
        "thinning", "thinning under stretch", Given("tow.poisson_ratio"), ("tow.poisson_ratio",), models=(TOW,), part=False,
        numbers=("tow.poisson_ratio", "tow.reference_tension"),
    ),
    Effect(
        "as_printed", "the report's misprints", Given("tow.as_printed"), ("tow.as_printed",), models=(TOW,), parameters=("tow.as_printed",),
    ),
    Effect(
        "audit", "audit of energy and momentum", Given("solver.audit"), ("solver.audit",), models=(CHAIN,), grids=(STAGGERED,),
        parameters=("solver.audit",), native="absent", told_to_peers=True, left_out={"solver.audit": False},
        costs={"audit": {"solver.audit": True}},
    ),
)  # fmt: skip

# numbers that are no effect's, which a model asks for in any case; `top.motion_order` is the one that kernels do not get
SETTINGS: Mapping[str, tuple[str, ...]] = {
    "top.motion_order": (CHAIN, TOW),
    "top.inputs_at": (CHAIN, TOW),
    "cable.length": (CHAIN, TOW),
    "cable.mass_per_length": (CHAIN, TOW),
    "cable.axial_stiffness": (CHAIN, TOW),
    "environment.gravity": (CHAIN, TOW),
    "solver.nodes": (CHAIN,),
    "solver.grading": (CHAIN,),
    "solver.time_step": (CHAIN, TOW),
    "solver.lambda_infinity": (CHAIN,),
    "solver.integrator": (CHAIN,),
    "solver.tolerance": (CHAIN, TOW),
    "tow.drag_segments": (TOW,),
    "tow.added_mass_vertical": (TOW,),
    "tow.drag_area_axial": (TOW,),
    "tow.body_angle": (TOW,),
    "tow.explicit": (TOW,),
}
INSTEAD = {"tow.added_mass_vertical": "body.added_mass"}  # what takes the place of a negative value

# -- what derives from it without a scene

BY_NAME = {effect.name: effect for effect in EFFECTS}
PARTS = tuple(effect.name for effect in EFFECTS if effect.part)
GOING = tuple(effect.name for effect in EFFECTS if effect.goes)  # parts that a cable that has parted is without
Parts: Any = parts_type(PARTS)  # what a problem has, see kernels.parts


def _by_part(names: list[str]) -> Mapping[str, list[str]]:
    """The keys of dotted names by their first word, in the order of its first use."""
    order = {part: k for k, part in enumerate(dict.fromkeys(name.partition(".")[0] for name in names))}
    ordered = sorted(names, key=lambda name: order[name.partition(".")[0]])
    return {part: [name.partition(".")[2] for name in group] for part, group in itertools.groupby(ordered, lambda n: n.partition(".")[0])}


_GROUPS = _by_part([name for name in SETTINGS if name != "top.motion_order"] + [name for effect in EFFECTS for name in effect.numbers])
PARAMETERS = tuple(f"{part}.{key}" for part, keys in _GROUPS.items() for key in keys)
# kernels read p[0].cable.length; in memory one flat vector in the order of PARAMETERS, which C code fills in the native FMU
NUMBERS = np.dtype([(part, [(key, np.float64) for key in keys]) for part, keys in _GROUPS.items()], align=True)


def record(values: Mapping[str, float]) -> np.recarray:
    """The numbers of kernels, an array of one record, from values by the names of PARAMETERS (SI); what is not given is 0."""
    return np.array([float(values.get(name, 0.0)) for name in PARAMETERS]).view(NUMBERS).view(np.recarray)


def in_fmus(effect: Effect) -> tuple[str, ...]:
    """The names in scenes of an effect's FMU parameters."""
    return (*effect.numbers, *effect.parameters)


FMU_PARAMETERS = (*SETTINGS, *(name for effect in EFFECTS for name in in_fmus(effect)))
COST_CASES = {name: dict(values) for effect in EFFECTS for name, values in effect.costs.items()}


def used_by(name: str) -> tuple[str, ...]:
    """The models that ask for an FMU parameter, by its name in scenes."""
    users = {model for effect in EFFECTS if name in in_fmus(effect) for model in effect.models} | set(SETTINGS.get(name, ()))
    return tuple(model for model in (CHAIN, TOW) if model in users)


def variant(model: str, space: bool) -> Mapping[str, str]:
    """How each part is compiled into a native FMU without a baked scene."""
    kinds = {effect.name: effect.native if model in effect.models else "absent" for effect in EFFECTS if effect.part}
    return {**kinds, "space": "present", "as_printed": "absent"} if space else kinds
