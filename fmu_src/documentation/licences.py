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
from fmu_src.native.targets import TARGETS

_FMI = "It was compiled with the FMI {} headers of the Modelica Association, 2-clause BSD: fmi.txt."
_NOTHING = "binaries/{} is this project's code alone and loads the system's C library."
_COMPILER = """binaries/{} was linked by the C compiler of the machine that built it, and has its start-up code (GCC's is under the GPL
with the GCC Runtime Library Exception)."""
_WINDOWS = """binaries/{} has of mingw-w64 the start-up code and wrappers of stdio (Zope Public License 2.1, in parts public domain:
mingw-w64.txt), and of zig its compiler run time and C library (MIT: zig.txt; in parts after musl, MIT: musl.txt)."""
_WINDOWS_FOLDERS = [folder for target in TARGETS if target.suffix == ".dll" for folder in (target.folder, target.folder3)]
_PYTHONFMU = "resources/pythonfmu, binaries/win64 and {} are PythonFMU's (MIT: pythonfmu.txt)."
_ATEXIT = """The library before it in binaries/linux64 has of the GNU C Library the function atexit: LGPL 2.1 or later, with unlimited
permission to link the compiled function with other programs and to distribute those without any restriction coming from it."""


def _text(package: str, name: str) -> str:
    """A licence that was installed with a package.  Raises ParameterError where it is not there."""
    # a repository has an egg-info of its package too, which lacks licences
    found = next(filter(None, (each.read_text(f"licenses/{name}") for each in metadata.distributions(name=package))), None)
    if found is None:
        raise ParameterError(f"{package}: must be installed with its licence {name}. Install it again with pip.")
    return found


def _notice(header: str) -> str:
    """The notice in an FMI header."""
    text = (link.fmi_headers() / header).read_text(encoding="utf-8")
    return text[text.index("Copyright (C)") : text.index("*/", text.index("Copyright (C)"))].rstrip() + "\n"


def _with_own(words: Sequence[str], others: dict[str, str]) -> dict[str, str]:
    head = f"This FMU was made by cable-fmu {__version__}, whose licence is below.\n"
    return {"license.txt": "\n".join([head, *words, "", _text("cable-fmu", "LICENSE")]), **others}


def _compiled(words: Sequence[str], others: dict[str, str], fmi: str = "2.0") -> dict[str, str]:
    """Of what was compiled with the headers of this version of FMI."""
    versions = [version for version in ("2.0", "3.0") if version <= fmi]  # the layer of 3.0 is one over that of 2.0
    notices = [_notice(f"fmi{version[0]}Functions.h") for version in versions]
    return _with_own([*words, _FMI.format(" and ".join(versions))], {"fmi.txt": "\n".join(notices), **others})


def of_native(folders: Sequence[str], fmi: str = "2.0") -> dict[str, str]:
    """Texts by their names in documentation/licenses/ of a native FMU of this version of FMI with these folders in binaries/."""
    windows = [folder for folder in folders if folder in _WINDOWS_FOLDERS]
    words = [(_NOTHING if link.has_zig() else _COMPILER).format(folder) for folder in folders if folder not in windows]
    if not windows:
        return _compiled(words, {}, fmi)
    licences = {"mingw-w64.txt": "lib/libc/mingw/COPYING", "zig.txt": "LICENSE", "musl.txt": "lib/libc/musl/COPYRIGHT"}
    texts = {name: _text("ziglang", f"ziglang/{place}") for name, place in licences.items()}
    return _compiled([*words, *map(_WINDOWS.format, windows)], texts, fmi)


def of_python(launched: bool) -> dict[str, str]:
    """Texts by their names in documentation/licenses/ of an FMU that runs Python; launched: whether our library is before pythonfmu's."""
    theirs = {"pythonfmu.txt": _text("pythonfmu", "LICENSE")}
    if not launched:
        return _with_own([_PYTHONFMU.format("binaries/linux64")], theirs)
    words = [_PYTHONFMU.format("the library that ends in _pythonfmu"), _ATEXIT]
    return _compiled([*words, *(() if link.has_zig() else [_COMPILER.format("linux64")])], theirs)
