"""Compiled kernels that numba keeps on disk: files that were damaged there are removed, and the error says so."""

from __future__ import annotations

import contextlib
import traceback
from collections.abc import Iterator
from pathlib import Path

from cable_model.errors import ParameterError


def _damaged_folder(error: BaseException) -> Path | None:
    """Where numba was reading when an error came up; None where it was not reading.  A damaged pickle raises any kind of error."""
    for frame, _ in traceback.walk_tb(error.__traceback__):
        index = getattr(frame.f_locals.get("self"), "_index_path", None)
        if frame.f_globals.get("__name__") == "numba.core.caching" and isinstance(index, str):
            return Path(index).parent
    return None


@contextlib.contextmanager
def mended() -> Iterator[None]:
    """While kernels are called: where their cache is damaged it is emptied, with a ParameterError; the next call compiles them anew."""
    try:
        yield
    except Exception as error:
        folder = None if isinstance(error, OSError) else _damaged_folder(error)  # a full disk is no damage
        if folder is None:
            raise
        for path in (*folder.glob("*.nbi"), *folder.glob("*.nbc")):
            path.unlink(missing_ok=True)
        raise ParameterError(f"{folder}: the compiled kernels there were damaged, and are removed. Call it again.") from error
