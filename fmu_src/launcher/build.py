"""Compiles the launcher, and puts it before pythonfmu's library in an FMU."""

from __future__ import annotations

import json
import sys
from collections.abc import Mapping
from pathlib import Path

from fmu_src.model_description import LOG_CATEGORIES
from fmu_src.native import link
from fmu_src.native.targets import LINUX

HERE = Path(__file__).resolve().parent
SOURCES = (HERE / "launcher.c", HERE / "place.h", HERE.parent / "native" / "log.h", HERE.parent / "native" / "absent.h")
FOLDER = "binaries/linux64"


def can_compile() -> bool:
    """Whether the launcher can be linked for its platform."""
    return LINUX in link.available()


def sources() -> str:
    """All that the launcher is made of, for an FMU's GUID."""
    return "".join(path.read_text(encoding="utf-8") for path in SOURCES)


def _compiled(identifier: str, guid: str) -> bytes:
    categories = ", ".join(map(json.dumps, LOG_CATEGORIES))
    names = {"MODEL_GUID": json.dumps(guid), "INNER_LIBRARY": json.dumps(f"{identifier}_pythonfmu.so"), "LOG_CATEGORIES": categories}
    header = "/* Written by fmu_src/launcher/build.py. */\n" + "".join(f"#define {name} {value}\n" for name, value in names.items())
    return link.library(LINUX, {"launcher.h": header.encode()}, SOURCES, ["launcher.c"], ["-ldl", "-lpthread"])


def before_pythonfmu(entries: Mapping[str, bytes], identifier: str, guid: str) -> dict[str, bytes]:
    """The files of an FMU, its library for Linux behind a launcher; as they are, with a line on stderr, where none can be compiled."""
    own = f"{FOLDER}/{identifier}.so"
    if not can_compile():
        sys.stderr.write(
            "No launcher in the FMU, which tells hosts of errors as FMI asks: it needs 64-bit x86 Linux, and zig or a C compiler.\n"
        )
        return dict(entries)
    behind = {f"{FOLDER}/{identifier}_pythonfmu.so": entries[own], own: _compiled(identifier, guid)}
    return {**entries, **behind}
