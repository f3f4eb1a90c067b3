"""The README says what is true: its Python block runs, its test command is what CI runs."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from cable_model.cli import app
from fmu_src.command import COMPILING
from fmu_src.variables_page import PAGES, replaced

ROOT = Path(__file__).resolve().parent.parent
README = (ROOT / "README.md").read_text(encoding="utf-8")


@pytest.mark.parametrize("name", PAGES)
def test_the_tables_of_variables_and_of_scenes_are_those_of_the_code(name):
    page = (ROOT / "docs" / name).read_text(encoding="utf-8")
    assert replaced(page, name) == page, "run: python -m fmu_src.variables_page"


@pytest.mark.parametrize("block", re.findall(r"```python\n(.*?)```", README, re.DOTALL))
def test_a_python_block_runs(block, capsys):
    exec(compile(block, "README.md", "exec"), {})
    assert capsys.readouterr().out.startswith("1.0 ")


def test_the_test_command_is_found_by_ci():
    marked = re.search(r"<!-- test command -->\n```bash\n(.*?)\n```", README, re.DOTALL)
    assert marked is not None
    assert marked[1].endswith("-m pytest -q -n 2")
    assert "test command" in (ROOT / ".ci" / "run").read_text(encoding="utf-8")


PAGES_OF_TEXT = sorted(path for path in (*ROOT.glob("*.md"), *(ROOT / "docs").rglob("*.md")))


def anchors(page: str) -> set[str]:
    """Of the headings of a page, as they are made where the repository is shown."""
    heads = re.findall(r"^#+ (.*)$", re.sub(r"```.*?```", "", page, flags=re.DOTALL), re.MULTILINE)
    return {re.sub(r"[^\w\- ]", "", head.lower()).strip().replace(" ", "-") for head in heads}


@pytest.mark.parametrize("path", PAGES_OF_TEXT, ids=lambda path: path.relative_to(ROOT).as_posix())
def test_no_link_of_a_page_is_dead(path):
    page = re.sub(r"```.*?```", "", path.read_text(encoding="utf-8"), flags=re.DOTALL)
    for target in re.findall(r"\]\(([^)\s]+)\)", page):
        if target.startswith(("http://", "https://")):
            continue
        name, _, anchor = target.partition("#")
        other = (path.parent / name).resolve() if name else path
        assert other.exists(), target
        if anchor:
            assert anchor in anchors(other.read_text(encoding="utf-8")), target


def test_the_readme_is_read_in_a_minute_and_every_command_it_names_is_one():
    assert len(README.splitlines()) <= 120
    known = {command.name or command.callback.__name__ for command in app.registered_commands}
    named = set(re.findall(r"cable-fmu ([a-z]+)", README + (ROOT / "docs" / "commands.md").read_text(encoding="utf-8")))
    assert named <= known | COMPILING.keys(), named - known
