"""Kernels that lie ready: object code that serves every scene, so that a run starts at once.

A wheel ships it, and `cable-fmu prepare` puts it into the user's cache; else what building FMUs left there serves most scenes.  It gives
the bits of what numba compiles for exactly the effects of a scene, but for the order in which many waves are summed, at 0.8 to 1.2 of its
cost.  Where none serves a scene numba compiles, which takes a quarter of a minute the first time.
"""

from __future__ import annotations

import functools
import hashlib
import json
import os
import sys
from collections.abc import Sequence
from importlib.metadata import version
from pathlib import Path

from cable_model.calls import Calls
from cable_model.effects import BOX, BY_NAME, CHAIN, EFFECTS, STAGGERED, TOW, variant
from cable_model.entries import ABSENT, EITHER, KINDS, PRESENT, RELEASED, Variant
from cable_model.model import Model
from cable_model.precompiled import ObjectCode

ROOT = Path(__file__).resolve().parents[1]
SHIPPED = ROOT / "cable_model" / "object_code"
KERNELS = ROOT / "cable_model" / "kernels"
# beside the kernels, what object code is made of
_MADE_BY = (
    "cable_model/calls.py",
    "cable_model/effects.py",
    "cable_model/entries.py",
    "cable_model/signals.py",
    "fmu_src/native/export.py",
    "fmu_src/native/presence.py",
    "fmu_src/native/reshape.py",
)
# of files with object code for 64-bit x86 Linux, and with what that of all platforms of FMUs is made of
SUFFIX, BITCODE = "-x86_64-unknown-linux-gnu.o", ".bc"
OLDEST, RECENT = "x86-64", "x86-64-v3"  # processors, as LLVM calls them: what FMUs are for, and what runs in the library
_RECENT = ("avx2", "bmi", "bmi2", "f16c", "fma", "lzcnt", "movbe")  # what the second has beyond the first

# of FMUs without a baked scene, whose parameters switch parts on and off: in the plane, and in space
GENERIC: dict[str, tuple[Variant, ...]] = {
    model: tuple({part: KINDS[kind] for part, kind in variant(model, space).items()} for space in (False, True)) for model in (CHAIN, TOW)
}


def _every_effect(model: str, grid: str, **fixed: int) -> Variant:
    """A variant in which all that a model has on a grid is decided at run time, but for what decides on the size of vectors: `fixed`."""
    has = {effect.name: model in effect.models and (model == TOW or grid in effect.grids) for effect in EFFECTS if effect.part}
    kinds = {name: KINDS[BY_NAME[name].native] if has_it else ABSENT for name, has_it in has.items()}
    parts = {name: EITHER if has[name] and kind == ABSENT else kind for name, kind in kinds.items()}
    released = EITHER if (model, grid) == (CHAIN, STAGGERED) else ABSENT
    return {**parts, "space": ABSENT, "box": ABSENT, RELEASED: released, **fixed}


# of the library: whatever a scene has
EVERY: dict[str, tuple[Variant, ...]] = {
    CHAIN: (
        *(_every_effect(CHAIN, STAGGERED, space=space) for space in (ABSENT, PRESENT)),
        *(_every_effect(CHAIN, BOX, box=PRESENT, bending=bending) for bending in (ABSENT, PRESENT)),
    ),
    TOW: (_every_effect(TOW, STAGGERED), _every_effect(TOW, STAGGERED, space=PRESENT, as_printed=ABSENT)),
}


@functools.cache
def _sources() -> bytes:
    """All that object code is made of."""
    paths = (*sorted(KERNELS.glob("*.py")), *(ROOT / path for path in _MADE_BY))
    return b"\0".join(hashlib.sha256(path.read_bytes()).digest() for path in paths)


def key(model: str, variants: Sequence[Variant], processor: str) -> str:
    """A name for the object code of these variants for a processor, by the content of all that it is made of."""
    return hashlib.sha256(_sources() + json.dumps([model, list(variants), processor]).encode()).hexdigest()[:24]


@functools.cache
def compilers() -> str:
    """The versions of all that compiles, by which the user's cache tells apart what they made of the same sources."""
    return "-".join((f"{sys.version_info.major}{sys.version_info.minor}", version("numba"), version("llvmlite")))


def kept(model: str, variants: Sequence[Variant], processor: str, suffix: str = SUFFIX) -> Path:
    """Where the user's cache keeps what was compiled of these variants; `suffix`: BITCODE, or a platform's object code."""
    import platformdirs

    name = f"{key(model, variants, processor)}-{compilers()}{suffix}"
    return Path(platformdirs.user_cache_dir("cable_fmu")) / "native" / name


def shipped(model: str, variants: Sequence[Variant], processor: str, suffix: str = SUFFIX) -> Path:
    """Where a wheel keeps it, which compilers of whatever version have made."""
    return SHIPPED / f"{key(model, variants, processor)}{suffix}"


def found(model: str, variants: Sequence[Variant], processor: str, suffix: str = SUFFIX) -> bytes:
    """What is compiled already of these variants; b"" where nothing is."""
    for place in (shipped, kept):
        path = place(model, variants, processor, suffix)
        if path.is_file():
            return path.read_bytes()
    return b""


@functools.cache
def is_recent() -> bool:
    """Whether this processor runs what is made for RECENT ones."""
    import llvmlite.binding as llvm

    features = llvm.get_host_cpu_features()
    return all(features.get(feature, False) for feature in _RECENT)


@functools.cache
def _code(model: str) -> tuple[ObjectCode, ...]:
    """What lies ready for a model: what was made for FMUs, which has less to decide, and what serves every scene."""
    kinds = [(GENERIC[model], OLDEST)]
    if is_recent():
        kinds.append((EVERY[model], RECENT))
    lying = ((found(model, variants, processor), variants) for variants, processor in kinds)
    return tuple(ObjectCode(code, variants) for code, variants in lying if code)


def calls(model: Model) -> Calls | None:
    """Calls of object code that lies ready; None where there is none, or none that serves this model, or kernels are to be plain Python."""
    if os.environ.get("NUMBA_DISABLE_JIT", "0") not in ("", "0"):
        return None
    code = _code(model.name)
    # sums over many waves are twice as fast on a recent processor
    made = (one.calls(model) for one in (code if model.parts.waves is None else reversed(code)))
    return next((each for each in made if each is not None), None)
