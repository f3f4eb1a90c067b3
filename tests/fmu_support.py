"""Driving FMUs from tests through fmpy: by names, with the log kept."""

from __future__ import annotations

import contextlib
import itertools
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any

import fmpy
import numpy as np
import pytest
from fmpy.fmi1 import FMICallException
from fmpy.fmi2 import FMU2Slave, defaultCallbacks, fmi2CallbackFunctions, fmi2CallbackLoggerTYPE

from cable_model.signals import INPUTS, OUTPUTS

__all__ = [
    "ERROR",
    "FIRST",
    "HEAD",
    "FMICallException",
    "Fmu",
    "Instance",
    "a_mooring_follows_the_top_during_initialization",
    "assert_same",
    "fresh",
    "goes_on_from_a_state_saved_in_a_sliver",
    "outputs_follow_what_is_set_during_initialization",
    "recovers",
    "refused",
    "started",
    "sway",
    "undisturbed_runs",
]

_numbers = itertools.count()
CUT = INPUTS.index("lower_end.let_go")  # the one that is a Boolean, and the last
HEAD = 10  # inputs whose value references come first
FIRST = OUTPUTS.index("top.force_mean_x")  # outputs whose value references follow theirs
ERROR = 3  # fmi2Error: a host can go on


def sway(time: float, amplitude: float = 0.3, omega: float = 0.9) -> np.ndarray:
    """A top that is at rest at time 0 and then circles smoothly in x and z; position, velocity, acceleration (9,)."""
    phase = omega * time
    x = amplitude * (phase - np.sin(phase)), amplitude * omega * (1.0 - np.cos(phase)), amplitude * omega**2 * np.sin(phase)
    z = amplitude * (1.0 - np.cos(phase)), amplitude * omega * np.sin(phase), amplitude * omega**2 * np.cos(phase)
    return np.array([x[0], 0.0, z[0], x[1], 0.0, z[1], x[2], 0.0, z[2]])


def assert_same(found: np.ndarray, expected: np.ndarray) -> None:
    """Outputs, a row a step, are equal within 1e-12 of each signal's size; an audit's of what its balances are the differences of."""
    scale = np.abs(expected).max(axis=0) + 1e-300
    if expected.ndim == 2 and expected.shape[1] == len(OUTPUTS):
        force = scale[[OUTPUTS.index(f"top.force_{axis}") for axis in "xyz"]].max()  # N, and of energy a metre of it
        for name in ("audit.energy", "audit.momentum"):
            scale[OUTPUTS.index(name)] = max(scale[OUTPUTS.index(name)], force)
    assert (np.abs(found - expected) / scale).max(axis=0) == pytest.approx(0.0, abs=1e-12)


class Fmu:
    """An FMU that is unzipped once; instances of it are made with `instance()`."""

    def __init__(self, path: Path, folder: Path) -> None:
        self.path = path
        self.description = fmpy.read_model_description(str(path))
        self.folder = fmpy.extract(str(path), unzipdir=str(folder))
        self.references = {v.name: v.valueReference for v in self.description.modelVariables}
        self.types = {v.name: v.type for v in self.description.modelVariables}

    def instance(self) -> Instance:
        return Instance(self)


class Instance:
    """One instance of an FMU; variables by name; `messages` holds what it logged as (status, text)."""

    slave_class: Any = FMU2Slave

    def __init__(self, fmu: Fmu) -> None:
        self.fmu = fmu
        self.messages: list[tuple[int, str]] = []
        self.slave = self.slave_class(
            guid=fmu.description.guid, unzipDirectory=fmu.folder, instanceName=f"cable{next(_numbers)}",
            modelIdentifier=fmu.description.coSimulation.modelIdentifier,
        )  # fmt: skip
        self._instantiate()
        self._inputs = [fmu.references[name] for name in INPUTS]
        self._outputs = [fmu.references[name] for name in OUTPUTS]

    def _instantiate(self) -> None:
        self._callbacks = fmi2CallbackFunctions(
            fmi2CallbackLoggerTYPE(self._log), defaultCallbacks.allocateMemory, defaultCallbacks.freeMemory, defaultCallbacks.stepFinished
        )
        self.slave.instantiate(callbacks=self._callbacks, loggingOn=True)

    def _log(self, environment: int, name: bytes, status: int, category: bytes, text: bytes) -> None:
        self.messages.append((status, text.decode()))

    @property
    def errors(self) -> list[str]:
        """Texts that were logged as errors."""
        assert all(status < 4 for status, _ in self.messages)  # none is fatal
        return [text for status, text in self.messages if status == 3]

    def set(self, values: Mapping[str, object]) -> None:
        for name, value in values.items():
            getattr(self.slave, f"set{self.fmu.types[name]}")([self.fmu.references[name]], [value])

    def get(self, name: str) -> float | int | bool | str:
        value = getattr(self.slave, f"get{self.fmu.types[name]}")([self.fmu.references[name]])[0]
        return value.decode() if isinstance(value, bytes) else value

    def initialize(self, values: Mapping[str, object] | None = None, inputs: Iterable[float] | None = None, time: float = 0.0) -> None:
        self.slave.setupExperiment(startTime=time)
        self.set(values or {})
        if inputs is not None:
            self.set_inputs(inputs)
        self.slave.enterInitializationMode()
        self.slave.exitInitializationMode()

    def set_inputs(self, inputs: Iterable[float]) -> None:
        """The first inputs; the others stay, where fmpy alone would make them 0."""
        given = [float(x) for x in inputs]
        self.slave.setReal(self._inputs[: len(given)][:CUT], given[:CUT])
        if len(given) > CUT:
            self.slave.setBoolean(self._inputs[CUT:], [given[CUT] != 0.0])

    def step(self, time: float, step: float, inputs: Iterable[float]) -> np.ndarray:
        self.set_inputs(inputs)
        self.slave.doStep(time, step)
        return self.outputs()

    def outputs(self) -> np.ndarray:
        return np.array(self.slave.getReal(self._outputs))

    def run(self, steps: int, step: float = 0.05, first: int = 0) -> np.ndarray:
        """Outputs (steps, 18) after steps number first + 1, ... under `sway`."""
        return np.array([self.step(k * step, step, sway(k * step)) for k in range(first, first + steps)])

    def close(self) -> None:
        with contextlib.suppress(FMICallException):  # that it never ran
            self.slave.terminate()
        self.slave.freeInstance()


def started(fmu: Fmu, values: dict[str, Any] | None = None, steps: int = 5) -> Instance:
    """An instance after some steps, its log emptied."""
    instance = fmu.instance()
    instance.initialize(values, sway(0.0))
    instance.run(steps)
    instance.messages.clear()
    return instance


def goes_back_before_initialization(fmu: Fmu) -> None:
    """A state from before the initialization holds the parameters of then, whatever was set since."""
    instance = fmu.instance()
    instance.set({"cable.length": 40.0})
    state = instance.slave.getFMUstate()
    instance.initialize(None, sway(0.0))
    first = instance.run(5)
    instance.slave.setFMUstate(state)
    instance.set({"cable.length": 41.0, "cable.diameter": 0.02})
    instance.slave.setFMUstate(state)
    instance.initialize(None, sway(0.0))
    assert np.array_equal(instance.run(5), first)
    instance.close()


def refuses_an_input(fmu: Fmu, name: str, text: str) -> None:
    """One of the inputs at a first step, in the words of a text, where no parameter asks for it."""
    given = np.zeros(len(INPUTS))
    instance = fmu.instance()
    instance.initialize({}, given)
    given[INPUTS.index(name)] = 0.1
    with pytest.raises(FMICallException):
        instance.step(0.0, 0.1, given)
    assert text in instance.errors[-1]
    instance.close()


def goes_on_from_a_state_saved_in_a_sliver(fmu: Fmu) -> None:
    """Bit for bit, in the same instance and in another: the time that waits for the next internal step is part of the state."""

    def take(which: Instance, time: float, steps: tuple[float, ...]) -> np.ndarray:
        rows = []
        for step in steps:
            rows.append(which.step(time, step, sway(time)))
            time += step
        return np.array(rows)

    instance, other = fmu.instance(), fmu.instance()
    before, after = (0.05, 0.05, 1e-9, 0.05, 1e-8), (1e-9, 0.05, 1e-3, 0.05)
    instance.initialize(None, sway(0.0))
    counts = take(instance, 0.0, before)[:, OUTPUTS.index("solver.steps")]
    assert counts[2] == counts[1] and counts[4] == counts[3]
    state = instance.slave.getFMUstate()
    data, saved_at = instance.slave.serializeFMUstate(state), sum(before)
    expected = take(instance, saved_at, after)
    instance.slave.setFMUstate(state)
    assert np.array_equal(take(instance, saved_at, after), expected)
    other.slave.setFMUstate(other.slave.deSerializeFMUstate(data))
    assert np.array_equal(take(other, saved_at, after), expected)
    instance.close()
    other.close()


def undisturbed_runs(fmus: Mapping[str, Fmu]) -> dict[str, np.ndarray]:
    """Ten steps of each FMU that nobody disturbs, by the file's name."""
    found = {}
    for fmu in fmus.values():
        instance = fmu.instance()
        instance.initialize(None, sway(0.0))
        found[fmu.path.stem] = instance.run(10)
        instance.close()
    return found


def recovers(instance: Instance, expected: np.ndarray) -> None:
    """It terminates, resets, and then runs as if nothing had been."""
    with contextlib.suppress(FMICallException):  # that it never ran
        instance.slave.terminate()
    instance.slave.reset()
    instance.initialize(None, sway(0.0))
    assert np.array_equal(instance.run(10), expected)
    instance.close()


def refused(fmu: Fmu, values: Mapping[str, Any], text: str) -> Instance:
    """An instance that said this one error at the end of its initialization, or where a value is none, when that was set."""
    instance = fmu.instance()
    early = any(isinstance(value, float) and not np.isfinite(value) for value in values.values())
    with pytest.raises(FMICallException, match="fmi2SetReal|fmi3SetFloat64" if early else "ExitInitializationMode") as error:
        instance.initialize(values)
    assert error.value.status == ERROR
    assert instance.errors == [text]
    return instance


def outputs_follow_what_is_set_during_initialization(fmu: Fmu) -> None:
    """They are those of a run that began with the same values, to the last bit; a value that is refused is one error, and can be mended."""
    straight = fmu.instance()
    start = [10.0, 0.0, -2.0, 0.3, 0.0, -0.2, 0.0, 0.0, 0.1]
    straight.initialize(None, start)
    instance = fmu.instance()
    instance.slave.setupExperiment(startTime=0.0)
    instance.slave.enterInitializationMode()
    hanging = instance.outputs()
    assert hanging[OUTPUTS.index("top.tension")] > 0.0 and instance.get("body.x") == pytest.approx(0.0, abs=1e-9)
    instance.set({"top.x": 10.0, "top.z": -2.0})
    moved = instance.outputs()
    assert moved[OUTPUTS.index("body.x")] == pytest.approx(10.0, abs=1e-9)
    assert moved[OUTPUTS.index("body.z")] - hanging[OUTPUTS.index("body.z")] == pytest.approx(-2.0, abs=1e-3)
    instance.set({"cable.length": -1.0})
    with pytest.raises(FMICallException):
        instance.outputs()
    assert instance.errors == ["cable.length = -1 m: must be > 0. Give the unstretched length."]
    instance.set({"cable.length": 100.0, "top.vx": 0.3, "top.vz": -0.2, "top.az": 0.1})
    last = instance.outputs()
    instance.slave.exitInitializationMode()
    assert np.array_equal(instance.outputs(), last)
    assert np.array_equal(last, straight.outputs())
    assert np.array_equal(instance.step(0.0, 0.05, start), straight.step(0.0, 0.05, start))
    straight.close()
    instance.close()


def a_mooring_follows_the_top_during_initialization(chain: Fmu) -> None:
    """The horizontal force of a catenary between the anchor and a top that is set in Initialization Mode, within the chain's own error."""
    instance = chain.instance()
    instance.set({"lower_end.anchored": True, "lower_end.x": 80.0, "lower_end.z": -50.0} | NO_BODY)
    instance.slave.setupExperiment(startTime=0.0)
    instance.slave.enterInitializationMode()
    for x in (0.0, 10.0, 5.0):
        instance.set({"top.x": x})
        assert instance.get("top.force_x") == pytest.approx(catenary_force(80.0 - x, 50.0), rel=2e-3)
    instance.slave.exitInitializationMode()
    instance.close()


NO_BODY = dict.fromkeys(("body.mass", "body.volume", "body.drag_area", "body.added_mass"), 0.0)


def catenary_force(span: float, drop: float) -> float:
    """Horizontal force of an inextensible catenary: sqrt(L^2 - drop^2) = 2 a sinh(span/(2 a)), H = w a, w the weight in water.

    The generic cable stretches by less than 1e-4.
    """
    length, weight = 100.0, 9.80665 * (0.68 - 1025.0 * 0.25 * np.pi * 0.013**2)
    wanted = np.sqrt(length**2 - drop**2)
    low, high = span / 60.0, 1e5
    for _ in range(200):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if 2.0 * middle * np.sinh(span / (2.0 * middle)) > wanted else (low, middle)
    return weight * low


def fresh(fmu: Fmu, steps: int = 20, values: dict[str, object] | None = None) -> np.ndarray:
    instance = fmu.instance()
    instance.initialize(values, sway(0.0))
    result = instance.run(steps)
    instance.close()
    return result
