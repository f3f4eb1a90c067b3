"""One command writes every generated figure and table of docs/ again."""

from pathlib import Path

import pytest
from typer.testing import CliRunner

from cable_model.errors import ParameterError
from cable_model.lab import docs as cli_docs
from cable_model.lab.cli import app

DOCS = Path(__file__).parents[2] / "docs"


def run(*arguments: str):
    return CliRunner().invoke(app, ["docs", *arguments])


def test_small_sizes_of_pictures_and_effects_are_written(tmp_path):
    # the other parts run small in the tests of their own commands
    done = run("--quick", "-o", str(tmp_path), "--only", "pictures", "--only", "effects")
    assert done.exit_code == 0, done.output
    assert (tmp_path / "dale_sphere.png").stat().st_size > 10_000
    assert "| bending |" in (tmp_path / "cost_of_effects.md").read_text(encoding="utf-8")


def test_what_fails_is_named_and_the_rest_is_written(tmp_path, monkeypatch):
    def fails(folder: Path, quick: bool) -> None:
        raise ParameterError("moordyn: not installed. Install it.")

    def writes(folder: Path, quick: bool) -> None:
        (folder / "written").write_text("x", encoding="utf-8")

    monkeypatch.setattr(cli_docs, "WRITERS", {"peers": fails, "limits": writes})
    done = run("-o", str(tmp_path))
    assert done.exit_code == 1
    assert "peers: moordyn: not installed" in done.output
    assert (tmp_path / "written").is_file()


def test_an_unknown_part_is_refused_with_the_nearest_name():
    done = run("--only", "limit")
    assert isinstance(done.exception, ParameterError)
    assert "limits" in str(done.exception)


@pytest.mark.parametrize("path", sorted(path.relative_to(DOCS).as_posix() for path in DOCS.rglob("*") if path.is_file()))
def test_every_file_of_docs_belongs_to_a_part(path):
    homes = (
        "hard/",
        "published/",
        "studies/",
        "cost_of_effects.md",
        "limits.md",
        "peers.md",
        "targets.md",
        "fmu_variables.md",  # by fmu_src.variables_page
        "scene_values.md",  # likewise
        "fmu_hosts.md",  # written by hand, as are the guides
        "fmus.md",
        "accuracy.md",
        "commands.md",
        "effects.md",
        "how_to/",
        "theory.md",
        "tutorial.md",
        *(f"{name}.png" for name in cli_docs.PICTURED),
    )
    assert path.startswith(homes)
