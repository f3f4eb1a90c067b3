"""The water's surface: which share of a cell and of a body is wet, what floats it, and where its drag is felt.

Level: z = 0, or the surface as it is where waves are stretched or cut to it.  A sphere of radius R whose middle is z above it is wet to

    share(x) = 1/2 - 3x/4 + x^3/4,  x = z/R from -1 to 1                        (exact)

and so, with half its diameter for R, is a short piece of cable.  M is the integral of the share over z, G that of M.  A straight cell
whose ends are z1 and z2 above the level has the share (M2 - M1)/(z2 - z1), and the energy of its buoyancy b a length is

    U = -b h E,   E = (G2 - G1)/(z2 - z1) + (split - 1/2) (M1 - M2),

so that its nodes are lifted by b h dE/dz1 and b h dE/dz2: where all is wet by b h split and b h (1 - split).
"""

from typing import NamedTuple

from cable_model.kernels.choice import by_presence
from cable_model.kernels.jit import kernel
from cable_model.kernels.vector import zero
from cable_model.kernels.wave_records import NOBODY
from cable_model.kernels.wave_sums import HIGHEST
from cable_model.kernels.waves import elevation_over

SHORT = 0.02  # of R: differences of heights below it lose too many digits, and quadrature takes their place
GAUSS = (0.1127016653792583, 0.5, 0.8872983346207417)
WEIGHT = (5.0 / 18.0, 8.0 / 18.0, 5.0 / 18.0)


class Share(NamedTuple):
    """Wet share of a cell, derivatives by the heights of its lower and upper end, and those of its buoyancy's E."""

    wet: float
    w1: float
    w2: float
    w11: float
    w12: float
    w22: float
    e1: float
    e2: float
    e11: float
    e12: float
    e22: float


@kernel
def share(z, r):
    """Wet share of a sphere of radius r whose middle is z above the level, and its first and second derivative by z."""
    if z >= r:
        return 0.0, 0.0, 0.0
    if z <= -r:
        return 1.0, 0.0, 0.0
    x = z / r
    return 0.5 - 0.75 * x + 0.25 * x * x * x, (0.75 * x * x - 0.75) / r, 1.5 * x / (r * r)


@kernel
def share_integrals(z, r):
    """M and G: integrals of the share over z, from r down; above r they are 0."""
    if z >= r:
        return 0.0, 0.0
    if z <= -r:
        return z, 0.5 * z * z + 0.1 * r * r
    x = z / r
    first = 0.5 * x - 0.375 * x * x + 0.0625 * x * x * x * x - 0.1875
    second = 0.25 * x * x - 0.125 * x * x * x + 0.0125 * x * x * x * x * x - 0.1875 * x + 0.05
    return r * first, r * r * second


@kernel
def centre(z, r):
    """How far the middle of a sphere's wet part is below its own middle, and the derivative by z."""
    if z >= r:
        return r, 0.0
    if z <= -r:
        return 0.0, 0.0
    x = z / r
    return 0.75 * r * (1.0 + x) * (1.0 + x) / (2.0 + x), 0.75 * (1.0 + x) * (3.0 + x) / ((2.0 + x) * (2.0 + x))


@kernel
def _long_cell(z1, z2, r, skew):
    """See cell_share: differences of the integrals."""
    s1, d1, _ = share(z1, r)
    s2, d2, _ = share(z2, r)
    m1, g1 = share_integrals(z1, r)
    m2, g2 = share_integrals(z2, r)
    inv = 1.0 / (z2 - z1)
    wet = (m2 - m1) * inv
    w1 = (wet - s1) * inv
    w2 = (s2 - wet) * inv
    mean = (g2 - g1) * inv
    e1 = (mean - m1) * inv
    e2 = (m2 - mean) * inv
    return Share(
        wet,
        w1,
        w2,
        (2.0 * w1 - d1) * inv,
        (w2 - w1) * inv,
        (d2 - 2.0 * w2) * inv,
        e1 + skew * s1,
        e2 - skew * s2,
        (2.0 * e1 - s1) * inv + skew * d1,
        (e2 - e1) * inv,
        (s2 - 2.0 * e2) * inv - skew * d2,
    )


@kernel
def _level_cell(z1, z2, r, skew):
    """See cell_share: integrals along the cell by three Gauss points, exact where the share is one cubic."""
    wet = w1 = w2 = w11 = w12 = w22 = e1 = e2 = e11 = e12 = e22 = 0.0
    for k in range(3):
        up = GAUSS[k]
        low = 1.0 - up
        s, d, dd = share(low * z1 + up * z2, r)
        s *= WEIGHT[k]
        d *= WEIGHT[k]
        dd *= WEIGHT[k]
        wet += s
        w1 += low * d
        w2 += up * d
        w11 += low * low * dd
        w12 += low * up * dd
        w22 += up * up * dd
        e1 += low * s
        e2 += up * s
        e11 += low * low * d
        e12 += low * up * d
        e22 += up * up * d
    s1, d1, _ = share(z1, r)
    s2, d2, _ = share(z2, r)
    return Share(wet, w1, w2, w11, w12, w22, e1 + skew * s1, e2 - skew * s2, e11 + skew * d1, e12, e22 - skew * d2)


@kernel
def cell_share(z1, z2, r, split):
    """The Share of a cell whose ends are z1 and z2 above the level; the lower end has the share `split` of its load."""
    if abs(z2 - z1) < SHORT * r:
        return _level_cell(z1, z2, r, split - 0.5)
    return _long_cell(z1, z2, r, split - 0.5)


@kernel
def _reach(waves):
    if waves is None:
        return 0.0
    return waves[HIGHEST, 0]


@kernel
def crest(parts):
    """Height that the surface never rises above."""
    if parts.stretched is None and parts.cut is None:
        return 0.0
    return _reach(parts.waves)


@kernel
def level_over(parts, position, time, below):
    """Height of the surface over a place, and its rate, m/s; `below` the height 0 by more than waves reach, it may be taken as 0."""
    return level_over_point(parts, NOBODY, zero(position), position, time, below)


@kernel
def level_over_point(parts, i, speed, position, time, below):
    """The same over a point that records follow, see wave_records.py, and that moves at a velocity."""
    if parts.stretched is None and parts.cut is None:
        return 0.0, 0.0
    return _level(parts.waves, parts, i, speed, position, time, below)


@kernel
def _still_level(waves, parts, i, speed, position, time, below):
    return 0.0, 0.0


@kernel
def _wavy_level(waves, parts, i, speed, position, time, below):
    if below > waves[HIGHEST, 0]:
        return 0.0, 0.0
    height, rate, _ = elevation_over(parts, waves, i, speed, position, time)
    return height, rate


_level = by_presence(_still_level, _wavy_level)
