"""Models that start at once: on the object code that building FMUs left in the user's cache, where it has a scene's effects.

Else numba compiles exactly these effects, which takes half a minute the first time and is the faster code.  Physics is the same, to
rounding.
"""

from __future__ import annotations

import functools
from pathlib import Path

from cable_model.calls import Calls
from cable_model.model import Model
from fmu_src.native.object_code import GENERIC, place
from fmu_src.precompiled import ObjectCode


@functools.cache
def _code(model: str) -> ObjectCode:
    path: Path = place(model, GENERIC[model])
    return ObjectCode(path.read_bytes() if path.is_file() else b"", GENERIC[model])


def calls(model: Model) -> Calls | None:
    """Calls of the object code that lies ready; None where there is none, or none that serves this model."""
    return _code(model.name).calls(model)
