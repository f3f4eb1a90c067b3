"""What a cable is made of along its length: the same everywhere, or by sections.

parts.sections is a table, a row a section from the lower end up: its length, then what Made has.  A mesh then has a third column, SECTION:
the row of the section that a cell belongs to; nodes lie on all joints.
"""

from typing import NamedTuple

from cable_model.kernels.choice import by_presence
from cable_model.kernels.jit import kernel

LENGTH, MASS, AREA = 0, 2, 9  # columns of the table
SECTION = 2  # column of the mesh


class Made(NamedTuple):
    """What a section is made of, by the names of a cable's numbers, in the order of the table."""

    diameter: float
    mass_per_length: float
    axial_stiffness: float
    bending_stiffness: float
    axial_damping: float
    normal_drag_coefficient: float
    tangential_drag_coefficient: float
    added_mass_coefficient: float
    volume_per_length: float  # of a section never "that of the diameter"
    breaking_tension: float


@kernel
def row_of(sections, k):
    """What section k is made of."""
    return Made(
        sections[k, 1], sections[k, 2], sections[k, 3], sections[k, 4], sections[k, 5], sections[k, 6], sections[k, 7], sections[k, 8],
        sections[k, 9], sections[k, 10],
    )  # fmt: skip


@kernel
def _alike(sections, p, mesh, i):
    c = p[0].cable
    return Made(
        c.diameter, c.mass_per_length, c.axial_stiffness, c.bending_stiffness, c.axial_damping, c.normal_drag_coefficient,
        c.tangential_drag_coefficient, c.added_mass_coefficient, c.volume_per_length, c.breaking_tension,
    )  # fmt: skip


@kernel
def _by_section(sections, p, mesh, i):
    return row_of(sections, int(mesh[i, SECTION]))


made_of = by_presence(_alike, _by_section)  # what cell i is made of


@kernel
def mesh_columns(sections):
    if sections is None:
        return 2
    return 3


@kernel
def sizes_of_weights(sections, density, gravity):
    """Sum of the sizes of the weights of all sections in water of a density, N."""
    total = 0.0
    for k in range(sections.shape[0]):
        total += abs(sections[k, MASS] - density * sections[k, AREA]) * gravity * sections[k, LENGTH]
    return total
