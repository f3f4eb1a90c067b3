"""What pip installs: the command, and a wheel that needs nothing of the repository."""

from __future__ import annotations

import re
import shutil
import subprocess
import sys
import tomllib
import zipfile
from importlib.metadata import entry_points, version
from pathlib import Path

import pytest

from cable_model.scene import shipped

ROOT = Path(__file__).resolve().parent.parent
RUN = "import sys; from fmu_src.command import main; print(sys.modules['fmu_src'].__file__); main()"


def test_pip_puts_a_command_beside_python_that_builds_too():
    (command,) = entry_points(group="console_scripts", name="cable-fmu")
    assert command.value == "fmu_src.command:main"
    shown = [subprocess.run([Path(sys.executable).parent / "cable-fmu", word], capture_output=True, text=True, check=True).stdout
             for word in ("--version", "--help")]  # fmt: skip
    assert shown[0] == f"cable-fmu {version('cable-fmu')}\n"
    assert all(name in shown[1] for name in ("run ", "build ", "--install-completion"))


def test_nothing_but_the_laboratory_knows_the_laboratory():
    """It is not in the wheel."""
    for package in ("cable_model", "fmu_src"):
        for path in (ROOT / package).rglob("*.py"):
            if "lab" not in path.relative_to(ROOT).parts:
                assert "cable_model.lab" not in path.read_text(encoding="utf-8"), path
    for path in (ROOT / "tests").glob("*.py"):
        assert not re.search(r"(?m)^\s*(from|import) cable_model\.lab", path.read_text(encoding="utf-8")), path


def test_scenes_of_every_folder_are_in_the_wheel():
    given = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["tool"]["setuptools"]["package-data"]["cable_model"]
    folders = {path.parent.relative_to(ROOT / "cable_model").as_posix() for path in shipped().values()}
    assert {f"{folder}/*.toml" for folder in folders} == set(given) - {"object_code/*"}


@pytest.mark.long
def test_a_wheel_builds_an_fmu_in_an_empty_folder(tmp_path: Path):
    subprocess.run([sys.executable, "-m", "pip", "wheel", "-q", "--no-deps", "-w", tmp_path, ROOT], check=True, timeout=600)
    (wheel,) = tmp_path.glob("*.whl")
    with zipfile.ZipFile(wheel) as archive:
        archive.extractall(tmp_path / "site")
    assert not (tmp_path / "site" / "cable_model" / "lab").exists()
    assert len(list((tmp_path / "site" / "cable_model" / "object_code").iterdir())) == 6
    assert not (ROOT / "cable_model" / "object_code").exists()
    empty = tmp_path / "empty"
    empty.mkdir()
    command = [sys.executable, "-c", RUN, "build", "dale_sphere", "-o", "My.fmu", "--model", "tow", "--native", "--simulate", "dale_sphere"]
    environment = {"PATH": "/usr/bin:/bin", "HOME": str(tmp_path), "PYTHONPATH": str(tmp_path / "site")}
    done = subprocess.run(command, cwd=empty, env=environment, capture_output=True, text=True, check=False, timeout=1200)
    assert done.returncode == 0, done.stderr
    assert str(tmp_path / "site") in done.stdout.splitlines()[0]
    assert {path.name for path in empty.rglob("*.fmu")} == {"My.fmu"}
    assert len(list(empty.rglob("*.fmu"))) == 2
    # and what lies in it serves: nothing is compiled, for a run or for FMUs
    shutil.rmtree(tmp_path / ".cache")
    for arguments in (["run", "towed_body", "-o", "out.csv"], ["build", "--no-native", "-o", "dist"]):
        subprocess.run([*command[:3], *arguments], cwd=empty, env=environment, capture_output=True, text=True, check=True, timeout=1200)
    kept = {path.suffix for path in (tmp_path / ".cache").rglob("*")}
    assert not {".o", ".bc", ".nbi", ".nbc"} & kept
