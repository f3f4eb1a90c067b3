"""The XML of an FMU, from the interface table alone: modelDescription.xml and OspModelDescription.xml.  No models, no pythonfmu."""

from __future__ import annotations

import datetime
import math
import os
import re
import sys
from collections.abc import Sequence
from xml.etree.ElementTree import Element, SubElement

from cable_model import __version__
from cable_model.errors import refuse
from cable_model.scene import Scene
from fmu_src.interface import Variable

AUTHOR = "The cable-fmu contributors"
DISPLAYED = {"rad": ("deg", math.degrees(1.0))}  # what people read instead of a unit, and how many of it that is
FIXED_STEP_TOLERANCE = 1e-3  # of the default experiment where solver.tolerance is 0: FMI wants one above it
_DERIVED = {"1": {}, "N": {"kg": 1, "m": 1, "s": -2}, "J": {"kg": 1, "m": 2, "s": -2}, "Pa": {"kg": 1, "m": -1, "s": -2}}


def base_units(unit: str) -> dict[str, int]:
    """Exponents of the SI base units in a unit such as "kg/m3" or "N.m2": factors joined by dots, and one slash at most."""
    exponents: dict[str, int] = {}
    above, _, below = unit.partition("/")
    for sign, factors in ((1, above), (-1, below)):
        for symbol, power in re.findall(r"([A-Za-z]+|1)(\d*)", factors):
            for base, exponent in _DERIVED.get(symbol, {symbol: 1}).items():
                exponents[base] = exponents.get(base, 0) + sign * exponent * int(power or 1)
    return {base: exponent for base, exponent in exponents.items() if exponent}


LOG_CATEGORIES = {
    "logStatusWarning": "messages with the status warning",
    "logStatusDiscard": "messages with the status discard",
    "logStatusError": "messages with the status error",
    "logStatusFatal": "messages with the status fatal",
    "logAll": "all messages",
}

_INITIAL = {"input": None, "output": "calculated", "local": "calculated", "parameter": "exact"}
_OSP_NAMESPACE = "https://open-simulation-platform.com/OspModelDescription/1.0.0"


def epoch_of(date: str) -> int:
    """SOURCE_DATE_EPOCH of a date as in ISO 8601, in UTC where it names no zone, or of "now".  Raises ParameterError."""
    try:
        moment = datetime.datetime.now(datetime.UTC) if date == "now" else datetime.datetime.fromisoformat(date)
    except ValueError:
        moment = datetime.datetime(1, 1, 1)
    moment = moment if moment.tzinfo else moment.replace(tzinfo=datetime.UTC)
    if not 1980 <= moment.year < 2100:
        raise refuse("date", date, "", "a date from 1980 to 2099 as in 2026-05-31 or 2026-05-31T12:00:00Z, or 'now'", "Write it so.")
    return int(moment.timestamp())


def generation_date() -> str:
    """SOURCE_DATE_EPOCH, or the first date that a zip archive can hold: the same input gives the same bytes."""
    seconds = int(os.environ.get("SOURCE_DATE_EPOCH", "315532800"))
    return datetime.datetime.fromtimestamp(seconds, datetime.UTC).strftime("%Y-%m-%dT%H:%M:%SZ")


def text(value: float | int | bool) -> str:
    """A number as XML writes it; floats survive the way back."""
    return str(value).lower() if isinstance(value, bool) else repr(value)


def least(row: Variable) -> float | int | None:
    """The least value that a variable takes: FMI's min is a bound that is reached.  Above 0: the smallest number that is not denormal."""
    if row.minimum is None or not row.minimum_excluded:
        return row.minimum
    return sys.float_info.min if row.minimum == 0.0 else math.nextafter(row.minimum, math.inf)


def _scalar_variable(reference: int, row: Variable) -> Element:
    facts = {"name": row.name, "valueReference": str(reference), "description": row.description}
    facts |= {"causality": row.causality, "variability": row.variability}
    if _INITIAL[row.causality] is not None:
        facts["initial"] = str(_INITIAL[row.causality])
    element = Element("ScalarVariable", facts)
    kind = SubElement(element, row.kind)
    if row.unit:
        kind.set("unit", row.unit)
    if row.unit in DISPLAYED:
        kind.set("displayUnit", DISPLAYED[row.unit][0])
    for attribute, value in (("min", least(row)), ("max", row.maximum), ("nominal", row.nominal), ("start", row.start)):
        if value is not None:
            kind.set(attribute, text(value))
    return element


def _unit_definitions(rows: Sequence[Variable]) -> Element:
    definitions = Element("UnitDefinitions")
    for unit in sorted({row.unit for row in rows if row.unit}):
        element = SubElement(definitions, "Unit", name=unit)
        SubElement(element, "BaseUnit", {base: str(power) for base, power in base_units(unit).items()})
        if unit in DISPLAYED:
            name, factor = DISPLAYED[unit]
            SubElement(element, "DisplayUnit", name=name, factor=text(factor))
    return definitions


def _structure(rows: Sequence[Variable]) -> Element:
    """Outputs after a step depend on the state alone; while initialization lasts, on inputs and parameters."""
    structure = Element("ModelStructure")
    outputs, initial = SubElement(structure, "Outputs"), SubElement(structure, "InitialUnknowns")
    parameters = [index for index, row in enumerate(rows, start=1) if row.causality == "parameter"]
    for index, row in enumerate(rows, start=1):
        if row.causality == "output":
            SubElement(outputs, "Unknown", index=str(index), dependencies="")
            inputs = [place for place, known in enumerate(rows, start=1) if known.name in row.starts_from]
            known = inputs + parameters if inputs else []
            SubElement(initial, "Unknown", index=str(index), dependencies=" ".join(map(str, known)))
    return structure


def model_description(
    identifier: str, guid: str, rows: Sequence[Variable], scene: Scene, description: str, tool: str, interpolates: bool = False
) -> Element:
    """modelDescription.xml of an FMI 2.0 co-simulation FMU with the interface `rows` and the default experiment of `scene`.

    interpolates: whether derivatives of inputs may be set.
    """
    root = Element(
        "fmiModelDescription",
        fmiVersion="2.0", modelName=identifier, guid=guid, description=description, author=AUTHOR, version=__version__, license="MIT",
        generationTool=tool, generationDateAndTime=generation_date(), variableNamingConvention="structured",
    )  # fmt: skip
    SubElement(
        root, "CoSimulation",
        modelIdentifier=identifier, needsExecutionTool="false", canHandleVariableCommunicationStepSize="true",
        canInterpolateInputs=str(interpolates).lower(), canBeInstantiatedOnlyOncePerProcess="false",
        canNotUseMemoryManagementFunctions="true", canGetAndSetFMUstate="true", canSerializeFMUstate="true",
    )  # fmt: skip
    root.append(_unit_definitions(rows))
    categories = SubElement(root, "LogCategories")
    for name, meaning in LOG_CATEGORIES.items():
        SubElement(categories, "Category", name=name, description=meaning)
    SubElement(
        root, "DefaultExperiment",
        startTime="0.0", stopTime=text(scene.run.duration), tolerance=text(scene.solver.tolerance or FIXED_STEP_TOLERANCE),
        stepSize=text(scene.run.output_step),
    )  # fmt: skip
    variables = SubElement(root, "ModelVariables")
    for reference, row in enumerate(rows):
        variables.append(_scalar_variable(reference, row))
    root.append(_structure(rows))
    return root


def osp_description() -> Element:
    """OspModelDescription.xml [OSP-IS]: both ends as linear mechanical ports, their places and the body's place and velocity as groups."""
    root = Element("OspModelDescription", xmlns=_OSP_NAMESPACE, version="1.0")
    groups = SubElement(root, "VariableGroups")
    for end in ("top", "lower"):
        port = SubElement(groups, "LinearMechanicalPort", name=end)
        _group(port, "Force", f"{end}.force", f"{end}.force_")
        _group(port, "LinearVelocity", f"{end}.velocity", f"{end}.v")
        _group(groups, "LinearDisplacement", f"{end}.position", f"{end}.")
    _group(groups, "LinearDisplacement", "body.position", "body.")
    _group(groups, "LinearVelocity", "body.velocity", "body.v")
    return root


def _group(parent: Element, kind: str, name: str, prefix: str) -> None:
    group = SubElement(parent, kind, name=name)
    for axis in "xyz":
        SubElement(group, "Variable", ref=prefix + axis)
