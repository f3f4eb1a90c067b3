"""Water on the box grid, in the local axes of a cell or of the lower end: drag, added mass and Froude-Krylov force."""

import math

from cable_model.kernels.fluid import body_drag, water_motion
from cable_model.kernels.jit import kernel
from cable_model.kernels.vector import apply, dot


@kernel
def relative_flow(parts, s, c, u, v, x, z, reach, time):
    """Velocity relative to the water and its derivatives by u, v, phi, along t and n; and the water's acceleration there."""
    t = (s, c)
    n = (c, -s)
    position = (x + reach * (u * s + v * c), z + reach * (u * c - v * s))
    flow, flow_rate, gradient = water_motion(parts, position, time)
    along = apply(gradient, t)
    across = apply(gradient, n)
    tt = reach * dot(t, along)
    tn = reach * dot(t, across)
    nt = reach * dot(n, along)
    nn = reach * dot(n, across)
    flow_t = dot(flow, t)
    flow_n = dot(flow, n)
    return (
        (u - flow_t, 1.0 - tt, -tn, -flow_n - u * tn + v * tt),
        (v - flow_n, -nt, 1.0 - nn, flow_t - u * nn + v * nt),
        (dot(flow_rate, t), dot(flow_rate, n)),
    )


@kernel
def cable_water(water, parts, medium, stretch, s, c, u, v, x, z, reach, time):
    """Water on the cable per unstretched length but for its added mass: ((f_t and its derivatives by eps, u, v, phi), (f_n ...)).

    Drag by components along t and n; displaced mass times the water's whole acceleration, as T is the effective tension, and added
    mass times its part along n: its own acceleration only, so that a steady uniform current has none however the cable turns.
    The change of that acceleration with place is left out of the derivatives (it is of the order of the wave's steepness times the
    squared step).
    """
    if water is None:
        return (0.0, 0.0, 0.0, 0.0, 0.0), (0.0, 0.0, 0.0, 0.0, 0.0)
    along, across, flow_rate = relative_flow(parts, s, c, u, v, x, z, reach, time)
    root = math.sqrt(stretch)
    kt = medium.tangential_drag * root
    kn = medium.normal_drag * root
    ft = -kt * abs(along[0]) * along[0]
    fn = -kn * abs(across[0]) * across[0]
    dt = -2.0 * kt * abs(along[0])
    dn = -2.0 * kn * abs(across[0])
    pressed = medium.added_mass + medium.displaced_mass
    displaced = medium.displaced_mass
    return (
        (
            ft + displaced * flow_rate[0],
            0.5 * ft / stretch,
            dt * along[1],
            dt * along[2],
            dt * along[3] + displaced * flow_rate[1],
        ),
        (
            fn + pressed * flow_rate[1],
            0.5 * fn / stretch,
            dn * across[1],
            dn * across[2],
            dn * across[3] - pressed * flow_rate[0],
        ),
    )


@kernel
def added_mass(water, medium):
    if water is None:
        return 0.0
    return medium.added_mass


@kernel
def body_water(water, parts, body, s, c, u, v, x, z, reach, time):
    """Drag and Froude-Krylov force on the body, as cable_water but without the derivative by eps."""
    if water is None:
        return (0.0, 0.0, 0.0, 0.0), (0.0, 0.0, 0.0, 0.0)
    along, across, flow_rate = relative_flow(parts, s, c, u, v, x, z, reach, time)
    drag, g = body_drag(body.drag, (along[0], across[0]))
    pressed = body.displaced_mass + body.added_mass
    return (
        (
            drag[0] + pressed * flow_rate[0],
            g[0] * along[1] + g[1] * across[1],
            g[0] * along[2] + g[1] * across[2],
            g[0] * along[3] + g[1] * across[3] + pressed * flow_rate[1],
        ),
        (
            drag[1] + pressed * flow_rate[1],
            g[2] * along[1] + g[3] * across[1],
            g[2] * along[2] + g[3] * across[2],
            g[2] * along[3] + g[3] * across[3] - pressed * flow_rate[0],
        ),
    )
