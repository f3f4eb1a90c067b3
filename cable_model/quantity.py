"""Fields of the scene's data classes: unit, rule and remedy beside each, and the one validation that reads them."""

from __future__ import annotations

import dataclasses
import functools
import math
import types
import typing
from typing import Any

from cable_model.errors import ParameterError, refuse, unknown


def quantity(
    unit: str,
    description: str,
    *,
    default: Any = dataclasses.MISSING,
    above: float | None = None,
    least: float | None = None,
    most: float | None = None,
    gap: tuple[float, float] | None = None,
    choices: tuple[str, ...] | None = None,
    remedy: str = "",
) -> Any:
    """A data-class field in the given unit; `above` excludes its bound, `least` and `most` include theirs; a `gap` is out."""
    facts = {
        "unit": unit, "description": description, "above": above, "least": least, "most": most, "gap": gap, "choices": choices,
        "remedy": remedy,
    }  # fmt: skip
    if isinstance(default, list | dict):
        raise TypeError("a default must not be mutable")
    return dataclasses.field(default=default, metadata=facts)


def rule_of(facts: typing.Mapping[str, Any]) -> str:
    """What a number must be, by the metadata of its field."""
    parts = []
    if facts["above"] is not None:
        parts.append(f"> {facts['above']:g}")
    if facts["gap"] is not None:
        parts.append("{:g} or >= {:g}".format(*facts["gap"]))
    elif facts["least"] is not None:
        parts.append(f">= {facts['least']:g}")
    if facts["most"] is not None:
        parts.append(f"<= {facts['most']:g}")
    return " and ".join(parts) or "a finite number"


def _asked_for(description: str) -> str:
    return f"Say {description}." if description.startswith(("whether ", "where ")) else f"Give the {description}."


def _number(name: str, value: Any, facts: typing.Mapping[str, Any], whole: bool) -> float | int:
    remedy = facts["remedy"] or _asked_for(facts["description"])
    kind = "a whole number" if whole else "a number"
    if isinstance(value, bool) or not isinstance(value, int | float):
        raise refuse(name, value, facts["unit"], kind, remedy)
    try:
        finite = math.isfinite(value)
    except OverflowError:  # a whole number that no float holds
        raise refuse(name, value, facts["unit"], "below 1.8e308", remedy) from None
    if not finite:
        raise refuse(name, float(value), facts["unit"], "finite", remedy)
    if whole and value != int(value):
        raise refuse(name, float(value), facts["unit"], kind, remedy)
    low = (facts["above"] is not None and not value > facts["above"]) or (facts["least"] is not None and value < facts["least"])
    between = facts["gap"] is not None and facts["gap"][0] < value < facts["gap"][1]
    if low or between or (facts["most"] is not None and value > facts["most"]):
        raise refuse(name, value, facts["unit"], rule_of(facts), remedy)
    return int(value) if whole else float(value)


def _checked(name: str, value: Any, kind: Any, facts: typing.Mapping[str, Any]) -> Any:
    remedy = facts["remedy"] or _asked_for(facts["description"])
    if kind is float or kind is int:
        return _number(name, value, facts, kind is int)
    if kind is bool:
        if not isinstance(value, bool):
            raise refuse(name, value, facts["unit"], "true or false", remedy)
        return value
    if kind is str:
        if not isinstance(value, str):
            raise refuse(name, value, facts["unit"], "a text", remedy)
        if facts["choices"] and value not in facts["choices"]:
            raise refuse(name, value, facts["unit"], "one of " + ", ".join(facts["choices"]), remedy)
        return value
    origin = typing.get_origin(kind)
    if origin is tuple:
        if not isinstance(value, list | tuple):
            raise refuse(name, value, facts["unit"], "a list", remedy)
        inner = typing.get_args(kind)
        if inner[-1] is not Ellipsis and len(value) != len(inner):
            raise refuse(name, list(value), facts["unit"], f"a list of {len(inner)}", remedy)
        kinds = [inner[0]] * len(value) if inner[-1] is Ellipsis else list(inner)
        return tuple(_checked(f"{name}[{i}]", x, k, facts) for i, (x, k) in enumerate(zip(value, kinds, strict=True)))
    raise TypeError(f"{name}: no check for {kind}")


@functools.cache
def types_of(kind: type) -> dict[str, Any]:
    """The types of a data class's fields by name."""
    return typing.get_type_hints(kind)


def build(kind: type, values: typing.Mapping[str, Any], prefix: str = "") -> Any:
    """Make the frozen data class `kind` from a mapping, checking every value; unknown keys name the nearest known one."""
    if not isinstance(values, dict):
        raise refuse(prefix or kind.__name__, values, "", "a table", "Write it as [" + prefix + "].")
    hints = types_of(kind)
    fields = {f.name: f for f in dataclasses.fields(kind)}
    dotted = prefix + "." if prefix else ""
    for key in values:
        if key not in fields:
            error = unknown(dotted + key, [dotted + name for name in fields])
            raise error
    made: dict[str, Any] = {}
    for name, field in fields.items():
        if name not in values:
            if field.default is dataclasses.MISSING and field.default_factory is dataclasses.MISSING:
                raise ParameterError(f"{dotted}{name}: missing. Give the {field.metadata.get('description', name)}.")
            continue
        made[name] = _field(dotted + name, values[name], hints[name], field)
    return kind(**made)


def _field(name: str, value: Any, kind: Any, field: dataclasses.Field) -> Any:
    if isinstance(kind, types.UnionType):  # an optional part
        kind = next(k for k in typing.get_args(kind) if k is not types.NoneType)
    if dataclasses.is_dataclass(kind):
        part = typing.cast(type, kind)
        return value if isinstance(value, part) else build(part, value, name)
    args = typing.get_args(kind)
    if typing.get_origin(kind) is tuple and args and dataclasses.is_dataclass(args[0]):
        if not isinstance(value, list | tuple):
            raise refuse(name, value, "", "a list of tables", f"Write each as [[{name}]].")
        row = typing.cast(type, args[0])
        return tuple(x if isinstance(x, row) else build(row, x, f"{name}[{i}]") for i, x in enumerate(value))
    return _checked(name, value, kind, field.metadata)
