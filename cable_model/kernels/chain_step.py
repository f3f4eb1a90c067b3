"""One internal step of the chain: the mesh as long as the cable then is, the step tried, its error, and what is kept of it."""

from cable_model.kernels import grid, header
from cable_model.kernels.audit import count_step
from cable_model.kernels.chain_ends import closing_velocities, ends_on, in_water_at
from cable_model.kernels.chain_outputs import in_axes
from cable_model.kernels.choice import by_presence
from cable_model.kernels.exchange import TO_LOWER, add_averaged
from cable_model.kernels.jit import kernel
from cable_model.kernels.layout import vector_at
from cable_model.kernels.parting import lost
from cable_model.kernels.path import WINCH, Ends
from cable_model.kernels.pending import followed
from cable_model.kernels.staggered_step import Winding
from cable_model.kernels.vector import sub
from cable_model.kernels.wave_records import without_records

FADING = 0.9  # of the step that sets the time in which drift is removed, from one internal step to the next shorter one


@kernel
def _no_winding(winch, parts, problem, view, state, course, time):
    return Winding(problem.cable.length, 0.0, 0.0)


@kernel
def _wind_to(winch, parts, problem, view, state, course, time):
    paid_out, speed, acceleration = followed(course.path, course.span, course.bridge, course.pending, time, WINCH)
    length = problem.numbers[0].cable.length - lost(parts.parting, state) + paid_out
    grid.change_length(parts.box, view, length / state[header.MESH_LENGTH])
    state[header.MESH_LENGTH] = length
    return Winding(length, speed / length, acceleration / length)


winding_at = by_presence(_no_winding, _wind_to)  # gives the mesh the length that the cable has at `time` of its course


@kernel
def _shift(state, ahead, h):
    """From the time of the rates kept to that of the rates before a step of h, whose member has them `ahead` h after its ends."""
    last = state[header.STEP]
    if last == 0.0:
        return 0.0
    if state[header.OFFSET] == ahead * last:
        return ahead * (h - last)
    return ahead * h - state[header.OFFSET]


@kernel
def try_step(parts, p, problem, view, state, c, time, course, done, h, tiny, least):
    """One internal step from time + done; returns the Newton iterations or a negative status.  `least`: see _drawn_to, not below it."""
    averaged = done + (1.0 - c.alpha_k) * h
    winding = winding_at(parts.winch, parts, problem, view, state, course, averaged)
    parts = in_water_at(parts, course, time, averaged)
    last = state[header.STEP]
    shift = _shift(state, c.alpha_m - c.alpha_k, h)
    reach = h / last if last >= tiny else 0.0
    size = view.y.size  # one run over all of an array, which the compiler does several numbers at a time
    yd0, yd, ydd = view.yd0.reshape(size), view.yd.reshape(size), view.ydd.reshape(size)
    for i in range(size):
        yd0[i] = yd[i] + shift * ydd[i]
    before, _ = ends_on(parts, course, done)
    after, velocities = ends_on(parts, course, done + h)
    velocities = closing_velocities(parts, p, view, velocities, before, max(h, FADING * state[header.DRIFT_STEP], least))
    return grid.newton_step(parts.box, parts, problem, view, c, time + done, h, reach, before.top, after.top, velocities, winding)


@kernel
def _count(parts, problem, view, state, c, time, course, done, h):
    averaged = done + (1.0 - c.alpha_k) * h
    winding = winding_at(parts.winch, parts, problem, view, state, course, averaged)
    parts = in_water_at(parts, course, time, averaged)
    before, slower = ends_on(parts, course, done)
    after, faster = ends_on(parts, course, done + h)
    force = grid.mean_forces(parts.box, parts, problem, view, c, time + done, h, before, after, winding)
    late, gap = (0.5 - c.alpha_k) * h, h - c.alpha_k * h + state[header.LAG]
    middle = add_averaged(0, state, in_axes(parts.space, force.top, 0.0), late, gap, h, done, course.span)
    if parts.driven is not None:
        add_averaged(TO_LOWER, state, in_axes(parts.space, force.lower, 0.0), late, gap, h, done, course.span)
    gained = Ends(sub(faster.top, slower.top), sub(faster.lower, slower.lower))
    count_step(parts.audit, without_records(parts, state), problem, view, state, c, time + done, h, before, after, gained, middle)


@kernel
def accept(parts, problem, view, state, c, time, course, done, h, tiny):
    grid.keep(parts.box, parts, problem, view, vector_at(parts, state, header.TOP), h)
    size = view.y.size
    y, yd, ydd = view.y.reshape(size), view.yd.reshape(size), view.ydd.reshape(size)
    y1, yd0, yd1 = view.y1.reshape(size), view.yd0.reshape(size), view.yd1.reshape(size)
    if not tiny:
        for i in range(size):
            ydd[i] = (yd1[i] - yd0[i]) / h
    _count(parts, problem, view, state, c, time, course, done, h)
    for i in range(size):
        y[i] = y1[i]
        yd[i] = yd1[i]


@kernel
def local_error(parts, problem, view, state, c, time, course, done, h):
    """Accelerations, m/s2: what the truncation error of the step just tried from time + done amounts to; the motion's own, rms."""
    first = abs(c.gamma + c.alpha_m - c.alpha_k - 0.5)
    second = abs(0.5 * (c.gamma * (1.0 - c.gamma) + c.alpha_k * (1.0 - c.alpha_k) - c.alpha_m * (1.0 - c.alpha_m)) - 1.0 / 24.0)
    share, reach = (first, 0.0) if first > 1e-12 else (second, h)
    averaged = done + (1.0 - c.alpha_k) * h
    winding = winding_at(parts.winch, parts, problem, view, state, course, averaged)
    parts = in_water_at(parts, course, time, averaged)
    before, _ = ends_on(parts, course, done)
    after, _ = ends_on(parts, course, done + h)
    miss, moving = grid.rate_error(parts.box, parts, problem, view, c, time + done, h, reach, before.top, after.top, winding)
    return share * miss, moving


@kernel
def note_worst(x, state):
    """Where the last Newton change was largest, and how large; a change that is not a number is the worst."""
    state[header.ERROR_SIZE] = 0.0
    for i in range(x.shape[0]):
        for k in range(x.shape[1]):
            if not abs(x[i, k]) <= state[header.ERROR_SIZE]:
                state[header.ERROR_SIZE] = abs(x[i, k])
                state[header.ERROR_NODE] = i
                if x[i, k] != x[i, k]:
                    return
