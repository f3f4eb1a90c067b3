"""The platforms of a native FMU: one row each, with what LLVM and the linker are to know of it."""

from typing import NamedTuple

from cable_model.ready import OLDEST, RECENT


class Target(NamedTuple):
    """A platform, or one of the two processors of macOS."""

    folder: str  # in binaries/ of an FMU
    folder3: str  # the same in FMI 3.0
    suffix: str  # of its library
    triple: str  # for LLVM
    processor: str  # the oldest that runs the code, for LLVM
    zig: str  # of `zig cc -target`: with the oldest system
    flags: tuple[str, ...] = ()  # of the link


_ELF = ("-fPIC", "-Wl,-Bsymbolic", "-Wl,--build-id=none", "-Wl,-z,noexecstack")
LINUX = Target("linux64", "x86_64-linux", ".so", "x86_64-unknown-linux-gnu", OLDEST, "x86_64-linux-gnu.2.17", _ELF)
TARGETS = (
    LINUX,
    Target("win64", "x86_64-windows", ".dll", "x86_64-w64-windows-gnu", "x86-64", "x86_64-windows-gnu"),
    Target("darwin64", "x86_64-darwin", ".dylib", "x86_64-apple-macosx11.0.0", "core2", "x86_64-macos.11.0-none"),
    Target("darwin64", "aarch64-darwin", ".dylib", "arm64-apple-macosx11.0.0", "apple-m1", "aarch64-macos.11.0-none"),
    Target("aarch64-linux", "aarch64-linux", ".so", "aarch64-unknown-linux-gnu", "generic", "aarch64-linux-gnu.2.17", _ELF),
)
LIBRARY = LINUX._replace(processor=RECENT)  # no FMU: what the library runs
