"""The tables that kernels get with a part, made from a scene."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from cable_model.sea import components, table_of
from cable_model.sections import pieces


def current(scene: Any) -> np.ndarray:
    """Rows of z, velocity x, velocity y (m, m/s), sorted by rising z."""
    given = scene.current
    rows = sorted(given.levels or ((0.0, given.speed, given.direction),))
    return np.array([[z, speed * math.cos(direction), speed * math.sin(direction)] for z, speed, direction in rows])


def current_over_time(scene: Any) -> np.ndarray:
    """Rows of time, z, velocity x, velocity y (s, m, m/s), sorted by time and rising z."""
    rows = sorted(scene.current.table)
    return np.array([[time, z, speed * math.cos(direction), speed * math.sin(direction)] for time, z, speed, direction in rows])


def waves(scene: Any) -> np.ndarray | None:
    """The table of kernels.wave_sums."""
    rows = components(scene.waves, scene.environment.gravity, scene.water.depth)
    return None if rows is None else table_of(rows)


def stiffness_curve(scene: Any) -> np.ndarray:
    """Rows of strain, tension (N) and slope (N) of a monotone cubic interpolation."""
    from scipy.interpolate import PchipInterpolator  # here only: other FMUs do without scipy

    rows = np.array(scene.cable.stiffness_curve)
    slopes = PchipInterpolator(rows[:, 0], rows[:, 1]).derivative()(rows[:, 0])
    secants = np.diff(rows[:, 1]) / np.diff(rows[:, 0])
    slopes[0] = max(slopes[0], 0.1 * secants[0])
    slopes[-1] = max(slopes[-1], 0.1 * secants[-1])
    return np.ascontiguousarray(np.column_stack((rows, slopes)))


def _slopes(x: np.ndarray, z: np.ndarray) -> np.ndarray:
    """Slopes of piecewise cubics that rise and fall only where the points do, along the last axis (Fritsch and Butland, 1984)."""
    secants, h = np.diff(z) / np.diff(x), np.diff(x)
    one, two = secants[..., :-1], secants[..., 1:]
    before, after = 2.0 * h[1:] + h[:-1], h[1:] + 2.0 * h[:-1]
    bent = np.where(one * two > 0.0, one * two, 0.0)
    inner = (before + after) * bent / np.where(bent > 0.0, before * two + after * one, 1.0)
    return np.concatenate((secants[..., :1], inner, secants[..., -1:]), axis=-1)


def relief(scene: Any) -> np.ndarray:
    """Rows of x, y, height (m), its slopes by x and by y and the slope of one by the other (1/m); first how many places there are along y.

    They are sorted by x, then by y; a profile has one place along y.
    """
    rows = sorted(scene.seabed.grid or ((x, 0.0, z) for x, z in scene.seabed.profile))
    x, y = (np.array(sorted({row[k] for row in rows})) for k in (0, 1))
    z = np.array([row[2] for row in rows]).reshape(len(x), len(y))
    by_x = _slopes(x, z.T).T
    by_y = twist = np.zeros_like(z)
    if len(y) > 1:
        by_y = _slopes(y, z)
        twist = 0.5 * (_slopes(y, by_x) + _slopes(x, by_y.T).T)  # of either order: x and y are alike
    places = np.array([row[:2] for row in rows])
    table = np.column_stack((places, *(each.ravel() for each in (z, by_x, by_y, twist))))
    return np.vstack((np.array([[float(len(y)), 0.0, 0.0, 0.0, 0.0, 0.0]]), table))


def sections(scene: Any) -> np.ndarray:
    """Rows of kernels.sections: the length and what it is made of, from the lower end up."""
    return np.array([
        [
            row.length, row.diameter, row.mass_per_length, row.axial_stiffness, row.bending_stiffness, row.axial_damping,
            row.normal_drag_coefficient, row.tangential_drag_coefficient, row.added_mass_coefficient, row.displaced_area,
            row.breaking_tension,
        ]
        for row in pieces(scene.cable)[0]
    ])  # fmt: skip


def line_bodies(scene: Any) -> np.ndarray:
    """Rows of kernels.line_bodies: the piece of cable above a body, and what it is."""
    _, above = pieces(scene.cable)
    rows = zip(above, scene.cable.body, strict=True)
    return np.array([[float(k), body.mass, body.volume, body.drag_area, body.added_mass] for k, body in rows])
