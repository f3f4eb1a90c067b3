"""The tow model's straight cable and its body at the water's surface: wet shares, what floats them, what their change does.

Axes z up, in the plane (x, z); f from 0 at the top to 1 at the lower end.  The share of the cable that is wet about f is that of a sphere
as thick, see surface.py; what the model needs of it are moments over a segment, exact by three Gauss points where it is a cubic:

    S_k = int f^k share df,      T_k = int f^k share' df      (share' by the height; of what is wet all along S_k = 1/(k+1), T_k = 0)

The energy of buoyancy is -g times the displaced mass times int M df, M' = share.  That of added mass, 1/2 M_a int share w.P w df with w the
velocity in the water and P what is across the cable, has by Lagrange's equations the deep cable's terms with S_k in place of 1/(k+1), and

    -M_a [share' z_t P w - 1/2 share' (w.P w) e_z],       z_t the rate of the height above the level,

on f, as on the staggered grid (staggered_surface.py): it makes no energy.  The body likewise, with the added mass of each axis for P.
"""

from typing import NamedTuple

from cable_model.kernels.choice import by_presence
from cable_model.kernels.jit import kernel
from cable_model.kernels.surface import GAUSS, WEIGHT, centre, crest, level_over, share
from cable_model.kernels.vector import add, axpy, dot, mix, scale, sub, upward, zero


class Segment(NamedTuple):
    """A segment of the cable: its wet share, f at the middle of its wet part, moments of what is dry of it and T_0 to T_3."""

    wet: float
    middle: float
    dry0: float
    dry1: float
    dry2: float
    t0: float
    t1: float
    t2: float
    t3: float
    level_rate: float


class Loads(NamedTuple):
    """Sums over the segments: moments of what is dry, and the exchange of added mass with the surface, on R and in all, over M_a."""

    dry0: float
    dry1: float
    dry2: float
    arm: tuple
    total: tuple


class Wet(NamedTuple):
    """Moments S_0, S_1, S_2 of the whole cable, each over that of a cable that is wet all along."""

    whole: float
    first: float
    second: float


class Sphere(NamedTuple):
    """The body's wet share, its slope by the height, how far the middle of the wet part is below its own, and the level's rate."""

    wet: float
    slope: float
    drop: float
    level_rate: float


@kernel
def no_loads(like):
    return Loads(0.0, 0.0, 0.0, zero(like), zero(like))


@kernel
def _clamped(x):
    return min(max(x, 0.0), 1.0)


@kernel
def _always(surface, parts, c, top, reach):
    return True


@kernel
def _below_troughs(surface, parts, c, top, reach):
    last = len(top) - 1
    return max(top[last], top[last] + reach[last]) + c.radius <= -crest(parts)


is_deep = by_presence(_always, _below_troughs)  # whether the whole cable is, as far as is known without a look at each segment


@kernel
def wet_segment(c, i):
    return Segment(1.0, (i + 0.5) / c.segments, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0)


@kernel
def _deep_segment(surface, parts, c, i, top, reach, time):
    return wet_segment(c, i)


@kernel
def _crossing_segment(surface, parts, c, i, top, reach, time):
    r = c.radius
    f0, f1 = i / c.segments, (i + 1.0) / c.segments
    z = top[len(top) - 1]
    rise = reach[len(top) - 1]
    highest = z + max(f0 * rise, f1 * rise)
    level, level_rate = level_over(parts, axpy(0.5 * (f0 + f1), reach, top), time, -highest - r)
    if highest <= level - r:
        return wet_segment(c, i)
    z0 = z + f0 * rise - level
    span = (f1 - f0) * rise
    # where along the segment, from 0 to 1, it is wet all through (from p to q) and where the surface cuts it (from a to b)
    if span == 0.0:
        a, b = 0.0, 1.0
        p = q = 0.0
    elif span > 0.0:
        a, b = _clamped((-r - z0) / span), _clamped((r - z0) / span)
        p, q = 0.0, a
    else:
        a, b = _clamped((r - z0) / span), _clamped((-r - z0) / span)
        p, q = b, 1.0
    p = f0 + p * (f1 - f0)
    q = f0 + q * (f1 - f0)
    s0 = q - p
    s1 = 0.5 * (q * q - p * p)
    s2 = (q * q * q - p * p * p) / 3.0
    t0 = t1 = t2 = t3 = 0.0
    for k in range(3):
        at = a + (b - a) * GAUSS[k]
        f = f0 + at * (f1 - f0)
        wet, slope, _ = share(z0 + at * span, r)
        weight = WEIGHT[k] * (b - a) * (f1 - f0)
        s0 += weight * wet
        s1 += weight * wet * f
        s2 += weight * wet * f * f
        t0 += weight * slope
        t1 += weight * slope * f
        t2 += weight * slope * f * f
        t3 += weight * slope * f * f * f
    middle = s1 / s0 if s0 > 0.0 else 0.5 * (f0 + f1)
    dry0 = f1 - f0 - s0
    dry1 = 0.5 * (f1 * f1 - f0 * f0) - s1
    dry2 = (f1 * f1 * f1 - f0 * f0 * f0) / 3.0 - s2
    return Segment(s0 * c.segments, middle, dry0, dry1, dry2, t0, t1, t2, t3, level_rate)


segment = by_presence(_deep_segment, _crossing_segment)  # number i from the top, which leads by `reach` to the lower end


@kernel
def _unchanged(surface, loads, seg, velocity, flow, motion, e):
    return loads


@kernel
def _with_segment(surface, loads, seg, velocity, flow, motion, e):
    """`velocity` of the top, `motion` R' = the lower end's beside the top's, `flow` of the water at the segment; e along the cable."""
    if seg.wet == 1.0:
        return loads
    loads = Loads(loads.dry0 + seg.dry0, loads.dry1 + seg.dry1, loads.dry2 + seg.dry2, loads.arm, loads.total)
    if seg.t0 == 0.0:
        return loads
    last = len(e) - 1
    u = sub(velocity, flow)
    rise = velocity[last] - seg.level_rate
    n0 = axpy(-dot(u, e), e, u)
    n1 = axpy(-dot(motion, e), e, motion)
    return Loads(
        loads.dry0,
        loads.dry1,
        loads.dry2,
        add(loads.arm, _exchange(seg.t1, seg.t2, seg.t3, n0, n1, rise, motion[last])),
        add(loads.total, _exchange(seg.t0, seg.t1, seg.t2, n0, n1, rise, motion[last])),
    )


with_segment = by_presence(_unchanged, _with_segment)


@kernel
def _exchange(t0, t1, t2, n0, n1, z0, z1):
    """Integral of -share' [z_t P w - 1/2 (w.P w) e_z], with P w = n0 + f n1 and z_t = z0 + f z1."""
    square = t0 * dot(n0, n0) + 2.0 * t1 * dot(n0, n1) + t2 * dot(n1, n1)
    return add(mix(-t0 * z0 - t1 * z1, n0, -t1 * z0 - t2 * z1, n1), upward(0.5 * square, n0))


@kernel
def _no_change(surface, c, mass, loads):
    return zero(loads.arm), zero(loads.arm)


@kernel
def _surface_forces(surface, c, mass, loads):
    arm = axpy(mass, loads.arm, upward(-c.lift * loads.dry1, loads.arm))
    return arm, axpy(mass, loads.total, upward(-c.lift * loads.dry0, loads.arm))


surface_forces = by_presence(_no_change, _surface_forces)
surface_forces.__doc__ = """What the buoyancy of a cable wet all along is too much, and the exchange: on R and in all; `mass` M_a."""


@kernel
def _wet_all_along(surface, loads):
    return Wet(1.0, 1.0, 1.0)


@kernel
def _wet_in_part(surface, loads):
    return Wet(1.0 - loads.dry0, 1.0 - 2.0 * loads.dry1, 1.0 - 3.0 * loads.dry2)


wetness = by_presence(_wet_all_along, _wet_in_part)


@kernel
def _deep_sphere(surface, parts, c, place, time):
    return Sphere(1.0, 0.0, 0.0, 0.0)


@kernel
def _bobbing_sphere(surface, parts, c, place, time):
    r = c.body_radius
    z = place[len(place) - 1]
    level, level_rate = level_over(parts, place, time, -z - r)
    if z <= level - r:
        return Sphere(1.0, 0.0, 0.0, 0.0)
    wet, slope, _ = share(z - level, r)
    drop, _ = centre(z - level, r)
    return Sphere(wet, slope, drop, level_rate)


sphere = by_presence(_deep_sphere, _bobbing_sphere)  # the body, its middle at `place`


@kernel
def _deep_masses(surface, c, ball):
    return c.mass_x, c.mass_y


@kernel
def _bobbing_masses(surface, c, ball):
    dry = 1.0 - ball.wet
    return c.mass_x - dry * c.added_x, c.mass_y - dry * c.added_y


virtual_masses = by_presence(_deep_masses, _bobbing_masses)  # of the body with the added mass of its wet part, across and up


@kernel
def _no_body_change(surface, c, ball, velocity, flow):
    return zero(velocity)


@kernel
def _body_change(surface, c, ball, velocity, flow):
    if ball.wet == 1.0:
        return zero(velocity)
    last = len(velocity) - 1
    w = sub(velocity, flow)
    carried = sub(scale(c.added_x, w), upward((c.added_x - c.added_y) * w[last], w))
    rise = velocity[last] - ball.level_rate
    force = upward(0.5 * ball.slope * dot(w, carried) - c.body_lift * (1.0 - ball.wet), w)
    return axpy(-ball.slope * rise, carried, force)


body_forces = by_presence(_no_body_change, _body_change)
body_forces.__doc__ = """What the buoyancy of a deep body is too much, and the exchange of its added mass with the surface."""


@kernel
def _nothing_lost(surface, parts, c, top, reach):
    return 0.0


@kernel
def _lost_buoyancy(surface, parts, c, top, reach):
    dry = 0.0
    for i in range(c.segments):
        dry += segment(surface, parts, c, i, top, reach, 0.0).dry1
    ball = sphere(surface, parts, c, add(top, reach), 0.0)
    return c.lift * dry + c.body_lift * (1.0 - ball.wet)


lost_buoyancy = by_presence(_nothing_lost, _lost_buoyancy)  # on R, of a cable at rest in calm water, N
