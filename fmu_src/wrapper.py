"""Cures for pythonfmu 0.7.0's compiled wrapper, which gives back twice what it owns once.  Nothing here knows a model."""

from __future__ import annotations

import ctypes
import os
import sys
from pathlib import Path


def keep(*objects: object) -> None:
    """Take a reference to each object that is never given back; the wrapper gives one back too many."""
    for each in objects:
        ctypes.pythonapi.Py_IncRef(ctypes.py_object(each))


def forget_interpreter(resources: str | None, identifier: str) -> None:
    """Let the wrapper forget its handle on an interpreter that it did not start.

    On Linux it frees that handle twice when it is unloaded, which aborts the host at its exit.  Where the wrapper started the
    interpreter itself (a host that is not Python has no command line in sys.orig_argv), the handle must stay.
    """
    if resources is None or not sys.platform.startswith("linux") or not sys.orig_argv:
        return
    library = Path(resources).parent / "binaries" / "linux64" / f"{identifier}.so"
    try:
        import _ctypes

        loaded = ctypes.CDLL(str(library), mode=os.RTLD_NOLOAD | os.RTLD_NOW)
        loaded.finalizePythonInterpreter()
        _ctypes.dlclose(loaded._handle)
    except (ImportError, OSError, AttributeError):
        return
