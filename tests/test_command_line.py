"""The command line as a user meets it: files, tables, pictures, exit status, and errors of one line."""

from __future__ import annotations

import os
import subprocess
import sys

import numpy as np
import pytest
from typer.testing import CliRunner

from cable_model.cli import app
from cable_model.comparison import compare, remarks
from cable_model.errors import ParameterError
from cable_model.scene import load, shipped
from cable_model.simulation import read_csv, write_csv

COLUMNS = ("time", "a", "b", "solver.steps")


def table(shift=0.0):
    t = np.linspace(0.0, 1.0, 11)
    return np.column_stack([t, np.sin(t), np.full(11, 5.0), np.arange(11) * (1.0 + shift)])


@pytest.fixture
def scene(tmp_path):
    path = tmp_path / "short.toml"
    path.write_text(
        'title = "short"\n[cable]\nlength = 1.75\nmass_per_length = 0.1\naxial_stiffness = 17167.5\n'
        '[[top.motion]]\nkind = "sinusoid"\naxis = "x"\namplitude = 0.02\nangular_frequency = 6.5\nramp_time = 1.0\n'
        "[solver]\nnodes = 26\n[run]\nduration = 0.5\noutput_step = 0.05\n"
    )
    return path


def test_equal_tables_agree_and_counters_are_left_out():
    found = compare(COLUMNS, table(), COLUMNS, table(shift=1.0), 0.0, 0.0)
    assert [d.signal for d in found] == ["a", "b"]
    assert all(d.passed for d in found)


def test_a_difference_is_named_with_its_time_and_size():
    other = table()
    other[7, 1] += 0.01
    worst = compare(COLUMNS, other, COLUMNS, table(), 1e-3, 0.0)[0]
    assert not worst.passed
    assert worst.time == pytest.approx(0.7)
    assert worst.largest == pytest.approx(0.01)


def test_a_value_that_is_not_a_number_never_agrees():
    other = table()
    other[3, 2] = np.nan
    assert not compare(COLUMNS, other, COLUMNS, table(), 1.0, 1.0)[1].passed


def test_a_result_that_ends_too_early_is_refused():
    with pytest.raises(ParameterError, match=r"^times 0 to 0\.5 s do not cover the reference's 0 to 1 s\. Simulate longer\.$"):
        compare(COLUMNS, table()[:6], COLUMNS, table(), 0.0, 0.0)


def test_a_table_of_one_row_is_compared_with_nothing():
    for a, b, name in ((table(), table()[:1], "reference"), (table()[:1], table(), "result")):
        with pytest.raises(ParameterError, match=rf"^the {name} has 1 row: must be at least 2\. Simulate longer\.$"):
            compare(COLUMNS, a, COLUMNS, b, 1.0, 1.0)


def test_times_that_do_not_rise_are_refused():
    back = table()
    back[4, 0] = back[3, 0]
    with pytest.raises(ParameterError, match=r"^the reference has times that do not rise, in row 5\. Write it again\.$"):
        compare(COLUMNS, table(), COLUMNS, back, 1.0, 1.0)


def test_a_result_that_goes_on_after_the_reference_differs_in_time():
    found = {d.signal: d for d in compare(COLUMNS, table(), COLUMNS, table()[:6], 1e-6, 1e-9)}
    assert found["a"].passed and not found["time"].passed
    assert found["time"].largest == pytest.approx(0.5) and found["time"].share_of_range == pytest.approx(1.0)


def test_other_times_and_lone_signals_are_told():
    assert remarks(COLUMNS, table(), COLUMNS, table()) == []
    words = "other times than the reference's (11 rows from 0 to 1 s against 6 rows from 0 to 1 s): compared at the reference's"
    assert remarks(COLUMNS, table(), COLUMNS, table()[::2]) == [words]
    turned = words.replace("11 rows", "x").replace("6 rows", "11 rows").replace("x", "6 rows")
    assert remarks(COLUMNS, table()[::2], COLUMNS, table()) == [turned + ", by straight lines between the result's"]
    lone = remarks(("time", "a", "c", "solver.steps"), table(), COLUMNS, table())
    assert lone == ["only the reference has b: not compared", "only the result has c: not compared"]


def test_differences_are_told_in_per_cent_of_the_range(tmp_path):
    other = table()
    other[7, 1] += 0.01 * np.ptp(table()[:, 1])
    write_csv(tmp_path / "a.csv", COLUMNS, other)
    write_csv(tmp_path / "b.csv", COLUMNS, table())
    shown = CliRunner().invoke(app, ["compare", str(tmp_path / "a.csv"), str(tmp_path / "b.csv")])
    assert shown.exit_code == 1
    assert "the most: a by 1 % of its range, at 0.7 s" in shown.output


def test_csv_files_come_back_as_written(tmp_path):
    write_csv(tmp_path / "a.csv", COLUMNS, table())
    columns, numbers = read_csv(tmp_path / "a.csv")
    assert columns == COLUMNS
    assert np.array_equal(numbers, table())  # to the last bit


def test_run_writes_csv_and_a_table_and_compare_accepts_it(scene, tmp_path):
    runner, target = CliRunner(), tmp_path / "out.csv"
    ran = runner.invoke(app, ["run", str(scene), "-o", str(target)])
    assert ran.exit_code == 0, ran.output
    assert "top tension, mean" in ran.output
    columns, numbers = read_csv(target)
    assert columns[0] == "time"
    assert len(numbers) == 11
    assert runner.invoke(app, ["compare", str(target), str(target)]).exit_code == 0
    numbers[5, columns.index("body.x")] += 1.0
    write_csv(tmp_path / "other.csv", columns, numbers)
    differs = runner.invoke(app, ["compare", str(tmp_path / "other.csv"), str(target)])
    assert differs.exit_code == 1
    assert "1 of " in differs.output
    assert "body.x" in differs.output


def test_plot_writes_a_picture(scene, tmp_path):
    done = CliRunner().invoke(app, ["plot", str(scene), "--model", "chain", "-o", str(tmp_path / "picture.png")])
    assert done.exit_code == 0, done.output
    assert (tmp_path / "picture.png").read_bytes()[:4] == b"\x89PNG"


def test_describe_lists_active_effects_and_unknowns(scene):
    done = CliRunner().invoke(app, ["describe", str(scene), "--model", "chain"])
    assert done.exit_code == 0, done.output
    assert "26 nodes, 2 unknowns a node: 52 unknowns" in done.output
    assert "water.density" not in done.output


@pytest.mark.parametrize(("name", "file"), [("umbilical", "umbilical"), ("examples/tow_line", "tow_line"), ("hard/snap", "snap")])
def test_new_writes_a_copy_with_its_comments_that_is_the_same_scene(name, file, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    done = CliRunner().invoke(app, ["new", name])
    assert (done.exit_code, done.output) == (0, f"wrote {file}.toml\n")
    source = next(path for path in shipped().values() if path.stem == file)
    assert (tmp_path / f"{file}.toml").read_bytes() == source.read_bytes()
    elsewhere = tmp_path / "mine" / "my.toml"
    assert CliRunner().invoke(app, ["new", name, "-o", str(elsewhere)]).exit_code == 0
    assert load(elsewhere) == load(source)


def test_new_lists_every_scene_and_the_titles_of_those_to_begin_with():
    command = [sys.executable, "-m", "cable_model", "new"]
    done = subprocess.run(command, capture_output=True, text=True, check=True, env={**os.environ, "COLUMNS": "200"})
    assert all(name in done.stdout for name in shipped())
    assert all(load(name).title in done.stdout for name in shipped() if not name.startswith("hard/"))


def test_describe_knows_an_example_by_its_name():
    done = CliRunner().invoke(app, ["describe", "examples/tow_line", "--model", "chain"])
    assert done.exit_code == 0, done.output
    assert load("examples/tow_line").title in done.output


def test_a_bad_scene_ends_with_one_line_and_status_2(tmp_path):
    (tmp_path / "bad.toml").write_text("[cable]\nlength = -1.0\nmass_per_length = 1.0\naxial_stiffness = 1.0\n")
    command = [sys.executable, "-m", "cable_model", "run", str(tmp_path / "bad.toml")]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert done.returncode == 2
    assert done.stdout.strip() == "error: cable.length = -1 m: must be > 0. Give the unstretched length."
    assert "Traceback" not in done.stderr
