"""What describes a problem: a record of numbers, and which parts are present.  No kernels: it can be read without numba.

A part that a scene does not name is None: numba compiles a kernel without its terms.  Kernels call the numbers `p`, an array of one
record of SI values by name, `p[0].cable.length`; in memory it is one flat vector in the order of PARAMETERS, which C code fills in
the native FMU.
"""

import itertools
from collections.abc import Mapping
from typing import NamedTuple

import numpy as np

INTEGRATORS = {
    "generalized-alpha": 0,
    "backward-difference": 1,
    "trapezoidal": 2,
    "generalized-trapezoidal": 3,
    "cornwell-malkus": 4,
    "wbz": 5,
}
PARAMETERS = (
    "cable.length",
    "cable.diameter",
    "cable.mass_per_length",
    "cable.axial_stiffness",
    "cable.bending_stiffness",
    "cable.axial_damping",
    "cable.normal_drag_coefficient",
    "cable.tangential_drag_coefficient",
    "cable.added_mass_coefficient",
    "cable.volume_per_length",
    "body.mass",
    "body.volume",
    "body.drag_area",
    "body.added_mass",
    "lower_end.x",
    "lower_end.y",
    "lower_end.z",
    "lower_end.release_force",
    "environment.gravity",
    "water.density",
    "solver.nodes",
    "solver.grading",
    "solver.time_step",
    "solver.lambda_infinity",
    "solver.integrator",
    "solver.tolerance",
    "solver.slack_smoothing",
    "solver.slack_damping",
    "tow.poisson_ratio",
    "tow.reference_tension",
    "tow.drag_segments",
    "tow.minimum_tension",
    "tow.added_mass_vertical",
    "tow.drag_area_axial",
    "tow.body_angle",
    "tow.explicit",
    "seabed.level",
    "seabed.stiffness",
    "seabed.damping_ratio",
    "seabed.friction_coefficient",
    "seabed.friction_velocity",
)

_GROUPS = {part: [name.partition(".")[2] for name in names] for part, names in itertools.groupby(PARAMETERS, lambda n: n.partition(".")[0])}
NUMBERS = np.dtype([(part, [(key, np.float64) for key in keys]) for part, keys in _GROUPS.items()], align=True)


def record(values: Mapping[str, float]) -> np.recarray:
    """The numbers of kernels, an array of one record, from values by the names of PARAMETERS (SI); what is not given is 0."""
    flat = np.array([float(values.get(name, 0.0)) for name in PARAMETERS])
    return flat.view(NUMBERS).view(np.recarray)


class Parts(NamedTuple):
    """Which parts a problem has: None is absent, True (or the part's own table) is present."""

    box: object = None  # the paper's box grid instead of the staggered one
    space: object = None  # motion in space instead of one vertical plane
    inextensible: object = None  # box grid only
    slack: object = None  # the cable carries no compression
    bending: object = None
    voigt: object = None  # material (Kelvin-Voigt) axial damping
    body: object = None
    anchor: object = None
    water: object = None
    current: object = None  # table, one row a level: z, velocity x, velocity y; sorted by rising z; end values hold beyond it
    waves: object = None  # table of waves.py, one row a component
    finite_depth: object = None  # of the waves
    stretched: object = None  # waves reach up to the surface as it is: Wheeler's way
    cut: object = None  # or as held, with nothing above it
    seabed: object = None
    friction: object = None  # along the seabed
    winch: object = None  # the cable's length changes at the top
    curve: object = None  # table of the axial law: strain, tension, slope; absent: linear
    cable_mass: object = None  # TowCable only (CBMAS >= 0)
    tension_floor: object = None  # TowCable only (TENS)
    as_printed: object = None  # TowCable only: the report's errors kept
