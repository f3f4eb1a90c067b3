"""The FMUs of FMI 3.0 have the numbers, states and errors of those of FMI 2.0, and arrays and a time."""

from __future__ import annotations

import ctypes as c
from collections.abc import Iterator

import fmpy
import numpy as np
import pytest
from fmi3_support import ARRAYS, CALLS, Instance3, library_of
from fmu_support import (
    ERROR,
    FMICallException,
    Fmu,
    fresh,
    goes_on_from_a_state_saved_in_a_sliver,
    outputs_follow_what_is_set_during_initialization,
    refused,
    started,
    sway,
)
from native_support import lean, native_run, only_where_they_run, values_of
from test_fmu_input import BAD_PARAMETERS_OF, BAD_STEPS, STEP, bad_parameters

from cable_model.models import MODELS
from cable_model.motion import motion_of
from cable_model.signals import SHAPE, SHAPE_POINTS
from fmu_src.interface import table

pytestmark = only_where_they_run
SCENES = [("chain", "hanging_chain"), ("chain", "basin_chain"), ("chain", "towed_body"), ("tow", "dale_sphere")]
INSTANTIATE = {f"fmi3Instantiate{kind}" for kind in ("ModelExchange", "CoSimulation", "ScheduledExecution")}
HAS = {
    *("fmi3EnterInitializationMode", "fmi3ExitInitializationMode", "fmi3DoStep", "fmi3Terminate", "fmi3Reset", "fmi3SetDebugLogging"),
    *(f"fmi3{way}{kind}" for way in ("Get", "Set") for kind in ("Float64", "Int32", "Boolean", "String")),
    *(f"fmi3{way}FMUState" for way in ("Get", "Set", "Free", "Serialize", "Deserialize")), "fmi3SerializedFMUStateSize",
}  # fmt: skip
LEFT_OUT = sorted(CALLS - HAS - INSTANTIATE - {"fmi3GetVersion", "fmi3FreeInstance"})
ABSENT = "must not be called: the capability flags of modelDescription.xml leave it out."


@pytest.fixture
def tow(native3: dict[str, Fmu]) -> Iterator[Instance3]:
    instance = native3["tow"].instance()
    yield instance
    instance.close()


# -- the numbers


@pytest.mark.parametrize(("key", "name"), SCENES)
def test_a_shipped_scene_gives_the_bits_of_fmi_2(native: dict[str, Fmu], native3: dict[str, Fmu], key: str, name: str):
    scene = lean(name, key)
    motion, step = motion_of(scene), scene.run.output_step
    inputs = np.array([motion(k * step) for k in range(60)])
    old, new = native[key].instance(), native3[key].instance()
    expected = native_run(old, values_of(scene, key), inputs, step)
    assert np.array_equal(native_run(new, values_of(scene, key), inputs, step), expected)
    assert np.ptp(expected[:, 0]) > 0.0  # it moved
    shape = [old.get(name) for name in SHAPE]
    assert [new.array(name) for name in ARRAYS] == [shape[k :: len(ARRAYS)] for k in range(len(ARRAYS))]
    assert new.get("effects.active") == old.get("effects.active") and new.get("time") == pytest.approx(60 * step)
    old.close()
    new.close()


def test_fmpy_simulates_it_as_it_does_that_of_fmi_2(native: dict[str, Fmu], native3: dict[str, Fmu]):
    times = np.linspace(0.0, 2.0, 41)
    motion = np.array([(t, *sway(t)[[0, 2]]) for t in times])
    signals = np.array([tuple(row) for row in motion], dtype=[("time", float), ("top.x", float), ("top.z", float)])
    given = {"stop_time": 2.0, "output_interval": 0.05, "input": signals, "start_values": {"body.mass": 450.0, "top.motion_order": 0}}
    old, new = (
        fmpy.simulate_fmu(str(fmu.path), output=["top.tension", "body.x", *more], **given)
        for fmu, more in ((native["tow"], ["shape.z[11]"]), (native3["tow"], ["shape.z"]))
    )
    assert len(new) == 41 and np.ptp(new["body.x"]) > 1e-3
    for name in ("time", "top.tension", "body.x"):
        assert np.array_equal(new[name], old[name])
    assert np.array_equal(new["shape.z"][:, -1], old["shape.z[11]"])


@pytest.mark.parametrize("key", sorted(MODELS))
def test_outputs_follow_what_is_set_in_initialization_mode(native3: dict[str, Fmu], key: str):
    outputs_follow_what_is_set_during_initialization(native3[key])


# -- states


@pytest.mark.parametrize("key", sorted(MODELS))
def test_a_state_saved_in_the_middle_goes_on_bit_for_bit_serialized_too(native3: dict[str, Fmu], key: str):
    goes_on_from_a_state_saved_in_a_sliver(native3[key])


def test_a_reset_instance_is_a_new_one(native3: dict[str, Fmu]):
    instance = started(native3["tow"], {"cable.length": 40.0})
    instance.slave.reset()
    assert [instance.get(name) for name in ("cable.length", "top.x", "time")] == [100.0, 0.0, 0.0]
    instance.initialize(None, sway(0.0))
    assert np.array_equal(instance.run(20), fresh(native3["tow"]))
    instance.close()


def test_a_state_of_the_fmu_of_fmi_2_is_refused(native: dict[str, Fmu], tow: Instance3):
    other = started(native["tow"])
    data = other.slave.serializeFMUstate(other.slave.getFMUstate())
    with pytest.raises(FMICallException):
        tow.slave.deserializeFMUState(data)
    assert tow.errors == ["saved state: must be of this build of the FMU. Restore only what the same FMU has saved."]
    other.close()


# -- errors


@pytest.mark.parametrize("case", BAD_STEPS)
def test_a_bad_step_is_the_error_of_fmi_2_and_harms_nothing(native3: dict[str, Fmu], case: str):
    time, step, inputs, text = BAD_STEPS[case]
    instance = started(native3["tow"])
    before = instance.outputs()
    with pytest.raises(FMICallException) as error:
        instance.step(time, step, inputs)
    assert (error.value.status, instance.errors) == (ERROR, [text])
    assert np.array_equal(instance.outputs(), before)
    assert instance.slave.doStep(5 * STEP, STEP) == (False, False, False, pytest.approx(6 * STEP))
    instance.close()


@pytest.mark.parametrize(("model", "case"), BAD_PARAMETERS_OF)
def test_a_bad_parameter_is_the_error_of_fmi_2(native3: dict[str, Fmu], model: str, case: str):
    refused(native3[model], *bad_parameters(model, case)).close()


def test_calls_out_of_order_are_errors_in_the_words_of_fmi_3(native3: dict[str, Fmu], tow: Instance3):
    place = native3["tow"].references
    slave, count = tow.slave, len(table())
    for call in (
        lambda: slave.doStep(0.0, STEP),
        slave.exitInitializationMode,
        slave.terminate,
        lambda: slave.enterInitializationMode(startTime=float("nan")),
        lambda: slave.enterInitializationMode(startTime=5.0, stopTime=4.0),
        lambda: tow.array("shape.x"),
    ):
        with pytest.raises(FMICallException):
            call()
    tow.initialize()
    for call in (
        slave.enterInitializationMode,
        lambda: tow.set({"cable.length": 3.0}),
        lambda: tow.set({"time": 3.0}),
        lambda: tow.set({"effects.active": "all"}),
        lambda: slave.setFloat64([place["shape.x"]], [0.0] * SHAPE_POINTS),
        lambda: slave.getFloat64([count + 1]),
        lambda: slave.getFloat64([place["shape.tension"] + 1]),
        lambda: slave.getFloat64([place["shape.x"], place["top.x"]], SHAPE_POINTS),
        lambda: slave.getFloat64([place["solver.nodes"]]),
        lambda: slave.getInt32([place["top.x"]]),
        lambda: slave.serializeFMUState(None),
        lambda: slave.fmi3GetFMUState(slave.component, None),
        lambda: slave.fmi3DoStep(slave.component, 0.0, STEP, True, *[None] * 4),
    ):
        with pytest.raises(FMICallException):
            call()
    assert tow.errors == [
        "instance = 'instantiated': must be initialized and running. Initialize, reset or restore it first.",
        "instance = 'instantiated': must be initializing. Enter the initialization mode first.",
        "instance = 'instantiated': must be initialized and not terminated. Reset it or free it instead.",
        "start time = nan s: must be finite. Give the time at which the simulation starts.",
        "stop time = 4 s: must be finite and >= the start time 5 s. Give a later one, or none.",
        "shape.x[1]: must be asked for after initialization has begun. Enter the initialization mode first.",
        "instance = 'running': must be new. Reset it first.",
        "cable.length = 3 m: must be set before the end of initialization. Reset the FMU first.",
        "time: must be left alone: it is the host's. Give it to fmi3DoStep.",
        "effects.active = 'all': must be left alone: it is calculated. Set inputs and parameters only.",
        "shape.x[1] = 0 m: must be left alone: it is calculated. Set inputs and parameters only.",
        f"value reference = {count + 1}: must be below {count}. Use the references of modelDescription.xml.",
        f"value reference = {place['shape.tension'] + 1}: must be that of a whole array. Use the references of modelDescription.xml.",
        "values = 11: must be 12, as many as the variables have elements. Pass room for all.",
        "solver.nodes as Float64: must be got and set as Int32. Use the types of modelDescription.xml.",
        "top.x as Int32: must be got and set as Float64. Use the types of modelDescription.xml.",
        "saved state: must not be empty. Save one first.",
        "place of the saved state: must be given. Pass the address of an fmi3FMUState.",
        "places of what a step tells: must be given. Pass the addresses of all four.",
    ]
    tow.run(3)


def test_values_that_are_refused_take_no_others_with_them(native3: dict[str, Fmu], tow: Instance3):
    place = native3["tow"].references
    with pytest.raises(FMICallException):
        tow.slave.setFloat64([place["top.y"], place["top.x"]], [7.0, float("nan")])
    with pytest.raises(FMICallException):
        tow.slave.setBoolean([place["solver.space"], place["top.x"]], [True, True])
    with pytest.raises(FMICallException):
        tow.slave.setInt32([place["top.motion_order"], place["effects.active"]], [2, 2])
    assert [tow.get(name) for name in ("top.y", "solver.space", "top.motion_order")] == [0.0, False, 1]
    tow.set({"solver.space": True, "top.motion_order": 2})
    assert [tow.get(name) for name in ("solver.space", "top.motion_order")] == [True, 2]


def test_a_step_that_is_refused_tells_where_the_last_one_ended(native3: dict[str, Fmu]):
    instance = started(native3["tow"])
    flags, last = [c.c_bool(True) for _ in range(3)], c.c_double(-1.0)
    with pytest.raises(FMICallException):
        instance.slave.fmi3DoStep(instance.slave.component, 9.0, STEP, True, *map(c.byref, flags), c.byref(last))
    assert ([flag.value for flag in flags], last.value) == ([False] * 3, pytest.approx(5 * STEP))
    instance.close()


def test_a_message_has_its_plain_text_and_the_categories_that_were_chosen(tow: Instance3):
    with pytest.raises(FMICallException):
        tow.set({"effects.active": "5 % of %s as Real, GUID, fmi2FMUstate"})
    with pytest.raises(FMICallException):
        tow.slave.fmi3SetDebugLogging(tow.slave.component, True, 1, (c.c_char_p * 1)(b"100 %d"))
    assert tow.errors == [
        "effects.active = '5 % of %s as Real, GUID, fmi2FMUstate': must be left alone: it is calculated. Set inputs and parameters only.",
        "log category = '100 %d': must be one of modelDescription.xml. Choose one of its LogCategories.",
    ]
    tow.slave.fmi3SetDebugLogging(tow.slave.component, True, 1, (c.c_char_p * 1)(b"logStatusError"))
    tow.initialize()
    assert len(tow.messages) == 2  # no word of what is simulated


def test_what_it_is_not_is_refused_with_a_text(native3: dict[str, Fmu], tow: Instance3):
    slave, token = tow.slave, native3["tow"].description.instantiationToken
    arguments = (b"cable", token.encode(), None, False, False)
    rest = (False, None, 0, None, slave.logMessage, slave.intermediateUpdate)
    library = library_of(native3["tow"])
    for name in ("fmi3InstantiateModelExchange", "fmi3InstantiateScheduledExecution"):
        call = getattr(library, name)
        call.restype = c.c_void_p
        assert call(*arguments, None, slave.logMessage, None, None, None) is None
    assert slave.fmi3InstantiateCoSimulation(*arguments, True, *rest) is None
    assert slave.fmi3InstantiateCoSimulation(b"cable", b"{another}", *arguments[2:], False, *rest) is None
    assert slave.fmi3InstantiateCoSimulation(b"", *arguments[1:], False, *rest) is None
    assert tow.errors == [
        f"fmi3InstantiateModelExchange: {ABSENT}",
        f"fmi3InstantiateScheduledExecution: {ABSENT}",
        f"fmi3InstantiateCoSimulation with eventModeUsed: {ABSENT}",
        f"instantiation token: must be {token}. The library and modelDescription.xml do not belong together.",
        "instance name: must not be empty. Give the instance a name.",
    ]


def test_every_call_bears_nothing_and_those_left_out_say_so(native3: dict[str, Fmu], tow: Instance3):
    library, at = library_of(native3["tow"]), c.c_void_p(tow.slave.component)
    nothing = (c.c_void_p(None),) * 12
    for name in (*LEFT_OUT, *sorted(HAS)):
        assert getattr(library, name)(*nothing) == ERROR, name
    library.fmi3FreeInstance(*nothing)
    for name in LEFT_OUT:
        assert getattr(library, name)(at, *nothing) == ERROR
    assert tow.errors == [f"{name}: {ABSENT}" for name in LEFT_OUT]
    for name in sorted(HAS - {"fmi3Reset", "fmi3FreeFMUState", "fmi3EnterInitializationMode"}):  # which ask for nothing
        assert getattr(library, name)(at, None, c.c_size_t(1), None, c.c_size_t(1), *nothing) == ERROR, name
    tow.initialize(None, sway(0.0))
    tow.run(3)
