"""How a prescribed motion is handed to a model: output steps up to the end of a run, in pieces that follow the motion.

Within a piece a model's top moves on the quintic through position, velocity and acceleration at both ends, and its winch turns at a
speed that is linear in time.  Both are exact, or as good as exact, only while nothing happens within a piece.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable, Iterator
from typing import NamedTuple

import numpy as np

from cable_model.motion import MotionLike, PrescribedMotion

ROUNDING = 1e-9  # of a step: times that are closer are the same


class OutputStep(NamedTuple):
    """The time between two rows of a record, s; `length` is the output step itself, without the rounding of its ends."""

    start: float
    end: float
    length: float


class Piece(NamedTuple):
    """A call of Model.advance: start s, length s, and the inputs at both ends, (22,) each."""

    time: float
    length: float
    first: np.ndarray
    last: np.ndarray


def output_steps(duration: float, step: float) -> list[OutputStep]:
    """The steps n step ... (n + 1) step of a run; the last one ends at `duration`, and is shorter where `step` is no divisor of it."""
    whole = math.floor(duration / step * (1.0 + 1e-12) + ROUNDING)
    steps = [OutputStep(k * step, (k + 1) * step, step) for k in range(whole)]
    if not steps or duration - whole * step > ROUNDING * step:
        return [*steps, OutputStep(whole * step, duration, duration - whole * step)]
    return [*steps[:-1], steps[-1]._replace(end=duration)]


def pieces(motion: MotionLike, output: OutputStep, time_step: float) -> Iterator[Piece]:
    """The pieces of an output step for a solver of that internal step: broken where the motion has events, divided where it is fast.

    Division keeps the internal steps that the whole would have, and never cuts one: what those do not resolve is the scene's own
    choice.  A motion that is a plain function has no events that are known, and is taken to be slow.
    """
    known = motion if isinstance(motion, PrescribedMotion) else None
    near = max(ROUNDING * min(output.length, time_step), 4.0 * math.ulp(output.end))
    events = known.events_within(output.start + near, output.end - near) if known else []
    for start, end in itertools.pairwise([output.start, *events, output.end]):
        length = end - start if events else output.length
        count = math.ceil(length / time_step - ROUNDING)
        longest = min(length, known.longest_piece(0.5 * (start + end))) if known else length
        together = max(1, math.floor(longest / length * count + ROUNDING))
        cuts = [start + length * (k / count) for k in range(together, count, together)]
        for a, b in itertools.pairwise([start, *cuts, end]):
            yield Piece(a, b - a if cuts else length, *_ends(motion, a, b, near))


def _ends(motion: MotionLike, start: float, end: float, near: float) -> tuple[np.ndarray, np.ndarray]:
    """The motion just after the start and just before the end; an event that rounding has put beside them is at them."""
    if isinstance(motion, PrescribedMotion):
        start, end = motion.event_near(start, near), motion.event_near(end, near)
    return motion(start, 1), motion(end, -1)


Advance = Callable[[float, float, np.ndarray, np.ndarray], None]


def follow(advance: Advance, motion: MotionLike, output: OutputStep, time_step: float) -> None:
    """Advance a model (its method `advance`) over an output step along the motion."""
    for piece in pieces(motion, output, time_step):
        advance(*piece)
