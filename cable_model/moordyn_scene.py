"""A line of a MoorDyn v2 input file, or lines that hang together, as a scene.

Where each number goes; both programs are SI, with z up from the still water.  What MoorDyn means by it is from its documentation
(docs/inputs.rst) and, where that is silent, from what its line model computes (source/Line.cpp, 2.7.1).

    MoorDyn                    unit     scene
    Diam                       m        cable.diameter: displaces its volume, and meets water and seabed in MoorDyn too
    Mass/m                     kg/m     cable.mass_per_length, in air
    EA                         N        cable.axial_stiffness; of EA_s|EA_d the static one
    EA as a file               1, N     cable.stiffness_curve; cable.axial_stiffness = last tension over last strain
    BA >= 0                    N.s      cable.axial_damping; of BA_s|BA_d the first
    BA < 0                     1        cable.axial_damping = -BA (L/N) sqrt(EA m), critical for one of MoorDyn's N segments
    EI                         N.m2     cable.bending_stiffness
    Cd                         1        cable.normal_drag_coefficient: both count on the diameter
    CdAx                       1        cable.tangential_drag_coefficient = pi CdAx: theirs counts on the perimeter
    Ca                         1        cable.added_mass_coefficient: both count on the volume of the diameter
    X, Y, Z                    m        top.position; lower_end.x, y, z of a fixed lower end, lower.position of a coupled one
    Mass, Volume               kg, m3   body.mass, body.volume of a free end; those of a cable.body where two lines meet
    CdA                        m2       body.drag_area
    Ca of a point              1        body.added_mass = Ca rho Volume
    UnstrLen                   m        cable.length; of lines that meet at free points a cable.section each
    NumSegs                    1        solver.nodes = NumSegs + 1, of all lines, where that is more than the default
    g                          m/s2     environment.gravity, 9.80665 where absent
    rho, WtrDnsty              kg/m3    water.density, 1025 where absent
    WtrDpth                    m        seabed.level = -WtrDpth, or the lowest point below that
    SeafloorFile               m        seabed.grid, in space; WtrDpth is then not asked for
    kBot                       Pa/m     seabed.stiffness, 3e6 where absent: both are pressure per depth on the diameter
    cBot                       Pa.s/m   seabed.damping_ratio = (cBot/2) sqrt(Diam/(kBot m)), 3e5 where absent: cBot Diam damps a length
    FrictionCoefficient        1        seabed.friction_coefficient
    dtOut                      s        run.output_step
"""

from __future__ import annotations

import math
import re
from typing import Any

from cable_model.errors import ParameterError
from cable_model.moordyn import COUPLED, FIXED, FREE, Deck, Line, Point, Row, read_curve, read_seafloor
from cable_model.parameters import Solver
from cable_model.scene import Scene, from_dict

GRAVITY, DENSITY, STIFFNESS, DAMPING = 9.80665, 1025.0, 3.0e6, 3.0e5  # MoorDyn's where the file is silent
REACH = 2.0  # lengths below the top beyond which a seabed is out of the line's way
_IMPLICIT = "steps are implicit here: see solver.time_step"
_FORCE = "a body feels weight, water and cable alone here"
_REST = "the scene starts at rest, which is solved for"
_FILES = "it concerns MoorDyn's own files"
_WAVES, _CURRENT = "give [waves] in the scene", "give [current] in the scene"
_FRICTION = "friction grips within seabed.friction_displacement and friction_velocity here"
_WITHOUT = {
    "dtm": _IMPLICIT, "cfl": _IMPLICIT, "tscheme": _IMPLICIT, "dtic": _REST, "tmaxic": _REST, "cdscaleic": _REST, "threshic": _REST,
    "icgendynamic": _REST, "fileic": _REST, "writelog": _FILES, "writeunits": _FILES, "disableoutput": _FILES, "disableouttime": _FILES,
    "outswitch": _FILES, "wavekin": _WAVES, "dtwave": _WAVES, "currents": _CURRENT, "unifycurrentgrid": _CURRENT,
    "fricdamp": _FRICTION, "statdynfricscale": _FRICTION,
}  # fmt: skip
_RESULTS = "every run has the outputs of docs/fmu_variables.md"
_NONE_AT_ZERO = ("wavekin", "currents")
_WITH = ("g", "rho", "wtrdpth", "kbot", "cbot", "frictioncoefficient", "dtout", "seafloorfile")

_INSTEAD = {"FAILURE": "give cable.breaking_tension, or parting.time and parting.place"}  # of sections that are left out


class _Translation:
    """The scene of a line in the making, `values`, and what is `told` of it: one text for each thing left out or changed.

    Lines that go on from it at free points which hold two belong to it: `numbers` are theirs from the lower end to the top.
    """

    def __init__(self, deck: Deck, number: int) -> None:
        self.deck, self.number = deck, number
        self.values: dict[str, dict[str, Any]] = {}
        self.told: list[str] = []
        self.density = self._option("rho", DENSITY)
        self.numbers, self.points = self._from_below(*self._hanging_together())
        self.lines = [deck.lines[k] for k in self.numbers]
        for line in self.lines:
            if line.type not in deck.types:
                known = ", ".join(deck.types) or "none"
                raise line.row.refused(f"line type {line.type!r} is unknown: known are {known}. Give one of them.")
        self.low, self.top = self.points[0], self.points[-1]
        self.seafloor = self.deck.options.get("seafloorfile")
        aside = self.low.kind in (FIXED, COUPLED) and self.low.place[1] != self.top.place[1]
        self.space = aside or self.seafloor is not None

    def _option(self, name: str, default: float) -> float:
        row = self.deck.options.get(name)
        return default if row is None else row.number_at(0, row.words[1])

    def _not_negative(self, name: str, default: float) -> float:
        value = self._option(name, default)
        if value < 0.0:
            row = self.deck.options[name]
            raise row.refused(f"{row.words[1]} = {row.words[0]}: must be >= 0. Mend it.")
        return value

    def _leave_out(self, what: str, why: str) -> None:
        self._tell(f"left out: {what}: {why}")

    def _change(self, what: str, how: str) -> None:
        self._tell(f"changed: {what}: {how}")

    def _tell(self, text: str) -> None:
        """Once, though several lines be of one type."""
        if text not in self.told:
            self.told.append(text)

    def add_cable(self) -> None:
        """What the line is made of; of several lines sections, with the bodies where they meet."""
        made = [self._made_of(line, self.deck.types[line.type]) for line in self.lines]
        self.values["cable"] = made[0] if len(made) == 1 else {"section": made, "body": self._bodies_between()}

    def _bodies_between(self) -> list[dict[str, float]]:
        bodies, at = [], 0.0
        for line, point in zip(self.lines, self.points[1:-1], strict=False):
            at += line.length
            if any(point.force):
                self._leave_out(f"force on point {point.number}", _FORCE)
            if point.mass or point.volume or point.drag_area:
                bodies.append({"at": at, **self._body_of(point)})
                self._tell_of_body(point)
        return bodies

    def _made_of(self, line: Line, row: Row) -> dict[str, Any]:
        cable = {
            "length": line.length, "diameter": row.positive_of(row.words[1], "Diam"),
            "mass_per_length": row.positive_of(row.words[2], "Mass/m"), **self._stiffness(row), "bending_stiffness": row.number_at(5, "EI"),
            "normal_drag_coefficient": row.number_at(6, "Cd"), "added_mass_coefficient": row.number_at(7, "Ca"),
            "tangential_drag_coefficient": math.pi * row.number_at(8, "CdAx"),
        }  # fmt: skip
        static, _, dynamic = row.word(4, "BA").partition("|")
        if dynamic:
            self._leave_out(f"dynamic damping BA_d = {dynamic}", "the material is elastic with one damping here")
        damping = row.number_of(static, "BA")
        if damping < 0.0:
            damping *= -(line.length / line.segments) * math.sqrt(cable["axial_stiffness"] * cable["mass_per_length"])
            self._change(f"BA = {static} of critical", f"cable.axial_damping = {damping:.6g} N.s, that of {line.segments} segments")
        cable["axial_damping"] = damping
        if row.number_at(9, "CaAx") != 0.0:
            self._leave_out(f"CaAx = {row.words[9]}", "there is no added mass along the cable here")
        if len(row.words) > 10 and row.number_at(10, "Cl") != 0.0:
            self._leave_out(f"Cl = {row.words[10]}", "there is no vortex-induced vibration here")
        return cable

    def _stiffness(self, row: Row) -> dict[str, Any]:
        static, *dynamic = row.word(3, "EA").split("|")
        if static.upper().startswith("SYROPE:"):
            raise row.refused("EA is of Syrope's model: must be a number or a table. Give the stiffness at the mean tension.")
        if dynamic:
            self._leave_out(f"dynamic stiffness {'|'.join(dynamic)}", f"cable.axial_stiffness is the static one, {static}")
        if not re.search("[a-df-z]", static, re.IGNORECASE):  # the only letter in a number is e
            return {"axial_stiffness": row.positive_of(static, "EA")}
        if len(self.lines) > 1:
            raise row.refused("EA is a table: must be a number where lines hang together. Give the stiffness at the mean tension.")
        curve = read_curve(row, self.deck.path.parent, static)
        self._change(f"EA = {static}", "its rows are joined smoothly in cable.stiffness_curve, by straight lines in MoorDyn")
        return {"axial_stiffness": curve[-1][1] / curve[-1][0], "stiffness_curve": curve}

    def _hanging_together(self) -> tuple[list[int], list[Point]]:
        """The lines that go on from this one over free points which hold two, in their order, and the points from end to end."""
        numbers = [self.number]
        points = list(self.deck.points_of(self.deck.lines[self.number]))
        for _ in range(2):  # on at its end B, and then, turned round, at A
            while self.deck.points[points[-1]].kind == FREE and len(self.deck.held_by(points[-1])) == 2:
                here, others = points[-1], [k for k in self.deck.held_by(points[-1]) if k not in numbers]
                if not others:
                    raise self.deck.points[here].row.refused(f"point {here} joins the two ends of one line. Fix it, or leave it out.")
                a, b = self.deck.points_of(self.deck.lines[others[0]])
                numbers.append(others[0])
                points.append(b if a == here else a)
            numbers.reverse()
            points.reverse()
        return numbers, [self.deck.points[k] for k in points]

    def _from_below(self, numbers: list[int], points: list[Point]) -> tuple[list[int], list[Point]]:
        """The same from the lower end to the top.  Raises ParameterError for ends that are no pair of those."""
        a, b = points[0], points[-1]
        for point in (a, b):
            if point.kind not in (FIXED, COUPLED, FREE):
                what = f"point {point.number} is on {point.kind!r}: must be coupled, fixed or free"
                raise point.row.refused(f"{what}. Write it so, at its place.")
        if a.kind == b.kind == COUPLED:
            top_is_a = a.place[2] >= b.place[2]
        elif a.kind == b.kind:
            of = f"line {numbers[0]}" if len(numbers) == 1 else f"lines {', '.join(map(str, numbers))}"
            what = f"both ends of {of} are {a.kind}: one must be the top, coupled (or fixed, over a free one)"
            raise self.deck.lines[self.number].row.refused(f"{what}. Write Coupled at the end that a host moves.")
        else:
            top_is_a = a.kind == COUPLED or (a.kind, b.kind) == (FIXED, FREE)
        return (numbers[::-1], points[::-1]) if top_is_a else (numbers, points)

    def add_ends(self) -> None:
        """The top, and the lower end with its anchor or body."""
        top, low = self.top, self.low
        self.values["top"] = {"position": list(top.place)}
        self._change(f"point {top.number}, {top.row.words[1]}", "it is the top and stands still; give [[top.motion]] or move it as an FMU")
        self._leave_out_body(top)
        if low.kind == COUPLED:
            self.values["lower_end"] = {"anchored": True, "driven": True}
            self.values["lower"] = {"position": list(low.place)}
            self._change(
                f"point {low.number}, {low.row.words[1]}",
                "it is the lower end and stands still; give [[lower.motion]] or move it as an FMU",
            )
            self._leave_out_body(low)
        elif low.kind == FIXED:
            self.values["lower_end"] = {"anchored": True, **dict(zip("xyz", low.place, strict=True))}
            self._leave_out_body(low)
        else:
            self._add_body(low)
        if not self.space:
            self._change("motion in space", "the cable moves in the plane of x and z; solver.space = true lets it leave that")

    def _leave_out_body(self, point: Point) -> None:
        for name, value in (("Mass", point.mass), ("Volume", point.volume), ("CdA", point.drag_area), ("force", any(point.force))):
            if value:
                self._leave_out(f"{name} of point {point.number}", "the end is held or moved, and feels the cable alone here")

    def _add_body(self, point: Point) -> None:
        held = self.deck.held_by(point.number)
        if len(held) > 1:
            what = f"point {point.number} is free and holds the lines {', '.join(map(str, held))}: must hold two at most"
            raise point.row.refused(f"{what}. Make it fixed or coupled.")
        self.values["body"] = self._body_of(point)
        if any(point.force):
            self._leave_out(f"force on point {point.number}", _FORCE)
        self._tell_of_body(point)

    def _tell_of_body(self, point: Point) -> None:
        self._leave_out(f"place of point {point.number}", _REST)
        if point.volume or point.drag_area:
            self._change(f"point {point.number}", "above the surface it is dry here, in MoorDyn it floats and drags there too")

    def _body_of(self, point: Point) -> dict[str, float]:
        added = point.added_mass_coefficient * self.density * point.volume
        return {"mass": point.mass, "volume": point.volume, "drag_area": point.drag_area, "added_mass": added}

    def add_surroundings(self) -> None:
        """Gravity, water and seabed."""
        self.values["environment"] = {"gravity": self._option("g", GRAVITY)}
        self.values["water"] = {"density": self.density}
        depth, lowest = self._option("wtrdpth", 0.0), -min(point.place[2] for point in self.deck.points.values())
        if lowest > depth and self.seafloor is None:
            self._change(f"WtrDpth = {depth:g}", f"the depth is {lowest:g} m, of the lowest point, as in MoorDyn")
        stiffness, damping = self._not_negative("kbot", STIFFNESS), self._not_negative("cbot", DAMPING)
        friction = self._option("frictioncoefficient", 0.0)
        level, cable = -max(depth, lowest), self.values["cable"]
        grid = None
        if self.seafloor is not None:
            name, grid = self.seafloor.words[0], read_seafloor(self.seafloor, self.deck.path.parent)
            level = max(z for _, _, z in grid)
            self._change(
                f"SeafloorFile = {name}",
                "seabed.grid joins its heights smoothly and goes straight on; MoorDyn by lines, and level",
            )
            if "wtrdpth" in self.deck.options:
                self._leave_out(f"WtrDpth = {depth:g}", f"heights come from {name}")
        lowermost, length = cable.get("section", [cable])[0], sum(line.length for line in self.lines)
        if stiffness == 0.0 or level < self.values["top"]["position"][2] - REACH * length:
            why = "kBot is 0" if stiffness == 0.0 else f"it lies deeper than {REACH:g} lengths below the top"
            self._leave_out(f"the seabed at z = {level:g} m", why)
            return
        if len(self.lines) > 1:
            self._change(f"cBot = {damping:g}", "seabed.damping_ratio is one for all lines, from the lowest")
        ratio = 0.5 * damping * math.sqrt(lowermost["diameter"] / (stiffness * lowermost["mass_per_length"]))
        if friction:
            self._change(f"FrictionCoefficient = {friction:g}", "friction holds a cable at rest here; in MoorDyn it only slows what slides")
        height = {"level": level} if grid is None else {"grid": grid}
        self.values["seabed"] = {**height, "stiffness": stiffness, "damping_ratio": ratio, "friction_coefficient": friction}

    def add_settings(self) -> None:
        """Nodes, output step, and every option without a counterpart."""
        segments = sum(line.segments for line in self.lines)
        given, nodes = segments + 1, Solver().nodes
        self.values["solver"] = {"space": self.space, "nodes": max(nodes, given, 4 * len(self.lines) + 1)}
        if given < nodes:
            self._change(f"NumSegs = {segments}", f"solver.nodes = {nodes}, the default, is finer")
        if self._option("dtout", 0.0) > 0.0:
            self.values["run"] = {"output_step": self._option("dtout", 0.0)}
        for name, row in self.deck.options.items():
            if name in _WITH or (name in _NONE_AT_ZERO and row.words[0] == "0"):
                continue
            self._leave_out(f"{row.words[1]} = {row.words[0]}", _WITHOUT.get(name, "it is unknown here"))

    def _tension_at(self, point: Point, k: int) -> str:
        """MoorDyn's name of the tension at an end of the k-th line."""
        return f"{'ANCHTEN' if self.deck.points_of(self.lines[k])[0] == point.number else 'FAIRTEN'}{self.numbers[k]}"

    def tell_the_rest(self) -> None:
        """The outputs, other lines, points and types, and the sections that have no place here."""
        for line in self.lines:
            if line.outputs != "-":
                self._leave_out(f"LineOutputs {line.outputs}", _RESULTS)
        tensions = {self._tension_at(self.low, 0): "body.tension", self._tension_at(self.top, -1): "top.tension"}
        for channel in self.deck.channels:
            if (name := tensions.get(channel.upper())) is not None:
                self._change(f"output {channel}", f"its name here is {name}")
            else:
                self._leave_out(f"output {channel}", _RESULTS)
        others = [number for number in self.deck.lines if number not in self.numbers]
        if others:
            self._leave_out(f"lines {', '.join(map(str, others))} with their types and points", "import each by itself with --line")
        for number in self.deck.points:
            if not self.deck.held_by(number):
                self._leave_out(f"point {number}", "it holds no line")
        used = {line.type for line in self.deck.lines.values()}
        for name in self.deck.types:
            if name not in used:
                self._leave_out(f"line type {name}", "no line has it")
        for section, rows in self.deck.others.items():
            for row in rows:
                why = _INSTEAD.get(section, "a cable between a top and a lower end is all there is here")
                self._leave_out(f"{section} {row.words[0]}", why)


def scene_of(deck: Deck, number: int | None = None) -> tuple[Scene, list[str]]:
    """The scene of a line of a deck, with those that hang together with it, and a text for each item that is left out or changed.

    Without a number it is that of the only line, or of all where they hang together.

    Raises ParameterError for a line that is not there, or not between a top and a lower end, and for values that no scene takes.
    """
    known = ", ".join(map(str, deck.lines)) or "none"
    if number is not None and number not in deck.lines:
        raise ParameterError(f"{deck.path.name}: has no line {number}, only {known}. Name one of them with --line.")
    made = _Translation(deck, next(iter(deck.lines)) if number is None else number)
    if number is None and len(made.numbers) != len(deck.lines):
        raise ParameterError(f"{deck.path.name}: has the lines {known}. Name one with --line.")
    number = made.number
    for step in (made.add_cable, made.add_ends, made.add_surroundings, made.add_settings, made.tell_the_rest):
        step()
    of = f"line {number}" if len(made.numbers) == 1 else f"lines {', '.join(map(str, made.numbers))}"
    text = {"title": deck.title or f"{of.capitalize()} of {deck.path.name}", "source": f"MoorDyn input file {deck.path.name}, {of}"}
    try:
        return from_dict({**text, **made.values}), made.told
    except ParameterError as error:
        raise ParameterError(f"{deck.path.name}, line {number}: {error}") from error
