"""Friction along the seabed: at every node a spring and a dashpot, which give way where they pull harder than mu N.

With the stretch xi of the spring before a step of length h, the node's velocity u along the bottom and the length l that it carries:

    P = l (k (xi + h u) + c u),    friction -F on the cable with F = P where |P| <= mu N, else mu N P/|P|

and the stretch after the step is the one at which both pull at F: F = l (k xi' + c (xi' - xi)/h).  With w the weight per length in
water, k = mu w over the displacement and c = mu w over the velocity at which a lying cable begins to slide.

xi belongs to the state, so a cable that is held stays where it is for ever; under a law of the velocity alone it creeps.  u is averaged
as the step averages velocities.  What F takes, h F u, is then never less than what the spring stores: friction feeds nothing.
Newton's method sees the kink between holding and sliding as it is; what it needs beside the derivative is told where it is done.

Statics of a cable that was laid out (ground.laid) measure xi from the place where a node lay before the cable was pulled: P = l k (r + xi)
with xi minus that place.  Other statics have no friction: mu, k and c are 0.
"""

from cable_model.kernels.bottom import add_tilt
from cable_model.kernels.choice import by_presence
from cable_model.kernels.contact import BASE, BEFORE, FORCE, NOW, TURNS, WAIT
from cable_model.kernels.jit import kernel
from cable_model.kernels.vector import (
    add_matrix,
    axpy,
    diagonal,
    dot,
    load_from,
    mix,
    norm,
    outer,
    scale,
    scale_matrix,
    store_from,
    sub,
    zero,
)

LEVEL_WITH = 1e-6  # share of mu N by which a slider that holds may exceed it: rounding


@kernel
def _along(a, up):
    """The part of a vector along a bottom with the normal `up`."""
    return axpy(-dot(a, up), up, a)


@kernel
def _no_slider(friction, ground, length, like, contact, i):
    return


@kernel
def _start(friction, ground, length, like, contact, i):
    base = zero(like)
    if ground.laid == 0.0:
        base = load_from(contact, i, BASE, like)
    store_from(contact, i, BEFORE, scale(ground.grip * length, base))
    contact[i, TURNS] = 0.0
    contact[i, WAIT] = 0.0


start_slider = by_presence(_no_slider, _start)  # before the first iteration of a step


@kernel
def _by_velocity(ground, gains, length):
    """Derivative of P by the velocity at the new time."""
    by_place = gains.r if ground.laid > 0.0 else gains.step * gains.v
    return length * (ground.grip * by_place + ground.drag * gains.v)


@kernel
def _no_friction(friction, ground, gains, length, up, turns, position, v, force, contact, i):
    return zero(v), zero(v), diagonal(0.0, v)


@kernel
def _friction(friction, ground, gains, length, up, turns, position, v, force, contact, i):
    ahead = _along(position, up) if ground.laid > 0.0 else scale(gains.step, _along(v, up))
    base = load_from(contact, i, BASE, v)
    stretch = axpy(1.0, ahead, _along(base, up))
    pull = mix(length * ground.grip, stretch, length * ground.drag, _along(v, up))
    before = load_from(contact, i, BEFORE, v)
    store_from(contact, i, BEFORE, pull)
    store_from(contact, i, NOW, pull)
    by = _by_velocity(ground, gains, length)
    level = add_matrix(diagonal(1.0, v), scale_matrix(-1.0, outer(up, up)))
    whole = mix(length * ground.grip, axpy(gains.step, v, base), length * ground.drag, v)  # of which the pull is the part along
    turned = gains.r / gains.v if gains.v > 0.0 else 0.0  # the place at the new time by the velocity that Newton's method seeks
    limit = ground.friction * force
    size = norm(pull)
    if size <= limit:
        return zero(v), pull, add_tilt(ground.relief, turns, turned, diagonal(1.0, v), up, whole, scale_matrix(by, level))
    t = scale(1.0 / size, pull)
    if dot(before, t) < 0.0:
        # it pulled the other way at the iteration before: the derivative there and here, next to 0, would let it go to and fro
        contact[i, TURNS] += 1.0
        contact[i, WAIT] = 2.0 ** contact[i, TURNS] - 1.0
        chord = (limit + min(limit, norm(before))) / norm(sub(pull, before))
        return scale(ground.friction, t), zero(v), scale_matrix(by * chord, level)
    firm, across = level, diagonal(1.0, v)
    if contact[i, WAIT] > 0.0:
        contact[i, WAIT] -= 1.0  # the secant from 0, whose steps never go too far
    else:
        slid = scale_matrix(-1.0, outer(t, t))
        firm, across = add_matrix(level, slid), add_matrix(across, slid)
    by_velocity = add_tilt(ground.relief, turns, turned * limit / size, across, up, whole, scale_matrix(by * limit / size, firm))
    return scale(ground.friction, t), zero(v), by_velocity


friction_of = by_presence(_no_friction, _friction)  # per N; what does not go with N; the derivative of both by the velocity at fixed N


@kernel
def _no_change(friction, ground, gains, length, up, x, force, new_force, contact, i, like):
    return False


@kernel
def _move(friction, ground, gains, length, up, x, force, new_force, contact, i, like):
    by = _by_velocity(ground, gains, length)
    before = load_from(contact, i, BEFORE, like)
    now = axpy(by, _along(load_from(x, i, 0, like), up), before)
    store_from(contact, i, NOW, now)
    if new_force < ground.smoothing * length:
        return False
    held = norm(before) <= (1.0 + LEVEL_WITH) * ground.friction * force
    holds = norm(now) <= (1.0 + LEVEL_WITH) * ground.friction * new_force
    return held != holds or (not holds and dot(now, before) < 0.0)


# Newton's change of a slider's pull, with that of N from `force` to `new_force`; whether it now holds, slides or turns where the law was
# linearised as if it did not: then the step is not solved, however small the change
move_slider = by_presence(_no_change, _move)


@kernel
def _nothing_kept(friction, ground, length, h, contact, i, like, stretch):
    return


@kernel
def _keep(friction, ground, length, h, contact, i, like, stretch):
    pull = load_from(contact, i, NOW, like)
    size = norm(pull)
    limit = ground.friction * contact[i, FORCE]
    if size > limit:
        pull = scale(limit / size, pull)
    firm = h * ground.grip + ground.drag
    kept = zero(like)
    if firm > 0.0:
        kept = mix(h / (firm * length), pull, ground.drag / firm, load_from(stretch, i, 0, like))
    store_from(stretch, i, 0, kept)


keep_slider = by_presence(_nothing_kept, _keep)  # the stretch after an accepted step of length h


@kernel
def _none(friction, n):
    return 0


@kernel
def _one_a_node(friction, n):
    return n - 1


slider_count = by_presence(_none, _one_a_node)  # of n nodes; the top is prescribed
