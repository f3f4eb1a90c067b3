"""Where the nodes are: uniform, graded towards the lower end, or equally spaced in the travel time of transverse waves.

mesh (n-1, 2): unstretched length h of each cell and its split b, the share of it below the image of the cell's midpoint; with sections
(n-1, 3), and the row of the cell's section.
"""

import math

from cable_model.kernels.choice import by_presence
from cable_model.kernels.header import CELLS_OF_A_SECTION
from cable_model.kernels.jit import kernel
from cable_model.kernels.line_bodies import weight_below
from cable_model.kernels.problem import body_weight, cable_of, density_of, total_weight, water_of
from cable_model.kernels.sections import LENGTH, SECTION, row_of

SLOWEST = 0.2  # of the root of the whole weight: next to no tension does not draw all cells


@kernel
def arc_length(xi, grading, length, end_tension, weight):
    """Arc length from the lower end at xi in 0..1: length xi^grading, or with grading 0 equal travel time ds ~ sqrt(T)."""
    if grading >= 1.0:
        return length * xi**grading
    top = end_tension + weight * length
    if weight <= 0.0 or end_tension < 0.0:
        return length * xi
    low, high = end_tension**0.5, top**0.5
    return length * xi * (low + xi * (high - low) + low) / (high + low)  # (root^2 - low^2)/weight, exact for next to no weight too


@kernel
def fill_mesh(mesh, grading, length, end_tension, weight):
    n = mesh.shape[0] + 1
    below = 0.0
    for i in range(n - 1):
        middle = arc_length((i + 0.5) / (n - 1), grading, length, end_tension, weight)
        above = length if i == n - 2 else arc_length((i + 1.0) / (n - 1), grading, length, end_tension, weight)
        mesh[i, 0] = above - below
        mesh[i, 1] = (middle - below) / (above - below)
        below = above


@kernel
def _fill_whole(sections, parts, problem, grading, mesh):
    fill_mesh(mesh, grading, problem.cable.length, body_weight(problem.body), problem.cable.weight)


@kernel
def _travel_time(parts, problem, k, below, grading):
    """That of transverse waves over section k, at whose lower end the tension is `below`, s; or with equal cells what goes with it.

    Under one tension everywhere, as it is between two held ends, it goes with the root of the mass.
    """
    p = problem.numbers
    density = density_of(parts.water, p)
    made, length = row_of(parts.sections, k), parts.sections[k, LENGTH]
    cable = cable_of(made, length, density, problem.cable.gravity)
    heavy = math.sqrt(cable.mass + water_of(made, density).added_mass)
    if grading >= 1.0:
        return heavy * length, cable.weight
    roots = math.sqrt(abs(below)) + math.sqrt(abs(below + cable.weight * length))
    return 2.0 * heavy * length / max(roots, SLOWEST * math.sqrt(total_weight(parts, p))), cable.weight


@kernel
def _travel(parts, problem, k, grading):
    """Travel time from the lower end to the end of section k, and the tension and the weight of a metre at the section's lower end."""
    density, gravity = density_of(parts.water, problem.numbers), problem.cable.gravity
    passed = 0.0
    weight = 0.0
    below = body_weight(problem.body)
    for i in range(k + 1):
        if i > 0:
            below += weight * parts.sections[i - 1, LENGTH]
        below += weight_below(parts.line_bodies, i, density, gravity)
        time, weight = _travel_time(parts, problem, i, below, grading)
        passed += time
    return passed, below, weight


@kernel
def _fill_sections(sections, parts, problem, grading, mesh):
    """Nodes on every joint; each section has cells by its travel time, at least CELLS_OF_A_SECTION, in its own grading."""
    cells, last = mesh.shape[0], sections.shape[0] - 1
    total, _, _ = _travel(parts, problem, last, grading)
    first = 0
    for k in range(last + 1):
        passed, below, weight = _travel(parts, problem, k, grading)
        beyond = int(cells * passed / total + 0.5)
        beyond = min(max(beyond, first + CELLS_OF_A_SECTION), cells - CELLS_OF_A_SECTION * (last - k))
        if k == last:
            beyond = cells
        own = mesh[first:beyond]
        fill_mesh(own, grading, sections[k, LENGTH], below, weight)
        for i in range(own.shape[0]):
            own[i, SECTION] = k
        first = beyond


fill = by_presence(_fill_whole, _fill_sections)  # the cells of a cable on the staggered grid


@kernel
def _two_cells(sections):
    return 3


@kernel
def _cells_of_all(sections):
    return CELLS_OF_A_SECTION * sections.shape[0] + 1


fewest_nodes = by_presence(_two_cells, _cells_of_all)  # nodes that a mesh has at least
