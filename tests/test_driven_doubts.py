"""What is doubtful about the motion of two ends is told, at the lower one as at the top."""

import numpy as np
import pytest
from chain_support import make, still
from doubts_support import FORM
from driven_support import AIR, FAR, LINE, LOW, SWAYING, TOP, inputs

from cable_model.signals import OUTPUTS


def warned(motion, **changes):
    model = make(LINE, **changes)
    model.initialize(motion(0.0))
    for k in range(100):
        model.step(0.1 * k, 0.1, motion(0.1 * k))
    assert all(FORM.fullmatch(text) for text in model.warnings())
    return model.warnings()


def with_lower(change):
    """The two ships, of which the lower one's inputs (9,) are changed at each time."""

    def motion(t):
        given = SWAYING(t)
        change(t, given[10:])
        return given

    return motion


def jumps(t, low):
    low[2] -= 2.0 if t > 5.0 else 0.0


def has_no_rates(t, low):
    low[3:] = 0.0


def has_no_acceleration(t, low):
    low[6:] = 0.0


def sinks_in(t, low):
    low[2] -= 20.0 * t / 10.0
    low[5] -= 2.0


def starts_at_speed(t, low):
    low[:] = [FAR[0] + 3.0 * t, *FAR[1:], 3.0, 0.0, 0.0, 0.0, 0.0, 0.0]


BOTTOM = {"seabed__level": -20.0, "seabed__stiffness": 1e4}


@pytest.mark.parametrize(
    ("change", "changes", "start"),
    [
        (jumps, {}, "lower end = "),
        (has_no_rates, {}, "way of the lower end = "),
        (has_no_acceleration, {"top__motion_order": 2}, "velocity of the lower end changed"),
        (starts_at_speed, {"cable__length": 100.5}, "an end starts at "),
        (sinks_in, BOTTOM, "an end of the cable at z = "),
    ],
)
def test_what_is_doubtful_about_its_motion_is_told(change, changes, start):
    assert not [text for text in warned(SWAYING, **changes) if text.startswith(start)]
    (text,) = {text for text in warned(with_lower(change), **changes) if text.startswith(start)}
    assert change is not jumps or "it jumps" in text


def test_ends_that_begin_in_one_place_are_told():
    """A host that has not set one of them yet."""
    model = make(LINE)
    for low, count in ((FAR, 0), ((0.05, 0.0, 0.0), 1)):
        model.initialize(inputs(still(), still(low))(0.0))
        told = [text for text in model.warnings() if text.startswith("ends of the cable = ")]
        assert len(told) == count


def rung(end, mass):
    """coupling.growth and warnings after 6 s of a vessel at one end of a taut line, which it feels a step late; the other end is fixed."""
    model = make(AIR, cable__axial_stiffness=2e6, cable__mass_per_length=20.0, solver__time_step=0.05)
    own, force = (0, TOP[0]) if end == "top" else (10, LOW[0])
    given = np.zeros(19)
    given[own] = 50.05
    model.initialize(given)
    rest, x, v = model.outputs[force], 0.0, 0.005
    held = rest
    for k in range(120):
        given[[own, own + 3]] = 50.05 + x, v
        model.step(0.05 * k, 0.05, given)
        a = (held - rest) / mass
        held, x, v = model.outputs[force], x + 0.05 * (v + 0.025 * a), v + 0.05 * a
    return model.outputs[OUTPUTS.index("coupling.growth")], [text for text in model.warnings() if text.startswith("ringing")]


def test_a_light_host_at_the_lower_end_rings_as_at_the_top_and_is_told():
    (growth, told), (same, as_well) = (rung(end, 1000.0) for end in ("top", "lower"))
    assert growth > 0.05
    assert same == pytest.approx(growth, rel=1e-2)
    assert len(told) == len(as_well) == 1
    assert rung("lower", 1e5) == (0.0, [])
