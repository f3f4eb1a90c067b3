"""The finite-difference chain as a component: state layout, initialization, time steps under one stepper for both grids, outputs.

State: the header, then mesh, Y, Y', Y'' (backward difference of Y'), the state before, and the tensions of the cells.
"""

import math
from typing import NamedTuple

from cable_model.kernels import header, staggered_chain
from cable_model.kernels.family import coefficients
from cable_model.kernels.jit import kernel
from cable_model.kernels.problem import body_part, cable_part, node_count, total_weight, water_part
from cable_model.kernels.staggered_step import Numeric, Problem, cut_scratch, keep_tensions, newton_step, rate_error, scratch_size
from cable_model.kernels.top import evaluate
from cable_model.kernels.vector import axpy, load, mix, norm, scale, sub

SMALLEST_STEP = 1e-6  # of the base step, before a step is given up


class View(NamedTuple):
    """The arrays of a state vector and its work vector."""

    mesh: object
    y: object
    yd: object
    ydd: object
    y_old: object
    force: object
    force_old: object
    y1: object
    yd1: object
    yd0: object
    scratch: object


@kernel
def axes(space, x, y, z):
    """A vector in the chain's own dimension."""
    if space is None:
        return (x, z)
    return (x, y, z)


@kernel
def state_size(parts, p):
    n = node_count(p)
    d = len(axes(parts.space, 0.0, 0.0, 0.0))
    return header.HEADER + 8 * n * d + 4 * (n - 1)


@kernel
def work_size(parts, p):
    n = node_count(p)
    d = len(axes(parts.space, 0.0, 0.0, 0.0))
    return 6 * n * d + scratch_size(n, d)


@kernel
def cut(parts, p, state, work):
    n = node_count(p)
    like = axes(parts.space, 0.0, 0.0, 0.0)
    d = len(like)
    m = 2 * n * d
    o = header.HEADER + 2 * (n - 1)
    return View(
        state[header.HEADER : o].reshape((n - 1, 2)),
        state[o : o + m].reshape((2 * n, d)),
        state[o + m : o + 2 * m].reshape((2 * n, d)),
        state[o + 2 * m : o + 3 * m].reshape((2 * n, d)),
        state[o + 3 * m : o + 4 * m].reshape((2 * n, d)),
        state[o + 4 * m : o + 4 * m + n - 1],
        state[o + 4 * m + n - 1 : o + 4 * m + 2 * (n - 1)],
        work[0:m].reshape((2 * n, d)),
        work[m : 2 * m].reshape((2 * n, d)),
        work[2 * m : 3 * m].reshape((2 * n, d)),
        cut_scratch(work[3 * m :], n, like),
    )


@kernel
def _presence(present, value):
    if present is None:
        return 0.0
    return value


@kernel
def build(parts, p, pull):
    """The problem that the parameters describe."""
    cable = cable_part(parts.water, p)
    wave_damping = p[26] * math.sqrt(cable.stiffness * cable.mass)
    reference = math.sqrt(max(cable.gravity, 1e-3) * cable.length)
    numeric = Numeric(
        p[25] * total_weight(parts, p),
        _presence(parts.slack, wave_damping),
        _presence(parts.voigt, p[5]),
        _presence(parts.bending, p[4]),
        pull,
        1e-8 * reference,
    )
    return Problem(cable, water_part(parts.water, p), body_part(parts.body, parts.water, p), numeric)


@kernel
def _anchor(anchor, space, p):
    if anchor is None:
        return None
    return axes(space, p[13], p[14], p[15])


@kernel
def _top_at(parts, state, offset):
    k = header.TOP + offset
    return axes(parts.space, state[k], state[k + 1], state[k + 2])


@kernel
def initialize(parts, p, time, state, work):
    """Static equilibrium under the top of the header; the top alone moves already."""
    view = cut(parts, p, state, work)
    problem = build(parts, p, p[16])
    staggered_chain.place_nodes(parts.anchor, problem, p[20], view.mesh)
    top = _top_at(parts, state, 0)
    status = staggered_chain.equilibrium(
        parts, problem, p, view.mesh, view.y, view.yd, view.y1, view.yd1, view.force,
        top, _anchor(parts.anchor, parts.space, p), time, view.scratch,
    )  # fmt: skip
    if status != header.OK:
        return status
    problem = build(parts, p, 0.0)
    status = staggered_chain.starting_rates(
        parts, problem, view.mesh, view.y, view.yd, view.y1, view.yd1, view.force,
        top, _top_at(parts, state, 3), _top_at(parts, state, 6), time, p[21], view.scratch,
    )  # fmt: skip
    if status != header.OK:
        return status
    n = view.mesh.shape[0] + 1
    for i in range(n - 1):
        view.force_old[i] = view.force[i]
    for k in range(len(top)):
        view.y[n - 1, k] = top[k]
    for i in range(view.y.shape[0]):
        for k in range(len(top)):
            view.ydd[i, k] = 0.0
            view.y_old[i, k] = view.y[i, k]
    state[header.TIME] = time
    for k in (header.STEP, header.NEXT_STEP, header.STEPS, header.NEWTON, header.REJECTED):
        state[k] = 0.0
    return header.OK


@kernel
def _path_at(parts, path, h, s):
    """Position and velocity of the top in the chain's dimension at fraction s of the communication step."""
    x, vx, _ = evaluate(path, h, s, 0)
    y, vy, _ = evaluate(path, h, s, 1)
    z, vz, _ = evaluate(path, h, s, 2)
    return axes(parts.space, x, y, z), axes(parts.space, vx, vy, vz)


@kernel
def _drawn_to(anchor, velocity, position, integrated, h):
    """Velocity that also removes the drift between the prescribed top and its integrated position (anchored cables)."""
    if anchor is None:
        return velocity
    return axpy(0.25 / h, sub(position, integrated), velocity)


@kernel
def _try_step(parts, problem, view, state, c, time, span, path, done, h):
    """One internal step from time + done; returns the Newton iterations or a negative status."""
    last = state[header.STEP]
    shift = (c.alpha_m - c.alpha_k) * (h - last) if last > 0.0 else 0.0
    n = view.mesh.shape[0] + 1
    for i in range(2 * n):
        for k in range(view.y.shape[1]):
            view.yd0[i, k] = view.yd[i, k] + shift * view.ydd[i, k]
    before, _ = _path_at(parts, path, span, done / span)
    after, velocity = _path_at(parts, path, span, (done + h) / span)
    velocity = _drawn_to(parts.anchor, velocity, before, load(view.y, n - 1, before), h)
    top = mix(1.0 - c.alpha_k, after, c.alpha_k, before)
    return newton_step(
        parts, problem, view.mesh, view.y, view.yd0, view.y_old, last, c, time + done + (1.0 - c.alpha_k) * h, h,
        top, velocity, view.y1, view.yd1, view.force, view.scratch,
    )  # fmt: skip


@kernel
def _accept(view, h):
    for i in range(view.y.shape[0]):
        for k in range(view.y.shape[1]):
            view.ydd[i, k] = (view.yd1[i, k] - view.yd0[i, k]) / h
            view.y_old[i, k] = view.y[i, k]
            view.y[i, k] = view.y1[i, k]
            view.yd[i, k] = view.yd1[i, k]
    for i in range(view.force.shape[0]):
        view.force_old[i] = view.force[i]
    keep_tensions(view.force, view.scratch)


@kernel
def _local_error(problem, view, c, h, like):
    """Estimate of the acceleration that the truncation error of a step amounts to, m/s2."""
    first = abs(c.gamma + c.alpha_m - c.alpha_k - 0.5)
    second = abs(0.5 * (c.gamma * (1.0 - c.gamma) + c.alpha_k * (1.0 - c.alpha_k) - c.alpha_m * (1.0 - c.alpha_m)) - 1.0 / 24.0)
    error = second * rate_error(problem, view.mesh, view.yd0, view.yd1, view.ydd, h, like)
    if first > 1e-12:
        error += first * rate_error(problem, view.mesh, view.yd0, view.yd1, view.ydd, 0.0, like)
    return error


@kernel
def advance(parts, p, time, span, path, state, work):
    """Integrate over [time, time + span] while the top follows `path`; internal steps are the chain's own.

    solver.tolerance 0: the fewest equal steps not longer than solver.time_step, cut where Newton's method fails.  Above 0: the
    truncation error of a step, as an acceleration, is kept below tolerance * g; solver.time_step is then the longest step.
    """
    view = cut(parts, p, state, work)
    problem = build(parts, p, 0.0)
    like = _top_at(parts, state, 0)
    c = coefficients(int(p[23]), p[22])
    tolerance = p[24]
    base = span / math.ceil(span / p[21] - 1e-9)
    allowed = tolerance * max(problem.cable.gravity, 1e-3)
    h = base
    if tolerance > 0.0:
        h = state[header.NEXT_STEP] if state[header.NEXT_STEP] > 0.0 else 0.01 * p[21]
    elif 0.0 < state[header.NEXT_STEP] < base:
        h = state[header.NEXT_STEP]
    done = 0.0
    while done < span:
        rest = span - done
        used = h
        if used >= rest * (1.0 - 1e-9):
            used = rest
        elif tolerance > 0.0 and used > 0.5 * rest:
            used = 0.5 * rest
        status = _try_step(parts, problem, view, state, c, time, span, path, done, used)
        if status < 0:
            state[header.REJECTED] += 1.0
            state[header.ERROR_TIME] = time + done
            h = 0.25 * used
            if h < SMALLEST_STEP * p[21]:
                return header.STEP_TOO_SMALL
            continue
        proposal = base
        if tolerance > 0.0:
            ratio = 0.25
            if state[header.STEPS] > 0.0:
                error = _local_error(problem, view, c, used, like)
                if error > 2.0 * allowed and used > SMALLEST_STEP * p[21]:
                    state[header.REJECTED] += 1.0
                    h = used * max(0.2, 0.8 * math.sqrt(allowed / error))
                    continue
                ratio = error / allowed
            growth = min(2.0, max(0.2, 0.85 / math.sqrt(max(ratio, 1e-6))))
            proposal = min(p[21], max(used * growth, min(h, used * 2.0) if used < h else 0.0))
        elif used < base:
            proposal = min(base, 2.0 * used) if status <= 8 else used
        _accept(view, used)
        state[header.STEP] = used
        state[header.STEPS] += 1.0
        state[header.NEWTON] += status
        h = proposal
        done = span if used == rest else done + used
    state[header.NEXT_STEP] = h
    state[header.TIME] = time + span
    for k in range(3):
        position, velocity, acceleration = evaluate(path, span, 1.0, k)
        state[header.TOP + k] = position
        state[header.TOP + 3 + k] = velocity
        state[header.TOP + 6 + k] = acceleration
    return header.OK


@kernel
def node_positions(parts, p, state, work, positions):
    """Positions (n, 3) of all nodes, summed from the prescribed top downwards."""
    view = cut(parts, p, state, work)
    n = view.mesh.shape[0] + 1
    at = _top_at(parts, state, 0)
    for i in range(n - 1, -1, -1):
        if i < n - 1:
            at = axpy(-view.mesh[i, 0], load(view.y, i, at), at)
        _spread(parts.space, at, state[header.TOP + 1], positions[i], 0)


@kernel
def outputs(parts, p, state, work, out):
    """Fill `out` in the order of signals.OUTPUTS."""
    view = cut(parts, p, state, work)
    problem = build(parts, p, 0.0)
    c = coefficients(int(p[23]), p[22])
    mesh = view.mesh
    n = mesh.shape[0] + 1
    top = _top_at(parts, state, 0)
    offset = (c.alpha_m - c.alpha_k) * state[header.STEP]
    for i in range(n):
        for k in range(len(top)):
            view.scratch.a[i, k] = view.yd[n + i, k] - offset * view.ydd[n + i, k]
    staggered_chain.tensions_now(parts.slack, view.force, view.force_old, c.alpha_k, view.scratch.cells)
    largest = 0.0
    smallest = 1e300
    slack = 0.0
    position = top
    for i in range(n - 2, -1, -1):
        t = view.scratch.cells[i, 0]
        largest = max(largest, t)
        smallest = min(smallest, t)
        if t < 1e-3 * total_weight(parts, p):
            slack += mesh[i, 0]
        position = axpy(-mesh[i, 0], load(view.y, i, top), position)
    end = staggered_chain.lower_end_tension(
        parts.body, parts, problem, mesh, view.y, view.scratch.a, position, state[header.TIME], view.scratch.cells
    )
    force = staggered_chain.top_force(parts, problem, mesh, view.y, view.scratch.a, top, state[header.TIME], view.scratch)
    q = load(view.y, n - 2, top)
    t = scale(1.0 / norm(q), q)
    pulled = 0.0
    for k in range(len(top)):
        pulled -= force[k] * t[k]
    _spread(parts.space, force, 0.0, out, 0)
    out[3] = pulled
    out[4] = math.acos(min(1.0, max(-1.0, t[len(t) - 1])))
    _spread(parts.space, position, state[header.TOP + 1], out, 5)
    _spread(parts.space, load(view.y, n, top), 0.0, out, 8)
    out[11] = end
    out[12] = max(largest, pulled)
    out[13] = smallest
    out[14] = slack / problem.cable.length
    out[15] = state[header.STEPS]
    out[16] = state[header.NEWTON]
    out[17] = state[header.REJECTED]


@kernel
def _spread(space, a, y, out, k):
    """Write a vector of the chain's dimension as x, y, z from out[k] on."""
    out[k] = a[0]
    out[k + 1] = y
    out[k + 2] = a[len(a) - 1]
    if space is not None:
        out[k + 1] = a[1]
