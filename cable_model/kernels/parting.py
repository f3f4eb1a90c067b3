"""A cable that parts: at a time or by an input where it is cut, or where it breaks.  What is below has gone, and the run goes on without.

Within a communication step `advance` ends an internal step exactly where the cable parts, cuts the state down to the nodes above, which
keep places and velocities (`lose`), and says PARTING; whoever called it calls it again, with the parts that are left (effects.GOING are
not), for the rest of the step.  That begins with rates that go with the new lower end (fronts.set_off_again).

A cable is cut at the node that is nearest to the place; where sections meet there is one.  It breaks where the tension, as outputs would
tell it, is largest over what the cable bears: at a node, or at an end.  When is found on the line between the ends of the internal step in
which that happens, which is then taken again, only so far.  Less than two cells cannot be simulated: where no more would be left all of it
has gone, and the top is free.
"""

from typing import NamedTuple

from cable_model.kernels import header
from cable_model.kernels.cells import of_cell
from cable_model.kernels.choice import by_presence
from cable_model.kernels.doubt import ALL_GONE, PARTS, note
from cable_model.kernels.header import ALL_LOST, AT_END, AT_START, DONE, SHORTER, WHOLE
from cable_model.kernels.jit import kernel
from cable_model.kernels.pending import ahead_to_end
from cable_model.kernels.problem import shortened
from cable_model.kernels.sections import made_of
from cable_model.kernels.slack import floor
from cable_model.kernels.staggered_chain import CELLS, end_tension, node_tension

NEVER = 1e300
AT_ONCE = 1e-9  # of a communication step: times that are closer are the same


class Event(NamedTuple):
    """When within a communication step the cable parts, s after its start, and at which node."""

    time: float
    node: int


# -- what is left


@kernel
def _as_built(parting, problem, state):
    return problem


@kernel
def _as_left(parting, problem, state):
    if state[header.PARTED] == WHOLE:
        return problem
    return shortened(problem, state[header.MESH_LENGTH])


left = by_presence(_as_built, _as_left)  # the problem, with the length of what is left


@kernel
def lost(parting, state):
    """Unstretched length that has gone, m."""
    if parting is None:
        return 0.0
    return state[header.LOST]


@kernel
def is_whole(state):
    """Whether nothing has gone, nor what held the lower end or hung there."""
    return state[header.PARTED] == WHOLE


@kernel
def open_parting(p, state):
    """Begin with a whole cable."""
    state[header.NODES] = p[0].solver.nodes
    for k in (header.PARTED, header.LOST, header.RESUMES, header.RESUMES_AFTER, header.LOAD, header.FRONT):
        state[k] = 0.0


@kernel
def has_gone(parting, state):
    """Whether nothing of the cable is left."""
    if parting is None:
        return False
    return state[header.PARTED] == ALL_LOST


# -- when it parts


@kernel
def _never(parting, parts, p, view, state, time, span):
    return Event(NEVER, 0)


@kernel
def _cut(parting, parts, p, view, state, time, span):
    """The cut that is due in a communication step of `span` from `time`."""
    if state[header.CUT] == DONE:
        return Event(NEVER, 0)
    at = NEVER
    if state[header.CUT] == AT_START:
        at = 0.0
    elif state[header.CUT] == AT_END:
        at = span
    if p[0].parting.time > 0.0:
        at = min(at, state[header.START] + p[0].parting.time - time)
    near = max(AT_ONCE * span, state[header.SHORTEST])  # an end of the step that is nearer is where it happens: no slivers
    if at > span + AT_ONCE * span:
        return Event(NEVER, 0)
    node = _nearest(parts, view, state, p[0].parting.place)
    if node < 0:
        return Event(NEVER, 0)
    if span - at <= near:
        at = span
    return Event(at if at > near or at == span else 0.0, node)


due = by_presence(_never, _cut)


@kernel
def _nearest(parts, view, state, place):
    """The node nearest to a place, an unstretched length above the lower end of the whole cable; -1 where it has gone already.

    Of a free end it is not the lowest: there is nothing to be cut from it.
    """
    arc = place - state[header.LOST]
    if arc < 0.0 or (arc == 0.0 and state[header.PARTED] != WHOLE):
        return -1
    below = 0.0
    for i in range(view.mesh.shape[0]):
        above = below + view.mesh[i, 0]
        if arc < 0.5 * (below + above) and (i > 0 or parts.body is not None or parts.anchor is not None):
            return i
        below = above
    return view.mesh.shape[0]


@kernel
def _strength(parts, problem, mesh, i):
    """The tension that the cable bears at node i: that of the weaker of the cells there; 0: any."""
    bears = 0.0
    for cell in range(max(i - 1, 0), min(i + 1, mesh.shape[0])):
        own = made_of(parts.sections, problem.numbers, mesh, cell).breaking_tension
        if own > 0.0 and (bears == 0.0 or own < bears):
            bears = own
    return bears


@kernel
def _largest_load(parts, problem, mesh, y, like, s):
    """The largest tension over what the cable bears there, and the node; cells[:, 0] holds the tensions."""
    largest = 0.0
    node = 0
    for i in range(mesh.shape[0] + 1):
        bears = _strength(parts, problem, mesh, i)
        if bears > 0.0 and (i > 0 or parts.body is not None or parts.anchor is not None):
            inner = 0 < i < mesh.shape[0]
            tension = node_tension(parts, problem, mesh, y, i, like, s) if inner else end_tension(parts, problem, mesh, y, i, like, s)
            if tension > largest * bears:
                largest = tension / bears
                node = i
    return largest, node


@kernel
def _no_load(parting, parts, problem, view, state, like):
    return


@kernel
def _load(parting, parts, problem, view, state, like):
    if problem.numbers[0].cable.breaking_tension > 0.0:
        state[header.LOAD], node = _largest_load(parts, problem, view.mesh, view.y, like, view.scratch)
        state[header.ERROR_NODE] = node


load_at_start = by_presence(_no_load, _load)  # into the state, from the tensions that `starting_rates` has left


@kernel
def _unbreakable(parting, parts, problem, view, state, c, done, h, like):
    return Event(NEVER, 0)


@kernel
def _break(parting, parts, problem, view, state, c, done, h, like):
    """Whether and when the cable breaks in the step of h just tried from `done`; a step that breaks nothing is kept in mind.

    The tensions, which a step has at its averaged time, are led on to its end as outputs do it; they are put aside meanwhile.
    """
    if problem.numbers[0].cable.breaking_tension == 0.0:
        return Event(NEVER, 0)
    mesh, s = view.mesh, view.scratch
    ahead = ahead_to_end(state, c, h)
    for i in range(mesh.shape[0]):
        now = s.cells[i, 0]
        s.cells[i, 1] = now
        held = floor(parts, of_cell(parts.sections, parts, problem, mesh, i).numeric, mesh[i, 0])
        s.cells[i, 0] = now + ahead * (now - held - view.force[i])
    load, node = _largest_load(parts, problem, mesh, view.y1, like, s)
    for i in range(mesh.shape[0]):
        s.cells[i, 0] = s.cells[i, 1]
    before = state[header.LOAD]
    if load < 1.0:
        state[header.LOAD] = load
        return Event(NEVER, 0)
    share = 0.0
    if before < 1.0:
        share = (1.0 - before) / (load - before)
    return Event(done + share * h, node)


breaks = by_presence(_unbreakable, _break)


# -- what goes


@kernel
def _keep_rows(state, at, array, first, beyond):
    """Rows of an array of the state, moved to the place `at` of it; the place after them."""
    for i in range(first, beyond):
        for k in range(array.shape[1]):
            state[at] = array[i, k]
            at += 1
    return at


@kernel
def _drop(view, state, first):
    """Cut the state down to what is above a node.

    What is kept moves towards the head, in the order in which it lies, so that nothing is written over before it is read.
    """
    cells = view.mesh.shape[0]
    n = cells + 1
    at = _keep_rows(state, header.HEADER, view.mesh, first, cells)
    for array in (view.y, view.yd, view.ydd):
        at = _keep_rows(state, at, array, first, n)
        at = _keep_rows(state, at, array, n + first, 2 * n)
    for force in (view.force, view.force_old):
        for i in range(first, cells):
            state[at] = force[i]
            at += 1
    if view.sliders.shape[0] > 0:
        at = _keep_rows(state, at, view.sliders, first, view.sliders.shape[0])
    state[header.NODES] = n - first


@kernel
def _holds(parting, view, state, time, event, breaking):
    return


@kernel
def _lose(parting, view, state, time, event, breaking):
    """Do what an event of a communication step from `time` asks for; a cut is not done twice.  The mesh has its length of then."""
    cells, length = view.mesh.shape[0], state[header.MESH_LENGTH]
    first = event.node if event.node <= cells - CELLS else cells
    gone = 0.0
    for i in range(first):
        gone += view.mesh[i, 0]
    state[header.LOST] += gone
    state[header.MESH_LENGTH] -= gone
    for k in (header.STEP, header.NEXT_STEP, header.LAG, header.LAG_BEFORE, header.OFFSET, header.DRIFT_STEP, header.LAST_ERROR):
        state[k] = 0.0
    state[header.LOAD] = 0.0
    state[header.RESUMES], state[header.RESUMES_AFTER] = 1.0, event.time
    if not breaking:
        state[header.CUT] = DONE
    if first < cells:
        state[header.PARTED] = SHORTER
        _drop(view, state, first)
        note(state, PARTS, time + event.time, state[header.MESH_LENGTH])
    else:
        state[header.PARTED] = ALL_LOST
        note(state, ALL_GONE, time + event.time, length)


lose = by_presence(_holds, _lose)


@kernel
def resumes(parting, state):
    """Whether this call of `advance` goes on within a communication step, where the cable has parted; it is said once."""
    if parting is None:
        return False
    goes_on = state[header.RESUMES] > 0.0
    state[header.RESUMES] = 0.0
    return goes_on
