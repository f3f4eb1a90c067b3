"""What plotly draws on the page of runs: water, seabed, cables and their ends in space, and time series with their cursors."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from cable_model.moving import Moving, Panel, Picture, is_held, keeping_peaks, panels, word_of_lower_end
from cable_model.plots import COLOURS, GREY, SEA, SEABED
from cable_model.scene import Scene
from cable_model.surroundings import Surface

MOST_VALUES = 1000  # of a time series: two for each dot across its panel
RARE = 1.5  # peaks so far above all but a hundredth of the tensions are told in words: in colours the rest would all look slack
DIGITS = 4  # after the first of the largest number
TENSION_COLOURS = ((0.0, "#2f55b5"), (0.35, "#23a0a0"), (0.65, "#e8a628"), (1.0, "#c1212d"))
AXIS_COLOURS = {"x": "#1f5a99", "y": "#3b8f5a", "z": "#d1602b"}  # told apart by colour-blind readers too
DASHES = ("solid", "dash")  # of the models
AXES = {"": "4", "2": "5", "3": "6"}  # of the panels, as plotly numbers axes, and the upright ones of their cursors

Trace = dict[str, Any]


def fixed_traces(picture: Picture, scene: Scene) -> list[Trace]:
    """Still water, seabed, the path of a free lower end, and the time series."""
    traces = []
    if picture.surface is not None:
        traces.append(_name(picture, 0.0, "waves" if picture.surface.moves else "still water", SEA))
        if not picture.surface.moves:
            traces.append(_sheet(picture.surface, 0, SEA))
    if picture.seabed is not None:
        traces += [_name(picture, float(picture.seabed.at(0)[0, 0]), "seabed", SEABED), _sheet(picture.seabed, 0, SEABED)]
    if not is_held(scene):
        path = {"mode": "lines", "line": {"color": GREY, "width": 1.5}, "hoverinfo": "skip"}
        traces += [_in_space(picture, moving.places[:, 0]) | path for moving in picture.cables.values()]
    for model, (label, moving) in enumerate(picture.cables.items()):
        traces += _series(label, moving, scene, model)
    return traces


def moving_traces(picture: Picture, scene: Scene, k: int) -> list[Trace]:
    """The waves, the cables with their ends, and the cursors of the time series at moment k."""
    traces = [_sheet(picture.surface, k, SEA)] if picture.surface is not None and picture.surface.moves else []
    for (label, moving), colour in zip(picture.cables.items(), COLOURS, strict=False):
        traces += [_cable(picture, label, moving, k, colour), _ends(picture, moving, scene, k, colour)]
    time = float(picture.times[k])
    cursor = {"type": "scatter", "mode": "lines", "line": {"color": GREY, "width": 1.5}, "hoverinfo": "skip"}
    traces += [{"x": [time, time], "y": [0.0, 1.0], "xaxis": f"x{n}", "yaxis": f"y{upright}"} | cursor for n, upright in AXES.items()]
    return traces


def colour_of(panel: Panel, name: str, model: int) -> str:
    """Of a line of a panel: that of its axis where the panel has several, or else of its model."""
    return AXIS_COLOURS[name] if len(panel.lines) > 1 else COLOURS[model]


def _rounded(values: np.ndarray, size: float) -> list[Any]:
    """Numbers with the digits that can be seen where the largest are of this size."""
    numbers: list[Any] = np.round(values, DIGITS - math.floor(math.log10(size)) if size > 0.0 else DIGITS).tolist()
    return numbers


def _in_space(picture: Picture, places: np.ndarray) -> Trace:
    """Points (n, 3)."""
    return {"type": "scatter3d", **{axis: _rounded(places[:, k], picture.size) for k, axis in enumerate("xyz")}}


def _name(picture: Picture, level: float, name: str, colour: str) -> Trace:
    """The name of a level at a corner of the box."""
    x, y, _ = picture.low + 0.02 * picture.size
    text = {"mode": "text", "text": [name], "textposition": "middle right", "textfont": {"color": colour, "size": 13}, "hoverinfo": "skip"}
    return _in_space(picture, np.array([[x, y, level]])) | text


def _sheet(surface: Surface, k: int, colour: str) -> Trace:
    """A surface at moment k, in one colour."""
    size = float(np.ptp(surface.x))
    return {
        "type": "surface", "x": _rounded(surface.x, size), "y": _rounded(surface.y, size), "z": _rounded(surface.at(k), size),
        "surfacecolor": np.zeros((len(surface.y), len(surface.x))).tolist(), "colorscale": [[0.0, colour], [1.0, colour]],
        "showscale": False, "opacity": 0.35, "hoverinfo": "skip", "lighting": {"ambient": 0.75, "diffuse": 0.5, "specular": 0.1},
    }  # fmt: skip


def _cable(picture: Picture, label: str, moving: Moving, k: int, colour: str) -> Trace:
    """A cable in the colours of its tension; where that is not told a pale and broad one, in which the other can lie."""
    told = "<br>".join((label, *(f"{axis} = %{{{axis}:.6~g}} m" for axis in "xyz")))
    shape = _in_space(picture, moving.places[k]) | {"mode": "lines", "name": label}
    if moving.tensions is None:
        return shape | {"line": {"width": 12, "color": colour}, "opacity": 0.4, "hovertemplate": f"{told}<extra></extra>"}
    least, most, peak = np.quantile(moving.tensions, (0.0, 0.99, 1.0)).tolist()
    title = "tension [N]"
    if peak > RARE * most:
        title += f"<br>peaks to {peak:.5g}"
    else:
        most = peak
    bar = {"title": {"text": title}, "x": 0.0, "xanchor": "left", "len": 0.55, "thickness": 12, "exponentformat": "SI"}
    line = {
        "width": 7, "color": _rounded(moving.tensions[k], most), "cmin": least, "cmax": most, "colorscale": TENSION_COLOURS,
        "showscale": True, "colorbar": bar,
    }  # fmt: skip
    return shape | {"line": line, "hovertemplate": f"{told}<br>%{{line.color:.4~s}}N<extra></extra>"}


def _ends(picture: Picture, moving: Moving, scene: Scene, k: int, colour: str) -> Trace:
    """Marks, not to scale, of the lower end and of the top."""
    below = word_of_lower_end(scene)
    size = {"anchor": 6, "driven end": 6, "body": 9, "free end": 3}[below]
    marker = {"symbol": ["diamond" if below == "anchor" else "circle", "square"], "size": [size, 6], "color": ["#222222", colour]}
    shown = {"mode": "markers", "marker": marker, "text": [below, "top"], "hovertemplate": "%{text}<extra></extra>"}
    return _in_space(picture, moving.places[k][[0, -1]]) | shown


def _series(label: str, moving: Moving, scene: Scene, model: int) -> list[Trace]:
    traces = []
    for n, panel in zip(AXES, panels(moving.run, scene), strict=True):
        for name, values in panel.lines.items():
            kept = keeping_peaks(values, MOST_VALUES)
            times = moving.run["time"][kept]
            traces.append({
                "type": "scatter", "mode": "lines", "x": _rounded(times, times[-1]), "y": _rounded(values[kept], np.abs(values).max()),
                "xaxis": f"x{n}", "yaxis": f"y{n}", "name": f"{label} {name}".strip(), "hovertemplate": "%{y:.4~s} at %{x} s",
                "line": {"color": colour_of(panel, name, model), "dash": DASHES[model], "width": 1.4},
            })  # fmt: skip
    return traces
