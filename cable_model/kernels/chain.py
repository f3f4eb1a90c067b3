"""The finite-difference chain as a component: initialization, time steps under one stepper for both grids, outputs."""

import math

from cable_model.kernels import grid, header
from cable_model.kernels.audit import open_audit
from cable_model.kernels.build import build
from cable_model.kernels.chain_ends import Course, an_end_leaves_plane, end_rates, held_place, move_ends
from cable_model.kernels.chain_outputs import outputs, points, winding_now
from cable_model.kernels.chain_step import FADING, accept, local_error, note_worst, try_step, winding_at
from cable_model.kernels.clock import start_clock
from cable_model.kernels.error_control import (
    GROWTH,
    MOST_STEPS,
    SOLVED,
    Trials,
    allowed_error,
    growth,
    judge,
    see_motion,
)
from cable_model.kernels.exchange import begin_exchange, pass_over
from cable_model.kernels.family import coefficients, coefficients_of_change
from cable_model.kernels.fluid import flows, in_water_now
from cable_model.kernels.fronts import TINY_STEP, aim_behind_front, follow_front, natural_step, set_off_again
from cable_model.kernels.jit import kernel
from cable_model.kernels.layout import cut, state_size, vector_at, with_waves_followed, work_size
from cable_model.kernels.parting import Event, breaks, due, has_gone, left, load_at_start, lose, lost, open_parting, resumes
from cable_model.kernels.path import WINCH, arrival, winch_turns
from cable_model.kernels.pending import build_bridge, equal_step, is_short, wait
from cable_model.kernels.problem import is_neutral, with_tolerance
from cable_model.kernels.watch_outputs import open_bottom

# what a model calls
__all__ = ("advance", "initialize", "outputs", "points", "release", "set_off", "settle", "state_size", "work_size")

LEAST_LENGTH = 0.01  # of the cable at the start, that the winch must leave
SMALLEST_STEP = 1e-6  # of the base step, before a step is given up
EASY = 8  # Newton iterations of a step after which the next may be longer
CHANGED = 0.05  # of the internal step: a step that differs by more is taken by family.coefficients_of_change


@kernel
def initialize(parts, p, time, state, work):
    """Static equilibrium between the ends of the header; they alone move already."""
    status = settle(parts, p, time, state, work)
    if status != header.OK:
        return status
    if p[0].lower_end.release_force != 0.0:
        return release(parts, p, time, state, work)
    return set_off(parts, p, time, state, work)


@kernel
def settle(parts, p, time, state, work):
    """Static equilibrium under the top of the header, in the water's velocity of this moment: drag does not jump when the run begins."""
    state[header.TIME] = state[header.START] = time
    if parts.space is None and state[header.STREAM + 1] != 0.0:
        state[header.ERROR_TIME] = time
        return header.OUT_OF_PLANE
    open_parting(p, state)
    parts = in_water_now(parts, p, state)
    view = cut(parts, p, state, work)
    problem = build(parts, p, p[0].lower_end.release_force, 0.0)
    grid.place_nodes(parts.box, parts.anchor, parts, problem, p[0].solver.grading, view.mesh)
    top = vector_at(parts, state, header.TOP)
    held = held_place(parts.driven, parts, p, state)
    status = grid.equilibrium(parts.box, parts, problem, p, view, top, held, time)
    if status == header.OK:
        return status
    note_worst(view.scratch.x, state)
    state[header.ERROR_TIME] = time
    depth = open_bottom(parts.finite_depth, parts.seabed, parts.waves)
    if depth > 0.0 and state[header.TOP + 2] - problem.cable.length < -depth:
        return header.BELOW_WAVES
    neutral, _, _ = is_neutral(parts, p)
    if parts.anchor is None and neutral and not flows(parts):
        return header.WEIGHTLESS
    return status if parts.slack is not None else header.NO_SLACK


@kernel
def set_off(parts, p, time, state, work):
    """Rates of change of a cable in place and at rest, whose ends alone move already; no steps yet."""
    parts = in_water_now(parts, p, state)
    view = cut(parts, p, state, work)
    problem = build(parts, p, 0.0)
    top = vector_at(parts, state, header.TOP)
    state[header.MESH_LENGTH] = problem.cable.length
    winding = winding_now(parts.winch, parts, problem, state)
    velocities, accelerations = end_rates(parts, state, 3), end_rates(parts, state, 6)
    status = grid.starting_rates(parts.box, parts, problem, p, view, top, velocities, accelerations, winding, time)
    if status != header.OK:
        return status
    for i in range(view.y.shape[0]):
        for k in range(view.y.shape[1]):
            view.ydd[i, k] = 0.0
    start_clock(state, time)
    load_at_start(parts.parting, parts, problem, view, state, top)
    if state[header.LOAD] >= 1.0:
        state[header.ERROR_TIME], state[header.ERROR_SIZE] = time, state[header.LOAD]
        return header.TOO_WEAK
    open_audit(parts.audit, parts, problem, view, state, top)
    state[header.SHORTEST] = TINY_STEP * natural_step(p, problem.cable)
    return header.OK


@kernel
def release(parts, p, time, state, work):
    """The same for a cable whose lower end was held until now: what pulled there falls off in an instant."""
    status = set_off(parts, p, time, state, work)
    if status == header.OK:
        view = cut(parts, p, state, work)
        problem = build(parts, p, 0.0)
        follow_front(parts.slack, parts, p, problem, view, state)
    return status


@kernel
def _refused(parts, p, path, state, length):
    """A status: whether the path asks for what is not there, or leaves the plane of a cable of this length."""
    status = _winch_refused(parts.winch, parts, p, path, state)
    if status == header.OK and an_end_leaves_plane(parts, path, state, length):
        status = header.OUT_OF_PLANE
    return status


@kernel
def _winch_refused(winch, parts, p, path, state):
    """Whether the path asks for a winch that is not there, or for more cable than there is."""
    if winch is None:
        return header.NO_WINCH if winch_turns(path) else header.OK
    if has_gone(parts.parting, state):
        return header.OK
    paid_out, _, _ = arrival(path, WINCH)
    length = p[0].cable.length
    return header.OK if length - lost(parts.parting, state) + paid_out > LEAST_LENGTH * length else header.HAULED_IN


@kernel
def advance(parts, p, time, span, path, state, work):
    """Integrate over [time, time + span] while the ends follow `path`; internal steps are the chain's own.

    solver.tolerance 0: the fewest equal steps not longer than solver.time_step, cut where Newton's method fails.  Above 0: the
    truncation error of a step, as an acceleration, is kept below TOLERATED tolerance times that of the largest motion so far (at
    least LEAST_MOTION g, at most g); solver.time_step is then the longest step.

    Where the cable parts within the step the status is PARTING, see parting.py: the rest is another call's, with what is left.
    """
    parts = with_waves_followed(parts.followed, in_water_now(parts, p, state), p, state, work)
    refused = _refused(parts, p, path, state, p[0].cable.length)
    if refused != header.OK:
        state[header.ERROR_TIME] = time
        return refused
    goes_on = resumes(parts.parting, state)
    if has_gone(parts.parting, state):
        if not goes_on:
            begin_exchange(state)
        state[header.PENDING] = 0.0
        _go_on_alone(parts, state, time, span, path)
        return header.OK
    view = cut(parts, p, state, work)
    problem = left(parts.parting, build(parts, p, 0.0), state)
    steady = coefficients(int(p[0].solver.integrator), p[0].solver.lambda_infinity)
    changing = coefficients_of_change(int(p[0].solver.integrator), p[0].solver.lambda_infinity)
    pending = state[header.PENDING]
    total = pending + span
    event = due(parts.parting, parts, p, view, state, time, span)
    if not goes_on and event.time > span and is_short(state, total, state[header.STEP]):
        wait(state, span, path)
        _go_on(parts, problem, view, state, time, span, path)
        return header.OK
    if span > MOST_STEPS * p[0].solver.time_step:
        state[header.ERROR_TIME] = time
        return header.TOO_MANY_STEPS
    build_bridge(state, view.bridge)
    course = Course(path, span, view.bridge, pending)
    done = -pending
    if goes_on:
        done = state[header.RESUMES_AFTER]
        status = set_off_again(parts.parting, parts, p, problem, view, state, course, time, done)
        if status != header.OK:
            return status
    else:
        begin_exchange(state)
    tolerance = p[0].solver.tolerance
    gravity = problem.cable.gravity
    longest = natural_step(p, problem.cable)
    smallest = SMALLEST_STEP * p[0].solver.time_step
    base = equal_step(p[0].solver.time_step, state[header.STEP], pending, span)
    allowed = allowed_error(state, tolerance, gravity)
    h = base
    if tolerance > 0.0:
        h = state[header.NEXT_STEP] if state[header.NEXT_STEP] > 0.0 else 0.01 * p[0].solver.time_step
    elif state[header.FRONT] > 0.0 or 0.0 < state[header.NEXT_STEP] < base:
        h = state[header.NEXT_STEP]
    if tolerance == 0.0 and state[header.FRONT] <= 0.0 and 0.0 < GROWTH * state[header.STEP] < h:
        h = GROWTH * state[header.STEP]
    trials = Trials(0.0, 0.0)
    steps = 0
    until = min(span, event.time)
    breaking = False
    while done < until:
        steps += 1
        if steps > MOST_STEPS:
            state[header.ERROR_TIME] = time + done
            return header.TOO_MANY_STEPS
        rest = until - done
        if event.time <= span and rest < state[header.SHORTEST]:  # a sliver before it parts: rates over it would be rounding
            pass_over(parts.driven is not None, state, rest, done, span)
            done = until
            continue
        tiny = TINY_STEP * (h if tolerance > 0.0 else longest)
        used = h if tolerance > 0.0 else min(h, base)
        if used >= rest * (1.0 - 1e-9):
            used = rest
        elif tolerance > 0.0:  # equal steps: every change of the step excites what it does not resolve
            used = rest / math.ceil(rest / used - 1e-9)
        elif rest - used < 0.5 * used:  # leave no sliver: the accelerations over one would be those of rounding
            used = 0.5 * rest
        if used < tiny:
            view.contraction[0] = 0.0  # what Newton's method leaves, over such a step, is a large acceleration
        last = state[header.STEP]
        c = steady if last == 0.0 or abs(used - last) <= CHANGED * last else changing
        to_solve = problem
        if tolerance > 0.0:  # what Newton's method leaves must not look like a truncation error
            to_solve = with_tolerance(problem, min(problem.numeric.tolerance, SOLVED * allowed * used), problem.numeric.rounding)
        status = try_step(parts, p, to_solve, view, state, c, time, course, done, used, tiny, longest if tolerance > 0.0 else 0.0)
        if status < 0:
            state[header.REJECTED] += 1.0
            state[header.ERROR_TIME] = time + done
            note_worst(view.scratch.x, state)
            h = 0.25 * used
            if h < smallest:
                return header.STEP_TOO_SMALL
            continue
        proposal = base
        if tolerance > 0.0:
            factor = growth(0.25)
            if state[header.STEP] > 0.0:  # not at the start, nor where the cable has parted: one difference of rates is no error
                error, moving = local_error(parts, problem, view, state, c, time, course, done, used)
                see_motion(state, moving, gravity)
                allowed = allowed_error(state, tolerance, gravity)
                factor, again, trials = judge(state, error, allowed, used, smallest, trials)
                if again:
                    state[header.REJECTED] += 1.0
                    h = max(used * factor, smallest)
                    continue
            kept = h if used < tiny else min(h, 2.0 * used) if used < h else 0.0
            proposal = min(p[0].solver.time_step, max(used * factor, kept, smallest))
        elif status > EASY and used < base:
            proposal = used
        elif state[header.FRONT] > 0.0:
            proposal = aim_behind_front(p, state, h, used)
        elif used < base:
            proposal = min(base, GROWTH * used)
        if not breaking:
            broken = breaks(parts.parting, parts, problem, view, state, c, done, used, vector_at(parts, state, header.TOP))
            if broken.time <= until:
                until = span if span - broken.time < state[header.SHORTEST] else broken.time
                event, breaking = Event(until, broken.node), True
                state[header.REJECTED] += 1.0
                h = used
                continue
        accept(parts, problem, view, state, c, time, course, done, used, used < tiny)
        state[header.STEP] = used
        state[header.LAG_BEFORE] = state[header.LAG]
        state[header.LAG] = c.alpha_k * used
        state[header.OFFSET] = (c.alpha_m - c.alpha_k) * used
        state[header.DRIFT_STEP] = max(used, FADING * state[header.DRIFT_STEP])
        state[header.STEPS] += 1.0
        state[header.NEWTON] += status
        h = proposal
        done = until if used == rest else done + used
    if event.time <= span:
        winding_at(parts.winch, parts, problem, view, state, course, done)
        lose(parts.parting, view, state, time, event, breaking)
        return header.PARTING
    state[header.NEXT_STEP] = h if tolerance > 0.0 or h < base or state[header.FRONT] > 0.0 else 0.0
    state[header.PENDING] = 0.0
    _go_on(parts, problem, view, state, time, span, path)
    return header.OK


@kernel
def _go_on_alone(parts, state, time, span, path):
    """Clock, ends and winch at the end of the path."""
    paid_out, speed, acceleration = arrival(path, WINCH)
    state[header.PAID_OUT] = paid_out
    state[header.WINCH_SPEED] = speed
    state[header.WINCH_ACCELERATION] = acceleration
    state[header.TIME] = time + span
    move_ends(parts, path, state)


@kernel
def _go_on(parts, problem, view, state, time, span, path):
    """The same for what there is of the cable, which a winch makes longer."""
    winding_at(parts.winch, parts, problem, view, state, Course(path, span, view.bridge, 0.0), span)
    _go_on_alone(parts, state, time, span, path)
