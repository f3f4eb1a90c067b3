"""The bytes of a saved FMU state: a head with magic, version, build and lengths, then numbers, then a checksum.  No pickle."""

from __future__ import annotations

import math
import struct
import zlib
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from fmu_src.interface import Variable
from fmu_src.order import Experiment, Phase

_MAGIC = b"CABLEFMU"
_VERSION = 2
_HEAD = struct.Struct("<8sI16sIIII")  # magic, version, build, phase, fixed numbers, parameters, model state
_CHECK = struct.Struct("<I")
TIMES = len(Experiment().numbers())  # numbers of a saved state before those of the variables
ONLY_OWN = "Restore only what the same FMU has saved."


class StateError(ValueError):
    """Bytes that are no state of this FMU; the text says why."""


def _impossible(part: str) -> StateError:
    """The error of a state whose part no instance can be in."""
    return StateError(f"saved state of {part!r}: must be one that this FMU can be in. {ONLY_OWN}")


@dataclass(frozen=True)
class SavedState:
    """Everything that a slave is: `numbers` are times, inputs and outputs, `parameters` all parameters, `model` the model's state."""

    phase: int
    numbers: np.ndarray
    parameters: np.ndarray
    model: np.ndarray


def pack(saved: SavedState, build: bytes) -> bytes:
    """The state as bytes; `build` (16 bytes) says which FMU it belongs to."""
    parts = (saved.numbers, saved.parameters, saved.model)
    head = _HEAD.pack(_MAGIC, _VERSION, build, saved.phase, *(len(part) for part in parts))
    body = head + b"".join(np.ascontiguousarray(part, dtype="<f8").tobytes() for part in parts)
    return body + _CHECK.pack(zlib.crc32(body))


def unpack(data: bytes, build: bytes) -> SavedState:
    """The state from bytes.  Raises StateError where they are cut, changed, or of another FMU or version."""
    if not isinstance(data, bytes) or data[: len(_MAGIC)] != _MAGIC:
        raise StateError(f"saved state: must begin with {_MAGIC.decode()}. {ONLY_OWN}")
    if len(data) < _HEAD.size + _CHECK.size:
        raise StateError(f"saved state = {len(data)} bytes: must be at least {_HEAD.size + _CHECK.size}. {ONLY_OWN}")
    _, version, owner, phase, *lengths = _HEAD.unpack_from(data)
    if version != _VERSION:
        raise StateError(f"saved state version = {version}: must be {_VERSION}. {ONLY_OWN}")
    expected = _HEAD.size + 8 * sum(lengths) + _CHECK.size
    if len(data) != expected:
        raise StateError(f"saved state = {len(data)} bytes: must be {expected}. {ONLY_OWN}")
    if _CHECK.unpack_from(data, expected - _CHECK.size)[0] != zlib.crc32(data[: -_CHECK.size]):
        raise StateError(f"saved state: must have its checksum. It was changed; {ONLY_OWN[0].lower()}{ONLY_OWN[1:]}")
    if owner != build:
        raise StateError(f"saved state: must be of this build of the FMU. {ONLY_OWN}")
    numbers = np.frombuffer(data, dtype="<f8", count=sum(lengths), offset=_HEAD.size).astype(np.float64)
    first, second = lengths[0], lengths[0] + lengths[1]
    return SavedState(phase, numbers[:first], numbers[first:second], numbers[second:])


def checked(saved: SavedState, values: Sequence[Variable], parameters: Sequence[Variable]) -> SavedState:
    """A state that an instance can be in; `values` and `parameters` are the rows of its numbers.  Raises StateError."""
    if (len(saved.numbers), len(saved.parameters)) != (TIMES + len(values), len(parameters)):
        raise _impossible("size")
    if saved.phase not in list(Phase) or (saved.phase > Phase.INITIALIZING and not len(saved.model)):
        raise _impossible("phase")
    try:
        Experiment.from_numbers(saved.numbers[:TIMES].tolist())
    except ValueError:
        raise _impossible("time") from None
    for row, value in zip((*values, *parameters), [*saved.numbers[TIMES:].tolist(), *saved.parameters.tolist()], strict=True):
        whole = math.isfinite(value) and (row.kind == "Real" or (value.is_integer() and abs(value) < 2.0**31))
        if not whole or (row.kind == "Boolean" and value not in (0.0, 1.0)):
            raise _impossible(row.name)
    if not np.isfinite(saved.model).all():
        raise _impossible("cable")
    return saved
