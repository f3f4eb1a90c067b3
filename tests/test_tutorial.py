"""The tutorial: its scene is one, and its commands and its program give what it says."""

from __future__ import annotations

import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

from cable_model.scene import load
from cable_model.simulated import one_line
from fmu_src.native import link

TEXT = (Path(__file__).parents[1] / "docs" / "tutorial.md").read_text(encoding="utf-8")


def block(language: str) -> str:
    (found,) = re.findall(rf"(?s)```{language}\n(.*?)```", TEXT)
    return found


def test_its_scene_is_a_sensor_in_a_current(tmp_path: Path):
    (tmp_path / "my.toml").write_text(block("toml"), encoding="utf-8")
    told = one_line(load(tmp_path / "my.toml"), "chain")
    assert all(effect in told for effect in ("body", "water", "current"))
    weight = 9.81 * (200.0 - 1025.0 * 0.03), 9.81 * 150.0 * (0.39 - 1025.0 * 7.854e-5)
    assert "1660 + 455 N" in TEXT
    assert weight == pytest.approx((1660.0, 455.0), abs=1.0)


@pytest.mark.long
def test_its_commands_and_its_program_give_what_it_says(tmp_path: Path):
    (tmp_path / "my.toml").write_text(block("toml"), encoding="utf-8")
    (tmp_path / "drive.py").write_text(block("python"), encoding="utf-8")
    here = {**os.environ, "PATH": f"{Path(sys.executable).parent}:{os.environ['PATH']}"}

    def run(*command: str, told: str = "") -> str:
        done = subprocess.run(command, cwd=tmp_path, env=here, capture_output=True, text=True, check=False)
        assert (done.returncode, done.stderr.strip()) == (0, told)
        return done.stdout

    assert "1953.7 .. 2278.6" in run("cable-fmu", "run", "my.toml")
    run("cable-fmu", "build", "my.toml", "-o", "My.fmu", "--native", told=link.missing())
    assert run("python", "drive.py") == "largest tension 2336.5 N\n"
