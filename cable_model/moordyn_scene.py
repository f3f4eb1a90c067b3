"""One line of a MoorDyn v2 input file as a scene.

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
    Mass, Volume               kg, m3   body.mass, body.volume of a free end
    CdA                        m2       body.drag_area
    Ca of a point              1        body.added_mass = Ca rho Volume
    UnstrLen                   m        cable.length
    NumSegs                    1        solver.nodes = NumSegs + 1, where that is more than the default
    g                          m/s2     environment.gravity, 9.80665 where absent
    rho, WtrDnsty              kg/m3    water.density, 1025 where absent
    WtrDpth                    m        seabed.level = -WtrDpth, or the lowest point below that
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
from cable_model.moordyn import COUPLED, FIXED, FREE, Deck, Point, read_curve
from cable_model.parameters import Solver
from cable_model.scene import Scene, from_dict

GRAVITY, DENSITY, STIFFNESS, DAMPING = 9.80665, 1025.0, 3.0e6, 3.0e5  # MoorDyn's where the file is silent
REACH = 2.0  # lengths below the top beyond which a seabed is out of the line's way
_IMPLICIT = "steps are implicit here: see solver.time_step"
_REST = "the scene starts at rest, which is solved for"
_FILES = "it concerns MoorDyn's own files"
_WAVES, _CURRENT = "give [waves] in the scene", "give [current] in the scene"
_FRICTION = "friction grips within seabed.friction_displacement and friction_velocity here"
_WITHOUT = {
    "dtm": _IMPLICIT, "cfl": _IMPLICIT, "tscheme": _IMPLICIT, "dtic": _REST, "tmaxic": _REST, "cdscaleic": _REST, "threshic": _REST,
    "icgendynamic": _REST, "fileic": _REST, "writelog": _FILES, "writeunits": _FILES, "disableoutput": _FILES, "disableouttime": _FILES,
    "outswitch": _FILES, "wavekin": _WAVES, "dtwave": _WAVES, "currents": _CURRENT, "unifycurrentgrid": _CURRENT,
    "fricdamp": _FRICTION, "statdynfricscale": _FRICTION, "seafloorfile": "the seabed is level here",
}  # fmt: skip
_RESULTS = "every run has the outputs of docs/fmu_variables.md"
_NONE_AT_ZERO = ("wavekin", "currents")
_WITH = ("g", "rho", "wtrdpth", "kbot", "cbot", "frictioncoefficient", "dtout")


class _Translation:
    """The scene of one line in the making, `values`, and what is `told` of it: one text for each thing left out or changed."""

    def __init__(self, deck: Deck, number: int) -> None:
        self.deck, self.number, self.line = deck, number, deck.lines[number]
        self.values: dict[str, dict[str, Any]] = {}
        self.told: list[str] = []
        if self.line.type not in deck.types:
            known = ", ".join(deck.types) or "none"
            raise self.line.row.refused(f"line type {self.line.type!r} is unknown: known are {known}. Give one of them.")
        self.type = deck.types[self.line.type]
        self.density = self._option("rho", DENSITY)
        self.top_is_a, self.top, self.low = self._ends()
        self.space = self.low.kind in (FIXED, COUPLED) and self.low.place[1] != self.top.place[1]

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
        self.told.append(f"left out: {what}: {why}")

    def _change(self, what: str, how: str) -> None:
        self.told.append(f"changed: {what}: {how}")

    def add_cable(self) -> None:
        row, line = self.type, self.line
        cable = self.values["cable"] = {
            "length": line.length, "diameter": row.positive_of(row.words[1], "Diam"),
            "mass_per_length": row.positive_of(row.words[2], "Mass/m"), **self._stiffness(), "bending_stiffness": row.number_at(5, "EI"),
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

    def _stiffness(self) -> dict[str, Any]:
        static, *dynamic = self.type.word(3, "EA").split("|")
        if static.upper().startswith("SYROPE:"):
            raise self.type.refused("EA is of Syrope's model: must be a number or a table. Give the stiffness at the mean tension.")
        if dynamic:
            self._leave_out(f"dynamic stiffness {'|'.join(dynamic)}", f"cable.axial_stiffness is the static one, {static}")
        if not re.search("[a-df-z]", static, re.IGNORECASE):  # the only letter in a number is e
            return {"axial_stiffness": self.type.positive_of(static, "EA")}
        curve = read_curve(self.type, self.deck.path.parent, static)
        self._change(f"EA = {static}", "its rows are joined smoothly in cable.stiffness_curve, by straight lines in MoorDyn")
        return {"axial_stiffness": curve[-1][1] / curve[-1][0], "stiffness_curve": curve}

    def _ends(self) -> tuple[bool, Point, Point]:
        """Whether the top is end A, the top, and the lower end.  Raises ParameterError for ends that are no pair of those."""
        a, b = (self.deck.points[number] for number in self.deck.points_of(self.line))
        for point in (a, b):
            if point.kind not in (FIXED, COUPLED, FREE):
                what = f"point {point.number} is on {point.kind!r}: must be coupled, fixed or free"
                raise point.row.refused(f"{what}. Write it so, at its place.")
        if a.kind == b.kind == COUPLED:
            top_is_a = a.place[2] >= b.place[2]
        elif a.kind == b.kind:
            what = f"both ends of line {self.number} are {a.kind}: one must be the top, coupled (or fixed, over a free one)"
            raise self.line.row.refused(f"{what}. Write Coupled at the end that a host moves.")
        else:
            top_is_a = a.kind == COUPLED or (a.kind, b.kind) == (FIXED, FREE)
        return (True, a, b) if top_is_a else (False, b, a)

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
            what = f"point {point.number} is free and holds the lines {', '.join(map(str, held))}: must hold one"
            raise point.row.refused(f"{what}. Make it fixed or coupled, or one line of them.")
        self.values["body"] = {
            "mass": point.mass, "volume": point.volume, "drag_area": point.drag_area,
            "added_mass": point.added_mass_coefficient * self.density * point.volume,
        }  # fmt: skip
        if any(point.force):
            self._leave_out(f"force on point {point.number}", "a body feels weight, water and cable alone here")
        self._leave_out(f"place of point {point.number}", _REST)
        if point.volume or point.drag_area:
            self._change(f"point {point.number}", "above the surface it is dry here, in MoorDyn it floats and drags there too")

    def add_surroundings(self) -> None:
        """Gravity, water and seabed."""
        self.values["environment"] = {"gravity": self._option("g", GRAVITY)}
        self.values["water"] = {"density": self.density}
        depth, lowest = self._option("wtrdpth", 0.0), -min(point.place[2] for point in self.deck.points.values())
        if lowest > depth:
            self._change(f"WtrDpth = {depth:g}", f"the depth is {lowest:g} m, of the lowest point, as in MoorDyn")
        stiffness, damping = self._not_negative("kbot", STIFFNESS), self._not_negative("cbot", DAMPING)
        friction = self._option("frictioncoefficient", 0.0)
        level, cable = -max(depth, lowest), self.values["cable"]
        if stiffness == 0.0 or level < self.values["top"]["position"][2] - REACH * self.line.length:
            why = "kBot is 0" if stiffness == 0.0 else f"it lies deeper than {REACH:g} lengths below the top"
            self._leave_out(f"the seabed at z = {level:g} m", why)
            return
        ratio = 0.5 * damping * math.sqrt(cable["diameter"] / (stiffness * cable["mass_per_length"]))
        if friction:
            self._change(f"FrictionCoefficient = {friction:g}", "friction holds a cable at rest here; in MoorDyn it only slows what slides")
        self.values["seabed"] = {"level": level, "stiffness": stiffness, "damping_ratio": ratio, "friction_coefficient": friction}

    def add_settings(self) -> None:
        """Nodes, output step, and every option without a counterpart."""
        given, nodes = self.line.segments + 1, Solver().nodes
        self.values["solver"] = {"space": self.space, "nodes": max(nodes, given)}
        if given < nodes:
            self._change(f"NumSegs = {self.line.segments}", f"solver.nodes = {nodes}, the default, is finer")
        if self._option("dtout", 0.0) > 0.0:
            self.values["run"] = {"output_step": self._option("dtout", 0.0)}
        for name, row in self.deck.options.items():
            if name in _WITH or (name in _NONE_AT_ZERO and row.words[0] == "0"):
                continue
            self._leave_out(f"{row.words[1]} = {row.words[0]}", _WITHOUT.get(name, "it is unknown here"))

    def tell_the_rest(self) -> None:
        """The outputs, other lines, points and types, and the sections that have no place here."""
        if self.line.outputs != "-":
            self._leave_out(f"LineOutputs {self.line.outputs}", _RESULTS)
        ends = ("top.tension", "body.tension") if self.top_is_a else ("body.tension", "top.tension")
        tensions = dict(zip((f"ANCHTEN{self.number}", f"FAIRTEN{self.number}"), ends, strict=True))  # of ends A and B
        for channel in self.deck.channels:
            if (name := tensions.get(channel.upper())) is not None:
                self._change(f"output {channel}", f"its name here is {name}")
            else:
                self._leave_out(f"output {channel}", _RESULTS)
        others = [number for number in self.deck.lines if number != self.number]
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
                self._leave_out(f"{section} {row.words[0]}", "a cable between a top and a lower end is all there is here")


def scene_of(deck: Deck, number: int | None = None) -> tuple[Scene, list[str]]:
    """The scene of one line of a deck, the only one if no number is given, and a text for each item that is left out or changed.

    Raises ParameterError for a line that is not there, or not between a top and a lower end, and for values that no scene takes.
    """
    known = ", ".join(map(str, deck.lines)) or "none"
    if number is None and len(deck.lines) != 1:
        raise ParameterError(f"{deck.path.name}: has the lines {known}. Name one with --line.")
    number = next(iter(deck.lines)) if number is None else number
    if number not in deck.lines:
        raise ParameterError(f"{deck.path.name}: has no line {number}, only {known}. Name one of them with --line.")
    made = _Translation(deck, number)
    for step in (made.add_cable, made.add_ends, made.add_surroundings, made.add_settings, made.tell_the_rest):
        step()
    text = {"title": deck.title or f"Line {number} of {deck.path.name}", "source": f"MoorDyn input file {deck.path.name}, line {number}"}
    try:
        return from_dict({**text, **made.values}), made.told
    except ParameterError as error:
        raise ParameterError(f"{deck.path.name}, line {number}: {error}") from error
