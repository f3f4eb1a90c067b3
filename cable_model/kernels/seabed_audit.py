"""What the audit reads of a seabed: its force on the nodes at the end of a step, from their heights and the stretch of the sliders.

A seabed acts at the end of a step (see seabed.py), and so it is read there: the work is that force times the way of the node.
"""

import math

from cable_model.kernels.bottom import over_bottom
from cable_model.kernels.choice import by_presence
from cable_model.kernels.contact import BASE
from cable_model.kernels.jit import kernel
from cable_model.kernels.seabed import carried, under
from cable_model.kernels.sections import made_of
from cable_model.kernels.vector import add, axpy, dot, load, load_from, mix, sub, zero


@kernel
def _no_slider(friction, ground, contact, sliders, i, length, h, like):
    return zero(like)


@kernel
def _slider(friction, ground, contact, sliders, i, length, h, like):
    """Minus the pull of spring and dashpot, N."""
    before, now = load_from(contact, i, BASE, like), load(sliders, i, like)
    return mix(-length * (ground.grip + ground.drag / h), now, length * ground.drag / h, before)


_friction = by_presence(_no_slider, _slider)


@kernel
def _under_node(parts, p, mesh, i):
    """Stiffness of the seabed under a metre, N/m2, and mass of a metre, kg/m, of node i: means over the halves of its cells."""
    up = made_of(parts.sections, p, mesh, i)
    if i == 0:
        return p[0].seabed.stiffness * up.diameter, up.mass_per_length
    low = made_of(parts.sections, p, mesh, i - 1)
    a, b = mesh[i, 1] * mesh[i, 0], (1.0 - mesh[i - 1, 1]) * mesh[i - 1, 0]
    wide = up.diameter if up.diameter == low.diameter else (a * up.diameter + b * low.diameter) / (a + b)
    mass = up.mass_per_length if up.mass_per_length == low.mass_per_length else (a * up.mass_per_length + b * low.mass_per_length) / (a + b)
    return p[0].seabed.stiffness * wide, mass


@kernel
def _no_bed(seabed, parts, problem, mesh, y0, y1, before, after, sliders, contact, h):
    return zero(before), 0.0


@kernel
def _on_bed(seabed, parts, problem, mesh, y0, y1, before, after, sliders, contact, h):
    p, ground = problem.numbers, problem.ground
    bed = p[0].seabed
    n = mesh.shape[0] + 1
    low0, low1 = before, after
    height0, height1 = load(y0, n - 1, before), load(y1, n - 1, before)  # those that the seabed feels: from where the top was brought
    force = zero(before)
    work = 0.0
    for i in range(n - 2, -1, -1):
        low0 = axpy(-mesh[i, 0], load(y0, i, before), low0)
        low1 = axpy(-mesh[i, 0], load(y1, i, before), low1)
        height0 = axpy(-mesh[i, 0], load(y0, i, before), height0)
        height1 = axpy(-mesh[i, 0], load(y1, i, before), height1)
        own = under(ground.sections, ground, mesh, i)
        firm, mass = _under_node(parts, p, mesh, i)
        lag = max(2.0 * bed.damping_ratio * math.sqrt(mass / firm), h)
        length = carried(own, mesh, i)
        above, up = over_bottom(ground.relief, ground, height1)
        f = -firm * length * (above + lag * dot(load(y1, n + i, before), up))
        w0 = own.smoothing * length
        root = math.sqrt(f * f + w0 * w0)
        pushed = 0.5 * (f + root) if f > 0.0 else 0.5 * w0 * w0 / (root - f)
        rubbed = _friction(parts.friction, own, contact, sliders, i, length, h, before)
        if i > 0 or parts.anchor is None:
            force = add(force, axpy(pushed, up, rubbed))
        work += pushed * dot(sub(height1, height0), up) + dot(rubbed, sub(low1, low0))
    return force, work


bed_in_step = by_presence(_no_bed, _on_bed)  # force of the seabed on what counts for momentum, N; and its work in a step of h, J
