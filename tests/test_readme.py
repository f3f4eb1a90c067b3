"""The README says what is true: its Python block runs, its test command is what CI runs."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

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
