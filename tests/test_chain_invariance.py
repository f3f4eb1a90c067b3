"""What must not change the chain's answer: how it is stepped, saved, mirrored, turned or carried along, and effects that are absent."""

import numpy as np
import pytest
from chain_support import HANGING, SECOND_MODE, WIRE, drive, every, make, swing, view

from cable_model import scene
from cable_model.cable_chain import CableChain
from cable_model.kernels import header
from cable_model.signals import OUTPUTS

SWAY = swing((0.02, 0.0, 0.01), SECOND_MODE, phase=(0.0, 0.0, 0.5))
STREAM = {**WIRE, "cable": {**WIRE["cable"], "added_mass_coefficient": 1.0, "tangential_drag_coefficient": 0.05}, "current": {"speed": 0.7}}
BASE = {**HANGING, "solver": {**HANGING["solver"], "nodes": 26}}


def test_the_same_run_twice_is_bit_identical():
    runs = [drive(make(BASE), every(0.02, 1.0), SWAY) for _ in range(2)]
    for name in OUTPUTS:
        assert np.array_equal(runs[0][name], runs[1][name])


@pytest.mark.parametrize("pieces", [2, 4])
def test_splitting_a_communication_step_on_internal_steps_changes_roundoff_and_path_only(pieces):
    # internal steps stay 0.01 s; only the quintic through the exact top motion is drawn anew, with its error (H^6)
    whole = drive(make(BASE), every(0.04, 2.0), SWAY)
    split = drive(make(BASE), every(0.04 / pieces, 2.0), SWAY)
    assert split["solver.steps"][-1] == whole["solver.steps"][-1]
    assert split["body.x"][::pieces] == pytest.approx(whole["body.x"], abs=1e-5)
    assert split["top.tension"][::pieces] == pytest.approx(whole["top.tension"], abs=1e-3 * 1.717)


def test_a_restored_state_runs_on_bit_identically():
    model, other = make(BASE), make(BASE)
    drive(model, every(0.02, 1.0), SWAY)
    saved = model.state.copy()

    def go_on(chain: CableChain) -> np.ndarray:
        for k in range(50, 80):
            chain.advance(0.02 * k, 0.02, SWAY(0.02 * k), SWAY(0.02 * (k + 1)))
        return np.concatenate([chain.state, chain.outputs, chain.positions().ravel()])

    first = go_on(model)
    model.state[:] = saved
    assert np.array_equal(go_on(model), first)
    other.initialize(SWAY(0.3))
    other.state[:] = saved
    assert np.array_equal(go_on(other), first)


def test_mirrored_motion_gives_the_mirrored_answer():
    run = drive(make(BASE), every(0.02, 2.0), SWAY)
    mirrored = drive(make(BASE), every(0.02, 2.0), swing((-0.02, 0.0, 0.01), SECOND_MODE, phase=(0.0, 0.0, 0.5)))
    for name in OUTPUTS:
        sign = -1.0 if name in ("top.force_x", "top.force_mean_x", "top.force_next_x", "body.x", "body.vx", "seabed.touchdown_x") else 1.0
        assert np.array_equal(mirrored[name] * sign, run[name]), name


def test_a_uniform_current_is_a_moving_frame():
    speed = 0.4  # m/s, of the frame
    motion = swing((0.5, 0.0, 0.5), 0.785, ramp_time=4.0)

    def carried(t: float) -> np.ndarray:
        return motion(t) + np.array([speed * t, 0.0, 0.0, speed, 0.0, 0.0, 0.0, 0.0, 0.0])

    fixed, moving = make(STREAM), make(STREAM, current__speed=0.7 + speed)
    fixed.initialize(motion(0.0))
    moving.initialize(carried(0.0))
    moving.state[:] = fixed.state
    moving.state[header.TOP + 3] += speed
    now = view(moving)
    n = now.y.shape[0] // 2
    for rates in (now.y[n:], now.yd[n - 1 : n]):  # velocities, and the drift of the top
        rates[:, 0] += speed
    for k in range(160):
        fixed.advance(0.05 * k, 0.05, motion(0.05 * k), motion(0.05 * (k + 1)))
        moving.advance(0.05 * k, 0.05, carried(0.05 * k), carried(0.05 * (k + 1)))
    assert moving.positions() - [speed * 8.0, 0.0, 0.0] == pytest.approx(fixed.positions(), abs=1e-8)
    assert moving.outputs[:4] == pytest.approx(fixed.outputs[:4], rel=1e-7)
    assert moving.outputs[8] - speed == pytest.approx(fixed.outputs[8], abs=1e-8)


@pytest.mark.parametrize(
    "absent",
    [
        {"cable__bending_stiffness": 0.0},
        {"cable__axial_damping": 0.0},
        {"body__mass": 0.0},
        {"water__density": 0.0},
        {"current__speed": 0.0},
        {"waves__amplitude": 0.0, "waves__period": 5.0},
        {"lower_end__release_force": 0.0},
        {"cable__diameter": 0.1, "cable__normal_drag_coefficient": 1.2, "cable__added_mass_coefficient": 1.0},
    ],
    ids=lambda values: " ".join(values),
)
def test_an_effect_that_is_switched_off_is_bit_identical_to_one_never_named(absent):
    plain, switched = make(BASE), make(BASE, **absent)
    runs = [drive(model, every(0.02, 0.5), SWAY) for model in (plain, switched)]
    assert np.array_equal(plain.state, switched.state)
    for name in OUTPUTS:
        assert np.array_equal(runs[0][name], runs[1][name])


def test_only_the_third_dimension_adds_unknowns():
    size = len(make(BASE).state)
    assert len(make(BASE, cable__bending_stiffness=1e-6).state) == size
    assert len(make(STREAM, solver__nodes=26).state) == size
    assert len(make(BASE, solver__space=True).state) > size


def test_a_plane_scene_is_the_same_in_space():
    plane = drive(make(BASE), every(0.02, 2.0), SWAY)
    space = drive(make(BASE, solver__space=True), every(0.02, 2.0), SWAY)
    for name in OUTPUTS[:-1]:
        assert space[name] == pytest.approx(plane[name], abs=1e-10), name
    assert np.all(space["body.y"] == 0.0)


def test_turning_the_motion_about_the_vertical_turns_the_answer():
    c, s = np.cos(0.7), np.sin(0.7)
    along = drive(make(BASE, solver__space=True), every(0.02, 2.0), swing((0.02, 0.0, 0.01), SECOND_MODE))
    turned = drive(make(BASE, solver__space=True), every(0.02, 2.0), swing((0.02 * c, 0.02 * s, 0.01), SECOND_MODE))
    # to Newton's tolerance of 4e-8 m/s by component, which is not the same in turned axes
    assert turned["body.x"] == pytest.approx(c * along["body.x"], abs=1e-7)
    assert turned["body.y"] == pytest.approx(s * along["body.x"], abs=1e-7)
    assert turned["top.force_y"] == pytest.approx(s * along["top.force_x"], abs=1e-6)
    assert turned["top.tension"] == pytest.approx(along["top.tension"], abs=1e-6)


def test_dotted_values_make_the_scene_that_a_dictionary_makes():
    direct = scene.from_dict({**BASE, "body": {"mass": 2.0}})
    assert scene.with_values(scene.from_dict(BASE), {"body.mass": 2.0}) == direct
