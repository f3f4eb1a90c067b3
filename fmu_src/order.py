"""The order of FMI calls and of communication points: what fits, and the texts where it does not.  No model, no values.

The native FMUs have the same rules and texts in C; the tests hold both against one list.
"""

from __future__ import annotations

import enum
import math
from dataclasses import dataclass

from cable_model.errors import ParameterError, refuse

# what communication points may be off by: hosts add up steps, or round to nanoseconds
STEP_SLACK, TIME_SLACK = 1e-6, 1e-9


class Phase(enum.IntEnum):
    """Where FMI's life of an instance is."""

    INSTANTIATED = 0
    INITIALIZING = 1
    RUNNING = 2
    FAILED = 3
    TERMINATED = 4
    FAILED_AND_TERMINATED = 5


def expect(phase: Phase, allowed: tuple[Phase, ...], rule: str, remedy: str) -> None:
    """Raises ParameterError where a call comes in a phase that it does not belong to."""
    if phase not in allowed:
        raise refuse("instance", phase.name.lower().replace("_", " "), "", rule, remedy)


@dataclass
class Experiment:
    """The times that a host has told: `last` is where the last step ended."""

    set_up: bool = False
    start: float = 0.0
    stop: float | None = None
    last: float = 0.0

    def begin(self, start: float, stop: float | None) -> None:
        """Raises ParameterError for times that are none."""
        if not math.isfinite(start):
            raise refuse("start time", float(start), "s", "finite", "Give the time at which the simulation starts.")
        if stop is not None and not (math.isfinite(stop) and stop >= start):
            raise refuse("stop time", float(stop), "s", f"finite and >= the start time {start:.10g} s", "Give a later one, or none.")
        self.set_up, self.start, self.stop, self.last = True, float(start), stop, float(start)

    def must_be_set_up(self) -> None:
        """Raises ParameterError where no times were told before initialization."""
        if not self.set_up:
            raise ParameterError("experiment: must be set up before initialization. Call fmi2SetupExperiment first.")

    def check(self, now: float, step: float) -> None:
        """A step begins where the last one ended, and ends by the stop time, but for the rounding of a host's clock."""
        slack = STEP_SLACK * step + TIME_SLACK * (1.0 + abs(self.last))
        if abs(now - self.last) > slack:
            where = f"must be {self.last:.12g} s, where the last step ended. Go on from there, or restore a state."
            raise ParameterError(f"communication point = {now:.12g} s: {where}")
        if self.stop is not None and now + step > self.stop + slack:
            must = f"must be <= {self.stop:.12g} s, the stop time. Shorten the step, or set up a later stop time."
            raise ParameterError(f"end of the step = {now + step:.12g} s: {must}")

    def numbers(self) -> list[float]:
        """As saved states hold it."""
        return [float(self.set_up), self.start, float(self.stop is not None), self.stop or 0.0, self.last]

    @classmethod
    def from_numbers(cls, numbers: list[float]) -> Experiment:
        """The inverse of `numbers`.  Raises ValueError where they are no times."""
        set_up, start, has_stop, stop, last = numbers
        if not {set_up, has_stop} <= {0.0, 1.0} or not all(map(math.isfinite, (start, stop, last))):
            raise ValueError("time")
        return cls(bool(set_up), start, stop if has_stop else None, last)
