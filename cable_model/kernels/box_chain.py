"""Static equilibrium, starting rates, positions and outputs of the chain on the box grid."""

import math

from cable_model.kernels import header, staggered_statics, staggered_step
from cable_model.kernels.box_law import strain, tension
from cable_model.kernels.box_step import force_scale, newton_step, speed_scale
from cable_model.kernels.choice import by_presence
from cable_model.kernels.family import Coefficients
from cable_model.kernels.jit import kernel
from cable_model.kernels.mesh import fill_mesh
from cable_model.kernels.problem import Cable, Problem, body_weight, with_tolerance
from cable_model.kernels.vector import copy_to

STATIC_STEPS = 100


@kernel
def place_nodes(problem, grading, mesh):
    """Uniform unless a grading is asked for."""
    fill_mesh(mesh, max(grading, 1.0), problem.cable.length, body_weight(problem.body), problem.cable.weight)


@kernel
def statics_size(n):
    """Work of the staggered grid's statics."""
    return 17 * n + staggered_step.scratch_size(n, 2)


@kernel
def _guess_stiffness(inextensible, cable, weight):
    if inextensible is None:
        return cable.stiffness
    return 1e4 * weight


@kernel
def _staggered_guess(parts, problem, p, mesh, y, contraction, top, anchor, time, work):
    """Equilibrium on the staggered grid, its cells' tensions and angles taken to the nodes."""
    n = mesh.shape[0] + 1
    m = 4 * n
    weight = force_scale(problem)
    c = problem.cable
    cable = Cable(c.length, c.diameter, c.mass, _guess_stiffness(parts.inextensible, c, weight), c.gravity, c.weight)
    q = work[0:m].reshape((2 * n, 2))
    force = work[4 * m : 4 * m + n - 1]
    status = staggered_statics.equilibrium(
        parts, Problem(cable, problem.medium, problem.body, problem.numeric, problem.ground, p), p, max(p[0].solver.grading, 1.0), mesh, q,
        work[m : 2 * m].reshape((2 * n, 2)), contraction, work[2 * m : 3 * m].reshape((2 * n, 2)), work[3 * m : 4 * m].reshape((2 * n, 2)),
        force, top, anchor, time, staggered_step.cut_scratch(work[4 * m + n :], n, (0.0, 0.0)),
    )  # fmt: skip
    if status != header.OK:
        return status
    size = y.shape[1]
    firm = 1.0
    if parts.inextensible is None:
        firm = c.stiffness
    y[:, :] = 0.0
    above = math.atan2(q[n - 2, 0], q[n - 2, 1])
    y[n - 1, 0] = force[n - 2] / firm
    y[n - 1, size // 3 + 2] = above
    for i in range(n - 2, -1, -1):
        phi = above
        if i > 0:
            phi = math.atan2(q[i - 1, 0], q[i - 1, 1])
            phi += 2.0 * math.pi * math.floor((above - phi) / (2.0 * math.pi) + 0.5)
        y[i, size // 3 + 2] = 0.5 * (above + phi)
        y[i, 0] = 0.5 * (force[i] + force[max(i - 1, 0)]) / firm
        above = phi
    return header.OK


@kernel
def _drift(anchor, inextensible, mesh, y, top, step):
    """Velocity of the top that closes the gap between an anchored cable and its top within a step."""
    if anchor is None:
        return (0.0, 0.0)
    x, z = anchored_top(anchor, inextensible, mesh, y)
    return ((top[0] - x) / step, (top[1] - z) / step)


@kernel
def anchored_top(anchor, inextensible, mesh, y):
    """Place of the top as the cells lead from the anchor to it."""
    x, z = anchor
    for i in range(mesh.shape[0]):
        q = cell_vector(inextensible, y, i)
        x += mesh[i, 0] * q[0]
        z += mesh[i, 0] * q[1]
    return x, z


@kernel
def cell_vector(inextensible, y, i):
    """(1 + eps) t of cell i in axes (x, z); its rate of change is what u, v and phi say, exactly."""
    cf = y.shape[1] // 3 + 2
    phi = 0.5 * (y[i, cf] + y[i + 1, cf])
    stretch = 1.0 + strain(inextensible, 0.5 * (y[i, 0] + y[i + 1, 0]))
    return (stretch * math.sin(phi), stretch * math.cos(phi))


@kernel
def _long(surface):
    return 1e5


@kernel
def _longer(surface):
    return 4e5


_last_step = by_presence(_long, _longer)  # in sqrt(L/g); heights above the surface follow a top that is still being closed on a step late


@kernel
def equilibrium(parts, problem, p, mesh, y, yd, contraction, y1, yd1, top, anchor, time, s):
    """Static equilibrium: the staggered grid's, then backward differences on the box equations with ever longer steps.

    The last steps are so long that only the static equations are left, so the cable stays where it is to rounding errors.
    """
    status = _staggered_guess(parts, problem, p, mesh, y, contraction, top, anchor, time, s.whole)
    if status != header.OK:
        return status
    exact = with_tolerance(problem, 1e-11 * speed_scale(problem), 0.0)
    yd[:, :] = 0.0
    cu = y.shape[1] // 3
    period = math.sqrt(problem.cable.length / max(problem.cable.gravity, 1e-3))
    step = period
    backward = Coefficients(0.0, 0.0, 1.0)
    for _ in range(STATIC_STEPS):
        drift = _drift(anchor, parts.inextensible, mesh, y, top, step)
        contraction[0] = 0.0  # steps differ too much to learn from one another
        status = newton_step(parts, exact, mesh, y, yd, y, 0.0, backward, time, step, top, drift, contraction, y1, yd1, s)
        if status < 0:
            step *= 0.2
            if step < 1e-9 * period:
                return header.NO_EQUILIBRIUM
            continue
        copy_to(y, y1)
        y[:, cu : cu + 2] = 0.0
        if step >= _last_step(parts.surface) * period and status <= 2:
            return header.OK
        step = min(step * (4.0 if status <= 6 else 1.5), 1e6 * period)
    return header.NO_EQUILIBRIUM


@kernel
def starting_rates(parts, problem, mesh, y, yd, contraction, y1, yd1, top, velocity, acceleration, time, h, s):
    """Rates of change at the start, from a backward difference over the first step.

    The cable is in place and at rest but for its top, which already has its prescribed velocity.  A much shorter step would
    leave rates that alternate from node to node: the box sees only their means over the cells.
    """
    size = y.shape[1]
    cu = size // 3
    n = y.shape[0]
    sin = math.sin(y[n - 1, cu + 2])
    cos = math.cos(y[n - 1, cu + 2])
    y[n - 1, cu] = velocity[0] * sin + velocity[1] * cos
    y[n - 1, cu + 1] = velocity[0] * cos - velocity[1] * sin
    ahead = (velocity[0] + h * acceleration[0], velocity[1] + h * acceleration[1])
    backward = Coefficients(0.0, 0.0, 1.0)
    contraction[0] = 0.0
    status = newton_step(parts, problem, mesh, y, yd, y, 0.0, backward, time, h, top, ahead, contraction, y1, yd1, s)
    contraction[0] = 0.0
    if status < 0:
        return header.NOT_FINITE
    copy_to(yd, yd1)
    return header.OK


@kernel
def node_tension(parts, problem, y, yd, ydd, offset, i):
    """N of node i; the rates now are yd - offset ydd."""
    return tension(parts.inextensible, problem.cable, problem.numeric, y[i, 0], yd[i, 0] - offset * ydd[i, 0])


@kernel
def measure(parts, problem, mesh, y, yd, ydd, offset, top, threshold):
    """Force on the attachment, tangent there, place and velocity of the lower end, tensions at the lower end, largest and
    smallest in the cells, and the length of cells below the threshold.  The rates now are yd - offset ydd."""
    n, size = y.shape
    cu = size // 3
    largest = 0.0
    smallest = 1e300
    slack = 0.0
    x, z = top
    above = node_tension(parts, problem, y, yd, ydd, offset, n - 1)
    pulled = above
    for i in range(n - 2, -1, -1):
        below = node_tension(parts, problem, y, yd, ydd, offset, i)
        mean = 0.5 * (above + below)
        largest = max(largest, mean)
        smallest = min(smallest, mean)
        if mean < threshold:
            slack += mesh[i, 0]
        q = cell_vector(parts.inextensible, y, i)
        x -= mesh[i, 0] * q[0]
        z -= mesh[i, 0] * q[1]
        above = below
    s = math.sin(y[n - 1, cu + 2])
    c = math.cos(y[n - 1, cu + 2])
    force = _turned(pulled, _shear(parts.bending, y, n - 1), s, c)
    s0 = math.sin(y[0, cu + 2])
    c0 = math.cos(y[0, cu + 2])
    velocity = (y[0, cu] * s0 + y[0, cu + 1] * c0, y[0, cu] * c0 - y[0, cu + 1] * s0)
    return force, (s, c), (x, z), velocity, above, largest, smallest, slack / problem.cable.length


@kernel
def _turned(tension, shear, s, c):
    """Force on the attachment, in axes (x, z), of tension and shear at the top."""
    return (-tension * s - shear * c, -tension * c + shear * s)


@kernel
def mean_force(parts, problem, family, y0, yd0, y1, yd1):
    """Force of the cable on its attachment in the step just taken: that at the averaged time."""
    top = y0.shape[0] - 1
    new, old = 1.0 - family.alpha_k, family.alpha_k
    turn = y0.shape[1] // 3 + 2
    phi = new * y1[top, turn] + old * y0[top, turn]
    rate = (1.0 - family.alpha_m) * yd1[top, 0] + family.alpha_m * yd0[top, 0]
    pulled = tension(parts.inextensible, problem.cable, problem.numeric, new * y1[top, 0] + old * y0[top, 0], rate)
    shear = new * _shear(parts.bending, y1, top) + old * _shear(parts.bending, y0, top)
    return _turned(pulled, shear, math.sin(phi), math.cos(phi))


@kernel
def _shear(bending, y, i):
    if bending is None:
        return 0.0
    return y[i, 1]
