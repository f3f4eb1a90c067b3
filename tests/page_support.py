"""What a page says, read from its text: traces, layout, settings and frames."""

from __future__ import annotations

import json
import re
from pathlib import Path
from typing import Any, NamedTuple


class Page(NamedTuple):
    text: str
    data: list[dict[str, Any]]
    layout: dict[str, Any]
    config: dict[str, Any]
    frames: list[dict[str, Any]]

    def at(self, k: int, name: str) -> dict[str, Any]:
        """What frame k says of the trace of that name."""
        (place,) = (i for i, trace in enumerate(self.data) if trace.get("name") == name and trace["type"] == "scatter3d")
        return self.frames[k]["data"][self.frames[k]["traces"].index(place)]


def read_page(path: Path) -> Page:
    text = path.read_text(encoding="utf-8")
    decoder = json.JSONDecoder()

    def after(place: int) -> tuple[Any, int]:
        return decoder.raw_decode(text, re.compile(r"[\s,]*").match(text, place).end())

    data, end = after(text.rindex('"cable",') + len('"cable",'))
    layout, end = after(end)
    config, _ = after(end)
    frames, _ = after(text.rindex("Plotly.addFrames('cable',") + len("Plotly.addFrames('cable',"))
    return Page(text, data, layout, config, frames)
