"""Cells and body of the box grid at the water's surface: the wet share of what the water does, and what that share's change does.

A cell feels its forces at its middle, half on each node, so its wet share is taken there: it changes with the height z of the middle and
with half the height of the cell.  Buoyancy and the exchange of added mass with the surface (see staggered_surface.py) are those of z; what
they would turn the cell by is left out, which is of the grid's order.  Local axes t = (s, c), n = (c, -s) in (x, z).
"""

from cable_model.kernels.box_water import added_mass, body_water, cable_water, relative_flow
from cable_model.kernels.choice import by_presence
from cable_model.kernels.jit import kernel
from cable_model.kernels.surface import cell_share, centre, level_over, share


@kernel
def _deep_cell(surface, parts, cable, medium, h, stretch, s, c, u, v, turning, x, z, reach, time):
    ft, fn = cable_water(parts.water, parts, medium, stretch, s, c, u, v, x, z, reach, time)
    return ft, fn, cable.mass + added_mass(parts.water, medium)


@kernel
def _slopes(cell, ma, buoyancy, w, rise, turning, by_z, by_rate, by_half, by_w):
    """Derivatives by one unknown of a wet share, of the force up and of that along -n, from those of height, its rate, half and w."""
    slope = cell.w1 + cell.w2
    wet = slope * by_z + (cell.w2 - cell.w1) * by_half
    slopes = (cell.w11 + 2.0 * cell.w12 + cell.w22) * by_z + (cell.w22 - cell.w11) * by_half
    up = 0.5 * ma * (slopes * w * w + 2.0 * slope * w * by_w) + buoyancy * wet
    return wet, up, ma * (slopes * rise * w + slope * by_rate * w + slope * rise * by_w + turning * wet)


@kernel
def _crossing(surface, parts, cable, medium, h, stretch, s, c, u, v, turning, x, z, reach, time):
    """`turning` is the cell's acceleration along n, of which the added mass takes the wet share."""
    r = 0.5 * cable.diameter
    rise = u * c - v * s
    middle = z + reach * rise
    half = 0.5 * h * stretch * c
    level, level_rate = level_over(parts, (x + reach * (u * s + v * c), middle), time, -middle - abs(half) - r)
    if middle + abs(half) <= level - r:
        return _deep_cell(surface, parts, cable, medium, h, stretch, s, c, u, v, turning, x, z, reach, time)
    cell = cell_share(middle - half - level, middle + half - level, r, 0.5)
    wet = cell.wet
    place = z - (1.0 - wet) * abs(half)
    deep_t, deep_n = cable_water(parts.water, parts, medium, stretch, s, c, u, v, x, place, reach, time)
    _, across, _ = relative_flow(parts, s, c, u, v, x, place, reach, time)
    w = across[0]
    ma = medium.added_mass
    buoyancy = medium.displaced_mass * cable.gravity
    slope = cell.w1 + cell.w2
    fall = u * s + v * c  # less what turning makes of the rate of the height
    rate = rise - level_rate
    up = 0.5 * ma * slope * w * w - buoyancy * (1.0 - wet)
    by_strain = _slopes(cell, ma, buoyancy, w, rate, turning, 0.0, 0.0, 0.5 * h * c, 0.0)
    by_u = _slopes(cell, ma, buoyancy, w, rate, turning, reach * c, c, 0.0, across[1])
    by_v = _slopes(cell, ma, buoyancy, w, rate, turning, -reach * s, -s, 0.0, across[2])
    by_phi = _slopes(cell, ma, buoyancy, w, rate, turning, -reach * fall, -fall, -0.5 * h * stretch * s, across[3])
    return (
        (
            wet * deep_t[0] + up * c,
            wet * deep_t[1] + by_strain[0] * deep_t[0] + by_strain[1] * c,
            wet * deep_t[2] + by_u[0] * deep_t[0] + by_u[1] * c,
            wet * deep_t[3] + by_v[0] * deep_t[0] + by_v[1] * c,
            wet * deep_t[4] + by_phi[0] * deep_t[0] + by_phi[1] * c - up * s,
        ),
        (
            wet * deep_n[0] - up * s - ma * slope * rate * w,
            wet * deep_n[1] + by_strain[0] * deep_n[0] - by_strain[1] * s - by_strain[2],
            wet * deep_n[2] + by_u[0] * deep_n[0] - by_u[1] * s - by_u[2],
            wet * deep_n[3] + by_v[0] * deep_n[0] - by_v[1] * s - by_v[2],
            wet * deep_n[4] + by_phi[0] * deep_n[0] - by_phi[1] * s - by_phi[2] - up * c,
        ),
        cable.mass + wet * ma,
    )


# water on a cell per unstretched length as box_water.cable_water gives it, with what its buoyancy lacks, and the mass that is accelerated
# along n; in the derivatives also what a change of that mass takes
cell_water = by_presence(_deep_cell, _crossing)


@kernel
def _deep_body(surface, parts, body, cable, s, c, u, v, along, across, x, z, reach, time):
    ft, fn = body_water(parts.water, parts, body, s, c, u, v, x, z, reach, time)
    return ft, fn, body.mass + body.added_mass


@kernel
def _body_slopes(body, lift, wet, slope, bend, wt, wn, rate, along, across, by_z, by_rate, by_t, by_n):
    """Derivatives by one unknown of the wet share, of the force up, and of those along -t and -n."""
    ma = body.added_mass
    wets = slope * by_z
    slopes = bend * by_z
    up = 0.5 * ma * (slopes * (wt * wt + wn * wn) + 2.0 * slope * (wt * by_t + wn * by_n)) + lift * wets
    swing = ma * (slopes * rate + slope * by_rate)
    return wets, up, swing * wt + ma * (slope * rate * by_t + along * wets), swing * wn + ma * (slope * rate * by_n + across * wets)


@kernel
def _bobbing_body(surface, parts, body, cable, s, c, u, v, along, across, x, z, reach, time):
    """`along` and `across` are the body's acceleration."""
    r = body.radius
    rise = u * c - v * s
    middle = z + reach * rise
    level, level_rate = level_over(parts, (x + reach * (u * s + v * c), middle), time, -middle - r)
    if middle <= level - r:
        return _deep_body(surface, parts, body, cable, s, c, u, v, along, across, x, z, reach, time)
    wet, slope, bend = share(middle - level, r)
    drop, _ = centre(middle - level, r)
    deep_t, deep_n = body_water(parts.water, parts, body, s, c, u, v, x, z - drop, reach, time)
    t, n, _ = relative_flow(parts, s, c, u, v, x, z - drop, reach, time)
    lift = body.displaced_mass * cable.gravity
    fall = u * s + v * c
    rate = rise - level_rate
    up = 0.5 * body.added_mass * slope * (t[0] * t[0] + n[0] * n[0]) - lift * (1.0 - wet)
    swing = body.added_mass * slope * rate
    by_u = _body_slopes(body, lift, wet, slope, bend, t[0], n[0], rate, along, across, reach * c, c, t[1], n[1])
    by_v = _body_slopes(body, lift, wet, slope, bend, t[0], n[0], rate, along, across, -reach * s, -s, t[2], n[2])
    by_phi = _body_slopes(body, lift, wet, slope, bend, t[0], n[0], rate, along, across, -reach * fall, -fall, t[3], n[3])
    return (
        (
            wet * deep_t[0] + up * c - swing * t[0],
            wet * deep_t[1] + by_u[0] * deep_t[0] + by_u[1] * c - by_u[2],
            wet * deep_t[2] + by_v[0] * deep_t[0] + by_v[1] * c - by_v[2],
            wet * deep_t[3] + by_phi[0] * deep_t[0] + by_phi[1] * c - by_phi[2] - up * s,
        ),
        (
            wet * deep_n[0] - up * s - swing * n[0],
            wet * deep_n[1] + by_u[0] * deep_n[0] - by_u[1] * s - by_u[3],
            wet * deep_n[2] + by_v[0] * deep_n[0] - by_v[1] * s - by_v[3],
            wet * deep_n[3] + by_phi[0] * deep_n[0] - by_phi[1] * s - by_phi[3] - up * c,
        ),
        body.mass + wet * body.added_mass,
    )


# water on the body as box_water.body_water gives it, with what its buoyancy lacks, and the mass that is accelerated
body_at_surface = by_presence(_deep_body, _bobbing_body)
