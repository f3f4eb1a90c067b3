"""What the cost cases change in the scenes that they are run on: a free chain, a wire and a tow that every code can simulate."""

from __future__ import annotations

import math
from collections.abc import Mapping

HEAVE = [{"kind": "sinusoid", "axis": "z", "amplitude": 1.0, "angular_frequency": 0.2 * math.pi, "ramp_time": 10.0}]
SHIFT, SHIFT_TIME = 1e-3, 2.2  # m, s: of the free chain's top, which then stands still
SHIFTED: Mapping[str, object] = {
    "cable.bending_stiffness": 0.0, "lower_end.release_force": 0.0, "run.output_step": 0.1,
    "top.motion": [
        {"kind": "sinusoid", "axis": "x", "amplitude": SHIFT, "angular_frequency": 0.0, "phase": 0.5 * math.pi, "ramp_time": SHIFT_TIME}
    ],
}  # fmt: skip
CIRCLE: Mapping[str, object] = {"cable.bending_stiffness": 0.0, "current.levels": (), "run.duration": 690.0}
WIRE: Mapping[str, object] = {
    "water.surface": False,  # the heaving top of the other codes' wire stays in water
    "cable.axial_damping": 0.0,
    "top.motion": HEAVE,
    "run.duration": 60.0,
    "run.output_step": 0.1,
    "solver.lambda_infinity": -0.9,
}
