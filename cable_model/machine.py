"""What a measurement was made on: it goes with every table of times."""

import platform
from collections.abc import Sequence
from importlib import metadata
from pathlib import Path


def _processor() -> str:
    try:
        lines = Path("/proc/cpuinfo").read_text(encoding="utf-8").splitlines()
    except OSError:  # not Linux
        return platform.processor() or platform.machine()
    names = [line.partition(":")[2].strip() for line in lines if line.startswith("model name")]
    return f"{names[0]} ({platform.machine()})" if names else platform.machine()


def _version(package: str) -> str:
    try:
        return f"{package} {metadata.version(package)}"
    except metadata.PackageNotFoundError:
        return f"{package} not installed"


def machine(further: Sequence[str] = ()) -> str:
    """Processor and versions, of `further` packages too."""
    packages = ("numba", "numpy", "cable-fmu", *further)
    return ", ".join([_processor(), f"Python {platform.python_version()}", *(_version(package) for package in packages)])
