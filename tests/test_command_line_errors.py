"""What is wrong around a run ends the command line with one line that says so, and loses nothing; texts are shown as they are."""

from __future__ import annotations

import gc
import os
import re
import subprocess
import sys
import zipfile
from pathlib import Path

import pytest
from typer.testing import CliRunner

from cable_model import cli, workers
from cable_model.cli import app
from cable_model.errors import ParameterError, SolverError, refuse
from cable_model.fmu_check import simulate_fmu
from cable_model.scene import load
from cable_model.simulation import read_csv, write_csv
from cable_model.studies import sweep

TITLE = "a [/x] [bold] $x_$ :smile: title"
SCENE = f"""title = "{TITLE}"
source = "from [water], see [1]"
[cable]
length = 1.75
mass_per_length = 0.1
axial_stiffness = 17167.5
[solver]
nodes = 6
[run]
duration = 0.2
"""


@pytest.fixture
def scene(tmp_path: Path) -> Path:
    path = tmp_path / "short.toml"
    path.write_text(SCENE, encoding="utf-8")
    return path


@pytest.fixture
def shown(capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch):
    """Runs the command line in this process; its exit status and what it shows."""

    def run(*arguments: object) -> tuple[int, str]:
        monkeypatch.setattr(sys, "argv", ["cable_model", *map(str, arguments)])
        with pytest.raises(SystemExit) as ended:
            cli.main()
        return int(ended.value.code or 0), capsys.readouterr().out

    return run


@pytest.fixture
def refused(shown):
    """The line that an error is, without "error: "."""

    def run(*arguments: object) -> str:
        status, text = shown(*arguments)
        assert status == 2
        (line,) = text.strip().splitlines()
        assert line.startswith("error: ")
        return line.removeprefix("error: ")

    return run


def test_brackets_in_an_error_come_out_whole(scene, refused):
    scene.write_text(SCENE + "[current]\nspeed = 1.0\n", encoding="utf-8")
    assert refused("run", scene) == "current.speed = 1 m/s: must be 0 without water. Add [water] or remove [current]."


def test_a_title_is_shown_as_it_is(scene, shown, tmp_path):
    status, text = shown("describe", scene, "--model", "chain")
    assert status == 0 and TITLE in text and "from [water], see [1]" in text
    assert shown("run", scene, "-o", tmp_path / "a.csv")[0] == 0
    assert shown("plot", scene, "--model", "tow", "-o", tmp_path / "a.png")[0] == 0


@pytest.mark.parametrize("command", [("plot",), ("view",), ("run", "--model", "both")])
def test_a_scene_that_no_model_takes_is_refused_after_what_each_lacks(scene, shown, command):
    scene.write_text(SCENE + "[tow]\nas_printed = true\n[lower_end]\nanchored = true\n", encoding="utf-8")
    status, text = shown(command[0], scene, *command[1:])
    lines = " ".join(text.split())
    assert status == 2
    assert "CableChain is left out: " in lines and "TowCable is left out: " in lines
    assert lines.endswith("error: neither model has all that the scene asks for. Remove what each was left out for.")


def test_the_help_of_every_command_has_its_brackets():
    assert "lists of values in [vary]" in " ".join(CliRunner().invoke(app, ["sweep", "--help"]).output.split())


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="needs a disk that is full")
def test_a_full_disk_is_named(scene, refused):
    told = "/dev/full: No space left on device. Free some space, or write elsewhere with -o."
    assert refused("run", scene, "-o", "/dev/full") == told
    with pytest.raises(OSError, match="No space left") as full:
        write_csv(Path("/dev/full"), ("time",), read_csv_of(scene)[1])
    assert full.value.filename == "/dev/full"


def read_csv_of(scene: Path):
    """Any table."""
    path = scene.with_suffix(".csv")
    path.write_text("time\n0\n1\n", encoding="utf-8")
    return read_csv(path)


def test_a_folder_is_no_output(scene, refused, tmp_path):
    told = f"{tmp_path}: is a folder. Give the name of a file."
    assert refused("run", scene, "-o", tmp_path) == told
    assert refused("advise", scene, "-o", tmp_path) == told
    assert refused("check", tmp_path / "x.fmu", "--scene", scene, "--write", "--reference", tmp_path) == told
    assert refused("study", scene, "-o", scene) == f"{scene}: is a file. Give the name of a folder."
    for name in (tmp_path, tmp_path / "a.xyz"):
        assert refused("plot", scene, "-o", name).startswith(f"{name}: no name of a picture file. Give one that ends in one of .")


def test_new_overwrites_nothing_and_names_the_nearest_scene(scene, refused, tmp_path):
    told = refused("new", "umbilical", "-o", scene)
    assert told == f"{scene}: is there already. Give another name with -o, or move it away."
    assert scene.read_text(encoding="utf-8") == SCENE
    assert refused("new", "umbilical", "-o", tmp_path) == f"{tmp_path}: is a folder. Give the name of a file."
    assert refused("new", "umbilcal", "-o", tmp_path / "a.toml").startswith(
        "umbilcal: unknown scene. Did you mean 'examples/umbilical'? Known: "
    )
    assert not (tmp_path / "a.toml").exists()


def test_a_scene_that_cannot_begin_leaves_the_file_of_an_earlier_run(scene, refused, tmp_path):
    kept = tmp_path / "kept.csv"
    kept.write_text("what was there", encoding="utf-8")
    scene.write_text(SCENE + "[top]\nposition = [0.0, 0.0, -1.0]\n[seabed]\nlevel = 0.0\nstiffness = 1e5\n", encoding="utf-8")
    scene.write_text(scene.read_text(encoding="utf-8").replace("17167.5", "17167.5\ndiameter = 0.01"), encoding="utf-8")
    assert refused("run", scene, "-o", kept).startswith("top.z = -1 m: must be >= seabed.level")
    assert kept.read_text(encoding="utf-8") == "what was there"


@pytest.mark.parametrize(
    ("text", "told"),
    [
        ("time,a\n0,1\n1,x\n", ", line 3: could not convert string to float: 'x'. Mend the line, or write the file again."),
        ("time,a\n0,1\n1\n", ", line 3: 1 numbers under 2 names. Mend it, or write the file again."),
        ("time,time\n0,1\n", ", line 1: two columns have one name. Give each column a name of its own."),
        ("", ": no CSV file with a header line. Write it with `python -m cable_model run`."),
        ("\udcff", ": no CSV file with a header line. Write it with `python -m cable_model run`."),
    ],
)
def test_a_malformed_csv_file_is_refused_with_its_line(tmp_path, refused, text, told):
    path, good = tmp_path / "bad.csv", tmp_path / "good.csv"
    path.write_bytes(text.encode(errors="surrogateescape"))
    good.write_text("time,a\n0,1\n1,2\n", encoding="utf-8")
    assert refused("compare", path, good) == f"{path}{told}"
    assert refused("compare", good, path) == f"{path}{told}"


def _zip(path: Path, **members: str) -> Path:
    with zipfile.ZipFile(path, "w") as archive:
        for name, text in members.items():
            archive.writestr(name.replace("__", "."), text)
    return path


def test_a_broken_fmu_is_refused_in_one_line(tmp_path, scene, refused):
    junk, whole, cut = tmp_path / "junk.fmu", _zip(tmp_path / "whole.fmu", modelDescription__xml="<a/>" * 100), tmp_path / "cut.fmu"
    junk.write_bytes(b"no zip")
    cut.write_bytes(whole.read_bytes()[:-30])
    reasons = {
        junk: "it is no zip file, or a part of one",
        cut: "it is no zip file, or a part of one",
        _zip(tmp_path / "empty.fmu", a="b"): "it has no modelDescription.xml",
        _zip(tmp_path / "other.fmu", modelDescription__xml="<a/>"): "its modelDescription.xml is not FMI's",
    }
    for fmu, reason in reasons.items():
        told = refused("check", fmu, "--scene", scene, "--write", "--reference", tmp_path / "r.csv")
        assert told == f"{fmu}: no FMU that can be simulated ({reason}). Build it with `python build_fmu.py`."
    for version in ("2.0", "9"):
        fmu = _zip(tmp_path / f"{version}.fmu", modelDescription__xml=f'<fmiModelDescription fmiVersion="{version}"/>')
        assert refused("check", fmu, "--scene", scene, "--write", "--reference", tmp_path / "r.csv").startswith(f"{fmu}: no FMU that can")
    assert not (tmp_path / "r.csv").exists()
    gc.collect()  # what was left open would be told now


@pytest.mark.parametrize(
    ("digits", "text"),
    [
        (400, rf"cable\.length = 1{'0' * 49}\.\.\. \(401 characters\) m: must be below 1\.8e308\. Give the unstretched length\."),
        (5000, r".*: a number has too many digits \(.*\)\. Numbers must be below 1\.8e308\."),
    ],
)
def test_a_number_of_hundreds_of_digits_is_refused(scene, refused, tmp_path, digits, text):
    scene.write_text(SCENE.replace("1.75", "1" + "0" * digits), encoding="utf-8")
    assert re.fullmatch(text, refused("run", scene))
    (tmp_path / "sweep.toml").write_text(f'scene = "free_chain"\n[vary]\n"cable.length" = [1{"0" * digits}]\n', encoding="utf-8")
    assert re.fullmatch(text, refused("sweep", tmp_path / "sweep.toml", "-o", tmp_path / "found"))


def test_an_error_shows_the_beginning_of_a_long_value():
    assert str(refuse("a", 10**300, "m", "small", "Less.")) == f"a = 1{'0' * 49}... (301 characters) m: must be small. Less."


def test_values_of_a_sweep_must_not_repeat():
    with pytest.raises(ParameterError, match=r"^vary: solver\.nodes = 6\.0: must be there once only\. Remove the repetition\.$"):
        sweep.jobs(load("free_chain"), {"solver.nodes": [6, 11, 6.0]})


def test_a_damaged_summary_is_told_and_its_run_done_again(scene, shown, tmp_path):
    (tmp_path / "sweep.toml").write_text('scene = "short.toml"\n[vary]\n"solver.nodes" = [6, 7]\n', encoding="utf-8")
    command = ("sweep", tmp_path / "sweep.toml", "-o", tmp_path / "found", "--workers", "1")
    assert shown(*command)[0] == 0
    whole = {path: path.read_text(encoding="utf-8") for path in (tmp_path / "found").glob("*.json")}
    torn, intact = whole
    torn.write_text(whole[torn][:20], encoding="utf-8")
    stamp = intact.stat().st_mtime_ns
    status, text = shown(*command)
    assert status == 0 and f"{torn}: damaged; its run is done again" in text
    assert torn.read_text(encoding="utf-8") == whole[torn] and intact.stat().st_mtime_ns == stamp


def test_a_damaged_cache_of_kernels_is_emptied_and_told(scene, tmp_path):
    command = [sys.executable, "-m", "cable_model", "run", str(scene), "--model", "tow", "-o", str(tmp_path / "a.csv")]
    elsewhere = {**os.environ, "XDG_CACHE_HOME": str(tmp_path / "cache")}  # where no object code lies ready
    assert subprocess.run(command, capture_output=True, check=False, env=elsewhere).returncode == 0
    for index in tmp_path.rglob("*.nbi"):
        index.write_bytes(index.read_bytes()[:40])
    told = subprocess.run(command, capture_output=True, text=True, check=False, env=elsewhere)
    assert told.returncode == 2 and told.stderr == ""
    shown = re.fullmatch(r"error: (\S+): the compiled kernels there were damaged, and are removed\. Call it again\.", told.stdout.strip())
    assert shown is not None and not list(Path(shown[1]).glob("*.nb?"))


def test_a_step_that_an_fmu_refuses_ends_in_its_own_words(monkeypatch, tmp_path, shown):
    def stopped(*given, **named):
        raise SolverError("x.fmu: fmi2DoStep failed with status 3 (error). [the FMU's] words")

    monkeypatch.setattr("cable_model.fmu_check.simulate_fmu", stopped)
    status, text = shown("check", tmp_path / "x.fmu", "--scene", "dale_sphere", "--write", "--reference", tmp_path / "r.csv")
    assert status == 2 and text.strip() == "error: x.fmu: fmi2DoStep failed with status 3 (error). [the FMU's] words"


def test_a_missing_fmu_is_named(tmp_path):
    with pytest.raises(ParameterError, match="no such file"):
        simulate_fmu(tmp_path / "none.fmu", *[None] * 2)


def test_a_pool_ends_its_workers_when_its_block_is_left_early():
    import multiprocessing
    import time

    begun = time.monotonic()
    with pytest.raises(KeyboardInterrupt), workers.pool(1) as processes:
        processes.submit(time.sleep, 60.0)
        time.sleep(0.5)
        raise KeyboardInterrupt
    for process in multiprocessing.active_children():
        process.join(10.0)
    assert not multiprocessing.active_children() and time.monotonic() - begun < 20.0
