"""Reads MoorDyn's input file, version 2: its sections as rows of words, and the types, points and lines in them.  No physics.

The form is that of MoorDyn's documentation (docs/inputs.rst of its repository, "The V2 Input File"): sections begin with a line that has
"---" and their name; tables have a row of names and a row of units, which are not read: values go by their place.
"""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TypeVar

from cable_model.errors import ParameterError

TYPES, POINTS, LINES, OPTIONS, OUTPUTS = "LINE TYPES", "POINTS", "LINES", "OPTIONS", "OUTPUTS"
_NAMES = {  # what MoorDyn finds in the head of a section, longest first where one is in another
    TYPES: ("LINE TYPES", "LINE DICTIONARY"),
    "ROD TYPES": ("ROD TYPES", "ROD DICTIONARY"),
    "BODIES": ("BODIES", "BODY LIST", "BODY PROPERTIES"),
    "RODS": ("RODS", "ROD LIST", "ROD PROPERTIES"),
    POINTS: ("POINTS", "POINT LIST", "POINT PROPERTIES", "CONNECTION PROPERTIES", "NODE PROPERTIES"),
    LINES: ("LINES", "LINE LIST", "LINE PROPERTIES"),
    OPTIONS: ("OPTIONS",),
    OUTPUTS: ("OUTPUT",),
}
_WITHOUT_HEADS = (OPTIONS, OUTPUTS)
_ALIASES = {  # other names of options
    "dt": "dtm", "gravity": "g", "wtrdnsty": "rho", "kb": "kbot", "cb": "cbot", "icdt": "dtic", "ictmax": "tmaxic", "icdfac": "cdscaleic",
    "icthresh": "threshic", "gendynamicic": "icgendynamic", "icfile": "fileic",
}  # fmt: skip
_FIXED = ("ANCHOR", "FIXED", "FIX")
_COUPLED = ("FAIRLEAD", "VESSEL", "VES", "COUPLED", "CPLD")
_FREE = ("POINT", "CONNECT", "CON", "FREE")
_Made = TypeVar("_Made")
FIXED, COUPLED, FREE = "fixed", "coupled", "free"
_KINDS = dict.fromkeys(_FIXED, FIXED) | dict.fromkeys(_COUPLED, COUPLED) | dict.fromkeys(_FREE, FREE)


@dataclass(frozen=True)
class Row:
    """The words of one line of the file; errors name both."""

    file: str
    number: int
    words: tuple[str, ...]

    def refused(self, what: str) -> ParameterError:
        return ParameterError(f"{self.file}, row {self.number}: {what}")

    def word(self, place: int, name: str) -> str:
        """The word at a place that counts from 0.  Raises ParameterError where the row is shorter."""
        if place >= len(self.words):
            raise self.refused(f"{name} is missing, column {place + 1} of {len(self.words)}. Complete the row as in MoorDyn v2.")
        return self.words[place]

    def number_of(self, word: str, name: str) -> float:
        """The number that a word of the row is.  Raises ParameterError for anything else."""
        try:
            value = float(word)
        except ValueError:
            value = math.nan
        if not math.isfinite(value):
            raise self.refused(f"{name} = {word!r}: must be a number. Mend it.")
        return value

    def number_at(self, place: int, name: str) -> float:
        """The number at a place.  Raises ParameterError for anything else."""
        return self.number_of(self.word(place, name), name)

    def positive_of(self, word: str, name: str) -> float:
        """The number above 0 that a word of the row is.  Raises ParameterError for anything else."""
        value = self.number_of(word, name)
        if not value > 0.0:
            raise self.refused(f"{name} = {word}: must be > 0. Mend it.")
        return value

    def whole_at(self, place: int, name: str) -> int:
        """The whole number at a place.  Raises ParameterError for anything else."""
        value = self.number_at(place, name)
        if value != int(value):
            raise self.refused(f"{name} = {self.words[place]!r}: must be a whole number. Mend it.")
        return int(value)


@dataclass(frozen=True)
class Point:
    """A row of POINTS: `place` (m) and `force` (N) are (3,), `kind` is FIXED, COUPLED, FREE or the word that stands there."""

    row: Row
    number: int
    kind: str
    place: tuple[float, float, float]
    mass: float  # kg
    volume: float  # m3
    drag_area: float  # m2
    added_mass_coefficient: float
    force: tuple[float, float, float]


@dataclass(frozen=True)
class Line:
    """A row of LINES; its ends are words, as "R1A" is the end of a rod."""

    row: Row
    type: str
    ends: tuple[str, str]  # A and B
    length: float  # m, unstretched
    segments: int
    outputs: str

    @property
    def numbers(self) -> list[int | None]:
        """The numbers of the points that its ends are on, None where one is on something else."""
        found = [re.fullmatch(r"(?:C|CON|P|POINT)?(\d+)", word.upper()) for word in self.ends]
        return [int(match[1]) if match else None for match in found]


@dataclass(frozen=True)
class Deck:
    """An input file: types as rows by name, points and lines by number, options as rows by MoorDyn's first names, in small letters."""

    path: Path
    title: str
    types: Mapping[str, Row]
    points: Mapping[int, Point]
    lines: Mapping[int, Line]
    options: Mapping[str, Row]
    channels: Sequence[str]
    others: Mapping[str, Sequence[Row]]  # sections that are not among these, by name

    def points_of(self, line: Line) -> tuple[int, int]:
        """The numbers of the points at the ends A and B of a line.  Raises ParameterError where one is no point."""
        for end, word, number in zip("AB", line.ends, line.numbers, strict=True):
            if number is None:
                raise line.row.refused(f"end {end} is on {word!r}: must be a point. Put a coupled, fixed or free point there.")
            if number not in self.points:
                raise line.row.refused(f"point {number} is unknown: known are {', '.join(map(str, self.points))}. Give one of them.")
        a, b = (int(number) for number in line.numbers if number is not None)
        return a, b

    def held_by(self, point: int) -> list[int]:
        """The lines that end on a point."""
        return [number for number, line in self.lines.items() if point in line.numbers]


def _section(head: str) -> str:
    """The name of the section that a line with "---" begins; an unknown one's own words."""
    upper = head.upper()
    return next((name for name, words in _NAMES.items() if any(word in upper for word in words)), head.strip("- \t").upper())


def _sections(path: Path) -> tuple[str, dict[str, list[Row]]]:
    """The title above the first section, and the rows of every section by its name."""
    title: list[str] = []
    found: dict[str, list[Row]] = {}
    rows, skipped = None, 0
    # a byte that is no UTF-8, such as a cube sign of another code page, is in a unit or a remark: numbers and names are ASCII
    for number, text in enumerate(path.read_text(encoding="utf-8", errors="replace").splitlines(), start=1):
        if "---" in text:
            name = _section(text)
            if rows is None and name not in _NAMES:
                continue
            rows = found.setdefault(name, [])
            skipped = 0 if name in _WITHOUT_HEADS else 2
        elif rows is None:
            if text.strip() and text.split()[1:2] not in (["Echo"], ["echo"]):
                title.append(text.strip())
        elif skipped:
            skipped -= 1
            if _is_of_numbers(text):
                raise ParameterError(
                    f"{path.name}, row {number}: has numbers where a table's names or units stand, which are not read. "
                    "Put a row of names and a row of units above it."
                )
        elif words := text.partition("#")[0].split():
            rows.append(Row(path.name, number, tuple(words)))
    return " ".join(title), found


def _is_of_numbers(text: str) -> bool:
    """Whether most words of a line are numbers: a row of a table."""
    words = text.partition("#")[0].split()
    numbers = sum(re.fullmatch(r"[-+]?(\d+\.?\d*|\.\d+)([eEdD][-+]?\d+)?", word) is not None for word in words)
    return 2 * numbers > len(words)


def _point(row: Row) -> Point:
    at = 10 if len(row.words) >= 12 else 7  # a force of three numbers may stand before the last two
    kind = row.word(1, "Attachment")
    letters = re.match(r"[A-Za-z]*", kind)
    numbers = [row.number_at(place, name) for place, name in enumerate(("X", "Y", "Z", "Mass", "Volume"), start=2)]
    drag_area, added = row.number_at(at, "CdA"), row.number_at(at + 1, "Ca")
    force = tuple(row.number_at(7 + k, f"F{axis}") for k, axis in enumerate("XYZ")) if at == 10 else (0.0, 0.0, 0.0)
    known = _KINDS.get(letters[0].upper() if letters else "", kind)
    return Point(
        row,
        row.whole_at(0, "ID"),
        known,
        (numbers[0], numbers[1], numbers[2]),
        numbers[3],
        numbers[4],
        drag_area,
        added,
        (force[0], force[1], force[2]),
    )


def _line(row: Row) -> Line:
    ends = (row.word(2, "AttachA"), row.word(3, "AttachB"))
    segments = row.whole_at(5, "NumSegs")
    if segments < 1:
        raise row.refused(f"NumSegs = {segments}: must be at least 1. Mend it.")
    return Line(row, row.word(1, "LineType"), ends, row.number_at(4, "UnstrLen"), segments, row.word(6, "LineOutputs"))


def _numbered(rows: Sequence[Row], make: Callable[[Row], _Made]) -> dict[int, _Made]:
    made: dict[int, _Made] = {}
    for row in rows:
        number = row.whole_at(0, "ID")
        if number in made:
            raise row.refused(f"ID {number} stands twice in its section. Give each its own.")
        made[number] = make(row)
    return made


def _option(row: Row) -> str:
    name = row.word(1, "the option's name").lower()
    return _ALIASES.get(name, name)


def read(path: Path) -> Deck:
    """The input file at a path.  Raises ParameterError, which names the file and the row, for what is not as in MoorDyn v2."""
    if not path.is_file():
        raise ParameterError(f"{path}: no such file. Give the path of a MoorDyn input file.")
    title, found = _sections(path)
    for name in (TYPES, POINTS, LINES, OPTIONS):
        if name not in found:
            raise ParameterError(f"{path.name}: no section {name}. Give a whole MoorDyn v2 input file.")
        if not found[name] and name != OPTIONS:
            raise ParameterError(f"{path.name}: nothing in section {name}. Give a whole MoorDyn v2 input file.")
    for row in found[TYPES]:
        if len(row.words) < 10:
            raise row.refused(f"a line type has {len(row.words)} columns: must be 10 as in MoorDyn v2 (v1 has no EI). Complete the row.")
    for k, row in enumerate(found[TYPES]):
        if row.words[0] in [before.words[0] for before in found[TYPES][:k]]:
            raise row.refused(f"line type {row.words[0]!r} stands twice in its section. Give each its own name.")
    words = [word for row in found.get(OUTPUTS, ()) for word in re.split(r'[,"]+', " ".join(row.words)) for word in word.split()]
    return Deck(
        path, title, {row.words[0]: row for row in found[TYPES]}, _numbered(found[POINTS], _point), _numbered(found[LINES], _line),
        {_option(row): row for row in found[OPTIONS]},
        [word for word in words if word != "END"],
        {name: rows for name, rows in found.items() if name not in (TYPES, POINTS, LINES, OPTIONS, OUTPUTS) and rows},
    )  # fmt: skip


def _table(row: Row, folder: Path, label: str, name: str, kind: str, least: int) -> list[Row]:
    """The rows, at least so many, of the file of this name after three lines of heads; errors name the `label` of what names it."""
    path = folder / name
    if not path.is_file():
        raise row.refused(f"{label} = {name!r}: must be {kind} in {str(folder)!r}. Put the file there.")
    texts = path.read_text(encoding="utf-8", errors="replace").splitlines()[3:]
    rows = [Row(path.name, number, tuple(text.split())) for number, text in enumerate(texts, start=4) if text.strip()]
    if len(rows) < least:
        raise row.refused(f"{label} = {name!r}: must be a file of 3 lines of heads and at least {least} rows. Complete it.")
    return rows


def read_seafloor(row: Row, folder: Path) -> list[tuple[float, float, float]]:
    """Heights on a grid, x, y, z (m), in the file that the option SeafloorFile names: a row a point after its size and its x and y.

    Raises ParameterError for a file that is not there or has no table.
    """
    rows = _table(row, folder, row.words[1], row.words[0], "a file", 4)
    size = (folder / row.words[0]).read_text(encoding="utf-8", errors="replace").split(maxsplit=2)[:2]
    if [word for word in size if not word.isdigit()] or int(size[0]) * int(size[1]) != len(rows):
        raise row.refused(f"{row.words[0]!r} has {len(rows)} points: must be {' times '.join(size)}, as its first line says. Mend it.")
    return [(point.number_at(0, "x"), point.number_at(1, "y"), point.number_at(2, "z")) for point in rows]


def read_curve(row: Row, folder: Path, name: str) -> list[tuple[float, float]]:
    """The table of strain and tension (N) in the file of this name: three lines of heads, then a row a point.

    Raises ParameterError for a file that is not there or has no table.
    """
    rows = _table(row, folder, "EA", name, "a number or a file", 2)
    curve = [(point.number_at(0, "strain"), point.number_at(1, "tension")) for point in rows]
    if not min(curve[-1]) > 0.0:
        raise rows[-1].refused("the last strain and tension: must be > 0. Sort the rows by strain.")
    return curve
