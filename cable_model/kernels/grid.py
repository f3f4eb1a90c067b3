"""What the chain asks of its grid, answered by the staggered or by the box one: the first argument, parts.box, decides.

Each grid compiles its own side only.  A View is layout.View; positions and velocities are vectors of the chain's dimension.
"""

from cable_model.kernels import box_chain, box_step, staggered_chain, staggered_statics, staggered_step
from cable_model.kernels.box_law import unknowns
from cable_model.kernels.choice import by_presence
from cable_model.kernels.extent import tell_bottom, tell_box_moment, tell_moment
from cable_model.kernels.jit import kernel, views
from cable_model.kernels.line_bodies import mass_on
from cable_model.kernels.path import Ends
from cable_model.kernels.problem import slack_weight, total_weight
from cable_model.kernels.seabed import keep_sliders, recall_sliders, start_contacts
from cable_model.kernels.sections import made_of
from cable_model.kernels.vector import axpy, dot, load, mix
from cable_model.kernels.watch_outputs import NOTHING, Seen


@kernel
def _staggered_shape(box, bending, n, like):
    return 2 * n, len(like), 0, n - 1


@kernel
def _box_shape(box, bending, n, like):
    return n, len(unknowns(bending)), n, 0


shape = by_presence(_staggered_shape, _box_shape)  # rows and columns of Y, rows kept of the state before, cells with their own tension


@kernel
def _staggered_scratch_size(box, bending, n, like):
    return staggered_step.scratch_size(n, len(like))


@kernel
def _box_scratch_size(box, bending, n, like):
    return max(box_step.scratch_size(n, len(unknowns(bending))), box_chain.statics_size(n))


scratch_size = by_presence(_staggered_scratch_size, _box_scratch_size)


@views
def _staggered_scratch(box, bending, work, n, like):
    return staggered_step.cut_scratch(work, n, like)


@views
def _box_scratch(box, bending, work, n, like):
    return box_step.cut_scratch(work, n, unknowns(bending))


cut_scratch = by_presence(_staggered_scratch, _box_scratch)


@kernel
def _staggered_places(box, anchor, parts, problem, grading, mesh):
    staggered_chain.place_nodes(anchor, parts, problem, grading, mesh)


@kernel
def _box_places(box, anchor, parts, problem, grading, mesh):
    box_chain.place_nodes(problem, grading, mesh)


place_nodes = by_presence(_staggered_places, _box_places)


@kernel
def _staggered_equilibrium(box, parts, problem, p, view, top, anchor, time):
    status = staggered_statics.equilibrium(
        parts, problem, p, staggered_chain.grading_of(anchor, p[0].solver.grading), view.mesh, view.y, view.yd, view.contraction,
        view.y1, view.yd1, view.force, top, anchor, time, view.scratch,
    )  # fmt: skip
    keep_sliders(parts.friction, problem.ground, view.mesh, 1.0, top, view.scratch.contact, view.sliders)
    return status


@kernel
def _box_equilibrium(box, parts, problem, p, view, top, anchor, time):
    return box_chain.equilibrium(
        parts, problem, p, view.mesh, view.y, view.yd, view.contraction, view.y1, view.yd1, top, anchor, time, view.scratch
    )


equilibrium = by_presence(_staggered_equilibrium, _box_equilibrium)


@kernel
def _staggered_rates(box, parts, problem, p, view, top, velocity, acceleration, winding, time):
    recall_sliders(parts.friction, view.sliders, top, view.scratch.contact)
    status = staggered_chain.starting_rates(
        parts, problem, view.mesh, view.y, view.yd, view.contraction, view.y1, view.yd1, view.force,
        top, velocity, acceleration, winding, time, p[0].solver.time_step, view.scratch,
    )  # fmt: skip
    n = view.mesh.shape[0] + 1
    for i in range(n - 1):
        view.force_old[i] = view.force[i]
    for k in range(len(top)):
        view.y[n - 1, k] = top[k]
    return status


@kernel
def _box_rates(box, parts, problem, p, view, top, velocity, acceleration, winding, time):
    h = p[0].solver.time_step if p[0].solver.tolerance == 0.0 else 0.01 * p[0].solver.time_step
    return box_chain.starting_rates(
        parts, problem, view.mesh, view.y, view.yd, view.contraction, view.y1, view.yd1, top, velocity.top, acceleration.top, time, h,
        view.scratch,
    )  # fmt: skip


starting_rates = by_presence(_staggered_rates, _box_rates)


@kernel
def _staggered_step(box, parts, problem, view, c, time, h, reach, before, after, velocity, winding):
    recall_sliders(parts.friction, view.sliders, before, view.scratch.contact)
    return staggered_step.newton_step(
        parts, problem, view.mesh, view.y, view.yd0, view.ydd, c, time + (1.0 - c.alpha_k) * h, h,
        mix(1.0 - c.alpha_k, after, c.alpha_k, before), velocity, winding, view.contraction, view.y1, view.yd1,
        view.force, view.force_old, reach, view.scratch,
    )  # fmt: skip


@kernel
def _box_step(box, parts, problem, view, c, time, h, reach, before, after, velocity, winding):
    return box_step.newton_step(
        parts, problem, view.mesh, view.y, view.yd0, view.y_old, reach, c, time + (1.0 - c.alpha_k) * h, h,
        before, velocity.top, view.contraction, view.y1, view.yd1, view.scratch,
    )  # fmt: skip


newton_step = by_presence(_staggered_step, _box_step)


@kernel
def _staggered_length(box, view, factor):
    staggered_step.change_length(view.mesh, view.y, view.yd, view.ydd, factor)


@kernel
def _box_length(box, view, factor):
    return


change_length = by_presence(_staggered_length, _box_length)  # winches are refused on the box grid


@kernel
def _staggered_keep(box, parts, problem, view, like, h):
    """The tensions that the last Newton iteration found, and the stretch of friction's springs."""
    for i in range(view.force.shape[0]):
        view.force_old[i] = view.force[i]
    staggered_step.keep_tensions(parts, problem, view.mesh, view.force, view.scratch)
    keep_sliders(parts.friction, problem.ground, view.mesh, h, like, view.scratch.contact, view.sliders)


@kernel
def _box_keep(box, parts, problem, view, like, h):
    """The state before the step: rates of the box grid's algebraic unknowns ring, and would predict badly."""
    for i in range(view.y.shape[0]):
        for k in range(view.y.shape[1]):
            view.y_old[i, k] = view.y[i, k]


keep = by_presence(_staggered_keep, _box_keep)  # what the next step needs, beside Y and its rates; before the new state takes its place


@kernel
def _staggered_forces(box, parts, problem, view, c, time, h, before, after, winding):
    return staggered_chain.mean_forces(
        parts, problem, c, h, view.mesh, view.y, view.yd0, view.y1, mix(1.0 - c.alpha_k, after.top, c.alpha_k, before.top),
        mix(1.0 - c.alpha_k, after.lower, c.alpha_k, before.lower), winding, time + (1.0 - c.alpha_k) * h, view.scratch,
    )  # fmt: skip


@kernel
def _box_forces(box, parts, problem, view, c, time, h, before, after, winding):
    force = box_chain.mean_force(parts, problem, c, view.y, view.yd0, view.y1, view.yd1)
    return Ends(force, force)


# on what holds the ends in the step just taken, as staggered_chain.end_forces (the box grid: the top's twice); after keep
mean_forces = by_presence(_staggered_forces, _box_forces)


@kernel
def _staggered_error(box, parts, problem, view, c, time, h, reach, before, after, winding):
    return staggered_step.rate_error(
        parts, problem, view.mesh, view.y, view.yd0, view.y1, view.yd1, view.ydd, c, time + (1.0 - c.alpha_k) * h, h, reach,
        mix(1.0 - c.alpha_k, after, c.alpha_k, before), winding, view.scratch,
    )  # fmt: skip


@kernel
def _box_error(box, parts, problem, view, c, time, h, reach, before, after, winding):
    return box_step.rate_error(parts.bending, problem, view.mesh, view.yd0, view.yd1, view.ydd, reach)


rate_error = by_presence(_staggered_error, _box_error)


@kernel
def _staggered_held(box, inextensible, view, anchor):
    return load(view.y, view.mesh.shape[0], anchor)


@kernel
def _box_held(box, inextensible, view, anchor):
    return box_chain.anchored_top(anchor, inextensible, view.mesh, view.y)


held_top = by_presence(_staggered_held, _box_held)  # where an anchored cable's own motion has brought its top


@kernel
def _staggered_vector(box, inextensible, view, i, like):
    return load(view.y, i, like)


@kernel
def _box_vector(box, inextensible, view, i, like):
    return box_chain.cell_vector(inextensible, view.y, i)


cell_vector = by_presence(_staggered_vector, _box_vector)  # (1 + eps) t of a cell


@kernel
def _staggered_ready(box, parts, problem, view, ahead, top):
    staggered_chain.tensions_now(parts, problem, view.mesh, view.y, view.force, view.force_old, ahead, top, view.scratch.cells)


@kernel
def _box_ready(box, parts, problem, view, ahead, top):
    return


ready_tensions = by_presence(_staggered_ready, _box_ready)  # what node_tension reads


@kernel
def _staggered_tension(box, parts, problem, view, offset, i, like):
    return staggered_chain.node_tension(parts, problem, view.mesh, view.y, i, like, view.scratch)


@kernel
def _box_tension(box, parts, problem, view, offset, i, like):
    return box_chain.node_tension(parts, problem, view.y, view.yd, view.ydd, offset, i)


node_tension = by_presence(_staggered_tension, _box_tension)  # N of an inner node, now


@kernel
def _staggered_lead(box, view, time, last, offset):
    """By a parabola: the rates now are yd - offset ydd."""
    for i in range(view.y.shape[0]):
        for k in range(view.y.shape[1]):
            rate = view.yd[i, k] - offset * view.ydd[i, k]
            view.y1[i, k] = view.y[i, k] + time * (rate + 0.5 * time * view.ydd[i, k])
            view.yd1[i, k] = view.yd[i, k] + time * view.ydd[i, k]


@kernel
def _box_lead(box, view, time, last, offset):
    """By the line through the last two states: rates of the algebraic unknowns ring."""
    reach = time / last if last > 0.0 else 0.0
    for i in range(view.y.shape[0]):
        for k in range(view.y.shape[1]):
            view.y1[i, k] = view.y[i, k] + reach * (view.y[i, k] - view.y_old[i, k])
            view.yd1[i, k] = view.yd[i, k]


lead_on = by_presence(_staggered_lead, _box_lead)  # the state and its rates some time after the last step, into y1 and yd1


@kernel
def _no_bodies(bodies, mesh, i, position, highest, nearest):
    return highest, nearest


@kernel
def _heights(bodies, mesh, i, position, highest, nearest):
    if mass_on(bodies, mesh, i) == 0.0:
        return highest, nearest
    z = position[len(position) - 1]
    return max(highest, z), z if abs(z) < abs(nearest) else nearest


_see_bodies = by_presence(_no_bodies, _heights)


@kernel
def _no_strain(sections, p, mesh, i, tension, strain, under):
    return strain, under


@kernel
def _strain_of_cell(sections, p, mesh, i, tension, strain, under):
    own = tension / made_of(sections, p, mesh, i).axial_stiffness
    return (own, tension) if own > strain else (strain, under)


_larger_strain = by_presence(_no_strain, _strain_of_cell)


@kernel
def _staggered_measure(box, parts, problem, p, view, last, offset, ahead, top, winding, time):
    mesh = view.mesh
    n = mesh.shape[0] + 1
    recall_sliders(parts.friction, view.sliders, top, view.scratch.contact)
    start_contacts(parts.seabed, parts.friction, problem.ground, mesh, view.y, n - 1, last, top, view.scratch.contact)
    for i in range(n):
        for k in range(len(top)):
            view.scratch.a[i, k] = view.yd[n + i, k] - offset * view.ydd[n + i, k]
    staggered_chain.tensions_now(parts, problem, mesh, view.y, view.force, view.force_old, ahead, top, view.scratch.cells)
    largest = 0.0
    strain = 0.0
    under = 0.0
    highest = -1e300
    nearest = 1e300
    smallest = 1e300
    slack = 0.0
    length = 0.0
    position = top
    for i in range(n - 2, -1, -1):
        t = staggered_chain.axial_force(parts, problem, mesh, view.y, i, top, view.scratch)
        largest = max(largest, t)
        strain, under = _larger_strain(parts.sections, problem.numbers, mesh, i, t, strain, under)
        smallest = min(smallest, t)
        if t < 1e-3 * slack_weight(parts, p):
            slack += mesh[i, 0]
        length += mesh[i, 0]
        position = axpy(-mesh[i, 0], load(view.y, i, top), position)
        highest, nearest = _see_bodies(parts.line_bodies, mesh, i, position, highest, nearest)
    largest = staggered_chain.largest_at_bodies(parts.line_bodies, parts, problem, mesh, view.y, top, view.scratch, largest)
    forces = staggered_chain.end_forces(parts, problem, mesh, view.y, view.scratch.a, top, position, winding, time, view.scratch)
    tangents = staggered_chain.end_tangents(parts, p, mesh, view.y, top)
    tensions = staggered_chain.end_tensions(
        parts, problem, mesh, view.y, view.scratch.a, forces, tangents, position, winding, time, view.scratch
    )  # fmt: skip
    seen = Seen(strain, under, highest, nearest)
    return forces, tangents, tensions, position, load(view.y, n, top), largest, smallest, slack / length, seen


@kernel
def _box_measure(box, parts, problem, p, view, last, offset, ahead, top, winding, time):
    force, t, position, velocity, end, largest, smallest, slack = box_chain.measure(
        parts, problem, view.mesh, view.y, view.yd, view.ydd, offset, top, 1e-3 * total_weight(parts, p)
    )
    tensions = Ends(0.0 - dot(force, t), end)
    return Ends(force, force), Ends(t, t), tensions, position, velocity, largest, smallest, slack, NOTHING


# forces, tangents and tensions at the ends, place and velocity of the lower one, largest and smallest tension of the cells, slack share,
# and what is seen of sections and bodies on the cable; the box grid has those of its top, but the lower end's tension
measure = by_presence(_staggered_measure, _box_measure)


@kernel
def _staggered_extent(box, parts, problem, view, top, out):
    tell_bottom(parts.seabed, parts, problem, view.mesh, view.y, view.scratch.contact, top, out)
    tell_moment(parts.bending, parts, problem, view.mesh, view.y, top, out)


@kernel
def _box_extent(box, parts, problem, view, top, out):
    tell_box_moment(parts.bending, problem, view.y, out)


tell_extent = by_presence(_staggered_extent, _box_extent)  # after `measure`, whose contacts it reads
