"""Simulating a built FMU under given motion of its ends, to compare it with a reference; what is no FMU of ours is refused."""

from __future__ import annotations

import contextlib
import itertools
import tempfile
import zipfile
from collections.abc import Callable, Iterator, Mapping
from pathlib import Path
from typing import Any

import numpy as np

from cable_model.comparison import times_of
from cable_model.driving import ROUNDING, output_steps
from cable_model.errors import ParameterError, SolverError, unknown
from cable_model.motion import MotionLike, PrescribedMotion
from cable_model.signals import INPUTS, OUTPUTS

_OF_LOWER_END, _OF_CURRENT, _CUT = INPUTS[10:19], INPUTS[19:21], INPUTS.index("lower_end.let_go")
RESULTS = (*OUTPUTS, "solver.cpu_time")
WARNING, ERROR = 1, 3  # status of what an FMU logs


def _refused(fmu: Path, why: object, remedy: str = "Build it with `python build_fmu.py`.") -> ParameterError:
    line = " ".join(str(why).split())
    return ParameterError(f"{fmu}: no FMU that can be simulated ({line.rstrip('.')}). {remedy}")


class _Opened:
    """An unzipped FMU with one instance; variables by their names."""

    def __init__(self, fmu: Path, folder: str) -> None:
        import fmpy
        from fmpy.fmi2 import FMU2Slave, defaultCallbacks, fmi2CallbackFunctions, fmi2CallbackLoggerTYPE

        self.fmu = fmu
        self.messages: list[tuple[int, str]] = []
        if not zipfile.is_zipfile(fmu):
            raise _refused(fmu, "it is no zip file, or a part of one")
        try:
            with fmu.open("rb") as file:  # fmpy leaves open what it opened where it fails
                description = fmpy.read_model_description(file)
            fmpy.extract(str(fmu), folder)
        except KeyError as absent:
            raise _refused(fmu, "it has no modelDescription.xml") from absent
        except AttributeError as other:  # what fmpy says of a file without attributes
            raise _refused(fmu, "its modelDescription.xml is not FMI's") from other
        except Exception as error:  # fmpy raises bare Exceptions, lxml its own
            if isinstance(error, OSError):
                raise
            raise _refused(fmu, error) from error
        if description.fmiVersion != "2.0" or description.coSimulation is None:
            needed = f"FMI {description.fmiVersion}, and FMI 2.0 for co-simulation is needed"
            raise _refused(fmu, needed, "Give the FMU of FMI 2.0, which `python build_fmu.py` builds too.")
        self.variables = {variable.name: variable for variable in description.modelVariables}
        lacking = [name for name in (*INPUTS, *RESULTS) if name not in self.variables]
        if lacking:
            raise _refused(fmu, f"it has no {', '.join(lacking[:3])}{' ...' if len(lacking) > 3 else ''}")
        identifier = description.coSimulation.modelIdentifier
        try:
            self.slave = FMU2Slave(guid=description.guid, unzipDirectory=folder, instanceName="checked", modelIdentifier=identifier)
        except Exception as error:  # no binary for this machine, or one that does not load
            raise _refused(fmu, error) from error
        self._callbacks = fmi2CallbackFunctions(
            fmi2CallbackLoggerTYPE(self._log), defaultCallbacks.allocateMemory, defaultCallbacks.freeMemory, defaultCallbacks.stepFinished
        )

    def _log(self, environment: int, name: bytes, status: int, category: bytes, text: bytes) -> None:
        self.messages.append((status, text.decode(errors="replace")))

    def instantiate(self) -> None:
        self.slave.instantiate(callbacks=self._callbacks, loggingOn=True)

    def set(self, values: Mapping[str, Any]) -> None:
        for name, value in values.items():
            if name not in self.variables:
                raise unknown(name, self.variables, "variable of the FMU")
            variable = self.variables[name]
            getattr(self.slave, f"set{variable.type}")([variable.valueReference], [value])

    def set_inputs(self, given: list[float]) -> None:
        """All of them, in the order of signals.INPUTS."""
        references = [self.variables[name].valueReference for name in INPUTS]
        self.slave.setReal(references[:_CUT] + references[_CUT + 1 :], given[:_CUT] + given[_CUT + 1 :])
        self.slave.setBoolean(references[_CUT : _CUT + 1], [given[_CUT] != 0.0])

    def results(self) -> list[float]:
        found: list[float] = self.slave.getReal([self.variables[name].valueReference for name in RESULTS])
        return found


@contextlib.contextmanager
def _opened(fmu: Path) -> Iterator[_Opened]:
    """An FMU until the block ends; a call that fails is a SolverError with what the FMU said."""
    from fmpy.fmi1 import FMICallException

    if not fmu.is_file():
        raise ParameterError(f"{fmu}: no such file. Build it with `python build_fmu.py`.")
    with tempfile.TemporaryDirectory(ignore_cleanup_errors=True) as folder:
        opened = _Opened(fmu, folder)
        try:
            opened.instantiate()
            yield opened
            opened.slave.terminate()
        except FMICallException as failure:
            said = [text for status, text in opened.messages if status == ERROR] or [text for _, text in opened.messages[-1:]]
            raise SolverError(f"{fmu}: {failure} {said[-1] if said else ''}".strip()) from failure
        finally:
            if opened.slave.component is not None:
                opened.slave.freeInstance()


def simulate_fmu(
    fmu: Path,
    times: np.ndarray,
    inputs: np.ndarray,
    parameters: Mapping[str, object] | None = None,
    told: Callable[[str], None] | None = None,
) -> tuple[tuple[str, ...], np.ndarray]:
    """Simulate an FMU that communicates at `times` (n,) with `inputs` (n, 22); returns columns and table as a library run has.

    The inputs of a communication step are those at its start, as FMI has it, or with top.inputs_at = 1 those at its end.  `told` gets the
    warnings that the FMU logs.  Raises ParameterError for what is no FMU of ours, SolverError for a call that fails.
    """
    with _opened(fmu) as opened:
        opened.slave.setupExperiment(startTime=float(times[0]), stopTime=float(times[-1]))
        moved = {"host.mass": 0.0} if "host.mass" in opened.variables else {}  # the motion is given
        opened.set({**moved, **(parameters or {})})
        opened.set_inputs(inputs[0].tolist())
        opened.slave.enterInitializationMode()
        opened.slave.exitInitializationMode()
        rows = [opened.results()]
        at_end = int(opened.slave.getInteger([opened.variables["top.inputs_at"].valueReference])[0])
        for (start, end), given in zip(itertools.pairwise(times.tolist()), inputs[at_end:].tolist(), strict=False):
            opened.set_inputs(given)
            opened.slave.doStep(start, end - start)
            rows.append(opened.results())
        if told is not None:
            for text in dict.fromkeys(text for status, text in opened.messages if status == WARNING):
                told(text)
    return ("time", *INPUTS, *RESULTS), np.column_stack([times, inputs, np.array(rows)])


def sampled_motion(motion: PrescribedMotion, duration: float, step: float) -> tuple[np.ndarray, np.ndarray]:
    """Output times of a run and events of the motion between them, and the inputs there, (n, 22): a host must not step over an event."""
    times = [0.0]
    for output in output_steps(duration, step):
        near = ROUNDING * output.length
        times += [*motion.events_within(output.start + near, output.end - near), output.end]
    return np.array(times), np.array([motion(t) for t in times])


def divided(times: np.ndarray, inputs: np.ndarray, motion: MotionLike, parts: int) -> tuple[np.ndarray, np.ndarray]:
    """So many communication steps in each, with the motion at their starts; every `parts`-th row is one that was given."""
    finer = np.interp(np.arange((len(times) - 1) * parts + 1) / parts, np.arange(len(times)), times)
    given = {k * parts: row for k, row in enumerate(inputs)}
    return finer, np.array([given[k] if k in given else motion(t, 1) for k, t in enumerate(finer)])


def coarsened(table: np.ndarray, parts: int) -> np.ndarray:
    """The rows that were given of what `simulate_fmu` made of `divided` ones: means over a step are those of its parts."""
    rows = table[::parts].copy()
    for k, name in enumerate(("time", *INPUTS, *RESULTS)):
        if ".force_mean_" in name:
            rows[1:, k] = table[1:, k].reshape(-1, parts).mean(axis=1)
    return rows


def rows_of_inputs(path: Path, columns: tuple[str, ...], table: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Times (n,) and inputs (n, 22) of a table; without those of the lower end none is driven, and so on."""
    times = times_of(str(path), columns, table)
    asked: tuple[str, ...] = INPUTS[:10]
    for group in (_OF_LOWER_END, _OF_CURRENT):
        asked += group if any(name in columns for name in group) else ()
    lacking = [name for name in asked if name not in columns]
    if lacking:
        raise ParameterError(f"{path}: has no column {lacking[0]}. Give --scene for the motion.")
    still = np.zeros(len(times))
    return times, np.column_stack([table[:, columns.index(name)] if name in columns else still for name in INPUTS])


def recorded_motion(times: np.ndarray, inputs: np.ndarray) -> MotionLike:
    """The motion between the rows of a run: quintics through position, velocity and acceleration; the winch's speed and currents linear.

    What lets the lower end go is held from row to row.
    """
    from scipy.interpolate import BPoly

    paths = [BPoly.from_derivatives(times, rows.reshape(-1, 3, 3)) for rows in (inputs[:, :9], inputs[:, 10:19])]
    top, lower = ((path, path.derivative(1), path.derivative(2)) for path in paths)

    def motion(time: float, side: int = 1) -> np.ndarray:
        speed, *currents = ([np.interp(time, times, inputs[:, k])] for k in (9, 19, 20))
        cut = inputs[max(int(np.searchsorted(times, time, "right")) - 1, 0)][_CUT:]
        return np.concatenate([*(value(time) for value in top), speed, *(value(time) for value in lower), *currents, cut])

    return motion
