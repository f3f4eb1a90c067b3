"""FMI 3.0 of a native FMU: its variables, modelDescription.xml and terminals, from the interface table and the XML of FMI 2.0."""

from __future__ import annotations

import dataclasses
from collections.abc import Sequence
from xml.etree.ElementTree import Element, SubElement

from cable_model.facts import facts_of
from cable_model.scene import Scene
from cable_model.signals import SHAPE, SHAPE_POINTS
from fmu_src import model_description as fmi2
from fmu_src.interface import Variable

KINDS = {"Real": "Float64", "Integer": "Int32", "Boolean": "Boolean", "String": "String"}  # types of FMI 2.0 and 3.0
ARRAYS = tuple(dict.fromkeys(name.partition("[")[0] for name in SHAPE))  # of SHAPE_POINTS elements each
TIME = Variable("time", "independent", "continuous", "Real", *facts_of("time")[:2])


def _whole(row: Variable) -> Variable:
    """An array's row from that of its first element."""
    text = row.description.replace(f"point 1 of {SHAPE_POINTS}", f"{SHAPE_POINTS} points")
    return dataclasses.replace(row, name=row.name.removesuffix("[1]"), description=text)


def _variables(rows: Sequence[Variable]) -> dict[int, Variable]:
    """The variables but the time by their value references: those of FMI 2.0; an array has that of its first element."""
    wanted = {place: row for place, row in enumerate(rows) if row.name not in SHAPE or row.name.endswith("[1]")}
    return {place: _whole(row) if row.name in SHAPE else row for place, row in wanted.items()}


def variables(rows: Sequence[Variable]) -> list[Variable]:
    """All variables with their types by FMI 3.0's names, from the interface table."""
    return [dataclasses.replace(row, kind=KINDS[row.kind]) for row in (*_variables(rows).values(), TIME)]


def model_description(identifier: str, token: str, rows: Sequence[Variable], scene: Scene, description: str, tool: str) -> Element:
    """modelDescription.xml of an FMI 3.0 co-simulation FMU; arguments as those of FMI 2.0's."""
    kept = _variables(rows)
    references = [str(reference) for reference in kept]
    old = fmi2.model_description(identifier, token, list(kept.values()), scene, description, tool)
    parts = {part.tag: part for part in old}
    facts = {("instantiationToken" if name == "guid" else name): value for name, value in old.items()}
    root = Element("fmiModelDescription", facts | {"fmiVersion": "3.0"})
    SubElement(
        root, "CoSimulation",
        modelIdentifier=identifier, needsExecutionTool="false", canBeInstantiatedOnlyOncePerProcess="false",
        canGetAndSetFMUState="true", canSerializeFMUState="true", canHandleVariableCommunicationStepSize="true",
    )  # fmt: skip
    root.extend([parts[name] for name in ("UnitDefinitions", "LogCategories", "DefaultExperiment")])
    made = SubElement(root, "ModelVariables")
    for reference, variable in zip(references, parts["ModelVariables"], strict=True):
        (kind,) = variable
        element = SubElement(made, KINDS[kind.tag], {**variable.attrib, "valueReference": reference, **kind.attrib})
        if variable.get("name") in ARRAYS:
            SubElement(element, "Dimension", start=str(SHAPE_POINTS))
    common = {"causality": TIME.causality, "variability": TIME.variability, "unit": TIME.unit, "description": TIME.description}
    SubElement(made, KINDS[TIME.kind], {"name": TIME.name, "valueReference": str(len(rows)), **common})
    structure = SubElement(root, "ModelStructure")
    for group, tag in (("Outputs", "Output"), ("InitialUnknowns", "InitialUnknown")):
        for unknown in parts["ModelStructure"].iterfind(f"{group}/Unknown"):
            own, *known = (references[int(index) - 1] for index in (unknown.attrib["index"], *unknown.attrib["dependencies"].split()))
            SubElement(structure, tag, valueReference=own, dependencies=" ".join(known))
    return root


def terminals() -> Element:
    """terminalsAndIcons.xml: force, position and velocity of each end, and where the icon lies."""
    root = Element("fmiTerminalsAndIcons", fmiVersion="3.0")
    picture, corners = SubElement(root, "GraphicalRepresentation"), {"x1": "-100", "y1": "-100", "x2": "100", "y2": "100"}
    SubElement(picture, "CoordinateSystem", corners | {"suggestedScalingFactorTo_mm": "0.1"})
    SubElement(picture, "Icon", corners)
    ends = SubElement(root, "Terminals")
    for end, words in (("top", "top"), ("lower", "lower end (needs lower_end.driven)")):
        # "bus": a host may connect fewer members, as positions alone
        text = f"{words}: motion, and the force of the cable on its attachment"
        terminal = SubElement(ends, "Terminal", name=end, matchingRule="bus", description=text)
        for member in (f"{kind}{axis}" for kind in ("force_", "", "v") for axis in "xyz"):
            SubElement(terminal, "TerminalMemberVariable", variableName=f"{end}.{member}", memberName=member, variableKind="signal")
    return root
