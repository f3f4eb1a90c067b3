"""What lies around a cable in pictures: the bottom and the water's surface between two corners of a box."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from cable_model.effects import BY_NAME, CHAIN
from cable_model.scene import Scene
from cable_model.sea import components, table_of
from cable_model.simulated import is_on
from cable_model.tables import relief

MOST_PLACES = 128  # of the surface at a moment
BED_PLACES = 61  # along each side of a bottom by heights
PER_WAVE = 6.0  # places in the length of the mean wave: fewer would show another one


@dataclass(frozen=True)
class Surface:
    """A surface: places x (k,), y (m,), and heights (moments, m, k), or (1, m, k) where it is still, m."""

    x: np.ndarray
    y: np.ndarray
    heights: np.ndarray

    @property
    def moves(self) -> bool:
        return len(self.heights) > 1

    def at(self, k: int) -> np.ndarray:
        """Heights (m, k) at a moment."""
        heights: np.ndarray = self.heights[k if self.moves else 0]
        return heights


def has(effect: str, scene: Scene) -> bool:
    """Whether the chain simulates an effect in a scene."""
    return is_on(BY_NAME[effect], scene, CHAIN)


def seabed_between(scene: Scene, low: np.ndarray, high: np.ndarray) -> Surface | None:
    """The bottom between two corners, where there is one."""
    if not has("seabed", scene):
        return None
    plane = not has("relief", scene)
    x, y = (np.linspace(low[k], high[k], 2 if plane or (k == 1 and not scene.seabed.grid) else BED_PLACES) for k in (0, 1))
    heights = scene.seabed.level + scene.seabed.slope * np.add.outer(
        y * math.sin(scene.seabed.slope_direction), x * math.cos(scene.seabed.slope_direction)
    )
    if not plane:
        from cable_model.kernels.bottom import shape_at  # imports numba

        table = relief(scene)
        heights = np.array([[shape_at(table, at_x, at_y)[0] for at_x in x.tolist()] for at_y in y.tolist()])
    return Surface(x, y, heights[None])


def surface_between(scene: Scene, times: np.ndarray, low: np.ndarray, high: np.ndarray) -> Surface:
    """The waves as the kernels have them; the still level where there are none, or too short ones for the places at hand."""
    still = Surface(np.array([low[0], high[0]]), np.array([low[1], high[1]]), np.zeros((1, 2, 2)))
    waves = components(scene.waves, scene.environment.gravity, scene.water.depth) if scene.water is not None else None
    if waves is None:
        return still
    steepness = (waves[:, 0] * waves[:, 2]) ** 2
    length = 2.0 * math.pi * math.sqrt(np.sum(waves[:, 0] ** 2) / np.sum(steepness))
    across, along = (1 + math.ceil(PER_WAVE * (high[k] - low[k]) / length) for k in (1, 0))
    x = np.linspace(low[0], high[0], max(along, 9))
    y = np.linspace(low[1], high[1], max(across, 9) if scene.solver.space else 2)
    if len(x) * len(y) > MOST_PLACES:
        return still
    from cable_model.kernels.waves import Ramp, elevation  # imports numba

    ramp = Ramp(float(times[0]), scene.waves.ramp_time)

    def height(at_x: float, at_y: float, time: float) -> float:
        place = (at_x, at_y, 0.0) if scene.solver.space else (at_x, 0.0)
        return float(elevation(table, ramp, place, time)[0])

    table = table_of(waves)
    heights = np.array([[[height(at_x, at_y, t) for at_x in x.tolist()] for at_y in y.tolist()] for t in times.tolist()])
    return Surface(x, y, heights)
