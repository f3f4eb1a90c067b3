"""What happens in an instant: an end that is suddenly free, and the front that runs up from it; a cable that parts."""

import math

from cable_model.kernels import grid, header
from cable_model.kernels.audit import reopen_audit
from cable_model.kernels.cells import of_cell
from cable_model.kernels.chain_ends import accelerations_on, ends_on, in_water_at
from cable_model.kernels.chain_step import winding_at
from cable_model.kernels.choice import by_presence
from cable_model.kernels.family import coefficients
from cable_model.kernels.jit import kernel
from cable_model.kernels.parting import load_at_start
from cable_model.kernels.slack import floor

IN_FRONT = 0.1  # of the time in which it runs through a cell: internal steps at a front
BEHIND_FRONT = 1.2  # by how much they grow from one to the next
PRESSES = 2.0  # times what pulled there, at least: behind a front that is thrown back a cell is pressed by as much
TINY_STEP = 1e-4  # of the base step, or of sqrt(L/g), or of what the error control proposed: over one, differences of rates are rounding


@kernel
def natural_step(p, cable):
    """The longest internal step, but at most the time in which the cable swings."""
    return min(p[0].solver.time_step, math.sqrt(cable.length / max(cable.gravity, 1e-3)))


@kernel
def _comes_back(slack, parts, p, problem, view, state):
    """Of a cable that may be pressed: what its end overshoots is pushed back."""
    return


@kernel
def _front(slack, parts, p, problem, view, state):
    """Begin with steps that resolve the front that runs up from an end which is suddenly free, and let them grow slowly.

    In steps longer than its way through a cell the end overshoots what it should get; and cells that go slack do not push it back: it
    would fly off at several times its speed.  Where bending lets cells be pressed by as much, they do.
    """
    mesh = view.mesh
    shortest = p[0].solver.time_step
    for i in range(mesh.shape[0]):
        own = of_cell(parts.sections, parts, problem, mesh, i).cable
        shortest = min(shortest, IN_FRONT * mesh[i, 0] * math.sqrt(own.mass / own.stiffness))
    lowest = of_cell(parts.sections, parts, problem, mesh, 0)
    cells = p[0].solver.time_step / mesh[0, 0] * math.sqrt(lowest.cable.stiffness / lowest.cable.mass)
    c = coefficients(int(p[0].solver.integrator), p[0].solver.lambda_infinity)
    kick = abs(1.0 - c.gamma - c.gamma * c.alpha_m / (1.0 - c.alpha_m))  # velocity after a step over its first acceleration times the step
    if view.force[0] * max(PRESSES, 2.0 * kick * cells * cells) > floor(parts, lowest.numeric, mesh[0, 0]):
        state[header.NEXT_STEP] = max(shortest, TINY_STEP * natural_step(p, problem.cable))
        state[header.FRONT] = 1.0


follow_front = by_presence(_comes_back, _front)


@kernel
def aim_behind_front(p, state, aim, used):
    """The internal step to aim at after one of `used`, which may have been cut; it grows only by steps that were about as long as aimed at.

    No more where it is as long as others: then the front is left to itself.
    """
    if used >= 0.5 * aim:
        aim *= BEHIND_FRONT
    if aim >= p[0].solver.time_step:
        state[header.FRONT] = -1.0
    return aim


@kernel
def _stays(parting, parts, p, problem, view, state, course, time, done):
    return header.OK


@kernel
def _set_off_again(parting, parts, p, problem, view, state, course, time, done):
    """Rates of what is left of a cable that has parted `done` after the communication step began: they go with its new lower end."""
    parts = in_water_at(parts, course, time, done)
    winding = winding_at(parts.winch, parts, problem, view, state, course, done)
    places, velocities = ends_on(parts, course, done)
    accelerations = accelerations_on(parts, course, done)
    status = grid.starting_rates(parts.box, parts, problem, p, view, places.top, velocities, accelerations, winding, time + done)
    if status != header.OK:
        state[header.ERROR_TIME] = time + done
        return status
    size = view.ydd.size
    change = view.ydd.reshape(size)
    for i in range(size):
        change[i] = 0.0
    follow_front(parts.slack, parts, p, problem, view, state)
    load_at_start(parts.parting, parts, problem, view, state, places.top)
    reopen_audit(parts.audit, parts, problem, view, state, places.top)
    return header.OK


set_off_again = by_presence(_stays, _set_off_again)
