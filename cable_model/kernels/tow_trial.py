"""Trials of the tow model's stretch at rest."""

import math
from typing import NamedTuple

from cable_model.kernels.choice import by_presence
from cable_model.kernels.jit import kernel


class Search(NamedTuple):
    """Of a stretch at rest: what is too short and too long, and the last trial, with the gap that it left."""

    low: float
    high: float
    last: float
    gap: float


@kernel
def no_trial():
    return Search(-math.inf, math.inf, math.nan, math.nan)


@kernel
def _straight_on(surface, u, gap, search):
    return u + gap, search


@kernel
def _between(surface, u, gap, search):
    """By the secant within what is known: the surface may be stiffer than the cable, so that going on by the gap leads away."""
    low = max(search.low, u) if gap > 0.0 else search.low
    high = min(search.high, u) if gap < 0.0 else search.high
    ahead = u + gap
    if (gap - search.gap) * (u - search.last) < 0.0:
        ahead = u - gap * (u - search.last) / (gap - search.gap)
    if not low < ahead < high and high - low < math.inf:
        ahead = 0.5 * (low + high)
    return ahead, Search(low, high, u, gap)


next_stretch = by_presence(_straight_on, _between)  # after a trial that left `gap` between what the load stretches and u, and the search
