"""The prescribed motion of the top as a function of time, from the parts that a scene names."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
from scipy.interpolate import CubicSpline

from cable_model.errors import refuse
from cable_model.parameters import Motion, Top, Winch

TopMotion = Callable[..., np.ndarray]  # (time, side=+1) -> (10,): position, velocity, acceleration, winch speed


def fade_in(t: float, ramp_time: float, ramp: str = "septic") -> tuple[float, float, float]:
    """Smooth step from 0 to 1 over ramp_time and its two derivatives; three (cubic: one) derivatives vanish at both ends."""
    if t >= ramp_time:
        return 1.0, 0.0, 0.0
    s = t / ramp_time
    if ramp == "cubic":
        return s * s * (3.0 - 2.0 * s), 6.0 * (s - s * s) / ramp_time, (6.0 - 12.0 * s) / ramp_time**2
    value = s**4 * (35.0 - 84.0 * s + 70.0 * s**2 - 20.0 * s**3)
    rate = 140.0 * s**3 * (1.0 - s) ** 3 / ramp_time
    return value, rate, 420.0 * s**2 * (1.0 - s) ** 2 * (1.0 - 2.0 * s) / ramp_time**2


def _sinusoid(part: Motion, t: float) -> tuple[float, float, float]:
    omega = part.angular_frequency
    x = part.amplitude * math.sin(omega * t + part.phase)
    v = part.amplitude * omega * math.cos(omega * t + part.phase)
    a = -omega * omega * x
    r, r1, r2 = fade_in(t, part.ramp_time, part.ramp)
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
        return _sinusoid(part, local)
    if part.duration > 0.0:
        return _ramp(part, local)
    return part.velocity * local, part.velocity, 0.0


def top_motion(top: Top, winch: Winch | None = None) -> TopMotion:
    """The motion that a scene's [top] and [winch] describe.

    The returned function gives position, velocity, acceleration and the winch's speed, (10,), at a time; where the
    motion jumps, `side` +1 takes the limit from after that time and -1 the one from before.
    """
    position = np.array(top.position)
    splines = None
    speeds = np.array(winch.speeds) if winch is not None and winch.speeds else None
    if top.table:
        rows = np.array(top.table)
        if len(rows) < 4 or not np.all(np.diff(rows[:, 0]) > 0.0):
            raise refuse("top.table", len(rows), "rows", "at least 4 rows of rising time", "Sort the rows by time.")
        splines = [CubicSpline(rows[:, 0], rows[:, 1:]).derivative(k) if k else CubicSpline(rows[:, 0], rows[:, 1:]) for k in range(3)]

    def motion(t: float, side: int = 1) -> np.ndarray:
        state = np.zeros(10)
        state[:3] = position
        for part in top.motion:
            k = "xyz".index(part.axis)
            for derivative, value in enumerate(_part(part, t, side)):
                state[3 * derivative + k] += value
        if splines is not None:
            inside = min(max(t, top.table[0][0]), top.table[-1][0])
            for derivative, spline in enumerate(splines):
                if derivative == 0 or inside == t:
                    state[3 * derivative : 3 * derivative + 3] += spline(inside)
        if speeds is not None:
            state[9] = np.interp(t, speeds[:, 0], speeds[:, 1])
        return state

    return motion
