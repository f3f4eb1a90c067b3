"""The prescribed motion of the cable's ends as a function of time, from the parts that a scene names."""

from __future__ import annotations

import bisect
import math
from collections.abc import Callable
from typing import Any

import numpy as np
from scipy.interpolate import CubicSpline

from cable_model.errors import refuse
from cable_model.parameters import Lower, Motion, Top, Winch

# (time, side) -> (22,), or the first 10 or 19 of them: position, velocity and acceleration of the top, winch speed, the same of the lower
# end, and the current that is added
MotionLike = Callable[[float, int], np.ndarray]

# A quintic through position, velocity and acceleration at both ends of a piece of h differs from x by at most h^6 max|x^(6)|/46080, its
# acceleration by h^4 max|x^(6)|/1920 [Hermite's remainder x^(6) (t - a)^3 (t - b)^3/720].  For A sin(omega t) the latter is
# (omega h)^4/1920 of its acceleration; it is kept to 1e-5, and position then to 6e-8 of A.  For a ramp of velocity over a time T,
# x^(6) = 720 v/T^5, it is 0.2 (h/T)^4 of the largest acceleration; for a fade-in x^(6) reaches 50400/T^6 at its ends, and it is
# 3.5 (h/T)^4, at T/24 again 1e-5.
PHASE_OF_A_PIECE = (1920.0 * 1e-5) ** 0.25
PIECES_OF_A_RAMP = 24


def fade_in(t: float, ramp_time: float, ramp: str = "septic", side: int = 1) -> tuple[float, float, float]:
    """Smooth step from 0 to 1 over ramp_time and its two derivatives; three (cubic: one) derivatives vanish at both ends."""
    if t > ramp_time or (t == ramp_time and (side > 0 or ramp_time == 0.0)):
        return 1.0, 0.0, 0.0
    s = t / ramp_time
    if ramp == "cubic":
        return s * s * (3.0 - 2.0 * s), 6.0 * (s - s * s) / ramp_time, (6.0 - 12.0 * s) / ramp_time**2
    value = s**4 * (35.0 - 84.0 * s + 70.0 * s**2 - 20.0 * s**3)
    rate = 140.0 * s**3 * (1.0 - s) ** 3 / ramp_time
    return value, rate, 420.0 * s**2 * (1.0 - s) ** 2 * (1.0 - 2.0 * s) / ramp_time**2


def _sinusoid(part: Motion, t: float, side: int) -> tuple[float, float, float]:
    omega = part.omega
    x = part.amplitude * math.sin(omega * t + part.phase)
    v = part.amplitude * omega * math.cos(omega * t + part.phase)
    a = -omega * omega * x
    r, r1, r2 = fade_in(t, part.ramp_time, part.ramp, side)
    return r * x, r1 * x + r * v, r2 * x + 2.0 * r1 * v + r * a


def _ramp(part: Motion, t: float) -> tuple[float, float, float]:
    """A velocity that rises smoothly by `velocity` within `duration`; the end velocity holds."""
    if t >= part.duration:
        return part.velocity * (t - 0.5 * part.duration), part.velocity, 0.0
    s = t / part.duration
    x = part.velocity * part.duration * s**4 * (2.5 - 3.0 * s + s**2)
    v = part.velocity * s**3 * (10.0 - 15.0 * s + 6.0 * s**2)
    return x, v, part.velocity * 30.0 * s**2 * (1.0 - s) ** 2 / part.duration


def _part(part: Motion, t: float, side: int) -> tuple[float, float, float]:
    local = t - part.start
    if local < 0.0 or (local == 0.0 and side < 0):
        return 0.0, 0.0, 0.0
    if part.stop > 0.0 and (t > part.stop or (t == part.stop and side > 0)):
        return _part(part, part.stop, -1)[0], 0.0, 0.0
    if part.kind == "sinusoid":
        return _sinusoid(part, local, side)
    if part.duration > 0.0:
        return _ramp(part, local)
    return part.velocity * local, part.velocity, 0.0


def _turning(part: Motion) -> float:
    """Time from its start in which a part fades in or changes its velocity."""
    return part.ramp_time if part.kind == "sinusoid" else part.duration if part.kind == "ramp" else 0.0


class _EndMotion:
    """The motion that a scene's [top] or [lower] describes, and the times at which something happens to it."""

    def __init__(self, end: Top | Lower, name: str) -> None:
        self._end = end
        self._splines = _splines(end, name)

    def events(self) -> set[float]:
        """Starts, stops and ends of ramps, and the rows of the table: between two of them position is smooth."""
        found = {row[0] for row in self._end.table}
        for part in self._end.motion:
            of_part = {part.start, part.start + _turning(part)}
            found.update(time for time in of_part if part.stop == 0.0 or time < part.stop)
            if part.stop > 0.0:
                found.add(part.stop)
        return found

    def longest_piece(self, time: float) -> float:
        """Time over which a quintic follows the motion about `time`, s; infinite for steady motion and between rows of a table."""
        found = math.inf
        for part in self._end.motion:
            if time < part.start or (part.stop > 0.0 and time > part.stop):
                continue
            if part.kind == "sinusoid" and part.omega > 0.0 and part.amplitude != 0.0:
                found = min(found, PHASE_OF_A_PIECE / part.omega)
            if time < part.start + _turning(part):
                found = min(found, _turning(part) / PIECES_OF_A_RAMP)
        return found

    def __call__(self, t: float, side: int) -> np.ndarray:
        """Position, velocity and acceleration, (9,)."""
        state = np.zeros(9)
        state[:3] = self._end.position
        for part in self._end.motion:
            k = "xyz".index(part.axis)
            for derivative, value in enumerate(_part(part, t, side)):
                state[3 * derivative + k] += value
        if self._splines:
            first, last = self._end.table[0][0], self._end.table[-1][0]
            at = min(max(t, first), last)
            moving = at == t and not (t == first and side < 0) and not (t == last and side > 0)
            for derivative, spline in enumerate(self._splines[: 3 if moving else 1]):
                state[3 * derivative : 3 * derivative + 3] += spline(at)
        return state


class PrescribedMotion:
    """The motion that a scene's [top], [winch] and [lower] describe, and the times at which something happens to it."""

    def __init__(self, top: Top, winch: Winch | None = None, lower: Lower | None = None) -> None:
        self._ends = (_EndMotion(top, "top"), _EndMotion(lower or Lower(), "lower"))
        self._speeds = np.array(winch.speeds) if winch is not None and winch.speeds else None
        of_winch = set() if self._speeds is None else set(self._speeds[:, 0].tolist())
        self._events = sorted(of_winch.union(*(end.events() for end in self._ends)))

    def events_within(self, start: float, end: float) -> list[float]:
        """Events between two times, without those at them."""
        return self._events[bisect.bisect_right(self._events, start) : bisect.bisect_left(self._events, end)]

    def event_near(self, time: float, near: float) -> float:
        """The event within `near` of a time, or that time."""
        return next(iter(self.events_within(time - near, time + near)), time)

    def longest_piece(self, time: float) -> float:
        """Time over which a quintic follows the motion about `time`, s; infinite for steady motion and between rows of a table."""
        return min(end.longest_piece(time) for end in self._ends)

    def __call__(self, t: float, side: int = 1) -> np.ndarray:
        """The inputs (22,) at a time, in the order of signals.INPUTS.

        Where the motion jumps, `side` +1 takes the limit from after that time and -1 the one from before.
        """
        speed = 0.0 if self._speeds is None else np.interp(t, self._speeds[:, 0], self._speeds[:, 1])
        top, lower = (end(t, side) for end in self._ends)
        return np.concatenate([top, [speed], lower, [0.0, 0.0, 0.0]])


def _splines(end: Top | Lower, name: str) -> list[CubicSpline]:
    """Position, velocity and acceleration of the table over time; none without a table."""
    if not end.table:
        return []
    rows = np.array(end.table)
    if len(rows) < 4 or not np.all(np.diff(rows[:, 0]) > 0.0):
        raise refuse(f"{name}.table", len(rows), "rows", "at least 4 rows of rising time", "Add rows, or sort them by time.")
    spline = CubicSpline(rows[:, 0], rows[:, 1:])
    return [spline, spline.derivative(1), spline.derivative(2)]


def motion_of(scene: Any) -> PrescribedMotion:
    """The motion that a scene describes."""
    return PrescribedMotion(scene.top, scene.winch, scene.lower)
