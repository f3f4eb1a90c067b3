"""The two errors of the package and the one form of their texts."""

from __future__ import annotations

import contextlib
import difflib
from collections.abc import Iterable, Iterator

LONGEST = 100  # characters of a value that an error shows


class ParameterError(ValueError):
    """A value that was given cannot be used; the text names it, its unit, the rule it breaks and what to do."""


class SolverError(RuntimeError):
    """A step failed; the text says when, where, how badly and what to try.  Results before it stay valid."""


def refuse(name: str, value: object, unit: str, rule: str, remedy: str) -> ParameterError:
    """The error `<name> = <value> <unit>: must be <rule>. <what to do>`; the unit "1" goes without saying."""
    shown = f"{value:.10g}" if isinstance(value, float) else repr(value)
    if len(shown) > LONGEST:
        shown = f"{shown[: LONGEST // 2]}... ({len(shown)} characters)"
    return ParameterError(f"{name} = {shown}{f' {unit}' if unit not in ('', '1') else ''}: must be {rule}. {remedy}")


def unknown(name: str, known: Iterable[str], what: str = "key") -> ParameterError:
    """The error for a name that nobody knows, with the nearest known one."""
    choices = sorted(known)
    near = difflib.get_close_matches(name, choices, n=1, cutoff=0.0)
    hint = f" Did you mean {near[0]!r}?" if near else ""
    return ParameterError(f"{name}: unknown {what}.{hint} Known: {', '.join(choices)}.")


@contextlib.contextmanager
def reading(source: object) -> Iterator[None]:
    """While a scene is read from `source`: what Python says of numbers of hundreds or thousands of digits becomes a ParameterError."""
    try:
        yield
    except (OverflowError, ValueError) as error:
        long = isinstance(error, OverflowError) or "digits" in str(error)
        if isinstance(error, ParameterError) or not long:
            raise
        raise ParameterError(f"{source}: a number has too many digits ({error}). Numbers must be below 1.8e308.") from error


@contextlib.contextmanager
def writing(path: object) -> Iterator[None]:
    """While a file is written: an error of the system, such as a full disk, names it as it does when a file is opened."""
    try:
        yield
    except OSError as error:
        if error.filename is not None or error.errno is None:
            raise
        raise OSError(error.errno, error.strerror, str(path)) from error
