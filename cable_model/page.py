"""A page on which runs of a scene can be watched: one file that holds all it needs, drawn by plotly."""

from __future__ import annotations

import html
from collections.abc import Mapping, Sequence
from pathlib import Path
from types import ModuleType
from typing import Any

from cable_model.errors import ParameterError, writing
from cable_model.moving import Picture, arrange
from cable_model.page_layout import layout
from cable_model.page_traces import fixed_traces, moving_traces
from cable_model.scene import Scene
from cable_model.simulation import Result

MOST_FRAMES = 300
BUTTONS = ["toImage", "pan3d", "orbitRotation", "tableRotation", "resetCameraDefault3d"]  # plotly's own would upload the data, too


def plotly_io() -> ModuleType:
    """plotly's writer; ParameterError where it is not installed."""
    try:
        import plotly.io
    except ImportError as absent:
        raise ParameterError("plotly: not installed. Install it with pip install 'cable-fmu[view]'.") from absent
    writer: ModuleType = plotly.io
    return writer


def check_page(path: Path) -> None:
    """Refuse, before minutes are spent, what is no name of a page, and a page that nothing can write."""
    if path.is_dir() or path.suffix.lower() not in (".html", ".htm"):
        raise ParameterError(f"{path}: no name of a page. Give one that ends in .html.")
    plotly_io()


def write_page(results: Mapping[str, Result], scene: Scene, path: Path, errors: Sequence[str]) -> None:
    """Write the page of runs of a scene by their models' names; `errors` are told on it."""
    shown = figure(arrange(results, scene, MOST_FRAMES), scene, errors)
    config = {"displaylogo": False, "responsive": True, "modeBarButtons": [BUTTONS]}
    drawn = plotly_io().to_html(
        shown, config=config, auto_play=False, include_plotlyjs=True, full_html=False,
        default_height="100%", div_id="cable", validate=False,
    )  # fmt: skip
    style = "<style>html, body, body > div {height: 100%; margin: 0; overflow: hidden}</style>"
    head = f'<meta charset="utf-8"><title>{html.escape(scene.title)}</title>{style}'
    path.parent.mkdir(parents=True, exist_ok=True)
    with writing(path):
        path.write_text(f'<!DOCTYPE html>\n<html lang="en"><head>{head}</head><body>{drawn}</body></html>\n', encoding="utf-8")


def figure(picture: Picture, scene: Scene, errors: Sequence[str]) -> dict[str, Any]:
    """Data, layout and frames of plotly's figure: first what does not change, then what each frame changes."""
    fixed = fixed_traces(picture, scene)
    moving = [moving_traces(picture, scene, k) for k in range(len(picture.times))]
    traces = list(range(len(fixed), len(fixed) + len(moving[0])))
    frames = [{"name": str(k), "traces": traces, "data": [_changing(trace) for trace in at]} for k, at in enumerate(moving)]
    return {"data": [*fixed, *moving[0]], "layout": layout(picture, scene, errors), "frames": frames}


def _changing(trace: dict[str, Any]) -> dict[str, Any]:
    """What of a trace a frame repeats: its places, and its colours where they are tensions."""
    places = ("z",) if trace["type"] == "surface" else ("x",) if trace["type"] == "scatter" else ("x", "y", "z")
    kept: dict[str, Any] = {axis: trace[axis] for axis in places}
    colours = trace.get("line", {}).get("color")
    if isinstance(colours, list):
        kept["line"] = {"color": colours}
    return kept
