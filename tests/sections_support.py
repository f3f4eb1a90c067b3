"""Cables in sections and with bodies on them: their parts, and elastic catenaries one after the other."""

from __future__ import annotations

import numpy as np
from scipy.optimize import fsolve

from cable_model.sections import pieces

GRAVITY, DENSITY = 9.80665, 1025.0
WET = {"density": DENSITY, "surface": False}
CHAIN = {
    "length": 150.0, "mass_per_length": 100.0, "axial_stiffness": 8e8, "diameter": 0.1, "volume_per_length": 0.0127,
    "normal_drag_coefficient": 2.0, "added_mass_coefficient": 1.0,
}  # fmt: skip
ROPE = {
    "length": 250.0, "mass_per_length": 6.0, "axial_stiffness": 2e6, "diameter": 0.08, "normal_drag_coefficient": 1.2,
    "added_mass_coefficient": 1.0,
}  # fmt: skip
UPPER = {**CHAIN, "length": 80.0, "mass_per_length": 80.0, "axial_stiffness": 6e8, "diameter": 0.09, "volume_per_length": 0.0102}
WIRE = {"length": 300.0, "mass_per_length": 6.0, "axial_stiffness": 2e7, "diameter": 0.05, "normal_drag_coefficient": 1.2}
FLOAT, CLUMP = {"mass": 300.0, "volume": 1.5, "drag_area": 1.0, "added_mass": 500.0}, {"mass": 3000.0, "volume": 0.4}


def weights(cable) -> tuple[list[tuple[float, float, float]], list[float]]:
    """Rows of weight in water (N/m), stiffness and length of the pieces from the lower end up, and the body's weight below each, N."""
    rows, above = pieces(cable)
    below = [0.0] * (len(rows) + 1)
    for k, body in zip(above, cable.body, strict=True):
        below[k] += (body.mass - DENSITY * body.volume) * GRAVITY
    made = [((row.mass_per_length - DENSITY * row.displaced_area) * GRAVITY, row.axial_stiffness, row.length) for row in rows]
    return made, below


def catenary(cable, guess: tuple[float, float], span: float, rise: float) -> tuple[float, float, float, list[tuple[float, float]]]:
    """Horizontal force, vertical ones at the lower end and the top, and the joints, of elastic catenaries one after the other [Irvine]."""
    made, below = weights(cable)

    def ends(unknown: np.ndarray) -> tuple[float, float, float, list[tuple[float, float]]]:
        h, v = unknown
        x, z, joints = 0.0, 0.0, []
        for (weight, stiffness, length), hung in zip(made, below, strict=False):
            v = v + hung
            up = v + weight * length
            x += h * length / stiffness + h / weight * (np.arcsinh(up / h) - np.arcsinh(v / h))
            z += (np.hypot(h, up) - np.hypot(h, v)) / weight + (up * up - v * v) / (2.0 * weight * stiffness)
            v = up
            joints.append((x, z))
        return x, z, v, joints

    found, _, status, text = fsolve(lambda u: np.array(ends(u)[:2]) - (span, rise), guess, xtol=1e-13, full_output=True)
    assert status == 1, text
    _, _, up, joints = ends(found)
    return found[0], found[1], up, joints


MOORINGS = {
    "chain, rope, chain": ({"section": [CHAIN, ROPE, UPPER]}, 420.0, 180.0),
    "a float on a line": ({**WIRE, "body": [{"at": 120.0, **FLOAT}]}, 150.0, 150.0),
    "a clump on a line": ({**WIRE, "body": [{"at": 120.0, **CLUMP}]}, 230.0, 150.0),
    "chain and rope with a float above their joint": (
        {"section": [{**CHAIN, "length": 100.0}, ROPE], "body": [{"at": 140.0, **FLOAT}, {"at": 140.0, "mass": 20.0}]}, 250.0, 190.0,
    ),
}  # fmt: skip
BUOY = {"at": 40.0, "mass": 100.0, "volume": 0.5, "drag_area": 0.5, "added_mass": 150.0}
