"""What a run leaves beside the CSV of its series: a dataset of xarray, which is written as netCDF, and profiles as CSV."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from cable_model import __version__
from cable_model.errors import ParameterError, writing
from cable_model.extras import xarray_module
from cable_model.facts import PROFILE, TIME, facts_of
from cable_model.scene import to_toml
from cable_model.simulation import Result, csv_row

if TYPE_CHECKING:
    import xarray

NETCDF = ".nc"
_MISTAKEN = (".cdf", ".h5", ".hdf5", ".nc3", ".nc4", ".netcdf")  # who gives one of them does not mean CSV
ARC_LENGTH = "arc_length"


def is_netcdf(path: Path) -> bool:
    """Whether a file of results is to be netCDF, by its ending."""
    return path.suffix.lower() == NETCDF


def check_results(path: Path) -> None:
    """Refuse, before minutes are spent, the ending of another kind of file than is written, and netCDF where nothing can write it."""
    if path.suffix.lower() in _MISTAKEN:
        raise ParameterError(f"{path}: no name of a file of results. Give one that ends in {NETCDF} (netCDF) or .csv.")
    if is_netcdf(path):
        xarray_module()


def check_profiles(path: Path, results: Path) -> None:
    """Refuse, before minutes are spent, a file of profiles that is none of CSV, or the one of the results."""
    if path.suffix.lower() in (NETCDF, *_MISTAKEN):
        raise ParameterError(f"{path}: no name of a table of profiles. Give one that ends in .csv; -o FILE{NETCDF} has profiles too.")
    if path.resolve() == results.resolve():
        raise ParameterError(f"{path}: is the file of the time series. Give profiles a name of their own.")


def dataset(result: Result) -> xarray.Dataset:
    """See Result.to_xarray."""
    library = xarray_module()
    variables: dict[str, Any] = {name: (TIME, result[name], _described(name)) for name in result.columns}
    if result.arc_lengths is not None:
        profiles = result.profiles()
        constant = bool(np.all(profiles.arc_lengths == profiles.arc_lengths[:1]))
        over = (TIME, ARC_LENGTH if constant else "point")
        lengths = (over[1:], profiles.arc_lengths[0]) if constant else (over, profiles.arc_lengths)
        x, y, z = np.moveaxis(profiles.positions, -1, 0)
        told = {"x": x, "y": y, "z": z, "tension": profiles.tensions, "curvature": profiles.curvatures}
        variables[ARC_LENGTH] = (*lengths, _described(ARC_LENGTH))
        variables |= {name: (over, values, _described(name)) for name, values in told.items()}
    made: xarray.Dataset = library.Dataset(variables, attrs=_attributes(result))
    return made.set_coords([name for name in (TIME, ARC_LENGTH) if name in variables])


def _described(name: str) -> dict[str, str]:
    facts = facts_of(name)
    return {"units": facts.unit, "long_name": facts.description}


def _attributes(result: Result) -> dict[str, str]:
    """Where the numbers come from; of what is not known there is nothing.  Texts only: netCDF-3 has no lists of them."""
    scene = result.scene
    known = {
        "title": scene.title if scene else "",
        "source": scene.source.strip() if scene else "",
        "model": result.model,
        "version": f"cable-fmu {__version__}",
        "scene": to_toml(scene) if scene else "",
        "warnings": "\n".join(result.warnings),
    }
    return {name: text for name, text in known.items() if text}


def write_netcdf(path: Path, result: Result) -> None:
    """Write all of a result as netCDF-3 with 64-bit offsets, which every reader of netCDF reads."""
    content = dataset(result).to_netcdf(engine="scipy", format="NETCDF3_64BIT")  # bytes: a full disk is then met by our own writing
    path.parent.mkdir(parents=True, exist_ok=True)
    with writing(path):
        path.write_bytes(content)


def write_profiles(path: Path, result: Result) -> None:
    """Write a line for each point of the cable at each output step, by the columns of facts.PROFILE, in digits that read back the same."""
    path.parent.mkdir(parents=True, exist_ok=True)
    with writing(path), path.open("w", encoding="utf-8") as file:
        file.write(",".join(PROFILE) + "\n")
        for table in result.profiles().tables():
            file.writelines(csv_row(row) + "\n" for row in table)
