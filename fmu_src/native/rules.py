"""The rules of scenes as tables for C: found by asking the Python code, so that no rule is written twice.

A rule is a conjunction of literals "this parameter is zero" or "is not".  Scenes are tried with one and two parameters changed from
the neutral ones; a literal belongs to a rule where changing that parameter alone back undoes the rule's effect.
"""

from __future__ import annotations

import functools
import itertools
import math
import re
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from cable_model.effects import effects
from cable_model.errors import ParameterError
from cable_model.kernels.parts import PARAMETERS, Parts
from cable_model.model import Model
from cable_model.scene import Scene, numbers_of, parts_of
from cable_model.signals import INPUTS
from fmu_src.interface import Variable, scene_from_values

Literal = tuple[int, bool]  # variable, whether it is nonzero
Values = Mapping[str, Any]
TAIL = re.compile(r"(.+?) = (.*?): must be (.*)", re.DOTALL)
WHY = re.compile(r"(\S+) = (\S+)(?: (\S+))?")
ANGLE = 0.5  # rad: neither along the x axis nor across
_NEEDED = ("cable.diameter", "environment.gravity", "top.motion_order")  # not zero in the neutral scene
_KEPT = ("environment.gravity", "top.motion_order")  # and never tried as zero: no rule asks for them


@dataclass(frozen=True)
class Refusal:
    """Values that do not go together: the variable that the text names, and the text after "must be "."""

    literals: tuple[Literal, ...]
    variable: int
    text: str


@dataclass(frozen=True)
class Limit:
    """What a parameter's own rule says after "must be ": not finite, out of range; "" where no value breaks it.  And its unit there."""

    finite: str
    range: str
    unit: str


@dataclass(frozen=True)
class Reason:
    """An effect as the list of active effects names it; `variable` < 0: the words are constant."""

    literals: tuple[Literal, ...]
    words: str
    variable: int
    unit: str


@dataclass
class Rules:
    """The rules that hold for FMU values over the scene `base` in a model ("chain" or "tow")."""

    rows: Sequence[Variable]
    base: Scene
    model: str
    _scenes: dict[tuple[int, ...], Scene | str] = field(default_factory=dict)

    @functools.cached_property
    def _parameters(self) -> list[int]:
        return [vr for vr, row in enumerate(self.rows) if row.causality == "parameter"]

    @functools.cached_property
    def _free(self) -> list[int]:
        """The parameters that are tried as zero and as nonzero."""
        zero_allowed = [vr for vr in self._parameters if (self.rows[vr].minimum or 0) <= 0 and not self.rows[vr].minimum_excluded]
        return [vr for vr in zero_allowed if self.rows[vr].name not in _KEPT]

    def _value(self, row: Variable, on: bool) -> Any:
        if row.kind == "Boolean":
            return on
        if not on:
            return 0.0 if row.kind == "Real" else 0
        if row.kind == "Integer":
            return max(1, int(row.minimum or 0), int(row.start or 0))
        if row.unit == "rad":
            return ANGLE
        top = math.inf if row.maximum is None else row.maximum
        return float(row.start) if row.start else min(0.5, top)

    @functools.cached_property
    def _neutral(self) -> dict[int, bool]:
        """Every parameter that may be zero is, but for those that a cable must have."""
        return {vr: vr not in self._free or self.rows[vr].name in _NEEDED for vr in self._parameters}

    def _scene(self, changed: Iterable[int]) -> Scene | str:
        """The scene with these parameters the other way round from the neutral ones, or the error's text."""
        key = tuple(sorted(changed))
        if key not in self._scenes:
            on = {vr: state != (vr in key) for vr, state in self._neutral.items()}
            values = {self.rows[vr].name: self._value(self.rows[vr], state) for vr, state in on.items()}
            try:
                self._scenes[key] = scene_from_values(self.base, values)
            except ParameterError as error:
                self._scenes[key] = str(error)
        return self._scenes[key]

    @functools.cached_property
    def _tried(self) -> list[tuple[int, ...]]:
        """None, one and two parameters changed; an excluded zero is never tried."""
        return [(), *((vr,) for vr in self._free), *itertools.combinations(self._free, 2)]

    def _literals(self, changed: tuple[int, ...], undone: Callable[[Scene], bool]) -> tuple[Literal, ...]:
        """The parameters each of which, changed alone, makes another valid scene for which `undone` is true; as literals."""
        others = {vr: self._scene(set(changed) ^ {vr}) for vr in self._free}
        needed = [vr for vr, other in others.items() if not isinstance(other, str) and undone(other)]
        return tuple((vr, self._neutral[vr] != (vr in changed)) for vr in needed)

    def _hold(self, literals: Iterable[Literal], changed: tuple[int, ...]) -> bool:
        return all(on == (self._neutral[vr] != (vr in changed)) for vr, on in literals)

    def _valid(self, literals: tuple[Literal, ...]) -> bool:
        """Whether a valid scene fulfils all the literals."""
        return any(self._hold(literals, changed) and not isinstance(self._scene(changed), str) for changed in self._tried)

    def _condition(self, active: Callable[[Scene], bool]) -> tuple[Literal, ...] | None:
        """Literals under which `active` is true; () always, None never.  Scenes that are refused do not count."""
        known = {changed: active(scene) for changed in self._tried if not isinstance(scene := self._scene(changed), str)}
        if not any(known.values()):
            return None
        literals = self._shared(known, active)
        if literals is None:  # active unless one parameter says so
            negated = self._shared({changed: not state for changed, state in known.items()}, lambda scene: not active(scene))
            if negated is None or len(negated) != 1:
                raise ValueError("a part or effect depends on its parameters in a new way. Teach rules.py that kind of rule.")
            literals = ((negated[0][0], not negated[0][1]),)
        return literals

    def _shared(self, known: Mapping[tuple[int, ...], bool], active: Callable[[Scene], bool]) -> tuple[Literal, ...] | None:
        """The literals that hold exactly where `active` is true among the tried scenes; None where there are none such."""
        first = next(changed for changed, state in known.items() if state)
        literals = self._literals(first, lambda other: not active(other))
        return literals if all(self._hold(literals, changed) == state for changed, state in known.items()) else None

    def refusals(self) -> list[Refusal]:
        """The rules that join several values."""
        found: dict[tuple[Literal, ...], Refusal] = {}
        for changed in self._tried:
            text = self._scene(changed)
            if not isinstance(text, str):
                continue
            literals = self._literals(changed, lambda other: True)
            if not self._valid(literals):  # else two rules are broken at once
                found.setdefault(literals, Refusal(literals, self._named(text), self.tail(text)))
        return list(found.values())

    def parts(self) -> dict[str, tuple[Literal, ...] | None]:
        """When each part is present: literals; () always, None never."""

        def present(scene: Scene, name: str) -> bool:
            return getattr(parts_of(scene, self.model), name) is not None

        return {name: self._condition(functools.partial(present, name=name)) for name in Parts._fields}

    def reasons(self) -> list[Reason]:
        """The effects that may be active, in the order of effects.effects."""
        made = []

        def active(scene: Scene, k: int) -> bool:
            return effects(scene, self.model)[k].active

        for k, effect in enumerate(effects(self.base, self.model)):
            condition = self._condition(functools.partial(active, k=k))
            if condition is None:
                continue
            why = self._why(k)
            match = WHY.fullmatch(why)
            place = self._place(match[1]) if match else -1
            if match and place >= 0:
                made.append(Reason(condition, f"{effect.name} ({match[1]} = ", place, match[3] or ""))
            else:
                made.append(Reason(condition, f"{effect.name} ({why})", -1, ""))
        return made

    def _why(self, k: int) -> str:
        for changed in self._tried:
            scene = self._scene(changed)
            if not isinstance(scene, str) and effects(scene, self.model)[k].active:
                return effects(scene, self.model)[k].why
        return ""

    @functools.cached_property
    def limits(self) -> dict[int, Limit]:
        """The texts of each parameter's own rule."""
        made = {}
        for vr in self._parameters:
            row = self.rows[vr]
            beyond = ((row.minimum, -1), (row.maximum, 1))
            tried = [bound + side for bound, side in beyond if bound is not None]
            refused = [text for value in tried if (text := self._refused(row, int(value) if row.kind == "Integer" else value))]
            finite = self._refused(row, math.nan) if row.kind == "Real" else ""
            number = TAIL.fullmatch((refused or [finite or "x = 0: must be"])[0] + " ")
            unit = number[2].partition(" ")[2] if number else ""
            made[vr] = Limit(self.tail(finite), self.tail(refused[0]) if refused else "", unit)
        return made

    def _refused(self, row: Variable, value: float) -> str:
        try:
            scene_from_values(self.base, {row.name: value})
        except ParameterError as error:
            return str(error)
        return ""

    def numbers(self) -> list[tuple[int, int]]:
        """For each number of the kernels the variable that it is, and the one that takes its place below zero (or -1)."""
        made = []
        for k, name in enumerate(PARAMETERS):
            vr = self._place(name)
            instead = -1
            least = self.rows[vr].minimum
            if self.rows[vr].kind == "Real" and (least is None or least < 0.0):
                probe = scene_from_values(self.base, {self.rows[vr].name: -1.0} | self._marked())
                value = numbers_of(probe)[k]
                if value != -1.0:
                    instead = next(at for at, mark in self._marks().items() if mark == value)
            made.append((vr, instead))
        return made

    def _marks(self) -> dict[int, float]:
        """A value of its own for every parameter of a body, which may stand in for another."""
        names = [vr for vr in self._parameters if self.rows[vr].name.startswith("body.")]
        return {vr: 1000.0 + vr for vr in names}

    def _marked(self) -> dict[str, Any]:
        anchored = {self.rows[vr].name: False for vr in self._parameters if self.rows[vr].name == "lower_end.anchored"}
        return {self.rows[vr].name: mark for vr, mark in self._marks().items()} | anchored

    def _place(self, name: str) -> int:
        return next((vr for vr, row in enumerate(self.rows) if name in (row.scene_name, row.name)), -1)

    def _named(self, text: str) -> int:
        match = TAIL.fullmatch(text)
        return self._place(match[1]) if match else -1

    @functools.cached_property
    def finite_input(self) -> str:
        """What an input must be, and what to do."""
        try:
            Model._finite(np.full(len(INPUTS), math.nan))
        except ParameterError as error:
            return self.tail(str(error))
        return ""

    @functools.cached_property
    def step_text(self) -> str:
        """What a communication step must be, and what to do."""
        try:
            Model.step(Model.__new__(Model), 0.0, -1.0, np.zeros(len(INPUTS)))
        except ParameterError as error:
            return self.tail(str(error))
        return ""

    @staticmethod
    def tail(text: str) -> str:
        """What an error's text says after "must be "."""
        match = TAIL.fullmatch(text)
        return match[3] if match else text
