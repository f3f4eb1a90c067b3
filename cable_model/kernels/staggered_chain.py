"""Starting rates and outputs of the chain on the staggered grid, and where its nodes are."""

from cable_model.kernels import header
from cable_model.kernels.cells import of_cell
from cable_model.kernels.choice import by_presence
from cable_model.kernels.clamps import BELOW, TOP, held_tangent
from cable_model.kernels.family import Coefficients
from cable_model.kernels.jit import kernel
from cable_model.kernels.line_bodies import joint, mass_on
from cable_model.kernels.mesh import fill
from cable_model.kernels.path import Ends
from cable_model.kernels.seabed import under_body
from cable_model.kernels.slack import floor, limited, width
from cable_model.kernels.staggered import add_seabed, assemble, bent
from cable_model.kernels.staggered_step import Gains, Winding, average, hold_anchor, keep_tensions, newton_step
from cable_model.kernels.staggered_surface import lower_end_terms, lower_weight
from cable_model.kernels.vector import axpy, dot, load, mix, norm, scale, store, store_from, unit, zero
from cable_model.kernels.wave_records import NOBODY

CELLS = 2  # at an end, that the force on what holds it asks for


@kernel
def grading_of(anchor, grading):
    """Uniform by default between two held ends, by travel time above a lower end that hangs."""
    return grading if anchor is None else max(grading, 1.0)


@kernel
def place_nodes(anchor, parts, problem, grading, mesh):
    fill(parts.sections, parts, problem, grading_of(anchor, grading), mesh)


@kernel
def unwound(problem):
    """The winding of a cable whose length does not change."""
    return Winding(problem.cable.length, 0.0, 0.0)


@kernel
def starting_rates(parts, problem, mesh, y, yd, contraction, y1, yd1, force, top, velocity, acceleration, winding, time, h, s):
    """Rates of change at the start, as the limit of a backward-difference step much shorter than h.

    The cable is in place, its ends have their prescribed velocities, and the rest moves as `y` has it, not at all at the start of a run.
    """
    n = mesh.shape[0] + 1
    store(y, 2 * n - 1, velocity.top)
    hold_anchor(parts.anchor, y, n, velocity.lower)
    short = 1e-6 * h
    backward = Coefficients(0.0, 0.0, 1.0)
    ahead = Ends(axpy(short, acceleration.top, velocity.top), axpy(short, acceleration.lower, velocity.lower))
    contraction[0] = 0.0
    status = newton_step(
        parts, problem, mesh, y, yd, yd, backward, time, short, top, ahead, winding, contraction, y1, yd1, force, force, 0.0, s
    )
    contraction[0] = 0.0
    if status < 0:
        return header.NOT_FINITE
    keep_tensions(parts, problem, mesh, force, s)
    for i in range(2 * n):
        store(yd, i, load(yd1, i, top))
    return header.OK


@kernel
def tensions_now(parts, problem, mesh, y, force, force_old, ahead, top, cells):
    """Tensions at the new time, T + T_c, into cells[:, 0], from those at the averaged times of the last two steps.

    They come from the momentum balance: on a stiff cable the strain times EA would carry Newton's tolerance times EA.
    """
    for i in range(force.shape[0]):
        numeric = of_cell(parts.sections, parts, problem, mesh, i).numeric
        held = floor(parts, numeric, mesh[i, 0])
        cells[i, 0] = force[i] + ahead * (force[i] - force_old[i]) + held
        if parts.slack is not None:
            least = held if force[i] > 0.0 else 0.0  # a cell that loses its tension within a step is not led on to push
            cells[i, 0] = max(cells[i, 0], least + 1e-9 * width(numeric, mesh[i, 0]))
        q = load(y, i, top)
        cells[i, 2] = norm(q)
        store_from(cells, i, 3, scale(1.0 / cells[i, 2], q))


@kernel
def axial_force(parts, problem, mesh, y, i, like, s):
    """N of cell i: its tension and what bending adds; cells[:, 0] holds the tensions T + T_c."""
    held = floor(parts, of_cell(parts.sections, parts, problem, mesh, i).numeric, mesh[i, 0])
    return s.cells[i, 0] - held + bent(parts.bending, parts, problem, mesh, y, i, like)


@kernel
def end_tangents(parts, p, mesh, y, like):
    """Directions of the cable at its ends, towards the top: on the lines through those of the two cells at each, or the clamp's."""
    m = mesh.shape[0]
    return Ends(
        held_tangent(parts.top_clamp, TOP, parts, p, _led_on(mesh, y, m - 1, m - 2, like)),
        held_tangent(parts.lower_clamp, BELOW, parts, p, _led_on(mesh, y, 0, 1, like)),
    )


@kernel
def _led_on(mesh, y, last, before, like):
    share = mesh[last, 0] / (mesh[last, 0] + mesh[before, 0])
    return unit(mix(1.0 + share, unit(load(y, last, like)), -share, unit(load(y, before, like))))


@kernel
def _between_cells(sections, parts, problem, mesh, y, i, like, s):
    """On the line between the splits of the cells, where their tensions are those of what hangs below."""
    low, up = (1.0 - mesh[i - 1, 1]) * mesh[i - 1, 0], mesh[i, 1] * mesh[i, 0]
    below, above = axial_force(parts, problem, mesh, y, i - 1, like, s), axial_force(parts, problem, mesh, y, i, like, s)
    return (below * up + above * low) / (low + up)


@kernel
def _at_joints(sections, parts, problem, mesh, y, i, like, s):
    """Where sections meet, the larger of the tensions to which the two cells on either side lead: at a body it jumps."""
    if joint(mesh, i) < 0:
        return _between_cells(sections, parts, problem, mesh, y, i, like, s)
    below = _end_of_two(parts, problem, mesh, y, i - 1, i - 2, (1.0 - mesh[i - 1, 1]) * mesh[i - 1, 0], like, s)
    above = _end_of_two(parts, problem, mesh, y, i, i + 1, mesh[i, 1] * mesh[i, 0], like, s)
    return max(below, above)


@kernel
def _end_of_two(parts, problem, mesh, y, near, far, beyond, like, s):
    """Tension on the line through those at the splits of two cells, `beyond` that of the nearer."""
    low = min(near, far)
    apart = (1.0 - mesh[low, 1]) * mesh[low, 0] + mesh[low + 1, 1] * mesh[low + 1, 0]
    there = axial_force(parts, problem, mesh, y, near, like, s)
    return there + beyond / apart * (there - axial_force(parts, problem, mesh, y, far, like, s))


@kernel
def end_tension(parts, problem, mesh, y, i, like, s):
    """N of node i at an end of the cable, on the line through those of the two cells there."""
    if i == 0:
        return _end_of_two(parts, problem, mesh, y, 0, 1, mesh[0, 1] * mesh[0, 0], like, s)
    return _end_of_two(parts, problem, mesh, y, i - 1, i - 2, (1.0 - mesh[i - 1, 1]) * mesh[i - 1, 0], like, s)


_node_tension = by_presence(_between_cells, _at_joints)


@kernel
def node_tension(parts, problem, mesh, y, i, like, s):
    """N of inner node i."""
    return _node_tension(parts.sections, parts, problem, mesh, y, i, like, s)


@kernel
def _no_bodies(bodies, parts, problem, mesh, y, like, s, largest):
    return largest


@kernel
def _at_bodies(bodies, parts, problem, mesh, y, like, s, largest):
    for i in range(1, mesh.shape[0]):
        if mass_on(bodies, mesh, i) > 0.0:
            largest = max(largest, node_tension(parts, problem, mesh, y, i, like, s))
    return largest


largest_at_bodies = by_presence(_no_bodies, _at_bodies)  # `largest`, or the largest N at a body on the cable where that is more


@kernel
def _no_force(driven, parts, problem, mesh, q, v, a, lower, winding, time, s):
    return zero(lower)


@kernel
def _force_below(driven, parts, problem, mesh, q, v, a, lower, winding, time, s):
    """Force of the cable on what drives its lower end, which is at `lower`: its row asks for the lowest cells only."""
    m = CELLS
    at = lower
    arc = 0.0
    for i in range(m):
        at = axpy(mesh[i, 0], load(q, i, lower), at)
        arc += mesh[i, 0]
    gains = Gains(0.0, 0.0, 0.0, 0.0, 0.0, 0.0, Winding(arc, winding.rate, winding.change))
    assemble(
        parts, problem, gains, mesh[:m], q[:m], v[: m + 1], a[: m + 1], at, time, 0, s.bands, s.x[: m + 1], s.cells, s.contact
    )  # fmt: skip
    return load(s.x, 0, lower)


_lower_force = by_presence(_no_force, _force_below)


@kernel
def _top_force(parts, problem, mesh, q, v, a, top, winding, time, s):
    n = mesh.shape[0] + 1
    gains = Gains(0.0, 0.0, 0.0, 0.0, 0.0, 0.0, winding)
    assemble(parts, problem, gains, mesh, q, v, a, top, time, n - 1 - CELLS, s.bands, s.x, s.cells, s.contact)
    return load(s.x, n - 1, top)


@kernel
def end_forces(parts, problem, mesh, y, acceleration, top, lower, winding, time, s):
    """Forces of the cable on its attachment and on what drives its lower end (else 0), which are at `top` and `lower`.

    `acceleration` (n, D) is that of the nodes now; cells[:, 0] holds the tensions.
    """
    v = y[mesh.shape[0] + 1 :]
    force = _top_force(parts, problem, mesh, y, v, acceleration, top, winding, time, s)
    return Ends(force, _lower_force(parts.driven, parts, problem, mesh, y, v, acceleration, lower, winding, time, s))


@kernel
def _average_below(driven, mesh, y0, yd0, y1, c, h, rates, s, like):
    if driven is not None:
        average(mesh, y0, yd0, y1, c, h, rates[0], rates[1], rates[2], rates[3], s, like, 0.0, 0, CELLS + 1)


@kernel
def mean_forces(parts, problem, c, h, mesh, y0, yd0, y1, top, lower, winding, time, s):
    """The same in the step just taken, as its equations have them: at the averaged time, at which the ends are at `top` and `lower`."""
    rates = (c.alpha_m / (1.0 - c.alpha_m), 1.0 / (1.0 - c.alpha_m), 1.0 / (c.gamma * h), (1.0 - c.gamma) / c.gamma)
    n = mesh.shape[0] + 1
    average(mesh, y0, yd0, y1, c, h, rates[0], rates[1], rates[2], rates[3], s, top, 0.0, n - 1 - CELLS)
    force = _top_force(parts, problem, mesh, s.q, s.v, s.a, top, winding, time, s)
    _average_below(parts.driven, mesh, y0, yd0, y1, c, h, rates, s, top)
    return Ends(force, _lower_force(parts.driven, parts, problem, mesh, s.q, s.v, s.a, lower, winding, time, s))


@kernel
def lower_end_tension(present, parts, problem, mesh, y, acceleration, t, position, winding, time, s):
    """Part along `t` of the force that reaches the lower end.

    It is what the body needs, or what the first cell carries less its lower share of weight; a free end without a body bears none.
    """
    n = mesh.shape[0] + 1
    q = load(y, 0, position)
    if present is None:
        if parts.anchor is None:
            return 0.0
        h, split = mesh[0, 0], mesh[0, 1]
        own = of_cell(parts.sections, parts, problem, mesh, 0)
        weight = lower_weight(parts.surface, parts, own.medium, own.cable, h, split, q, position, time)
        return axial_force(parts, problem, mesh, y, 0, position, s) * dot(unit(q), t) - weight * t[len(t) - 1]
    gains = Gains(0.0, 0.0, 0.0, 0.0, 0.0, 0.0, winding)
    v = load(y, n, position)
    a = load(acceleration, 0, position)
    needed, needed_by = lower_end_terms(present, parts, problem.body, problem.cable, gains, NOBODY, position, v, a, time)
    lifted, _ = add_seabed(parts.seabed, parts, problem.ground, gains, mesh, 0, position, v, q, 0.0, s.contact, zero(v), needed_by)
    return dot(axpy(under_body(parts.seabed, problem.ground, mesh), lifted, needed), t)


@kernel
def _hinged_tension(clamp, parts, problem, mesh, y, acceleration, t, position, winding, time, s):
    return lower_end_tension(parts.body, parts, problem, mesh, y, acceleration, t, position, winding, time, s)


@kernel
def _clamped_tension(clamp, parts, problem, mesh, y, acceleration, t, position, winding, time, s):
    force = _force_below(True, parts, problem, mesh, y, y[mesh.shape[0] + 1 :], acceleration, position, winding, time, s)
    return dot(force, t)


_anchored_tension = by_presence(_hinged_tension, _clamped_tension)


@kernel
def _held_tension(driven, parts, problem, mesh, y, acceleration, force, t, position, winding, time, s):
    return _anchored_tension(parts.lower_clamp, parts, problem, mesh, y, acceleration, t, position, winding, time, s)


@kernel
def _driven_tension(driven, parts, problem, mesh, y, acceleration, force, t, position, winding, time, s):
    return dot(force, t)


_lower_tension = by_presence(_held_tension, _driven_tension)


@kernel
def end_tensions(parts, problem, mesh, y, acceleration, forces, tangents, position, winding, time, s):
    """Tensions at the ends, where the cable has these forces on what holds it, and tangents; its lower end is at `position`."""
    lower = _lower_tension(
        parts.driven, parts, problem, mesh, y, acceleration, forces.lower, tangents.lower, position, winding, time, s
    )  # fmt: skip
    top = 0.0 - dot(forces.top, tangents.top)
    last = mesh.shape[0] - 1
    at_top = of_cell(parts.sections, parts, problem, mesh, last).numeric
    at_lower = of_cell(parts.sections, parts, problem, mesh, 0).numeric
    return Ends(limited(parts, at_top, mesh[last, 0], top), limited(parts, at_lower, mesh[0, 0], lower))
