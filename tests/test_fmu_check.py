"""Checking an FMU: against what it wrote it agrees, against a prescribed motion the cost of holding its inputs is told."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pytest
from fmu_support import Fmu
from typer.testing import CliRunner

from cable_model.cli import app
from cable_model.errors import ParameterError
from cable_model.fmu_check import divided, recorded_motion, rows_of_inputs, sampled_motion
from cable_model.models import MODELS
from cable_model.motion import motion_of
from cable_model.scene import Scene, load, to_toml, with_values
from cable_model.signals import INPUTS, OUTPUTS
from cable_model.simulation import simulate, write_csv
from fmu_src import trial
from fmu_src.build import build as build_fmu

CIRCLE = with_values(load("dale_sphere"), {"run.duration": 12.0})


@pytest.fixture(scope="module")
def checked(tmp_path_factory: pytest.TempPathFactory):
    """A TowCable FMU of a scene, and the command that checks it under that scene's motion."""
    folder = tmp_path_factory.mktemp("checked")
    (folder / "circle.toml").write_text(to_toml(CIRCLE), encoding="utf-8")
    fmu = build_fmu("tow", CIRCLE, folder / "Circle.fmu", precompile=False)

    def check(reference: Path, *options: str, scene: bool = True):
        motion = ["--scene", str(folder / "circle.toml")] if scene else []
        return CliRunner().invoke(app, ["check", str(fmu), "--reference", str(reference), *motion, *options])

    return check


def test_an_fmu_agrees_to_the_last_bit_with_what_it_just_wrote(checked, tmp_path):
    reference = tmp_path / "written.csv"
    compared = [name for name in (*INPUTS, *OUTPUTS) if not name.startswith("solver.")]
    assert checked(reference, "--write").exit_code == 0
    for scene in (True, False):
        again = checked(reference, "--rtol", "0", "--atol", "0", scene=scene)
        assert again.exit_code == 0, again.output
        assert f"all {len(compared)} signals agree" in again.output


def test_what_holding_the_inputs_costs_is_told_against_a_prescribed_motion(checked, tmp_path):
    run = simulate(MODELS["tow"](CIRCLE))
    write_csv(tmp_path / "run.csv", run.columns, run.table)
    for scene in (True, False):
        found = checked(tmp_path / "run.csv", scene=scene)
        assert found.exit_code == 1
        words = re.search(
            r"Holding the inputs over communication steps costs up to ([\d.e-]+) % of the range of \S+; with steps 8 times shorter the FMU "
            r"differs from the reference by ([\d.e-]+) % \(\S+\) instead of ([\d.e-]+) %: most of the difference is the holding's",
            " ".join(found.output.split()),
        )
        assert words is not None, found.output
        cost, left, before = map(float, words.groups())
        assert cost == pytest.approx(before, rel=0.3) and left < 0.3 * before


def test_a_reference_of_another_cable_is_not_explained_by_holding(checked, tmp_path):
    run = simulate(MODELS["tow"](with_values(CIRCLE, {"body.mass": 0.03})))
    write_csv(tmp_path / "other.csv", run.columns, run.table)
    found = checked(tmp_path / "other.csv")
    assert found.exit_code == 1 and "holding does not explain the difference." in " ".join(found.output.split())


def _pulse() -> Scene:
    return with_values(load(Path(__file__).parent / "data" / "F9_winch_pulse.toml"), {"run.duration": 12.25})


def test_a_host_communicates_at_the_rows_of_a_table_and_at_the_end():
    scene = _pulse()
    times, inputs = sampled_motion(motion_of(scene), scene.run.duration, scene.run.output_step)
    assert times.tolist() == [*(0.5 * k for k in range(21)), 10.3, 10.5, 10.7, 11.0, 11.5, 12.0, 12.25]
    assert inputs[times == 10.5, 9] == 4.0
    assert np.trapezoid(inputs[:, 9], times) == pytest.approx(0.8)


def test_recorded_rows_give_back_the_motion_between_them():
    motion = motion_of(CIRCLE)
    times, inputs = sampled_motion(motion, 3.0, 0.1)
    between = recorded_motion(*rows_of_inputs(Path("a"), ("time", *INPUTS), np.column_stack([times, inputs])))
    finer, rows = divided(times, inputs, between, 4)
    assert len(finer) == 4 * 30 + 1 and np.array_equal(rows[::4], inputs)
    assert rows == pytest.approx(np.array([motion(t) for t in finer]), abs=1e-6)


def test_a_table_with_a_part_of_the_lower_ends_inputs_is_refused():
    """What lacks would count as 0, which no motion has."""
    columns = ("time", *INPUTS[:13])
    with pytest.raises(ParameterError, match=r"^a: has no column lower\.vx\. Give --scene for the motion\.$"):
        rows_of_inputs(Path("a"), columns, np.column_stack([np.arange(3.0), np.zeros((3, 13))]))
    _, inputs = rows_of_inputs(Path("a"), columns[:11], np.column_stack([np.arange(3.0), np.ones((3, 10))]))
    assert np.array_equal(inputs, np.repeat([[1.0] * 10 + [0.0] * 12], 3, axis=0))


def test_the_first_command_of_the_readme_simulates_both_models(fmus: dict[str, Fmu], tmp_path):
    """Each with the values of the scene that its model has a use for; both hang the sphere at the end of 2.74 m."""
    found = trial.simulate({key: fmu.path for key, fmu in fmus.items()}, "dale_sphere", tmp_path)
    assert sorted(found) == ["CableChain", "TowCable"]
    for run in found.values():
        assert run["time"][-1] == 120.0
        assert run["top.z"][0] - run["body.z"][0] == pytest.approx(2.7432, rel=1e-3)
    assert found["CableChain"]["body.x"] == pytest.approx(found["TowCable"]["body.x"], abs=0.05)
    assert len(list(tmp_path.glob("*.csv"))) == 2
