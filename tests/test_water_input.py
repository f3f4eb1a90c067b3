"""What a scene says of water that changes and does not go together, is not asked for, or is not followed."""

import pytest
from chain_support import make, scene_of
from changing_water_support import BOTH, BY_INPUT, DEEP, LINE, stream

from cable_model import CableChain, simulate
from cable_model.errors import ParameterError, SolverError


@BOTH
def test_a_current_that_nothing_asks_for_is_refused(model):
    cable = model(scene_of(LINE))
    inputs = stream(DEEP, lambda t: [0.1, 0.0])(0.0)
    with pytest.raises(SolverError, match=r"the inputs water\.current_x and y give a current, but are not asked for\. Leave both at 0"):
        cable.initialize(inputs)
    cable.initialize(stream(DEEP, lambda t: [0.0, 0.0])(0.0))
    with pytest.raises(SolverError, match=r"water\.current_input = true"):
        cable.step(0.0, 0.1, inputs)
    with pytest.raises(SolverError, match=r"water\.current_input = true"):
        cable.advance(0.0, 0.1, DEEP(0.0), inputs)


@BOTH
def test_a_current_across_the_plane_is_refused(model):
    cable = model(scene_of(LINE, **BY_INPUT))
    across = stream(DEEP, lambda t: [0.0, 0.1])(0.0)
    with pytest.raises(SolverError, match=r"left the vertical plane.*water\.current_y at 0"):
        cable.initialize(across)
    cable.initialize(DEEP(0.0))
    with pytest.raises(SolverError, match="left the vertical plane"):
        cable.step(0.0, 0.1, across)


@pytest.mark.parametrize(
    ("changes", "text"),
    [
        ({"current__ramp_time": 5.0}, "current.ramp_time = 5 s: must be 0 without a current. Give a current, or remove it."),
        ({"waves__ramp_time": 5.0}, "waves.ramp_time = 5 s: must be 0 without waves. Give waves, or remove it."),
        (
            {"current__table": [[0.0, 0.0, 1.0, 0.0]], "current__speed": 1.0},
            "current.speed = 1 m/s: must be 0 beside current.table. Keep one of them.",
        ),
        (
            {"current__table": [[0.0, 0.0, 1.0, 0.0], [0.0, -5.0, 1.0, 0.0], [9.0, 0.0, 1.0, 0.0]]},
            "current.table = 3 rows: must be the same levels at every time, each once. Give every level at every time.",
        ),
        ({"current__table": [[0.0, 0.0, 1.0, 0.4]]}, "current.table[0] = 0.4 rad: must be 0 or pi in the plane."),
        (
            {"waves__record": [[float(k), 0.1 * (k % 3)] for k in (0, 1, 2, 3, 5, 6, 7, 8, 9)]},
            "waves.record = 9 rows: must be at least 8 rows of time that rises by equal steps, and of heights that differ. "
            "Sort the rows, and fill gaps.",
        ),
        ({"waves__record": [[float(k), 0.5] for k in range(9)]}, "waves.record = 9 rows: must be at least 8 rows of time that rises by"),
        ({"waves__surface": "wheeler"}, "waves.surface = 'wheeler': must be held without waves. Give waves, or remove it."),
        (
            {"waves__record": [[float(k), 0.1 * (k % 3)] for k in range(9)], "waves__amplitude": 1.0},
            "waves = 2 kinds: must be one of amplitude, spectrum, table and record. Keep one of them.",
        ),
        ({"water__density": 0.0, "water__current_input": True}, "water.current_input = True: must be false without water."),
    ],
)  # fmt: skip
def test_what_does_not_go_together_is_refused(changes, text):
    with pytest.raises(ParameterError) as error:
        scene_of(LINE, **changes)
    assert str(error.value).startswith(text)


@pytest.mark.parametrize(
    ("changes", "text"),
    [
        (
            {"current__table": [[0.0, 0.0, 0.1, 0.0], [0.1, 0.0, 0.3, 0.0]]},
            "rows of current.table 0.1 s apart, internal step = 0.02 s: the push of water that changes within a few steps is lost in part. "
            "Set solver.time_step = 0.01, or give smoother rows.",
        ),
        (
            {"current__table": [[0.0, 10.0, 0.5, 0.0], [0.0, 50.0, 0.1, 0.0]]},
            "levels of current.table from z = 10 to 50 m: all above the water. z points up from still water: give depths as negative z.",
        ),
        (
            {"waves__record": [[0.5 * k, 0.05 * k] for k in range(40)]},
            "waves.record = 1.95 m from its last row to its first, at most 0.05 m from any other row to the next: it repeats with a jump, "
            "which its waves have all the time. Cut or fade it so that both ends meet.",
        ),
    ],
)
def test_what_a_run_does_not_follow_is_told(changes, text):
    model = make(LINE, **changes)
    model.initialize(DEEP(0.0))
    assert text in model.warnings()


def test_a_current_that_nothing_gives_in_a_run_is_told():
    run = simulate(CableChain(scene_of(LINE, **BY_INPUT, run__duration=0.2)))
    assert any(text.startswith("water.current_input = true in a run without a host") for text in run.warnings)
    assert not any("current" in text for text in simulate(CableChain(scene_of(LINE, run__duration=0.2))).warnings)
