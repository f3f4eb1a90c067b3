"""What a run tells along the cable: places, tensions and curvature over unstretched length, at moments."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property

import numpy as np


@dataclass(frozen=True)
class Profiles:
    """The cable at moments `times` (k,), s: at points from the lower end to the top, which are the nodes of the model.

    `arc_lengths` (k, n), m, are unstretched, from the lower end; `positions` (k, n, 3), m; `tensions` (k, n), N.
    """

    times: np.ndarray
    arc_lengths: np.ndarray
    positions: np.ndarray
    tensions: np.ndarray

    @cached_property
    def curvatures(self) -> np.ndarray:
        """Curvature (k, n), 1/m, see `curvature`; nodes that have gone from a cable that has parted have that of its end, or 0."""
        nodes = self.positions.shape[1]
        made = np.zeros((len(self.positions), nodes))
        gone = np.sum(self.arc_lengths[:, 1:] == 0.0, axis=1)
        for count in np.unique(gone[gone < nodes - 1]):
            rows = gone == count
            left = curvature(self.positions[rows, count:])
            made[rows] = np.concatenate((np.repeat(left[:, :1], count, axis=1), left), axis=1)
        return made

    def tables(self) -> Iterator[np.ndarray]:
        """A table (n, 7) of each moment, by the columns of facts.PROFILE."""
        for k, time in enumerate(self.times):
            columns = (np.full(len(self.positions[k]), time), self.arc_lengths[k], self.positions[k], self.tensions[k], self.curvatures[k])
            yield np.column_stack(columns)


def curvature(positions: np.ndarray) -> np.ndarray:
    """Curvature (..., n), 1/m, of lines through points (..., n, 3), m, n >= 2; never negative, and that of the cable as it lies, stretched.

    At an inner point |t_2 - t_1| / ((l_1 + l_2)/2), t and l the unit tangents and lengths of the chords before and after it: |dt/ds| by
    differences.  It is exact for equal chords in a circle and of second order where lengths change smoothly, as those of a mesh do; where
    a line turns back on itself it is 2/l for chords l.  At an end, where two chords do not meet, it is led on by the straight line through
    the two points beside it, and not below 0; of three points it is that of the middle one, of two 0.
    """
    chords = np.diff(positions, axis=-2)
    lengths = np.maximum(np.linalg.norm(chords, axis=-1), np.finfo(float).tiny)  # two points in one place have no direction
    turns = np.linalg.norm(np.diff(chords / lengths[..., None], axis=-2), axis=-1)
    inner = turns / (0.5 * (lengths[..., 1:] + lengths[..., :-1]))
    if inner.shape[-1] < 2:
        return np.broadcast_to(inner if inner.shape[-1] else 0.0, positions.shape[:-1]).copy()
    low = inner[..., 0] + lengths[..., 0] / lengths[..., 1] * (inner[..., 0] - inner[..., 1])
    high = inner[..., -1] + lengths[..., -1] / lengths[..., -2] * (inner[..., -1] - inner[..., -2])
    return np.concatenate((np.maximum(low, 0.0)[..., None], inner, np.maximum(high, 0.0)[..., None]), axis=-1)
