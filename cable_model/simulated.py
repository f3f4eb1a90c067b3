"""What of a scene a model simulates, by the table of effects: parts and numbers for kernels, words for people, and what is refused."""

from __future__ import annotations

import functools
import math
import operator
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from cable_model.condition import CHANGED, Case, Changed, Chosen, Condition, Given, On, cases, holds, names
from cable_model.effects import BOX, BY_NAME, CHAIN, EFFECTS, INSTEAD, PARAMETERS, TOW, Effect, Parts, record
from cable_model.errors import ParameterError, refuse
from cable_model.parameters import field_of, value_of

TYPES = {CHAIN: "CableChain", TOW: "TowCable"}
ON_BOX = Given("solver.grid")


# -- conditions on a scene


def given(value: Any, unit: str) -> bool:
    """Whether a value says something: a number that is not zero, a direction that is not along x, a switch that is on, a table."""
    return abs(math.sin(value)) > 1e-9 if unit == "rad" else bool(value)


def _is_given(asked: Given, scene: Any) -> bool:
    facts, value = field_of(asked.name).metadata, value_of(scene, asked.name)
    if asked.column >= 0:
        return any(given(row[asked.column], facts["unit"].split(", ")[asked.column]) for row in value)
    return value != facts["choices"][0] if facts["choices"] else given(value, facts["unit"])


def true(condition: Condition, scene: Any, model: str) -> bool:
    """Whether a condition holds for a scene; effects are those of a model."""

    def leaf(asked: Condition) -> bool:
        if isinstance(asked, Given):
            return _is_given(asked, scene)
        if isinstance(asked, Chosen):
            return bool(value_of(scene, asked.name) == asked.choice)
        if isinstance(asked, Changed):
            return bool(value_of(scene, asked.name) != field_of(asked.name).default)
        assert isinstance(asked, On)
        return is_on(BY_NAME[asked.effect], scene, model)

    return holds(condition, leaf)


def when(effect: Effect, model: str) -> Condition | bool:
    """When an effect is on in a model, grid and all that it needs included; a bool where a scene decides nothing."""
    if model not in effect.models:
        return False
    terms: list[Condition] = [On(name) for name in effect.needs]
    if effect.on is not None:
        terms.append(effect.on)
    if model == CHAIN and len(effect.grids) == 1:
        terms.append(ON_BOX if effect.grids == (BOX,) else ~ON_BOX)
    return functools.reduce(operator.and_, terms) if terms else True


def is_on(effect: Effect, scene: Any, model: str) -> bool:
    """Whether a model simulates an effect in a scene."""
    asked = when(effect, model)
    return asked if isinstance(asked, bool) else true(asked, scene, model)


def literals(condition: Condition, place: Mapping[str, int], scene: Any, model: str) -> list[Case]:
    """A condition as alternatives for C: `place` are the variables by names in scenes; all else that it asks for is as in `scene`."""

    def leaf(asked: Condition) -> int | bool | Condition:
        if isinstance(asked, On):
            return when(BY_NAME[asked.effect], model)
        if isinstance(asked, Given) and asked.column < 0 and asked.name in place:
            return place[asked.name]
        if isinstance(asked, Changed) and asked.name in place:
            return CHANGED + place[asked.name]
        return true(asked, scene, model)

    return cases(condition, leaf)


# -- what kernels get


def parts_of(scene: Any, model: str) -> Any:
    """Which parts the kernels of a model ("chain" or "tow") get; absent parts are None and cost nothing.

    Raises ParameterError for an effect of the scene that the model does not have.
    """
    for error in refused_by(scene, model):
        raise error
    on = [effect for effect in EFFECTS if effect.part and is_on(effect, scene, model)]
    return Parts(**{effect.name: effect.table(scene) if effect.table else True for effect in on})


def _number(scene: Any, name: str) -> float:
    value, choices = value_of(scene, name), field_of(name).metadata["choices"]
    if name in INSTEAD and value < 0.0:
        return float(value_of(scene, INSTEAD[name]))
    return float(choices.index(value)) if choices else float(value)


def numbers_of(scene: Any) -> np.recarray:
    """The numbers of the kernels, an array of one record."""
    return record({name: _number(scene, name) for name in PARAMETERS})


# -- what is refused


def _refusal(effect: Effect, scene: Any, where: str, remedy: str, name: str = "") -> ParameterError:
    """The error of an effect; it names the value `name`, or the first that asks for it."""
    condition = asked(effect)
    changed = [name for name in names(condition) if value_of(scene, name) != field_of(name).default] if condition is not None else []
    name = name or (changed[0] if changed else decides(effect, scene))
    value, unit, default = value_of(scene, name), field_of(name).metadata["unit"], field_of(name).default
    if isinstance(value, tuple):
        return refuse(name, len(value), "rows", f"empty {where}", remedy)
    wanted = str(default).lower() if isinstance(value, bool) else str(default) if isinstance(value, str) else f"{default:g}"
    return refuse(name, value, unit, f"{wanted} {where}", remedy)


def asked(effect: Effect) -> Condition | None:
    """What a scene must not say to a model or grid that lacks the effect."""
    return effect.asked if effect.asked is not None else effect.on


def lacking(scene: Any, model: str) -> Iterator[Effect]:
    """The effects that a scene asks for and a model does not have; what has no words is a way to solve, not an effect."""
    for effect in EFFECTS:
        condition = asked(effect)
        if effect.words and model not in effect.models and condition is not None and true(condition, scene, CHAIN):
            yield effect


def refused_by(scene: Any, model: str) -> Iterator[ParameterError]:
    """The errors of the effects that a scene asks for and a model does not have."""
    for effect in lacking(scene, model):
        yield _refusal(effect, scene, f"for {TYPES[model]}", f"Use {TYPES[effect.models[0]]}.")


def refused_for_good(scene: Any, model: str) -> Iterator[ParameterError]:
    """Those of them that no scene makes sense without."""
    for effect in lacking(scene, model):
        if not effect.left_out:
            yield _refusal(effect, scene, f"for {TYPES[model]}", f"Use {TYPES[effect.models[0]]}.")


def left_out_for(scene: Any, model: str) -> tuple[list[str], dict[str, Any]]:
    """Words of the effects that a scene must leave out for a model and can, and the values, by dotted name, that leave them out."""
    effects = [effect for effect in lacking(scene, model) if effect.left_out]
    return [effect.words for effect in effects], {name: value for effect in effects for name, value in effect.left_out.items()}


def refused_on(effect: Effect, grid: str) -> Condition | None:
    """What a scene must not say to a grid; None where the grid has the effect, or something in its place, or lacks what it needs."""
    without = effect.instead or (effect.needs and effect.asked is None)
    return None if grid in effect.grids or without else asked(effect)


def grid_refusal(effect: Effect, scene: Any, grid: str, name: str = "") -> ParameterError:
    """The error of an effect on a grid that has it not, for the value `name` or the first that asks for it."""
    return _refusal(effect, scene, f"on the {grid} grid", effect.remedy, name)


def refused_on_grid(scene: Any) -> Iterator[ParameterError]:
    """The errors of the effects that a scene has and its grid has not."""
    grid = scene.solver.grid
    for effect in EFFECTS:
        condition = refused_on(effect, grid)
        if condition is not None and true(condition, scene, CHAIN):
            yield grid_refusal(effect, scene, grid)


# -- what people are told


@dataclass(frozen=True)
class Told:
    """An effect of a model as lists of effects name it."""

    name: str
    active: bool
    why: str


def decides(effect: Effect, scene: Any) -> str:
    """The name of the value that decides on an effect: the first that is given."""
    return next((name for name in effect.because if _is_given(Given(name), scene)), effect.because[-1])


def why(effect: Effect, scene: Any, model: str) -> str:
    """The value that decides on an effect, or what it needs and lacks."""
    for needed in (BY_NAME[name] for name in effect.needs):
        if needed.missing and not is_on(needed, scene, model):
            return needed.missing
    if effect.missing and getattr(scene, effect.because[0].partition(".")[0]) is None:
        return effect.missing
    if effect.instead and model == CHAIN and scene.solver.grid not in effect.grids:
        return effect.instead
    name = decides(effect, scene)
    value, unit = value_of(scene, name), field_of(name).metadata["unit"]
    if isinstance(value, tuple):
        return f"{name} has {len(value)} rows"
    if name == "waves.spectrum":
        return f"{name} = {value}, {scene.waves.components} components{', summed each time' if scene.waves.exact else ''}"
    shown = str(value).lower() if isinstance(value, bool) else value if isinstance(value, str) else f"{value:g}"
    return f"{name} = {shown} {unit if unit != '1' else ''}".rstrip()


def effects(scene: Any, model: str | None = None) -> tuple[Told, ...]:
    """Every effect of a model ("chain" or "tow") that has words, whether the scene has it, and the value that decides."""
    model = model or scene.run.model
    told: dict[str, Told] = {}
    for effect in EFFECTS:
        if effect.words and model in effect.models:
            on = is_on(effect, scene, model) != effect.inverse
            before = told.get(effect.words)
            told[effect.words] = Told(effect.words, on or (before is not None and before.active), why(effect, scene, model))
    return tuple(told.values())


def one_line(scene: Any, model: str | None = None) -> str:
    """The active effects and what switched each on, on one line for a log."""
    return "; ".join(f"{told.name} ({told.why})" for told in effects(scene, model) if told.active)


def unknowns_per_node(scene: Any, model: str | None = None) -> int:
    """Unknowns that are solved for at each node of the chain; for TowCable its degrees of freedom in all."""
    parts = parts_of(scene, model or scene.run.model)
    if (model or scene.run.model) == TOW:
        return 3 if parts.space is not None else 2
    if parts.box is not None:
        return 6 if parts.bending is not None else 4
    return 3 if parts.space is not None else 2
