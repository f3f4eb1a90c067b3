"""Softer laws of what statics seek: stages on the way to the laws as they are, each an easy step from the one before.

At ease 1 the cable stretches by its length under its weight, and what is sharp in the laws is smooth: slack, seabed and the water's
surface.  With ease 0 they are as they are.
"""

from cable_model.kernels.jit import kernel
from cable_model.kernels.problem import Cable, Numeric, Problem, thickened
from cable_model.kernels.seabed import Ground

SPREAD = 0.1  # of the weight: width of the slack law, and by length that of the seabed
BLUNT = 0.3  # of a cell: see Numeric.blunt
LEAST_BLUNT = 1e-6  # what is left of it at the end: it lengthens a cell by half its square
TURN = 0.5  # largest change of a cell vector in an iteration
THICK = 0.3  # of the length: over that height the water's surface is spread


@kernel
def eased(problem, ease, blunt, weight, bending, tolerance):
    """The problem with its laws at `ease`, another bending stiffness and Newton's tolerance, m/s; `blunt` 0: Newton's steps as they are."""
    old, cable = problem.numeric, problem.cable
    spread = SPREAD * ease * weight
    numeric = Numeric(
        max(old.smoothing, spread),
        max(old.hung, spread),
        old.own,
        old.damping,
        old.voigt,
        bending,
        old.pull,
        tolerance,
        0.0,
        blunt,
        TURN if blunt > 0.0 else 0.0,
        old.rests,
        weight / ease if ease > 0.0 else 1e300,
        THICK * ease * cable.length,
    )
    stiffness = cable.stiffness
    if ease * stiffness > weight:
        stiffness = weight / ease
    soft = Cable(cable.length, max(cable.diameter, numeric.thinnest), cable.mass, stiffness, cable.gravity, cable.weight)
    return Problem(
        soft,
        problem.medium,
        _soft_body(problem.body, ease, cable.length),
        numeric,
        _soft_ground(problem.ground, ease, weight, cable.length),
        problem.numbers,
    )


@kernel
def _soft_body(body, ease, length):
    if body is None:
        return None
    return thickened(body, THICK * ease * length)


@kernel
def _soft_ground(ground, ease, weight, length):
    if ground is None:
        return None
    stiffness = ground.stiffness
    if ease * length * length * stiffness > weight:
        stiffness = weight / (ease * length * length)
    return Ground(
        ground.level, stiffness, ground.lag, ground.least_lag, ground.friction, ground.grip, ground.drag, ground.laid, ground.body_length,
        max(ground.smoothing, SPREAD * ease * weight / length), ground.sections, ground.weight, ground.density, ground.numbers,
        ground.bodies, SPREAD * ease * weight / length, ground.slope, ground.normal, ground.relief,
    )  # fmt: skip
