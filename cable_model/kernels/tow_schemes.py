"""One step of the tow model by a Runge-Kutta method: Radau IIA (three stages, order 5) or the report's Kutta-Merson.

Radau IIA is stiffly accurate: its steps follow the smooth motion however stiff the cable is.  A step stays on one branch of
the tension floor, and leaves a cubic of the excess tension for the search of the branch's end.
"""

import math
from typing import NamedTuple

from cable_model.kernels.jit import kernel
from cable_model.kernels.top import evaluate
from cable_model.kernels.tow import accelerations, excess_tension

MAX_ITERATIONS = 10

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
    """The prescribed path of the top over one communication step."""

    path: object
    h: float
    time: float


@kernel
def derivative(parts, c, drive, elapsed, y, slack):
    """Rates of y = (phi, phi', u, u'); NaN where the cable has shrunk to nothing or y has run away."""
    if not (abs(y[0]) < 1e6 and abs(y[1]) < 1e12 and c.length + y[2] > 1e-6 * c.length and y[2] < 1e12 and abs(y[3]) < 1e12):
        return (math.nan, math.nan, math.nan, math.nan)
    x, vx, ax = evaluate(drive.path, drive.h, elapsed / drive.h, 0)
    z, vz, az = evaluate(drive.path, drive.h, elapsed / drive.h, 2)
    phi_rate, u_rate = accelerations(parts, c, (x, vx, ax, -z, -vz, -az), drive.time + elapsed, y, slack)
    return (y[1], phi_rate, y[3], u_rate)


@kernel
def weights(c, y):
    """Sizes against which errors of y are measured: 0.1 rad and more, the stretch at rest and more, and their rates."""
    angle = 0.1 + abs(math.sin(y[0]))
    stretch = c.force / c.spring + abs(y[2])
    return (angle, angle * c.pendulum + abs(y[1]), stretch, stretch * c.axial + abs(y[3]))


@kernel
def size_of(e, scale):
    total = 0.0
    for k in range(4):
        part = abs(e[k]) / scale[k]
        total += part * part
    return math.sqrt(0.25 * total)


@kernel
def moved(y, a, d):
    return (y[0] + a * d[0], y[1] + a * d[1], y[2] + a * d[2], y[3] + a * d[3])


@kernel
def jacobian(parts, c, drive, elapsed, y, f, slack):
    """Derivatives of phi'' (first four) and u'' by y, by differences: exact for the stiff spring, which is linear."""
    phi, w, u, v = y
    d0, d1, d2 = 1e-7, 1e-7 * (c.pendulum + abs(w)), 1e-7 * c.reference_length
    d3 = d2 * c.pendulum
    _, a0, _, b0 = derivative(parts, c, drive, elapsed, (phi + d0, w, u, v), slack)
    _, a1, _, b1 = derivative(parts, c, drive, elapsed, (phi, w + d1, u, v), slack)
    _, a2, _, b2 = derivative(parts, c, drive, elapsed, (phi, w, u + d2, v), slack)
    _, a3, _, b3 = derivative(parts, c, drive, elapsed, (phi, w, u, v + d3), slack)
    a, b = f[1], f[3]
    return ((a0 - a) / d0, (a1 - a) / d1, (a2 - a) / d2, (a3 - a) / d3, (b0 - b) / d0, (b1 - b) / d1, (b2 - b) / d2, (b3 - b) / d3)


@kernel
def solve(rate, j, r):
    """(rate - J)^-1 r for real or complex rate: positions first, 2 by 2, then their rates."""
    m00 = rate * (rate - j[1]) - j[0]
    m01 = -rate * j[3] - j[2]
    m10 = -rate * j[5] - j[4]
    m11 = rate * (rate - j[7]) - j[6]
    b0 = r[1] + (rate - j[1]) * r[0] - j[3] * r[2]
    b1 = r[3] + (rate - j[7]) * r[2] - j[5] * r[0]
    det = m00 * m11 - m01 * m10
    inverse = det.conjugate() * (1.0 / (det.real * det.real + det.imag * det.imag))
    x0 = (b0 * m11 - m01 * b1) * inverse
    x1 = (m00 * b1 - m10 * b0) * inverse
    return (x0, rate * x0 - r[0], x1, rate * x1 - r[2])


@kernel
def mix(work, at, a, b, d):
    """Weighted sum of three rows of four."""
    return (
        a * work[at] + b * work[at + 4] + d * work[at + 8],
        a * work[at + 1] + b * work[at + 5] + d * work[at + 9],
        a * work[at + 2] + b * work[at + 6] + d * work[at + 10],
        a * work[at + 3] + b * work[at + 7] + d * work[at + 11],
    )


@kernel
def radau_step(parts, c, drive, elapsed, h, y, f, j, slack, scale, tolerance, work):
    """One step of Radau IIA by simplified Newton; returns iterations (-1: failed), new y, error and right-hand sides spent.

    work: increments of the stages (3 x 4), their split form, their rates; then the cubic of the excess tension.
    """
    real, pair = REAL / h, PAIR * (1.0 / h)
    enough = max(0.02 * tolerance, 1e-11)
    for i in range(3):
        s = h * (C1 if i == 0 else (C2 if i == 1 else 1.0))
        work[4 * i] = s * (f[0] + 0.5 * s * f[1])
        work[4 * i + 1] = s * f[1]
        work[4 * i + 2] = s * (f[2] + 0.5 * s * f[3])
        work[4 * i + 3] = s * f[3]
    split = mix(work, 0, S11, S12, S13)
    split_pair = mix(work, 0, P1, P2, P3)
    previous = 1e300
    spent = 0
    for iteration in range(1, MAX_ITERATIONS + 1):
        for i in range(3):
            s = h * (C1 if i == 0 else (C2 if i == 1 else 1.0))
            stage = (y[0] + work[4 * i], y[1] + work[4 * i + 1], y[2] + work[4 * i + 2], y[3] + work[4 * i + 3])
            rates = derivative(parts, c, drive, elapsed + s, stage, slack)
            for k in range(4):
                work[12 + 4 * i + k] = rates[k]
        spent += 3
        d = solve(real, j, moved(mix(work, 12, S11, S12, S13), -real, split))
        e = solve(pair, j, moved(mix(work, 12, P1, P2, P3), -pair, split_pair))
        split = moved(split, 1.0, d)
        split_pair = moved(split_pair, 1.0, e)
        for k in range(4):
            a, b, g = split[k], split_pair[k].real, split_pair[k].imag
            work[k] = T11 * a + T12 * b + T13 * g
            work[4 + k] = T21 * a + T22 * b + T23 * g
            work[8 + k] = a + b
        change = size_of(d, scale) + size_of(e, scale)
        ratio = change / previous if iteration > 1 else 1.0
        if not change < 1e12 or (ratio > 2.0 and change > 1e-9):
            return -1, y, 0.0, spent
        # the stiff spring is solved at once and would make the rest look converged: trust no ratio below 0.05
        closing = iteration > 1 and change * max(ratio, 0.05) <= enough * (1.0 - ratio)
        stalled = iteration > 1 and change < 1e-9 and ratio > 0.3  # at rounding
        if change <= enough or closing or stalled:
            end = (y[0] + work[8], y[1] + work[9], y[2] + work[10], y[3] + work[11])
            residual = mix(work, 0, E1 / h, E2 / h, E3 / h)
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
    """Coefficients of the cubic through the excess tension at the start and the stages, into work[24:28]."""
    g0 = excess_tension(c, y)
    d1 = (c.spring * work[2] + c.damper * work[3]) / C1
    d2 = (c.spring * (work[6] - work[2]) + c.damper * (work[7] - work[3])) / (C2 - C1)
    d3 = (c.spring * (work[10] - work[6]) + c.damper * (work[11] - work[7])) / (1.0 - C2)
    e1 = (d2 - d1) / C2
    a3 = (d3 - d2) / (1.0 - C1) - e1
    work[24], work[25], work[26], work[27] = g0, d1 - C1 * e1 + C1 * C2 * a3, e1 - (C1 + C2) * a3, a3


@kernel
def merson_step(parts, c, drive, elapsed, h, y, f, slack, scale, work):
    """One step of Kutta-Merson, the report's method; returns as radau_step does."""
    k2 = derivative(parts, c, drive, elapsed + h / 3.0, moved(y, h / 3.0, f), slack)
    k3 = derivative(parts, c, drive, elapsed + h / 3.0, moved(moved(y, h / 6.0, f), h / 6.0, k2), slack)
    half = moved(moved(y, h / 8.0, f), 0.375 * h, k3)
    k4 = derivative(parts, c, drive, elapsed + 0.5 * h, half, slack)
    last = moved(moved(moved(y, 0.5 * h, f), -1.5 * h, k3), 2.0 * h, k4)
    k5 = derivative(parts, c, drive, elapsed + h, last, slack)
    end = moved(moved(moved(y, h / 6.0, f), 2.0 / 3.0 * h, k4), h / 6.0, k5)
    error = moved(moved(moved(moved((0.0, 0.0, 0.0, 0.0), h / 15.0, f), -0.3 * h, k3), 4.0 / 15.0 * h, k4), -h / 30.0, k5)
    g0 = excess_tension(c, y)
    slope = h * (c.spring * f[2] + c.damper * f[3])
    rest = excess_tension(c, end) - g0 - slope
    a3 = 2.0 * (rest - 4.0 * (excess_tension(c, half) - g0 - 0.5 * slope))
    work[24], work[25], work[26], work[27] = g0, slope, rest - a3, a3
    return 0, end, size_of(error, scale), 4
