"""The object code of a model's kernels, from the user's cache or a new export; which variants of a model are compiled."""

from __future__ import annotations

import contextlib
import itertools
import platform
import sys
from collections.abc import Callable, Iterator, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

from cable_model import ready
from cable_model.effects import BY_NAME, GOING
from cable_model.entries import ABSENT, EITHER, PRESENT, RELEASED, Variant
from cable_model.ready import GENERIC
from cable_model.scene import Scene
from cable_model.simulated import is_on, parts_of
from fmu_src.native.export import export, object_file
from fmu_src.native.targets import LIBRARY, LINUX, Target


def can_export() -> bool:
    """Whether this machine is of the kind that the object code is for."""
    return sys.platform == "linux" and platform.machine() == "x86_64"


def prepare(variants: Mapping[str, Sequence[Variant]] = GENERIC, target: Target = LINUX) -> None:
    """Compile variants of all models side by side.  Raises ExportError where one fails."""
    with ThreadPoolExecutor(len(variants)) as pool:
        list(pool.map(object_code, variants, variants.values(), itertools.repeat(target)))


def variants_of(model: str, scene: Scene | None) -> tuple[Variant, ...]:
    """What is compiled: exactly the parts of a baked scene, those that go where it parts decided at run time, or the generic set."""
    if scene is None:
        return GENERIC[model]
    parts = {name: ABSENT if part is None else PRESENT for name, part in parts_of(scene, model)._asdict().items()}
    if parts["parting"] == PRESENT:
        parts |= {name: EITHER for name in GOING if parts[name] == PRESENT}
    return (parts | ({RELEASED: PRESENT} if is_on(BY_NAME[RELEASED], scene, model) else {}),)


@contextlib.contextmanager
def _alone(lock: Path) -> Iterator[None]:
    """One process at a time: others wait for what the first one makes."""
    import fcntl

    with lock.open("w") as file:
        fcntl.flock(file, fcntl.LOCK_EX)
        yield


def _made(model: str, variants: Sequence[Variant], target: Target, suffix: str, make: Callable[[], bytes]) -> bytes:
    """What lies ready in the package or in the user's cache; else it is made, and kept there."""
    compiled = ready.found(model, variants, target.processor, suffix)
    if compiled:
        return compiled
    path = ready.kept(model, variants, target.processor, suffix)
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        with _alone(path.with_name(f"{path.name}.lock")):
            if not path.is_file():
                part = path.with_name(f"{path.name}.part")
                part.write_bytes(make())
                part.replace(path)
            return path.read_bytes()
    except OSError:
        return make()  # a cache that cannot be written is none


def bitcode(model: str, variants: Sequence[Variant]) -> bytes:
    """Entries kernel_0, kernel_1, ... of the variants as LLVM's bitcode, for all platforms of FMUs, kept in the user's cache.

    Raises ExportError where the export fails.
    """
    return _made(model, variants, LINUX, ready.BITCODE, lambda: export(model, variants))


def object_code(model: str, variants: Sequence[Variant], target: Target = LINUX) -> bytes:
    """The same as an object file for a platform, or for LIBRARY, kept likewise."""
    if target == LIBRARY:
        return _made(model, variants, target, ready.SUFFIX, lambda: object_file(export(model, variants, target), target))
    suffix = f"-{target.triple}.o"
    return _made(model, variants, LINUX, suffix, lambda: object_file(bitcode(model, variants), target))
