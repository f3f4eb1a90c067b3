"""Ends that are clamped in a direction d, which the cable's tangent has there: a bend stiffener, a built-in riser.

The half of a cell between its middle and the clamp bends as a node's two halves do, see staggered.py.  With the cell vector q the energy is

    E = k (|q| - q.d),   k = EI/(half the cell)

which is k a^2/2 at a small angle a between them, and nothing where they agree, however far the cell is stretched.  The clamp is turned with
the torque k d x q, so that forces and torques of the whole are in balance, whatever the mesh.
"""

import math
from typing import NamedTuple

from cable_model.kernels.cells import of_cell
from cable_model.kernels.choice import by_presence
from cable_model.kernels.jit import kernel
from cable_model.kernels.vector import (
    add_matrix,
    axes,
    axpy,
    diagonal,
    dot,
    load,
    load_matrix,
    norm,
    outer,
    scale,
    scale_matrix,
    store,
    store_matrix,
    sub,
    zero,
)
from cable_model.kernels.watch_outputs import watch_clamp

TOP, BELOW = True, False  # which end: `upper` in what follows


class Clamp(NamedTuple):
    """What holds an end."""

    cell: int  # next to it
    direction: object  # d, towards the top
    stiffness: float  # k, N m


@kernel
def clamp_of(upper, parts, problem, mesh):
    """The clamp of an end."""
    p = problem.numbers
    i = mesh.shape[0] - 1 if upper else 0
    half = (1.0 - mesh[i, 1] if upper else mesh[i, 1]) * mesh[i, 0]
    stiffness = of_cell(parts.sections, parts, problem, mesh, i).numeric.bending / half
    return Clamp(i, direction_of(upper, parts, p), stiffness)


@kernel
def direction_of(upper, parts, p):
    """Of the cable at a clamp, towards the top: it leaves the top downwards and the lower end upwards, at the angles that are given."""
    top, end = p[0].top, p[0].lower_end
    lean = top.clamp_declination if upper else end.clamp_declination
    towards = top.clamp_direction if upper else end.clamp_direction
    across = -math.sin(lean) if upper else math.sin(lean)
    return axes(parts.space, across * math.cos(towards), across * math.sin(towards), math.cos(lean))


@kernel
def _adds_nothing(present, upper, parts, problem, gains, mesh, q, bands, x, like):
    return


@kernel
def _adds(present, upper, parts, problem, gains, mesh, q, bands, x, like):
    """The clamp's force on the nodes of its cell into minus the residual, and its derivative."""
    clamp = clamp_of(upper, parts, problem, mesh)
    low, inv = clamp.cell, 1.0 / mesh[clamp.cell, 0]
    qi = load(q, low, like)
    stretch = norm(qi)
    t = scale(1.0 / stretch, qi)
    turn = scale(clamp.stiffness * inv, sub(t, clamp.direction))
    store(x, low, axpy(1.0, turn, load(x, low, like)))
    store(x, low + 1, axpy(-1.0, turn, load(x, low + 1, like)))
    size = clamp.stiffness * gains.q * inv * inv / stretch
    across = scale_matrix(size, add_matrix(diagonal(1.0, like), scale_matrix(-1.0, outer(t, t))))
    against = scale_matrix(-1.0, across)
    store_matrix(bands, 2, low, add_matrix(load_matrix(bands, 2, low, like), across))
    store_matrix(bands, 3, low, add_matrix(load_matrix(bands, 3, low, like), against))
    store_matrix(bands, 1, low + 1, add_matrix(load_matrix(bands, 1, low + 1, like), against))
    store_matrix(bands, 2, low + 1, add_matrix(load_matrix(bands, 2, low + 1, like), across))


_add = by_presence(_adds_nothing, _adds)


@kernel
def add_clamps(parts, problem, gains, mesh, q, lowest, bands, x, like):
    """Of a cable from node `lowest` on; where it is cut off above, the row there is not asked for."""
    _add(parts.top_clamp, TOP, parts, problem, gains, mesh, q, bands, x, like)
    if lowest == 0:
        _add(parts.lower_clamp, BELOW, parts, problem, gains, mesh, q, bands, x, like)


@kernel
def _unturned(present, upper, parts, problem, mesh, q, like):
    return zero(like)


@kernel
def _turned(present, upper, parts, problem, mesh, q, like):
    clamp = clamp_of(upper, parts, problem, mesh)
    qi = load(q, clamp.cell, like)
    return scale(clamp.stiffness, sub(scale(1.0 / norm(qi), qi), clamp.direction))


turned = by_presence(_unturned, _turned)  # k (t - d), N m: the derivative of E by the cell vector


@kernel
def _no_energy(present, upper, parts, problem, mesh, q, like):
    return 0.0


@kernel
def _energy(present, upper, parts, problem, mesh, q, like):
    clamp = clamp_of(upper, parts, problem, mesh)
    qi = load(q, clamp.cell, like)
    return clamp.stiffness * (norm(qi) - dot(qi, clamp.direction))


clamp_energy = by_presence(_no_energy, _energy)  # E, J


@kernel
def _as_led_on(present, upper, parts, p, tangent):
    return tangent


@kernel
def _as_held(present, upper, parts, p, tangent):
    return direction_of(upper, parts, p)


held_tangent = by_presence(_as_led_on, _as_held)  # of the cable at an end: `tangent`, or the clamp's


@kernel
def _nothing_seen(present, upper, parts, problem, mesh, q, like, tension, state):
    return


@kernel
def _seen(present, upper, parts, problem, mesh, q, like, tension, state):
    clamp = clamp_of(upper, parts, problem, mesh)
    bending = of_cell(parts.sections, parts, problem, mesh, clamp.cell).numeric.bending
    angle = norm(_turned(present, upper, parts, problem, mesh, q, like)) / clamp.stiffness
    watch_clamp(state, angle, bending, tension, mesh[clamp.cell, 0])


see_clamp = by_presence(_nothing_seen, _seen)  # warnings of what cells do not resolve


@kernel
def _tell_cross(k, d, q, out, at):
    """k d x q."""
    if len(d) == 2:
        out[at + 1] = k * (d[1] * q[0] - d[0] * q[1])
    else:
        out[at] = k * (d[1] * q[2] - d[2] * q[1])
        out[at + 1] = k * (d[2] * q[0] - d[0] * q[2])
        out[at + 2] = k * (d[0] * q[1] - d[1] * q[0])


@kernel
def _no_torque(present, upper, parts, problem, mesh, q, like, out, at):
    return 0.0


@kernel
def _torque(present, upper, parts, problem, mesh, q, like, out, at):
    clamp = clamp_of(upper, parts, problem, mesh)
    _tell_cross(clamp.stiffness, clamp.direction, load(q, clamp.cell, like), out, at)
    return (out[at] ** 2 + out[at + 1] ** 2 + out[at + 2] ** 2) ** 0.5


tell_torque = by_presence(_no_torque, _torque)  # k d x q, on what holds an end, into out[at:at + 3]; its size, N m
