"""FMI 2.0's C interface through ctypes alone: every call returns its status, whatever is passed; nothing stands between."""

from __future__ import annotations

import ctypes as c
from pathlib import Path
from typing import Any

OK, WARNING, DISCARD, ERROR, FATAL = range(5)
KINDS = {"Real": c.c_double, "Integer": c.c_int, "Boolean": c.c_int, "String": c.c_char_p}
_LOGGER = c.CFUNCTYPE(None, c.c_void_p, c.c_char_p, c.c_int, c.c_char_p, c.c_char_p)
_TAKE, _GIVE_BACK = c.CFUNCTYPE(c.c_void_p, c.c_size_t, c.c_size_t), c.CFUNCTYPE(None, c.c_void_p)
_LIBC = c.CDLL(None)
_LIBC.calloc.restype, _LIBC.calloc.argtypes, _LIBC.free.argtypes = c.c_void_p, [c.c_size_t, c.c_size_t], [c.c_void_p]


class Callbacks(c.Structure):
    _fields_ = (
        ("logger", _LOGGER), ("take", _TAKE), ("give_back", _GIVE_BACK), ("finished", c.c_void_p), ("environment", c.c_void_p),
    )  # fmt: skip


class Library:
    """The library of an unzipped FMU."""

    def __init__(self, folder: Path, identifier: str) -> None:
        self.folder = folder
        self._library = c.CDLL(str(folder / "binaries" / "linux64" / f"{identifier}.so"))

    @property
    def uri(self) -> str:
        return (self.folder / "resources").resolve().as_uri()

    def call(self, name: str, component: int | None, *arguments: Any) -> int:
        function = getattr(self._library, f"fmi2{name}")
        function.restype = c.c_int
        return int(function(c.c_void_p(component), *arguments))

    def instantiate(self, name: bytes | None, kind: int, guid: bytes | None, uri: bytes | None, callbacks: Any, logging: int) -> int | None:
        function = self._library.fmi2Instantiate
        function.restype = c.c_void_p
        result = function(c.c_char_p(name), kind, c.c_char_p(guid), c.c_char_p(uri), callbacks, 0, logging)
        return None if result is None else int(result)

    def free(self, component: int | None) -> None:
        self._library.fmi2FreeInstance.restype = None
        self._library.fmi2FreeInstance(c.c_void_p(component))


class Component:
    """An instance; `messages` holds (status, category, text) of all that it logged, as bytes, None for NULL."""

    def __init__(
        self, library: Library, guid: str, name: bytes | None = b"cable", uri: bytes | None = b"?", kind: int = 1, logging: int = 1
    ):
        self.messages: list[tuple[int, bytes | None, bytes | None]] = []
        self._library = library
        self._callbacks = Callbacks(_LOGGER(self._log), _TAKE(_LIBC.calloc), _GIVE_BACK(_LIBC.free), None, None)
        place = library.uri.encode() if uri == b"?" else uri
        self.at = library.instantiate(name, kind, guid.encode(), place, c.byref(self._callbacks), logging)

    def _log(self, environment: int, name: bytes, status: int, category: bytes, text: bytes) -> None:
        self.messages.append((status, category, text))

    @property
    def texts(self) -> list[str]:
        return [(text or b"").decode() for _, _, text in self.messages]

    def call(self, name: str, *arguments: Any) -> int:
        return self._library.call(name, self.at, *arguments)

    def free(self) -> None:
        self._library.free(self.at)
        self.at = None

    def set_up(self, start: float = 0.0, stop: float | None = None) -> int:
        return self.call("SetupExperiment", 0, c.c_double(0.0), c.c_double(start), int(stop is not None), c.c_double(stop or 0.0))

    def step(self, time: float, step: float) -> int:
        return self.call("DoStep", c.c_double(time), c.c_double(step), 1)

    def set(self, kind: str, references: list[int], values: list[Any]) -> int:
        n = len(references)
        return self.call(f"Set{kind}", (c.c_uint * n)(*references), c.c_size_t(n), (KINDS[kind] * n)(*values))

    def get(self, kind: str, references: list[int]) -> tuple[int, list[Any]]:
        n = len(references)
        values = (KINDS[kind] * n)()
        return self.call(f"Get{kind}", (c.c_uint * n)(*references), c.c_size_t(n), values), list(values)

    def derive(self, references: list[int], orders: list[int], values: list[float]) -> int:
        n = len(references)
        given = ((c.c_uint * n)(*references), c.c_size_t(n), (c.c_int * n)(*orders), (c.c_double * n)(*values))
        return self.call("SetRealInputDerivatives", *given)

    def initialize(self) -> int:
        return max(self.set_up(), self.call("EnterInitializationMode"), self.call("ExitInitializationMode"))

    def save(self, state: c.c_void_p) -> int:
        return self.call("GetFMUstate", c.byref(state))

    def restore(self, state: c.c_void_p) -> int:
        return self.call("SetFMUstate", state)

    def free_state(self, state: c.c_void_p) -> int:
        return self.call("FreeFMUstate", c.byref(state))

    def size(self, state: c.c_void_p) -> tuple[int, int]:
        size = c.c_size_t(0)
        return self.call("SerializedFMUstateSize", state, c.byref(size)), size.value

    def as_bytes(self, state: c.c_void_p, room: int) -> tuple[int, bytes]:
        to = c.create_string_buffer(room)
        return self.call("SerializeFMUstate", state, to, c.c_size_t(room)), to.raw

    def from_bytes(self, data: bytes, state: c.c_void_p) -> int:
        return self.call("DeSerializeFMUstate", c.create_string_buffer(data, len(data)), c.c_size_t(len(data)), c.byref(state))

    def choose(self, on: int, *categories: bytes | None) -> int:
        n = len(categories)
        return self.call("SetDebugLogging", on, c.c_size_t(n), (c.c_char_p * n)(*categories))
