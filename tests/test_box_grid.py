"""The paper's box grid: its equations, its elimination, its statics, and its motion against other codes and the other grid."""

import json
import os
import subprocess
import sys
from pathlib import Path

import box_plain
import numpy as np
import pytest
from chain_support import HANGING, SECOND_MODE, SHORT_BENDING, WEIGHT, drive, every, make, no_ramp, swing

PLAIN = bool(os.environ.get("NUMBA_DISABLE_JIT"))
SLOW = pytest.mark.skipif(PLAIN, reason="minutes in plain Python")
HINGED_BEAM = [1.20241, 2.76025, 4.32965, 5.91057]  # EI = 1e-6, hinged top: Hermite beam eigenvalues
BOX = HANGING | {
    "cable": HANGING["cable"] | {"bending_stiffness": SHORT_BENDING},
    "solver": {"nodes": 101, "time_step": 0.01, "lambda_infinity": -0.5, "grid": "box"},
}


@pytest.fixture(scope="session")
def plain() -> dict:
    """Results of box_plain, run without numba: a hundred variants are sooner run than compiled."""
    if PLAIN:
        return {check.__name__: check() for check in box_plain.CHECKS}
    script = Path(box_plain.__file__)
    run = subprocess.run(
        [sys.executable, str(script)], cwd=script.parent, env=os.environ | {"NUMBA_DISABLE_JIT": "1"}, capture_output=True, text=True
    )
    assert run.returncode == 0, run.stderr
    return json.loads(run.stdout)


def test_jacobian_is_exact_in_every_variant_without_waves(plain):
    misfits = {name: misfit for name, misfit in plain["jacobian_misfits"].items() if "waves" not in name}
    assert len(misfits) == 90
    assert max(misfits.values()) < 1e-9


def test_jacobian_under_waves_lacks_only_the_small_gradient_of_the_waters_acceleration(plain):
    misfits = {name: misfit for name, misfit in plain["jacobian_misfits"].items() if "waves" in name}
    assert len(misfits) == 30
    assert max(misfits.values()) < 2e-6


def test_jacobian_is_exact_through_the_waters_surface(plain):
    assert len(plain["surface_misfits"]) == 40
    assert max(plain["surface_misfits"].values()) < 1e-9


def test_cables_and_floats_at_the_surface_rest_by_archimedes(plain):
    height, force, refused = plain["afloat"]
    big = (0.75 / np.pi * 0.5) ** (1.0 / 3.0)
    weight = (300.0 + 0.5 * 0.9 * 30.0 - 0.5 * 1025.0 * np.pi / 4.0 * 0.02**2 * 30.0) * 9.80665
    lift = 1025.0 * 0.5 * 9.80665 * (0.5 - 0.75 * height / big + 0.25 * (height / big) ** 3)
    assert lift - weight == pytest.approx(4e3 / 30.0 * (height + 0.2), rel=1e-6)  # the tension of a line from z = -30.2 m
    assert force == pytest.approx(-(4.0 * 8.0 - 1025.0 * np.pi / 4.0 * 0.05**2 * 4.0) * 9.80665, rel=1e-3)  # and a stretch of 1e-3
    assert refused.startswith("CableChain at t = 0 s: no static equilibrium was found for a cable that does not go slack ")


def test_both_grids_heave_a_body_through_the_surface_alike(plain):
    coarse, fine = plain["surface_gaps"]
    assert fine < 1e-3
    assert coarse / fine > 3.0


@pytest.mark.parametrize("unknowns", ["4", "6"])
def test_elimination_solves_matrices_without_a_favoured_pivot(plain, unknowns):
    assert plain["solver_misfits"][unknowns] < 1e-12


def test_newton_converges_quadratically(plain):
    first, second, third, fourth = plain["newton_changes"][:4]
    assert second < 0.1 * first
    assert third < second**2
    assert fourth < max(third**2, 1e-12)


def test_cells_pass_on_power_exactly(plain):
    assert plain["power_misfit"] < 1e-12


def test_uniform_current_on_a_turning_cable_gives_the_forces_of_the_same_motion_in_still_water(plain):
    assert plain["frame_misfit"] < 1e-12


@pytest.mark.parametrize(("mode", "tolerance"), [(0, 1e-3), (1, 1e-3), (2, 1e-3), (3, 1.2e-3)])
def test_natural_frequencies_of_100_nodes_are_those_of_a_hinged_beam(plain, mode, tolerance):
    # the fourth is off by 1.09e-3: that is the box's dispersion, see the next test
    assert plain["frequencies"]["100"][mode] == pytest.approx(HINGED_BEAM[mode], rel=tolerance)


@pytest.mark.parametrize("mode", [2, 3])
def test_natural_frequencies_are_second_order_in_the_cell_length(plain, mode):
    coarse, fine = (plain["frequencies"][n][mode] - HINGED_BEAM[mode] for n in ("51", "101"))
    assert coarse / fine > 3.7


def test_added_mass_slows_every_mode_by_the_root_of_weight_over_virtual_mass(plain):
    assert plain["wet_frequencies"] == pytest.approx([np.sqrt(0.6 / 1.8)] * 4, rel=1e-3)


@pytest.mark.parametrize("name", list(box_plain.AT_REST))
def test_equilibrium_stays_at_rest_and_meets_top_and_anchor(plain, name):
    moved, gap, from_anchor = plain["rest"][name]
    assert moved < 1e-9
    assert gap < 1e-12
    assert from_anchor < 1e-9


def test_rates_at_the_start_do_not_alternate_from_node_to_node(plain):
    # the box sees only means over cells: a start over a vanishing step leaves +-0.086 1/s here
    assert np.all(np.diff([0.0, *plain["starting_turns"]]) > 0.0)


def test_release_force_is_balanced_by_tension_and_shear_at_the_tip(plain):
    assert plain["pulled_end"] < 1e-10


@SLOW
def test_tip_under_a_suddenly_swung_top_is_that_of_two_other_codes():
    series = drive(make(BOX), every(0.01, 2.0), swing((0.05, 0.0, 0.0), 3.0, ramp=no_ramp))
    assert series["body.x"][150] == pytest.approx(0.0469, abs=5e-4)
    assert series["body.x"][200] == pytest.approx(-0.205, abs=1e-3)


FINE = {"solver__nodes": 201, "solver__time_step": 0.005, "solver__lambda_infinity": -0.9, "cable__bending_stiffness": 0.0}


@SLOW
def test_forced_chain_follows_the_extrapolated_lumped_mass_reference():
    series = drive(make(BOX, **FINE), every(0.01, 8.0), swing((0.02, 0.0, 0.0), SECOND_MODE))
    assert series["body.x"][[200, 400, 800]] == pytest.approx([0.10606, 0.17905, 0.25092], abs=2e-4)
    assert series["top.tension"].min() / WEIGHT == pytest.approx(0.831, abs=2e-3)
    assert series["top.tension"].max() / WEIGHT == pytest.approx(1.303, abs=2e-3)


@SLOW
def test_both_grids_close_on_each_other_fourfold_when_nodes_and_steps_double():
    gaps = []
    for nodes, step in ((101, 0.01), (201, 0.005)):
        fine = FINE | {"solver__nodes": nodes, "solver__time_step": step}
        box, staggered = (
            drive(make(BOX, solver__grid=grid, **fine), every(0.01, 8.0), swing((0.02, 0.0, 0.0), SECOND_MODE))
            for grid in ("box", "staggered")
        )
        gaps.append(np.max(np.abs(box["body.x"] - staggered["body.x"])))
        assert np.std(box["top.tension"] - staggered["top.tension"]) < 0.01 * np.std(staggered["top.tension"])
    assert gaps[1] < 1e-3
    assert gaps[0] / gaps[1] == pytest.approx(4.0, abs=0.3)


@SLOW
def test_inextensible_cable_is_the_limit_of_a_stiff_one():
    # they differ by the time at which the cable's length is kept, the new or the averaged one: a gap of second order in the step
    motion = swing((0.02, 0.0, 0.0), SECOND_MODE)
    gaps = []
    for step in (0.01, 0.005):
        limit, stiff = (
            drive(make(BOX, solver__time_step=step, **cable), every(0.02, 2.0), motion)
            for cable in ({"cable__inextensible": True}, {"cable__axial_stiffness": 1e9 * WEIGHT})
        )
        gaps.append(np.max(np.abs(stiff["body.x"] - limit["body.x"])))
        assert stiff["top.tension"] == pytest.approx(limit["top.tension"], abs=2e-5 * WEIGHT)
    assert gaps[0] < 1e-5
    assert gaps[0] / gaps[1] == pytest.approx(4.0, abs=0.3)


@SLOW
def test_reported_velocity_of_the_tip_is_the_rate_of_its_reported_position():
    series = drive(make(BOX), every(0.01, 4.0), swing((0.02, 0.0, 0.0), SECOND_MODE))
    for axis in "xz":
        rate = (series[f"body.{axis}"][2:] - series[f"body.{axis}"][:-2]) / 0.02
        speed = series[f"body.v{axis}"]
        assert np.max(np.abs(rate - speed[1:-1])) < 0.02 * np.max(np.abs(speed))


@SLOW
@pytest.mark.parametrize("ramp_time", [0.0, 1.0])
def test_collapse_of_the_paper_runs_through_with_its_geometry_intact(ramp_time):
    # the linear law carries compression then, and no code's path can be trusted after 2.5 s: invariants only
    motion = swing((0.0875, 0.0, 0.0), SECOND_MODE, **({"ramp": no_ramp} if ramp_time == 0.0 else {}))
    model = make(BOX, solver__nodes=100)
    series = drive(model, every(0.01, 10.0), motion)
    cells = np.diff(model.positions(), axis=0)
    lengths = np.linalg.norm(cells, axis=1)
    assert len(series["time"]) == 1001
    assert model.positions()[-1] == pytest.approx(motion(10.0)[:3], abs=1e-12)
    assert lengths == pytest.approx(1.75 / 99, rel=0.02)
    if ramp_time > 0.0:
        assert series["body.x"][200] == pytest.approx(0.261, abs=0.006)  # other codes: .256-.266 at 2 s


@SLOW
def test_error_control_buys_accuracy_with_steps():
    motion = swing((0.02, 0.0, 0.0), SECOND_MODE)
    soft = {"cable__axial_stiffness": 100.0 * WEIGHT, "solver__time_step": 0.05}
    answers = [drive(make(BOX, solver__tolerance=tolerance, **soft), every(0.1, 2.0), motion) for tolerance in (1e-2, 1e-4, 1e-6)]
    errors = [np.max(np.abs(a["body.x"] - answers[-1]["body.x"])) for a in answers[:-1]]
    assert errors[1] < 0.1 * errors[0]
    assert answers[0]["solver.steps"][-1] < answers[1]["solver.steps"][-1]
