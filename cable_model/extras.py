"""Packages that only extras install."""

from types import ModuleType

from cable_model.errors import ParameterError


def xarray_module() -> ModuleType:
    """xarray; ParameterError where it is not installed."""
    try:
        import xarray
    except ImportError as absent:
        raise ParameterError("xarray: not installed. Install it with pip install 'cable-fmu[results]'.") from absent
    return xarray
