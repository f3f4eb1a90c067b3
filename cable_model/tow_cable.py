"""TowCable: Wang's straight cable that swings and stretches, as a model; free initial states for studies and tests."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from cable_model.errors import SolverError, unknown
from cable_model.kernels import header, top, tow, tow_step
from cable_model.kernels.problem import PARAMETERS, Parts
from cable_model.signals import OUTPUTS

SPHERE = 18.0  # tow.body_angle, rad: anything beyond pi selects the drag law of spheres
DEFAULTS = {"solver.time_step": 0.01, "tow.drag_segments": 10.0, "tow.body_angle": SPHERE}


class TowCable:
    """The two-degree-of-freedom tow model [Wang 1971, corrected].

    `state` is the complete state; copy it to save, write it back to restore.  `outputs` is in the order of signals.OUTPUTS.
    Angle: from straight down, positive where the body is at x < x of the top, as in the report.  Validity: a straight cable,
    in the plane y = const; lateral motion only while drag penetrates most of the length.
    """

    def __init__(self, numbers: np.ndarray, parts: Parts) -> None:
        self.parts = parts
        self.numbers = numbers
        self.state = np.zeros(tow_step.state_size(parts, numbers))
        self.outputs = np.zeros(len(OUTPUTS))
        self._work = np.zeros(tow_step.work_size(parts, numbers))
        self._path = np.zeros((6, 3))

    @classmethod
    def from_numbers(cls, p: Mapping[str, float], parts: Parts) -> TowCable:
        """A model from values by the names of PARAMETERS (SI); what is not given is DEFAULTS' or zero."""
        for name in p:
            if name not in PARAMETERS:
                raise unknown(name, PARAMETERS, "parameter")
        values = DEFAULTS | dict(p)
        return cls(np.array([float(values.get(name, 0.0)) for name in PARAMETERS]), parts)

    def initialize(self, start: np.ndarray, time: float = 0.0) -> None:
        """Equilibrium under a top of position, velocity and acceleration `start` (9,); raises SolverError where there is none."""
        self.state[:] = 0.0
        self.state[header.TOP : header.TOP + 9] = start
        self._must(tow_step.initialize(self.parts, self.numbers, float(time), self.state, self._work))

    def set_state(self, angle: float, angular_velocity: float, stretch: float, stretch_velocity: float) -> None:
        """Replace the motion: angle rad, rad/s, stretch from zero tension m, m/s."""
        self.state[[tow.ANGLE, tow.ANGLE_RATE, tow.STRETCH, tow.STRETCH_RATE]] = angle, angular_velocity, stretch, stretch_velocity
        self.state[header.NEXT_STEP] = 0.0
        self._read_outputs()

    def advance(self, time: float, h: float, start9: np.ndarray, end9: np.ndarray) -> None:
        """One step of h from `time` with the top's motion known at both ends; raises SolverError and keeps the state if it fails."""
        top.quintic(np.asarray(start9, dtype=float), np.asarray(end9, dtype=float), float(h), self._path)
        self._must(tow_step.advance(self.parts, self.numbers, float(time), float(h), self._path, self.state, self._work))

    @property
    def motion(self) -> np.ndarray:
        """Angle, angular velocity, stretch, stretch velocity."""
        return self.state[tow.ANGLE : tow.ANGLE + 4].copy()

    def __getitem__(self, name: str) -> float:
        return float(self.outputs[OUTPUTS.index(name)])

    def _read_outputs(self) -> None:
        tow_step.outputs(self.parts, self.numbers, self.state, self._work, self.outputs)

    def _must(self, status: int) -> None:
        if status != header.OK:
            at, size = self.state[header.ERROR_TIME], self.state[header.ERROR_SIZE]
            raise SolverError(f"TowCable at t = {at:.6g} s: status {status}, error {size:.3g}. Try a smaller step or a smoother motion.")
        self._read_outputs()
