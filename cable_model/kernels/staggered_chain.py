"""Static equilibrium, starting rates and outputs of the chain on the staggered grid."""

import math

from cable_model.kernels import header
from cable_model.kernels.family import Coefficients
from cable_model.kernels.jit import kernel
from cable_model.kernels.mesh import fill_mesh
from cable_model.kernels.problem import body_weight, total_weight
from cable_model.kernels.seabed import under_body
from cable_model.kernels.slack import floor, width
from cable_model.kernels.staggered import add_seabed, assemble, bent
from cable_model.kernels.staggered_step import Gains, Winding, keep_tensions, newton_step, with_bending, with_tolerance
from cable_model.kernels.staggered_surface import lower_end_terms, lower_weight
from cable_model.kernels.vector import axpy, dot, load, norm, scale, store, store_from, sub, upward, zero

STATIC_STEPS = 400
FIRST_BENDING = 1e-3  # of W h^2: bending that moves no node of the hanging chain by much of a cell
BENDING_FACTOR = 4.0  # the next bending stiffness over one whose equilibrium is found
SETTLED = 10.0  # sqrt(L/g): a pseudo-step that long, with few iterations, is an equilibrium near enough to go on from
FEW_ITERATIONS = 5


@kernel
def place_nodes(anchor, problem, grading, mesh):
    """Uniform by default between two held ends, by travel time above a lower end that hangs."""
    below = body_weight(problem.body)
    weight = problem.cable.weight
    if anchor is not None:
        fill_mesh(mesh, max(grading, 1.0), problem.cable.length, below, weight)
    else:
        fill_mesh(mesh, grading, problem.cable.length, below, weight)


@kernel
def _first_guess(anchor, problem, scale_force, mesh, y, force, top):
    """The catenary under weight and pull alone, cell by cell; between two held ends a V of two straight legs."""
    n = mesh.shape[0] + 1
    pull = problem.numeric.pull
    load_below = body_weight(problem.body)
    total = load_below + problem.cable.weight * problem.cable.length
    sign = 1.0 if total >= 0.0 else -1.0
    for i in range(n - 1):
        hanging = load_below + problem.cable.weight * mesh[i, 1] * mesh[i, 0]
        load_below += problem.cable.weight * mesh[i, 0]
        if sign * hanging < 0.0:
            hanging = 0.0
        size = math.sqrt(hanging * hanging + pull * pull)
        force[i] = max(size, 1e-3 * scale_force)
        stretch = 1.0 + size / problem.cable.stiffness
        if size > 0.0:
            store(y, i, along_x(-pull * stretch / size, upward(hanging * stretch / size, top)))
        else:
            store(y, i, upward(sign, top))
    _bend_guess(anchor, mesh, y, top)


@kernel
def along_x(size, a):
    """The vector a with its first component set."""
    if len(a) == 2:
        return (size, a[1])
    return (size, a[1], a[2])


@kernel
def _bend_guess(anchor, mesh, y, top):
    if anchor is None:
        return
    n = mesh.shape[0] + 1
    length = 0.0
    for i in range(n - 1):
        length += mesh[i, 0]
    chord = sub(top, anchor)
    rise = chord[len(top) - 1]
    level = axpy(-1.0, upward(rise, top), chord)
    across = norm(level)
    if dot(chord, chord) >= length * length or across < 1e-9 * length:
        for i in range(n - 1):
            store(y, i, scale(1.0 / length, chord))
        return
    # legs a below the anchor and b below the top: horizontal runs share the chord, both at the same slope
    drop = math.sqrt(length * length - across * across)
    first = 0.5 * (1.0 - rise / drop) * length
    ahead = scale(1.0 / length, level)
    gone = 0.0
    for i in range(n - 1):
        # exact lengths: a cell that holds the kink is bent into its mean direction
        down = min(max((first - gone) / mesh[i, 0], 0.0), 1.0)
        store(y, i, axpy(1.0, upward((1.0 - 2.0 * down) * drop / length, top), ahead))
        gone += mesh[i, 0]


@kernel
def unwound(problem):
    """The winding of a cable whose length does not change."""
    return Winding(problem.cable.length, 0.0, 0.0)


@kernel
def equilibrium(parts, problem, p, mesh, y, yd, contraction, y1, yd1, force, top, anchor, time, s):
    """Static equilibrium by pseudo-transient continuation: backward differences from rest with ever longer steps.

    A loop with bending may be in equilibrium in several shapes.  Found is the one that the hanging chain reaches as EI grows from next to
    nothing to its value: a large step at once may end in another, or in a fold between two cells.
    """
    n = mesh.shape[0] + 1
    weight = total_weight(parts, p)
    _first_guess(anchor, problem, weight, mesh, y, force, top)
    still = zero(top)
    for i in range(n, 2 * n):
        store(y, i, still)
    store(y, n - 1, top)
    for i in range(2 * n):
        store(yd, i, still)
    period = math.sqrt(problem.cable.length / max(problem.cable.gravity, 1e-3))
    step = 0.03 * period
    backward = Coefficients(0.0, 0.0, 1.0)
    goal = problem.numeric.bending
    stiff = _first_bending(parts.bending, weight, problem, n - 1)
    for _ in range(STATIC_STEPS):
        to_place = with_tolerance(problem, 1e-10 * problem.cable.length / step, 0.0)  # positions to 1e-10 of the length
        to_place = with_bending(to_place, stiff)
        contraction[0] = 0.0  # steps differ too much to learn from one another
        status = newton_step(
            parts, to_place, mesh, y, yd, yd, backward, time, step, top, still, unwound(problem), contraction, y1, yd1, force, force, 0.0, s
        )
        if status < 0:
            step *= 0.2
            if step < 1e-9 * period:
                return header.NO_EQUILIBRIUM
            continue
        keep_tensions(parts, to_place.numeric, mesh, force, s)
        for i in range(n - 1):
            store(y, i, load(y1, i, top))
        if stiff < goal and step >= SETTLED * period and status <= FEW_ITERATIONS:
            stiff = min(goal, BENDING_FACTOR * stiff)
            step = period
            continue
        if stiff >= goal and step >= 1e5 * period and status <= 4:
            return header.OK
        step = min(step * (4.0 if status <= 6 else 1.5), 1e6 * period)
    return header.NO_EQUILIBRIUM


@kernel
def _first_bending(bending, weight, problem, cells):
    if bending is None:
        return problem.numeric.bending
    cell = problem.cable.length / cells
    return min(problem.numeric.bending, FIRST_BENDING * weight * cell * cell)


@kernel
def starting_rates(parts, problem, mesh, y, yd, contraction, y1, yd1, force, top, velocity, acceleration, winding, time, h, s):
    """Rates of change at the start, as the limit of a backward-difference step much shorter than h.

    The cable is in place and at rest but for its top, which already has its prescribed velocity.
    """
    n = mesh.shape[0] + 1
    store(y, 2 * n - 1, velocity)
    short = 1e-6 * h
    backward = Coefficients(0.0, 0.0, 1.0)
    ahead = axpy(short, acceleration, velocity)
    contraction[0] = 0.0
    status = newton_step(
        parts, problem, mesh, y, yd, yd, backward, time, short, top, ahead, winding, contraction, y1, yd1, force, force, 0.0, s
    )
    contraction[0] = 0.0
    if status < 0:
        return header.NOT_FINITE
    keep_tensions(parts, problem.numeric, mesh, force, s)
    for i in range(2 * n):
        store(yd, i, load(yd1, i, top))
    return header.OK


@kernel
def tensions_now(parts, problem, mesh, y, force, force_old, ahead, top, cells):
    """Tensions at the new time, T + T_c, into cells[:, 0], from those at the averaged times of the last two steps.

    They come from the momentum balance: on a stiff cable the strain times EA would carry Newton's tolerance times EA.
    """
    for i in range(force.shape[0]):
        cells[i, 0] = force[i] + ahead * (force[i] - force_old[i]) + floor(parts, problem.numeric, mesh[i, 0])
        if parts.slack is not None:
            cells[i, 0] = max(cells[i, 0], 1e-9 * width(problem.numeric, mesh[i, 0]))
        q = load(y, i, top)
        cells[i, 2] = norm(q)
        store_from(cells, i, 3, scale(1.0 / cells[i, 2], q))


@kernel
def axial_force(parts, numeric, mesh, y, i, like, s):
    """N of cell i: its tension and what bending adds; cells[:, 0] holds the tensions T + T_c."""
    return s.cells[i, 0] - floor(parts, numeric, mesh[i, 0]) + bent(parts.bending, numeric.bending, mesh, y, i, like)


@kernel
def top_force(parts, problem, mesh, y, acceleration, top, winding, time, s):
    """Force of the cable on its attachment; `acceleration` (n, D) is that of the nodes now; cells[:, 0] holds the tensions."""
    n = mesh.shape[0] + 1
    gains = Gains(0.0, 0.0, 0.0, 0.0, 0.0, 0.0, winding)
    lowest = max(n - 3, 0)
    assemble(parts, problem, gains, mesh, y, y[n:], acceleration, top, time, lowest, s.bands, s.x, s.cells, s.contact)
    return load(s.x, n - 1, top)


@kernel
def lower_end_tension(present, parts, problem, mesh, y, acceleration, position, winding, time, s):
    """Tension that reaches the lower end: what the body needs, or without one the first cell's less its lower share of weight."""
    n = mesh.shape[0] + 1
    q = load(y, 0, position)
    t = scale(1.0 / norm(q), q)
    if present is None:
        h, split = mesh[0, 0], mesh[0, 1]
        weight = lower_weight(parts.surface, parts, problem.medium, problem.cable, h, split, q, position, time)
        return axial_force(parts, problem.numeric, mesh, y, 0, position, s) - weight * t[len(t) - 1]
    gains = Gains(0.0, 0.0, 0.0, 0.0, 0.0, 0.0, winding)
    v = load(y, n, position)
    a = load(acceleration, 0, position)
    needed, needed_by = lower_end_terms(present, parts, problem.body, problem.cable, gains, position, v, a, time)
    lifted, _ = add_seabed(parts.seabed, parts, problem.ground, gains, mesh, 0, position, v, q, 0.0, s.contact, zero(v), needed_by)
    return dot(axpy(under_body(parts.seabed, problem.ground, mesh), lifted, needed), t)
