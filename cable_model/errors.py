"""The two errors of the package and the one form of their texts."""

from __future__ import annotations

import difflib
from collections.abc import Iterable


class ParameterError(ValueError):
    """A value that was given cannot be used; the text names it, its unit, the rule it breaks and what to do."""


class SolverError(RuntimeError):
    """A step failed; the text says when, where, how badly and what to try.  Results before it stay valid."""


def refuse(name: str, value: object, unit: str, rule: str, remedy: str) -> ParameterError:
    """The error `<name> = <value> <unit>: must be <rule>. <what to do>`."""
    shown = f"{value:.10g}" if isinstance(value, float) else repr(value)
    return ParameterError(f"{name} = {shown}{' ' + unit if unit else ''}: must be {rule}. {remedy}")


def unknown(name: str, known: Iterable[str], what: str = "key") -> ParameterError:
    """The error for a name that nobody knows, with the nearest known one."""
    choices = sorted(known)
    near = difflib.get_close_matches(name, choices, n=1, cutoff=0.0)
    hint = f" Did you mean {near[0]!r}?" if near else ""
    return ParameterError(f"{name}: unknown {what}.{hint} Known: {', '.join(choices)}.")
