"""The staggered grid: motion at the nodes, tension in the cells; residual and analytic Jacobian of one Newton iteration.

Node 0 is the lower end, node n-1 the prescribed top; cell i joins nodes i and i+1.  State of a step: the cell vectors
q = (r_(i+1) - r_i)/h and the node velocities v.  q is linear in v, so v is the only unknown of the Newton iteration.

    R_i = inertia_i - f_i + f_(i-1) - loads_i = 0,      f = T t + g/h:  the force that cell i exerts on node i

T the tension, g the gradient of the bending energy by q.  All is taken at the averaged time of the
step, and so is the stretch l: the average of the lengths, not the length of the average, along t = q/l.  A cell that turns far
within a step then keeps its length, and with alpha_k = 1/2 the work of T is exactly the change of the strain energy.
Inertia of a cell is shared at its split b (the travel-time midpoint) with weights b - 1/12, 1/12, 1 - b - 1/12:
fourth-order dispersion on smooth meshes.
"""

from cable_model.kernels.block_elimination import clear_outer, identity_row
from cable_model.kernels.cells import of_cell, turn_stiffness
from cable_model.kernels.choice import by_presence
from cable_model.kernels.clamps import BELOW, TOP, add_clamps, turned
from cable_model.kernels.jit import kernel
from cable_model.kernels.line_bodies import ABOVE, joint, row_of
from cable_model.kernels.problem import body_of, thickened
from cable_model.kernels.seabed import node_load
from cable_model.kernels.slack import constitutive, elastic, floor, iterate, shortfall, width, with_quadratic_damping
from cable_model.kernels.staggered_surface import cell_water, lower_end_terms
from cable_model.kernels.staggered_water import SHARE
from cable_model.kernels.vector import (
    add,
    add_matrix,
    apply,
    axpy,
    diagonal,
    dot,
    load,
    load_from,
    load_matrix,
    mix,
    norm,
    outer,
    scale,
    scale_matrix,
    store,
    store_from,
    store_matrix,
    sub,
    upward,
    zero,
)

FADING = -2  # column of the cells: the share of the slack damping that acts


@kernel
def wound(winch, gains, mass, h, split, middle, q, dv):
    """What cable that moves past the nodes adds to a cell: a winch pays out at the top, and node i keeps its share s/L of the length.

    Cable at a node then moves at v - a q, with a = s L'/L, where v is the node's velocity.  Its acceleration is the node's, less
    2 a v_s + (s L''/L) q, plus the derivative of a^2 q along the cable: the last acts as a force m a^2 q against the tension.
    `middle` is s of the cell.  Returns that force per q, the shares of the lower and the upper node, and their derivatives by q
    (times gains.q/h), which stand for those by the velocities.
    """
    if winch is None:
        return 0.0, zero(q), zero(q), 0.0, 0.0
    slide = middle * gains.winding.rate
    load = mix(-2.0 * slide * mass * h, dv, -middle * gains.winding.change * mass * h, q)
    rate = -mass * (2.0 * slide * gains.v + middle * gains.winding.change * gains.q)
    return mass * slide * slide, scale(split, load), scale(1.0 - split, load), split * rate, (1.0 - split) * rate


@kernel
def _slide(winch, gains, s, q, v):
    """Velocity of the cable at a node, or of a cell's middle, that itself moves at v."""
    if winch is None:
        return v
    return axpy(-s * gains.winding.rate, q, v)


@kernel
def assemble(parts, problem, gains, mesh, q, v, a, top, time, lowest, bands, x, cells, contact):
    """Residual (with minus sign, into x) and Jacobian (into bands) of all rows at given q (n-1, D), v and a (n, D).

    The change of a cell's tension, T' = c + b.(v_up' - v_low'), is an unknown of its own and in neither x nor bands: the solver
    eliminates it after the velocity below, so that EA, however large, never swamps the inertia in a sum.
    Cells from `lowest` up are visited: 0 for a step, n-3 where only the top's row is wanted, which asks for two.
    gains: derivatives of q h, v, a and r by the unknown velocities; gains.law 0 takes the tensions as they are.
    cells (>=n-1, 3D+5), a row each: the tension of the slack law, T + T_c, its change c at fixed velocities (written), the averaged
    stretch, the unit tangent at the new time (replaced by that at the averaged time), b (written), D places of the solver, the share of
    the slack damping, the shortfall.
    contact (n, .): the table of contact.py, likewise.
    """
    body, ground = problem.body, problem.ground
    n = v.shape[0]
    position = top
    like = top
    arc = gains.winding.length
    v_up = load(v, n - 1, like)
    a_up = load(a, n - 1, like)
    carry_r = zero(like)
    carry_d = diagonal(0.0, like)
    for i in range(n - 2, lowest - 1, -1):
        h = mesh[i, 0]
        split = mesh[i, 1]
        made = of_cell(parts.sections, parts, problem, mesh, i)
        cable, medium, numeric = made.cable, made.medium, made.numeric
        qi = load(q, i, like)
        v_low = load(v, i, like)
        a_low = load(a, i, like)
        middle = axpy(-0.5 * h, qi, position)
        position = axpy(-h, qi, position)
        stretch = cells[i, 2]
        inv = 1.0 / stretch
        t = scale(inv, qi)
        t_new = load_from(cells, i, 3, like)
        dv = scale(1.0 / h, sub(v_up, v_low))
        rate = dot(dv, t)
        arc -= h
        damping = numeric.voigt + numeric.damping * h * cells[i, FADING]
        strain = stretch - 1.0 + shortfall(parts.slack, cells, i)
        f, stiffness = elastic(parts.curve, cable.stiffness, strain)
        strain_rate = rate - _lengthening(parts.winch, gains, stretch)
        f += damping * strain_rate
        f, damping = with_quadratic_damping(parts.quadratic_damping, problem.numbers, strain_rate, f, damping)
        w0 = width(numeric, h)
        held = floor(parts, numeric, h)
        f += held
        force = iterate(parts.slack, w0, f, cells[i, 0])
        cells[i, 0] = force
        slope, misfit = constitutive(parts.slack, w0, f, force)
        stiffness -= damping * _lengthening(parts.winch, gains, 1.0)
        along = mix(slope * gains.q * stiffness / h, t_new, slope * gains.v * damping / h, t)
        along = axpy(slope * gains.q * damping * inv / h, axpy(-rate, t_new, dv), along)
        thrown, low_wound, up_wound, low_rate, up_rate = wound(parts.winch, gains, cable.mass, h, split, arc + split * h, qi, dv)
        pull = axpy(-thrown, qi, scale(force - held, t))
        firm = (force - held) * inv * gains.q / h
        k = add_matrix(diagonal(firm - thrown * gains.q / h, like), scale_matrix(-firm, outer(t, t_new)))
        low = mix(split - SHARE, a_low, SHARE, a_up)
        up = mix(1.0 - split - SHARE, a_up, SHARE, a_low)
        speed = _slide(parts.winch, gains, arc + split * h, qi, mix(0.5, v_low, 0.5, v_up))
        low_w, up_w, low_q, up_q, low_v, up_v, low_up, up_low, inertia = cell_water(
            parts.surface, parts, medium, cable, h, split, qi, i, middle, speed, low, up, v_low, v_up, time, gains
        )
        down = upward(-cable.weight * h, like)
        low_r = axpy(h, apply(inertia, low), axpy(-split, down, sub(add(low_w, low_wound), pull)))
        up_r = axpy(h, apply(inertia, up), axpy(split - 1.0, down, add(add(up_w, up_wound), pull)))
        # row i+1 is complete now
        m = scale_matrix(h * gains.a, inertia)
        near = scale_matrix(SHARE, m)
        kq_low = add_matrix(diagonal(low_rate, like), add_matrix(scale_matrix(-1.0, k), scale_matrix(gains.q / h, low_q)))
        kq_up = add_matrix(diagonal(up_rate, like), add_matrix(k, scale_matrix(gains.q / h, up_q)))
        store_matrix(bands, 1, i + 1, add_matrix(near, add_matrix(scale_matrix(-1.0, kq_up), up_low)))
        own = add_matrix(scale_matrix(1.0 - split - SHARE, m), add_matrix(kq_up, up_v))
        store_matrix(bands, 2, i + 1, add_matrix(carry_d, own))
        store(x, i + 1, scale(-1.0, add(carry_r, up_r)))
        store_matrix(bands, 3, i, add_matrix(near, add_matrix(kq_low, low_up)))
        carry_d = add_matrix(scale_matrix(split - SHARE, m), add_matrix(scale_matrix(-1.0, kq_low), low_v))
        carry_r = low_r
        carry_r, carry_d = add_seabed(parts.seabed, parts, ground, gains, mesh, i, position, v_low, qi, arc, contact, carry_r, carry_d)
        cells[i, 1] = gains.law * slope * misfit
        store_from(cells, i, 3, t)
        store_from(cells, i, 3 + len(like), along)
        v_up = v_low
        a_up = a_low
    end_r, end_d = zero(like), diagonal(0.0, like)
    if lowest == 0:
        end_r, end_d = lower_end_terms(parts.body, parts, body, problem.cable, gains, n - 1, position, v_up, a_up, time)
    store_matrix(bands, 2, lowest, add_matrix(carry_d, end_d))
    store_matrix(bands, 1, lowest, diagonal(0.0, like))
    store_matrix(bands, 3, n - 1, diagonal(0.0, like))
    store(x, lowest, scale(-1.0, add(carry_r, end_r)))
    x[lowest, 0] += problem.numeric.pull
    _add_bodies(parts.line_bodies, parts, problem, gains, mesh, q, v, a, top, time, lowest, bands, x)
    _add_outflow(parts.winch, gains, problem.cable, load(q, n - 2, like), x, n - 1)
    _add_bending(parts.bending, parts, problem, gains, mesh, q, lowest, bands, x, like)
    add_clamps(parts, problem, gains, mesh, q, lowest, bands, x, like)


@kernel
def _lengthening(winch, gains, stretch):
    """Rate at which a cell's nodes move apart without stretching it."""
    if winch is None:
        return 0.0
    return gains.winding.rate * stretch


@kernel
def _add_outflow(winch, gains, cable, q, x, top):
    """Momentum that the cable carries in at the top, into minus the residual."""
    if winch is None:
        return
    slide = gains.winding.length * gains.winding.rate
    store(x, top, axpy(-cable.mass * slide * slide, q, load(x, top, q)))


@kernel
def _no_bodies(bodies, parts, problem, gains, mesh, q, v, a, top, time, lowest, bands, x):
    return


@kernel
def _bodies(bodies, parts, problem, gains, mesh, q, v, a, top, time, lowest, bands, x):
    """A loop of its own: in that of the cells the compiler would keep fewer numbers in registers."""
    position = top
    for i in range(mesh.shape[0] - 1, lowest, -1):
        position = axpy(-mesh[i, 0], load(q, i, top), position)
        section = joint(mesh, i)
        if section < 0:
            continue
        for j in range(bodies.shape[0]):
            if int(bodies[j, ABOVE]) == section:
                body = thickened(body_of(row_of(bodies, j), parts.water, problem.numbers), problem.numeric.thinnest)
                more, by_velocity = lower_end_terms(
                    True, parts, body, problem.cable, gains, mesh.shape[0] + 1 + j, position, load(v, i, top), load(a, i, top), time
                )  # fmt: skip
                store(x, i, sub(load(x, i, top), more))
                store_matrix(bands, 2, i, add_matrix(load_matrix(bands, 2, i, top), by_velocity))


_add_bodies = by_presence(_no_bodies, _bodies)


@kernel
def add_seabed(present, parts, ground, gains, mesh, i, position, v, q, arc, contact, residual, jacobian):
    if present is None:
        return residual, jacobian
    load, by_velocity = node_load(present, parts.friction, ground, gains, mesh, i, position, _slide(parts.winch, gains, arc, q, v), contact)
    return add(residual, load), add_matrix(jacobian, by_velocity)


@kernel
def _add_bending(bending, parts, problem, gains, mesh, q, lowest, bands, x, like):
    """Shear from the bending energy EI |q_(i+1) - q_i|^2/(2 h_node) of every inner node; ends carry no moment.

    The curvature is that of the positions by unstretched length: a quadratic energy, so its force is linear and a slack cell
    that has nearly vanished does no harm.  It differs from the curvature of the tangent by the strain.
    """
    if bending is None:
        return
    n = x.shape[0]
    clear_outer(bending, bands, n)
    for j in range(lowest + 1, n - 1):  # inner node j between cells j-1 (low) and j (up)
        low = j - 1
        kappa = turn_stiffness(parts.sections, parts, problem, mesh, j)
        below = 1.0 / mesh[low, 0]
        above = 1.0 / mesh[j, 0]
        middle = -below - above
        turn = scale(kappa, sub(load(q, j, like), load(q, low, like)))
        # d(q_up - q_low) = below dr_low + middle dr_j + above dr_up; x holds minus the residual
        store(x, low, axpy(-below, turn, load(x, low, like)))
        store(x, j, axpy(-middle, turn, load(x, j, like)))
        store(x, j + 1, axpy(-above, turn, load(x, j + 1, like)))
        k = kappa * gains.q
        _add_diagonal(bands, 2, low, k * below * below, like)
        _add_diagonal(bands, 3, low, k * below * middle, like)
        _add_diagonal(bands, 4, low, k * below * above, like)
        _add_diagonal(bands, 1, j, k * middle * below, like)
        _add_diagonal(bands, 2, j, k * middle * middle, like)
        _add_diagonal(bands, 3, j, k * middle * above, like)
        _add_diagonal(bands, 0, j + 1, k * above * below, like)
        _add_diagonal(bands, 1, j + 1, k * above * middle, like)
        _add_diagonal(bands, 2, j + 1, k * above * above, like)


@kernel
def bent(bending, parts, problem, mesh, q, i, like):
    """What bending adds to the axial force of cell i, t.g/h, N: N = T + EI kappa^2 in the limit of small cells."""
    if bending is None:
        return 0.0
    middle = load(q, i, like)
    gradient = zero(like)
    for j in (i, i + 1):  # the inner nodes below and above the cell
        if 0 < j < mesh.shape[0]:
            other = load(q, 2 * j - 1 - i, like)
            gradient = axpy(turn_stiffness(parts.sections, parts, problem, mesh, j), sub(middle, other), gradient)
    if i == 0:
        gradient = add(gradient, turned(parts.lower_clamp, BELOW, parts, problem, mesh, q, like))
    if i == mesh.shape[0] - 1:
        gradient = add(gradient, turned(parts.top_clamp, TOP, parts, problem, mesh, q, like))
    return dot(gradient, middle) / (norm(middle) * mesh[i, 0])


@kernel
def _add_diagonal(bands, j, i, size, like):
    """Add a multiple of the identity to a block."""
    for k in range(len(like)):
        bands[j, i, k * (len(like) + 1)] += size


@kernel
def prescribe_ends(parts, bands, x, n, like):
    """The top node, and an anchored lower end, have no unknowns: their change is zero."""
    identity_row(parts.bending, bands, x, n - 1, like)
    _prescribe_anchor(parts.anchor, parts.bending, bands, x, like)


@kernel
def _prescribe_anchor(anchor, bending, bands, x, like):
    if anchor is not None:
        identity_row(bending, bands, x, 0, like)
