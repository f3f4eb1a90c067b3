"""How the inputs of communication steps move the ends of the cable, its winch and the water: paths through them, and beyond them."""

import math

from cable_model.kernels.header import (
    AT_END,
    AT_START,
    CLOSING,
    CUT,
    ERROR_TIME,
    INPUT_STEPS,
    INPUTS,
    KEPT_STREAM,
    NO_STREAM,
    NOT_DRIVEN,
    NOT_LET_GO,
    OK,
    PAID_OUT,
    PARTED,
    SHORTEST,
    STEP,
    STREAM,
    WHOLE,
    WINCH_ACCELERATION,
    WINCH_SPEED,
)
from cable_model.kernels.jit import kernel
from cable_model.kernels.path import (
    CARRIED,
    COLUMNS,
    GIVEN_CUT,
    GIVEN_STREAM,
    LOWER_END,
    UPPER_END,
    WINCH,
    carry,
    glide,
    quintic,
    shorten,
    wind,
)

KEPT = 4  # inputs, see header.INPUTS
NEAR = 0.1  # of the time that is extrapolated over: inputs that are nearer to one another tell little about it, and rounding much


@kernel
def horizon(state, h):
    """Time over which the top closes on where its inputs lead: a communication step of h, or what is left of an earlier, longer plan.

    Closed within a sliver, the least mismatch would be a shock.
    """
    planned = max(state[CLOSING], state[SHORTEST])
    return planned if planned > h * (1.0 + 1e-9) else h


@kernel
def _told_over(state, at_end, h):
    """Time that inputs must tell something about: that of a plan; where they are given at the end, of an internal step too."""
    planned = horizon(state, h)
    return max(planned, state[STEP]) if at_end else planned


@kernel
def _first_kept(state, h):
    """The newest of the inputs kept that tells something about a time of h: 0, or 1 where the very newest is too near to those now."""
    return 1 if 0.0 < state[INPUT_STEPS] < NEAR * h else 0


@kernel
def _ages(state, newest):
    """Times between the inputs now and up to three before it, from one to the next; 0 where there is none."""
    if newest == 0:
        return state[INPUT_STEPS], state[INPUT_STEPS + 1], state[INPUT_STEPS + 2]
    if state[INPUT_STEPS + 1] == 0.0:
        return 0.0, 0.0, 0.0
    return state[INPUT_STEPS] + state[INPUT_STEPS + 1], state[INPUT_STEPS + 2], state[INPUT_STEPS + 3]


@kernel
def _differences(state, inputs, which, first, newest, k):
    """Divided differences of order 0 to 3 of axis k over these inputs and up to three before them; 0 where there are too few."""
    h1, h2, h3 = _ages(state, newest)
    row = INPUTS + COLUMNS * newest + which.column + k
    f0 = inputs[which.given + first + k]
    f1 = state[row]
    f2 = state[row + COLUMNS]
    f3 = state[row + 2 * COLUMNS]
    d1 = 0.0
    d2 = 0.0
    d3 = 0.0
    if h1 > 0.0:
        d1 = (f0 - f1) / h1
    if h2 > 0.0:
        before = (f1 - f2) / h2
        d2 = (d1 - before) / (h1 + h2)
        if h3 > 0.0:
            d3 = (d2 - (before - (f2 - f3) / h3) / (h2 + h3)) / (h1 + h2 + h3)
    return f0, d1, d2, d3


@kernel
def _smoothness(state, inputs, which, first, newest, low, factor, h):
    """1 where the differences of a signal fall with their order, down to 0 at noise and jumps, which must not be extrapolated."""
    rough = 0.0
    plain = 0.0
    for k in range(3):
        differences = _differences(state, inputs, which, first, newest, k)
        plain += differences[low] ** 2
        rough += differences[low + 1] ** 2
    if rough == 0.0:
        return 1.0
    ratio = factor * h * math.sqrt(rough)
    plain = math.sqrt(plain)
    return 1.0 - (ratio / plain) ** 8 if ratio < plain else 0.0


@kernel
def predict(order, state, inputs, which, newest, h, end):
    """Where an end will be a time h after the inputs (22,), into `end` (9,); 0: where it is, what is not given from what is.

    order: 0 only positions are given, 1 positions and velocities, 2 accelerations too.  The highest that is given is extrapolated by
    the polynomial through its last values (Newton's divided differences; cubic for positions, parabola for velocities, line for
    accelerations), by one degree less where they are not smooth.  Then position, velocity and acceleration are right to h^4, h^3 and h^2.
    """
    first = 3 * order
    a, b, _ = _ages(state, newest)
    b += a
    smooth = 1.0
    if h > 0.0:
        smooth = _smoothness(state, inputs, which, first, newest, 2 - order, 3.0 - order, h)
    for k in range(3):
        f, d1, d2, d3 = _differences(state, inputs, which, first, newest, k)
        p = inputs[which.given + k]
        if order == 0:
            d3 *= smooth
            end[k] = f + h * (d1 + (h + a) * (d2 + (h + b) * d3))
            end[3 + k] = d1 + (2.0 * h + a) * d2 + (3.0 * h * h + 2.0 * (a + b) * h + a * b) * d3
            end[6 + k] = 2.0 * d2 + (6.0 * h + 2.0 * (a + b)) * d3
        elif order == 1:
            d2 *= smooth
            end[k] = p + h * (f + 0.5 * h * (d1 + a * d2) + h * h / 3.0 * d2)
            end[3 + k] = f + h * (d1 + (h + a) * d2)
            end[6 + k] = d1 + (2.0 * h + a) * d2
        else:
            d1 *= smooth
            v = inputs[which.given + 3 + k]
            end[k] = p + h * (v + 0.5 * h * (f + h / 3.0 * d1))
            end[3 + k] = v + h * (f + 0.5 * h * d1)
            end[6 + k] = f + h * d1


@kernel
def _any_of(inputs, first, count):
    largest = 0.0
    for k in range(first, first + count):
        largest = max(largest, abs(inputs[k]))
    return largest > 0.0


@kernel
def refuse_inputs(p, time, state, inputs):
    """A status: NOT_DRIVEN, NO_STREAM or NOT_LET_GO where inputs (22,) do what is not asked for; columns of paths that are not stay 0."""
    status = OK
    if p[0].lower_end.driven == 0.0 and _any_of(inputs, LOWER_END.given, 9):
        status = NOT_DRIVEN
    elif p[0].water.current_input == 0.0 and _any_of(inputs, GIVEN_STREAM, 2):
        status = NO_STREAM
    elif p[0].parting.by_input == 0.0 and inputs[GIVEN_CUT] != 0.0:
        status = NOT_LET_GO
    if status != OK:
        state[ERROR_TIME] = time
    return status


@kernel
def _hear(state, inputs, at_end):
    """What the input lower_end.let_go of a communication step says, which is given at its start or at its end."""
    if inputs[GIVEN_CUT] != 0.0 and state[CUT] == 0.0:
        state[CUT] = AT_END if at_end else AT_START


@kernel
def _is_driven(p, state, path):
    """Whether inputs move the lower end; of one that has gone with its cable nothing is followed."""
    if p[0].lower_end.driven == 0.0:
        return False
    if state[PARTED] == WHOLE:
        return True
    for i in range(path.shape[0]):
        for k in range(3):
            path[i, LOWER_END.column + k] = 0.0
    return False


@kernel
def follow_inputs(order, p, state, inputs, h, end, path):
    """The path over a step of h that inputs (22,) ask for, given at its start or, by top.inputs_at, at its end; `end` (9,) is scratch."""
    driven = _is_driven(p, state, path)
    streams = p[0].water.current_input > 0.0
    _hear(state, inputs, p[0].top.inputs_at > 0.0)
    if p[0].top.inputs_at > 0.0:
        _arrive(driven, streams, order, state, inputs, h, end, path)
    else:
        _lead_on(driven, streams, order, state, inputs, h, end, path)


@kernel
def follow_ends(p, state, start, end, h, path):
    """The path over a step of h from inputs (22,) at its start to those at its end."""
    _hear(state, start, False)
    quintic(start[0:9], end[0:9], h, path, UPPER_END.column)
    wind(state[PAID_OUT], start[9], end[9], h, path)
    given = LOWER_END.given
    if _is_driven(p, state, path):
        quintic(start[given : given + 9], end[given : given + 9], h, path, LOWER_END.column)
    if p[0].water.current_input > 0.0:
        for k in range(2):
            glide(CARRIED + k, 0.0, start[GIVEN_STREAM + k], end[GIVEN_STREAM + k], h, path)


@kernel
def _go_to(which, order, state, inputs, newest, ahead, h, end, path):
    """The path of an end over a step of h to where it will be `ahead` after the inputs."""
    predict(order, state, inputs, which, newest, ahead, end)
    quintic(state[which.motion : which.motion + 9], end, h, path, which.column)


@kernel
def _arrive(driven, streams, order, state, inputs, h, end, path):
    """The path that ends exactly where the inputs are; those kept get older by the step."""
    state[INPUT_STEPS] += h
    newest = _first_kept(state, _told_over(state, True, h))
    _go_to(UPPER_END, order, state, inputs, newest, 0.0, h, end, path)
    if driven:
        _go_to(LOWER_END, order, state, inputs, newest, 0.0, h, end, path)
    wind(state[PAID_OUT], state[WINCH_SPEED], inputs[9], h, path)
    if streams:
        carry(state, inputs[GIVEN_STREAM], inputs[GIVEN_STREAM + 1], h, path)


@kernel
def _ahead(state, given, column, newest, whole):
    """Where the line through an input and the one kept before it leads in a time of `whole`."""
    age, _, _ = _ages(state, newest)
    ahead = 0.0
    if age > 0.0:
        ahead = (given - state[INPUTS + COLUMNS * newest + column]) * whole / age
    return given + ahead


@kernel
def _lead_on(driven, streams, order, state, inputs, h, end, path):
    """The path to where the ends will be after `horizon`, of which a shorter step goes a part.

    The winch's speed and the stream go on to where the line through their last two inputs leads.
    """
    whole = horizon(state, h)
    newest = _first_kept(state, whole)
    _go_to(UPPER_END, order, state, inputs, newest, whole, whole, end, path)
    if driven:
        _go_to(LOWER_END, order, state, inputs, newest, whole, whole, end, path)
    wind(state[PAID_OUT], state[WINCH_SPEED], _ahead(state, inputs[9], WINCH, newest, whole), whole, path)
    if streams:
        x = _ahead(state, inputs[GIVEN_STREAM], CARRIED, newest, whole)
        carry(state, x, _ahead(state, inputs[GIVEN_STREAM + 1], CARRIED + 1, newest, whole), whole, path)
    if whole > h:
        shorten(path, h / whole, h)


@kernel
def remember(order, p, state, inputs, h):
    """Keep what `predict` needs of these inputs for the steps after this one of h, and how much of its plan is left."""
    at_end = p[0].top.inputs_at > 0.0
    since = 0.0 if at_end else h  # from these inputs to the next step's, or to the next step
    near = _first_kept(state, _told_over(state, at_end, h)) == 1
    state[CLOSING] = max(horizon(state, h) - h, h)
    if near:  # to those kept, which stay
        state[INPUT_STEPS] += since
        return
    for i in range(3, 0, -1):
        state[INPUT_STEPS + i] = state[INPUT_STEPS + i - 1]
        for k in range(COLUMNS):
            state[INPUTS + COLUMNS * i + k] = state[INPUTS + COLUMNS * (i - 1) + k]
    state[INPUT_STEPS] = since
    _keep_newest(order, state, inputs)


@kernel
def _keep_newest(order, state, inputs):
    for k in range(3):
        state[INPUTS + k] = inputs[3 * order + k]
        state[INPUTS + LOWER_END.column + k] = inputs[LOWER_END.given + 3 * order + k]
    state[INPUTS + WINCH] = inputs[9]
    for k in range(2):
        state[INPUTS + CARRIED + k] = inputs[GIVEN_STREAM + k]


@kernel
def _start_end(which, order, state, inputs):
    """What motion_order does not connect is 0."""
    for k in range(9):
        state[which.motion + k] = inputs[which.given + k] if k < 3 * (order + 1) else 0.0


@kernel
def start_ends(order, p, state, inputs):
    """The motion of both ends at initialization, from the start values of the inputs."""
    _start_end(UPPER_END, order, state, inputs)
    _start_end(LOWER_END, order, state, inputs)
    state[PAID_OUT] = 0.0
    state[WINCH_SPEED] = inputs[9]
    state[WINCH_ACCELERATION] = 0.0
    for k in range(2):
        state[STREAM + k] = inputs[GIVEN_STREAM + k]
        state[STREAM + 2 + k] = 0.0
        state[KEPT_STREAM + k] = 0.0
    for k in range(INPUTS, INPUT_STEPS + KEPT):
        state[k] = 0.0
    state[CUT] = 0.0
    state[PARTED] = WHOLE  # of the tow model too, whose lower end is never driven
    _hear(state, inputs, False)
    if p[0].top.inputs_at > 0.0:
        _keep_newest(order, state, inputs)
    state[CLOSING] = 0.0
    state[SHORTEST] = 0.0
