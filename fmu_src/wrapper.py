"""Cures for pythonfmu 0.7.0's compiled wrapper, which gives back twice what it owns once, and never what it only looks at.

Nothing here knows a model.
"""

from __future__ import annotations

import ctypes
import functools
import os
import sys
from pathlib import Path


def keep(*objects: object) -> None:
    """Take a reference to each object that is never given back; the wrapper gives one back too many."""
    for each in objects:
        ctypes.pythonapi.Py_IncRef(ctypes.py_object(each))


def release(taken: object) -> None:
    """Give back the reference that the wrapper forgets: to the bytes of a state that is refused."""
    ctypes.pythonapi.Py_DecRef(ctypes.py_object(taken))


@functools.lru_cache(maxsize=256)
def same_text(text: str) -> str:
    """The same object for the same text: the wrapper keeps every message for ever."""
    return text


def look_here_once(resources: str | None) -> None:
    """Leave one entry in Python's path: the wrapper inserts another one at every instantiation."""
    if resources in sys.path:
        first = sys.path.index(resources)
        sys.path[:] = [place for at, place in enumerate(sys.path) if place != resources or at == first]


class _Quiet(type):
    """Classes whose representation is one object."""

    def __repr__(cls) -> str:
        return same_text(super().__repr__())


def stand_in() -> type:
    """A class that the wrapper takes for the slave's when it looks for that at an instantiation; the slave's it then takes by its name.

    It writes down the names of all bases of what it looks at, for ever: this class has as few as can be.
    """
    base = _Quiet("Fmi2Slave", (), {"__module__": "pythonfmu"})
    return _Quiet("Slave", (base,), {"__module__": "pythonfmu"})


def library_of(resources: Path, identifier: str) -> Path:
    """pythonfmu's library of an unzipped FMU: beside its launcher, or where there is none, in its place."""
    folder = resources.parent / "binaries" / "linux64"
    behind = folder / f"{identifier}_pythonfmu.so"
    return behind if behind.is_file() else folder / f"{identifier}.so"


def forget_interpreter(resources: str | None, identifier: str) -> None:
    """Let the wrapper forget its handle on an interpreter that it did not start.

    On Linux it frees that handle twice when it is unloaded, which aborts the host at its exit.  Where the wrapper started the
    interpreter itself (a host that is not Python has no command line in sys.orig_argv), the handle must stay.
    """
    if resources is None or not sys.platform.startswith("linux") or not sys.orig_argv:
        return
    try:
        import _ctypes

        loaded = ctypes.CDLL(str(library_of(Path(resources), identifier)), mode=os.RTLD_NOLOAD | os.RTLD_NOW)
        loaded.finalizePythonInterpreter()
        _ctypes.dlclose(loaded._handle)
    except (ImportError, OSError, AttributeError):
        return
