"""The page of the FMUs' variables, from the interface table: `python -m fmu_src.variables_page` writes it into docs/."""

from __future__ import annotations

import re
from pathlib import Path

from fmu_src.interface import Variable, table

_BLOCK = re.compile(r"(<!-- interface table -->\n).*?(<!-- end of interface table -->)", re.DOTALL)


def _range(row: Variable) -> str:
    if row.gap is not None:
        return "{:g}, >= {:g}".format(*row.gap) + (f", <= {row.maximum:g}" if row.maximum is not None else "")
    low = "" if row.minimum is None else f"{'>' if row.minimum_excluded else '>='} {row.minimum:g}"
    high = "" if row.maximum is None else f"<= {row.maximum:g}"
    return ", ".join(bound for bound in (low, high) if bound)


def markdown() -> str:
    """The variables of both FMUs as a Markdown table."""
    lines = ["| name | kind | type | unit | start | range | meaning |", "|---|---|---|---|---|---|---|"]
    for row in table():
        start = "" if row.start is None else f"{row.start:g}" if isinstance(row.start, float) else str(row.start).lower()
        cells = (f"`{row.name}`", row.causality, row.kind, row.unit, start, _range(row), row.description)
        lines.append("| " + " | ".join(cells) + " |")
    return "\n".join(lines) + "\n"


def replaced(page: str) -> str:
    """The page's text with the table as it is now."""
    return _BLOCK.sub(lambda match: match[1] + markdown() + match[2], page)


if __name__ == "__main__":
    path = Path("docs/fmu_variables.md")
    path.write_text(replaced(path.read_text(encoding="utf-8")), encoding="utf-8")
