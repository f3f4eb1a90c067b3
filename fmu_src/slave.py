"""The pythonfmu slave of both FMUs: FMI calls onto a model.  No physics, and nothing that a host does may harm the host.

pythonfmu 0.7.0 gives back references to the instance, its class and its log once too often after every exception, and prints log
texts as printf formats; `_guarded` and `log` make up for both.
"""

from __future__ import annotations

import functools
import math
import sys
import time as clock
import traceback
import uuid
import weakref
from collections.abc import Callable, Sequence
from typing import Any, ClassVar
from xml.etree.ElementTree import Element

import numpy as np
from pythonfmu import Fmi2Slave
from pythonfmu.enums import Fmi2Status

from cable_model.errors import ParameterError, SolverError, refuse
from cable_model.model import Model
from cable_model.models import MODELS
from cable_model.parameters import field_of
from cable_model.precompiled import ObjectCode
from cable_model.scene import Scene, from_dict
from cable_model.signals import INPUTS, OUTPUTS, SHAPE
from cable_model.simulated import one_line
from fmu_src.interface import CPU_TIME, EFFECTS, Variable, in_variables, scene_from_values, table
from fmu_src.model_description import model_description
from fmu_src.order import Experiment, Phase, expect
from fmu_src.state import ONLY_OWN, TIMES, SavedState, StateError, checked, pack, unpack
from fmu_src.wrapper import forget_interpreter, keep, look_here_once, release, same_text

_PLACES = {row.name: vr for vr, row in enumerate(table())}
_INPUTS = tuple(_PLACES[name] for name in INPUTS)
_ARE_INPUTS = frozenset(vr for vr in _INPUTS if table()[vr].kind == "Real")
_OUTPUTS = tuple(_PLACES[name] for name in OUTPUTS)
_SHAPE = tuple(_PLACES[name] for name in SHAPE)  # has values where it was asked for since the last step
_IN_SHAPE = frozenset(_SHAPE)
_CPU_TIME, _EFFECTS = _PLACES[CPU_TIME], _PLACES[EFFECTS]
_PARAMETERS = tuple(vr for vr, row in enumerate(table()) if row.causality == "parameter")
_VALUES = (*_INPUTS, *_OUTPUTS, _CPU_TIME)
_CATEGORIES = {Fmi2Status.warning: "logStatusWarning", Fmi2Status.error: "logStatusError"}


class CallError(RuntimeError):
    """What a host is told: the text of any error, safe to be printed as a format; the wrapper shows its representation."""

    def __repr__(self) -> str:
        return str(self)


def _guarded(method: Callable[..., Any]) -> Callable[..., Any]:
    """Log what leaves the method, print its traceback to stderr (many hosts drop the log), and keep the host alive."""

    @functools.wraps(method)
    def call(self: CableSlave, *arguments: Any) -> Any:
        try:
            return method(self, *arguments)
        except BaseException as error:
            expected = isinstance(error, ParameterError | SolverError | StateError)
            text = in_variables(str(error)) if expected else "".join(traceback.format_exception(error))
            sys.stderr.write(f"{self.instance_name}: {method.__name__}: {traceback.format_exc()}\n")
            self.log(text, Fmi2Status.error)
            keep(self, type(self), self.log_queue)
            raise CallError(text.replace("%", "%%")) from None

    return call


class CableSlave(Fmi2Slave):
    """An FMU instance; subclasses name the model, the baked scene, the kernels' object code and the build."""

    model_key: ClassVar[str] = "chain"
    scene_values: ClassVar[dict[str, Any]] = {}
    build_guid: ClassVar[str] = "{00000000-0000-0000-0000-000000000000}"
    tool: ClassVar[str] = ""
    object_code: ClassVar[ObjectCode] = ObjectCode()
    _scene: ClassVar[Scene]
    _alive: ClassVar[weakref.WeakSet[CableSlave]] = weakref.WeakSet()

    def __init__(self, **arguments: Any) -> None:
        super().__init__(**arguments)
        self.modelName = type(self).__name__
        forget_interpreter(self.resources, self.modelName)
        look_here_once(self.resources)
        self._base = self._baked()
        self._rows = table(self._base)
        self._real = self._starts("Real")
        self._forget_shape()
        self._integer = self._starts("Integer")
        self._boolean = self._starts("Boolean")
        self._phase = Phase.INSTANTIATED
        self._experiment = Experiment()
        self._outdated = True
        self._model: Model | None = None
        self._doubts = 0
        self._told: set[str] = set()
        self._alive.add(self)

    @classmethod
    def _baked(cls) -> Scene:
        """The baked scene; it cannot be changed, so instances may have it in common."""
        if "_scene" not in vars(cls):
            cls._scene = from_dict(cls.scene_values)
        return cls._scene

    def _starts(self, kind: str) -> dict[int, Any]:
        return {vr: 0.0 if row.start is None else row.start for vr, row in enumerate(self._rows) if row.kind == kind}

    def log(self, msg: str, status: Fmi2Status = Fmi2Status.ok, category: str | None = None, debug: Any = None) -> None:
        super().log(same_text(str(msg).replace("%", "%%")), status, category or _CATEGORIES.get(status, "logAll"))

    def to_xml(self, model_options: Any = None) -> Element:
        description = f"{MODELS[self.model_key].__name__}: cable under a moving top end. {self._base.title}".strip()
        return model_description(self.modelName, self.build_guid, self._rows, self._base, description, self.tool)

    # -- life of an instance

    @_guarded
    def setup_experiment(self, start_time: float, stop_time: float | None = None, tolerance: float | None = None) -> None:
        expect(self._phase, (Phase.INSTANTIATED,), "new", "Reset it first.")
        self._experiment.begin(start_time, stop_time)

    @_guarded
    def enter_initialization_mode(self) -> None:
        expect(self._phase, (Phase.INSTANTIATED,), "new", "Reset it first.")
        self._experiment.must_be_set_up()
        self._phase = Phase.INITIALIZING
        self._outdated = True

    @_guarded
    def exit_initialization_mode(self) -> None:
        expect(self._phase, (Phase.INITIALIZING,), "initializing", "Enter the initialization mode first.")
        self._preview()
        self._phase = Phase.RUNNING
        self.log(f"{MODELS[self.model_key].__name__} simulates: {self._effects()}")
        self._tell_doubts()
        if self._model is not None and (why := self.object_code.refusal(self._model)):
            self.log(f"numba compiled the kernels: {why}")

    @_guarded
    def do_step(self, current_time: float, step_size: float) -> bool:
        expect(self._phase, (Phase.RUNNING,), "initialized and running", "Initialize, reset or restore it first.")
        if not math.isfinite(current_time):
            raise refuse("communication point", float(current_time), "s", "finite", "Give the time at which the step begins.")
        begun = clock.thread_time()
        model = self._initialized
        self._experiment.check(current_time, Model._positive(step_size))
        try:
            model.step(current_time, step_size, self._input_values())
        except SolverError:
            self._phase = Phase.FAILED
            raise
        self._experiment.last = current_time + step_size
        self._keep_outputs(model)
        self._real[_CPU_TIME] += clock.thread_time() - begun
        if model.doubts > self._doubts:
            self._tell_doubts()
        return True

    def _tell_doubts(self) -> None:
        """Log each warning once in the life of an instance."""
        if self._model is None:
            return
        self._doubts = self._model.doubts
        for text in self._model.warnings():
            if text not in self._told:
                self._told.add(text)
                self.log(text, Fmi2Status.warning)

    @_guarded
    def terminate(self) -> None:
        expect(self._phase, (Phase.RUNNING, Phase.FAILED), "initialized and not terminated", "Reset it or free it instead.")
        self._phase = Phase.FAILED_AND_TERMINATED if self._phase is Phase.FAILED else Phase.TERMINATED

    @property
    def _initialized(self) -> Model:
        """The model, which is there from initialization on."""
        assert self._model is not None
        return self._model

    def _preview(self) -> None:
        """While initialization lasts, outputs are those of the equilibrium under the values that are set by then."""
        if self._phase is not Phase.INITIALIZING or not self._outdated:
            return
        self._model = None
        model = self._made(self._parameters())
        model.initialize(self._input_values(), self._experiment.start)
        self._model = model
        self._keep_outputs(model)
        self._outdated = False

    def _input_values(self) -> np.ndarray:
        real, boolean = self._real, self._boolean
        return np.array([real[vr] if vr in real else float(boolean[vr]) for vr in _INPUTS])

    def _keep_outputs(self, model: Model) -> None:
        self._real.update(zip(_OUTPUTS, model.outputs.tolist(), strict=True))
        self._forget_shape()

    def _forget_shape(self) -> None:
        if _SHAPE[0] in self._real:
            for vr in _SHAPE:
                del self._real[vr]

    def _tell_shape(self, vrs: Sequence[int]) -> None:
        """Work the shape out where it is asked for: most hosts do not."""
        if _SHAPE[0] in self._real or _IN_SHAPE.isdisjoint(vrs):
            return
        if self._phase in (Phase.FAILED, Phase.FAILED_AND_TERMINATED):
            late = "must be asked for before a step fails. Restore a state, or reset the FMU."
            raise ParameterError(f"{next(self._rows[vr].name for vr in vrs if vr in _IN_SHAPE)}: {late}")
        self._real.update(zip(_SHAPE, self._initialized.shape().ravel().tolist(), strict=True))

    def _made(self, parameters: dict[str, float | int | bool]) -> Model:
        scene = scene_from_values(self._base, parameters, self.model_key)
        try:
            return MODELS[self.model_key](scene, self.object_code.calls)
        except ImportError as error:
            text = (
                f"{error.name or 'numba'}: must be installed where this FMU runs ({error}). Install what resources/requirements.txt lists, "
            )
            raise ParameterError(f"{text}or use the native FMU.") from error

    def _parameters(self) -> dict[str, float | int | bool]:
        known = {**self._real, **self._integer, **self._boolean}
        return {self._rows[vr].name: known[vr] for vr in _PARAMETERS}

    def _effects(self) -> str:
        return "" if self._model is None else in_variables(one_line(self._model.scene, self.model_key))

    # -- values

    def _known(self, vr: int, kind: str) -> Variable:
        if not 0 <= vr < len(self._rows):
            raise refuse("value reference", vr % 2**32, "", f"below {len(self._rows)}", "Use the references of modelDescription.xml.")
        row = self._rows[vr]
        if row.kind != kind:
            own = f"must be got and set as {row.kind}. Use the types of modelDescription.xml."
            raise ParameterError(f"{row.name} as {kind}: {own}")
        return row

    def _may_get(self, vr: int, kind: str) -> None:
        row = self._known(vr, kind)
        if self._phase is Phase.INSTANTIATED and row.causality in ("output", "local"):
            late = "must be asked for after initialization has begun. Enter the initialization mode first."
            raise ParameterError(f"{row.name}: {late}")

    def _may_set(self, vr: int, kind: str, value: Any) -> None:
        row = self._known(vr, kind)
        shown = float(value) if kind == "Real" else value
        if row.causality == "parameter" and self._phase > Phase.INITIALIZING:
            unit = "" if row.choices or kind == "Boolean" else field_of(row.scene_name).metadata["unit"]
            raise refuse(row.scene_name, shown, unit, "set before the end of initialization", "Reset the FMU first.")
        if row.causality not in ("parameter", "input"):
            raise refuse(row.name, shown, row.unit, "left alone: it is calculated", "Set inputs and parameters only.")
        if self._phase >= Phase.TERMINATED:
            raise refuse(row.name, shown, row.unit, "set before the end of the simulation", "Reset the FMU first.")
        if kind == "Real" and not math.isfinite(value):
            if row.causality == "input":
                Model._finite(np.where(np.array(_INPUTS) == vr, value, 0.0))
            scene_from_values(self._base, {row.name: value}, self.model_key)

    def _get(self, values: dict[int, Any], kind: str, vrs: Sequence[int]) -> list[Any]:
        for vr in vrs:
            self._may_get(vr, kind)
        self._preview()
        self._tell_shape(vrs)
        return [values[vr] for vr in vrs]

    def _set(self, values: dict[int, Any], kind: str, vrs: Sequence[int], new: Sequence[Any]) -> None:
        """All of them or none."""
        for vr, value in zip(vrs, new, strict=True):
            self._may_set(vr, kind, value)
        values.update(zip(vrs, new, strict=True))
        self._outdated = True

    @_guarded
    def get_real(self, vrs: Sequence[int]) -> list[float]:
        if self._phase is Phase.RUNNING:
            values = self._real
            try:
                return [values[vr] for vr in vrs]
            except KeyError:
                pass
        return self._get(self._real, "Real", vrs)

    @_guarded
    def set_real(self, vrs: Sequence[int], values: Sequence[float]) -> None:
        if _ARE_INPUTS.issuperset(vrs) and self._phase < Phase.TERMINATED and math.isfinite(sum(values)):
            self._real.update(zip(vrs, values, strict=True))
            self._outdated = True
        else:
            self._set(self._real, "Real", vrs, values)

    @_guarded
    def get_integer(self, vrs: Sequence[int]) -> list[int]:
        return self._get(self._integer, "Integer", vrs)

    @_guarded
    def set_integer(self, vrs: Sequence[int], values: Sequence[int]) -> None:
        self._set(self._integer, "Integer", vrs, values)

    @_guarded
    def get_boolean(self, vrs: Sequence[int]) -> list[bool]:
        return self._get(self._boolean, "Boolean", vrs)

    @_guarded
    def set_boolean(self, vrs: Sequence[int], values: Sequence[bool]) -> None:
        self._set(self._boolean, "Boolean", vrs, values)

    @_guarded
    def get_string(self, vrs: Sequence[int]) -> list[str]:
        for vr in vrs:
            self._may_get(vr, "String")
        self._preview()
        return [self._effects() for _ in vrs]

    @_guarded
    def set_string(self, vrs: Sequence[int], values: Sequence[str]) -> None:
        self._set({_EFFECTS: ""}, "String", vrs, values)

    # -- complete state

    @classmethod
    def _build(cls) -> bytes:
        return uuid.UUID(cls.build_guid).bytes

    @_guarded
    def _get_fmu_state(self) -> bytes:
        parameters = np.array([float(value) for value in self._parameters().values()])
        numbers = np.array([*self._experiment.numbers(), *map(float, map((self._boolean | self._real).__getitem__, _VALUES))])
        model = np.zeros(0) if self._model is None else self._model.state
        return pack(SavedState(self._phase, numbers, parameters, model), self._build())

    @_guarded
    def _set_fmu_state(self, state: bytes) -> None:
        saved = self._checked(state)
        values = dict(zip(_PARAMETERS, saved.parameters.tolist(), strict=True))
        kept = {kind: self._of_kind(values, kind) for kind in ("Real", "Integer", "Boolean")}
        model = self._restored(saved, {self._rows[vr].name: value for group in kept.values() for vr, value in group.items()})
        times, reals = np.split(saved.numbers, [TIMES])
        self._phase = Phase(saved.phase)
        self._experiment = Experiment.from_numbers(times.tolist())
        self._outdated = True
        self._forget_shape()
        values = dict(zip(_VALUES, reals.tolist(), strict=True))
        self._real |= self._of_kind(values, "Real") | kept["Real"]
        self._integer |= kept["Integer"]
        self._boolean |= self._of_kind(values, "Boolean") | kept["Boolean"]
        self._model = model
        self._doubts = 0 if model is None else model.doubts

    def _restored(self, saved: SavedState, parameters: dict[str, float | int | bool]) -> Model | None:
        """The model of a saved state; this instance stays as it is where the state is refused."""
        if not len(saved.model):
            return None
        size = f"saved state = {len(saved.model)} numbers: must be those of its own parameters. {ONLY_OWN}"
        model = self._model
        try:
            if model is None or parameters != self._parameters():
                model = self._made(parameters)
        except ParameterError as error:
            raise StateError(f"{size} {error}") from error
        if len(model.state) != len(saved.model):
            raise StateError(size)
        model.state[:] = saved.model
        return model

    def _of_kind(self, values: dict[int, float], kind: str) -> dict[int, Any]:
        python = {"Real": float, "Integer": int, "Boolean": bool}[kind]
        return {vr: python(value) for vr, value in values.items() if self._rows[vr].kind == kind}

    @classmethod
    def _checked(cls, data: bytes) -> SavedState:
        """A state from bytes, checked whole.  Raises StateError."""
        rows = table(cls._baked())
        return checked(unpack(data, cls._build()), [rows[vr] for vr in _VALUES], [rows[vr] for vr in _PARAMETERS])

    @staticmethod
    def _fmu_state_to_bytes(state: bytes) -> bytes:
        return state

    @classmethod
    def _fmu_state_from_bytes(cls, data: bytes) -> bytes:
        try:
            cls._checked(data)
        except StateError as error:
            sys.stderr.write(traceback.format_exc() + "\n")
            for instance in cls._alive:  # the wrapper does not say whose call this is
                if type(instance) is cls:
                    keep(instance, cls, instance.log_queue)
            release(data)
            raise CallError(str(error)) from None
        return data
