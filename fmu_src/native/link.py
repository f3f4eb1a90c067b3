"""Links kernels and C layer into the library of a platform: by zig, which links for all of them, or the system's compiler for its own.

Zig is the package `ziglang`, the extra `native`.
"""

from __future__ import annotations

import importlib.util
import shutil
import struct
import subprocess
import sys
import tempfile
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path

from cable_model.errors import ParameterError
from fmu_src.native.object_code import can_export
from fmu_src.native.targets import LINUX, TARGETS, Target

COMPILERS = ("cc", "gcc", "clang")
FLAGS = ("-std=gnu11", "-O2", "-ffp-contract=off", "-shared", "-fvisibility=hidden", "-Wl,-s")
_FAT, _THIN, _ARM64 = 0xCAFEBABE, 0xFEEDFACF, 0x0100000C  # of Mach-O: magic numbers, and Apple's processor


def compiler() -> str | None:
    """The C compiler, if there is one."""
    return next((found for name in COMPILERS if (found := shutil.which(name))), None)


def has_zig() -> bool:
    """Whether zig is installed beside this Python."""
    return importlib.util.find_spec("ziglang") is not None


def fmi_headers() -> Path:
    """The folder of the FMI headers that come with fmpy."""
    import fmpy

    return Path(fmpy.__file__).parent / "c-code"


def available() -> tuple[Target, ...]:
    """The platforms that can be linked for here."""
    if not can_export():
        return ()
    if has_zig():
        return TARGETS
    return (LINUX,) if compiler() is not None else ()


def missing() -> str:
    """Which platforms cannot be linked for here and what to do; "" where none is missing."""
    if has_zig() or not available():
        return ""
    others = dict.fromkeys(target.folder for target in TARGETS if target != LINUX)
    return f"Native FMUs are for {LINUX.folder} alone: linking for {', '.join(others)} needs zig. Run `pip install ziglang`."


def chosen(folders: Sequence[str]) -> tuple[Target, ...]:
    """The platforms with these folders in binaries/; none named: all that can be linked for.

    Raises ParameterError for one that is unknown or that cannot be linked for here.
    """
    known = dict.fromkeys(target.folder for target in TARGETS)
    for folder in folders:
        if folder not in known:
            raise ParameterError(f"platform = {folder!r}: must be one of {', '.join(known)}. Choose one of them.")
    found = [target for target in available() if not folders or target.folder in folders]
    lacking = [folder for folder in folders if folder not in {target.folder for target in found}]
    if not can_export():
        raise ParameterError("machine: must be 64-bit x86 Linux to build native FMUs. Build them there, or with --no-native.")
    if lacking or not found:
        what = ", ".join(lacking) or LINUX.folder
        raise ParameterError(f"linker for {what} = none: must be zig or, on 64-bit Linux, a C compiler. Run `pip install ziglang`.")
    return tuple(found)


def library(target: Target, files: Mapping[str, bytes], sources: Iterable[Path], units: Sequence[str], libraries: Sequence[str]) -> bytes:
    """A shared library of the `units` (C files and objects) among `files` and copies of `sources`.

    Raises ParameterError with the linker's words where it fails.
    """
    own = [sys.executable, "-m", "ziglang", "cc", "-target", target.zig] if has_zig() else [str(compiler())]
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        for file, content in files.items():
            (folder / file).write_bytes(content)
        for source in sources:
            shutil.copy(source, folder)
        made = folder / f"made{target.suffix}"
        command = [*own, *FLAGS, *target.flags, f"-I{fmi_headers()}", "-o", made.name, *units, *libraries]
        done = subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False)
        if done.returncode != 0:
            raise ParameterError(f"{' '.join(command)}: failed. {done.stderr}")
        return made.read_bytes()


def universal(slices: Sequence[bytes]) -> bytes:
    """One Mach-O file of libraries for several processors: its head (big-endian), then each at a multiple of its page size."""
    kinds = [struct.unpack_from("<III", code) for code in slices]  # magic number, processor, its kind
    if any(magic != _THIN for magic, _, _ in kinds):
        raise ValueError("a slice is no 64-bit Mach-O file")
    made = bytearray(struct.pack(">II", _FAT, len(slices)))
    place, places = 8 + 20 * len(slices), []
    for code, (_, processor, kind) in zip(slices, kinds, strict=True):
        page = 14 if processor == _ARM64 else 12  # as a power of two
        place = -(-place >> page) << page
        places.append(place)
        made += struct.pack(">IIIII", processor, kind, place, len(code), page)
        place += len(code)
    for code, place in zip(slices, places, strict=True):
        made += bytes(place - len(made)) + code
    return bytes(made)
