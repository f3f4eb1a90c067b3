"""TowCable: Wang's straight cable that swings and stretches, as a model; free initial states for studies and tests."""

from __future__ import annotations

from collections.abc import Mapping
from types import ModuleType
from typing import Any

import numpy as np

from cable_model.effects import PARAMETERS, record
from cable_model.errors import unknown
from cable_model.kernels import header
from cable_model.model import Model
from cable_model.signals import OUTPUTS

SPHERE = 18.0  # tow.body_angle, rad: anything beyond pi selects the drag law of spheres
DEFAULTS = {"solver.time_step": 0.01, "tow.drag_segments": 10.0, "tow.body_angle": SPHERE, "cable.volume_per_length": -1.0}


class TowCable(Model):
    """The two-degree-of-freedom tow model [Wang 1971, corrected]; three degrees of freedom with solver.space.

    Angle: from straight down, positive where the body is at x < x of the top, as in the report.  Validity: a straight cable,
    in the plane y = const unless in space; lateral motion only while drag penetrates most of the length.
    """

    name = "tow"

    @staticmethod
    def kernels() -> ModuleType:
        from cable_model.kernels import tow_step

        return tow_step

    @classmethod
    def from_numbers(cls, p: Mapping[str, float], parts: Any) -> TowCable:
        """A model without a scene, from values by the names of PARAMETERS (SI); what is not given is DEFAULTS' or zero."""
        for name in p:
            if name not in PARAMETERS:
                raise unknown(name, PARAMETERS, "parameter")
        model = cls.__new__(cls)
        model.motion_order = 2
        model.parts = parts
        model.numbers = record(DEFAULTS | dict(p))
        model._calls = model._just_in_time()
        return model

    def set_state(self, angle: float, angular_velocity: float, stretch: float, stretch_velocity: float) -> None:
        """Replace the motion in the plane: angle rad, rad/s, stretch from zero tension m, m/s."""
        from cable_model.kernels import tow

        self.state[[tow.ANGLE, tow.ANGLE_RATE, tow.STRETCH, tow.STRETCH_RATE]] = angle, angular_velocity, stretch, stretch_velocity
        self.state[[header.NEXT_STEP, header.PENDING]] = 0.0
        self._calls.read_outputs()
        self._must(header.OK, self.state[header.TIME])

    def set_motion(self, direction: np.ndarray, turning: np.ndarray, stretch: float, stretch_velocity: float) -> None:
        """Replace the motion in space: unit vector (3,) from the top to the body, its rate 1/s, stretch m and its rate m/s."""
        from cable_model.kernels import tow, tow_space

        self.state[tow_space.DIRECTION : tow_space.STATE_IN_SPACE] = *direction, *turning
        self.state[[tow.STRETCH, tow.STRETCH_RATE]] = stretch, stretch_velocity
        self.state[[header.NEXT_STEP, header.PENDING]] = 0.0
        self._calls.read_outputs()
        self._must(header.OK, self.state[header.TIME])

    @property
    def motion(self) -> np.ndarray:
        """Angle, angular velocity, stretch, stretch velocity in the plane."""
        from cable_model.kernels import tow

        return self.state[tow.ANGLE : tow.ANGLE + 4].copy()

    def __getitem__(self, name: str) -> float:
        return float(self.outputs[OUTPUTS.index(name)])

    def arc_lengths(self) -> np.ndarray:
        return np.array([0.0, self.scene.cable.length])

    def _node_count(self) -> int:
        return 2

    def _measure(self, status: int) -> str:
        return f"status {status}, error {self.state[header.ERROR_SIZE]:.3g}"
