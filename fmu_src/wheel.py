"""How a wheel is made (PEP 517): by setuptools, with compiled kernels in it: every scene, and every build of FMUs, starts at once."""

from __future__ import annotations

import shutil
import tomllib
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from setuptools import build_meta
from setuptools.build_meta import (
    build_editable,
    build_sdist,
    get_requires_for_build_editable,
    get_requires_for_build_sdist,
    prepare_metadata_for_build_editable,
    prepare_metadata_for_build_wheel,
)

__all__ = [  # PEP 517's and PEP 660's hooks
    "build_editable",
    "build_sdist",
    "build_wheel",
    "get_requires_for_build_editable",
    "get_requires_for_build_sdist",
    "get_requires_for_build_wheel",
    "prepare_metadata_for_build_editable",
    "prepare_metadata_for_build_wheel",
]
ROOT = Path(__file__).resolve().parents[1]


def get_requires_for_build_wheel(config_settings: Mapping[str, Any] | None = None) -> list[str]:
    """What compiles the kernels, beside what setuptools asks for: all that the package itself needs."""
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    return [*build_meta.get_requires_for_build_wheel(config_settings), *project["dependencies"]]


def build_wheel(wheel_directory: str, config_settings: Mapping[str, Any] | None = None, metadata_directory: str | None = None) -> str:
    """Write the wheel; where no object code can be made, on other systems than 64-bit x86 Linux, one whose kernels numba compiles."""
    from cable_model import ready
    from fmu_src.native.object_code import bitcode, can_export, object_code
    from fmu_src.native.targets import LIBRARY, LINUX

    try:
        if can_export():
            ready.SHIPPED.mkdir(exist_ok=True)
            for model, variants in ready.EVERY.items():
                ready.shipped(model, variants, LIBRARY.processor).write_bytes(object_code(model, variants, LIBRARY))
            for model, variants in ready.GENERIC.items():
                ready.shipped(model, variants, LINUX.processor, ready.BITCODE).write_bytes(bitcode(model, variants))
                ready.shipped(model, variants, LINUX.processor).write_bytes(object_code(model, variants))
        name: str = build_meta.build_wheel(wheel_directory, config_settings, metadata_directory)
        return name
    finally:
        shutil.rmtree(ready.SHIPPED, ignore_errors=True)  # a checkout has none: its kernels change
