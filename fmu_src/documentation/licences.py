"""The licences of what an FMU holds: this project's, and those of what is linked in or lies beside.

What zig links in was found by the link maps and symbol tables of zig 0.17.1: in win64 mingw-w64's start-up and wrappers of stdio and zig's
compiler run time and C library; elsewhere no code but this project's. tests/test_fmu_documentation.py holds the latter.
"""

from __future__ import annotations

from collections.abc import Sequence
from importlib import metadata

from cable_model import __version__
from cable_model.errors import ParameterError
from fmu_src.native import link

_FMI = "It was compiled with the FMI 2.0 headers of the Modelica Association, 2-clause BSD: fmi.txt."
_NOTHING = "binaries/{} is this project's code alone and loads the system's C library."
_COMPILER = """binaries/{} was linked by the C compiler of the machine that built it, and has its start-up code (GCC's is under the GPL
with the GCC Runtime Library Exception)."""
_WINDOWS = """binaries/win64 has of mingw-w64 the start-up code and wrappers of stdio (Zope Public License 2.1, in parts public domain:
mingw-w64.txt), and of zig its compiler run time and C library (MIT: zig.txt; in parts after musl, MIT: musl.txt)."""
_PYTHONFMU = "resources/pythonfmu, binaries/win64 and the library that ends in _pythonfmu are PythonFMU's (MIT: pythonfmu.txt)."
_ATEXIT = """The library before it in binaries/linux64 has of the GNU C Library the function atexit: LGPL 2.1 or later, with unlimited
permission to link the compiled function with other programs and to distribute those without any restriction coming from it."""


def _text(package: str, name: str) -> str:
    """A licence that was installed with a package.  Raises ParameterError where it is not there."""
    # a repository has an egg-info of its package too, which lacks licences
    found = next(filter(None, (each.read_text(f"licenses/{name}") for each in metadata.distributions(name=package))), None)
    if found is None:
        raise ParameterError(f"{package}: must be installed with its licence {name}. Install it again with pip.")
    return found


def _fmi() -> str:
    """The notice in the FMI headers."""
    text = (link.fmi_headers() / "fmi2Functions.h").read_text(encoding="utf-8")
    return text[text.index("Copyright (C)") : text.index("*/", text.index("Copyright (C)"))].rstrip() + "\n"


def _with_own(words: Sequence[str], others: dict[str, str]) -> dict[str, str]:
    head = f"This FMU was made by cable-fmu {__version__}, whose licence is below.\n"
    text = "\n".join([head, *words, _FMI, "", _text("cable-fmu", "LICENSE")])
    return {"license.txt": text, "fmi.txt": _fmi(), **others}


def of_native(folders: Sequence[str]) -> dict[str, str]:
    """Texts by their names in documentation/licenses/ of a native FMU for the platforms with these folders in binaries/."""
    words = [(_NOTHING if link.has_zig() else _COMPILER).format(folder) for folder in folders if folder != "win64"]
    if "win64" not in folders:
        return _with_own(words, {})
    licences = {"mingw-w64.txt": "lib/libc/mingw/COPYING", "zig.txt": "LICENSE", "musl.txt": "lib/libc/musl/COPYRIGHT"}
    return _with_own([*words, _WINDOWS], {name: _text("ziglang", f"ziglang/{place}") for name, place in licences.items()})


def of_python(launched: bool) -> dict[str, str]:
    """Texts by their names in documentation/licenses/ of an FMU that runs Python; launched: whether our library is before pythonfmu's."""
    words = [_ATEXIT, *(() if link.has_zig() else (_COMPILER.format("linux64"),))] if launched else []
    return _with_own([_PYTHONFMU, *words], {"pythonfmu.txt": _text("pythonfmu", "LICENSE")})
