"""Compiled entries of the kernels: what they are asked for, what they ask for, and which scenes they serve.  Words for numbers only.

`fmu_src.native.export` compiles them; the native FMU links them, and `cable_model.precompiled` loads them.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from cable_model.signals import INPUTS

# a part in a variant: compiled without, compiled in, decided at run time, compiled in where zeros give what its absence gives
ABSENT, PRESENT, EITHER, ALWAYS = 0, 1, 2, 3
KINDS = {"absent": ABSENT, "present": PRESENT, "either": EITHER, "always": ALWAYS}  # by their words in the table of effects
# the tables that an entry takes, and their columns; of waves the rows, as many numbers of each component
TABLES = {"current": 3, "current_table": 4, "waves": 10, "curve": 3, "relief": 6, "sections": 11, "line_bodies": 5}
RELEASED = "released"  # beside the parts of a variant, and after them where they are told: whether the lower end is let go at the start
SIZES, START, STEP, ADVANCE, NODES, OUTPUTS, SHAPE = range(7)  # what an entry is asked for, see fmu_src.native.export
ROWS, COLUMNS = 9, 9  # of a path of the cable's ends
PATH, END, WORK = 0, ROWS * COLUMNS, ROWS * COLUMNS + len(INPUTS)  # places in an entry's work array: path, end inputs, kernels' own
EXTERNAL = (
    "acos", "asin", "atan", "atan2", "ceil", "cos", "cosh", "exp", "expm1", "floor", "fmod", "hypot", "log", "log1p", "memcpy", "memmove",
    "memset", "pow", "round", "sin", "sincos", "sinh", "sqrt", "tan", "tanh", "trunc",
)  # fmt: skip
"""All that entries may call of libc and libm."""

Variant = Mapping[str, int]


def serves(variant: Variant, parts: Any, released: bool = False) -> bool:
    """Whether a variant does what a scene with these parts asks for; `released`: whose lower end is let go."""
    if variant.get(RELEASED, ABSENT) not in (EITHER, PRESENT if released else ABSENT):
        return False
    asked = {name: ABSENT if part is None else PRESENT for name, part in parts._asdict().items()}
    return all(variant[name] in (kind, EITHER, ALWAYS) for name, kind in asked.items())
