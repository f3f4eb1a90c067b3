"""What a study hands over: a title, a caption with its numbers, tables as CSV and Markdown, and a picture; and how they become files."""

from __future__ import annotations

import csv
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
from matplotlib.figure import Figure

from cable_model.errors import writing

HEAD = """# Published figures and tables, computed anew

Written by `python -m cable_model.lab published -o docs/published`.  Every number in the captions is taken from the computed data;
the rows behind each picture are in the CSV file of the same name.
"""
Rows = Sequence[Sequence[object]]


@dataclass(frozen=True)
class Page:
    """One study: `rows` go to a CSV file, `shown` (its head first) into the text, if there is any."""

    name: str
    title: str
    caption: str
    figure: Figure
    head: Sequence[str]
    rows: Rows
    shown: Rows = ()


def number(value: object) -> str:
    return f"{value:.6g}" if isinstance(value, float) else str(value)


def markdown(table: Rows) -> str:
    """A table whose first row is its head; the first column is text, the others are numbers."""
    head, *rows = table
    rule = "|---|" + "---:|" * (len(head) - 1)
    return "\n".join(["| " + " | ".join(number(v) for v in row) + " |" for row in (head,)] + [rule] +
                     ["| " + " | ".join(number(v) for v in row) + " |" for row in rows])  # fmt: skip


def section(page: Page) -> str:
    parts = [f"## {page.title}", page.caption, f"![{page.title}]({page.name}.png)"]
    return "\n\n".join(parts + ([markdown(page.shown)] if page.shown else [])) + "\n"


def write(folder: Path, page: Page, order: Sequence[str]) -> None:
    """Picture, CSV and the page's section in README.md; `order` names all pages, sections of others stay as they are."""
    folder.mkdir(parents=True, exist_ok=True)
    page.figure.tight_layout()
    page.figure.savefig(folder / f"{page.name}.png", dpi=72)
    plt.close(page.figure)
    table = folder / f"{page.name}.csv"
    with writing(table), table.open("w", encoding="utf-8", newline="") as file:
        rows = csv.writer(file, lineterminator="\n")
        rows.writerow(page.head)
        rows.writerows([number(v) for v in row] for row in page.rows)
    index = folder / "README.md"
    kept = index.read_text(encoding="utf-8").split("\n## ")[1:] if index.is_file() else []
    sections = {_picture_of(text): f"## {text.strip()}\n" for text in kept}
    sections[page.name] = section(page)
    known = [sections[name] for name in order if name in sections]
    index.write_text("\n".join([HEAD, *known]), encoding="utf-8")


def _picture_of(text: str) -> str:
    """The name of the page that a section belongs to, from its picture."""
    return text.partition(".png)")[0].rpartition("(")[2]
