"""FMI 2.0 to the letter, both flavours alike: what may be called when, what a host may pass, and what it is told."""

from __future__ import annotations

import ctypes
import struct
import zlib

import numpy as np
import pytest
from fmi_calls import DISCARD, ERROR, OK, WARNING, Component, Library
from fmu_support import Fmu
from native_support import only_where_they_run

from cable_model.signals import INPUTS, OUTPUTS
from fmu_src.interface import table

pytestmark = only_where_they_run
PLACE = {row.name: reference for reference, row in enumerate(table())}
TENSION = PLACE["top.tension"]


# -- the order of calls


def test_calls_out_of_order_are_errors_that_harm_nothing(new):
    """What each phase refuses; afterwards the instance goes on as if nothing had been asked."""
    component = new()
    for call in (
        lambda: component.call("ExitInitializationMode"),
        lambda: component.call("EnterInitializationMode"),  # before the experiment is set up
        lambda: component.call("Terminate"),
        lambda: component.step(0.0, 0.1),
        lambda: component.get("Real", [TENSION])[0],
        lambda: component.get("String", [PLACE["effects.active"]])[0],
        lambda: component.set_up(float("nan")),
        lambda: component.set_up(5.0, 4.0),
    ):
        assert call() == ERROR
    assert component.get("Real", [PLACE["cable.length"]]) == (OK, [100.0])
    assert component.set_up(1.0, 2.0) == component.call("EnterInitializationMode") == OK
    for call in (
        lambda: component.set_up(),
        lambda: component.call("EnterInitializationMode"),
        lambda: component.call("Terminate"),
        lambda: component.step(1.0, 0.1),
    ):
        assert call() == ERROR
    assert component.call("ExitInitializationMode") == OK
    for call in (
        lambda: component.set_up(),
        lambda: component.call("EnterInitializationMode"),
        lambda: component.call("ExitInitializationMode"),
        lambda: component.set("Real", [PLACE["cable.length"]], [90.0]),
        lambda: component.call("CancelStep"),
    ):
        assert call() == ERROR
    assert component.step(1.0, 0.5) == component.step(1.5, 0.5) == OK
    assert component.step(2.0, 0.5) == ERROR  # past the stop time
    assert component.call("Terminate") == OK
    for call in (
        lambda: component.call("Terminate"),
        lambda: component.step(2.0, 0.1),
        lambda: component.set("Real", [PLACE["top.x"]], [1.0]),
    ):
        assert call() == ERROR
    assert component.get("Real", [TENSION])[0] == OK
    assert component.call("Reset") == OK
    assert component.initialize() == OK
    errors = [text for status, _, text in component.messages if status == ERROR]
    assert len(errors) == 8 + 4 + 5 + 1 + 3 and len({status for status, *_ in component.messages}) == 2


def test_the_texts_of_the_order_are_the_same(new):
    component = new()
    component.call("EnterInitializationMode")
    component.call("Terminate")
    component.get("Real", [TENSION])
    component.set_up(5.0, 4.0)
    component.set_up(5.0, 5.3)
    component.call("EnterInitializationMode")
    component.call("ExitInitializationMode")
    component.step(5.0, 0.25)
    component.step(5.25, 0.25)
    component.call("Terminate")
    component.set("Real", [PLACE["top.x"]], [2.0])
    assert [text.decode() for status, _, text in component.messages if status == ERROR] == [
        "experiment: must be set up before initialization. Call fmi2SetupExperiment first.",
        "instance = 'instantiated': must be initialized and not terminated. Reset it or free it instead.",
        "top.tension: must be asked for after initialization has begun. Enter the initialization mode first.",
        "stop time = 4 s: must be finite and >= the start time 5 s. Give a later one, or none.",
        "end of the step = 5.5 s: must be <= 5.3 s, the stop time. Shorten the step, or set up a later stop time.",
        "top.x = 2 m: must be set before the end of the simulation. Reset the FMU first.",
    ]


@pytest.mark.parametrize("host", ["sums", "nanoseconds", "sliver"])
def test_a_hosts_clock_may_round(new, host: str):
    """Added steps, whole nanoseconds, and the sliver of 2e-14 s that a sum leaves at the end."""
    component = new()
    component.set_up(0.0, 1.0)
    component.call("EnterInitializationMode")
    component.call("ExitInitializationMode")
    time = 0.0
    for k in range(30):
        begin = time if host != "nanoseconds" else round(k / 30.0 * 1e9) * 1e-9
        assert component.step(begin, 1.0 / 30.0) == OK
        time += 1.0 / 30.0
    if host == "sliver":
        assert component.step(1.0 - 2e-14, 2e-14) == OK


# -- values


def test_values_that_are_none_are_refused_when_they_are_set_and_no_value_with_them(new):
    component = new()
    for name, bad in (("top.x", np.nan), ("top.az", np.inf), ("cable.length", np.nan), ("winch.speed", -np.inf)):
        assert component.set("Real", [PLACE["top.y"], PLACE[name]], [7.0, bad]) == ERROR
    assert component.get("Real", [PLACE["top.y"], PLACE["top.x"], PLACE["cable.length"]]) == (OK, [0.0, 0.0, 100.0])
    assert component.texts == [
        "top.x = nan m: must be finite. Check what is connected to this input.",
        "top.az = inf m/s2: must be finite. Check what is connected to this input.",
        "cable.length = nan m: must be finite. Give the unstretched length.",
        "winch.speed = -inf m/s: must be finite. Check what is connected to this input.",
    ]


def test_nothing_where_something_must_be_is_an_error(new):
    component = new()
    one, size = (ctypes.c_uint * 1)(0), ctypes.c_size_t(1)
    for kind in ("Real", "Integer", "Boolean", "String"):
        for call in ("Get", "Set"):
            assert component.call(f"{call}{kind}", None, size, (ctypes.c_double * 1)(0.0)) == ERROR
            assert component.call(f"{call}{kind}", one, size, None) == ERROR
            assert component.call(f"{call}{kind}", None, ctypes.c_size_t(0), None) == OK
    assert component.call("GetFMUstate", None) == component.call("SetFMUstate", None) == ERROR
    assert component.call("SerializedFMUstateSize", None, ctypes.byref(size)) == ERROR
    assert component.call("SerializeFMUstate", None, ctypes.create_string_buffer(9), size) == ERROR
    assert component.call("DeSerializeFMUstate", None, size, ctypes.byref(ctypes.c_void_p())) == ERROR
    assert component.call("DeSerializeFMUstate", ctypes.create_string_buffer(9), size, None) == ERROR
    assert component.call("FreeFMUstate", None) == component.call("FreeFMUstate", ctypes.byref(ctypes.c_void_p())) == OK
    assert component.set("String", [PLACE["effects.active"]], [None]) == component.set("String", [0], [b"\xff\xfe"]) == ERROR
    assert component.get("Real", [2**32 - 1])[0] == component.get("Real", [2**31])[0] == ERROR
    assert component.initialize() == OK


def test_no_instance_is_an_error(library: Library):
    nothing = ctypes.c_size_t(0)
    for name in (
        "Reset", "Terminate", "EnterInitializationMode", "ExitInitializationMode", "CancelStep", "FreeFMUstate", "GetFMUstate",
        "SetFMUstate",
    ):  # fmt: skip
        assert library.call(name, None, None) == ERROR
    assert library.call("GetReal", None, None, nothing, None) == library.call("SetBoolean", None, None, nothing, None) == ERROR
    assert library.call("SetDebugLogging", None, 0, nothing, None) == ERROR
    library.free(None)


def test_what_the_capability_flags_leave_out_is_an_error_and_no_status_is_pending(new):
    component, nothing = new(), ctypes.c_size_t(0)
    assert component.call("GetRealOutputDerivatives", None, nothing, None, None) == ERROR
    assert component.call("GetDirectionalDerivative", None, nothing, None, nothing, None, None) == ERROR
    value, flag = ctypes.c_double(np.nan), ctypes.c_int(7)
    for name in ("GetStatus", "GetIntegerStatus", "GetStringStatus"):
        assert component.call(name, 0, ctypes.byref(flag)) == DISCARD
    component.initialize()
    component.step(0.0, 0.25)
    assert (component.call("GetRealStatus", 2, ctypes.byref(value)), value.value) == (OK, 0.25)
    assert (component.call("GetBooleanStatus", 3, ctypes.byref(flag)), flag.value) == (OK, 0)
    assert component.call("GetRealStatus", 2, None) == component.call("GetBooleanStatus", 3, None) == ERROR


def test_derivatives_of_inputs_are_the_inputs_that_they_name(in_each_flavour: Fmu, new):
    """Native FMUs take them; a host that sets those of all its inputs is told once which are not followed."""
    if not in_each_flavour.description.coSimulation.canInterpolateInputs:
        assert new().derive([PLACE["top.x"]], [1], [1.0]) == ERROR
        return
    given, derived = new(), new()
    velocity, acceleration = ([PLACE[f"top.{kind}{axis}"] for axis in "xyz"] for kind in "va")
    position = [PLACE[f"top.{axis}"] for axis in "xyz"]
    for component in (given, derived):
        component.set("Integer", [PLACE["top.motion_order"]], [2])
    given.set("Real", [*velocity, *acceleration], [1.0, 0.0, 0.2, 0.1, 0.0, -0.3])
    assert derived.derive([*position, *velocity], [1] * 6, [1.0, 0.0, 0.2, 0.1, 0.0, -0.3]) == OK
    for component in (given, derived):
        component.initialize()
        component.step(0.0, 0.1)
    assert derived.get("Real", [TENSION]) == given.get("Real", [TENSION])
    assert derived.derive(position, [2] * 3, [0.5, 0.0, 0.0]) == OK
    assert derived.get("Real", acceleration) == (OK, [0.5, 0.0, 0.0])
    assert [derived.derive([PLACE["top.ax"]], [1], [1.0]) for _ in range(3)] == [WARNING] * 3
    assert derived.derive([PLACE["winch.speed"]], [1], [1.0]) == derived.derive(position[:1], [3], [1.0]) == WARNING
    assert [text for text in derived.texts if "not followed" in text] == [
        "derivative of order 1 of top.ax = not followed: top.motion_order = 2 says how much of the motion is. "
        "Set top.motion_order, or leave that derivative out."
    ]
    assert derived.derive(position[:1], [0], [1.0]) == derived.derive(position[:1], [1], [float("nan")]) == ERROR
    assert derived.derive([TENSION], [1], [1.0]) == derived.derive([2**31], [1], [1.0]) == ERROR


# -- states


def saved(component: Component) -> tuple[ctypes.c_void_p, bytes]:
    state = ctypes.c_void_p()
    assert component.save(state) == OK
    _, size = component.size(state)
    status, data = component.as_bytes(state, size)
    assert status == OK
    return state, data


def test_a_freed_state_is_gone_and_a_smaller_room_refused(new):
    component = new()
    component.initialize()
    state, data = saved(component)
    assert component.as_bytes(state, len(data) - 1)[0] == ERROR
    assert component.as_bytes(state, len(data) + 9) == (OK, data + bytes(9))
    assert component.save(state) == OK  # in place of the first
    assert component.free_state(state) == OK and state.value is None
    assert component.restore(state) == component.size(state)[0] == ERROR
    assert component.free_state(state) == OK


def fnv(data: bytes) -> int:
    total = 14695981039346656037
    for byte in data:
        total = (total ^ byte) * 1099511628211 % 2**64
    return total


class Forged:
    """The bytes of a state with other numbers, and a checksum that fits.  Python: times, values, the model's numbers; native likewise."""

    def __init__(self, data: bytes) -> None:
        self.native = data.startswith(b"CABLEFM3")
        self.data = bytearray(data)
        self.values = 64 if self.native else 44 + 8 * 5
        # in Python inputs and outputs come before the parameters, wherever these stand in the table
        parameters = (row.name for row in table() if row.causality == "parameter")
        names = PLACE if self.native else (*INPUTS, *OUTPUTS, "solver.cpu_time", *parameters)
        self.place = {name: place for place, name in enumerate(names)}

    def put(self, offset: int, value: float) -> Forged:
        self.data[offset : offset + 8] = struct.pack("<d", value)
        return self

    def value(self, name: str, value: float) -> Forged:
        return self.put(self.values + 8 * self.place[name], value)

    def core(self, name: str, value: float) -> Forged:
        """Of the native state: what follows the values."""
        names = ("start_time", "stop_time", "last_time", "phase", "outdated", "initialized", "set_up", "has_stop", "shaped")
        return self.put(self.values + 8 * (len(PLACE) + names.index(name)), value)

    def phase(self, value: int) -> Forged:
        if self.native:
            return self.core("phase", value)
        self.data[28:32] = struct.pack("<I", value)
        return self

    def cable(self, value: float) -> Forged:
        return self.put(len(self.data) - (8 if self.native else 12), value)

    def time(self, value: float) -> Forged:
        return self.core("last_time", value) if self.native else self.put(44 + 8 * 4, value)

    @property
    def bytes(self) -> bytes:
        if self.native:
            self.data[48:56] = struct.pack("<Q", fnv(bytes(self.data[56:])))
        else:
            self.data[-4:] = struct.pack("<I", zlib.crc32(self.data[:-4]))
        return bytes(self.data)


def test_a_forged_state_is_refused_by_the_name_of_its_part(new):
    component = new()
    component.initialize()
    component.step(0.0, 0.25)
    state, data = saved(component)
    assert Forged(data).bytes == data
    assert component.from_bytes(Forged(data).value("top.x", 3.0).bytes, state) == component.restore(state) == OK
    assert component.get("Real", [PLACE["top.x"]]) == (OK, [3.0])
    component.messages.clear()
    forged = {
        "phase": Forged(data).phase(7), "time": Forged(data).time(np.nan), "top.vz": Forged(data).value("top.vz", np.nan),
        "body.tension": Forged(data).value("body.tension", np.inf), "cable.length": Forged(data).value("cable.length", np.nan),
        "solver.nodes": Forged(data).value("solver.nodes", 20.5), "solver.space": Forged(data).value("solver.space", 2.0),
        "cable": Forged(data).cable(np.nan),
    }  # fmt: skip
    for each in forged.values():
        assert component.from_bytes(each.bytes, state) == ERROR
    assert component.texts == [
        f"saved state of '{part}': must be one that this FMU can be in. Restore only what the same FMU has saved." for part in forged
    ]
    if Forged(data).native:
        for name, value in {"phase": 2.5, "outdated": np.nan, "initialized": 0.0, "has_stop": 3.0, "set_up": -1.0}.items():
            assert component.from_bytes(Forged(data).core(name, value).bytes, state) == ERROR
        early = Forged(data).core("phase", 1.0).core("initialized", 0.0)
        assert component.from_bytes(early.bytes, state) == ERROR
    for name, value in {"cable.length": -3.0, "solver.nodes": 60.0}.items():  # can be in a state, but breaks a rule
        assert component.from_bytes(Forged(data).value(name, value).bytes, state) == OK
        assert component.restore(state) == ERROR
    assert component.get("Real", [PLACE["cable.length"]]) == (OK, [100.0])
    assert component.step(0.25, 0.25) == OK
    component.free_state(state)
