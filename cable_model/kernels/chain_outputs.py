"""What the chain tells: forces, places and tensions now, and its shape."""

import math

from cable_model.kernels import grid, header
from cable_model.kernels.build import build
from cable_model.kernels.choice import by_presence
from cable_model.kernels.clamps import BELOW, TOP, see_clamp
from cable_model.kernels.exchange import LOWER_FORCES, LOWER_MEANS, tell_exchange
from cable_model.kernels.extent import HAS_PARTED, see_cells, tell_elevation, tell_whole
from cable_model.kernels.family import coefficients
from cable_model.kernels.fluid import in_water_now
from cable_model.kernels.jit import kernel, views
from cable_model.kernels.layout import cut, led_on, vector_at
from cable_model.kernels.parting import has_gone, left, lost
from cable_model.kernels.pending import tensions_ahead
from cable_model.kernels.staggered_step import Winding
from cable_model.kernels.vector import axpy, dot, mix
from cable_model.kernels.watch_outputs import watch_outputs, watch_set_off


@kernel
def _fixed_length(winch, parts, problem, state):
    return Winding(problem.cable.length, 0.0, 0.0)


@kernel
def _wound_length(winch, parts, problem, state):
    length = problem.numbers[0].cable.length - lost(parts.parting, state) + state[header.PAID_OUT]
    return Winding(length, state[header.WINCH_SPEED] / length, state[header.WINCH_ACCELERATION] / length)


winding_now = by_presence(_fixed_length, _wound_length)


@views
def _now(parts, p, state, work):
    """The arrays of the state, led on where time is pending."""
    return led_on(parts, cut(parts, p, state, work), state[header.PENDING], state[header.STEP], state[header.OFFSET])


@kernel
def _tensions_ahead(p, state):
    return tensions_ahead(state, coefficients(int(p[0].solver.integrator), p[0].solver.lambda_infinity))


@kernel
def points(parts, p, state, work, told, even, out):
    """Position (m) and tension (N) of points from the lower end to the top, (m, 4), summed from the prescribed top downwards.

    `even`: they are at equal unstretched lengths from one another; else they are the nodes.  `told` are the outputs now, which have the
    tensions at the ends.
    """
    at = vector_at(parts, state, header.TOP)
    if has_gone(parts.parting, state):
        for i in range(out.shape[0]):
            _tell_point(parts, state, at, 0.0, out[i])
        return
    parts = in_water_now(parts, p, state)
    problem = left(parts.parting, build(parts, p, 0.0), state)
    view = _now(parts, p, state, work)
    grid.ready_tensions(parts.box, parts, problem, view, _tensions_ahead(p, state), at)
    m, cells = out.shape[0], view.mesh.shape[0]
    first = 0 if even else m - 1 - cells  # of the nodes that are left: those below have gone, and are told where the cable ends
    length = 0.0
    for i in range(cells):
        length += view.mesh[i, 0]
    row, arc, tension = m - 1, length, told[3]
    _tell_point(parts, state, at, tension, out[row])
    for i in range(cells - 1, -1, -1):
        h = view.mesh[i, 0]
        arc -= h
        lower = axpy(-h, grid.cell_vector(parts.box, parts.inextensible, view, i, at), at)
        below = grid.node_tension(parts.box, parts, problem, view, state[header.OFFSET], i, at) if i > 0 else told[11]
        while even and row > 1 and length * (row - 1) / (m - 1) >= arc:
            row -= 1
            share = (length * row / (m - 1) - arc) / h
            _tell_point(parts, state, mix(1.0 - share, lower, share, at), (1.0 - share) * below + share * tension, out[row])
        at, tension = lower, below
        if not even:
            _tell_point(parts, state, at, tension, out[first + i])
    for i in range(first + 1):
        _tell_point(parts, state, at, tension, out[i])


@kernel
def _tell_point(parts, state, at, tension, row):
    _spread(parts.space, at, state[header.TOP + 1], row, 0)
    row[3] = tension


@kernel
def outputs(parts, p, state, work, out):
    """Fill `out` in the order of signals.OUTPUTS."""
    parts = in_water_now(parts, p, state)
    if has_gone(parts.parting, state):
        _tell_nothing(parts, state, out)
        return
    problem = left(parts.parting, build(parts, p, 0.0), state)
    view = _now(parts, p, state, work)
    ahead = _tensions_ahead(p, state)
    top = vector_at(parts, state, header.TOP)
    winding = winding_now(parts.winch, parts, problem, state)
    force, t, tension, position, velocity, largest, smallest, slack, seen = grid.measure(
        parts.box, parts, problem, p, view, state[header.STEP], state[header.OFFSET], ahead, top, winding, state[header.TIME]
    )
    _spread(parts.space, force.top, 0.0, out, 0)
    out[3] = tension.top
    out[4] = _declination(t.top)
    _spread(parts.space, position, state[header.TOP + 1], out, 5)
    _spread(parts.space, velocity, 0.0, out, 8)
    out[11] = tension.lower
    out[12] = max(largest, tension.top, tension.lower) if parts.driven is not None else max(largest, tension.top)
    out[13] = smallest
    out[14] = slack
    _tell_counts(state, out)
    _tell_lower_end(parts.driven, parts, force.lower, t.lower, out)
    tell_exchange(state, out)
    tell_whole(winding.length, state[header.PAID_OUT], out)
    if parts.parting is not None:
        out[HAS_PARTED] = state[header.PARTED]
    grid.tell_extent(parts.box, parts, problem, view, top, out)
    tell_elevation(parts.waves, parts, state, out)
    watch_outputs(parts, p, state, out, seen)
    see_cells(parts.relief, problem, view.mesh, view.y, top, state)
    see_clamp(parts.top_clamp, TOP, parts, problem, view.mesh, view.y, top, tension.top, state)
    see_clamp(parts.lower_clamp, BELOW, parts, problem, view.mesh, view.y, top, tension.lower, state)
    along = dot(vector_at(parts, state, header.TOP + 3), t.top)
    if parts.driven is not None:
        along -= dot(vector_at(parts, state, header.LOWER + 3), t.lower)
    watch_set_off(parts, p, state, along, out)


@kernel
def _tell_counts(state, out):
    out[15] = state[header.STEPS]
    out[16] = state[header.NEWTON]
    out[17] = state[header.REJECTED]


@kernel
def _tell_nothing(parts, state, out):
    """The outputs of a cable of which nothing is left: its lower end is its top, which bears nothing."""
    for k in range(out.shape[0]):
        out[k] = 0.0
    for k in range(3):
        out[5 + k] = state[header.TOP + k]
        out[8 + k] = state[header.TOP + 3 + k]
    _tell_counts(state, out)
    tell_exchange(state, out)
    tell_whole(0.0, state[header.PAID_OUT], out)
    out[HAS_PARTED] = state[header.PARTED]
    tell_elevation(parts.waves, parts, state, out)


@kernel
def _declination(t):
    """Angle from straight down of a cable whose tangent towards the top is t."""
    return math.acos(min(1.0, max(-1.0, t[len(t) - 1])))


@kernel
def _tell_lower_end(driven, parts, force, t, out):
    if driven is None:
        for k in range(3):
            out[LOWER_FORCES + k] = 0.0
        out[LOWER_MEANS + 3] = 0.0
        return
    _spread(parts.space, force, 0.0, out, LOWER_FORCES)
    out[LOWER_MEANS + 3] = _declination(t)


@kernel
def in_axes(space, a, y):
    """A vector of the chain's dimension as (x, y, z), `y` in the plane."""
    if space is not None:
        return (a[0], a[1], a[2])
    return (a[0], y, a[1])


@kernel
def _spread(space, a, y, out, k):
    """Write a vector of the chain's dimension as x, y, z from out[k] on."""
    out[k] = a[0]
    out[k + 1] = y
    out[k + 2] = a[len(a) - 1]
    if space is not None:
        out[k + 1] = a[1]
