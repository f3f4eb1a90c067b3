"""What the audit of a staggered chain reads: energies, momentum, outer loads and what damping takes, apart from the kernels that step it.

All is written from the equations and from the numbers of the scene, at the ends of an internal step and in its middle (the mean of both
ends); velocities of the water, the wet share of a shape and the elastic law's points are those of fluid.py, surface.py and slack.py.
Cable, body and water are as in staggered.py, and nothing here is linearized or solved for.
"""

import math

from cable_model.kernels.cells import of_cell
from cable_model.kernels.choice import by_presence
from cable_model.kernels.clamps import BELOW, TOP, clamp_energy, turned
from cable_model.kernels.fluid import water_motion
from cable_model.kernels.jit import kernel
from cable_model.kernels.line_bodies import ABOVE, joint, mass_on, row_of
from cable_model.kernels.sections import made_of
from cable_model.kernels.slack import elastic, floor, width
from cable_model.kernels.surface import Share, cell_share, centre, level_over, share
from cable_model.kernels.vector import add, axpy, dot, load, mix, norm, scale, sub, upward, zero

COUPLED = 1.0 / 12.0  # of a cell's mass that couples its two nodes
NO_LENGTH = 1e-12  # a cell that turns round within a step has none in its middle
DEEP = -1e300  # below it no wave reaches: every level is looked up


@kernel
def mass_of_body(body, p):
    if body is None:
        return 0.0
    return p[0].body.mass


@kernel
def stored(parts, problem, mesh, y, top):
    """Kinetic, potential and elastic (strain and bending) energy of cable and body in y (2n, D) under the top, J."""
    p = problem.numbers
    gravity = p[0].environment.gravity
    n = mesh.shape[0] + 1
    kinetic = 0.0
    potential = 0.0
    strained = 0.0
    at = top
    v_up = load(y, 2 * n - 1, top)
    for i in range(n - 2, -1, -1):
        h, split = mesh[i, 0], mesh[i, 1]
        m = made_of(parts.sections, p, mesh, i).mass_per_length
        q = load(y, i, top)
        v = load(y, n + i, top)
        upper = at[len(at) - 1]
        at = axpy(-h, q, at)
        squares = (split - COUPLED) * dot(v, v) + 2.0 * COUPLED * dot(v, v_up) + (1.0 - split - COUPLED) * dot(v_up, v_up)
        kinetic += 0.5 * m * h * squares
        potential += m * gravity * h * (split * at[len(at) - 1] + (1.0 - split) * upper)
        strained += h * _strain_energy(parts, problem, mesh, i, norm(q) - 1.0)
        on_line = mass_on(parts.line_bodies, mesh, i)
        kinetic += 0.5 * on_line * dot(v, v)
        potential += on_line * gravity * at[len(at) - 1]
        v_up = v
    mass = mass_of_body(parts.body, p)
    kinetic += 0.5 * mass * dot(v_up, v_up)
    potential += mass * gravity * at[len(at) - 1]
    strained += clamp_energy(parts.top_clamp, TOP, parts, problem, mesh, y, top)
    strained += clamp_energy(parts.lower_clamp, BELOW, parts, problem, mesh, y, top)
    return kinetic, potential, strained + _bending_energy(parts.bending, parts, p, mesh, y, top)


@kernel
def _bending_energy(bending, parts, p, mesh, y, like):
    if bending is None:
        return 0.0
    energy = 0.0
    for i in range(1, mesh.shape[0]):
        turn = sub(load(y, i, like), load(y, i - 1, like))
        energy += 0.5 * _turn_stiffness(parts, p, mesh, i) * dot(turn, turn)
    return energy


@kernel
def _turn_stiffness(parts, p, mesh, i):
    """Moment over the turn at node i, N m: the flexibilities of the half cells below and above it, as springs in series."""
    low, up = made_of(parts.sections, p, mesh, i - 1).bending_stiffness, made_of(parts.sections, p, mesh, i).bending_stiffness
    if low == up:
        return low / ((1.0 - mesh[i - 1, 1]) * mesh[i - 1, 0] + mesh[i, 1] * mesh[i, 0])
    if low == 0.0 or up == 0.0:
        return 0.0
    return 1.0 / ((1.0 - mesh[i - 1, 1]) * mesh[i - 1, 0] / low + mesh[i, 1] * mesh[i, 0] / up)


@kernel
def _strain_energy(parts, problem, mesh, i, strain):
    """Integral of the tension at rest over the strain, J/m, of cell i."""
    h, numeric = mesh[i, 0], of_cell(parts.sections, parts, problem, mesh, i).numeric
    stiffness, more = _above_linear(parts.curve, parts, made_of(parts.sections, problem.numbers, mesh, i).axial_stiffness, strain)
    if parts.slack is None:
        return 0.5 * stiffness * strain * strain + more
    held = floor(parts, numeric, h)
    w0 = max(width(numeric, h), 1e-300)
    f = stiffness * strain + held
    root = math.sqrt(f * f + w0 * w0)
    logarithm = math.log((abs(f) + root) / w0)
    law = (f * f + f * root + w0 * w0 * (logarithm if f >= 0.0 else -logarithm)) / (4.0 * stiffness)
    return law - held * strain - 0.5 * held * held / stiffness + more


@kernel
def _none_above(curve, parts, stiffness, strain):
    return stiffness, 0.0


@kernel
def _by_table(curve, parts, stiffness, strain):
    secant = curve[1, 1] / curve[1, 0]
    if strain <= 0.0:
        return secant, 0.5 * (curve[0, 2] - secant) * strain * strain if parts.slack is None else 0.0
    energy = -0.5 * secant * strain * strain
    for i in range(1, curve.shape[0]):
        w = curve[i, 0] - curve[i - 1, 0]
        s = min((strain - curve[i - 1, 0]) / w, 1.0)
        if s <= 0.0:
            return secant, energy
        rise = curve[i, 1] - curve[i - 1, 1]
        c1 = curve[i - 1, 2] * w
        c2 = 3.0 * rise - 2.0 * c1 - curve[i, 2] * w
        c3 = c1 + curve[i, 2] * w - 2.0 * rise
        energy += w * s * (curve[i - 1, 1] + s * (c1 / 2.0 + s * (c2 / 3.0 + s * c3 / 4.0)))
    last = curve.shape[0] - 1
    rest = max(strain - curve[last, 0], 0.0)
    return secant, energy + rest * (curve[last, 1] + 0.5 * curve[last, 2] * rest)


_above_linear = by_presence(_none_above, _by_table)  # a stiffness, and the energy of a table beyond that of the linear law of it, J/m


@kernel
def taken_by_damping(parts, problem, mesh, y0, y1, fading, h, like):
    """What axial damping takes in a step of h, J; `fading` (n-1): the share at which the slack damping acted, the step's own."""
    p = problem.numbers
    taken = 0.0
    for i in range(mesh.shape[0]):
        numeric = of_cell(parts.sections, parts, problem, mesh, i).numeric
        before, after = norm(load(y0, i, like)), norm(load(y1, i, like))
        at_rest, _ = elastic(parts.curve, made_of(parts.sections, p, mesh, i).axial_stiffness, 0.5 * (before + after) - 1.0)
        at_rest += floor(parts, numeric, mesh[i, 0])
        rate = (after - before) / h
        moving = at_rest + (numeric.voigt + numeric.damping * mesh[i, 0] * fading[i]) * rate
        if parts.quadratic_damping is not None:
            moving += p[0].cable.quadratic_damping * abs(rate) * rate
        more = moving - at_rest
        if parts.slack is not None:
            w0 = width(numeric, mesh[i, 0])
            more = 0.5 * (more + math.sqrt(moving * moving + w0 * w0) - math.sqrt(at_rest * at_rest + w0 * w0))
        taken += mesh[i, 0] * more * (after - before)
    return taken


@kernel
def change_of_momentum(parts, problem, mesh, y0, y1, like):
    """Change of the momentum of cable and body, kg m/s, and the weight of what counts, N: all, but for an anchor what moves with node 0."""
    p = problem.numbers
    n = mesh.shape[0] + 1
    change = zero(like)
    mass = mass_of_body(parts.body, p)
    up = sub(load(y1, 2 * n - 1, like), load(y0, 2 * n - 1, like))
    for i in range(n - 2, -1, -1):
        h, split = mesh[i, 0], mesh[i, 1]
        m = made_of(parts.sections, p, mesh, i).mass_per_length
        low = sub(load(y1, n + i, like), load(y0, n + i, like))
        if i > 0 or parts.anchor is None:
            on_line = mass_on(parts.line_bodies, mesh, i)
            mass += m * h + on_line
            change = add(change, mix(m * h * split + on_line, low, m * h * (1.0 - split), up))
        else:
            mass += m * h * (1.0 - split)
            change = add(change, mix(m * h * COUPLED, low, m * h * (1.0 - split - COUPLED), up))
        up = low
    change = axpy(mass_of_body(parts.body, p), up, change)
    return change, upward(-mass * p[0].environment.gravity, like)


@kernel
def pull_of_anchor(anchor, parts, problem, mesh, y0, y1, tension, like):
    """Force of the lowest cell, of that tension, on the cable above node 0; none without an anchor."""
    if anchor is None:
        return zero(like)
    q = mix(0.5, load(y0, 0, like), 0.5, load(y1, 0, like))
    pull = scale(-tension / max(norm(q), NO_LENGTH), q)
    if parts.bending is not None:
        above = mix(0.5, load(y0, 1, like), 0.5, load(y1, 1, like))
        stiff = _turn_stiffness(parts, problem.numbers, mesh, 1) / mesh[0, 0]
        pull = axpy(stiff, sub(above, q), pull)
    before = turned(parts.lower_clamp, BELOW, parts, problem, mesh, y0, like)
    after = turned(parts.lower_clamp, BELOW, parts, problem, mesh, y1, like)
    pull = axpy(-0.5 / mesh[0, 0], add(before, after), pull)
    return pull


@kernel
def _across(a, t):
    return axpy(-dot(a, t), t, a)


@kernel
def _all_wet(surface, parts, low, up, split, r, time):
    return Share(1.0, 0.0, 0.0, 0.0, 0.0, 0.0, split, 1.0 - split, 0.0, 0.0, 0.0), 0.0


@kernel
def _cut_by_surface(surface, parts, low, up, split, r, time):
    level, rate = level_over(parts, mix(0.5, low, 0.5, up), time, DEEP)
    z1, z2 = low[len(low) - 1] - level, up[len(up) - 1] - level
    if max(z1, z2) <= -r:
        return _all_wet(surface, parts, low, up, split, r, time)
    return cell_share(z1, z2, r, split), rate


_wet_share = by_presence(_all_wet, _cut_by_surface)  # of a cell between two places, and the rate of the level


@kernel
def _dry_cell(water, parts, p, cable, h, split, q, low, up, v_low, v_up, a_low, a_up, time):
    return zero(q), zero(q)


@kernel
def _wet_cell(water, parts, p, cable, h, split, q, low, up, v_low, v_up, a_low, a_up, time):
    density = p[0].water.density
    section = 0.25 * math.pi * cable.diameter * cable.diameter
    displaced = density * (cable.volume_per_length if cable.volume_per_length >= 0.0 else section)
    added = density * section * cable.added_mass_coefficient
    wet, rate = _wet_share(parts.surface, parts, low, up, split, 0.5 * cable.diameter, time)
    rise = wet.w1 * (v_low[len(q) - 1] - rate) + wet.w2 * (v_up[len(q) - 1] - rate)
    stretch = max(norm(q), NO_LENGTH)
    t = scale(1.0 / stretch, q)
    drop = 0.5 * (1.0 - wet.wet) * abs(up[len(q) - 1] - low[len(q) - 1])
    flow, flow_rate, _ = water_motion(parts, add(mix(0.5, low, 0.5, up), upward(-drop, q)), time)
    u_low, u_up = sub(v_low, flow), sub(v_up, flow)
    u = mix(0.5, u_low, 0.5, u_up)
    along = dot(u, t)
    normal = _across(u, t)
    drag = -0.5 * density * cable.diameter * math.sqrt(stretch)
    pull = mix(
        drag * cable.normal_drag_coefficient * norm(normal), normal, drag * cable.tangential_drag_coefficient * abs(along) * along, t
    )
    pull = add(pull, mix(added, _across(flow_rate, t), displaced, flow_rate))
    to_low, to_up = split - COUPLED, 1.0 - split - COUPLED
    on_low = scale(wet.wet, mix(split, pull, -added, _across(mix(to_low, a_low, COUPLED, a_up), t)))
    on_up = scale(wet.wet, mix(1.0 - split, pull, -added, _across(mix(to_up, a_up, COUPLED, a_low), t)))
    # added mass that depends on the place, see staggered_surface.py
    n_low, n_up = _across(mix(to_low, u_low, COUPLED, u_up), t), _across(mix(to_up, u_up, COUPLED, u_low), t)
    square = dot(u_low, n_low) + dot(u_up, n_up)
    lift = displaced * p[0].environment.gravity
    on_low = add(axpy(-added * rise, n_low, on_low), upward(lift * wet.e1 + 0.5 * added * wet.w1 * square, q))
    on_up = add(axpy(-added * rise, n_up, on_up), upward(lift * wet.e2 + 0.5 * added * wet.w2 * square, q))
    return scale(h, on_low), scale(h, on_up)


_on_cell = by_presence(_dry_cell, _wet_cell)  # force of the water on the lower and the upper node of a cell, N


@kernel
def _on_body(body, parts, p, at, v, a, time):
    """Force of the water on the body, N."""
    if body is None or parts.water is None:
        return zero(v)
    return _on_sphere(parts, p, p[0].body, at, v, a, time)


@kernel
def _nothing(bodies, parts, p, mesh, i, at, v, a, time):
    return zero(v)


@kernel
def _on_bodies(bodies, parts, p, mesh, i, at, v, a, time):
    force = zero(v)
    section = joint(mesh, i)
    if section < 0 or parts.water is None:
        return force
    for j in range(bodies.shape[0]):
        if int(bodies[j, ABOVE]) == section:
            force = add(force, _on_sphere(parts, p, row_of(bodies, j), at, v, a, time))
    return force


_on_line = by_presence(_nothing, _on_bodies)  # force of the water on the bodies on node i, N


@kernel
def _on_sphere(parts, p, hung, at, v, a, time):
    density = p[0].water.density
    displaced, radius = density * hung.volume, max((0.75 / math.pi * hung.volume) ** (1.0 / 3.0), 0.5 * p[0].cable.diameter)
    wet, slope, rate, drop = 1.0, 0.0, 0.0, 0.0
    if parts.surface is not None:
        level, rate = level_over(parts, at, time, DEEP)
        wet, slope, _ = share(at[len(v) - 1] - level, radius)
        drop, _ = centre(at[len(v) - 1] - level, radius)
    flow, flow_rate, _ = water_motion(parts, add(at, upward(-drop, v)), time)
    u = sub(v, flow)
    force = mix(-0.5 * density * hung.drag_area * norm(u), u, displaced + hung.added_mass, flow_rate)
    force = scale(wet, axpy(-hung.added_mass, a, force))
    force = axpy(-hung.added_mass * slope * (v[len(v) - 1] - rate), u, force)
    lift = wet * displaced * p[0].environment.gravity + 0.5 * hung.added_mass * slope * dot(u, u)
    return add(force, upward(lift, v))


@kernel
def water_in_step(parts, problem, mesh, y0, y1, before, after, h, time):
    """Force of the water on what counts for momentum, N, in the middle of a step, at `time`; and its work on all in the step, J."""
    n = mesh.shape[0] + 1
    p = problem.numbers
    force = zero(before)
    work = 0.0
    low0, low1 = before, after
    v_up = mix(0.5, load(y0, 2 * n - 1, before), 0.5, load(y1, 2 * n - 1, before))
    a_up = scale(1.0 / h, sub(load(y1, 2 * n - 1, before), load(y0, 2 * n - 1, before)))
    for i in range(n - 2, -1, -1):
        up0, up1 = low0, low1
        low0 = axpy(-mesh[i, 0], load(y0, i, before), up0)
        low1 = axpy(-mesh[i, 0], load(y1, i, before), up1)
        low, up = mix(0.5, low0, 0.5, low1), mix(0.5, up0, 0.5, up1)
        q = scale(1.0 / mesh[i, 0], sub(up, low))
        v_low = mix(0.5, load(y0, n + i, before), 0.5, load(y1, n + i, before))
        a_low = scale(1.0 / h, sub(load(y1, n + i, before), load(y0, n + i, before)))
        cable = made_of(parts.sections, p, mesh, i)
        on_low, on_up = _on_cell(parts.water, parts, p, cable, mesh[i, 0], mesh[i, 1], q, low, up, v_low, v_up, a_low, a_up, time)
        on_line = _on_line(parts.line_bodies, parts, p, mesh, i, low, v_low, a_low, time)
        on_low = add(on_low, on_line)
        force = add(force, on_up)
        if i > 0 or parts.anchor is None:
            force = add(force, on_low)
        work += dot(on_low, sub(low1, low0)) + dot(on_up, sub(up1, up0))
        v_up = v_low
        a_up = a_low
    on_body = _on_body(parts.body, parts, p, mix(0.5, low0, 0.5, low1), v_up, a_up, time)
    return add(force, on_body), work + dot(on_body, sub(low1, low0))
