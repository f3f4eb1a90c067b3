"""A prescribed motion is followed as it is written, whatever the output step; the end of a run is in its record."""

from __future__ import annotations

import itertools
import math
from pathlib import Path

import numpy as np
import pytest

from cable_model.driving import OutputStep, output_steps, pieces
from cable_model.models import MODELS
from cable_model.motion import PrescribedMotion, motion_of
from cable_model.parameters import Motion, Top, Winch
from cable_model.scene import load, with_values
from cable_model.simulation import simulate
from cable_model.studies import timed

PULSE = with_values(load(Path(__file__).parent / "data" / "F9_winch_pulse.toml"), {"run.duration": 20.0})
CHAIN = with_values(load("hanging_chain"), {"solver.nodes": 11, "run.duration": 4.0})
SWING = Motion(kind="sinusoid", axis="x", amplitude=0.3, angular_frequency=2.0, phase=0.4, ramp_time=1.5, start=0.21, stop=5.37)
RAMP = Motion(kind="ramp", axis="z", velocity=-1.2, start=0.53, duration=2.02)
STEP = Motion(kind="step", axis="y", velocity=0.5, start=1.03, stop=2.11)
CUBIC = Motion(kind="sinusoid", axis="z", amplitude=0.1, angular_frequency=3.0, ramp_time=0.77, ramp="cubic")
TABLE = tuple((float(t), math.sin(t), 0.0, math.cos(t)) for t in np.linspace(0.3, 5.9, 25))


@pytest.mark.parametrize("output_step", [0.1, 0.25, 0.5, 1.0, 7.0, 30.0])
def test_a_winch_pays_out_the_area_of_its_table_whatever_the_output_step(output_step):
    """Triangle of 4 m/s over 0.4 s: 0.8 m; the wire itself gives 0.3 mm by its own swing and stretch."""
    run = simulate(MODELS["chain"](with_values(PULSE, {"run.output_step": output_step})))
    assert run["body.z"][0] - run["body.z"][-1] == pytest.approx(0.8, abs=5e-4)
    assert run["time"][-1] == 20.0


@pytest.mark.parametrize("model", MODELS)
def test_outputs_do_not_depend_on_how_often_they_are_written(model):
    """Fast against a second: its internal steps are the same, and what is left is the quintic's error."""
    seen = [simulate(MODELS[model](with_values(CHAIN, {"run.output_step": step}))) for step in (0.02, 1.0)]
    for name in ("top.tension", "top.force_x", "body.x", "body.z"):
        often, seldom = seen[0][name][::50], seen[1][name]
        assert seldom == pytest.approx(often, abs=1e-5 * np.ptp(seen[0][name]))


def test_output_steps_that_resolve_the_motion_are_one_piece_each():
    for name in ("dale_sphere", "hanging_chain", "towed_body", "basin_chain"):
        scene = load(name)
        motion = motion_of(scene)
        for output in output_steps(scene.run.duration, scene.run.output_step):
            (piece,) = pieces(motion, output, scene.solver.time_step)
            assert (piece.time, piece.length) == (output.start, scene.run.output_step)


@pytest.mark.parametrize("top", [Top(motion=(SWING,)), Top(motion=(RAMP, STEP)), Top(motion=(CUBIC,)), Top(table=TABLE)])
@pytest.mark.parametrize("output_step", [0.5, 7.0])
def test_the_top_moves_between_outputs_as_the_scene_says(top, output_step):
    """The quintic of every piece, written out by its six conditions, against the motion itself."""
    motion = PrescribedMotion(top)
    fastest = max(np.abs(motion(t)[6:9]).max() for t in np.linspace(0.0, 7.0, 701))
    for piece in (p for output in output_steps(7.0, output_step) for p in pieces(motion, output, 0.01)):
        h, times = piece.length, np.linspace(0.0, piece.length, 9)[1:-1]
        powers = np.arange(6)
        rows = [[math.perm(k, d) * t ** max(k - d, 0) if k >= d else 0.0 for k in powers] for t in (0.0, h) for d in range(3)]
        given = np.concatenate([piece.first[:9].reshape(3, 3), piece.last[:9].reshape(3, 3)])
        path = np.linalg.solve(np.array(rows), given)
        true = np.array([motion(piece.time + t) for t in times])
        assert times[:, None] ** powers @ path == pytest.approx(true[:, :3], abs=1e-6 * (1.0 + fastest) * h**2 + 1e-12)
        twice = np.array([[math.perm(k, 2) * t ** max(k - 2, 0) if k >= 2 else 0.0 for k in powers] for t in times])
        assert twice @ path == pytest.approx(true[:, 6:9], abs=1e-4 * fastest)


def test_pieces_meet_and_keep_the_internal_steps_of_the_whole():
    motion = PrescribedMotion(Top(motion=(Motion(kind="sinusoid", axis="x", amplitude=1.0, angular_frequency=20.0),)))
    parts = list(pieces(motion, OutputStep(3.0, 4.0, 1.0), 0.005))
    assert parts[0].time == 3.0 and parts[-1].time + parts[-1].length == pytest.approx(4.0, abs=1e-12)
    assert all(a.time + a.length == pytest.approx(b.time, abs=1e-12) for a, b in itertools.pairwise(parts))
    assert {round(part.length / 0.005, 6) for part in parts[:-1]} == {3.0}  # 0.372 of a radian at 20 rad/s: 0.0186 s
    (coarse,) = pieces(motion, OutputStep(3.0, 4.0, 1.0), 1.0)
    assert coarse.length == 1.0  # no internal step is cut


def test_an_event_that_rounding_puts_beside_an_output_time_is_at_it():
    """3 * 0.1 is behind 0.3: the step before it must end at rest, and no sliver is left."""
    motion = PrescribedMotion(Top(motion=(Motion(kind="step", axis="x", velocity=0.5, start=0.3),)))
    before, after = (list(pieces(motion, output, 0.1)) for output in output_steps(1.0, 0.1)[2:4])
    assert len(before) == len(after) == 1
    assert before[0].last[3] == 0.0 and after[0].first[3] == 0.5


def test_a_table_that_ends_leaves_the_top_at_rest():
    motion = PrescribedMotion(Top(table=TABLE))
    first, last = TABLE[0][0], TABLE[-1][0]
    assert motion(last, -1)[3] == pytest.approx(math.cos(last), abs=2e-3) and motion(last, 1)[3] == 0.0
    assert motion(first, 1)[3] == pytest.approx(math.cos(first), abs=2e-3) and motion(first, -1)[3] == 0.0


def test_a_cubic_fade_in_ends_with_the_acceleration_of_its_own_side():
    motion = PrescribedMotion(Top(motion=(CUBIC,)))
    before, at = motion(0.77 - 1e-9, -1)[8], motion(0.77, -1)[8]
    assert at == pytest.approx(before, abs=1e-6)
    assert abs(motion(0.77, 1)[8] - at) > 0.5


@pytest.mark.parametrize(
    ("duration", "step", "times"),
    [(1.0, 0.25, [0.25, 0.5, 0.75, 1.0]), (1.0, 0.4, [0.4, 0.8, 1.0]), (1.0, 3.0, [1.0]), (0.7, 0.1, [0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7])],
)
def test_the_end_of_a_run_is_its_last_output_exactly(duration, step, times):
    steps = output_steps(duration, step)
    assert [s.end for s in steps] == pytest.approx(times)
    assert steps[-1].end == duration
    assert [s.start for s in steps] == [k * step for k in range(len(steps))]  # n h, no running sum


@pytest.mark.parametrize("output_step", [0.15, 0.7, 5.0])
def test_the_record_of_a_run_reaches_its_end_whatever_the_output_step(output_step):
    run = simulate(MODELS["chain"](with_values(CHAIN, {"run.duration": 1.0, "run.output_step": output_step})))
    often = simulate(MODELS["chain"](with_values(CHAIN, {"run.duration": 1.0, "run.output_step": 0.05})))
    assert run["time"][-1] == 1.0
    assert run["body.x"][-1] == pytest.approx(often["body.x"][-1], abs=1e-6 * np.ptp(often["body.x"]))


def test_runs_with_a_last_short_step_are_compared_row_by_row():
    run = timed.timed(with_values(CHAIN, {"run.duration": 1.0, "run.output_step": 0.15}))
    assert run.times[-1] == 1.0
    assert timed.errors(run, run, timed.Scale.of(run)) == dict.fromkeys(timed.SIGNALS, 0.0)


def test_winch_speeds_between_rows_are_linear_and_rows_are_events():
    motion = PrescribedMotion(Top(), Winch(fitted=True, speeds=((0.0, 0.0), (10.3, 0.0), (10.5, 4.0), (10.7, 0.0))))
    parts = list(pieces(motion, OutputStep(10.0, 11.0, 1.0), 0.5))
    assert [part.time for part in parts] == [10.0, 10.3, 10.5, 10.7]
    assert sum(0.5 * (part.first[9] + part.last[9]) * part.length for part in parts) == pytest.approx(0.8)
