"""The seabed under a cable: an elastic bottom that pushes along its normal only, with damping, and friction along it.

Per node with the length l of cable that it carries, at height z above the bottom (bottom.py), with velocity w along its normal:

    f = -K d l (z + lag w),   N = (f + sqrt(f^2 + w0^2))/2

K the stiffness in Pa/m, lag = 2 zeta sqrt(m/(K d)) but at least one time step (in statics none).  f is taken at the new time,
not at the averaged one: a node that lands is then at rest after a step, while the average of its velocities would let it ring
with lambda_infinity.
N is an unknown in the barrier form of slack.py; as it belongs to one node it is condensed there.  Friction is that of friction.py.
"""

from typing import NamedTuple

from cable_model.kernels import friction as sliders
from cable_model.kernels.bottom import add_turn, by_approach, normal_under, over_bottom, turning
from cable_model.kernels.choice import by_presence
from cable_model.kernels.contact import BASE, BY_VELOCITY, CHANGE, FORCE, HEIGHT, MOTION, NORMAL, PLACE, SPEED
from cable_model.kernels.jit import kernel
from cable_model.kernels.line_bodies import weight_on
from cable_model.kernels.problem import cable_of
from cable_model.kernels.sections import made_of
from cable_model.kernels.slack import constitutive, iterate, step_tension
from cable_model.kernels.vector import add_matrix, axpy, diagonal, dot, load, load_from, norm, outer, scale, store_from, sub, upward, zero

LIGHTEST = 1e-3  # of the weight of a metre on average
RESTING = 0.05  # of the weight that a node carries


class Ground(NamedTuple):
    """Constants of the seabed."""

    level: float  # m, along the normal of a bottom that is a plane
    stiffness: float  # K d, N/m2
    lag: float  # damping over stiffness, s
    least_lag: float  # in time steps
    friction: float  # mu, and of friction.py: 0 in statics without friction
    grip: float  # k, N/m2
    drag: float  # c, N s/m2
    laid: float  # 1: statics of a cable that was laid out from its anchor
    body_length: float  # of cable that would weigh as much as the body, m: the body sinks in as deep as the cable
    smoothing: float  # w0 of a unit length, N/m
    sections: object = None  # and what tells what a node has of it where there are any
    weight: float = 0.0  # of a metre, N/m: the scale of smoothing, grip, drag and body_length
    density: float = 0.0  # of the water, kg/m3
    numbers: object = None
    bodies: object = None  # on the cable, see line_bodies.py
    spread: float = 0.0  # N/m, that statics give a node's smoothing at least
    slope: object = None  # whether it slopes, and its normal
    normal: object = None
    relief: object = None  # the table of a bottom that is no plane, see bottom.py


@kernel
def _as_all(sections, ground, mesh, i):
    return ground


@kernel
def _of_both_cells(sections, ground, mesh, i):
    """The seabed under node i, whose cells lie on it with their own diameters, masses and weights, by the lengths that it carries."""
    p, gravity = ground.numbers, ground.numbers[0].environment.gravity
    above = mesh[i, 1] * mesh[i, 0]
    below = (1.0 - mesh[i - 1, 1]) * mesh[i - 1, 0] if i > 0 else 0.0
    up = cable_of(made_of(sections, p, mesh, i), 1.0, ground.density, gravity)
    low = cable_of(made_of(sections, p, mesh, max(i - 1, 0)), 1.0, ground.density, gravity)
    share = above / (above + below)
    whole = p[0].cable
    wide = (share * up.diameter + (1.0 - share) * low.diameter) / whole.diameter
    massive = (share * up.mass + (1.0 - share) * low.mass) / whole.mass_per_length
    heavy = max((share * abs(up.weight) + (1.0 - share) * abs(low.weight)) / ground.weight, LIGHTEST)
    own = heavy * ground.weight
    length = ground.body_length / heavy if i == 0 else abs(weight_on(ground.bodies, mesh, i, ground.density, gravity)) / own
    return Ground(
        ground.level, ground.stiffness * wide, ground.lag * (massive / wide) ** 0.5, ground.least_lag, ground.friction, ground.grip * heavy,
        ground.drag * heavy, ground.laid, length, max(p[0].solver.slack_smoothing * own, ground.spread), ground.sections, ground.weight,
        ground.density, p, ground.bodies, ground.spread, ground.slope, ground.normal,
        ground.relief,
    )  # fmt: skip


under = by_presence(_as_all, _of_both_cells)  # the seabed as node i has it


@kernel
def _nothing(bodies, ground):
    return 0.0


@kernel
def _share_of_bodies(bodies, ground):
    return ground.body_length


_of_bodies = by_presence(_nothing, _share_of_bodies)


@kernel
def carried(ground, mesh, i):
    """Unstretched length of cable that node i carries, with what would weigh as much as the bodies on it; `ground`: as the node has it."""
    if i == 0:
        return mesh[0, 1] * mesh[0, 0] + ground.body_length
    return mesh[i, 1] * mesh[i, 0] + (1.0 - mesh[i - 1, 1]) * mesh[i - 1, 0] + _of_bodies(ground.bodies, ground)


@kernel
def under_body(present, ground, mesh):
    """Share of the seabed's force on node 0 that the body there takes: the rest lifts the cable's part of the node."""
    if present is None:
        return 0.0
    length = under(ground.sections, ground, mesh, 0).body_length
    return length / (length + mesh[0, 1] * mesh[0, 0])


@kernel
def _nothing_begins(relief, place, motion, up, contact, i):
    return


@kernel
def _begins(relief, place, motion, up, contact, i):
    store_from(contact, i, PLACE, place)
    store_from(contact, i, MOTION, motion)
    store_from(contact, i, NORMAL, up)


_begin_there = by_presence(_nothing_begins, _begins)  # where a node is before a step, over a bottom that is no plane


@kernel
def _no_start(present, friction, ground, mesh, y0, top_row, h, like, contact):
    return


@kernel
def _start(present, friction, ground, mesh, y0, top_row, h, like, contact):
    n = mesh.shape[0] + 1
    position = load(y0, top_row, like)
    for i in range(n - 2, -1, -1):
        position = axpy(-mesh[i, 0], load(y0, i, like), position)
        height, up = over_bottom(ground.relief, ground, position)
        speed = dot(load(y0, n + i, like), up)
        _begin_there(ground.relief, position, load(y0, n + i, like), up, contact, i)
        own = under(ground.sections, ground, mesh, i)
        length = carried(own, mesh, i)
        w0 = own.smoothing * length
        f = -own.stiffness * length * (height + max(own.lag, own.least_lag * h) * speed)
        root = (f * f + w0 * w0) ** 0.5
        contact[i, FORCE] = 0.5 * (f + root) if f > 0.0 else 0.5 * w0 * w0 / (root - f)
        contact[i, HEIGHT] = height
        contact[i, SPEED] = speed
        sliders.start_slider(friction, own, length, like, contact, i)


start_contacts = by_presence(_no_start, _start)  # heights, velocities and forces of all nodes at the start of a step of length h


@kernel
def _never(present, ground, weight, mesh, i, contact):
    return False


@kernel
def _rests(present, ground, weight, mesh, i, contact):
    return contact[i, FORCE] > RESTING * abs(weight) * carried(under(ground.sections, ground, mesh, i), mesh, i)


rests = by_presence(_never, _rests)  # whether the seabed carries a good part of what hangs on node i; `weight` is that of a metre


@kernel
def _to_plane(relief, ground, now, position, v, contact, i):
    above, up = over_bottom(relief, ground, position)
    height = contact[i, HEIGHT] + now * (above - contact[i, HEIGHT])
    speed = contact[i, SPEED] + now * (dot(v, up) - contact[i, SPEED])
    return height, speed, v, up, turning(relief, position, up)


@kernel
def _to_relief(relief, ground, now, position, v, contact, i):
    before = load_from(contact, i, PLACE, position)
    place = axpy(now, sub(position, before), before)
    height, up = over_bottom(relief, ground, place)
    before = load_from(contact, i, MOTION, v)
    v = axpy(now, sub(v, before), before)
    store_from(contact, i, NORMAL, up)
    return height, dot(v, up), v, up, turning(relief, place, up)


_approach = by_presence(_to_plane, _to_relief)  # at the new time: height, velocity along the normal, velocity, normal, Turning


@kernel
def _no_load(present, friction, ground, gains, mesh, i, position, v, contact):
    return zero(v), diagonal(0.0, v)


@kernel
def _load(present, friction, whole, gains, mesh, i, position, v, contact):
    ground = under(whole.sections, whole, mesh, i)
    length = carried(ground, mesh, i)
    stiffness = ground.stiffness * length
    w0 = ground.smoothing * length
    lag = max(ground.lag, ground.least_lag * gains.step)
    now = 1.0 / gains.v if gains.v > 0.0 else 0.0  # from the average to the new time
    height, speed, v_new, up, turns = _approach(ground.relief, ground, now, position, v, contact, i)
    f = -stiffness * (height + lag * speed)
    force = iterate(present, w0, f, contact[i, FORCE])
    slope, misfit = constitutive(present, w0, f, force)
    change = gains.law * slope * misfit
    by_motion = scale(-gains.law * slope * stiffness * now, by_approach(ground.relief, turns, gains, lag, up, height, v_new))
    contact[i, FORCE] = force
    contact[i, CHANGE] = change
    store_from(contact, i, BY_VELOCITY, by_motion)
    share, held, by_velocity = sliders.friction_of(friction, ground, gains, length, up, turns, position, v, force, contact, i)
    along = sub(share, up)  # of the seabed's force, per N and negative
    residual = axpy(force + change, along, held)
    jacobian = add_turn(ground.relief, turns, -force * now * gains.r, outer(along, by_motion))
    return residual, add_matrix(jacobian, by_velocity)


node_load = by_presence(_no_load, _load)  # what the seabed adds to the residual of a node, and its derivative by the velocity


@kernel
def update_contacts(present, friction, ground, gains, mesh, x, like, contact):
    """Newton's change of the contact forces from that of the velocities; whether one was cut by more than a trifle, or changed its law."""
    if present is None:
        return False
    cut = False
    for i in range(mesh.shape[0]):
        up = normal_under(ground.relief, ground, contact, i, like)
        change = contact[i, CHANGE] + dot(load_from(contact, i, BY_VELOCITY, like), load(x, i, like))
        own = under(ground.sections, ground, mesh, i)
        length = carried(own, mesh, i)
        before = contact[i, FORCE]
        contact[i, FORCE], limited = step_tension(present, own.smoothing * length, before, change)
        other = sliders.move_slider(friction, own, gains, length, up, x, before, contact[i, FORCE], contact, i, like)
        cut = cut or limited or other
    return cut


@kernel
def _nothing_to_recall(friction, stretch, like, contact):
    return


@kernel
def _recall(friction, stretch, like, contact):
    for i in range(stretch.shape[0]):
        store_from(contact, i, BASE, load(stretch, i, like))


recall_sliders = by_presence(_nothing_to_recall, _recall)  # the state's stretches, before a step


@kernel
def _nothing_laid(friction, ground, mesh, anchor, top, contact):
    return


@kernel
def _lay_out(friction, ground, mesh, anchor, top, contact):
    if anchor is None:
        return
    ahead = sub(top, anchor)
    ahead = axpy(-ahead[len(top) - 1], upward(1.0, top), ahead)
    reach = norm(ahead)
    place = sub(zero(top), anchor)
    for i in range(mesh.shape[0]):
        store_from(contact, i, BASE, scale(ground.laid, axpy(-place[len(top) - 1], upward(1.0, top), place)))
        if reach > 0.0:
            place = axpy(-mesh[i, 0] / reach, ahead, place)


lay_out = by_presence(_nothing_laid, _lay_out)  # where nodes lie on a cable laid out unstretched from its anchor towards its top


@kernel
def _nothing_kept(friction, ground, mesh, h, like, contact, stretch):
    return


@kernel
def _keep(friction, ground, mesh, h, like, contact, stretch):
    for i in range(stretch.shape[0]):
        own = under(ground.sections, ground, mesh, i)
        sliders.keep_slider(friction, own, carried(own, mesh, i), h, contact, i, like, stretch)


keep_sliders = by_presence(_nothing_kept, _keep)  # the state's stretches, after an accepted step of length h
