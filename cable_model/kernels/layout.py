"""The chain's state vector: the header, then mesh, Y, Y', Y'' (backward difference of Y'), and what else predicts the next step.

What that is, is the grid's: see grid.keep.  Nothing here moves anything.
"""

from typing import NamedTuple

from cable_model.kernels import grid, header
from cable_model.kernels.choice import by_presence
from cable_model.kernels.friction import slider_count
from cable_model.kernels.jit import kernel, views
from cable_model.kernels.path import COLUMNS, PATH, ROWS
from cable_model.kernels.problem import node_count
from cable_model.kernels.sections import mesh_columns
from cable_model.kernels.vector import axes
from cable_model.kernels.wave_records import MANY, Records, record_sizes, with_records
from cable_model.kernels.wave_terms import TERMS


class View(NamedTuple):
    """The arrays of a state vector and its work vector."""

    mesh: object
    y: object
    yd: object
    ydd: object
    y_old: object
    contraction: object  # (1,)
    force: object
    force_old: object
    sliders: object  # stretch of the springs of friction.py
    y1: object
    yd1: object
    yd0: object
    bridge: object  # (9, 7): path of the ends over the pending time, see pending.py
    scratch: object


@kernel
def _all_nodes(parting, p, state):
    return node_count(p)


@kernel
def _nodes_left(parting, p, state):
    return int(state[header.NODES])


nodes_now = by_presence(_all_nodes, _nodes_left)


@kernel
def state_size(parts, p):
    n = node_count(p)
    rows, columns, kept, tensions = grid.shape(parts.box, parts.bending, n, axes(parts.space, 0.0, 0.0, 0.0))
    return (
        header.HEADER
        + mesh_columns(parts.sections) * (n - 1)
        + (3 * rows + kept + slider_count(parts.friction, n)) * columns
        + 2 * tensions
        + _size_of_records(parts.followed, parts, p)
    )


@kernel
def work_size(parts, p):
    return _room_of_steps(parts, p) + TERMS * _count(parts.followed, parts.waves)


@kernel
def _room_of_steps(parts, p):
    n = node_count(p)
    like = axes(parts.space, 0.0, 0.0, 0.0)
    rows, columns, _, _ = grid.shape(parts.box, parts.bending, n, like)
    return PATH + 3 * rows * columns + grid.scratch_size(parts.box, parts.bending, n, like)


@kernel
def _no_table(table, axis):
    return 0


@kernel
def _length(table, axis):
    return table.shape[axis]


_length_of = by_presence(_no_table, _length)


@kernel
def _none(followed, waves):
    return 0


@kernel
def _many(followed, waves):
    count = _length_of(waves, 1)
    return count if count >= MANY else 0


_count = by_presence(_none, _many)  # of the components of waves in which points are followed


@kernel
def _points(parts, p):
    """Cells, the lower end and bodies on the cable, in this order: what reads the waves."""
    return node_count(p) + _length_of(parts.line_bodies, 0)


@kernel
def _surface_points(parts, p):
    return 0 if parts.stretched is None and parts.cut is None else _points(parts, p)


@kernel
def _no_records(followed, parts, p):
    return 0


@kernel
def _records(followed, parts, p):
    if _count(followed, parts.waves) == 0:
        return 0
    water, surface = record_sizes(axes(parts.space, 0.0, 0.0, 0.0))
    return _points(parts, p) * water + _surface_points(parts, p) * surface


_size_of_records = by_presence(_no_records, _records)


@kernel
def with_waves_followed(followed, parts, p, state, work):
    """The parts with the records of waves, which are the state's last numbers, where the part `followed` is present."""
    water, surface = record_sizes(axes(parts.space, 0.0, 0.0, 0.0))
    size = _size_of_records(followed, parts, p)
    if size == 0:
        return parts
    count = _count(followed, parts.waves)
    n, m = _points(parts, p), _surface_points(parts, p)
    first, end, terms = state.shape[0] - size, state.shape[0], work[_room_of_steps(parts, p) :]
    records = Records(
        state[first : first + n * water].reshape((n, water)),
        state[first + n * water : end].reshape((m, surface)),
        terms[: TERMS * count].reshape((TERMS, count)),
    )
    return with_records(parts, records)


@views
def cut(parts, p, state, work):
    n = nodes_now(parts.parting, p, state)
    like = axes(parts.space, 0.0, 0.0, 0.0)
    rows, d, kept, tensions = grid.shape(parts.box, parts.bending, n, like)
    m = rows * d
    wide = mesh_columns(parts.sections)
    o = header.HEADER + wide * (n - 1)
    e = o + 3 * m + kept * d
    f = e + 2 * tensions
    sliders = slider_count(parts.friction, n)
    return View(
        state[header.HEADER : o].reshape((n - 1, wide)),
        state[o : o + m].reshape((rows, d)),
        state[o + m : o + 2 * m].reshape((rows, d)),
        state[o + 2 * m : o + 3 * m].reshape((rows, d)),
        state[o + 3 * m : e].reshape((kept, d)),
        state[header.CONTRACTION : header.CONTRACTION + 1],
        state[e : e + tensions],
        state[e + tensions : f],
        state[f : f + sliders * d].reshape((sliders, d)),
        work[PATH : PATH + m].reshape((rows, d)),
        work[PATH + m : PATH + 2 * m].reshape((rows, d)),
        work[PATH + 2 * m : PATH + 3 * m].reshape((rows, d)),
        work[0:PATH].reshape((ROWS, COLUMNS)),
        grid.cut_scratch(parts.box, parts.bending, work[PATH + 3 * m :], n, like),
    )


@views
def led_on(parts, view, time, last, offset):
    """The state some time after the last step, which is left as it is."""
    if time == 0.0:
        return view
    grid.lead_on(parts.box, view, time, last, offset)
    return View(
        view.mesh, view.y1, view.yd1, view.ydd, view.y_old, view.contraction, view.force, view.force_old, view.sliders, view.y1,
        view.yd1, view.yd0, view.bridge, view.scratch,
    )  # fmt: skip


@kernel
def vector_at(parts, state, k):
    """A vector of the state's head, in the chain's own dimension."""
    return axes(parts.space, state[k], state[k + 1], state[k + 2])
