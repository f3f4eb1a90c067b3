"""States of the native FMUs: bit for bit, complete, and refused where they were changed."""

from __future__ import annotations

import numba
import numpy as np
import pytest
from fmu_support import FMICallException, Fmu, goes_back_before_initialization, goes_on_from_a_state_saved_in_a_sliver, started, sway
from native_support import ANCHORED, KEYS, SEABED, only_where_they_run

from cable_model.models import MODELS
from cable_model.signals import INPUTS
from fmu_src.interface import generic_scene

pytestmark = only_where_they_run

STEPS = 20 if numba.config.DISABLE_JIT else 300


@pytest.fixture(params=sorted(MODELS))
def fmu(request: pytest.FixtureRequest, native: dict[str, Fmu]) -> Fmu:
    return native[request.param]


@pytest.mark.parametrize("order", [0, 1, 2])
def test_a_restored_run_is_bit_identical(fmu: Fmu, order: int):
    instance = started(fmu, {"top.motion_order": order, "body.mass": 450.0}, 7)
    state = instance.slave.getFMUstate()
    data = instance.slave.serializeFMUstate(state)
    expected = instance.run(20, first=7)
    instance.slave.setFMUstate(state)
    assert np.array_equal(instance.run(20, first=7), expected)
    instance.slave.freeFMUstate(state)
    other = fmu.instance()
    other.slave.setFMUstate(other.slave.deSerializeFMUstate(data))
    assert other.get("body.mass") == 450.0
    assert np.array_equal(other.run(20, first=7), expected)
    instance.close()
    other.close()


def test_a_state_saved_in_a_sliver_goes_on_bit_for_bit(fmu: Fmu):
    goes_on_from_a_state_saved_in_a_sliver(fmu)


@pytest.mark.parametrize("space", [False, True], ids=["plane", "space"])
def test_a_saved_state_has_the_friction_of_a_cable_on_the_seabed(native: dict[str, Fmu], space: bool):
    instance = started(native["chain"], ANCHORED | SEABED | {"solver.space": space}, 7)
    state = instance.slave.serializeFMUstate(instance.slave.getFMUstate())
    expected = instance.run(20, first=7)
    other = native["chain"].instance()
    other.slave.setFMUstate(other.slave.deSerializeFMUstate(state))
    assert np.array_equal(other.run(20, first=7), expected)
    instance.close()
    other.close()


def test_a_state_holds_the_inputs_and_the_outputs(fmu: Fmu):
    instance = started(fmu)
    instance.set_inputs(np.arange(float(len(INPUTS))))
    outputs, state = instance.outputs(), instance.slave.getFMUstate()
    instance.slave.reset()
    instance.slave.setFMUstate(state)
    assert [instance.get(name) for name in INPUTS] == [*range(len(INPUTS) - 1), True]
    assert np.array_equal(instance.outputs(), outputs)
    instance.close()


def test_a_state_from_before_initialization_restores_that(fmu: Fmu):
    goes_back_before_initialization(fmu)


def test_a_reset_instance_is_a_new_one(fmu: Fmu):
    fresh = fmu.instance()
    fresh.initialize(None, sway(0.0))
    expected = fresh.run(10)
    instance = started(fmu, {"cable.length": 40.0, "solver.time_step": 0.02})
    instance.slave.reset()
    assert [instance.get(name) for name in ("cable.length", "solver.time_step", "top.x")] == [100.0, 0.01, 0.0]
    instance.initialize(None, sway(0.0))
    assert np.array_equal(instance.run(10), expected)
    for each in (fresh, instance):
        each.close()


def test_a_changed_state_is_refused(fmu: Fmu, native: dict[str, Fmu]):
    instance = started(fmu)
    data = instance.slave.serializeFMUstate(instance.slave.getFMUstate())
    (other,) = (started(each) for each in native.values() if each is not fmu)
    foreign = other.slave.serializeFMUstate(other.slave.getFMUstate())
    advice = "Restore only what the same FMU has saved."
    for bad, text in (
        (b"rubbish", f"saved state = 7 bytes: must be at least {len(data) - 8 * instance_numbers(fmu)}. {advice}"),
        (data[:-8], f"saved state = {len(data) - 8} bytes: must be complete. {advice}"),
        (b"x" + data[1:], f"saved state: must be of this build of the FMU. {advice}"),
        (foreign, f"saved state: must be of this build of the FMU. {advice}"),
        (
            data[:-20] + b"\0\1\2\3" + data[-16:],
            "saved state: must have its checksum. It was changed; restore only what the same FMU has saved.",
        ),
    ):
        instance.messages.clear()
        with pytest.raises(FMICallException):
            instance.slave.deSerializeFMUstate(bad)
        assert instance.errors == [text]
    assert np.array_equal(instance.run(3, first=5), started(fmu, steps=5).run(3, first=5))
    instance.close()
    other.close()


def instance_numbers(fmu: Fmu) -> int:
    """Size of the model's own state at its start values."""
    return len(MODELS[KEYS[fmu.path.stem]](generic_scene()).state)
