"""Driving FMUs of FMI 3.0 as fmu_support drives those of FMI 2.0, so that one test serves both."""

from __future__ import annotations

import ctypes
import re
from pathlib import Path
from typing import Any

from fmpy.fmi3 import FMU3Slave
from fmu_support import Fmu, Instance

from cable_model.signals import SHAPE_POINTS
from fmu_src.native import link

ARRAYS = ("shape.x", "shape.y", "shape.z", "shape.tension")
_HEADER = (link.fmi_headers() / "fmi3Functions.h").read_text(encoding="utf-8")
CALLS = set(re.findall(r"(?m)^FMI3_Export \w+\s+(\w+);", _HEADER))  # all of FMI 3.0


def library_of(fmu: Fmu) -> ctypes.CDLL:
    return ctypes.CDLL(str(Path(fmu.folder) / "binaries" / "x86_64-linux" / f"{fmu.path.stem}.so"))


class Slave(FMU3Slave):
    """fmpy's, which can be called as its FMU2Slave too."""

    getReal = FMU3Slave.getFloat64
    getFMUstate, setFMUstate, freeFMUstate = FMU3Slave.getFMUState, FMU3Slave.setFMUState, FMU3Slave.freeFMUState
    serializeFMUstate, deSerializeFMUstate = FMU3Slave.serializeFMUState, FMU3Slave.deserializeFMUState

    def setReal(self, references: list[int], values: list[float]) -> None:
        """FMU2Slave has zeros for what lacks at the end."""
        self.setFloat64(references, [*values, *[0.0] * (len(references) - len(values))])

    def setupExperiment(self, startTime: float) -> None:
        self._start = startTime

    def enterInitializationMode(self, **times: float) -> None:
        super().enterInitializationMode(**(times or {"startTime": self._start}))


class Instance3(Instance):
    """One instance of an FMU of FMI 3.0."""

    slave_class = Slave

    def _instantiate(self) -> None:
        self.slave.instantiate(loggingOn=True, logMessage=self._log3)

    def _log3(self, environment: int, status: int, category: bytes, text: bytes) -> None:
        self.messages.append((status, text.decode()))

    def array(self, name: str) -> list[float]:
        """The elements of shape.x and the like."""
        return self.slave.getFloat64([self.fmu.references[name]], SHAPE_POINTS)


class Fmu3(Fmu):
    """An FMU of FMI 3.0 that is unzipped once."""

    def instance(self) -> Any:
        return Instance3(self)
