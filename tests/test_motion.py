"""The prescribed motion of the top: derivatives belong to each other, parts add up, jumps have two sides."""

from __future__ import annotations

import math

import numpy as np
import pytest

from cable_model.errors import ParameterError
from cable_model.motion import PrescribedMotion, fade_in
from cable_model.parameters import Motion, Top
from cable_model.scene import from_dict

SWING = Motion(kind="sinusoid", axis="x", amplitude=0.3, angular_frequency=2.0, phase=0.4, ramp_time=1.5)
RAMP = Motion(kind="ramp", axis="z", velocity=-1.2, start=0.5, duration=2.0)
TABLE = tuple((t, np.sin(t), 0.0, np.cos(t)) for t in np.linspace(0.0, 6.0, 25))


@pytest.mark.parametrize("top", [Top(motion=(SWING,)), Top(motion=(RAMP,)), Top(motion=(SWING, RAMP)), Top(table=TABLE)])
@pytest.mark.parametrize("time", [0.3, 0.9, 1.4, 2.2, 4.1])
def test_velocity_and_acceleration_are_the_derivatives_of_position(top, time):
    motion, h = PrescribedMotion(top), 1e-5
    before, now, after = motion(time - h), motion(time), motion(time + h)
    assert now[3:6] == pytest.approx((after[:3] - before[:3]) / (2 * h), abs=1e-8)
    assert now[6:9] == pytest.approx((after[3:6] - before[3:6]) / (2 * h), abs=1e-7)


def test_a_ramp_ends_with_its_velocity_and_the_distance_of_its_mean():
    state = PrescribedMotion(Top(motion=(RAMP,)))(2.5)
    assert state[5] == pytest.approx(-1.2)
    assert state[2] == pytest.approx(-1.2)
    assert state[8] == pytest.approx(0.0, abs=1e-12)


def test_a_step_of_velocity_has_two_sides():
    motion = PrescribedMotion(Top(motion=(Motion(kind="step", axis="x", velocity=0.5, start=1.0),)))
    assert motion(1.0, -1)[3] == 0.0
    assert motion(1.0, 1)[3] == 0.5
    assert motion(3.0)[0] == pytest.approx(1.0)


def test_fading_in_is_complete_and_flat_at_both_ends():
    assert fade_in(0.0, 2.0) == (0.0, 0.0, 0.0)
    assert fade_in(2.0, 2.0) == (1.0, 0.0, 0.0)
    assert fade_in(1.0, 2.0)[0] == pytest.approx(0.5)


def test_a_table_with_falling_times_is_refused():
    with pytest.raises(ParameterError, match=r"^top\.table = 4 rows: must be at least 4 rows of rising time\. "):
        PrescribedMotion(Top(table=((0.0, 0, 0, 0), (2.0, 0, 0, 0), (1.0, 0, 0, 0), (3.0, 0, 0, 0))))


@pytest.mark.parametrize("given", [{"angular_frequency": 2.5}, {"period": 2.0 * math.pi / 2.5}, {"frequency": 2.5 / (2.0 * math.pi)}])
def test_a_sinusoid_is_given_by_its_angular_frequency_its_period_or_its_frequency(given):
    motion = PrescribedMotion(Top(motion=(Motion(kind="sinusoid", axis="z", amplitude=2.0, **given),)))
    assert motion(0.3)[[2, 5, 8]] == pytest.approx([2.0 * math.sin(0.75), 5.0 * math.cos(0.75), -12.5 * math.sin(0.75)])
    assert motion.longest_piece(0.0) < 1.0


@pytest.mark.parametrize("end", ["top", "lower"])
@pytest.mark.parametrize(
    ("part", "words"),
    [
        ({"kind": "step", "velocity": 1.0, "period": 3.0}, "period = 3: must be left out of a step. It belongs to a sinusoid."),
        ({"kind": "step", "velocity": 1.0, "duration": 3.0}, "duration = 3: must be left out of a step. It belongs to a ramp."),
        ({"kind": "ramp", "velocity": 1.0, "ramp": "cubic"}, "ramp = 'cubic': must be left out of a ramp. It belongs to a sinusoid."),
        ({"kind": "ramp", "velocity": 1.0, "amplitude": 2.0}, "amplitude = 2: must be left out of a ramp. It belongs to a sinusoid."),
        ({"kind": "sinusoid", "amplitude": 1.0, "velocity": 2.0}, "velocity = 2: must be left out of a sinusoid. It belongs to a ramp."),
    ],
)
def test_what_a_kind_of_motion_has_no_use_for_is_refused(end, part, words):
    cable = {"length": 1.0, "mass_per_length": 1.0, "axial_stiffness": 1.0}
    with pytest.raises(ParameterError) as refused:
        from_dict({"cable": cable, "lower_end": {"anchored": True, "driven": True}, end: {"motion": [{"axis": "x", **part}]}})
    assert str(refused.value) == f"{end}.motion[0].{words}"


@pytest.mark.parametrize(
    ("part", "words"),
    [
        ({"amplitude": 1.0}, " = 'no frequency': must be a sinusoid with one of angular_frequency, period and frequency. Give one."),
        ({"amplitude": 1.0, "period": 2.0, "start": 3.0, "stop": 2.0}, ".stop = 2 s: must be 0 or > start = 3. Mend one of them."),
        ({"amplitude": 1.0, "period": 2.0, "start": 3.0, "phase": 1.0}, ".phase = 1 rad: must be 0 or pi in a sinusoid that begins later "
         "without ramp_time: else it begins with a jump. Give ramp_time, or start = 0."),
    ],
)  # fmt: skip
def test_a_sinusoid_without_frequency_end_or_beginning_is_refused(part, words):
    cable = {"length": 1.0, "mass_per_length": 1.0, "axial_stiffness": 1.0}
    with pytest.raises(ParameterError) as refused:
        from_dict({"cable": cable, "top": {"motion": [{"kind": "sinusoid", "axis": "x", **part}]}})
    assert str(refused.value) == f"top.motion[0]{words}"


def test_a_sinusoid_may_begin_later_where_it_does_not_jump():
    cable = {"length": 1.0, "mass_per_length": 1.0, "axial_stiffness": 1.0}
    for part in ({"phase": math.pi}, {"phase": 1.0, "ramp_time": 0.5}):
        motion = {"kind": "sinusoid", "axis": "x", "amplitude": 1.0, "period": 2.0, "start": 3.0, **part}
        from_dict({"cable": cable, "top": {"motion": [motion]}})


def test_a_sinusoid_that_is_given_in_two_ways_is_refused():
    part = {"kind": "sinusoid", "axis": "x", "amplitude": 1.0, "period": 2.0, "frequency": 0.5}
    words = r"top\.motion\[0\] = 'period and frequency': must be one of angular_frequency, period and frequency\. Keep one\."
    with pytest.raises(ParameterError, match=words):
        from_dict({"cable": {"length": 1.0, "mass_per_length": 1.0, "axial_stiffness": 1.0}, "top": {"motion": [part]}})
