"""Ends that are clamped in a direction d, which the cable's tangent has there: a bend stiffener, a built-in riser.

The half of a cell between its middle and the clamp bends as a node's two halves do (see staggered.py), with the energy

    E = k |q - d|^2/2,   k = EI/(half the cell)

and turns the clamp with the torque k d x q, so that forces and torques of the whole are in balance, whatever the mesh.
"""

import math

from cable_model.kernels.cells import of_cell
from cable_model.kernels.choice import by_presence
from cable_model.kernels.jit import kernel
from cable_model.kernels.vector import axes, axpy, dot, load, norm, scale, store, sub, zero
from cable_model.kernels.watch import watch_clamp


@kernel
def upper_direction(parts, p):
    """Of the clamp at the top: of the cable towards the top, where it leaves it at these angles."""
    top = p[0].top
    across = -math.sin(top.clamp_declination)
    return axes(
        parts.space, across * math.cos(top.clamp_direction), across * math.sin(top.clamp_direction), math.cos(top.clamp_declination)
    )  # fmt: skip


@kernel
def lower_direction(parts, p):
    """Of the clamp at the lower end: of the cable towards the top."""
    end = p[0].lower_end
    across = math.sin(end.clamp_declination)
    return axes(
        parts.space, across * math.cos(end.clamp_direction), across * math.sin(end.clamp_direction), math.cos(end.clamp_declination)
    )  # fmt: skip


@kernel
def stiffness_at_top(parts, problem, mesh):
    """k of the last cell, N m."""
    i = mesh.shape[0] - 1
    return of_cell(parts.sections, parts, problem, mesh, i).numeric.bending / ((1.0 - mesh[i, 1]) * mesh[i, 0])


@kernel
def stiffness_below(parts, problem, mesh):
    """k of the first cell, N m."""
    return of_cell(parts.sections, parts, problem, mesh, 0).numeric.bending / (mesh[0, 1] * mesh[0, 0])


@kernel
def _add(k, d, gains, mesh, q, low, bands, x, like):
    """The clamp's force on the nodes of cell `low` into minus the residual, and its derivative."""
    inv = 1.0 / mesh[low, 0]
    turn = scale(k * inv, sub(load(q, low, like), d))
    store(x, low, axpy(1.0, turn, load(x, low, like)))
    store(x, low + 1, axpy(-1.0, turn, load(x, low + 1, like)))
    size = k * gains.q * inv * inv
    for j in range(len(like)):
        place = j * (len(like) + 1)
        bands[2, low, place] += size
        bands[3, low, place] -= size
        bands[1, low + 1, place] -= size
        bands[2, low + 1, place] += size


@kernel
def _free_top(clamp, parts, problem, gains, mesh, q, bands, x, like):
    return


@kernel
def _held_top(clamp, parts, problem, gains, mesh, q, bands, x, like):
    _add(
        stiffness_at_top(parts, problem, mesh), upper_direction(parts, problem.numbers), gains, mesh, q, mesh.shape[0] - 1, bands, x, like
    )  # fmt: skip


_add_top = by_presence(_free_top, _held_top)


@kernel
def _free_below(clamp, parts, problem, gains, mesh, q, bands, x, like):
    return


@kernel
def _held_below(clamp, parts, problem, gains, mesh, q, bands, x, like):
    _add(stiffness_below(parts, problem, mesh), lower_direction(parts, problem.numbers), gains, mesh, q, 0, bands, x, like)


_add_below = by_presence(_free_below, _held_below)


@kernel
def add_clamps(parts, problem, gains, mesh, q, lowest, bands, x, like):
    """Of a cable from node `lowest` on; where it is cut off above, the row there is not asked for."""
    _add_top(parts.top_clamp, parts, problem, gains, mesh, q, bands, x, like)
    if lowest == 0:
        _add_below(parts.lower_clamp, parts, problem, gains, mesh, q, bands, x, like)


@kernel
def _no_turn(clamp, parts, problem, mesh, q, like):
    return zero(like)


@kernel
def _turned_at_top(clamp, parts, problem, mesh, q, like):
    k = stiffness_at_top(parts, problem, mesh)
    return scale(k, sub(load(q, mesh.shape[0] - 1, like), upper_direction(parts, problem.numbers)))


@kernel
def _turned_below(clamp, parts, problem, mesh, q, like):
    return scale(stiffness_below(parts, problem, mesh), sub(load(q, 0, like), lower_direction(parts, problem.numbers)))


turned_at_top = by_presence(_no_turn, _turned_at_top)  # k (q - d), N m: the derivative of E by the cell vector
turned_below = by_presence(_no_turn, _turned_below)


@kernel
def _no_energy(clamp, parts, problem, mesh, q, like):
    return 0.0


@kernel
def _energy_at_top(clamp, parts, problem, mesh, q, like):
    turned = turned_at_top(clamp, parts, problem, mesh, q, like)
    return 0.5 * dot(turned, turned) / stiffness_at_top(parts, problem, mesh)


@kernel
def _energy_below(clamp, parts, problem, mesh, q, like):
    turned = turned_below(clamp, parts, problem, mesh, q, like)
    return 0.5 * dot(turned, turned) / stiffness_below(parts, problem, mesh)


energy_at_top = by_presence(_no_energy, _energy_at_top)
energy_below = by_presence(_no_energy, _energy_below)


@kernel
def _as_led_on(clamp, parts, p, tangent):
    return tangent


@kernel
def _as_held_at_top(clamp, parts, p, tangent):
    return upper_direction(parts, p)


@kernel
def _as_held_below(clamp, parts, p, tangent):
    return lower_direction(parts, p)


tangent_at_top = by_presence(_as_led_on, _as_held_at_top)  # of the cable at an end: `tangent`, or the clamp's
tangent_below = by_presence(_as_led_on, _as_held_below)


@kernel
def _nothing_seen(clamp, parts, problem, mesh, q, like, tension, state):
    return


@kernel
def _see_top(clamp, parts, problem, mesh, q, like, tension, state):
    k, i = stiffness_at_top(parts, problem, mesh), mesh.shape[0] - 1
    turned = norm(turned_at_top(clamp, parts, problem, mesh, q, like))
    watch_clamp(state, turned, k, k * (1.0 - mesh[i, 1]) * mesh[i, 0], tension, mesh[i, 0])


@kernel
def _see_below(clamp, parts, problem, mesh, q, like, tension, state):
    k = stiffness_below(parts, problem, mesh)
    turned = norm(turned_below(clamp, parts, problem, mesh, q, like))
    watch_clamp(state, turned, k, k * mesh[0, 1] * mesh[0, 0], tension, mesh[0, 0])


see_top = by_presence(_nothing_seen, _see_top)  # warnings of what cells do not resolve
see_below = by_presence(_nothing_seen, _see_below)


@kernel
def _tell(space, d, q, k, out, at):
    """The torque k d x q on what holds an end, N m."""
    if space is None:
        out[at + 1] = k * (d[1] * q[0] - d[0] * q[1])
    else:
        out[at] = k * (d[1] * q[2] - d[2] * q[1])
        out[at + 1] = k * (d[2] * q[0] - d[0] * q[2])
        out[at + 2] = k * (d[0] * q[1] - d[1] * q[0])


@kernel
def _no_torque(clamp, parts, problem, mesh, q, like, out, at):
    return


@kernel
def _torque_at_top(clamp, parts, problem, mesh, q, like, out, at):
    d, k = upper_direction(parts, problem.numbers), stiffness_at_top(parts, problem, mesh)
    _tell(parts.space, d, load(q, mesh.shape[0] - 1, like), k, out, at)


@kernel
def _torque_below(clamp, parts, problem, mesh, q, like, out, at):
    d, k = lower_direction(parts, problem.numbers), stiffness_below(parts, problem, mesh)
    _tell(parts.space, d, load(q, 0, like), k, out, at)


tell_torque_at_top = by_presence(_no_torque, _torque_at_top)
tell_torque_below = by_presence(_no_torque, _torque_below)
