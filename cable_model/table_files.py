"""Tables of a scene that stand in files of their own: where a scene gives a file's name in place of rows, its rows are read."""

from __future__ import annotations

import itertools
import re
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
_SPEED_UNITS = ("m/s", "m s-1", "m s^-1", "meter/second", "meters/second", "meter second-1", "m.s-1")
_LENGTH_UNITS = ("m", "meter", "meters", "metre", "metres")
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
    """Rows of numbers between commas, semicolons or blanks; comments begin with #, and the first row may name the columns as they are."""
    found: list[list[float]] = []
    named = False
    try:
        lines = path.read_text(encoding="utf-8-sig").splitlines()
    except UnicodeDecodeError as error:
        raise ParameterError(f"{name}: {path}: not a text ({error}). Give rows of numbers as CSV.") from error
    for number, line in enumerate(lines, 1):
        words = line.partition("#")[0].replace(",", " ").replace(";", " ").split()
        if not words:
            continue
        numbers = [_number(word) for word in words]
        where = f"{name}: {path}, line {number}"
        if not found and not named and all(value is None for value in numbers):
            named = True
            _check_names(name, where, line.partition("#")[0])
            continue
        if None in numbers:
            raise ParameterError(f"{where}: {words[numbers.index(None)]!r} is no number. Give numbers.")
        if len(words) != columns:
            units = field_of(name).metadata["unit"]
            raise refuse(where, len(words), "columns", f"{columns}: {units}", "Mend the row.")
        found.append([value for value in numbers if value is not None])
    if not found:
        raise ParameterError(f"{name}: {path}: no rows. Give rows of numbers.")
    return found


def _number(word: str) -> float | None:
    try:
        return float(word)
    except ValueError:
        return None


def _check_names(name: str, where: str, line: str) -> None:
    """Raises the ParameterError of a first row that names other columns than the table's, or other units, in brackets."""
    wanted = re.findall(r"\[(.*?)\]", field_of(name).metadata["description"])[0].split(", ")
    units = field_of(name).metadata["unit"].split(", ")
    separator = next((mark for mark in ";," if mark in line), None)
    for k, (title, right) in enumerate(itertools.zip_longest(line.split(separator), wanted)):
        word, _, unit = (title or "").strip().strip('"').replace("[", "(").rstrip("]) ").partition("(")
        as_it_is = right is not None and word.strip().lower() in (right, right.split()[0])
        if not as_it_is or (unit and unit.strip() not in (units[min(k, len(units) - 1)],)):
            known = ", ".join(f"{one} ({unit})" for one, unit in zip(wanted, units, strict=False))
            raise ParameterError(f"{where}: names {line.strip()!r}: must be {known}. Order and convert the columns so, or leave names out.")


def _variable(data: Any, names: tuple[str, ...], name: str, path: Path) -> Any:
    """The variable of a data set with one of these standard names or names."""
    for key in data.variables:
        if data[key].attrs.get("standard_name", key) in names or key.lower() in names:
            return data[key]
    raise ParameterError(f"{name}: {path}: no variable {' or '.join(names)}. Name it so, or give the rows as CSV.")


def _at_one_place(velocity: Any, times: Any, heights: Any) -> Any:
    """Without axes of one value that are neither time nor height."""
    return velocity.squeeze([axis for axis in velocity.dims if velocity.sizes[axis] == 1 and axis not in (times.name, heights.name)])


def _check_unit(variable: Any, known: tuple[str, ...], name: str, path: Path) -> None:
    unit = str(variable.attrs.get("units", known[0]))
    if unit.strip() not in known:
        raise ParameterError(f"{name}: {path}: {variable.name} in {unit!r}: must be in {known[0]}. Convert it.")


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
    times, heights = _variable(data, _TIMES, name, path), _variable(data, _HEIGHTS, name, path)
    east, north = (_at_one_place(_variable(data, names, name, path), times, heights) for names in (_EAST, _NORTH))
    for velocity in (east, north):
        _check_unit(velocity, _SPEED_UNITS, name, path)
    _check_unit(heights, _LENGTH_UNITS, name, path)
    if set(east.dims) != {times.name, heights.name} or set(north.dims) != set(east.dims):
        shown = ", ".join(map(str, east.dims)) or "nothing"
        raise ParameterError(f"{name}: {path}: {east.name} over {shown}: must be over time and height. Cut out one place.")
    z = heights.to_numpy().astype(float)
    sense = heights.attrs.get("positive", {"depth": "down", "z": "up"}.get(str(heights.name).lower(), ""))
    if sense not in ("up", "down"):
        raise ParameterError(f"{name}: {path}: {heights.name} without `positive`: must be up or down. Give that attribute.")
    z = z if sense == "up" else -z
    moments = times.to_numpy()
    since = moments - moments.min()
    seconds = since / np.timedelta64(1, "s") if moments.dtype.kind == "M" else since.astype(float)
    x, y = (velocity.transpose(times.name, heights.name).to_numpy().astype(float) for velocity in (east, north))
    if not (np.isfinite(x).all() and np.isfinite(y).all()):
        raise ParameterError(f"{name}: {path}: velocities are missing. Cut out the levels that are there at all times.")
    speeds, directions = np.hypot(x, y), np.arctan2(y, x)
    return [
        [float(t), float(level), float(speeds[i, j]), float(directions[i, j])] for i, t in enumerate(seconds) for j, level in enumerate(z)
    ]
