"""Importing a vendored package from a folder named by its content, so that compiled kernels are found again at the next unzip.

Copied into each FMU under a name of its own.  It imports nothing of ours and holds no state.
"""

import hashlib
import importlib.util
import os
import shutil
import sys
import tempfile
from pathlib import Path
from types import ModuleType

_ANY_TIME = 1_000_000_000  # numba's cache asks for the time of a source file: the same content, the same time


def _key(folder: Path) -> str:
    """Hash of the Python files in a folder and of Python's version; numba's is in the folder where it keeps what it compiled."""
    digest = hashlib.sha256(f"{sys.implementation.cache_tag} {sys.version_info}".encode())
    for path in sorted(folder.rglob("*.py")):
        digest.update(path.relative_to(folder).as_posix().encode() + b"\0" + path.read_bytes() + b"\0")
    return digest.hexdigest()[:20]


def _sources(folder: Path) -> dict[str, bytes]:
    return {path.relative_to(folder).as_posix(): path.read_bytes() for path in folder.rglob("*.py")}


def _copy(folder: Path, to: Path) -> None:
    """Copy the Python files, in place of what is there; the folder appears complete or not at all."""
    to.parent.mkdir(parents=True, exist_ok=True)
    made = Path(tempfile.mkdtemp(dir=to.parent, prefix="new-"))
    try:
        shutil.copytree(folder, made / "new" / folder.name, ignore=shutil.ignore_patterns("__pycache__"))
        for path in (made / "new" / folder.name).rglob("*.py"):
            os.utime(path, (_ANY_TIME, _ANY_TIME))
        if to.exists():
            os.rename(to, made / "old")
        os.rename(made / "new", to)
    except OSError:
        if not (to / folder.name).is_dir():  # nobody else has laid it meanwhile
            raise
    finally:
        shutil.rmtree(made, ignore_errors=True)


def staged(folder: Path) -> Path:
    """A lasting copy of a package's folder in the user's cache, laid anew where it is damaged; the folder itself where there is none."""
    try:
        import platformdirs

        to = Path(platformdirs.user_cache_dir("cable_fmu")) / "staged" / _key(folder)
        if not (to / folder.name).is_dir() or _sources(to / folder.name) != _sources(folder):
            _copy(folder, to)
        return to / folder.name if _sources(to / folder.name) == _sources(folder) else folder
    except (OSError, ImportError, RuntimeError):
        return folder


def _imported(package: str, folder: Path) -> ModuleType:
    spec = importlib.util.spec_from_file_location(package, folder / "__init__.py", submodule_search_locations=[str(folder)])
    if spec is None or spec.loader is None:
        raise ImportError(f"{package}: not found in {folder}")
    module = importlib.util.module_from_spec(spec)
    sys.modules[package] = module
    try:
        spec.loader.exec_module(module)
    except BaseException:
        del sys.modules[package]
        raise
    return module


def load(package: str, resources: Path) -> ModuleType:
    """Import a package that lies in the folder `resources`, from its staged copy; its name holds its hash, so it is loaded once."""
    if package in sys.modules:
        return sys.modules[package]
    return _imported(package, staged(resources / package))
