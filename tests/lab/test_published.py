"""The published figures and tables: the family's radii, the order of the methods, where a straight cable is enough, the files."""

import csv
import math

import numpy as np
import pytest
from typer.testing import CliRunner

from cable_model.errors import ParameterError
from cable_model.lab.cli import app
from cable_model.lab.published import catalogue, forced_chain, free_release, modes, page, penetration, spectral_radius, tolerance


def test_radii_of_lambda_minus_a_half_are_those_of_its_quadratic_and_the_derived_figures():
    found = spectral_radius.radius("generalized-alpha", -0.5, np.array(spectral_radius.CHECKED))
    assert found == pytest.approx([0.99005, 0.90474, 0.3129, 0.4230, 0.4999], abs=6e-5)
    assert found == pytest.approx([spectral_radius.by_quadratic(-0.5, z) for z in spectral_radius.CHECKED], rel=1e-9)


@pytest.mark.parametrize("lam", [-0.9, -0.7, -0.5, 0.25])
def test_at_large_frequency_the_radius_is_lambda(lam):
    assert spectral_radius.radius("generalized-alpha", lam, np.array([1e10]))[0] == pytest.approx(abs(lam), abs=1e-4)


def test_series_have_the_published_frequencies_and_amplitudes():
    bessel, beam = modes.bessel_series(4), modes.beam_series(5, 1e-6)
    assert bessel.frequencies == pytest.approx([1.20241, 2.76004, 4.32686, 5.89577], abs=6e-6)
    assert bessel.amplitudes == pytest.approx([2.56262e-3, 1.12527e-3, 7.11660e-4, 5.14665e-4], rel=2e-5)
    assert beam.frequencies == pytest.approx([1.20241, 2.76025, 4.32965, 5.91057, 7.51305], abs=2e-5)


def test_a_line_of_a_known_series_is_found_with_its_amplitude():
    times = np.arange(8001) / free_release.RATE
    series = modes.Series(np.array([1.3, 2.9]), np.array([2.0, 0.5]))
    frequencies, amplitudes = free_release.fitted(series.tip(times), np.array([1.31, 2.88]))
    assert frequencies == pytest.approx([1.3, 2.9], abs=1e-5)
    assert amplitudes == pytest.approx([2.0, 0.5], rel=1e-3)


def test_methods_lose_the_more_of_the_forced_chains_rise_the_more_they_damp():
    found = forced_chain.measure(quick=True)
    lost = [
        found.lost(("staggered grid", member, 0.01))
        for member in ("backward differences", "lambda 0", "lambda -0.5", "lambda -0.7", "lambda -0.9", "box method")
    ]
    assert lost == sorted(lost, reverse=True)
    assert lost[0] > 0.3 and 0.03 < lost[1] < 0.1 and 0.0 < lost[-1] < lost[2] < 0.03
    for member in forced_chain.MEMBERS:  # and all come nearer with the step, at their orders
        coarse, fine = (found.errors(("staggered grid", member, step))[0] for step in (0.02, 0.01))
        assert math.log2(coarse / fine) > (0.6 if member == "backward differences" else 1.5)


def test_the_straight_cables_error_grows_as_drag_keeps_motion_near_the_top():
    found = sorted(penetration.measure(quick=True), key=lambda case: -case.depth)
    errors = [case.motion_error for case in found]
    assert found[0].depth > 1.5 and found[-1].depth < 0.3
    assert errors == sorted(errors) and errors[0] < 0.05 < 1.0 < errors[-1]
    assert all(abs(case.tension_error) < 0.02 for case in found)


def test_slope_and_ratio_of_a_tolerance_line_leave_out_what_the_reference_cannot_tell():
    def point(asked: float, error: float, steps: int) -> tolerance.Point:
        return tolerance.Point(asked, {"position": error}, steps, 0, 0)

    points = (point(1e-1, 5e-3, 10), point(1e-2, 2e-2, 10), point(1e-3, 2e-3, 30), point(1e-4, 2e-4, 90), point(1e-5, 1e-4, 300))
    line = tolerance.Line("a case", -0.9, points, {"position": 5e-5})
    assert [p.tolerance for p in line.judged("position")] == [1e-2, 1e-3, 1e-4]
    assert line.slope("position") == pytest.approx(1.0)
    assert line.ratio("position") == pytest.approx(2.0)


def test_the_command_writes_pictures_tables_and_an_index_that_keeps_other_sections(tmp_path):
    runner = CliRunner()
    for names in (["--only", "straight"], ["--only", "radii", "--only", "tolerance"]):
        done = runner.invoke(app, ["published", *names, "--quick", "-o", str(tmp_path)])
        assert done.exit_code == 0, done.output
    text = (tmp_path / "README.md").read_text(encoding="utf-8")
    order = [text.index(f"({study.NAME}.png)") for name, study in catalogue.STUDIES.items() if name in ("radii", "straight", "tolerance")]
    assert order == sorted(order) and text.count("\n## ") == 3
    for name in ("radii", "straight", "tolerance"):
        stem = tmp_path / catalogue.STUDIES[name].NAME
        assert 10_000 < stem.with_suffix(".png").stat().st_size < 200_000
        with stem.with_suffix(".csv").open(encoding="utf-8", newline="") as file:
            rows = list(csv.reader(file))
        assert len(rows) > 3 and len({len(row) for row in rows}) == 1


def test_an_unknown_study_is_named_with_what_there_is(tmp_path):
    with pytest.raises(ParameterError, match="radii"):
        catalogue.write_all(tmp_path, ["radi"])


def test_a_markdown_table_has_a_rule_under_its_head():
    assert page.markdown([("a", "b"), ("x", 1.5)]).splitlines() == ["| a | b |", "|---|---:|", "| x | 1.5 |"]


def test_the_first_mode_does_not_hide_the_twentieth_in_the_spectrum():
    times = np.arange(8001) / free_release.RATE
    series = modes.beam_series(20, 1e-6)
    without = modes.Series(series.frequencies, np.append(series.amplitudes[:-1], 0.0))
    ratio = free_release.peaks(without.tip(times), series.frequencies)[-1] / free_release.peaks(series.tip(times), series.frequencies)[-1]
    assert ratio < 0.1
