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
    """The table of kernels.waves."""
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
