"""A communication step of the tow model: step control, and steps that end where the cable goes slack or taut.

With what it takes over from the other files this is the whole component: sizes, initialization, steps, outputs.
"""

import math

from cable_model.kernels.choice import by_presence
from cable_model.kernels.error_control import MOST_STEPS
from cable_model.kernels.exchange import IMPULSE, OWED
from cable_model.kernels.extent import tell_elevation, tell_whole
from cable_model.kernels.fluid import Stream, in_water_now, with_stream
from cable_model.kernels.header import (
    ERROR_SIZE,
    ERROR_TIME,
    KEPT_STREAM,
    KEPT_TOP,
    NEWTON,
    NEXT_STEP,
    NO_WINCH,
    NOT_FINITE,
    OK,
    OUT_OF_PLANE,
    PENDING,
    REJECTED,
    STEP,
    STEP_TOO_SMALL,
    STEPS,
    TIME,
    TOO_MANY_STEPS,
)
from cable_model.kernels.jit import kernel
from cable_model.kernels.path import (
    CARRIED,
    COLUMNS,
    PATH,
    ROWS,
    UPPER_END,
    arrival,
    arrive,
    evaluate,
    glide,
    leaves_plane,
    quintic,
    stream_crosses,
    take_stream,
    winch_turns,
)
from cable_model.kernels.pending import is_short, wait
from cable_model.kernels.tow import (
    ANGLE,
    ANGLE_RATE,
    COUNTED,
    EVALUATIONS,
    JOINED,
    PLANE,
    STRETCH,
    STRETCH_RATE,
    WORK,
    constants,
    outputs_in_plane,
    work_size,
)
from cable_model.kernels.tow_events import attempt, first_crossing, on_floor, step_to_event
from cable_model.kernels.tow_impulse import count_impulse
from cable_model.kernels.tow_schemes import (
    MAX_ITERATIONS,
    Drive,
    derivative,
    jacobian,
    places,
    weights,
)
from cable_model.kernels.tow_space import keep_in_space, motion_in_space, outputs_in_space, recharted_in_space
from cable_model.kernels.tow_static import initialize, points, state_size
from cable_model.kernels.vector import diagonal
from cable_model.kernels.watch_outputs import watch_outputs, watch_straight

__all__ = ("advance", "initialize", "outputs", "points", "state_size", "work_size")


@kernel
def _motion_in_plane(space, state):
    return (state[ANGLE], state[ANGLE_RATE], state[STRETCH], state[STRETCH_RATE]), None


@kernel
def _same_chart(space, y, frame):
    return y, None


@kernel
def _keep_in_plane(space, y, frame, state):
    state[ANGLE], state[ANGLE_RATE], state[STRETCH], state[STRETCH_RATE] = y


motion_of = by_presence(_motion_in_plane, motion_in_space)  # y and its chart
recharted = by_presence(_same_chart, recharted_in_space)
keep_motion = by_presence(_keep_in_plane, keep_in_space)


@kernel
def sine_of(y, frame):
    """Sine of the cable's angle to the vertical at the start of a step."""
    if frame is None:
        return abs(math.sin(y[0]))
    return math.sqrt(frame.e[0] * frame.e[0] + frame.e[1] * frame.e[1])


@kernel
def finite(y):
    total = 0.0
    for k in range(len(y)):
        total += abs(y[k])
    return total < 1e12


@kernel
def failed(status, state, time, size):
    state[ERROR_TIME] = time
    state[ERROR_SIZE] = size
    return status


@kernel
def check_path(space, path, h, c, state):
    total = h
    for i in range(6):
        total += abs(path[i, 0]) + abs(path[i, 1]) + abs(path[i, 2])
    if not total < 1e12:
        return NOT_FINITE
    if winch_turns(path):
        return NO_WINCH
    if space is None:
        if leaves_plane(path, state[PLANE], c.reference_length, UPPER_END) or stream_crosses(path):
            return OUT_OF_PLANE
    return OK


@kernel
def next_size(explicit, size, error, tolerance, iterations):
    """Step that the error asks for: by its order, or by halves and doubles as the report's method does."""
    if explicit:
        if error > tolerance:
            return 0.5 * size
        return 2.0 * size if error < tolerance / 32.0 else size
    safety = 0.9 * (2 * MAX_ITERATIONS + 1) / (2 * MAX_ITERATIONS + iterations)
    return size * min(8.0, max(0.2, safety * (tolerance / max(error, 1e-6 * tolerance)) ** 0.25))


@kernel
def join(path, h, state, end, whole):
    """The path with the pending time before it as one quintic: that time is too short for a quintic to lose anything over it.

    The current that inputs give goes straight from what it was before to what it will be.
    """
    for k in range(3):
        end[k], end[3 + k], end[6 + k] = arrival(path, k)
    quintic(state[KEPT_TOP : KEPT_TOP + 9], end, state[PENDING] + h, whole, UPPER_END.column)
    for k in range(2):
        _, speed, _ = arrival(path, CARRIED + k)
        glide(CARRIED + k, 0.0, state[KEPT_STREAM + k], speed, state[PENDING] + h, whole)


@kernel
def _in_stream(parts, path, h, time):
    """The parts with the current that inputs give over a step."""
    _, x, rate_x = evaluate(path, h, 0.0, CARRIED)
    _, y, rate_y = evaluate(path, h, 0.0, CARRIED + 1)
    return with_stream(parts, Stream(x, y, rate_x, rate_y, time))


@kernel
def advance(parts, p, time, h, path, state, work):
    """Integrate over [time, time + h] while the top follows `path`; returns a status, and leaves the state alone unless it is OK.

    solver.tolerance > 0 bounds the local error of a step relative to `weights`; at 0 the steps are equal, none longer than
    solver.time_step.  Either way a step ends where the cable goes slack or taut.  A sliver waits, see pending.py.
    """
    parts = in_water_now(parts, p, state)
    c = constants(parts, p)
    status = check_path(parts.space, path, h, c, state)
    if status != OK:
        return failed(status, state, time, 0.0)
    if is_short(state, state[PENDING] + h, 0.0):
        wait(state, h, path)
        take_stream(path, state)
        arrive(UPPER_END, path, state)
        state[TIME] = time + h
        return OK
    y, frame = motion_of(parts.space, state)
    if not p[0].solver.tolerance > 0.0 and h > MOST_STEPS * p[0].solver.time_step:
        return failed(TOO_MANY_STEPS, state, time, 0.0)
    explicit = p[0].tow.explicit > 0.5
    tolerance = max(p[0].solver.tolerance, 0.0)
    fixed = not tolerance > 0.0
    pieces = max(1, math.ceil(h / p[0].solver.time_step * (1.0 - 1e-12))) if fixed else 1
    if state[PENDING] > 0.0:
        whole = work[JOINED : JOINED + PATH].reshape(ROWS, COLUMNS)
        join(path, h, state, work[JOINED + PATH : JOINED + PATH + 9], whole)
        path = whole
    waited = state[PENDING]
    for k in range(COUNTED, WORK):
        work[k] = 0.0
    end_time = time + h
    time -= state[PENDING]
    h += state[PENDING]
    parts = _in_stream(parts, path, h, time)
    drive = Drive(path, h, time, frame)
    graze = max(0.1 * tolerance, 1e-9) * c.force
    wanted = h
    if not fixed:
        wanted = state[NEXT_STEP] if state[NEXT_STEP] > 0.0 else (p[0].solver.time_step if p[0].solver.time_step > 0.0 else h)
    elapsed, size, piece, flips = 0.0, 0.0, 1, 0
    steps, newton, rejected, evaluations = 0, 0, 0, 1
    f = derivative(parts, c, drive, 0.0, y, 0.0)
    slack = on_floor(parts.tension_floor, c, y, f, graze)
    f = derivative(parts, c, drive, 0.0, y, slack)
    j = (diagonal(0.0, places(y)), diagonal(0.0, places(y)))
    fresh = True
    while elapsed < h:
        if steps + rejected > MOST_STEPS:
            return failed(TOO_MANY_STEPS, state, time + elapsed, 0.0)
        goal = h if piece >= pieces else h * piece / pieces
        left = goal - elapsed
        size = left if wanted >= left * (1.0 - 1e-9) else (0.5 * left if wanted > 0.5 * left else wanted)
        if fresh and not explicit:
            j = jacobian(parts, c, drive, elapsed, y, f, slack)
            evaluations += len(y)
        fresh = False
        scale = weights(c, sine_of(y, drive.frame), y)
        iterations, end, error, spent = attempt(explicit, parts, c, drive, elapsed, size, y, f, j, slack, scale, tolerance, work)
        evaluations += spent
        newton += max(iterations, 0)
        good = iterations >= 0 and abs(error) < 1e12 and finite(end)
        if not good or (not fixed and error > tolerance):
            rejected += 1
            wanted = next_size(explicit, size, error, tolerance, iterations) if good else 0.25 * size
            if not wanted >= 1e-9 * min(h, 1.0 / c.pendulum):
                return failed(STEP_TOO_SMALL if good or abs(f[1]) + abs(f[3]) < 1e300 else NOT_FINITE, state, time + elapsed, error)
            continue
        share = first_crossing(parts.tension_floor, work, slack, graze)
        if share * size < 1e-12 * h and flips < 3:
            slack = 1.0 - slack
            flips += 1
            f = derivative(parts, c, drive, elapsed, y, slack)
            evaluations += 1
            fresh = True
            continue
        before = size
        if 1e-12 * h <= share * size and share <= 1.0:
            size, iterations, end, error, spent = step_to_event(
                explicit, parts, c, drive, elapsed, size, share, y, f, j, slack, scale, tolerance, graze, work
            )
            evaluations += spent
            newton += max(iterations, 0)
            if iterations < 0:
                rejected += 1
                wanted = 0.25 * before
                continue
        count_impulse(explicit, parts, c, drive, elapsed, size, y, slack, waited, work)
        elapsed = goal if size >= left else elapsed + size
        if size >= left:
            piece += 1
        y, frame = recharted(parts.space, end, drive.frame)
        drive = Drive(path, h, time, frame)
        steps += 1
        flips = 0
        fresh = True
        f = derivative(parts, c, drive, elapsed, y, slack)
        evaluations += 1
        now_slack = on_floor(parts.tension_floor, c, y, f, graze)
        if now_slack != slack:
            slack = now_slack
            f = derivative(parts, c, drive, elapsed, y, slack)
            evaluations += 1
        if not fixed:
            proposal = next_size(explicit, size, error, tolerance, iterations)
            wanted = max(wanted, proposal) if size < wanted else proposal
        else:
            wanted = max(wanted, 2.0 * size)
    keep_motion(parts.space, y, drive.frame, state)
    for k in range(3):
        state[OWED + k] += work[COUNTED + k]
        state[IMPULSE + k] = work[COUNTED + 3 + k]
    state[TIME] = end_time
    state[PENDING] = 0.0
    state[STEP] = size
    state[NEXT_STEP] = wanted if not fixed else size
    state[STEPS] += steps
    state[NEWTON] += newton
    state[REJECTED] += rejected
    state[EVALUATIONS] += evaluations
    take_stream(path, state)
    arrive(UPPER_END, path, state)
    return OK


_outputs = by_presence(outputs_in_plane, outputs_in_space)


@kernel
def outputs(parts, p, state, work, out):
    """Fill `out` in the order of signals.OUTPUTS."""
    parts = in_water_now(parts, p, state)
    _outputs(parts.space, parts, p, state, work, out)
    tell_whole(p[0].cable.length, 0.0, out)
    tell_elevation(parts.waves, parts, state, out)
    watch_outputs(parts, p, state, out)
    watch_straight(parts, p, state, out)
