"""The object code of a model's kernels, from the user's cache or a new export; which variants of a model are compiled."""

from __future__ import annotations

import contextlib
import hashlib
import json
import platform
import sys
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

from cable_model.effects import BY_NAME, CHAIN, GOING, TOW, variant
from cable_model.scene import Scene
from cable_model.simulated import is_on, parts_of
from fmu_src.entries import ABSENT, EITHER, KINDS, PRESENT, RELEASED, Variant
from fmu_src.native.export import export, object_file
from fmu_src.native.targets import LINUX, Target

HERE = Path(__file__).resolve().parent
_ROOT = HERE.parents[1]
# beside the kernels, what the export reads
_MADE_BY = (
    "fmu_src/entries.py",
    "fmu_src/native/export.py",
    "fmu_src/native/presence.py",
    "fmu_src/native/reshape.py",
    "cable_model/calls.py",
    "cable_model/effects.py",
    "cable_model/signals.py",
)

# of FMUs without a baked scene, whose parameters switch parts on and off: in the plane, and in space
GENERIC: dict[str, tuple[Variant, ...]] = {
    model: tuple({part: KINDS[kind] for part, kind in variant(model, space).items()} for space in (False, True)) for model in (CHAIN, TOW)
}


def can_export() -> bool:
    """Whether this machine is of the kind that the object code is for."""
    return sys.platform == "linux" and platform.machine() == "x86_64"


def prepare_generic() -> None:
    """Compile what the generic FMUs of all models ship side by side; what fails here fails again, and is told, where it is asked for."""
    with ThreadPoolExecutor(len(GENERIC)) as pool:
        for model, variants in GENERIC.items():
            pool.submit(object_code, model, variants)


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


def _folder_and_key(model: str, variants: Sequence[Variant]) -> tuple[Path, str]:
    """The user's cache, and a name for the code of these variants by the content of all that makes it, for all platforms."""
    import llvmlite
    import numba
    import platformdirs

    from cable_model.kernels.jit import source_hash

    made_from = [source_hash(), numba.__version__, llvmlite.__version__, model, json.dumps(list(variants)), LINUX.triple, LINUX.processor]
    made_from += [(_ROOT / path).read_text(encoding="utf-8") for path in _MADE_BY]
    key = hashlib.sha256("\0".join(made_from).encode()).hexdigest()[:24]
    return Path(platformdirs.user_cache_dir("cable_fmu")) / "native", key


def place(model: str, variants: Sequence[Variant], target: Target = LINUX) -> Path:
    """Where the object code of these variants for a platform is kept, in the user's cache."""
    folder, key = _folder_and_key(model, variants)
    return folder / f"{key}-{target.triple}-{target.processor}.o"


def _kept(path: Path, make: Callable[[], bytes]) -> bytes:
    """What a file of the cache holds, made first where it is not there."""
    if path.is_file():
        return path.read_bytes()
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
    """Entries kernel_0, kernel_1, ... of the variants as LLVM's bitcode, for all platforms, kept in the user's cache.

    Raises ExportError where the export fails.
    """
    folder, key = _folder_and_key(model, variants)
    return _kept(folder / f"{key}.bc", lambda: export(model, variants))


def object_code(model: str, variants: Sequence[Variant], target: Target = LINUX) -> bytes:
    """The same as an object file for a platform, kept likewise."""
    return _kept(place(model, variants, target), lambda: object_file(bitcode(model, variants), target))
