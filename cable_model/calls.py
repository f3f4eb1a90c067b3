"""What a model asks of its kernels, whoever compiled them.  Neither numba nor physics here: an FMU that ships kernels needs no more."""

from __future__ import annotations

from typing import Protocol

import numpy as np

TOO_FAST = -1  # status of a step, beside those of kernels.header
FASTEST_END = 1e4  # m/s, of either end, on average over a step; no ship, and no aircraft


class Calls(Protocol):
    """The kernels of one model instance, and the arrays that they work on.

    `state` is the complete state, `outputs` in the order of signals.OUTPUTS, `work` scratch.  Every call returns a status of
    kernels.header or TOO_FAST, after which `end_speed`, m/s, says how fast; `outputs` is filled only where it returns OK.
    """

    state: np.ndarray
    outputs: np.ndarray
    work: np.ndarray
    end_speed: float

    def start(self, time: float, inputs: np.ndarray) -> int:
        """Static equilibrium at `time` between the ends that inputs (22,) place."""

    def step(self, time: float, step: float, inputs: np.ndarray) -> int:
        """One communication step, inputs (22,) given at its start."""

    def advance(self, time: float, step: float, start: np.ndarray, end: np.ndarray) -> int:
        """One step, inputs (22,) known at both ends."""

    def points(self, even: bool, at: np.ndarray) -> None:
        """Position (m) and tension (N) of points from the lower end to the top, (m, 4): evenly along the cable, or the nodes."""

    def read_outputs(self) -> None:
        """Fill `outputs` from the state."""
