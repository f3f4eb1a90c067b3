"""Where things are on the page of runs: the space in true proportions, three time series, the slider and its buttons."""

from __future__ import annotations

import html
import textwrap
from collections.abc import Sequence
from typing import Any

import numpy as np

from cable_model.moving import Panel, Picture, panels
from cable_model.page_traces import AXES, colour_of
from cable_model.plots import GREY, opened
from cable_model.scene import Scene

WORDS = 105  # characters in a line of the title
BAR, SPACE = 0.07, 0.62  # of the page's width: left of the space is the bar of colours, beside it are the panels
ROWS = ((0.755, 0.96), (0.485, 0.69), (0.215, 0.42))  # of its height, of each panel
ROOM = (2.5, 1.8)  # for the box, across and upright, in plotly's lengths
EYE = {False: (0.35, -1.8, 0.35), True: (1.0, -1.4, 0.6)}  # where the cable is looked at from in the plane, and in space
LAST = "3"  # panel, under which the time is written
WRONG = "#c1212d"


def layout(picture: Picture, scene: Scene, errors: Sequence[str]) -> dict[str, Any]:
    """plotly's layout; `errors` are told under the title."""
    title = textwrap.wrap(html.escape(scene.title, quote=False), WORDS)
    for error in errors:
        title += [f'<span style="color:{WRONG}">{line}</span>' for line in textwrap.wrap(html.escape(error, quote=False), WORDS)]
    if picture.output_steps > 1.0:
        apart = float(np.ptp(picture.times)) / (len(picture.times) - 1)
        title.append(
            f'<span style="color:{GREY}">The cable is shown every {apart:.3g} s, at one of {picture.output_steps:.2g} output steps: '
            "what swings faster looks slower here. The curves have all peaks.</span>"
        )
    return {
        "margin": {"l": 8, "r": 12, "t": 10 + 20 * len(title), "b": 8}, "font": {"size": 12, "color": "#222222"},
        "paper_bgcolor": "white", "plot_bgcolor": "white", "showlegend": False, "uirevision": "kept",
        "scene": _space(picture, scene), **_axes(picture, scene),
        "annotations": [_text("<br>".join(title), 0.0, 1.0, 15), *_headings(picture, scene)],
        "sliders": [_slider(picture)], "updatemenus": [_buttons(picture)],
    }  # fmt: skip


def _space(picture: Picture, scene: Scene) -> dict[str, Any]:
    """True proportions, seen without perspective: from the side where the cable keeps to a plane."""
    sides = picture.high - picture.low
    eye = np.array(EYE[scene.solver.space])
    axes = {
        f"{axis}axis": {
            "title": {"text": ""}, "tickprefix": f"{axis} = ", "ticksuffix": " m", "showtickprefix": "last", "showticksuffix": "last",
            "range": [float(picture.low[k]), float(picture.high[k])], "backgroundcolor": "white",
            "gridcolor": "#dddddd", "zerolinecolor": "#dddddd", "showspikes": False, "nticks": 2 + round(6 * sides[k] / picture.size),
            "tickangle": 0, "tickfont": {"size": 11},
        }
        for k, axis in enumerate("xyz")
    }  # fmt: skip
    return {
        "domain": {"x": [BAR, SPACE], "y": [0.12, 1.0]}, "aspectmode": "manual", "hovermode": "closest",
        "aspectratio": dict(zip("xyz", (sides * _zoom(sides, eye)).tolist(), strict=True)),
        "camera": {"projection": {"type": "orthographic"}, "eye": dict(zip("xyz", eye.tolist(), strict=True))}, **axes,
    }  # fmt: skip


def _zoom(sides: np.ndarray, eye: np.ndarray) -> float:
    """Of a box, so that it fills its part of the page; a distance of the eye brings nothing nearer that is seen without perspective."""
    right = np.cross((0.0, 0.0, 1.0), eye)
    up = np.cross(eye, right)
    return float(min(room / (np.abs(axis) / np.linalg.norm(axis) @ sides) for room, axis in zip(ROOM, (right, up), strict=True)))


def _axes(picture: Picture, scene: Scene) -> dict[str, Any]:
    """Of the three panels, over one time; those of cursors lie over them and go from 0 to 1."""
    axes: dict[str, Any] = {}
    line = {"gridcolor": "#e4e4e4", "zeroline": False, "linecolor": "#888888", "showline": True, "exponentformat": "SI"}
    shown = [panels(moving.run, scene) for moving in picture.cables.values()]
    for k, ((n, upright), row) in enumerate(zip(AXES.items(), ROWS, strict=True)):
        axes[f"xaxis{n}"] = {"domain": [SPACE + 0.05, 1.0], "anchor": f"y{n}", "showticklabels": n == LAST} | line
        axes[f"yaxis{n}"] = {"domain": row, "anchor": f"x{n}", **_range([of_run[k] for of_run in shown])} | line
        axes[f"yaxis{upright}"] = {"overlaying": f"y{n}", "anchor": f"x{n}", "range": [0.0, 1.0], "visible": False}
        if n:
            axes[f"xaxis{n}"]["matches"] = "x"
    axes[f"xaxis{LAST}"]["title"] = {"text": "time [s]"}
    return axes


def _range(shown: Sequence[Panel]) -> dict[str, Any]:
    """Of an upright axis: plotly's own, but where there is next to nothing to see."""
    values = np.concatenate([line for panel in shown for line in panel.lines.values()])
    low, high, least = float(values.min()), float(values.max()), max(panel.least for panel in shown)
    return {} if high - low > least else {"range": [*opened(low, high, least)]}


def _headings(picture: Picture, scene: Scene) -> list[dict[str, Any]]:
    """Over each panel what it shows, and the names of its lines in their colours."""
    shown = [panels(moving.run, scene) for moving in picture.cables.values()]
    headings = []
    for panel, row in zip(shown[0], ROWS, strict=True):
        names = [*panel.lines] if len(panel.lines) > 1 else [*picture.cables] if len(shown) > 1 else []
        coloured = [f'<span style="color:{colour_of(panel, name, k)}"><b>{name}</b></span>' for k, name in enumerate(names)]
        headings.append(_text("&nbsp;&nbsp; ".join((panel.label, *coloured)), SPACE + 0.05, row[1], 12))
    return headings


def _text(text: str, x: float, y: float, size: int) -> dict[str, Any]:
    """A text whose lower left corner is at a place of the page."""
    place = {"xref": "paper", "yref": "paper", "x": x, "y": y, "xanchor": "left", "yanchor": "bottom"}
    return {"text": text, "align": "left", "showarrow": False, "font": {"size": size}, **place}


def _move(duration: float, **more: Any) -> dict[str, Any]:
    return {"mode": "immediate", "frame": {"duration": duration, "redraw": True}, "transition": {"duration": 0}, **more}


def _slider(picture: Picture) -> dict[str, Any]:
    digits = max(0, 2 - int(np.floor(np.log10(max(picture.times[-1], 1e-3)))))
    steps = [
        {"label": f"{time:.{digits}f}", "method": "animate", "args": [[str(k)], _move(0.0)]}
        for k, time in enumerate(picture.times.tolist())
    ]
    return {
        "x": 0.18, "len": 0.82, "y": 0.0, "yanchor": "bottom", "pad": {"t": 0, "b": 0}, "ticklen": 3, "minorticklen": 0,
        "tickcolor": "#aaaaaa", "font": {"size": 10, "color": "#555555"}, "transition": {"duration": 0},
        "currentvalue": {"prefix": "t = ", "suffix": " s", "xanchor": "left", "font": {"size": 14, "color": "#222222"}}, "steps": steps,
    }  # fmt: skip


def _buttons(picture: Picture) -> dict[str, Any]:
    return {
        "type": "buttons", "direction": "right", "x": 0.0, "xanchor": "left", "y": 0.02, "yanchor": "bottom", "showactive": False,
        "buttons": [
            {
                "label": f"▶ {picture.speed:.2g} x real time", "method": "animate",
                "args": [None, _move(1e3 * picture.pace, fromcurrent=True)],
            },
            {"label": "❚❚", "method": "animate", "args": [[None], _move(0.0)]},
        ],
    }  # fmt: skip
