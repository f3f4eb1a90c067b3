"""Where the statics of the staggered grid begin: a catenary, a V between two held ends, or the shape found on a coarser mesh."""

import math

from cable_model.kernels.cells import of_cell
from cable_model.kernels.jit import kernel
from cable_model.kernels.line_bodies import weight_on
from cable_model.kernels.mesh import fill
from cable_model.kernels.problem import body_weight, density_of
from cable_model.kernels.vector import axpy, dot, load, norm, scale, store, sub, upward, zero

OPEN = 0.1  # of the length: two held ends nearer to one another across than that get a loop that is open, for a fold has no direction


@kernel
def rest(anchor, parts, problem, scale_force, mesh, y, yd, force, top):
    """The first guess of cell vectors and tensions, at rest."""
    n = mesh.shape[0] + 1
    _catenary(anchor, parts, problem, scale_force, mesh, y, force, top)
    _stop(n, y, top)
    for i in range(2 * n):
        store(yd, i, zero(top))


@kernel
def _stop(n, y, top):
    for i in range(n, 2 * n):
        store(y, i, zero(top))
    store(y, n - 1, top)


@kernel
def refine(parts, problem, grading, cells, nodes, mesh, y, force, y1, yd1, top):
    """Take shape and tensions of the `cells` of a mesh to the finer mesh of `nodes`; y1 and yd1 are overwritten.

    A new cell has the means over its length, so that the ends stay where they are.
    """
    for i in range(cells):
        store(y1, i, load(y, i, top))
        yd1[i, 0] = force[i]
        yd1[i, 1] = mesh[i, 0]
    fine = mesh[: nodes - 1]
    fill(parts.sections, parts, problem, grading, fine)
    j = 0
    rest_of = yd1[0, 1]  # of the old cell j that no new cell has yet
    for i in range(nodes - 1):
        wanted = fine[i, 0]
        q = zero(top)
        tension = 0.0
        while wanted > 0.0:
            part = min(wanted, rest_of) if j < cells - 1 else wanted
            q = axpy(part / fine[i, 0], load(y1, j, top), q)
            tension += part / fine[i, 0] * yd1[j, 0]
            wanted -= part
            rest_of -= part
            if rest_of <= 0.0 and j < cells - 1:
                j += 1
                rest_of = yd1[j, 1]
        store(y, i, q)
        force[i] = tension
    _stop(nodes, y, top)


@kernel
def _catenary(anchor, parts, problem, scale_force, mesh, y, force, top):
    """The catenary under weight and pull alone, cell by cell; between two held ends a V of two straight legs."""
    n = mesh.shape[0] + 1
    pull = problem.numeric.pull
    load_below = body_weight(problem.body)
    density = density_of(parts.water, problem.numbers)
    total = load_below + problem.cable.weight * problem.cable.length
    for i in range(n - 1):
        total += weight_on(parts.line_bodies, mesh, i, density, problem.cable.gravity)
    sign = 1.0 if total >= 0.0 else -1.0
    for i in range(n - 1):
        own = of_cell(parts.sections, parts, problem, mesh, i).cable
        load_below += weight_on(parts.line_bodies, mesh, i, density, problem.cable.gravity)
        hanging = load_below + own.weight * mesh[i, 1] * mesh[i, 0]
        load_below += own.weight * mesh[i, 0]
        if sign * hanging < 0.0:
            hanging = 0.0
        size = math.sqrt(hanging * hanging + pull * pull)
        force[i] = max(size, 1e-3 * scale_force)
        stretch = 1.0 + size / own.stiffness
        if size > 0.0:
            store(y, i, along_x(-pull * stretch / size, upward(hanging * stretch / size, top)))
        else:
            store(y, i, upward(sign, top))
    _bend_guess(anchor, problem, total - body_weight(problem.body), mesh, y, top)


@kernel
def along_x(size, a):
    """The vector a with its first component set."""
    if len(a) == 2:
        return (size, a[1])
    return (size, a[1], a[2])


@kernel
def _bend_guess(anchor, problem, weight, mesh, y, top):
    """A V of two legs, upside down where what is between the ends weighs less than the water, `weight` N."""
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
    if dot(chord, chord) >= length * length:
        for i in range(n - 1):
            store(y, i, scale(1.0 / length, chord))
        return
    # legs a below the anchor and b below the top: horizontal runs share the chord, both at the same slope
    drop = math.sqrt(length * length - across * across)
    sign = 1.0 if weight >= 0.0 else -1.0
    first = 0.5 * (1.0 - sign * rise / drop) * length
    ahead = scale(1.0 / length, level)
    gone = 0.0
    for i in range(n - 1):
        # exact lengths: a cell that holds the kink is bent into its mean direction
        down = min(max((first - gone) / mesh[i, 0], 0.0), 1.0)
        q = axpy(1.0, upward(sign * (1.0 - 2.0 * down) * drop / length, top), ahead)
        if across < OPEN * length:  # a fold would have a cell without a direction
            q = along_x(q[0] + OPEN * _swing(mesh[i, 0], gone, length), q)
        store(y, i, q)
        gone += mesh[i, 0]


@kernel
def _swing(h, low, length):
    """Mean over a cell of length h from arc length `low` on of cos(2 pi s/L), which a closed loop has."""
    turn = 2.0 * math.pi / length
    return (math.sin(turn * (low + h)) - math.sin(turn * low)) / (turn * h)
