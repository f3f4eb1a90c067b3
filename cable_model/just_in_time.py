"""The kernels as numba compiles them for the parts at hand, called for a model.  Only this file makes a model need numba."""

from __future__ import annotations

from types import ModuleType
from typing import Any

import numpy as np

from cable_model.calls import FASTEST_END, TOO_FAST
from cable_model.effects import GOING
from cable_model.kernels import ends, exchange, header, host, host_trials, instants, ringing, watch
from cable_model.kernels.jit import for_kernels
from cable_model.kernels.parting import is_whole
from cable_model.kernels.path import COLUMNS, ROWS, fastest_end
from cable_model.signals import OUTPUTS


class JustInTime:
    """Calls of a module of kernels (`chain` or `tow_step`); `held` are the parts under which the cable hangs until it is let go.

    A cable that parts goes on with fewer: kernels for these are compiled when that happens.
    """

    def __init__(self, kernels: ModuleType, order: int, parts: Any, numbers: np.ndarray, held: Any = None) -> None:
        self._kernels, self._order, self._parts, self._held = kernels, order, parts, held
        self._numbers = for_kernels(numbers)
        self._left = parts._replace(**dict.fromkeys(GOING))
        self.state = np.zeros(kernels.state_size(parts, numbers))
        self.work = np.zeros(kernels.work_size(parts, numbers))
        self.outputs = np.zeros(len(OUTPUTS))
        self.end_speed = 0.0
        self._path = np.zeros((ROWS, COLUMNS))
        self._end = np.zeros(9)
        self._room = np.zeros(host.room_size(self._numbers, len(self.state), len(OUTPUTS)))

    def start(self, time: float, inputs: np.ndarray) -> int:
        status = ends.refuse_inputs(self._numbers, time, self.state, inputs)
        if status != header.OK:
            return status
        ends.start_ends(self._order, self._numbers, self.state, inputs)
        status = self._equilibrium(time)
        if status == header.OK:
            watch.watch_start(self.state, inputs)
            self.read_outputs()
            exchange.start_exchange(self.state, self.outputs)
        return status

    def _equilibrium(self, time: float) -> int:
        """Statics; with the parts that hold it, then rates without them, where the cable is let go at the start."""
        if self._held is None:
            found: int = self._kernels.initialize(self._parts, self._numbers, time, self.state, self.work)
            return found
        status: int = self._kernels.settle(self._held, self._numbers, time, self.state, self.work)
        return status if status != header.OK else self._kernels.release(self._parts, self._numbers, time, self.state, self.work)

    def step(self, time: float, step: float, inputs: np.ndarray) -> int:
        status = ends.refuse_inputs(self._numbers, time, self.state, inputs)
        if status != header.OK:
            return status
        ringing.watch_ringing(self._numbers, self.state, inputs)
        instants.watch_instants(self._numbers, self.state)
        watch.watch_inputs(self._order, self._numbers, self.state, inputs, step)
        ends.follow_inputs(self._order, self._numbers, self.state, inputs, step, self._end, self._path)
        status = self._follow(time, step) if not len(self._room) else self._find_top(time, step, inputs)
        if status == header.OK:
            ends.remember(self._order, self._numbers, self.state, inputs, step)
        return status

    def _find_top(self, time: float, step: float, inputs: np.ndarray) -> int:
        """A step whose top has a mass: the path that follows the inputs is the first of several that are tried."""
        fixed = (self._parts.space is not None, self._numbers)
        changed = (self.state, self.outputs, self._room, self._path)
        host_trials.begin_trials(*fixed, time, step, self.state, self.outputs, inputs, self._room, self._path)
        status: int = host_trials.AGAIN
        while status == host_trials.AGAIN:
            status = host_trials.judge(*fixed, self._follow(float(self._room[host.TIME]), step), *changed)
        return status

    def advance(self, time: float, step: float, start: np.ndarray, end: np.ndarray) -> int:
        for inputs in (start, end):
            status: int = ends.refuse_inputs(self._numbers, time, self.state, inputs)
            if status != header.OK:
                return status
        ends.follow_ends(self._numbers, self.state, start, end, step, self._path)
        return self._follow(time, step)

    def _follow(self, time: float, step: float) -> int:
        self.end_speed = fastest_end(self._path, step)
        if self.end_speed > FASTEST_END:
            return TOO_FAST
        status: int = header.PARTING
        while status == header.PARTING:
            status = self._kernels.advance(self._now(), self._numbers, time, step, self._path, self.state, self.work)
        if status == header.OK:
            self.read_outputs()
            exchange.end_exchange(self._parts.driven is not None, self.state, step, self.outputs)
        return status

    def _now(self) -> Any:
        """The parts that there are now, or after this call has begun."""
        return self._parts if self._parts.parting is None or is_whole(self.state) else self._left

    def points(self, even: bool, at: np.ndarray) -> None:
        told = np.zeros(len(OUTPUTS))
        self._kernels.outputs(self._now(), self._numbers, self.state, self.work, told)
        self._kernels.points(self._now(), self._numbers, self.state, self.work, told, even, at)

    def read_outputs(self) -> None:
        self._kernels.outputs(self._now(), self._numbers, self.state, self.work, self.outputs)
