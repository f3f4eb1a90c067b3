"""The paper's box grid in the plane [Gobat 2002, eqs 1, 2, 22]: residual and analytic Jacobian of one Newton iteration.

Unknowns of a node: [eps, S, u, v, phi, Omega] with bending, [eps, u, v, phi] without; T in the place of eps on an inextensible
cable.  Tangent t = (sin phi, cos phi), normal n = (cos phi, -sin phi) in axes (x, z); s runs up from the lower end.

    T_s - S Omega - m (u_t - v phi_t) - w cos phi + f_t = 0              u_s - Omega v - eps_t = 0
    S_s + T Omega - m (v_t + u phi_t) + w sin phi + f_n = 0              v_s + Omega u - (1 + eps) phi_t = 0
    phi_s - Omega = 0                                                    EI Omega_s + S (1 + eps) = 0

Every factor is the mean over a cell, so the cells conserve energy exactly and (1 + eps) t is exactly carried by u, v.  The
last pair of rows, the ends' conditions and an inextensible cable's u_s - Omega v = 0 hold at the new time, all other rows at
the averaged one.  Forces are linear in the strain: a tension-only law leaves the box's alternating strain unopposed.
"""

import math

from cable_model.kernels.box_ends import lower_end, upper_end
from cable_model.kernels.box_law import strain, tension, tension_gain
from cable_model.kernels.box_surface import cell_water
from cable_model.kernels.jit import kernel


@kernel
def _put(row, column, size, mean, difference):
    """Derivatives of a row by the mean (over the cell) and the difference of an unknown, as those by the lower and upper node's."""
    row[column] = mean - difference
    row[size + column] = mean + difference


@kernel
def _put_turn(bending, row, size, mean, weight, h):
    """The derivative of a row by phi, and by Omega through the cell's turn (Omega h, or without bending phi's difference)."""
    column = size // 3 + 2
    if bending is None:
        _put(row, column, size, mean, weight)
    else:
        _put(row, column, size, mean, 0.0)
        _put(row, column + 1, size, 0.5 * h * weight, 0.0)


@kernel
def _turn(bending, y, i, h, column):
    if bending is None:
        return y[i + 1, column] - y[i, column]
    return 0.5 * h * (y[i, column + 1] + y[i + 1, column + 1])


@kernel
def _mean(y, i, column):
    return 0.5 * (y[i, column] + y[i + 1, column])


@kernel
def _cell(parts, problem, gains, h, a, d, y1, base, time, i, block, like):
    """Rows of cell i into `block`: motion along t and n, stretch, rotation."""
    cable, medium, numeric = problem.cable, problem.medium, problem.numeric
    size = len(like)
    cu = size // 3
    cv = cu + 1
    cf = cu + 2
    k = gains.k
    m = gains.m
    half = 0.5 * h
    for r in range(size):
        for j in range(2 * size):
            block[r, j] = 0.0
    along = block[0]
    across = block[1]
    stretching = block[2]
    turning = block[3]
    low = tension(parts.inextensible, cable, numeric, a[i, 0], d[i, 0])
    high = tension(parts.inextensible, cable, numeric, a[i + 1, 0], d[i + 1, 0])
    stretch = 1.0 + strain(parts.inextensible, _mean(a, i, 0))
    pull = 0.5 * (low + high)
    u = _mean(a, i, cu)
    v = _mean(a, i, cv)
    phi = _mean(a, i, cf)
    spin = _mean(d, i, cf)
    s = math.sin(phi)
    c = math.cos(phi)
    turn = _turn(parts.bending, a, i, h, cf)
    mass = cable.mass
    turning_by = _mean(d, i, cv) + u * spin
    ft, fn, heavy = cell_water(
        parts.surface, parts, cable, medium, h, stretch, s, c, u, v, turning_by, base[i, 0], base[i, 1], gains.reach, time
    )
    w = cable.weight
    f = gains.scale
    fh = f * half
    gain = tension_gain(parts.inextensible, cable, numeric, gains)
    # motion along the tangent, and along the normal
    along[2 * size] = -f * (high - low - h * (mass * (_mean(d, i, cu) - v * spin) + w * c - ft[0]))
    _put(along, cu, size, fh * (k * ft[2] - m * mass), 0.0)
    _put(along, cv, size, fh * k * (ft[3] + mass * spin), 0.0)
    _put_turn(parts.bending, along, size, fh * (k * (w * s + ft[4]) + m * mass * v), 0.0, h)
    across[2 * size] = -f * (pull * turn - h * (heavy * turning_by - w * s - fn[0]))
    _put(across, cu, size, fh * k * (fn[2] - heavy * spin), 0.0)
    _put(across, cv, size, fh * (k * fn[3] - m * heavy), 0.0)
    _put_turn(parts.bending, across, size, fh * (k * (w * c + fn[4]) - m * heavy * u), f * k * pull, h)
    # rotation
    turning[2 * size] = -(a[i + 1, cv] - a[i, cv] + turn * u - h * stretch * spin)
    _put(turning, cu, size, 0.5 * k * turn, 0.0)
    _put(turning, cv, size, 0.0, k)
    _put_turn(parts.bending, turning, size, -half * stretch * m, k * u, h)
    # stretch
    if parts.inextensible is None:
        stretching[2 * size] = -(a[i + 1, cu] - a[i, cu] - turn * v - h * _mean(d, i, 0))
        _put(stretching, 0, size, -half * m, 0.0)
        _put(stretching, cu, size, 0.0, k)
        _put(stretching, cv, size, -0.5 * k * turn, 0.0)
        _put_turn(parts.bending, stretching, size, 0.0, -k * v, h)
        _put(along, 0, size, fh * k * ft[1], f * gain)
        _put(across, 0, size, 0.5 * f * gain * turn + fh * k * fn[1], 0.0)
        _put(turning, 0, size, -half * k * spin, 0.0)
    else:
        _put(along, 0, size, 0.0, f * gain)
        _put(across, 0, size, 0.5 * f * gain * turn, 0.0)
        v = _mean(y1, i, cv)
        turn = _turn(parts.bending, y1, i, h, cf)
        stretching[2 * size] = -(y1[i + 1, cu] - y1[i, cu] - turn * v)
        _put(stretching, cu, size, 0.0, 1.0)
        _put(stretching, cv, size, -0.5 * turn, 0.0)
        _put_turn(parts.bending, stretching, size, 0.0, -v, h)
    _add_bending(parts.bending, parts.inextensible, numeric.bending, gains, h, a, y1, i, block, size)


@kernel
def _add_bending(bending, inextensible, stiffness, gains, h, a, y1, i, block, size):
    """Shear in the rows of motion, and the rows of curvature and shear."""
    if bending is None:
        return
    along = block[0]
    across = block[1]
    bent = block[4]
    sheared = block[5]
    f = gains.scale
    k = gains.k
    shear = _mean(a, i, 1)
    turn = 0.5 * h * (a[i, 5] + a[i + 1, 5])
    along[2 * size] += f * shear * turn
    _put(along, 1, size, -0.5 * f * k * turn, 0.0)
    _put(along, 5, size, -0.5 * f * k * h * shear, 0.0)
    across[2 * size] -= f * (a[i + 1, 1] - a[i, 1])
    _put(across, 1, size, 0.0, f * k)
    bent[2 * size] = -(y1[i + 1, 4] - y1[i, 4] - 0.5 * h * (y1[i, 5] + y1[i + 1, 5]))
    _put(bent, 4, size, 0.0, 1.0)
    _put(bent, 5, size, -0.5 * h, 0.0)
    stretch = 1.0 + strain(inextensible, _mean(y1, i, 0))
    shear = _mean(y1, i, 1)
    firm = stiffness / h
    sheared[2 * size] = -f * (firm * (y1[i + 1, 5] - y1[i, 5]) + shear * stretch)
    _put(sheared, 5, size, 0.0, f * firm)
    _put(sheared, 1, size, 0.5 * f * stretch, 0.0)
    if inextensible is None:
        _put(sheared, 0, size, 0.5 * f * shear, 0.0)


@kernel
def assemble(parts, problem, gains, mesh, a, d, y1, base, time, top_velocity, blocks, lower, upper, like):
    """All rows: `a` and `d` (n, N) are states and rates at the averaged time, `y1` the new states, `base` (n, 2) the places of the
    cells' middles, and in its last row of the lower end, where their velocities (times reach) carry them to the averaged time.
    """
    n = a.shape[0]
    for i in range(n - 1):
        _cell(parts, problem, gains, mesh[i, 0], a, d, y1, base, time, i, blocks[i], like)
    lower[:, :] = 0.0
    upper[:, :] = 0.0
    lower_end(parts.anchor, parts, problem, gains, a, d, y1, base, time, lower, like)
    upper_end(parts.bending, y1, top_velocity, upper, like)
