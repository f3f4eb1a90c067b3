"""Tables of a scene that stand in files of their own: where a scene gives a file's name in place of rows, its rows are read."""

from __future__ import annotations

import typing
import warnings
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from cable_model.errors import ParameterError, refuse
from cable_model.extras import xarray_module
from cable_model.parameters import field_of, holder_of
from cable_model.quantity import types_of

NETCDF = (".nc", ".nc4", ".cdf")
# names of the variables of a current in netCDF, where no standard_name of the CF conventions tells
_EAST, _NORTH = ("eastward_sea_water_velocity", "u", "uo"), ("northward_sea_water_velocity", "v", "vo")
_HEIGHTS, _TIMES = ("z", "depth", "lev", "level"), ("time", "t")


def with_tables(values: Mapping[str, Any], folder: Path) -> dict[str, Any]:
    """The parts of a scene with the rows of its files, whose names are relative to `folder`.  Raises ParameterError."""
    read = dict(values)
    for part, given in values.items():
        if not isinstance(given, dict):
            continue
        files = {key: text for key, text in given.items() if isinstance(text, str) and _columns(f"{part}.{key}")}
        read[part] = given | {key: _rows(f"{part}.{key}", folder / text) for key, text in files.items()}
    return read


def _columns(name: str) -> int:
    """Columns of the table that a scene has under a name; 0 where it has none."""
    try:
        holder = holder_of(name)
    except KeyError:
        return 0
    kind = types_of(holder).get(name.partition(".")[2])
    rows = typing.get_args(kind)[:1]
    return len(typing.get_args(rows[0])) if rows and typing.get_origin(rows[0]) is tuple else 0


def _rows(name: str, path: Path) -> list[list[float]]:
    if not path.is_file():
        raise ParameterError(f"{name}: {path}: no such file. Give a file beside the scene, or the rows.")
    if path.suffix in NETCDF:
        if name != "current.table":
            raise ParameterError(f"{name}: {path}: netCDF is read for current.table alone. Give the rows as CSV.")
        return _of_netcdf(name, path)
    return _of_text(name, path, _columns(name))


def _of_text(name: str, path: Path, columns: int) -> list[list[float]]:
    """Rows of numbers between commas, semicolons or blanks; comments begin with #, and the first row may name the columns."""
    found: list[list[float]] = []
    try:
        lines = path.read_text(encoding="utf-8-sig").splitlines()
    except UnicodeDecodeError as error:
        raise ParameterError(f"{name}: {path}: not a text ({error}). Give rows of numbers as CSV.") from error
    begun = False
    for number, line in enumerate(lines, 1):
        words = line.partition("#")[0].replace(",", " ").replace(";", " ").split()
        if not words:
            continue
        try:
            row = [float(word) for word in words]
        except ValueError as error:
            if not begun:  # the names of the columns
                begun = True
                continue
            raise ParameterError(f"{name}: {path}, line {number}: {error}. Give numbers.") from error
        begun = True
        if len(row) != columns:
            units = field_of(name).metadata["unit"]
            raise refuse(f"{name}: {path}, line {number}", len(row), "columns", f"{columns}: {units}", "Mend the row.")
        found.append(row)
    if not found:
        raise ParameterError(f"{name}: {path}: no rows. Give rows of numbers.")
    return found


def _variable(data: Any, names: tuple[str, ...], name: str, path: Path) -> Any:
    """The variable of a data set with one of these standard names or names."""
    for key in data.variables:
        if data[key].attrs.get("standard_name", key) in names or key.lower() in names:
            return data[key]
    raise ParameterError(f"{name}: {path}: no variable {' or '.join(names)}. Name it so, or give the rows as CSV.")


def _of_netcdf(name: str, path: Path) -> list[list[float]]:
    """Rows of time since the first moment, z, speed and direction (x east, y north), from velocities over time and height or depth."""
    xarray = xarray_module()
    try:
        with warnings.catch_warnings(), xarray.open_dataset(path) as data:
            warnings.simplefilter("ignore")
            data.load()
    except (OSError, ValueError, TypeError) as error:
        text = str(error).splitlines()[0]
        raise ParameterError(f"{name}: {path}: not read as netCDF ({text}). Give netCDF 3, or install netCDF4.") from error
    east, north = _variable(data, _EAST, name, path).squeeze(), _variable(data, _NORTH, name, path).squeeze()
    times, heights = _variable(data, _TIMES, name, path), _variable(data, _HEIGHTS, name, path)
    if set(east.dims) != {times.name, heights.name} or set(north.dims) != set(east.dims):
        shown = ", ".join(map(str, east.dims)) or "nothing"
        raise ParameterError(f"{name}: {path}: {east.name} over {shown}: must be over time and height. Cut out one place.")
    z = heights.to_numpy().astype(float)
    if heights.attrs.get("positive", "down" if str(heights.name).lower() == "depth" else "up") == "down":
        z = -z
    moments = times.to_numpy()
    seconds = (moments - moments[0]) / np.timedelta64(1, "s") if moments.dtype.kind == "M" else moments.astype(float)
    x, y = (velocity.transpose(times.name, heights.name).to_numpy().astype(float) for velocity in (east, north))
    if not (np.isfinite(x).all() and np.isfinite(y).all()):
        raise ParameterError(f"{name}: {path}: velocities are missing. Cut out the levels that are there at all times.")
    speeds, directions = np.hypot(x, y), np.arctan2(y, x)
    return [
        [float(t), float(level), float(speeds[i, j]), float(directions[i, j])] for i, t in enumerate(seconds) for j, level in enumerate(z)
    ]
