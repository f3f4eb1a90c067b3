"""The rules of scenes as tables for C, derived from the table of effects and from the rules that join values; no rule is written here."""

from __future__ import annotations

import functools
import math
import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from cable_model.condition import CHANGED, Case, Condition, Given
from cable_model.effects import BOX, BY_NAME, CHAIN, EFFECTS, INSTEAD, PARAMETERS, STAGGERED, Effect
from cable_model.errors import ParameterError
from cable_model.model import Model
from cable_model.parameters import field_of
from cable_model.rules import RULES, START_RULES
from cable_model.scene import Scene, with_values
from cable_model.signals import INPUTS
from cable_model.simulated import ON_BOX, decides, grid_refusal, is_on, literals, refused_on, true, when, why
from fmu_src.interface import Variable, in_scenes, kept, scene_name

TAIL = re.compile(r"(.+?) = (.*?): must be (.*)", re.DOTALL)


_SEA = ("wave.amplitude", "wave.period", "wave.direction", "wave.phase", "environment.gravity")  # what the rows of a sea are made of


def has_sea(scene: Scene, model: str) -> bool:
    """Whether a scene's waves are baked in as rows: many, or over a finite depth."""
    given = (Given("waves.spectrum"), Given("waves.table"), Given("waves.record"))
    return any(true(condition, scene, model) for condition in given) or is_on(BY_NAME["finite_depth"], scene, model)


@dataclass(frozen=True)
class Refusal:
    """Values that do not go together: the variable that the text names, and the text after "must be "."""

    literals: Case
    variable: int
    text: str


@dataclass(frozen=True)
class AtStart:
    """A rule of inputs at the start: variables, see rules.StartRule; `slack` < 0: none; the words about the number in "must be"."""

    literals: Case
    variable: int
    other: int
    slack: int
    times: float
    equal: bool
    words: tuple[str, str]


@dataclass(frozen=True)
class Limit:
    """What a parameter's own rule says after "must be ": not finite, out of range; "" where no value breaks it.  And its unit there."""

    finite: str
    range: str
    unit: str


@dataclass(frozen=True)
class Reason:
    """An effect as the list of active effects names it; `variable` < 0: the words are constant.

    `again`: another case of the effect in the row before, which is told once.
    """

    literals: Case
    words: str
    variable: int
    unit: str
    again: bool = False


@dataclass
class Rules:
    """The rules that hold for FMU values over the scene `base` in a model ("chain" or "tow")."""

    rows: Sequence[Variable]
    base: Scene
    model: str

    @functools.cached_property
    def _parameters(self) -> list[int]:
        return [vr for vr, row in enumerate(self.rows) if row.causality == "parameter"]

    @functools.cached_property
    def _place(self) -> Mapping[str, int]:
        """The variables of the parameters by their names in scenes."""
        return {self.rows[vr].scene_name: vr for vr in self._parameters}

    def _cases(self, condition: Condition, model: str) -> list[Case]:
        return literals(condition, self._place, self.base, model)

    def refusals(self) -> list[Refusal]:
        """The rules that join several values, and what a grid does not have."""
        found = []
        for rule in RULES:
            if rule.name in self._place:
                text = f"{rule.must}. {rule.remedy}"
                found += [Refusal(tuple(sorted(case)), self._place[rule.name], text) for case in self._cases(rule.broken, CHAIN)]
        for condition, effect, grid in self._grids():
            for case in self._cases(condition, CHAIN):
                name = self._named(effect, case)
                if name in self._place:
                    text = self.tail(str(grid_refusal(effect, self.base, grid, name)))
                    found.append(Refusal(tuple(sorted(case)), self._place[name], text))
        return found

    def _named(self, effect: Effect, case: Case) -> str:
        """The value that a case of an effect is about."""
        of_case = (name for name in effect.because if any(self._place.get(name) == variable % CHANGED for variable, _ in case))
        return next(of_case, effect.because[-1])

    def start_rules(self) -> list[AtStart]:
        """The rules of the inputs at the start."""
        place = {row.scene_name or row.name: vr for vr, row in enumerate(self.rows)}
        return [
            AtStart(case, place[r.name], place[r.other], place.get(r.slack, -1), r.times, r.equal, r.words)
            for r in START_RULES
            for case in self._cases(r.when, self.model)
        ]

    @staticmethod
    def _grids() -> Iterator[tuple[Condition, Effect, str]]:
        """When an effect is refused on a grid that has it not."""
        for effect in EFFECTS:
            for grid, chosen in ((BOX, ON_BOX), (STAGGERED, ~ON_BOX)):
                condition = refused_on(effect, grid)
                if condition is not None:
                    yield condition & chosen, effect, grid

    @functools.cached_property
    def _excluded(self) -> list[set[tuple[int, bool]]]:
        return [set(refusal.literals) for refusal in self.refusals()]

    def _when(self, effect: Effect) -> list[Case]:
        """When an effect is on: cases of literals, without those that follow from others since their contrary is refused."""
        asked = when(effect, self.model)
        alternatives = [()] if asked is True else [] if asked is False else self._cases(asked, self.model)
        return list(dict.fromkeys(map(self._shortened, alternatives)))

    def _shortened(self, case: Case) -> Case:
        kept = set(case)
        for variable, given in case:
            if any(refused <= kept - {(variable, given)} | {(variable, not given)} for refused in self._excluded):
                kept.discard((variable, given))
        return tuple(sorted(kept))

    def parts(self) -> dict[str, list[Case]]:
        """When each part is present: cases of literals; [()] always, [] never."""
        return {effect.name: self._when(effect) for effect in EFFECTS if effect.part}

    def reasons(self) -> list[Reason]:
        """The effects that may be active, as simulated.effects names them."""
        made: dict[str, list[Reason]] = {}
        for effect in EFFECTS:
            told = self._told(effect)
            if told and effect.words not in made:
                made[effect.words] = [self._reason(effect, case, told) for case in told]
        return [reason for group in made.values() for reason in group]

    def _reason(self, effect: Effect, case: Case, told: list[Case]) -> Reason:
        """The words of one of the cases in which an effect is told: the value that decides on it."""
        name = decides(effect, self.base) if len(told) == 1 else self._named(effect, case)
        if name not in self._place:
            return Reason(case, f"{effect.words} ({why(effect, self.base, self.model)})", -1, "")
        unit = field_of(name).metadata["unit"]
        return Reason(case, f"{effect.words} ({name} = ", self._place[name], "" if unit == "1" else unit, case != told[0])

    def _told(self, effect: Effect) -> list[Case]:
        """When lists of effects have this one: cases of literals."""
        if not effect.words or self.model not in effect.models:
            return []
        alternatives = self._when(effect)
        if not effect.inverse:
            return alternatives
        if not alternatives:
            return [()]
        if [len(case) for case in alternatives] != [1]:
            raise ValueError(f"{effect.name}: the contrary of several values. Teach the C layer alternatives.")
        (((variable, given),),) = alternatives
        return [((variable, not given),)]

    @functools.cached_property
    def kept(self) -> Mapping[str, str]:
        """What the parameters must be that must keep their start values, by their names."""
        found = kept(self.base, self.model)
        if has_sea(self.base, self.model):
            for name in _SEA:
                start = self.rows[self._place[scene_name(name)]].start
                found.setdefault(name, (f"{start:g} where a sea is baked into a native FMU", "Bake it with this value."))
        return {name: f"{rule}. {remedy}" for name, (rule, remedy) in found.items()}

    def numbers(self) -> list[tuple[int, int]]:
        """For each number of the kernels the variable that it is, and the one that takes its place below zero (or -1)."""
        return [(self._place[name], self._place.get(INSTEAD.get(name, ""), -1)) for name in PARAMETERS]

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
            with_values(self.base, {row.scene_name: in_scenes(row, value)})
        except ParameterError as error:
            return str(error)
        return ""

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
