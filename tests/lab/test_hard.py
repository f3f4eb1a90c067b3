"""The hard cases, one test each (run with -m hard), and the suite's own rules, which must fail on doctored runs (always run)."""

import dataclasses

import numpy as np
import pytest

from cable_model.lab.hard import report, rules, runner
from cable_model.lab.hard.bad_input import bad_input
from cable_model.lab.hard.cases import CASES
from cable_model.lab.hard.record import Record, record
from cable_model.scene import load, with_values


@pytest.mark.hard
@pytest.mark.parametrize("case", CASES, ids=lambda case: case.key)
def test_hard_case_keeps_every_rule(case):
    verdicts = [runner.judge(case, variant) for variant in case.variants if variant.judged]
    broken = [f"{v.variant.label}: ({f.rule}) {f.words}: {f.value:.3g} > {f.limit:g}" for v in verdicts for f in v.findings if not f.holds]
    broken += [f"{f.words}: {f.value:.3g} against {f.limit:g}" for f in runner.further(case, verdicts) if not f.holds]
    assert not broken, "\n".join(broken)


def test_every_bad_input_gives_one_clear_error():
    broken = [finding.words for finding in bad_input() if not finding.holds]
    assert not broken, "\n".join(broken)


SMOOTH = with_values(load("hard/stiffness"), {"run.duration": 2.0, "solver.nodes": 21})


@pytest.fixture(scope="module")
def smooth() -> Record:
    return record(SMOOTH)


def test_a_smooth_run_keeps_every_rule(smooth):
    assert rules.finishes(smooth, 2.0).holds
    assert rules.keeps_energy(smooth).holds
    assert all(finding.holds for finding in rules.keeps_geometry(smooth, 2.0))


def test_the_ledger_of_a_smooth_run_closes():
    """Without damping what is stored is what was worked, up to the integrator's error."""
    exact = record(with_values(SMOOTH, {"solver.slack_damping": 0.0, "solver.time_step": 0.002, "solver.lambda_infinity": -0.9}))
    assert np.abs(exact.excess).max() < 1e-4 * exact.weight * exact.scene.cable.length


def test_the_ledger_of_a_wire_in_water_closes():
    wire = with_values(
        load("hard/snap"),
        {"cable.axial_damping": 0.0, "cable.axial_stiffness": 1e6, "cable.added_mass_coefficient": 1.0, "solver.slack_damping": 0.0,
         "solver.nodes": 26, "solver.lambda_infinity": -0.9, "run.duration": 12.0, "waves.amplitude": 1.0, "waves.period": 7.0,
         "current.speed": 0.5,
         "top.motion": [{"kind": "sinusoid", "axis": "z", "amplitude": 1.0, "angular_frequency": 0.8, "ramp_time": 4.0}]},
    )  # fmt: skip
    run = record(wire)
    assert np.abs(run.excess).max() < 1e-6 * run.weight * run.scene.cable.length


@pytest.mark.parametrize(
    ("doctored", "judged"),
    [
        (lambda r: {"error": "stopped"}, lambda r: rules.finishes(r, 2.0)),
        (lambda r: {"substeps": np.full_like(r.substeps, 2e4)}, lambda r: rules.finishes(r, 2.0)),
        (lambda r: {"excess": r.excess + 0.02 * r.weight * 1.75 * (r.times > 1.0)}, rules.keeps_energy),
        (lambda r: {"top_error": 1e-9}, lambda r: rules.keeps_geometry(r, 2.0)[0]),
        (lambda r: {"arc_error": 1e-5}, lambda r: rules.keeps_geometry(r, 2.0)[1]),
        (lambda r: {"drift": r.drift + 2e-3 * 1.75}, lambda r: rules.keeps_geometry(r, 2.0)[2]),
        (lambda r: {"pressed": 0.1 * r.weight}, lambda r: rules.keeps_geometry(r, 2.0)[-1]),
        (
            lambda r: {"outputs": r.outputs - 0.1 * r.weight, "scene": with_values(r.scene, {"cable.bending_stiffness": 0.0})},
            lambda r: rules.keeps_geometry(r, 2.0)[-1],
        ),
    ],
)
def test_each_rule_fails_on_a_doctored_run(smooth, doctored, judged):
    assert judged(smooth).holds
    assert not judged(dataclasses.replace(smooth, **doctored(smooth))).holds


def test_refinement_and_communication_rules_fail_on_other_paths(smooth):
    moved = dataclasses.replace(smooth, outputs=smooth.outputs + 0.02)
    first, second = rules.converges(smooth, smooth, moved, 2.0, 0.01)  # the finest moves away
    assert first.holds and not second.holds
    assert not rules.converges(smooth, moved, moved, 2.0, 0.01)[0].holds
    assert not rules.ignores_communication(smooth, moved, 2.0).holds


def test_the_report_names_what_failed(smooth, tmp_path):
    case = next(case for case in CASES if case.key == "H6")
    bad = dataclasses.replace(smooth, top_error=1.0)
    verdicts = [
        runner.Verdict(case, case.variants[0], smooth, (rules.finishes(smooth, 2.0),)),
        runner.Verdict(case, case.variants[1], bad, (*rules.keeps_geometry(bad, 2.0),)),
    ]
    report.write(tmp_path, verdicts, {"H6": ()})
    text = (tmp_path / "README.md").read_text(encoding="utf-8")
    assert "| passes |" in text and "fails: (c) top off its place over L" in text
    assert (tmp_path / "h6.png").stat().st_size > 10_000
    assert (tmp_path / "table.csv").read_text(encoding="utf-8").count("\n") == 3
