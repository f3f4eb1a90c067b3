"""The ends of the box grid: N/2 conditions on the lower node (free, body or anchored) and N/2 on the prescribed top."""

import math

from cable_model.kernels.box_law import strain, tension, tension_gain
from cable_model.kernels.box_surface import body_at_surface, cell_water
from cable_model.kernels.jit import kernel


@kernel
def upper_end(bending, y1, velocity, upper, like):
    """The prescribed velocity, and no moment."""
    size = len(like)
    cu = size // 3
    top = y1.shape[0] - 1
    s = math.sin(y1[top, cu + 2])
    c = math.cos(y1[top, cu + 2])
    along = velocity[0] * s + velocity[1] * c
    across = velocity[0] * c - velocity[1] * s
    upper[0, cu] = 1.0
    upper[0, cu + 2] = -across
    upper[0, size] = along - y1[top, cu]
    upper[1, cu + 1] = 1.0
    upper[1, cu + 2] = along
    upper[1, size] = across - y1[top, cu + 1]
    if bending is not None:
        upper[2, 5] = 1.0
        upper[2, 6] = -y1[top, 5]


@kernel
def lower_end(anchor, parts, problem, gains, a, d, y1, base, time, lower, like):
    size = len(like)
    cu = size // 3
    if anchor is None:
        _hanging_end(parts.body, parts, problem, gains, a, d, y1, base, time, lower, like)
    else:
        for r in range(2):
            lower[r, cu + r] = 1.0
            lower[r, size] = -y1[0, cu + r]
    if parts.bending is not None:
        lower[2, 5] = 1.0
        lower[2, 6] = -y1[0, 5]


@kernel
def _hanging_end(present, parts, problem, gains, a, d, y1, base, time, lower, like):
    """The motion of the body; without one no force but the release pull P: T = -P sin phi, S = -P cos phi.

    Without bending there is no S: the cable's own motion along the normal at s = 0 takes the second condition's place.
    """
    if present is None:
        cable, numeric = problem.cable, problem.numeric
        size = len(like)
        cf = size // 3 + 2
        f = gains.scale
        pull = numeric.pull
        c = math.cos(y1[0, cf])
        s = math.sin(y1[0, cf])
        firm = 1.0
        if parts.inextensible is None:
            firm = cable.stiffness
        lower[0, 0] = f * firm
        lower[0, cf] = f * pull * c
        lower[0, size] = -f * (firm * y1[0, 0] + pull * s)
        if pull != 0.0 or parts.bending is not None:
            lower[1, cf] = -f * pull * s
            lower[1, size] = -f * pull * c
            _add_shear(parts.bending, f, y1[0, 1], lower, size)
        else:
            _free_normal(parts, problem, gains, a, d, base, time, lower, like)
    else:
        _body(parts, problem, gains, a, d, base, time, lower, like)


@kernel
def _add_shear(bending, f, shear, lower, size):
    if bending is not None:
        lower[1, 1] = f
        lower[1, size] -= f * shear


@kernel
def _free_normal(parts, problem, gains, a, d, base, time, lower, like):
    """m (v_t + u phi_t) = w sin phi + f_n at the free end, times the cable's length."""
    cable, medium = problem.cable, problem.medium
    size = len(like)
    cu = size // 3
    n = a.shape[0]
    phi = a[0, cu + 2]
    s = math.sin(phi)
    c = math.cos(phi)
    stretch = 1.0 + strain(parts.inextensible, a[0, 0])
    u = a[0, cu]
    v = a[0, cu + 1]
    spin = d[0, cu + 2]
    across = d[0, cu + 1] + u * spin
    _, fn, heavy = cell_water(
        parts.surface, parts, cable, medium, 0.0, stretch, s, c, u, v, across, base[n - 1, 0], base[n - 1, 1], gains.reach, time
    )
    f = gains.scale * cable.length
    k = gains.k
    lower[1, size] = -f * (cable.weight * s + fn[0] - heavy * across)
    lower[1, cu] = f * k * (fn[2] - heavy * spin)
    lower[1, cu + 1] = f * (k * fn[3] - heavy * gains.m)
    lower[1, cu + 2] = f * (k * (cable.weight * c + fn[4]) - heavy * u * gains.m)
    if parts.inextensible is None:
        lower[1, 0] = f * k * fn[1]


@kernel
def _body(parts, problem, gains, a, d, base, time, lower, like):
    """M (u_t - v phi_t) = T - W cos phi + F_t, M (v_t + u phi_t) = S + W sin phi + F_n at the lower end."""
    cable, body, numeric = problem.cable, problem.body, problem.numeric
    size = len(like)
    cu = size // 3
    n = a.shape[0]
    phi = a[0, cu + 2]
    s = math.sin(phi)
    c = math.cos(phi)
    u = a[0, cu]
    v = a[0, cu + 1]
    spin = d[0, cu + 2]
    along = d[0, cu] - v * spin
    across = d[0, cu + 1] + u * spin
    ft, fn, mass = body_at_surface(
        parts.surface, parts, body, cable, s, c, u, v, along, across, base[n - 1, 0], base[n - 1, 1], gains.reach, time
    )
    weight = body.weight
    pull = numeric.pull
    f = gains.scale
    k = gains.k
    m = gains.m
    force = tension(parts.inextensible, cable, numeric, a[0, 0], d[0, 0])
    lower[0, size] = -f * (force - weight * c + pull * s + ft[0] - mass * along)
    lower[0, 0] = f * tension_gain(parts.inextensible, cable, numeric, gains)
    lower[0, cu] = f * (k * ft[1] - m * mass)
    lower[0, cu + 1] = f * k * (ft[2] + mass * spin)
    lower[0, cu + 2] = f * (k * (weight * s + pull * c + ft[3]) + m * mass * v)
    lower[1, size] = -f * (weight * s + pull * c + fn[0] - mass * across)
    lower[1, cu] = f * k * (fn[1] - mass * spin)
    lower[1, cu + 1] = f * (k * fn[2] - m * mass)
    lower[1, cu + 2] = f * (k * (weight * c - pull * s + fn[3]) - m * mass * u)
    _add_shear(parts.bending, f * k, a[0, 1] / k, lower, size)
