"""Internal steps: irregular communication steps do no harm, fixed steps are the ones asked for, error control follows its tolerance."""

import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from chain_support import HANGING, SECOND_MODE, drive, every, make, swing

from cable_model.kernels import header

SWAY = swing((0.02, 0.0, 0.0), SECOND_MODE)
RHYTHMS = {
    "alternating by a tenth": [1.0, 1.1],
    "alternating by three": [1.0, 3.0],
    "up to sevenfold": [1.0, 0.5, 1.6, 0.4, 1.5, 0.8, 1.2, 0.25, 1.75, 1.0],
    "slowly": list(1.0 + 0.5 * np.sin(2.0 * np.pi * np.arange(40) / 40)),
}


def irregular(rhythm: list[float], mean: float, duration: float) -> np.ndarray:
    steps = np.array(rhythm) * mean / np.mean(rhythm)
    return np.concatenate([[0.0], np.cumsum(np.tile(steps, int(np.ceil(duration / steps.sum()))))])


@pytest.mark.parametrize("lam", [-0.5, -0.9])
@pytest.mark.parametrize("rhythm", RHYTHMS.values(), ids=RHYTHMS)
def test_irregular_communication_steps_leave_tip_and_tension_alone(rhythm, lam):
    # a stretch that rings while the step changes pumps energy into a stiff cable: 800 N of tension within 2 s when it did
    times = irregular(rhythm, 0.01, 4.0)
    run = drive(make(HANGING, solver__time_step=1e3, solver__lambda_infinity=lam), times, SWAY)
    fine = drive(make(HANGING, solver__time_step=0.0025, solver__lambda_infinity=lam), times, SWAY)
    assert np.max(np.abs(run["body.x"] - fine["body.x"])) < 0.01 * 1.75
    assert np.max(run["top.tension"]) < 1.05 * np.max(fine["top.tension"])
    assert run["solver.rejected_steps"][-1] == 0


def test_a_fixed_step_is_the_fewest_equal_parts_of_every_communication_step():
    times = irregular(RHYTHMS["up to sevenfold"], 0.01, 0.5)
    run = drive(make(HANGING, solver__time_step=0.004), times, SWAY)
    assert run["solver.steps"][-1] == np.sum(np.ceil(np.diff(times) / 0.004 - 1e-9))


@pytest.mark.parametrize("lam", [-0.5, -0.9])
def test_the_observed_error_follows_the_tolerance_over_four_decades(lam):
    times = every(0.2, 8.0)
    reference = drive(make(HANGING, solver__time_step=0.0002, solver__lambda_infinity=lam), times, SWAY)["body.x"]
    tolerances = np.array([0.1, 0.01, 1e-3, 1e-4, 1e-5])
    errors, steps = [], []
    for tolerance in tolerances:
        run = drive(make(HANGING, solver__time_step=0.2, solver__tolerance=tolerance, solver__lambda_infinity=lam), times, SWAY)
        errors.append(np.sqrt(np.mean((run["body.x"] - reference) ** 2)) / np.std(reference))
        steps.append(run["solver.steps"][-1])
    # the tolerance bounds the acceleration that the truncation error amounts to, over that of the motion: it and the error both go with
    # the step squared; the tip of this chain keeps well within it; its top tension is nearer to it (docs/published)
    assert np.polyfit(np.log(tolerances), np.log(errors), 1)[0] == pytest.approx(1.0, abs=0.1)
    assert (errors < tolerances).all() and (errors > 0.02 * tolerances).all()
    # waves along the cable that the step does not resolve must not rule it: 54 thousand steps a second when they did
    assert steps[1] < 500 * times[-1]


@pytest.mark.parametrize("grid", ["staggered", "box"])
@pytest.mark.parametrize("tiny", [1e-6, 1e-9, 1e-11])
def test_a_tiny_communication_step_leaves_the_tension_alone(tiny, grid):
    """A host that iterates for an event asks for one; over 1e-11 s the difference of two velocities is rounding."""
    times = every(0.01, 0.4)
    plain = drive(make(HANGING, solver__grid=grid), every(0.01, 0.6), SWAY)["top.tension"][-20:]
    run = drive(make(HANGING, solver__grid=grid), np.concatenate([times, times[-1] + tiny + every(0.01, 0.2)]), SWAY)
    assert run["top.tension"][-20:] == pytest.approx(plain, rel=1e-3)


def test_what_is_left_of_a_communication_step_is_never_a_sliver():
    """A proposed step a billionth short of the rest left 1e-11 s, over which the top force was -2e12 N."""
    model = make(HANGING)
    times = every(0.01, 0.5)
    drive(model, times, SWAY)
    model.state[header.NEXT_STEP] = 0.01 * (1.0 - 2e-9)
    model.advance(times[-1], 0.01, SWAY(times[-1]), SWAY(times[-1] + 0.01))
    assert model.state[header.STEP] == pytest.approx(0.005)


VANISHING = """
import os, sys, threading, time
from chain_support import HANGING, SECOND_MODE, drive, every, make, swing
from cable_model.kernels import header
model = make(HANGING, solver__time_step=0.1, solver__tolerance=float(sys.argv[1]), solver__lambda_infinity=float(sys.argv[2]))
def watch():
    while not 0.0 < model.state[header.STEP] < 1e-9 * 0.1:
        time.sleep(0.01)
    os._exit(3)
threading.Thread(target=watch, daemon=True).start()
drive(model, every(0.1, 4.0), swing((0.02, 0.0, 0.0), SECOND_MODE))
"""


@pytest.mark.skipif(bool(os.environ.get("NUMBA_DISABLE_JIT")), reason="minutes in plain Python")
@pytest.mark.parametrize(("tolerance", "lam"), [(0.01, -0.9), (0.003, -0.9)])
def test_error_control_never_lets_the_step_vanish(tolerance, lam):
    # in a process of its own: a step that shrinks for ever is a kernel that never returns
    folder = str(Path(__file__).parent)
    command = [sys.executable, "-c", VANISHING, str(tolerance), str(lam)]
    run = subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False)
    assert (run.returncode, run.stderr) == (0, "")


@pytest.mark.parametrize("nodes", [26, 101, 401, 1001])
def test_smooth_motion_takes_little_more_than_one_iteration_a_step_on_every_mesh(nodes):
    scene = make(HANGING, solver__lambda_infinity=-0.9, solver__nodes=nodes)
    run = drive(scene, every(0.01, 6.0), swing((0.02, 0.0, 0.0), SECOND_MODE))
    assert run["solver.newton_iterations"][-1] <= 1.75 * run["solver.steps"][-1]
    assert run["solver.rejected_steps"][-1] == 0
