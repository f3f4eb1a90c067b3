"""Bodies on the cable between its ends, each on a node where two sections meet: a clump weight, a float.

parts.line_bodies is a table, a row a body: the section above it, then what Hung has.  Each body is as the one on the lower end.
"""

from typing import NamedTuple

from cable_model.kernels.choice import by_presence
from cable_model.kernels.jit import kernel
from cable_model.kernels.sections import SECTION

ABOVE, MASS, VOLUME = 0, 1, 2  # columns of the table


class Hung(NamedTuple):
    """What a body is, by the names of the numbers of the one on the lower end, in the order of the table."""

    mass: float
    volume: float
    drag_area: float
    added_mass: float


@kernel
def row_of(bodies, j):
    return Hung(bodies[j, 1], bodies[j, 2], bodies[j, 3], bodies[j, 4])


@kernel
def _none(bodies, k, density, gravity):
    return 0.0


@kernel
def _weight_below(bodies, k, density, gravity):
    total = 0.0
    for j in range(bodies.shape[0]):
        if int(bodies[j, ABOVE]) == k:
            total += (bodies[j, MASS] - density * bodies[j, VOLUME]) * gravity
    return total


weight_below = by_presence(_none, _weight_below)  # in water of a density of the bodies at the lower end of section k, N


@kernel
def joint(mesh, i):
    """The section that begins at node i, or -1 where none does, and at the lower end."""
    if i == 0 or mesh[i, SECTION] == mesh[i - 1, SECTION]:
        return -1
    return int(mesh[i, SECTION])


@kernel
def _no_mass(bodies, mesh, i):
    return 0.0


@kernel
def _mass_on(bodies, mesh, i):
    total = 0.0
    section = joint(mesh, i)
    if section >= 0:
        for j in range(bodies.shape[0]):
            if int(bodies[j, ABOVE]) == section:
                total += bodies[j, MASS]
    return total


mass_on = by_presence(_no_mass, _mass_on)  # of the bodies on node i, kg


@kernel
def _no_weight(bodies, mesh, i, density, gravity):
    return 0.0


@kernel
def _weight_on(bodies, mesh, i, density, gravity):
    section = joint(mesh, i)
    return weight_below(bodies, section, density, gravity) if section >= 0 else 0.0


weight_on = by_presence(_no_weight, _weight_on)  # of the bodies on node i, N


@kernel
def _no_sizes(bodies, density, gravity):
    return 0.0, 0.0


@kernel
def _sizes(bodies, density, gravity):
    weight = 0.0
    mass = 0.0
    for j in range(bodies.shape[0]):
        weight += abs(bodies[j, MASS] - density * bodies[j, VOLUME]) * gravity
        mass += bodies[j, MASS]
    return weight, mass


sizes_of_bodies = by_presence(_no_sizes, _sizes)  # the sizes of their weights, N, and their masses, kg, in sum
