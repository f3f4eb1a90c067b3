"""How much of the cable hangs and how much lies, what bends it most, and the waves over its top: what outputs tell of the whole of it.

The cable touches down, seen from its top, where the seabed carries half of what it carries of one that lies; what hangs is the
unstretched length above.
"""

from cable_model.kernels import header
from cable_model.kernels.bottom import normal_under, over_bottom
from cable_model.kernels.cells import of_cell, turn_stiffness
from cable_model.kernels.choice import by_presence
from cable_model.kernels.clamps import BELOW, TOP, tell_torque
from cable_model.kernels.contact import FORCE
from cable_model.kernels.jit import kernel
from cable_model.kernels.line_bodies import weight_on
from cable_model.kernels.problem import body_weight, density_of
from cable_model.kernels.vector import axpy, load, mix, norm, sub
from cable_model.kernels.watch_outputs import watch_cell
from cable_model.kernels.waves import elevation

MOMENT, HANGING, REACTION, TOUCHDOWN = 34, 35, 36, 37  # of the outputs; the last is the first of three
PAID_OUT, ELEVATION, HAS_PARTED, REMAINING = 40, 41, 42, 43  # likewise
TORQUES = 44  # of both ends, three each
CARRIED = 0.5  # of what a bottom carries of a node that lies on it, where the cable touches down


@kernel
def tell_whole(length, paid_out, out):
    """What holds of a whole cable without a seabed and bending: all hangs, down to the lower end that the outputs have."""
    out[MOMENT] = 0.0
    out[HANGING] = length
    out[REACTION] = 0.0
    for k in range(3):
        out[TOUCHDOWN + k] = out[5 + k]
    out[PAID_OUT] = paid_out
    out[HAS_PARTED] = 0.0
    out[REMAINING] = length
    for k in range(6):
        out[TORQUES + k] = 0.0


@kernel
def _over_plane(space, waves, ramp, state):
    return elevation(waves, ramp, (state[header.TOP], state[header.TOP + 2]), state[header.TIME])[0]


@kernel
def _over_space(space, waves, ramp, state):
    return elevation(waves, ramp, (state[header.TOP], state[header.TOP + 1], state[header.TOP + 2]), state[header.TIME])[0]


_over_top = by_presence(_over_plane, _over_space)


@kernel
def _calm(waves, parts, state, out):
    out[ELEVATION] = 0.0


@kernel
def _wavy(waves, parts, state, out):
    out[ELEVATION] = _over_top(parts.space, waves, parts.wave_ramp, state)


tell_elevation = by_presence(_calm, _wavy)  # of either model


@kernel
def _weight_at(parts, problem, mesh, i):
    """Weight in the medium that node i carries, N."""
    above = of_cell(parts.sections, parts, problem, mesh, i).cable.weight * mesh[i, 1] * mesh[i, 0]
    if i == 0:
        return above + body_weight(problem.body)
    below = of_cell(parts.sections, parts, problem, mesh, i - 1).cable.weight * (1.0 - mesh[i - 1, 1]) * mesh[i - 1, 0]
    return above + below + weight_on(parts.line_bodies, mesh, i, density_of(parts.water, problem.numbers), problem.cable.gravity)


@kernel
def _no_bottom(seabed, parts, problem, mesh, y, contact, top, out):
    return


@kernel
def _on_bottom(seabed, parts, problem, mesh, y, contact, top, out):
    position = top
    touched = False
    hanging = 0.0
    before = 0.0  # share of the weight that the seabed carries at the node above
    reaction = 0.0
    for i in range(mesh.shape[0] - 1, -1, -1):
        lower = axpy(-mesh[i, 0], load(y, i, top), position)
        up = normal_under(problem.ground.relief, problem.ground, contact, i, top)[len(top) - 1]
        reaction += contact[i, FORCE] * up
        now = contact[i, FORCE] / max(up * abs(_weight_at(parts, problem, mesh, i)), 1e-300)
        if not touched and now >= CARRIED:
            touched = True
            share = (CARRIED - before) / (now - before)
            hanging += share * mesh[i, 0]
            at = mix(1.0 - share, position, share, lower)
            out[HANGING] = hanging
            out[TOUCHDOWN] = at[0]
            out[TOUCHDOWN + 2] = at[len(at) - 1]
            if parts.space is not None:
                out[TOUCHDOWN + 1] = at[1]
        hanging += mesh[i, 0]
        before = now
        position = lower
    out[REACTION] = reaction


tell_bottom = by_presence(_no_bottom, _on_bottom)


@kernel
def _as_ends(relief, problem, mesh, y, top, state):
    return


@kernel
def _between_ends(relief, problem, mesh, y, top, state):
    """Of a bottom that is no plane: what cells cut through, which feel it at their ends."""
    position = top
    above = over_bottom(relief, problem.ground, top)[0]
    for i in range(mesh.shape[0] - 1, -1, -1):
        half = 0.5 * mesh[i, 0]
        middle = axpy(-half, load(y, i, top), position)
        position = axpy(-half, load(y, i, top), middle)
        below = over_bottom(relief, problem.ground, position)[0]
        watch_cell(state, over_bottom(relief, problem.ground, middle)[0], 0.5 * (above + below), mesh[i, 0])
        above = below


see_cells = by_presence(_as_ends, _between_ends)


@kernel
def _limp(bending, parts, problem, mesh, y, top, out):
    return


@kernel
def _stiff(bending, parts, problem, mesh, y, top, out):
    largest = 0.0
    for j in range(1, mesh.shape[0]):
        turn = norm(sub(load(y, j, top), load(y, j - 1, top)))
        largest = max(largest, turn_stiffness(parts.sections, parts, problem, mesh, j) * turn)
    at_top = tell_torque(parts.top_clamp, TOP, parts, problem, mesh, y, top, out, TORQUES)
    below = tell_torque(parts.lower_clamp, BELOW, parts, problem, mesh, y, top, out, TORQUES + 3)
    out[MOMENT] = max(largest, at_top, below)


tell_moment = by_presence(_limp, _stiff)


@kernel
def _limp_box(bending, problem, y, out):
    return


@kernel
def _stiff_box(bending, problem, y, out):
    largest = 0.0
    for j in range(y.shape[0]):
        largest = max(largest, abs(y[j, y.shape[1] - 1]))
    out[MOMENT] = problem.numeric.bending * largest


tell_box_moment = by_presence(_limp_box, _stiff_box)
