"""Underwater and hanging cables under a moving top end: a finite-difference chain and a tow model of two or three degrees of freedom."""

from importlib import import_module
from typing import Any

__version__ = "0.1.0"

_HOMES = {
    "CableChain": "cable_chain",
    "TowCable": "tow_cable",
    "ParameterError": "errors",
    "SolverError": "errors",
    "Scene": "scene",
    "from_dict": "scene",
    "load": "scene",
    "with_values": "scene",
    "Result": "simulation",
    "simulate": "simulation",
}
__all__ = list(_HOMES)


def __getattr__(name: str) -> Any:
    """Import on first use: an FMU needs the models alone, without scipy and matplotlib."""
    if name not in _HOMES:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(import_module(f"{__name__}.{_HOMES[name]}"), name)
