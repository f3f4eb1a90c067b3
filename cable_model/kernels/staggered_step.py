"""One implicit step of the staggered chain: Newton's method on the node velocities under any member of the family.

State Y is (2n, D): rows 0 ... n-2 the cell vectors q, row n-1 the integrated position of the top (for anchored cables),
rows n ... 2n-1 the node velocities.  Every public function has a twin of the same name and arguments for the box grid.
"""

from typing import NamedTuple

from cable_model.kernels.block_elimination import solve
from cable_model.kernels.cells import of_cell
from cable_model.kernels.contact import CHANGE
from cable_model.kernels.contact import COLUMNS as CONTACT_COLUMNS
from cable_model.kernels.convergence import has_converged, is_rough
from cable_model.kernels.jit import kernel, views
from cable_model.kernels.line_bodies import mass_on, weight_on
from cable_model.kernels.problem import body_mass, density_of
from cable_model.kernels.seabed import rests, start_contacts, update_contacts
from cable_model.kernels.slack import fading, floor, step_tension, width
from cable_model.kernels.staggered import FADING, SHARE, assemble, prescribe_ends
from cable_model.kernels.vector import axpy, dot, load, mix, norm, scale, store, store_from, sub, zero

MAX_ITERATIONS = 25
MAX_TURNS = 60  # iterations where the change of one is limited
DIVERGED = -1
NOT_CONVERGED = -2
FELT_TIME = 0.1  # of sqrt(L/g): vibrations much faster than this do not count as errors
ROUNDED = 1e-15  # of T_c
SLACK_MARGIN = 100.0  # widths of the slack law: below this a cell is deep in slack


class Winding(NamedTuple):
    """How the cable's length changes at the averaged time."""

    length: float  # m
    rate: float  # of the length over the length, 1/s
    change: float  # second derivative of the length over the length, 1/s2


class Gains(NamedTuple):
    """Derivatives of the quantities at the averaged time by the velocity at the new time."""

    q: float
    v: float
    a: float
    r: float
    law: float  # 1: tensions and contact forces are drawn to their laws; 0: they are taken as they are
    step: float  # s
    winding: object


class Scratch(NamedTuple):
    """Work arrays of a step."""

    q: object
    v: object
    a: object
    x: object
    bands: object
    cells: object
    length: object  # stretch of the cells before the step
    contact: object  # columns of contact.py
    whole: object  # all of it, for statics on coarser meshes


@kernel
def scratch_size(n, dimension):
    return n * (7 * dimension + 6 + CONTACT_COLUMNS) + 5 * n * dimension * dimension


@views
def cut_scratch(work, n, like):
    d = len(like)
    m = n * d
    o = 4 * m + 5 * m * d + n * (3 * d + 6)
    return Scratch(
        work[0:m].reshape((n, d)),
        work[m : 2 * m].reshape((n, d)),
        work[2 * m : 3 * m].reshape((n, d)),
        work[3 * m : 4 * m].reshape((n, d)),
        work[4 * m : 4 * m + 5 * m * d].reshape((5, n, d * d)),
        work[4 * m + 5 * m * d : 4 * m + 5 * m * d + n * (3 * d + 5)].reshape((n, 3 * d + 5)),
        work[o - n : o],
        work[o : o + n * CONTACT_COLUMNS].reshape((n, CONTACT_COLUMNS)),
        work,
    )


@kernel
def newton_step(parts, problem, mesh, y0, yd0, ydd, c, time, h, top, ends, winding, contraction, y1, yd1, force, force_old, reach, s):
    """Advance (y0, yd0) by h into (y1, yd1); returns the iterations, or a negative status.

    `yd0` is already corrected for a changed step; with `ydd`, its rate of change, it predicts.  `time` and `top` are those at the
    averaged time t_i - alpha_k h, `ends` are the prescribed velocities of the top and a held lower end at the new time.  `contraction`
    (1,) is that of convergence.py.  The first guess of the tensions (n-1) leads from `force_old` over `force` on by `reach`, the ratio of
    the steps; the new ones are left in s.cells[:, 0], with T_c of slack.py.
    """
    n = mesh.shape[0] + 1
    like = top
    rate_old = c.alpha_m / (1.0 - c.alpha_m)
    rate_new = 1.0 / (1.0 - c.alpha_m)
    to_position = h * c.gamma * rate_new * (1.0 - c.alpha_k)
    to_rate = 1.0 / (c.gamma * h)
    back = (1.0 - c.gamma) / c.gamma
    moved = to_position * (1.0 - c.alpha_k)
    gains = Gains(moved, 1.0 - c.alpha_k, (1.0 - c.alpha_m) * to_rate, moved, 1.0, h, winding)
    ahead = 0.5 * h - (c.alpha_m - c.alpha_k) * h  # yd0 belongs to (alpha_m - alpha_k) h after the start
    if is_rough(contraction):  # rates of rates, and of tensions, mislead there
        ahead = 0.0
        reach = 0.0
    for i in range(n - 1):
        rate = axpy(ahead, load(ydd, n + i, like), load(yd0, n + i, like))
        store(y1, n + i, axpy(h, rate, load(y0, n + i, like)))
    store(y1, 2 * n - 1, ends.top)
    hold_anchor(parts.anchor, y1, n, ends.lower)
    for i in range(n - 1):
        held = _floor(parts, problem, mesh, i)
        s.cells[i, 0] = _ahead(parts.slack, force[i] + held, reach * (force[i] - force_old[i]), ROUNDED * held)
        s.length[i] = norm(load(y0, i, like))
    _fade(parts, problem, mesh, s)
    _forget_slack(parts.slack, parts, problem, mesh, c.alpha_k, s)
    top = _integrated_top(parts, y0, yd0, y1, c, h, rate_old, rate_new, top)
    start_contacts(parts.seabed, parts.friction, problem.ground, mesh, y0, n - 1, h, like, s.contact)
    previous = 1e300
    for iteration in range(1, (MAX_TURNS if problem.numeric.turn > 0.0 else MAX_ITERATIONS) + 1):
        average(mesh, y0, yd0, y1, c, h, rate_old, rate_new, to_rate, back, s, like, problem.numeric.blunt)
        assemble(parts, problem, gains, mesh, s.q, s.v, s.a, top, time, 0, s.bands, s.x, s.cells, s.contact)
        prescribe_ends(parts, s.bands, s.x, n, like)
        solve(parts.bending, parts.anchor, s.bands, s.x, s.cells, n, like)
        shortened = _shorten(problem.numeric.turn, gains.q, mesh, s, like)
        change = 0.0
        for i in range(n):
            for k in range(len(like)):
                dv = s.x[i, k]
                y1[n + i, k] += dv
                if change == change and not abs(dv) <= change:  # a NaN stays
                    change = abs(dv)
        if not change < 1e12:
            return DIVERGED
        cut = _update_tensions(parts.slack, parts, problem, mesh, s.cells)
        cut = update_contacts(parts.seabed, parts.friction, problem.ground, gains, mesh, s.x, like, s.contact) or cut
        if has_converged(iteration, change, previous, problem.numeric, contraction) and not cut and not shortened:
            _finish(mesh, y0, yd0, y1, yd1, c, h, rate_old, rate_new, to_rate, back, like)
            return iteration
        previous = change
    return NOT_CONVERGED


@kernel
def _shorten(turn, by_velocity, mesh, s, like):
    """Take a share of Newton's changes where one of a cell vector would be larger than `turn`; whether so."""
    if turn == 0.0:
        return False
    largest = 0.0
    for i in range(mesh.shape[0]):
        largest = max(largest, norm(sub(load(s.x, i + 1, like), load(s.x, i, like))) * by_velocity / mesh[i, 0])
    if not largest > turn:
        return False
    share = turn / largest
    for i in range(mesh.shape[0]):
        s.cells[i, 1] *= share
        s.contact[i, CHANGE] *= share
        for k in range(len(like)):
            s.x[i, k] *= share
    return True


@kernel
def _ahead(slack, tension, rise, least):
    """Extrapolated tension; the slack law's stays positive, and at least `least`, as rounding may have left nothing of T + T_c."""
    if slack is None:
        return tension + rise
    return max(tension + rise, 0.5 * tension, least)


@kernel
def _floor(parts, problem, mesh, i):
    """slack.floor of cell i."""
    return floor(parts, of_cell(parts.sections, parts, problem, mesh, i).numeric, mesh[i, 0])


@kernel
def _fade(parts, problem, mesh, s):
    """Shares of the slack damping at the tensions that are foretold."""
    below = problem.numeric.hung
    density = density_of(parts.water, problem.numbers)
    for i in range(mesh.shape[0]):
        numeric = of_cell(parts.sections, parts, problem, mesh, i).numeric
        below += numeric.own * mesh[i, 0] + abs(weight_on(parts.line_bodies, mesh, i, density, problem.cable.gravity))
        s.cells[i, FADING] = fading(parts.slack, s.cells[i, 0] - floor(parts, numeric, mesh[i, 0]), below)


@kernel
def _forget_slack(slack, parts, problem, mesh, alpha_k, s):
    """A cell that was slack counts as just straight in the averaged strain.

    Else it could overshoot unopposed until its average is taut, and so gain strain energy from nothing.
    """
    if slack is None:
        return
    last = s.cells.shape[1] - 1
    for i in range(mesh.shape[0]):
        own = of_cell(parts.sections, parts, problem, mesh, i)
        lost = floor(parts, own.numeric, mesh[i, 0]) + SLACK_MARGIN * width(own.numeric, mesh[i, 0])
        least = 1.0 - lost / own.cable.stiffness
        s.cells[i, last] = alpha_k * max(least - s.length[i], 0.0)


@kernel
def _update_tensions(slack, parts, problem, mesh, cells):
    cut = False
    for i in range(mesh.shape[0]):
        w0 = width(of_cell(parts.sections, parts, problem, mesh, i).numeric, mesh[i, 0])
        cells[i, 0], limited = step_tension(slack, w0, cells[i, 0], cells[i, 1])
        cut = cut or limited
    return cut


@kernel
def _integrated_top(parts, y0, yd0, y1, c, h, rate_old, rate_new, top):
    """Where the cable's own motion brings its top at the averaged time: held from below, its heights count from there."""
    if parts.anchor is None and parts.seabed is None:
        return top
    n = y0.shape[0] // 2
    before = load(y0, n - 1, top)
    rate = load(yd0, n - 1, top)
    drift = mix(1.0 - c.alpha_k, load(y1, 2 * n - 1, top), c.alpha_k, load(y0, 2 * n - 1, top))
    after = axpy(h, mix(1.0 - c.gamma, rate, c.gamma, mix(rate_new, drift, -rate_old, rate)), before)
    return mix(1.0 - c.alpha_k, after, c.alpha_k, before)


@kernel
def hold_anchor(anchor, y1, n, velocity):
    if anchor is not None:
        store(y1, n, velocity)


@kernel
def average(mesh, y0, yd0, y1, c, h, rate_old, rate_new, to_rate, back, s, like, blunt=0.0, lowest=0, beyond=0):
    """Cell vectors and velocities at the averaged time, accelerations at theirs; from node `lowest` to before `beyond`, 0: to the top."""
    n = mesh.shape[0] + 1
    last = n if beyond == 0 else beyond
    low = mix(1.0 - c.alpha_k, load(y1, n + lowest, like), c.alpha_k, load(y0, n + lowest, like))
    for i in range(lowest, last):
        v0 = load(y0, n + i, like)
        v1 = load(y1, n + i, like)
        vd0 = load(yd0, n + i, like)
        vd1 = axpy(-back, vd0, scale(to_rate, sub(v1, v0)))
        store(s.a, i, mix(1.0 - c.alpha_m, vd1, c.alpha_m, vd0))
        store(s.v, i, mix(1.0 - c.alpha_k, v1, c.alpha_k, v0))
        if i + 1 < n:
            up = mix(1.0 - c.alpha_k, load(y1, n + i + 1, like), c.alpha_k, load(y0, n + i + 1, like))
            q0 = load(y0, i, like)
            qd0 = load(yd0, i, like)
            qd1 = mix(rate_new / mesh[i, 0], sub(up, low), -rate_old, qd0)
            q1 = axpy(h, mix(1.0 - c.gamma, qd0, c.gamma, qd1), q0)
            store(s.q, i, mix(1.0 - c.alpha_k, q1, c.alpha_k, q0))
            length = (dot(q1, q1) + blunt * blunt) ** 0.5
            s.cells[i, 2] = (1.0 - c.alpha_k) * length + c.alpha_k * s.length[i]
            store_from(s.cells, i, 3, scale(1.0 / length, q1))
            low = up


@kernel
def _finish(mesh, y0, yd0, y1, yd1, c, h, rate_old, rate_new, to_rate, back, like):
    """Rates and cell vectors at the new time from the converged velocities."""
    n = mesh.shape[0] + 1
    for i in range(n):
        v0 = load(y0, n + i, like)
        v1 = load(y1, n + i, like)
        store(yd1, n + i, axpy(-back, load(yd0, n + i, like), scale(to_rate, sub(v1, v0))))
        if i + 1 < n:
            up = mix(1.0 - c.alpha_k, load(y1, n + i + 1, like), c.alpha_k, load(y0, n + i + 1, like))
            low = mix(1.0 - c.alpha_k, v1, c.alpha_k, v0)
            drift = scale(1.0 / mesh[i, 0], sub(up, low))
        else:  # the integrated position of the top
            drift = mix(1.0 - c.alpha_k, v1, c.alpha_k, v0)
        rate = mix(rate_new, drift, -rate_old, load(yd0, i, like))
        store(yd1, i, rate)
        store(y1, i, axpy(h, mix(1.0 - c.gamma, load(yd0, i, like), c.gamma, rate), load(y0, i, like)))


@kernel
def change_length(mesh, y, yd, ydd, factor):
    """Give the mesh `factor` times its length; positions stay where they are.

    The nodes keep their shares of the length and cable moves past them: see `wound` in staggered.py.
    """
    for i in range(mesh.shape[0]):
        mesh[i, 0] *= factor
        for k in range(y.shape[1]):
            y[i, k] /= factor
            yd[i, k] /= factor
            ydd[i, k] /= factor


@kernel
def keep_tensions(parts, problem, mesh, force, s):
    """Take over the tensions T that the last Newton iteration found."""
    for i in range(force.shape[0]):
        force[i] = s.cells[i, 0] - _floor(parts, problem, mesh, i)


@kernel
def rate_error(parts, problem, mesh, y0, yd0, y1, yd1, ydd, c, time, h, reach, top, winding, s):
    """Root mean squares over the mass, m/s2: of what the accelerations differ from their extrapolation by `reach`, as felt; and of the
    motion: its acceleration, or its velocity over sqrt(L/g) where that is less, as it is where waves along the cable ring.

    Felt: the Newton matrix of a step of FELT_TIME stands for the mass, so that what the cable's stiffness takes up within that
    time does not count.  Else waves along the cable, of no size but of large accelerations, would rule the step.  Nor do nodes count that
    the seabed carries: one that lands stops at once, whatever the step.
    """
    n = mesh.shape[0] + 1
    like = top
    rate_old = c.alpha_m / (1.0 - c.alpha_m)
    rate_new = 1.0 / (1.0 - c.alpha_m)
    to_rate = 1.0 / (c.gamma * h)
    period = (problem.cable.length / max(problem.cable.gravity, 1e-3)) ** 0.5
    felt_in = max(h, FELT_TIME * period)
    moved = felt_in * c.gamma * rate_new * (1.0 - c.alpha_k) * (1.0 - c.alpha_k)
    gains = Gains(moved, 1.0 - c.alpha_k, (1.0 - c.alpha_m) / (c.gamma * felt_in), moved, 1.0, h, winding)
    top = _integrated_top(parts, y0, yd0, y1, c, h, rate_old, rate_new, top)
    average(mesh, y0, yd0, y1, c, h, rate_old, rate_new, to_rate, (1.0 - c.gamma) / c.gamma, s, like, 0.0)
    assemble(parts, problem, gains, mesh, s.q, s.v, s.a, top, time, 0, s.bands, s.x, s.cells, s.contact)
    faster = 0.0
    moving = 0.0
    for i in range(n - 1):
        now = load(s.a, i, like)
        faster += _mass(parts, problem, mesh, i) * dot(now, now)
        now = load(s.v, i, like)
        moving += _mass(parts, problem, mesh, i) * dot(now, now)
        s.cells[i, 1] = 0.0
    _missed_momentum(parts, problem, gains, mesh, yd0, yd1, ydd, reach, s, like)
    for i in range(n - 1):
        if _rests(parts, problem, mesh, i, s):
            store(s.x, i, zero(like))
    prescribe_ends(parts, s.bands, s.x, n, like)
    solve(parts.bending, parts.anchor, s.bands, s.x, s.cells, n, like)
    total = 0.0
    summed = 0.0
    for i in range(n - 1):
        mass = _mass(parts, problem, mesh, i)
        felt = load(s.x, i, like)
        total += mass
        if not _rests(parts, problem, mesh, i, s):
            summed += mass * dot(felt, felt)
    return (summed / total) ** 0.5, min((faster / total) ** 0.5, (moving / total) ** 0.5 / period)


@kernel
def _missed_momentum(parts, problem, gains, mesh, yd0, yd1, ydd, reach, s, like):
    """What the accelerations differ from their extrapolation by, times the mass as the inertia is shared, into s.x."""
    n = mesh.shape[0] + 1
    for i in range(n):
        store(s.v, i, sub(axpy(-reach, load(ydd, n + i, like), load(yd1, n + i, like)), load(yd0, n + i, like)))
        store(s.x, i, zero(like))
    store(s.x, 0, scale(gains.a * body_mass(problem.body), load(s.v, 0, like)))
    for i in range(n - 1):
        share = gains.a * _mass_per_length(parts, problem, mesh, i) * mesh[i, 0]
        low = load(s.v, i, like)
        up = load(s.v, i + 1, like)
        store(s.x, i, axpy(share, mix(mesh[i, 1] - SHARE, low, SHARE, up), load(s.x, i, like)))
        store(s.x, i + 1, scale(share, mix(1.0 - mesh[i, 1] - SHARE, up, SHARE, low)))
    if parts.line_bodies is not None:
        for i in range(1, n - 1):
            store(s.x, i, axpy(gains.a * mass_on(parts.line_bodies, mesh, i), load(s.v, i, like), load(s.x, i, like)))


@kernel
def _rests(parts, problem, mesh, i, s):
    return rests(parts.seabed, problem.ground, of_cell(parts.sections, parts, problem, mesh, i).cable.weight, mesh, i, s.contact)


@kernel
def _mass_per_length(parts, problem, mesh, i):
    return of_cell(parts.sections, parts, problem, mesh, i).cable.mass


@kernel
def _mass(parts, problem, mesh, i):
    """Mass of cable, and at the lower end of the body, that node i carries."""
    above = _mass_per_length(parts, problem, mesh, i)
    if i == 0:
        return above * mesh[0, 1] * mesh[0, 0] + body_mass(problem.body)
    below = _mass_per_length(parts, problem, mesh, i - 1)
    return mass_on(parts.line_bodies, mesh, i) + above * mesh[i, 1] * mesh[i, 0] + below * (1.0 - mesh[i - 1, 1]) * mesh[i - 1, 0]
