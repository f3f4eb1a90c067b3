"""The problem as a cell of the staggered grid has it: with the cable, water and constants of its section, where there are sections."""

import math

from cable_model.kernels.choice import by_presence
from cable_model.kernels.jit import kernel
from cable_model.kernels.problem import Cable, Numeric, Problem, cable_of, density_of, own_weight, water_of, with_some_weight
from cable_model.kernels.sections import made_of


@kernel
def presence(present, value):
    """The value, or 0 without the part."""
    if present is None:
        return 0.0
    return value


@kernel
def _as_all(sections, parts, problem, mesh, i):
    return problem


@kernel
def _no_medium(water, made, density):
    return None


@kernel
def _medium(water, made, density):
    return water_of(made, density)


_own_medium = by_presence(_no_medium, _medium)


@kernel
def _as_its_section(sections, parts, problem, mesh, i):
    p, whole = problem.numbers, problem.numeric
    made = made_of(sections, p, mesh, i)
    density = density_of(parts.water, p)
    cable = with_some_weight(cable_of(made, problem.cable.length, density, problem.cable.gravity), whole.rests)
    bending = 0.0
    if parts.bending is not None:
        bending = made.bending_stiffness * (whole.bending / p[0].cable.bending_stiffness)  # statics begin with less
    damping, voigt = presence(parts.slack, wave_damping(p, cable)), presence(parts.voigt, made.axial_damping)
    numeric = Numeric(
        whole.smoothing, whole.hung, own_weight(cable), damping, voigt, bending, whole.pull, whole.tolerance, whole.rounding, whole.blunt,
        whole.turn, whole.rests, whole.stiffest, whole.thinnest,
    )  # fmt: skip
    eased = Cable(
        cable.length, max(cable.diameter, whole.thinnest), cable.mass, min(cable.stiffness, whole.stiffest), cable.gravity, cable.weight
    )
    return Problem(eased, _own_medium(parts.water, made, density), problem.body, numeric, problem.ground, p)


of_cell = by_presence(_as_all, _as_its_section)


@kernel
def wave_damping(p, cable):
    """The slack law's axial damping per cell length, N s/m."""
    return p[0].solver.slack_damping * math.sqrt(cable.stiffness * cable.mass)


@kernel
def _alike(sections, parts, problem, mesh, j):
    return problem.numeric.bending / ((1.0 - mesh[j - 1, 1]) * mesh[j - 1, 0] + mesh[j, 1] * mesh[j, 0])


@kernel
def _in_series(sections, parts, problem, mesh, j):
    low = of_cell(sections, parts, problem, mesh, j - 1).numeric.bending
    up = of_cell(sections, parts, problem, mesh, j).numeric.bending
    soft = (1.0 - mesh[j - 1, 1]) * mesh[j - 1, 0] * up + mesh[j, 1] * mesh[j, 0] * low
    return low * up / soft if soft > 0.0 else 0.0


turn_stiffness = by_presence(_alike, _in_series)  # moment over the turn at inner node j, N m: of the halves of its two cells, in series
