"""What the tests of parting share: a mooring, a string, and what effects they have."""

import numpy as np
from chain_support import make

MAY_PART = {"breaking_tension": 1e12}  # a cable that may and does not: its kernels are those of one that is let go
MOORING = {  # 100 m of light chain between a float and an anchor to its side
    "cable": {
        "length": 100.0, "mass_per_length": 4.0, "axial_stiffness": 2e6, "diameter": 0.04, "normal_drag_coefficient": 1.5,
        "added_mass_coefficient": 1.0, **MAY_PART,
    },
    "water": {"surface": False},
    "lower_end": {"anchored": True, "x": -60.0, "z": -70.0},
    "solver": {"nodes": 31, "time_step": 0.02, "lambda_infinity": -0.5},
}  # fmt: skip
SECTIONS = [
    {"length": 40.0, "mass_per_length": 9.0}, {"length": 30.0, "mass_per_length": 2.0, "axial_stiffness": 1e6}, {"length": 30.0},
]  # fmt: skip
STRING = {  # a straight one under 1000 N that nothing weighs down, whose waves run at 316 m/s
    "cable": {"length": 100.0, "mass_per_length": 1.0, "axial_stiffness": 1e5, "compressible": True, **MAY_PART},
    "environment": {"gravity": 0.0},
    "lower_end": {"anchored": True, "z": -101.0},
    "solver": {"nodes": 101, "grading": 1.0, "time_step": 1e-3, "lambda_infinity": -0.5},
}
PULL, SPEED = 1000.0, np.sqrt(1e5)
IMPACT = PULL / np.sqrt(1e5)  # m/s, of an end from which the pull falls off

KINDS = {
    "chain in drag": {},
    "bending, in space, in a current": {
        "cable__bending_stiffness": 2e3, "solver__space": True, "current__speed": 0.8, "current__direction": 0.7,
    },
    "friction on a seabed": {
        "cable__length": 120.0, "lower_end__x": -80.0, "lower_end__z": -60.0, "seabed__level": -60.0, "seabed__stiffness": 1e5,
        "seabed__friction_coefficient": 0.2,
    },
}  # fmt: skip
SLOW_KINDS = {
    "sections and a float": {"section": True},
    "steps by a tolerance": {"solver__tolerance": 1e-3, "cable__axial_damping": 1e5},
    "audited": {"solver__audit": True},
}


def mooring(kind, **changes):
    changes = {**KINDS, **SLOW_KINDS}[kind] | changes
    if not changes.pop("section", False):
        return make(MOORING, **changes)
    common = {name: value for name, value in MOORING["cable"].items() if name != "length"}
    cable = {**common, "section": SECTIONS, "body": [{"at": 70.0, "mass": 100.0, "volume": 0.3}]}
    return make({**MOORING, "cable": cable}, **changes)


def drifting(t):
    """A top that moves off ever faster along x."""
    return np.array([0.5 * t**3, 0.0, 0.0, 1.5 * t**2, 0.0, 0.0, 3.0 * t, 0.0, 0.0])
