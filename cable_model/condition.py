"""Conditions on the values of a scene, as data: evaluated for a scene, and written out as alternatives of literals for C."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass


class Condition:
    """Joined with `&`, `|` and `~`; what it asks for are Given, Chosen, Changed and On."""

    def __and__(self, other: Condition) -> Condition:
        return Both(self, other)

    def __or__(self, other: Condition) -> Condition:
        return ~(~self & ~other)

    def __invert__(self) -> Condition:
        return self.term if isinstance(self, Not) else Not(self)


@dataclass(frozen=True)
class Given(Condition):
    """The value is neither zero, false, empty nor the first choice; an angle, or one in a `column` of a table, is not along x."""

    name: str
    column: int = -1


@dataclass(frozen=True)
class Chosen(Condition):
    """The value is this one of its choices."""

    name: str
    choice: str


@dataclass(frozen=True)
class Changed(Condition):
    """The value is not its default."""

    name: str


@dataclass(frozen=True)
class On(Condition):
    """An effect is simulated by the model at hand."""

    effect: str


@dataclass(frozen=True)
class Both(Condition):
    one: Condition
    other: Condition


@dataclass(frozen=True)
class Not(Condition):
    term: Condition


def holds(condition: Condition, leaf: Callable[[Condition], bool]) -> bool:
    """The condition's value; `leaf` answers for what it asks for."""
    if isinstance(condition, Both):
        return holds(condition.one, leaf) and holds(condition.other, leaf)
    if isinstance(condition, Not):
        return not holds(condition.term, leaf)
    return leaf(condition)


def leaves(condition: Condition | None) -> list[Condition]:
    """What a condition asks for, in its order."""
    if isinstance(condition, Both):
        return [*leaves(condition.one), *leaves(condition.other)]
    if isinstance(condition, Not):
        return leaves(condition.term)
    return [] if condition is None else [condition]


def names(condition: Condition) -> list[str]:
    """The names of the values that a condition asks for, in their order."""
    return [leaf.name for leaf in leaves(condition) if isinstance(leaf, Given | Chosen | Changed)]


Literal = tuple[int, bool]  # a variable of an FMU, and whether its value is given; or CHANGED beyond it, and whether it is not the usual
CHANGED = 1 << 16
Case = tuple[Literal, ...]


def cases(condition: Condition, leaf: Callable[[Condition], int | bool | Condition], wanted: bool = True) -> list[Case]:
    """The condition, or its contrary, as alternatives of literals: [()] holds always, [] never.

    `leaf` answers for what is asked for with the number of a variable, with a condition in its stead, or with a value that is known.
    """
    if isinstance(condition, Not):
        return cases(condition.term, leaf, not wanted)
    if isinstance(condition, Both):
        one, other = (cases(term, leaf, wanted) for term in (condition.one, condition.other))
        joined = [tuple(dict.fromkeys(a + b)) for a in one for b in other] if wanted else one + other
        possible = [case for case in dict.fromkeys(joined) if not any((variable, not given) in case for variable, given in case)]
        return [case for case in possible if not any(set(shorter) < set(case) for shorter in possible)]
    answer = leaf(condition)
    if isinstance(answer, bool):
        return [()] if answer is wanted else []
    return [((answer, wanted),)] if isinstance(answer, int) else cases(answer, leaf, wanted)
