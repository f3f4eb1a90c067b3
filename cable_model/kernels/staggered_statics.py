"""Static equilibrium of the chain on the staggered grid."""

import math

from cable_model.kernels import header
from cable_model.kernels.choice import by_presence
from cable_model.kernels.easing import BLUNT, LEAST_BLUNT, eased
from cable_model.kernels.family import Coefficients
from cable_model.kernels.jit import kernel
from cable_model.kernels.line_bodies import sizes_of_bodies
from cable_model.kernels.mesh import fewest_nodes, fill
from cable_model.kernels.path import Ends
from cable_model.kernels.problem import body_mass, total_weight
from cable_model.kernels.seabed import lay_out
from cable_model.kernels.staggered_chain import unwound
from cable_model.kernels.staggered_guess import refine, rest
from cable_model.kernels.staggered_step import cut_scratch, keep_tensions, newton_step
from cable_model.kernels.vector import load, norm, store, zero

PLAIN_STEPS = 150  # pseudo-steps with the laws as they are, before they are eased
EASED_STEPS = 1500  # and with eased laws, over all meshes
FIRST_BENDING = 1e-3  # of W h^2: bending that moves no node of the hanging chain by much of a cell
BENDING_FACTOR = 4.0  # the next bending stiffness over one whose equilibrium is found
EASE_FACTOR = 0.25  # the next ease over one whose equilibrium is found
LEAST_EASE = 1e-4  # from which the laws as they are come next
COARSE = 33  # nodes of the first mesh with eased laws
LOOSE = 1e-4  # of the length: to which a stage is solved that is not the last
SETTLED = 10.0  # sqrt(L/g): a pseudo-step that long, with few iterations, is an equilibrium near enough to go on from
FEW_ITERATIONS = 5
LEFT = 1e-9  # of the weight over the mass: the acceleration that is left to a node where the laws had to be eased
UPRIGHT = 0.01  # of the weight: mean pressure of a cable that stands on its top
SLACK = 1e-6  # of the weight: less tension is none, and as much of an acceleration is left to a cable that may lie in many ways


@kernel
def equilibrium(parts, problem, p, grading, mesh, y, yd, contraction, y1, yd1, force, top, anchor, time, s):
    """Static equilibrium by pseudo-transient continuation: backward differences from rest with ever longer steps.

    A loop with bending may be in equilibrium in several shapes.  Found is the one that the hanging chain reaches as EI grows from next to
    nothing to its value: a large step at once may end in another, or in a fold between two cells.
    Where that leads nowhere, the laws are eased, see easing.py, on a coarse mesh first; `grading` is that of the mesh.
    """
    n = mesh.shape[0] + 1
    weight = total_weight(parts, p)
    _, on_line = sizes_of_bodies(parts.line_bodies, 0.0, 0.0)
    mass = problem.cable.mass * problem.cable.length + body_mass(problem.body) + on_line
    rest(anchor, parts, problem, weight, mesh, y, yd, force, top)
    lay_out(parts.friction, problem.ground, mesh, anchor, top, s.contact)
    period = math.sqrt(problem.cable.length / max(problem.cable.gravity, 1e-3))
    step = 0.03 * period
    backward = Coefficients(0.0, 0.0, 1.0)
    still = Ends(zero(top), zero(top))
    goal = problem.numeric.bending
    stiff = _first_bending(parts.bending, weight, problem, n - 1)
    ease = 0.0
    easing = False
    failed = 0
    nodes = n
    stuck = False
    for trial in range(PLAIN_STEPS + EASED_STEPS):
        if not easing and (stuck or trial == PLAIN_STEPS):
            easing = True
            ease = 1.0
            step = period
            nodes = min(n, max(COARSE, fewest_nodes(parts.sections)))
            fill(parts.sections, parts, problem, grading, mesh[: nodes - 1])
            rest(anchor, parts, problem, weight, mesh[: nodes - 1], y, yd, force, top)
            _lay_again(parts, problem, mesh[: nodes - 1], anchor, top, s)
            stiff = _first_bending(parts.bending, weight, problem, nodes - 1)
        now = cut_scratch(s.whole, nodes, top)
        close = (LOOSE if ease > 0.0 else 1e-10) * problem.cable.length / step  # positions to 1e-10 of the length
        to_place = eased(problem, ease, BLUNT * ease + LEAST_BLUNT if easing else 0.0, weight, stiff, close)
        contraction[0] = 0.0  # steps differ too much to learn from one another
        status = newton_step(
            parts, to_place, mesh[: nodes - 1], y[: 2 * nodes], yd[: 2 * nodes], yd[: 2 * nodes], backward, time, step, top, still,
            unwound(problem), contraction, y1[: 2 * nodes], yd1[: 2 * nodes], force[: nodes - 1], force[: nodes - 1], 0.0, now,
        )  # fmt: skip
        if status < 0:
            step *= 0.2
            failed = 2
            stuck = step < 1e-9 * period
            if stuck and easing:
                return header.NO_EQUILIBRIUM
            continue
        keep_tensions(parts, to_place, mesh[: nodes - 1], force[: nodes - 1], now)
        for i in range(nodes - 1):
            store(y, i, load(y1, i, top))
        settled = step >= SETTLED * period and status <= FEW_ITERATIONS
        balanced = easing and step >= period and _unbalanced(y1, force, nodes, weight, top) * mass < weight * step
        if ease > 0.0 and settled:
            ease = EASE_FACTOR * ease if ease > LEAST_EASE else 0.0
            step = period
            continue
        if stiff < goal and settled:
            stiff = min(goal, BENDING_FACTOR * stiff)
            step = period
            continue
        found = balanced or (step >= 1e5 * period and status <= 4)
        if ease == 0.0 and stiff >= goal and (found or (nodes < n and settled)):
            if nodes == n:
                if not (_buckled(parts.slack, parts, force, weight) or _upside_down(parts.surface, parts, mesh, force, weight)):
                    return header.OK
                if easing:
                    return header.NO_EQUILIBRIUM
                stuck = True
                continue
            refine(parts, problem, grading, nodes - 1, min(2 * nodes - 1, n), mesh, y, force, y1, yd1, top)
            nodes = min(2 * nodes - 1, n)
            _lay_again(parts, problem, mesh[: nodes - 1], anchor, top, s)
            step = period
            continue
        failed -= 1
        step = min(step * (4.0 if status <= 6 and not (easing and failed > 0) else 1.5), 1e6 * period)
    return header.NO_EQUILIBRIUM


@kernel
def _buckled(slack, parts, force, weight):
    """Whether cells that can be pressed are, by more than any weight could press them: a column, which tips over at a touch."""
    if slack is not None or parts.bending is not None:
        return False
    least = 0.0
    for i in range(force.shape[0]):
        least = min(least, force[i])
    return least < -weight


@kernel
def _never(surface, parts, mesh, force, weight):
    return False


@kernel
def _stands(surface, parts, mesh, force, weight):
    if parts.slack is not None or parts.anchor is not None:
        return False
    pull = 0.0
    for i in range(mesh.shape[0]):
        pull += mesh[i, 0] * force[i]
    total = 0.0
    for i in range(mesh.shape[0]):
        total += mesh[i, 0]
    return pull < -UPRIGHT * weight * total


# whether a cable with a free end stands on its top, a float in the air: turned as a whole it falls where the integral of the tension is
# negative, which is the moment of all loads per radian
_upside_down = by_presence(_never, _stands)


@kernel
def _lay_again(parts, problem, mesh, anchor, top, s):
    """What friction measures from, where the mesh is another."""
    lay_out(parts.friction, problem.ground, mesh, anchor, top, cut_scratch(s.whole, mesh.shape[0] + 1, top).contact)


@kernel
def _unbalanced(y, force, n, weight, top):
    """The largest velocity of a node over the acceleration, in units of the weight over the mass, that may be left to it."""
    largest = 0.0
    below = 0.0
    for i in range(n):
        above = force[i] if i < n - 1 else below
        allowed = LEFT if max(below, above) > SLACK * weight else SLACK
        below = above
        largest = max(largest, norm(load(y, n + i, top)) / allowed)
    return largest


@kernel
def _first_bending(bending, weight, problem, cells):
    if bending is None:
        return problem.numeric.bending
    cell = problem.cable.length / cells
    return min(problem.numeric.bending, FIRST_BENDING * weight * cell * cell)
