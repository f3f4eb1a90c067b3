"""Makes the documentation of an FMU from its scene and its variables."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from html import escape
from pathlib import Path
from string import Template

from cable_model import __version__
from cable_model.models import MODELS
from cable_model.scene import Scene
from fmu_src.interface import Variable
from fmu_src.variables_page import COLUMNS, cells

HERE = Path(__file__).resolve().parent
ABOUT = {
    "chain": "A cable under a moving top end: the full finite-difference chain, which bends, goes slack and touches the seabed.",
    "tow": "A straight cable under a moving top end, which swings and stretches, with a body at its lower end.",
}
NATIVE = "It needs no Python, on {}. FMUs of one scene for other platforms have the same {}."
PYTHON = (
    "It runs Python: 3.11 or newer with numpy and numba (or llvmlite alone, for effects that were compiled in) where the host finds it; on "
    "Linux a host that is not Python needs libpython too."
)


def _read(name: str) -> str:
    return (HERE / name).read_text(encoding="utf-8")


def _row(tag: str, words: Sequence[str]) -> str:
    return "<tr>" + "".join(f"<{tag}>{escape(word, quote=False)}</{tag}>" for word in words) + "</tr>"


def page(model: str, identifier: str, rows: Sequence[Variable], scene: Scene, runs: str, fmi: str = "2.0") -> str:
    """documentation/index.html of an FMU of a model ("chain" or "tow"); runs: what it runs on; fmi: its version of FMI."""
    table = "\n".join([_row("th", COLUMNS), *(_row("td", cells(row)) for row in rows)])
    name = " ".join(dict.fromkeys((identifier, MODELS[model].__name__)))
    return Template(_read("page.html")).substitute(
        name=name, about=ABOUT[model], title=escape(scene.title), source=escape(scene.source.strip()),
        runs=runs, sketch=_read("sketch.svg"), equations=_read(f"{model}.html"), limits=_read(f"{model}_limits.html"),
        table=f"<table>\n{table}\n</table>", version=__version__, fmi=fmi,
    )  # fmt: skip


def files(
    model: str,
    identifier: str,
    rows: Sequence[Variable],
    scene: Scene,
    runs: str,
    licences: Mapping[str, str],
    fmi: str = "2.0",
    picture: str = "model.png",
) -> dict[str, bytes]:
    """What an archive holds for people, by its place there; the licences come by their names in documentation/licenses/."""
    return {
        picture: (HERE / "model.png").read_bytes(),
        "documentation/index.html": page(model, identifier, rows, scene, runs, fmi).encode(),
        **{f"documentation/licenses/{name}": text.encode() for name, text in licences.items()},
    }
