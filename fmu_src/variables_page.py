"""The pages of the FMUs' variables and of the values of scenes: `python -m fmu_src.variables_page` writes them into docs/."""

from __future__ import annotations

import dataclasses
import re
from collections.abc import Callable
from pathlib import Path

from cable_model import parameters
from cable_model.quantity import rule_of
from cable_model.scene import Scene
from fmu_src.interface import Variable, table

_BLOCK = re.compile(r"(<!-- table -->\n).*?(<!-- end of table -->)", re.DOTALL)


def _range(row: Variable) -> str:
    if row.gap is not None:
        return "{:g}, >= {:g}".format(*row.gap) + (f", <= {row.maximum:g}" if row.maximum is not None else "")
    low = "" if row.minimum is None else f"{'>' if row.minimum_excluded else '>='} {row.minimum:g}"
    high = "" if row.maximum is None else f"<= {row.maximum:g}"
    return ", ".join(bound for bound in (low, high) if bound)


COLUMNS = ("name", "kind", "type", "unit", "start", "range", "meaning")


def cells(row: Variable) -> tuple[str, ...]:
    """What a table says of a variable, by COLUMNS."""
    start = "" if row.start is None else f"{row.start:g}" if isinstance(row.start, float) else str(row.start).lower()
    return row.name, row.causality, row.kind, row.unit, start, _range(row), row.description


def markdown() -> str:
    """The variables of both FMUs as a Markdown table."""
    lines = ["| " + " | ".join(COLUMNS) + " |", "|" + len(COLUMNS) * "---|"]
    for name, *others in map(cells, table()):
        lines.append("| " + " | ".join((f"`{name}`", *others)) + " |")
    return "\n".join(lines) + "\n"


_KINDS = {bool: "true, false", tuple: "rows", str: "text"}


def _rows(part: str, holder: type) -> list[str]:
    """Lines of the values of one part of a scene."""
    lines = []
    for field in dataclasses.fields(holder):
        facts = field.metadata
        if not facts:
            continue
        default = "must be given" if field.default is dataclasses.MISSING else _shown(field.default)
        unit = "" if facts["unit"] == "1" else facts["unit"]
        allowed = ", ".join(map(repr, facts["choices"])) if facts["choices"] else _KINDS.get(type(field.default)) or rule_of(facts)
        lines.append(f"| `{part}{field.name}` | {unit} | {default} | {allowed} | {facts['description']} |")
    return lines


def _shown(value: object) -> str:
    if isinstance(value, tuple):
        return "none" if not value else str(list(value))
    return str(value).lower() if isinstance(value, bool) else f"{value:g}" if isinstance(value, float) else str(value)


ROWS: dict[str, tuple[tuple[str, type], ...]] = {  # what tables of tables hold, after the part that has them
    "cable": (("cable.section", parameters.Section), ("cable.body", parameters.LineBody)),
    "top": (("top.motion", parameters.Motion),),
}


def scenes() -> str:
    """The values of scenes as a Markdown table."""
    lines = ["| name | unit | default | allowed | meaning |", "|---|---|---|---|---|"]
    for field in dataclasses.fields(Scene):
        if field.metadata:
            lines += [f"| `{field.name}` | | | | {field.metadata['description']} |"]
            continue
        lines += _rows(f"{field.name}.", parameters.holder_of(field.name))
        for name, row in ROWS.get(field.name, ()):
            lines += _rows(f"[[{name}]] ", row)
    return "\n".join(lines) + "\n"


PAGES: dict[str, Callable[[], str]] = {"fmu_variables.md": markdown, "scene_values.md": scenes}  # in docs/


def replaced(page: str, name: str) -> str:
    """The text of the page of this name with the table as it is now."""
    return _BLOCK.sub(lambda match: match[1] + PAGES[name]() + match[2], page)


if __name__ == "__main__":
    for name in PAGES:
        path = Path("docs") / name
        path.write_text(replaced(path.read_text(encoding="utf-8"), name), encoding="utf-8")
