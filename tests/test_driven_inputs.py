"""The inputs of a driven lower end: communication steps, states, scenes, and what has no use for them."""

import numpy as np
import pytest
from chain_support import HANGING, make, still
from driven_support import FAR, LINE, LOW, OTHER_WAY_ROUND, SWAYING, about, inputs

from cable_model import CableChain, TowCable
from cable_model.errors import ParameterError, SolverError
from cable_model.scene import from_dict, with_values
from cable_model.signals import INPUTS, OUTPUTS
from cable_model.simulation import simulate

PLACE = [OUTPUTS.index(f"body.{axis}") for axis in "xyz"]


@pytest.mark.parametrize("order", [0, 1, 2])
@pytest.mark.parametrize("at_end", [0, 1])
def test_inputs_of_communication_steps_are_followed_at_either_end_alike(order, at_end):
    moved, fixed = about((0.0, 0.0, -2.0), (0.8, 0.0, 0.6), 0.6), still(FAR)
    steps = [0.1, 0.05, 0.1, 0.1, 1e-7, 0.1] * 20
    found = []
    for motion in (inputs(moved, fixed), inputs(fixed, moved)):
        model = make(LINE, solver__time_step=0.025, top__motion_order=order, top__inputs_at=at_end)
        model.initialize(motion(0.0))
        time, rows = 0.0, []
        for step in steps:
            model.step(time, step, motion(time + at_end * step))
            time += step
            rows.append(model.outputs.copy())
        found.append(np.array(rows))
    one, other = found
    for here, there in OTHER_WAY_ROUND:
        assert np.abs(one[:, here] - other[:, there]).max() < 5e-4 * np.abs(one[:, here]).max()


def test_inputs_of_the_end_of_a_step_are_reached():
    motion = inputs(still(), about(FAR, (1.0, 0.0, 1.0), 1.0))
    model = make(LINE, top__inputs_at=1)
    model.initialize(motion(0.0))
    for k in range(100):
        model.step(0.1 * k, 0.1, motion(0.1 * (k + 1)))
        assert np.abs(model.outputs[PLACE] - motion(0.1 * (k + 1))[10:13]).max() < 1e-4


def test_slivers_change_nothing_and_a_restored_state_goes_on_bit_for_bit():
    regular, broken = (make(LINE, top__inputs_at=1, top__motion_order=2) for _ in range(2))
    regular.initialize(SWAYING(0.0))
    broken.initialize(SWAYING(0.0))
    steady = []
    for k in range(101):
        regular.step(0.05 * k, 0.05, SWAYING(0.05 * k + 0.05))
        steady.append(regular.outputs[LOW])
    times = np.cumsum([0.0, *[0.05] * 60, 1e-4, 1e-9, 0.05 - 1e-4 - 1e-9, *[0.05] * 40])

    def going_on(first, last):
        rows = []
        for k in range(first, last):
            broken.step(times[k], times[k + 1] - times[k], SWAYING(times[k + 1]))
            rows.append(broken.outputs.copy())
        return np.array(rows)

    going_on(0, 62)  # into a sliver
    saved = broken.state.copy()
    once = going_on(62, len(times) - 1)
    broken.state[:] = saved
    assert np.array_equal(going_on(62, len(times) - 1), once)
    assert np.abs(broken.outputs[LOW] - steady[-1]).max() < 0.01 * np.ptp(np.array(steady), axis=0).max()


def test_a_scene_moves_both_ends():
    sway = {"kind": "sinusoid", "axis": "x", "amplitude": 1.0, "angular_frequency": 1.0, "ramp_time": 5.0}
    scene = from_dict({**LINE, "lower": {"position": [*FAR], "motion": [sway]}, "run": {"duration": 10.0, "output_step": 0.1}})
    result = simulate(CableChain(scene))
    assert result["lower.x"] == pytest.approx(result["body.x"], abs=1e-4)
    assert np.ptp(result["lower.x"]) > 1.5
    assert np.ptp(result["lower.force_x"]) > 100.0
    assert np.linalg.norm([result[f"lower.force_{axis}"][-1] for axis in "xz"]) == pytest.approx(result["body.tension"][-1], rel=0.05)


def test_a_driven_end_that_is_told_nothing_stays_where_the_scene_has_it():
    model = CableChain(from_dict({**LINE, "lower": {"position": [*FAR]}}))
    model.initialize(np.zeros(9))
    model.step(0.0, 0.1, np.zeros(10))
    assert model.positions()[0] == pytest.approx([*FAR], abs=1e-6)


def test_what_does_not_have_it_refuses_it():
    scene = from_dict({**LINE, "lower": {"position": [*FAR]}})
    with pytest.raises(ParameterError, match=r"lower_end\.(anchored|driven) = True: must be false for TowCable"):
        TowCable(scene)
    with pytest.raises(ParameterError, match=r'lower_end\.driven = True: must be false on the box grid\. Set solver\.grid = "staggered"\.'):
        with_values(scene, {"solver.grid": "box"})
    for changes, text in (
        ({"lower_end.anchored": False}, "must be false for an end that nothing holds"),
        ({"lower_end.released": True}, "must be false for an end that is let go"),
        ({"lower_end.x": 5.0}, "must be false beside lower_end.x, y or z"),
        ({"lower_end.driven": False}, "must be true for a lower end that \\[lower\\] moves"),
    ):
        with pytest.raises(ParameterError, match=rf"lower_end\.driven = .*: {text}"):
            with_values(scene, changes)


@pytest.mark.parametrize("kind", [CableChain, TowCable])
@pytest.mark.parametrize("at_start", [True, False])
def test_inputs_of_a_lower_end_that_nothing_drives_are_refused(kind, at_start):
    hung = {part: values for part, values in LINE.items() if part != "lower_end"}
    model = kind(from_dict({**hung, "body": {"mass": 300.0}, "current": {}}))
    for name in INPUTS[10:19]:
        given = np.zeros(19)
        model.initialize(given)
        given[INPUTS.index(name)] = 1e-3
        with pytest.raises(SolverError, match="the inputs lower"):
            if at_start:
                model.initialize(given)
            else:
                model.step(0.0, 0.1, given)


def test_a_lower_end_that_leaves_the_plane_is_refused():
    model = CableChain(from_dict(LINE))
    start = inputs(still(), still(FAR))(0.0)
    model.initialize(start)
    start[INPUTS.index("lower.y")] = 0.5
    with pytest.raises(SolverError, match="left the vertical plane"):
        model.step(0.0, 0.1, start)
    with pytest.raises(ParameterError, match=r"lower\.y = 0\.5 m: must be top\.y = 0 in the plane"):
        CableChain(from_dict(LINE)).initialize(start)


@pytest.mark.parametrize("asked", ["start", "end"])
def test_a_step_between_inputs_that_say_where_an_end_is_that_nothing_drives_is_refused(asked):
    model, given = make(HANGING), {"start": np.zeros(19), "end": np.zeros(19)}
    model.initialize(np.zeros(19))
    given[asked][12] = -1.0
    with pytest.raises(SolverError, match=r"the inputs lower\.\* say where the lower end is, but they do not drive it"):
        model.advance(0.0, 0.05, given["start"], given["end"])
