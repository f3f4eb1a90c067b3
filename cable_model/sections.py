"""Sections of a cable and bodies on it: what sections take from [cable], and what the cable is on the whole, which scales read."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from cable_model.errors import ParameterError, refuse
from cable_model.kernels.header import CELLS_OF_A_SECTION
from cable_model.parameters import Cable, Section
from cable_model.quantity import build

SHARED = tuple(field.name for field in dataclasses.fields(Section) if field.name != "length")
CLOSE = 1e-9  # of a value: what it may differ by from that of the sections, which is summed
SAME_PLACE = 1e-6  # of the length: bodies nearer to one another, or to a joint, are in one place


def whole(sections: Sequence[Section]) -> dict[str, float]:
    """What a cable of these sections is on the whole, by the names of Section.

    Mass, weight, volume, drag and added mass per length are means, the stiffness stretches as all sections do in series; of diameter,
    bending and damping it has the largest, of the tensions at which they break the least.
    """
    lengths = np.array([section.length for section in sections])
    length = float(lengths.sum())

    def mean(values: Sequence[float]) -> float:
        return float(lengths @ values) / length

    diameter = max(section.diameter for section in sections)
    wide = np.array([section.diameter / diameter if diameter > 0.0 else 0.0 for section in sections])
    return {
        "length": length,
        "mass_per_length": mean([section.mass_per_length for section in sections]),
        "axial_stiffness": 1.0 / mean([1.0 / section.axial_stiffness for section in sections]),
        "diameter": diameter,
        "bending_stiffness": max(section.bending_stiffness for section in sections),
        "axial_damping": max(section.axial_damping for section in sections),
        "normal_drag_coefficient": mean([section.normal_drag_coefficient for section in sections] * wide),
        "tangential_drag_coefficient": mean([section.tangential_drag_coefficient for section in sections] * wide),
        "added_mass_coefficient": mean([section.added_mass_coefficient for section in sections] * wide**2),
        "volume_per_length": mean([section.displaced_area for section in sections]),
        "breaking_tension": min((section.breaking_tension for section in sections if section.breaking_tension > 0.0), default=0.0),
    }


def joined(cable: Mapping[str, Any]) -> dict[str, Any]:
    """The values of [cable] with its sections made whole: each has what it does not give itself from [cable], which gets theirs.

    Raises ParameterError for a value of [cable] that no section takes.
    """
    given = cable["section"]
    if not isinstance(given, list | tuple):
        raise refuse("cable.section", given, "", "a list of tables", "Write each as [[cable.section]].")
    rows = [dataclasses.asdict(row) if isinstance(row, Section) else row for row in given]
    common = {name: cable[name] for name in SHARED if name in cable}
    sections = [
        build(Section, {**common, **row} if isinstance(row, dict) else row, f"cable.section[{k}]") for k, row in enumerate(rows)
    ]  # fmt: skip
    of_all = whole(sections)
    for name, value in common.items():
        if all(name in row for row in rows) and not _close(value, of_all[name]):
            raise ParameterError(f"cable.{name}: every section has its own. Remove it from [cable], or from the sections that share it.")
    must = f"{of_all['length']:g}, that of its sections"
    if "length" in cable and not _close(cable["length"], of_all["length"]):
        raise refuse("cable.length", cable["length"], "m", must, "Remove it, or mend the sections.")
    return {**cable, **of_all, "section": tuple(sections)}


def _close(value: Any, other: float) -> bool:
    return isinstance(value, int | float) and abs(value - other) <= CLOSE * abs(other)


def pieces(cable: Cable) -> tuple[list[Section], list[int]]:
    """The cable in pieces that are alike, from the lower end up, cut where bodies are; and for each body the piece above it."""
    names = [field.name for field in dataclasses.fields(Section)]
    left = list(cable.section) or [Section(**{name: getattr(cable, name) for name in names})]
    made: list[Section] = []
    joints = [0.0]
    for at in [*sorted({body.at for body in cable.body}), math.inf]:
        while left:
            rest = at - joints[-1]
            if rest <= SAME_PLACE * cable.length:
                break
            piece = left.pop(0)
            if piece.length - rest > SAME_PLACE * cable.length:
                left.insert(0, dataclasses.replace(piece, length=piece.length - rest))
                piece = dataclasses.replace(piece, length=rest)
            made.append(piece)
            joints.append(joints[-1] + piece.length)
    return made, [int(np.argmin(np.abs(np.array(joints) - body.at))) for body in cable.body]


def fewest_cells(cable: Cable) -> int:
    """Cells that a chain needs for the cable's joints and bodies."""
    return CELLS_OF_A_SECTION * len(pieces(cable)[0]) if cable.section or cable.body else 1


def check(cable: Cable, nodes: int, meets: bool) -> None:
    """Raises the ParameterError of sections or bodies that a chain of so many nodes cannot have; `meets`: water or a seabed is there."""
    if cable.section:
        for name, value in whole(cable.section).items():
            if not _close(getattr(cable, name), value):
                raise refuse(f"cable.{name}", getattr(cable, name), "", f"{value:g}, that of its sections", "Change the sections.")
    for k, body in enumerate(cable.body):
        if not SAME_PLACE * cable.length < body.at < (1.0 - SAME_PLACE) * cable.length:
            raise refuse(f"cable.body[{k}].at", body.at, "m", f"between 0 and cable.length = {cable.length:g}", "An end's is in [body].")
    least = fewest_cells(cable) + 1
    if nodes < least:
        count = len(pieces(cable)[0])
        raise refuse("solver.nodes", nodes, "", f">= {least} with {count} lengths of cable between joints and bodies", "Give more nodes.")
    for k, section in enumerate(cable.section):
        if meets and section.diameter == 0.0:
            raise refuse(f"cable.section[{k}].diameter", 0.0, "m", "> 0 in water or on a seabed", "Give the diameter.")


def check_clamps(cable: Any, clamps: Mapping[int, str]) -> None:
    """Raises the ParameterError of a clamp, by the place of its section and its name, on a section that does not bend."""
    for k, name in clamps.items():
        place = k % len(cable.section)
        if pieces(cable)[0][k].bending_stiffness == 0.0:
            raise refuse(name, True, "", f"false where cable.section[{place}] has no bending stiffness", "Give it some.")
