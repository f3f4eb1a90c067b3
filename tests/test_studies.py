"""Studies: references know their own error, the cheapest front is one, advice holds against an independent finer run, sweeps resume."""

import csv
import dataclasses
import json
import math
import os
import sys

import numpy as np
import pytest
from typer.testing import CliRunner

from cable_model.cli import app
from cable_model.cli_studies import fraction
from cable_model.errors import ParameterError
from cable_model.scene import load, shipped, to_toml, with_values
from cable_model.studies import advice, reference, settings, sweep, timed, validity, work_precision

SWAY = with_values(load("hanging_chain"), {"run.duration": 4.0, "solver.nodes": 31})
SHORT = with_values(SWAY, {"run.duration": 0.2})


@pytest.fixture(scope="module")
def converged():
    return reference.converge(SWAY, 0.01)


@pytest.mark.parametrize("name", shipped())
def test_a_scene_written_as_toml_reads_back_equal(name, tmp_path):
    scene = load(name)
    path = tmp_path / "scene.toml"
    path.write_text(to_toml(scene), encoding="utf-8")
    assert load(path) == scene


def test_the_reference_is_as_good_as_it_says(converged):
    last = converged.levels[-1].setting
    nodes, step = 4 * (last.changes["solver.nodes"] - 1) + 1, last.changes["solver.time_step"] / 4.0
    finer = timed.timed(SWAY, reference.chain_setting(SWAY, nodes - 1, step))
    true = timed.errors(converged.run, finer, timed.Scale.of(finer))
    assert converged.converged
    for signal in timed.SIGNALS:
        assert true[signal] == pytest.approx(converged.own_error[signal], rel=0.5)


@pytest.mark.parametrize(
    ("before", "last", "share"), [(4.0, 1.0, 1.0 / 3.0), (2.0, 1.0, 1.0), (16.0, 1.0, 1.0 / 3.0), (1.0, 0.9, math.inf)]
)
def test_what_is_left_after_the_last_change_follows_from_how_the_changes_fall(before, last, share):
    assert reference.remaining(before, last) == pytest.approx(share)


def test_a_run_that_takes_too_long_is_given_up():
    run = timed.timed(SWAY, longest=0.0)
    assert "given up" in run.error and len(run.times) == 2


def test_vertical_motion_of_the_top_is_no_lateral_forcing():
    heave = with_values(SWAY, {"top.motion": [{"kind": "sinusoid", "axis": "z", "amplitude": 0.01, "angular_frequency": 5.0}]})
    assert validity.forcing(heave, "xy") == [] and validity.forcing(heave) == [5.0]
    assert validity.penetration(heave, 1.0) == math.inf


def test_a_chaotic_scene_has_no_reference():
    violent = with_values(load("hard/collapse"), {"run.duration": 6.0, "solver.nodes": 26, "solver.time_step": 0.01})
    assert not reference.converge(violent, 0.01).converged


def test_errors_are_zero_of_a_run_against_itself_and_infinite_of_one_that_stopped(converged):
    assert converged.errors(converged.run) == dict.fromkeys(timed.SIGNALS, 0.0)
    cut = timed.Timed(converged.run.times[:5], converged.run.tension[:5], converged.run.position[:5], 0.0, "stopped")
    assert converged.errors(cut) == dict.fromkeys(timed.SIGNALS, math.inf)
    higher = timed.Timed(converged.run.times, converged.run.tension + converged.scale.tension, converged.run.position, 0.0)
    assert converged.errors(higher)["tension"] == pytest.approx(1.0)


def test_the_front_is_what_nothing_beats():
    def point(cost, error):
        return work_precision.Point(timed.Setting("m", "chain", {}), cost, {"tension": error}, "")

    points = [point(1.0, 0.1), point(2.0, 0.2), point(3.0, 0.01), point(0.5, math.inf), point(4.0, 0.01)]
    assert [(p.cost, p.errors["tension"]) for p in work_precision.front(points, "tension")] == [(1.0, 0.1), (3.0, 0.01)]


def test_study_writes_every_run_and_a_picture(tmp_path):
    path = tmp_path / "sway.toml"
    path.write_text(to_toml(SWAY), encoding="utf-8")
    result = CliRunner().invoke(app, ["study", str(path), "--quick", "-o", str(tmp_path)])
    assert result.exit_code == 0, result.output
    lines = (tmp_path / "sway.csv").read_text(encoding="utf-8").splitlines()
    assert lines[0].startswith("#") and "numba" in lines[0] and "its own error" in lines[1]
    rows = list(csv.DictReader(lines[2:]))
    assert {row["method"] for row in rows} >= {"TowCable", "chain, lambda -0.9", "box grid, box method", "chain, error control"}
    best = min(float(row["error_position"]) for row in rows if row["method"] == "chain, lambda -0.9")
    assert best < 0.02 < min(float(row["error_position"]) for row in rows if row["method"] == "TowCable")
    assert (tmp_path / "sway.png").stat().st_size > 20_000


@pytest.mark.parametrize("wanted", [0.03, pytest.param(0.003, marks=pytest.mark.long)])
def test_the_advised_setting_meets_the_accuracy_against_a_finer_run(wanted):
    found = advice.advise(SWAY, wanted)
    assert found.choice is not None and found.choice.setting.model == "chain"
    finer = timed.timed(SWAY, reference.chain_setting(SWAY, 400, 0.0005))
    own = timed.timed(found.scene)
    true = timed.errors(own, finer, timed.Scale.of(finer))
    assert max(true.values()) <= wanted
    assert max(true.values()) > 0.02 * wanted  # and is no overkill


@pytest.mark.long  # compiles four sets of effects
def test_advice_leaves_out_an_effect_that_does_nothing_and_keeps_one_that_does():
    scene = with_values(SWAY, {"cable.bending_stiffness": 0.02, "cable.axial_damping": 10.0})
    found = advice.advise(scene, 0.03)
    assert "material damping" in found.left_out and found.scene.cable.axial_damping == 0.0
    assert "bending" in found.kept and found.scene.cable.bending_stiffness == 0.02


def test_advise_writes_the_scene_and_says_how_sure_it_is(tmp_path):
    path = tmp_path / "sway.toml"
    path.write_text(to_toml(SWAY), encoding="utf-8")
    result = CliRunner().invoke(app, ["advise", str(path), "--accuracy", "3%", "-o", str(tmp_path / "chosen.toml")])
    assert result.exit_code == 0, result.output
    assert "itself sure to" in " ".join(result.output.split())
    assert load(tmp_path / "chosen.toml").solver.nodes <= SWAY.solver.nodes


def test_the_forcing_of_a_table_is_seen_by_its_mean_frequency():
    rows = [[t, 0.1 * math.sin(2.0 * t), 0.0, 0.05 * math.sin(5.0 * t)] for t in np.linspace(0.0, 4.0 * math.pi, 200)]
    tabled = with_values(SWAY, {"top.motion": [], "top.table": rows, "run.duration": 4.0 * math.pi})
    assert validity.forcing(tabled, "x") == pytest.approx([2.0], rel=0.02)
    assert validity.forcing(tabled) == pytest.approx([2.0, 5.0], rel=0.02)


def test_water_that_moves_along_slows_the_bending_of_a_straight_cable():
    heavy = with_values(SWAY, {"cable.diameter": 0.01, "cable.added_mass_coefficient": 1.5, "water.density": 1000.0})
    bare = validity.lateral_frequency(SWAY, 5.0)
    ratio = 1.0 + 1.5 * 1000.0 * 0.25 * math.pi * 0.01**2 / SWAY.cable.mass_per_length
    assert validity.lateral_frequency(heavy, 5.0) == pytest.approx(bare / math.sqrt(ratio))


def test_a_spring_with_a_third_of_the_mass_errs_by_a_quarter_of_the_axial_phase_squared():
    long = with_values(SWAY, {"cable.length": 17.5, "cable.mass_per_length": 0.1, "cable.axial_stiffness": 1e3})
    phase = validity.axial_phase(long)
    assert phase == pytest.approx(6.5348 * 17.5 * 0.01, rel=1e-3)
    x = 0.1
    for mu in (0.0, 1.0, 10.0):
        exact = x * (math.tan(x) + mu * x) / (1.0 - mu * x * math.tan(x))
        lumped = x**2 * ((mu + 1.0 / 3.0) / (1.0 - x**2 * (mu + 1.0 / 3.0)) + 2.0 / 3.0)
        assert 0.2 < (exact - lumped) / (exact * x**2) < 0.45
    assert not next(check for check in validity.straight_enough(long) if "wave along" in check.words).holds


def test_nothing_is_accurate_against_a_reference_that_stopped():
    run = timed.timed(SHORT)
    stopped = dataclasses.replace(run, times=run.times[:2], tension=run.tension[:2], position=run.position[:2], error="it stopped")
    assert timed.errors(run, stopped, timed.Scale.of(run)) == {"tension": math.inf, "position": math.inf}


def test_one_change_is_not_a_convergence():
    assert reference.remaining(math.inf, 1e-6) == math.inf
    assert reference.remaining(4e-6, 1e-6) == pytest.approx(1.0 / 3.0)


def test_a_top_that_is_refused_on_the_way_ends_its_run_only():
    fast = [{"kind": "ramp", "axis": "x", "velocity": 1e7, "duration": 2.0}]
    run = timed.timed(with_values(SWAY, {"top.motion": fast}))
    assert run.error and run.times[-1] < SWAY.run.duration


def test_advice_without_a_reference_says_why(monkeypatch):
    def stopped(scene, setting=None, repetitions=1, longest=math.inf):
        return timed.Timed(np.zeros(1), np.zeros(1), np.zeros((1, 3)), 0.0, "Newton's method failed")

    monkeypatch.setattr(reference, "timed", stopped)
    result = CliRunner().invoke(app, ["advise", "hanging_chain"])
    assert result.exit_code != 0 and "Newton's method failed" in str(result.exception)


def test_scales_rule_the_straight_cable_out():
    deep = with_values(load("towed_body"), {"cable.length": 4000.0})
    assert validity.penetration(deep, 6000.0) < 0.05
    assert not next(check for check in validity.straight_enough(deep) if "penetrates" in check.words).holds
    anchored = load("basin_chain")
    assert not validity.straight_enough(anchored)[0].holds
    assert settings.TOW not in settings.methods(anchored)


@pytest.mark.parametrize(("text", "value"), [("1%", 0.01), ("0.003", 0.003), ("0.3 %", 0.003)])
def test_accuracies_read_as_written(text, value):
    assert fraction(text) == pytest.approx(value)


@pytest.mark.parametrize("text", ["0", "100%", "nan", "much", "-1%"])
def test_other_accuracies_are_refused(text):
    with pytest.raises(ParameterError, match="between 0 and 100 %"):
        fraction(text)


SWEEP = {"solver.nodes": [6, 11], "cable.length": [1.5, 1.75]}


def test_a_sweep_resumes_where_it_stopped(tmp_path):
    wanted = sweep.jobs(SHORT, SWEEP)
    assert len(wanted) == 4
    first = sweep.run(wanted[:2], tmp_path, 1)
    stamp = {path: path.stat().st_mtime_ns for path in tmp_path.glob("*.json")}
    told = []
    every = sweep.run(wanted, tmp_path, 2, told.append)
    assert every[:2] == first and told[0] == 2 and told[-1] == 4
    assert all(path.stat().st_mtime_ns == time for path, time in stamp.items())
    assert [summary["cable.length"] for summary in every] == [1.5, 1.75, 1.5, 1.75]
    sweep.write_table(tmp_path / "table.csv", every)
    assert len((tmp_path / "table.csv").read_text(encoding="utf-8").splitlines()) == 5


def test_the_command_writes_a_table_of_all_runs(tmp_path):
    path = tmp_path / "sweep.toml"
    (tmp_path / "short.toml").write_text(to_toml(SHORT), encoding="utf-8")
    path.write_text('scene = "short.toml"\n[vary]\n"solver.nodes" = [6, 7]\n', encoding="utf-8")
    result = CliRunner().invoke(app, ["sweep", str(path), "-o", str(tmp_path / "found"), "--workers", "1"])
    assert result.exit_code == 0, result.output
    with (tmp_path / "found" / "table.csv").open(encoding="utf-8") as file:
        assert [row["solver.nodes"] for row in csv.DictReader(file)] == ["6", "7"]


def _die_once(job, folder):
    """As perform, but its worker is gone the first time."""
    from pathlib import Path

    mark = Path(folder) / "died"
    if job.values["solver.nodes"] == 11 and not mark.exists():
        mark.touch()
        os._exit(1)
    return sweep.__dict__["_perform"](job, folder)


def test_a_worker_that_dies_loses_nothing(tmp_path, monkeypatch):
    monkeypatch.setattr(sweep, "_perform", sweep.perform, raising=False)
    monkeypatch.setattr(sweep, "perform", _die_once)
    summaries = sweep.run(sweep.jobs(SHORT, SWEEP), tmp_path, 2)
    assert len(summaries) == 4 and not any(summary["error"] for summary in summaries)
    assert (tmp_path / "died").exists()


def test_a_run_that_stops_keeps_its_rows_and_says_why(tmp_path):
    fast = {"top.motion": [{"kind": "step", "axis": "x", "velocity": 1.0, "start": 0.1}], "solver.time_step": 1e-3}
    scene = with_values(SHORT, {**fast, "solver.space": False})
    (job,) = sweep.jobs(scene, {"solver.slack_damping": [0.1]})
    kept = sweep.perform(job, str(tmp_path))
    assert json.loads((tmp_path / f"{job.key}.json").read_text(encoding="utf-8")) == kept
    table = np.loadtxt(tmp_path / f"{job.key}.csv", delimiter=",", skiprows=1)
    assert len(table) == 11


def test_a_sweep_with_a_bad_value_is_refused_before_anything_runs(tmp_path):
    path = tmp_path / "sweep.toml"
    path.write_text('scene = "hanging_chain"\n[vary]\n"cable.length" = [1.0, -2.0]\n', encoding="utf-8")
    with pytest.raises(ParameterError, match=r"cable\.length = -2 m"):
        sweep.jobs(*sweep.read(path))
    path.write_text('scene = "hanging_chain"\n', encoding="utf-8")
    with pytest.raises(ParameterError, match="vary"):
        sweep.read(path)


def _die_at_eleven(job, folder):
    if job.values["solver.nodes"] == 11:
        os._exit(1)
    return sweep.__dict__["_perform"](job, folder)


def test_runs_whose_workers_always_die_cost_nothing_but_themselves(tmp_path, monkeypatch):
    monkeypatch.setattr(sweep, "_perform", sweep.perform, raising=False)
    monkeypatch.setattr(sweep, "perform", _die_at_eleven)
    wanted = sweep.jobs(SHORT, {"solver.nodes": [11, 6, 7, 8]})
    died, *rest = sweep.run(wanted, tmp_path, 2)
    assert "worker died" in died["error"] and died["solver.nodes"] == 11
    assert [summary["error"] for summary in rest] == ["", "", ""]
    monkeypatch.setattr(sweep, "perform", sweep.__dict__["_perform"])
    assert [summary["error"] for summary in sweep.run(wanted, tmp_path, 2)] == [""] * 4  # the next call tries it again
    assert not list(tmp_path.glob("*.begun"))


def test_a_run_that_is_refused_costs_nothing_but_itself(tmp_path):
    curve = {"cable.stiffness_curve": [[0.0, 0.0], [0.1, 100.0]]}  # which TowCable lacks
    (job,) = sweep.jobs(with_values(SHORT, curve), {"run.model": ["tow"]})
    (summary,) = sweep.run([job], tmp_path, 1)
    assert "stiffness_curve" in summary["error"]


def test_values_are_needed_and_another_code_has_other_results(monkeypatch):
    with pytest.raises(ParameterError, match=r"solver\.nodes has no values"):
        sweep.jobs(SHORT, {"solver.nodes": []})
    (job,) = sweep.jobs(SHORT, {"solver.nodes": [6]})
    monkeypatch.setattr(sweep, "source_hash", lambda: "other kernels")
    (other,) = sweep.jobs(SHORT, {"solver.nodes": [6]})
    assert job.key != other.key


def test_a_cluster_gives_the_same_and_a_run_that_kills_its_workers_costs_only_itself(tmp_path, monkeypatch):
    distributed = pytest.importorskip("distributed")
    cloudpickle = pytest.importorskip("cloudpickle")
    wanted = sweep.jobs(SHORT, SWEEP)
    with distributed.LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address=None) as cluster:
        address = cluster.scheduler_address
        assert sweep.run(wanted, tmp_path / "cluster", 1, None, address) == sweep.run(wanted, tmp_path / "cores", 1)
        cloudpickle.register_pickle_by_value(sys.modules[__name__])
        monkeypatch.setattr(sweep, "perform", _always_die)
        (died,) = sweep.run(wanted[:1], tmp_path / "dead", 1, None, address)
        cloudpickle.unregister_pickle_by_value(sys.modules[__name__])
    assert "worker died" in died["error"]


def _always_die(job, folder):
    os._exit(1)
