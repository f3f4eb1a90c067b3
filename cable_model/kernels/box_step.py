"""One implicit step of the box grid: Newton's method on the whole state under any member of the family [Gobat 2002, eqs 17-24].

State Y is (n, N), a row for each node from the lower end up; see box_law for its columns.  Coefficients and forces are taken at
the averaged state (1 - alpha_k) Y_i + alpha_k Y_(i-1).  Not M at (1 - alpha_m) Y_i + alpha_m Y_(i-1), as eq 23 has it: the
averaged rate belongs to the time t_i - alpha_k h, and a mass matrix of another time costs an order [measured in test_box_order].
"""

import math
from typing import NamedTuple

from cable_model.kernels.almost_block_diagonal import solve
from cable_model.kernels.box import assemble
from cable_model.kernels.box_law import Gains, strain, unknowns
from cable_model.kernels.choice import by_presence
from cable_model.kernels.convergence import has_converged
from cable_model.kernels.jit import kernel, views
from cable_model.kernels.problem import body_weight

MAX_ITERATIONS = 20
DIVERGED = -1
NOT_CONVERGED = -2


class Scratch(NamedTuple):
    """Work arrays of a step; `whole` is all of it, for the statics on the other grid."""

    a: object
    d: object
    x: object
    base: object
    blocks: object
    lower: object
    upper: object
    stack: object
    whole: object


@kernel
def scratch_size(n, size):
    half = size // 2
    return 3 * n * size + 2 * n + n * size * (2 * size + 1) + 2 * half * (size + 1) + (size + half) * (2 * size + 1)


@views
def cut_scratch(work, n, like):
    size = len(like)
    half = size // 2
    m = n * size
    o = 3 * m + 2 * n
    e = o + m * (2 * size + 1)
    g = half * (size + 1)
    return Scratch(
        work[0:m].reshape((n, size)),
        work[m : 2 * m].reshape((n, size)),
        work[2 * m : 3 * m].reshape((n, size)),
        work[3 * m : o].reshape((n, 2)),
        work[o:e].reshape((n, size, 2 * size + 1)),
        work[e : e + g].reshape((half, size + 1)),
        work[e + g : e + 2 * g].reshape((half, size + 1)),
        work[e + 2 * g : e + 2 * g + (size + half) * (2 * size + 1)].reshape((size + half, 2 * size + 1)),
        work,
    )


@kernel
def force_scale(problem):
    """Weight of cable and body in the medium, N; never zero."""
    cable = problem.cable
    weight = abs(cable.weight) * cable.length + abs(body_weight(problem.body))
    return max(weight, 1e-6 * cable.mass * max(cable.gravity, 1e-3) * cable.length)


@kernel
def speed_scale(problem):
    return math.sqrt(max(problem.cable.gravity, 1e-3) * problem.cable.length)


@kernel
def _half(surface, c):
    return 0.5


@kernel
def _whole_if_backward(surface, c):
    return 1.0 if c.gamma == 1.0 and c.alpha_m == 0.0 else 0.5


# share of the new velocities in the way to the averaged time: in the long steps of the statics a float must meet the surface where it
# gets to, not half-way
_share_of_new = by_presence(_half, _whole_if_backward)


@kernel
def newton_step(parts, problem, mesh, y0, yd0, y_old, reach, c, time, h, start, top_velocity, contraction, y1, yd1, s):
    """Advance (y0, yd0) by h into (y1, yd1); returns the iterations, or a negative status.

    `yd0` is already corrected for a changed step.  `y_old`, the state before y0, predicts; `reach` is the ratio of the steps, 0: not.
    `time` is the averaged time t_i - alpha_k h, `start` the place of the top at t_i - h, `top_velocity` the prescribed one at the new
    time t_i.  `contraction` (1,) is that of convergence.py.
    """
    n, size = y0.shape
    like = unknowns(parts.bending)
    to_rate = 1.0 / (c.gamma * h)
    back = (1.0 - c.gamma) / c.gamma
    share = _share_of_new(parts.surface, c)
    gains = Gains(1.0 - c.alpha_k, (1.0 - c.alpha_m) * to_rate, share * (1.0 - c.alpha_k) * h, 1.0 / force_scale(problem))
    for i in range(n):
        for j in range(size):
            y1[i, j] = y0[i, j] + reach * (y0[i, j] - y_old[i, j])
    _place(parts.water, parts.inextensible, mesh, y0, start, (1.0 - share) * (1.0 - c.alpha_k) * h, s.base)
    previous = 1e300
    for iteration in range(1, MAX_ITERATIONS + 1):
        _average(c, gains, back, y0, yd0, y1, s.a, s.d)
        assemble(parts, problem, gains, mesh, s.a, s.d, y1, s.base, time, top_velocity, s.blocks, s.lower, s.upper, like)
        solve(s.blocks, s.lower, s.upper, s.stack, s.x, like)
        change = _update(parts.inextensible, problem, y1, s.x)
        if not change < 1e6 * speed_scale(problem):
            return DIVERGED
        if has_converged(iteration, change, previous, problem.numeric, contraction):
            for i in range(n):
                for j in range(size):
                    yd1[i, j] = to_rate * (y1[i, j] - y0[i, j]) - back * yd0[i, j]
            return iteration
        previous = change
    return NOT_CONVERGED


@kernel
def _average(c, gains, back, y0, yd0, y1, a, d):
    """States and rates at the averaged time."""
    old = c.alpha_m - (1.0 - c.alpha_m) * back
    for i in range(y0.shape[0]):
        for j in range(y0.shape[1]):
            a[i, j] = gains.k * y1[i, j] + c.alpha_k * y0[i, j]
            d[i, j] = gains.m * (y1[i, j] - y0[i, j]) + old * yd0[i, j]


@kernel
def _place(water, inextensible, mesh, y, top, reach, base):
    """Where the cells' middles (and in the last row the lower end) would be at the averaged time but for their new velocities."""
    if water is None:
        return
    n, size = y.shape
    cu = size // 3
    x, z = top
    for i in range(n - 2, -1, -1):
        u = 0.5 * (y[i, cu] + y[i + 1, cu])
        v = 0.5 * (y[i, cu + 1] + y[i + 1, cu + 1])
        phi = 0.5 * (y[i, cu + 2] + y[i + 1, cu + 2])
        s = math.sin(phi)
        c = math.cos(phi)
        h = mesh[i, 0] * (1.0 + strain(inextensible, 0.5 * (y[i, 0] + y[i + 1, 0])))
        base[i, 0] = x - 0.5 * h * s + reach * (u * s + v * c)
        base[i, 1] = z - 0.5 * h * c + reach * (u * c - v * s)
        x -= h * s
        z -= h * c
    s = math.sin(y[0, cu + 2])
    c = math.cos(y[0, cu + 2])
    base[n - 1, 0] = x + reach * (y[0, cu] * s + y[0, cu + 1] * c)
    base[n - 1, 1] = z + reach * (y[0, cu] * c - y[0, cu + 1] * s)


@kernel
def _update(inextensible, problem, y1, x):
    """Add the change of an iteration; returns its size as a speed: tensions by the weight, angles by a radian."""
    n, size = y1.shape
    cu = size // 3
    speed = speed_scale(problem)
    by_force = speed / force_scale(problem)
    if inextensible is None:
        by_force *= problem.cable.stiffness
    change = 0.0
    for i in range(n):
        for j in range(size):
            y1[i, j] += x[i, j]
        here = abs(x[i, cu]) + abs(x[i, cu + 1]) + speed * abs(x[i, cu + 2]) + by_force * abs(x[i, 0])
        if change == change and not here <= change:  # a NaN stays
            change = here
    return change


@kernel
def rate_error(bending, problem, mesh, yd0, yd1, ydd, h):
    """Root mean squares over the mass, m/s2: of what the accelerations (u_t, v_t) differ from their linear extrapolation; of all."""
    cu = len(unknowns(bending)) // 3
    total = 0.0
    summed = 0.0
    moving = 0.0
    for i in range(mesh.shape[0]):
        mass = problem.cable.mass * mesh[i, 0]
        total += mass
        for j in range(cu, cu + 2):
            low = yd1[i, j] - yd0[i, j] - h * ydd[i, j]
            high = yd1[i + 1, j] - yd0[i + 1, j] - h * ydd[i + 1, j]
            summed += 0.25 * mass * (low + high) ** 2
            moving += 0.25 * mass * (yd1[i, j] + yd1[i + 1, j]) ** 2
    return (summed / total) ** 0.5, (moving / total) ** 0.5
