"""One step of the tow model by a Runge-Kutta method: Radau IIA (three stages, order 5) or the report's Kutta-Merson.

Radau IIA is stiffly accurate: its steps follow the smooth motion however stiff the cable is.  A step stays on one branch of
the tension floor, and leaves a cubic of the excess tension for the search of the branch's end.
"""

import math
from typing import NamedTuple

from cable_model.kernels.choice import by_presence
from cable_model.kernels.jit import kernel
from cable_model.kernels.path import evaluate
from cable_model.kernels.tow import accelerations, excess_tension
from cable_model.kernels.tow_space import derivative_in_space
from cable_model.kernels.vector import add, add_matrix, apply, axpy, diagonal, scale, scale_matrix

MAX_ITERATIONS = 10
RATES = 18  # in work: the stages' rates, after their increments
CUBIC = 36

# Radau IIA, order 5: nodes, eigenvalues of the inverse of A, and the transformation that splits the stages (rows of T^-1, T)
ROOT6 = 6.0**0.5
C1 = (4.0 - ROOT6) / 10.0
C2 = (4.0 + ROOT6) / 10.0
E1 = (-13.0 - 7.0 * ROOT6) / 3.0
E2 = (-13.0 + 7.0 * ROOT6) / 3.0
E3 = -1.0 / 3.0
REAL = 3.0 + 3.0 ** (2.0 / 3.0) - 3.0 ** (1.0 / 3.0)
PAIR = complex(3.0 + 0.5 * (3.0 ** (1.0 / 3.0) - 3.0 ** (2.0 / 3.0)), -0.5 * (3.0 ** (5.0 / 6.0) + 3.0 ** (7.0 / 6.0)))
T11, T12, T13 = 0.09443876248897524, -0.14125529502095421, 0.03002919410514742
T21, T22, T23 = 0.25021312296533332, 0.20412935229379994, -0.38294211275726192
S11, S12, S13 = 4.17871859155190428, 0.32768282076106237, 0.52337644549944951
P1 = complex(-4.17871859155190428, 0.50287263494578682)
P2 = complex(-0.32768282076106237, -2.57192694985560522)
P3 = complex(0.47662355450055044, 0.59603920482822492)


class Drive(NamedTuple):
    """The prescribed path of the top over one communication step; in space also the chart of the cable's direction."""

    path: object
    h: float
    time: float
    frame: object  # tow_space.Frame; None in the plane


@kernel
def top_in_plane(drive, elapsed):
    """The top's x, x', x'', y, y', y'', y down."""
    x, vx, ax = evaluate(drive.path, drive.h, elapsed / drive.h, 0)
    z, vz, az = evaluate(drive.path, drive.h, elapsed / drive.h, 2)
    return x, vx, ax, -z, -vz, -az


@kernel
def derivative_in_plane(space, parts, c, drive, elapsed, y, slack):
    """Rates of y = (phi, phi', u, u'); NaN where the cable has shrunk to nothing or y has run away."""
    if not (abs(y[0]) < 1e6 and abs(y[1]) < 1e12 and c.length + y[2] > 1e-6 * c.length and y[2] < 1e12 and abs(y[3]) < 1e12):
        return (math.nan, math.nan, math.nan, math.nan)
    phi_rate, u_rate = accelerations(parts, c, top_in_plane(drive, elapsed), drive.time + elapsed, y, slack)
    return (y[1], phi_rate, y[3], u_rate)


_derivative = by_presence(derivative_in_plane, derivative_in_space)


@kernel
def derivative(parts, c, drive, elapsed, y, slack):
    return _derivative(parts.space, parts, c, drive, elapsed, y, slack)


@kernel
def weights(c, sine, y):
    """Sizes against which errors of y are measured: 0.1 rad and more, the stretch at rest and more, and their rates.

    sine: of the cable's angle to the vertical.
    """
    angle = 0.1 + sine
    stretch = c.force / c.spring + abs(y[2])
    stretching = stretch * c.axial + abs(y[3])
    if len(y) == 4:
        return (angle, angle * c.pendulum + abs(y[1]), stretch, stretching)
    turning = angle * c.pendulum + math.sqrt(y[1] * y[1] + y[5] * y[5])
    return (angle, turning, stretch, stretching, angle, turning)


@kernel
def size_of(e, scale):
    """Error or change measured by `scale`; does not depend on the chart's axes, and a motion in one plane has the plane's size."""
    total = 0.0
    for k in range(len(e)):
        part = abs(e[k]) / scale[k]
        total += part * part
    return math.sqrt(0.25 * total)


@kernel
def moved(y, a, d):
    if len(y) == 4:
        return (y[0] + a * d[0], y[1] + a * d[1], y[2] + a * d[2], y[3] + a * d[3])
    return (y[0] + a * d[0], y[1] + a * d[1], y[2] + a * d[2], y[3] + a * d[3], y[4] + a * d[4], y[5] + a * d[5])


@kernel
def shifted(y, k, d):
    """y with d added to its number k."""
    if len(y) == 4:
        return (y[0] + d * (k == 0), y[1] + d * (k == 1), y[2] + d * (k == 2), y[3] + d * (k == 3))
    return (y[0] + d * (k == 0), y[1] + d * (k == 1), y[2] + d * (k == 2), y[3] + d * (k == 3), y[4] + d * (k == 4), y[5] + d * (k == 5))


@kernel
def places(y):
    """The coordinates of y, without their rates."""
    if len(y) == 4:
        return (y[0], y[2])
    return (y[0], y[2], y[4])


@kernel
def rates(y):
    if len(y) == 4:
        return (y[1], y[3])
    return (y[1], y[3], y[5])


@kernel
def woven(q, v):
    """y from coordinates and rates."""
    if len(q) == 2:
        return (q[0], v[0], q[1], v[1])
    return (q[0], v[0], q[1], v[1], q[2], v[2])


@kernel
def columns(a, b, c):
    """Matrix of these columns; c is not read in two dimensions."""
    if len(a) == 2:
        return (a[0], b[0], a[1], b[1])
    return (a[0], b[0], c[0], a[1], b[1], c[1], a[2], b[2], c[2])


@kernel
def slope(parts, c, drive, elapsed, y, f, slack, k, d):
    """Derivative of the accelerations by number k of y, by a difference of d."""
    return scale(1.0 / d, axpy(-1.0, rates(f), rates(derivative(parts, c, drive, elapsed, shifted(y, k, d), slack))))


@kernel
def jacobian(parts, c, drive, elapsed, y, f, slack):
    """Derivatives of the accelerations by coordinates and by rates: by differences, exact for the stiff spring, which is linear."""
    d0, d1, d2 = 1e-7, 1e-7 * (c.pendulum + abs(y[1])), 1e-7 * c.reference_length
    d3 = d2 * c.pendulum
    last = len(y) - 2
    q0 = slope(parts, c, drive, elapsed, y, f, slack, 0, d0)
    v0 = slope(parts, c, drive, elapsed, y, f, slack, 1, d1)
    q1 = slope(parts, c, drive, elapsed, y, f, slack, 2, d2)
    v1 = slope(parts, c, drive, elapsed, y, f, slack, 3, d3)
    q2, v2 = q1, v1
    if last > 2:
        q2 = slope(parts, c, drive, elapsed, y, f, slack, last, d0)
        v2 = slope(parts, c, drive, elapsed, y, f, slack, last + 1, d1)
    return columns(q0, q1, q2), columns(v0, v1, v2)


@kernel
def reciprocal(z):
    """1/z of a real or complex number."""
    return z.conjugate() * (1.0 / (z.real * z.real + z.imag * z.imag))


@kernel
def solved(m, b):
    """m^-1 b of a real or complex matrix by cofactors."""
    if len(b) == 2:
        d = reciprocal(m[0] * m[3] - m[1] * m[2])
        return ((b[0] * m[3] - m[1] * b[1]) * d, (m[0] * b[1] - m[2] * b[0]) * d)
    c0 = m[4] * m[8] - m[5] * m[7]
    c1 = m[5] * m[6] - m[3] * m[8]
    c2 = m[3] * m[7] - m[4] * m[6]
    d = reciprocal(m[0] * c0 + m[1] * c1 + m[2] * c2)
    return (
        d * (c0 * b[0] + (m[2] * m[7] - m[1] * m[8]) * b[1] + (m[1] * m[5] - m[2] * m[4]) * b[2]),
        d * (c1 * b[0] + (m[0] * m[8] - m[2] * m[6]) * b[1] + (m[2] * m[3] - m[0] * m[5]) * b[2]),
        d * (c2 * b[0] + (m[1] * m[6] - m[0] * m[7]) * b[1] + (m[0] * m[4] - m[1] * m[3]) * b[2]),
    )


@kernel
def solve(rate, j, r):
    """(rate - J)^-1 r for real or complex rate: coordinates first, then their rates."""
    by_place, by_rate = j
    q, v = places(r), rates(r)
    freed = add_matrix(diagonal(rate, q), scale_matrix(-1.0, by_rate))
    x = solved(add_matrix(scale_matrix(rate, freed), scale_matrix(-1.0, by_place)), add(v, apply(freed, q)))
    return woven(x, axpy(-1.0, q, scale(rate, x)))


@kernel
def weighed(work, at, y, a, b, d):
    """a, b and d times the three rows, as long as y, that begin at `at`."""
    n = len(y)
    if len(y) == 4:
        return (
            a * work[at] + b * work[at + n] + d * work[at + 2 * n],
            a * work[at + 1] + b * work[at + n + 1] + d * work[at + 2 * n + 1],
            a * work[at + 2] + b * work[at + n + 2] + d * work[at + 2 * n + 2],
            a * work[at + 3] + b * work[at + n + 3] + d * work[at + 2 * n + 3],
        )
    return (
        a * work[at] + b * work[at + n] + d * work[at + 2 * n],
        a * work[at + 1] + b * work[at + n + 1] + d * work[at + 2 * n + 1],
        a * work[at + 2] + b * work[at + n + 2] + d * work[at + 2 * n + 2],
        a * work[at + 3] + b * work[at + n + 3] + d * work[at + 2 * n + 3],
        a * work[at + 4] + b * work[at + n + 4] + d * work[at + 2 * n + 4],
        a * work[at + 5] + b * work[at + n + 5] + d * work[at + 2 * n + 5],
    )


@kernel
def row(work, at, y):
    if len(y) == 4:
        return (work[at], work[at + 1], work[at + 2], work[at + 3])
    return (work[at], work[at + 1], work[at + 2], work[at + 3], work[at + 4], work[at + 5])


@kernel
def keep_cubic(work, a0, a1, a2, a3):
    """Excess tension over the fraction of the step, for the search of the branch's end."""
    work[CUBIC], work[CUBIC + 1], work[CUBIC + 2], work[CUBIC + 3] = a0, a1, a2, a3


@kernel
def radau_step(parts, c, drive, elapsed, h, y, f, j, slack, scale, tolerance, work):
    """One step of Radau IIA by simplified Newton; returns iterations (-1: failed), new y, error and right-hand sides spent.

    work: increments of the stages (a row each, as long as y), from 18 on their rates; then the cubic of the excess tension.
    """
    n = len(y)
    real, pair = REAL / h, PAIR * (1.0 / h)
    enough = max(0.02 * tolerance, 1e-11)
    for i in range(3):
        s = h * (C1 if i == 0 else (C2 if i == 1 else 1.0))
        for k in range(0, n, 2):
            work[n * i + k] = s * (f[k] + 0.5 * s * f[k + 1])
            work[n * i + k + 1] = s * f[k + 1]
    split = weighed(work, 0, y, S11, S12, S13)
    split_pair = weighed(work, 0, y, P1, P2, P3)
    previous = 1e300
    spent = 0
    for iteration in range(1, MAX_ITERATIONS + 1):
        for i in range(3):
            s = h * (C1 if i == 0 else (C2 if i == 1 else 1.0))
            moving = derivative(parts, c, drive, elapsed + s, moved(y, 1.0, row(work, n * i, y)), slack)
            for k in range(n):
                work[RATES + n * i + k] = moving[k]
        spent += 3
        d = solve(real, j, moved(weighed(work, RATES, y, S11, S12, S13), -real, split))
        e = solve(pair, j, moved(weighed(work, RATES, y, P1, P2, P3), -pair, split_pair))
        split = moved(split, 1.0, d)
        split_pair = moved(split_pair, 1.0, e)
        for k in range(n):
            a, b, g = split[k], split_pair[k].real, split_pair[k].imag
            work[k] = T11 * a + T12 * b + T13 * g
            work[n + k] = T21 * a + T22 * b + T23 * g
            work[2 * n + k] = a + b
        change = size_of(d, scale) + size_of(e, scale)
        ratio = change / previous if iteration > 1 else 1.0
        if not change < 1e12 or (ratio > 2.0 and change > 1e-9):
            return -1, y, 0.0, spent
        # the stiff spring is solved at once and would make the rest look converged: trust no ratio below 0.05
        closing = iteration > 1 and change * max(ratio, 0.05) <= enough * (1.0 - ratio)
        stalled = iteration > 1 and change < 1e-9 and ratio > 0.3  # at rounding
        if change <= enough or closing or stalled:
            end = moved(y, 1.0, row(work, 2 * n, y))
            residual = weighed(work, 0, y, E1 / h, E2 / h, E3 / h)
            error = solve(real, j, moved(f, 1.0, residual))
            if size_of(error, scale) > tolerance:  # a stiff transient: filter once more
                again = derivative(parts, c, drive, elapsed, moved(y, 1.0, error), slack)
                error = solve(real, j, moved(again, 1.0, residual))
                spent += 1
            _excess_by_stages(c, y, end, work)
            return iteration, end, size_of(error, scale), spent
        previous = change
    return -1, y, 0.0, spent


@kernel
def _excess_by_stages(c, y, end, work):
    """Coefficients of the cubic through the excess tension at the start and the stages, into work[CUBIC:]."""
    u, v = 2, 3  # of a row
    n = len(y)
    g0 = excess_tension(c, y)
    d1 = (c.spring * work[u] + c.damper * work[v]) / C1
    d2 = (c.spring * (work[n + u] - work[u]) + c.damper * (work[n + v] - work[v])) / (C2 - C1)
    d3 = (c.spring * (work[2 * n + u] - work[n + u]) + c.damper * (work[2 * n + v] - work[n + v])) / (1.0 - C2)
    e1 = (d2 - d1) / C2
    a3 = (d3 - d2) / (1.0 - C1) - e1
    keep_cubic(work, g0, d1 - C1 * e1 + C1 * C2 * a3, e1 - (C1 + C2) * a3, a3)


@kernel
def merson_step(parts, c, drive, elapsed, h, y, f, slack, scale, work):
    """One step of Kutta-Merson, the report's method; returns as radau_step does, and leaves its start, middle and end as stages."""
    k2 = derivative(parts, c, drive, elapsed + h / 3.0, moved(y, h / 3.0, f), slack)
    k3 = derivative(parts, c, drive, elapsed + h / 3.0, moved(moved(y, h / 6.0, f), h / 6.0, k2), slack)
    half = moved(moved(y, h / 8.0, f), 0.375 * h, k3)
    k4 = derivative(parts, c, drive, elapsed + 0.5 * h, half, slack)
    last = moved(moved(moved(y, 0.5 * h, f), -1.5 * h, k3), 2.0 * h, k4)
    k5 = derivative(parts, c, drive, elapsed + h, last, slack)
    end = moved(moved(moved(y, h / 6.0, f), 2.0 / 3.0 * h, k4), h / 6.0, k5)
    error = moved(moved(moved(moved(moved(f, -1.0, f), h / 15.0, f), -0.3 * h, k3), 4.0 / 15.0 * h, k4), -h / 30.0, k5)
    g0 = excess_tension(c, y)
    rise = h * (c.spring * f[2] + c.damper * f[3])
    rest = excess_tension(c, end) - g0 - rise
    a3 = 2.0 * (rest - 4.0 * (excess_tension(c, half) - g0 - 0.5 * rise))
    keep_cubic(work, g0, rise, rest - a3, a3)
    n = len(y)
    for k in range(n):
        work[k], work[n + k], work[2 * n + k] = 0.0, half[k] - y[k], end[k] - y[k]
        work[RATES + k], work[RATES + n + k], work[RATES + 2 * n + k] = f[k], k4[k], k5[k]
    return 0, end, size_of(error, scale), 4
