"""Loads the kernels that an FMU ships as object code, with llvmlite alone: neither numba nor a compiler, and no physics.

Where the object code cannot serve, it says why, and numba compiles the kernels.  The head of an entry is `fmu_src.native.export.ENTRY`.
"""

from __future__ import annotations

import ctypes
import functools
import hashlib
import os
import sys
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from cable_model.calls import Calls
from cable_model.entries import ADVANCE, END, EXTERNAL, NODES, OUTPUTS, SHAPE, SIZES, START, STEP, TABLES, WORK, Variant, serves
from cable_model.errors import SolverError
from cable_model.kernels import header
from cable_model.model import Model
from cable_model.signals import INPUTS
from cable_model.signals import OUTPUTS as SIGNALS

_KINDS: dict[str, Any] = {"i": ctypes.c_int64, "d": ctypes.c_double, "p": ctypes.c_void_p}
_KINDS_OF_ENTRY = "ppiddippp" + "pi" * len(TABLES) + "pipip"
_ENTRY = ctypes.CFUNCTYPE(ctypes.c_int32, *(_KINDS[kind] for kind in _KINDS_OF_ENTRY))  # releases the interpreter's lock
# no current is one level at rest
_NO_ROWS = {name: np.zeros((columns, 0) if name == "waves" else (int(name == "current"), columns)) for name, columns in TABLES.items()}


class ObjectCode:
    """Object code with the entries kernel_0, kernel_1, ... of some variants.  It is loaded once, when the first model asks for it."""

    def __init__(self, code: bytes = b"", variants: Sequence[Variant] = (), digest: str = "") -> None:
        """`digest` (SHA-256): of the code that may run; none: of any."""
        self._code, self._variants = code, variants
        self.changed = bool(digest) and hashlib.sha256(code).hexdigest() != digest

    def calls(self, model: Model) -> Calls | None:
        """The calls of a model; None where `refusal` says why not."""
        if self.refusal(model):
            return None
        engine, entries = self._loaded
        return Precompiled(entries[self._serving(model)[0]], model, engine)

    def _serving(self, model: Model) -> list[int]:
        released = model.scene.lower_end.released
        return [k for k, variant in enumerate(self._variants) if serves(variant, model.parts, released)]

    def refusal(self, model: Model) -> str:
        """Why the object code does not serve a model; "" where it does."""
        if self.changed:
            return "the object code is not the one that the FMU was built with"
        if not self._code:
            return "the FMU was built without object code"
        if not self._serving(model):
            return "no variant in the object code has these effects"
        return self._unloadable

    @functools.cached_property
    def _unloadable(self) -> str:
        """Why the object code cannot be loaded here; "" where it can."""
        if not sys.platform.startswith("linux") or os.uname().machine != "x86_64":
            return "the object code is for 64-bit x86 Linux"
        try:
            _ = self._loaded
        except (ImportError, OSError, RuntimeError, AttributeError) as error:
            return f"llvmlite could not load the object code ({error})"
        return ""

    @functools.cached_property
    def _loaded(self) -> tuple[object, list[Callable[..., int]]]:
        """LLVM's engine, which owns the machine code, and the entries."""
        import llvmlite.binding as llvm

        llvm.initialize_native_target()
        llvm.initialize_native_asmprinter()
        llvm.load_library_permanently("libm.so.6")
        missing = [name for name in EXTERNAL if llvm.address_of_symbol(name) is None]
        if missing:  # LLVM ends the process where it misses one
            raise RuntimeError(f"{', '.join(missing)} not found")
        machine = llvm.Target.from_triple("x86_64-unknown-linux-gnu").create_target_machine()
        engine = llvm.create_mcjit_compiler(llvm.parse_assembly(""), machine)
        engine.add_object_file(llvm.ObjectFileRef.from_data(self._code))
        engine.finalize_object()
        return engine, [_ENTRY(engine.get_function_address(f"kernel_{k}")) for k in range(len(self._variants))]


_shared: dict[str, ObjectCode] = {}


def shared(digest: str, path: Path, variants: Sequence[Variant]) -> ObjectCode:
    """The object code in a file, one for all FMUs that have the same; code with another digest than this does not run."""
    if digest not in _shared:
        code = ObjectCode(path.read_bytes() if path.is_file() else b"", variants, digest)
        if code.changed:
            return code
        _shared[digest] = code
    return _shared[digest]


def _at(array: np.ndarray) -> int:
    return int(array.ctypes.data)


class Precompiled:
    """Calls of one entry."""

    def __init__(self, entry: Callable[..., int], model: Model, engine: object) -> None:
        parts = model.parts
        tables = [_NO_ROWS[name] if getattr(parts, name) is None else getattr(parts, name) for name in TABLES]
        self._inputs, self._new, self._status = np.zeros(len(INPUTS)), np.zeros(len(SIGNALS)), np.zeros(2, dtype=np.int64)
        released = getattr(model, "scene", None) is not None and model.scene.lower_end.released
        present = np.array([*(float(part is not None) for part in parts), float(released)])
        self._held = (model.numbers, present, tables, engine)  # only their addresses are passed
        counts = [table.shape[name == "waves"] for name, table in zip(TABLES, tables, strict=True)]
        rows = [given for table, count in zip(tables, counts, strict=True) for given in (_at(table), count)]
        fixed = (_at(self._inputs), _at(model.numbers), _at(present), *rows)
        new_at, status = _at(self._new), (_at(self._status), _at(self._status) + 8)
        entry(*status, SIZES, 0.0, 0.0, 0, *fixed, None, 0, None, 0, new_at)
        sizes = self._new[:2].astype(int)
        self.state, work = np.zeros(sizes[0]), np.zeros(sizes[1])
        self._end, self.work = work[END:WORK], work[WORK:]
        self.outputs = np.zeros(len(SIGNALS))
        self.end_speed = 0.0
        arrays = (*fixed, _at(self.state), len(self.state), _at(work), len(work))
        self._call: Callable[..., int] = lambda what, time, step, order=model.motion_order, out=new_at: entry(
            *status, what, time, step, order, *arrays, out
        )

    def _run(self, what: int, time: float, step: float, inputs: np.ndarray) -> int:
        self._inputs[:] = inputs
        if self._call(what, time, step):  # what numba would raise
            return header.NOT_FINITE
        status = int(self._status[0])
        if status == header.OK:
            self.outputs[:] = self._new
        else:
            self.end_speed = float(self._new[0])
        return status

    def start(self, time: float, inputs: np.ndarray) -> int:
        return self._run(START, time, 0.0, inputs)

    def step(self, time: float, step: float, inputs: np.ndarray) -> int:
        return self._run(STEP, time, step, inputs)

    def advance(self, time: float, step: float, start: np.ndarray, end: np.ndarray) -> int:
        self._end[:] = end
        return self._run(ADVANCE, time, step, start)

    def points(self, even: bool, at: np.ndarray) -> None:
        told = np.zeros(len(SIGNALS) + at.size)
        if self._call(SHAPE if even else NODES, 0.0, 0.0, len(at), _at(told)):  # what numba would raise
            raise SolverError("points along the cable: could not be worked out")
        at[:] = told[len(SIGNALS) :].reshape(at.shape)

    def read_outputs(self) -> None:
        self._run(OUTPUTS, 0.0, 0.0, self._inputs)
