"""Random FMI call sequences on one FMU, in a process of its own: `python fmu_sequences.py FOLDER IDENTIFIER GUID COUNT BREADCRUMB`.

hypothesis draws the sequences.  What must hold: no crash, no fatal status, no OK with a NaN, every message with a category of the
description.  Then the same sequences twice more, and busy lives: the second pass may hold no more memory than the first, but for 1 kB
each.
What is being run is written to BREADCRUMB before, so that a crash can be told.
"""

from __future__ import annotations

import ctypes
import gc
import math
import os
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import hypothesis
from fmi_calls import DISCARD, ERROR, OK, WARNING, Component, Library
from hypothesis import strategies as st

from cable_model.signals import INPUTS, OUTPUTS
from fmu_src.interface import table
from fmu_src.model_description import LOG_CATEGORIES

ROWS = table()
PLACE = {row.name: reference for reference, row in enumerate(ROWS)}
LEAK = 1000  # bytes a sequence
# whose values any scene may have without a compilation by numba or a step that takes minutes
REALS = (
    "cable.length", "cable.diameter", "cable.mass_per_length", "cable.axial_stiffness", "cable.axial_damping", "body.mass", "body.volume",
    "lower_end.x", "lower_end.z", "water.density", "current.speed", "wave.amplitude", "seabed.stiffness", "seabed.level",
    "solver.slack_damping",
)  # fmt: skip
VALUES = (0.0, 1.0, -1.0, 0.3, 10.0, -50.0, 100.0, 1e4, 1e6, -0.0, 5e-324, 1e300, math.nan, math.inf, -math.inf)
INTEGERS = {"solver.nodes": (3, 5, 20, 0, -1, 2**31 - 1), "top.motion_order": (0, 1, 2, 3, -7), "solver.integrator": (0, 1, 99)}
BOOLEANS = ("solver.space", "lower_end.anchored", "winch.fitted", "cable.compressible", "water.surface")
TIMES = (0.0, 0.0, 0.0, 0.0, 1e-12, -1e-12, 0.1, -0.05, math.nan, math.inf, 1e300)  # off the time that is due
STEPS = (0.05, 0.05, 0.05, 0.01, 0.1, 1e-3, 1e-9, 2e-14, 0.0, -0.1, math.nan, math.inf, 1e-320)
NO_ARGUMENTS = ("EnterInitializationMode", "ExitInitializationMode", "Terminate", "Reset", "CancelStep")

reference = st.one_of(st.sampled_from([*range(60), *range(60)]), st.sampled_from([2**31, 2**32 - 1, 10**6, len(ROWS)]))
kind = st.sampled_from(["Real", "Integer", "Boolean", "String"])
inputs = st.tuples(st.just("inputs"), st.lists(st.tuples(st.sampled_from(INPUTS), st.sampled_from(VALUES)), max_size=4))
reals = st.tuples(st.just("reals"), st.lists(st.tuples(st.sampled_from(REALS), st.sampled_from(VALUES)), max_size=3))
integers = st.sampled_from(sorted(INTEGERS)).flatmap(
    lambda name: st.tuples(st.just("integer"), st.just(name), st.sampled_from(INTEGERS[name]))
)
booleans = st.tuples(st.just("boolean"), st.sampled_from(BOOLEANS), st.sampled_from([0, 1, 7, -1]))
step = st.tuples(st.just("step"), st.sampled_from(TIMES), st.sampled_from(STEPS))
steps = st.tuples(st.just("steps"), st.integers(1, 5))
get = st.tuples(st.just("get"), kind, st.lists(reference, max_size=5))
outputs = st.tuples(st.just("get"), st.just("Real"), st.just([PLACE[name] for name in (*OUTPUTS, "solver.cpu_time")]))
wrong_set = st.tuples(
    st.just("set"), kind, st.lists(st.sampled_from([PLACE["top.tension"], PLACE["effects.active"], 2**31, 12345]), max_size=2)
)
plain = st.tuples(st.just("call"), st.sampled_from(NO_ARGUMENTS))
setup = st.tuples(st.just("setup"), st.sampled_from([0.0, 0.0, 5.0, -1.0, math.nan]), st.sampled_from([None, None, 0.2, 100.0, math.inf]))
running = st.just(("initialize",))
log = st.tuples(st.just("log"), st.integers(0, 1), st.lists(st.sampled_from([*LOG_CATEGORIES, "nothing", None]), max_size=2))
states = st.tuples(st.just("state"), st.sampled_from(["save", "restore", "free", "write", "read"]), st.integers(0, 2))
bad_bytes = st.tuples(st.just("bytes"), st.integers(0, 2), st.integers(0, 10**6), st.sampled_from(["flip", "cut", "add", "none"]))
status = st.tuples(st.just("status"), st.sampled_from(["GetRealStatus", "GetBooleanStatus", "GetStatus"]), st.integers(0, 3))
operation = st.one_of(
    inputs, reals, integers, booleans, step, steps, outputs, get, wrong_set, plain, setup, running, log, states, bad_bytes, status
)
sequences = st.lists(operation, min_size=1, max_size=20).flatmap(
    lambda operations: st.sampled_from([operations, [("initialize",), *operations], [("initialize",), ("steps", 2), *operations]])
)

Life = list[tuple[Any, ...]]
# ten times all that takes memory: a leak of any of it is above the limit
BUSY: Life = [
    ("initialize",), ("steps", 2),
    *[
        ("state", "save", 0), ("state", "write", 0), ("state", "read", 0), ("state", "restore", 0), ("bytes", 0, 100, "flip"),
        ("bytes", 0, 1000, "cut"), ("inputs", [("top.x", math.nan)]), ("step", 0.1, 0.05), ("step", 0.0, 0.05), ("initialize",),
    ] * 10,
]  # fmt: skip


class Run:
    """One instance under one sequence."""

    def __init__(self, library: Library, guid: str, chain: bool) -> None:
        self.chain = chain
        self.component = Component(library, guid, logging=0)
        assert self.component.at is not None, self.component.texts
        self.states = [ctypes.c_void_p() for _ in range(3)]
        self.data = [b""] * 3
        self.due = 0.0

    def end(self) -> None:
        for state in self.states:
            self.component.free_state(state)
        self.component.free()

    def do(self, operation: tuple[Any, ...]) -> None:
        name, *arguments = operation
        getattr(self, f"_{name}")(*arguments)
        for status, category, text in self.component.messages:
            assert category is not None and category.decode() in LOG_CATEGORIES and text and status < 4, (status, category, text)
        self.component.messages.clear()

    def _told(self, status: int) -> int:
        assert status in (OK, WARNING, DISCARD, ERROR), f"status {status}"
        return status

    def _inputs(self, values: list[tuple[str, float]]) -> None:
        self._told(self.component.set("Real", [PLACE[name] for name, _ in values], [value for _, value in values]))

    _reals = _inputs

    def _integer(self, name: str, value: int) -> None:
        self._told(self.component.set("Integer", [PLACE[name]], [value]))

    def _boolean(self, name: str, value: int) -> None:
        self._told(self.component.set("Boolean", [PLACE[name]], [value]))

    def _set(self, kind: str, references: list[int]) -> None:
        values = [b"text" if kind == "String" else 1] * len(references)
        status = self._told(self.component.set(kind, references, values))
        assert status == (ERROR if references else OK)

    def _get(self, kind: str, references: list[int]) -> None:
        status, values = self.component.get(kind, references)
        if self._told(status) == OK and kind == "Real":
            assert all(map(math.isfinite, values)), values
        elif status == OK and kind == "String":
            assert None not in values

    def _step(self, off: float, step: float) -> None:
        if self._told(self.component.step(self.due + off, step)) == OK:
            assert step > 0.0 and math.isfinite(step) and abs(off) < 1e-5
            self.due += off + step
        self._get("Real", [PLACE[name] for name in OUTPUTS])

    def _steps(self, count: int) -> None:
        for _ in range(count):
            self._step(0.0, 0.05)

    def _setup(self, start: float, stop: float | None) -> None:
        if self._told(self.component.set_up(start, stop)) == OK:
            self.due = start

    def _call(self, name: str) -> None:
        self._told(self.component.call(name))

    def _initialize(self) -> None:
        """Whatever was before: reset, it is as new."""
        assert self.component.call("Reset") == OK
        self.due = 0.0
        if self.chain:
            assert self.component.set("Integer", [PLACE["solver.nodes"]], [11]) == OK
        assert self.component.initialize() == OK, self.component.texts

    def _log(self, on: int, categories: list[str | None]) -> None:
        self._told(self.component.choose(on, *(None if name is None else name.encode() for name in categories)))

    def _state(self, what: str, k: int) -> None:
        state = self.states[k]
        if what == "read":
            status = self.component.from_bytes(self.data[k], state)
        elif what == "write":
            status, size = self.component.size(state)
            if status == OK:
                status, self.data[k] = self.component.as_bytes(state, size)
        else:
            status = {"save": self.component.save, "restore": self.component.restore, "free": self.component.free_state}[what](state)
        if self._told(status) == OK and what == "restore":
            time = ctypes.c_double(self.due)
            self.component.call("GetRealStatus", 2, ctypes.byref(time))
            self.due = time.value

    def _bytes(self, k: int, at: int, how: str) -> None:
        """Damaged bytes are refused, and what was in their place is still there."""
        data = self.data[k]
        if not data:
            return
        at %= len(data)
        damaged = {"flip": data[:at] + bytes([data[at] ^ 0x40]) + data[at + 1 :], "cut": data[:at], "add": data + b"\0", "none": b""}[how]
        assert self._told(self.component.from_bytes(damaged, self.states[k])) == ERROR

    def _status(self, name: str, what: int) -> None:
        room = (ctypes.c_double * 1)(0.0)
        if self._told(self.component.call(name, what, room)) == OK:
            assert math.isfinite(room[0])


class _Mallinfo(ctypes.Structure):
    _names = "arena ordblks smblks hblks hblkhd usmblks fsmblks uordblks fordblks keepcost"
    _fields_ = tuple((name, ctypes.c_size_t) for name in _names.split())


def held() -> int:
    """Bytes that this process has from malloc and has not freed; run with PYTHONMALLOC=malloc."""
    gc.collect()
    libc = ctypes.CDLL(None)
    libc.mallinfo2.restype = _Mallinfo
    info = libc.mallinfo2()
    return int(info.uordblks + info.hblkhd)


def growth(one: Callable[[Life], None], lives: list[Life]) -> int:
    """Bytes that running them leaves behind."""
    before = held()
    for operations in lives:
        one(operations)
    return held() - before


def main(folder: str, identifier: str, guid: str, count: str, breadcrumb: str) -> None:
    library, ran = Library(Path(folder), identifier), []

    def one(operations: Life) -> None:
        run = Run(library, guid, identifier == "CableChain")
        try:
            for operation in operations:
                run.do(operation)
        finally:
            run.end()

    @hypothesis.settings(
        max_examples=int(count), deadline=None, database=None, derandomize=True, suppress_health_check=list(hypothesis.HealthCheck)
    )
    @hypothesis.given(sequences)
    def any_sequence(operations: Life) -> None:
        Path(breadcrumb).write_text(repr(operations), encoding="utf-8")
        ran.append(operations)
        one(operations)

    any_sequence()
    if "LEAKS" in os.environ:  # malloc is not libc's
        return
    for what, lives in (("sequences", ran), ("busy lives", [BUSY] * 20)):
        growth(one, lives)  # what is kept once
        leak = min(growth(one, lives) for _ in range(2)) / len(lives)
        sys.stdout.write(f"{len(lives)} {what}, {leak:.0f} bytes each\n")
        assert leak < LEAK, f"{leak:.0f} bytes each of {what}"


if __name__ == "__main__":
    main(*sys.argv[1:])
