"""The mass that the top is fastened to: the top's motion is then an unknown, and the force is foretold for a host that holds it.

A host that steps beside the cable holds what it was told over its next step, and on a stiff cable that lag feeds a ringing.  With
host.mass = M > 0 the top is a body of mass M within a communication step, under the cable's force F and an outer force f:

- f is all else that acts on the host.  Its means over the last steps, M dv/h less the force told, are led on by a line.
- F is a parabola through the force at the start, that at the end, and its mean: the last two are found in trials, see host_trials.py.
- The top starts where it is.  By what the host is elsewhere, an outer force that is linear in time draws it there: all of the velocity
  that it misses, and CLOSED of the position, within the time of `horizon`.

Then the step after this one is tried in the same way: its mean force is foretold, with the impulse that the cable has given so far and the
host was not told.  So the sum of force told times step is the cable's impulse, but for that of one step.
"""

from cable_model.kernels.ends import NEAR, horizon
from cable_model.kernels.exchange import MEANS, NEXT, TOLD, tell_exchange
from cable_model.kernels.header import HOST, PAID_OUT, SHORTEST, STREAM, TOP, WINCH_ACCELERATION, WINCH_SPEED
from cable_model.kernels.jit import kernel
from cable_model.kernels.path import ARRIVAL, LOWER_END, carry, go_on, wind

# in the state; three numbers each where they are vectors
KNOWN = HOST  # 0 before the first step; then 1, and 1 more for each mean of the outer force that is known, up to 3
OUTER = HOST + 1  # mean of the outer force over the last interval, N
OUTER_BEFORE = HOST + 4  # over the interval before
LASTED = HOST + 7  # the last interval, s
LASTED_BEFORE = HOST + 8
SINCE = HOST + 9  # time since its end, s
GIVEN = HOST + 10  # impulse told to the host since then, N s
SPEED = HOST + 13  # of the host then, m/s
DUE = HOST + 16  # impulse that the cable has given and the host was not told, N s
FORCE = HOST + 19  # at the start of the last step, N
FORCE_STEP = HOST + 22  # its length, s
SLOPE_STEP = HOST + 23  # step that the slope is of, s; 0: there is none
SLOPE = HOST + 24  # (2, 2, 9), see host_trials.py

# in the room beside the kernels' own work
TIME = 0  # where the trial begins, s
STEP = 1  # s
START = 2  # force at the start, N
GUESS = 5  # force at the end, and the mean
LINE = 11  # outer force at the start, and by what it changes within the step
OWN = 17  # of the trials
KEPT = 29  # the state, then the outputs

CLOSED = 0.1  # of the distance to the host, in a step
ENOUGH = 3.0  # of KNOWN, for a line


@kernel
def room_size(p, state_size, output_count):
    """Numbers of the room that a communication step needs; 0 without a mass."""
    return KEPT + output_count + state_size if p[0].host.mass > 0.0 else 0


@kernel
def keep(state, outputs, room):
    n = state.shape[0]
    for i in range(n):
        room[KEPT + i] = state[i]
    for i in range(outputs.shape[0]):
        room[KEPT + n + i] = outputs[i]


@kernel
def restore(state, outputs, room):
    n = state.shape[0]
    for i in range(n):
        state[i] = room[KEPT + i]
    for i in range(outputs.shape[0]):
        outputs[i] = room[KEPT + n + i]


@kernel
def learn_outer_force(mass, state, inputs):
    """The mean since the host's velocity was last looked at, where that is long enough ago to tell something; at first, what holds it."""
    if state[KNOWN] > 0.0 and state[SINCE] < max(NEAR * state[LASTED], state[SHORTEST]):
        return
    for k in range(3):
        state[OUTER_BEFORE + k] = state[OUTER + k]
        state[OUTER + k] = -state[TOLD + k]
        if state[KNOWN] > 0.0:
            state[OUTER + k] = (mass * (inputs[3 + k] - state[SPEED + k]) - state[GIVEN + k]) / state[SINCE]
        state[GIVEN + k] = 0.0
        state[SPEED + k] = inputs[3 + k]
    state[LASTED_BEFORE], state[LASTED], state[SINCE] = state[LASTED], state[SINCE], 0.0
    state[KNOWN] = min(state[KNOWN] + 1.0, ENOUGH)


@kernel
def lead_outer_force_on(state, room):
    """The line through its last two means, at the middles of their intervals."""
    for k in range(3):
        rate = 0.0
        if state[KNOWN] == ENOUGH:
            rate = 2.0 * (state[OUTER + k] - state[OUTER_BEFORE + k]) / (state[LASTED] + state[LASTED_BEFORE])
        room[LINE + k] = state[OUTER + k] + rate * (0.5 * state[LASTED] + state[SINCE])
        room[LINE + 3 + k] = rate * room[STEP]


@kernel
def close_on_host(mass, state, inputs, room):
    """Add what draws the top to where the host is; its velocity is that which it has when it has been told all of the impulse."""
    whole = horizon(state, room[STEP])
    for k in range(3):
        slip = inputs[3 + k] - state[TOP + 3 + k] + state[DUE + k] / mass
        way = slip + CLOSED * (inputs[k] - state[TOP + k]) / whole
        room[LINE + k] += mass * (6.0 * way - 2.0 * slip) / whole
        room[LINE + 3 + k] += mass * (6.0 * slip - 12.0 * way) / whole * (room[STEP] / whole)


@kernel
def guess_first(state, room):
    """The force goes on as in the step before."""
    share = 0.0
    if state[FORCE_STEP] > 0.0:
        share = min(room[STEP] / state[FORCE_STEP], 1.0)
    for k in range(3):
        change = share * (state[TOLD + k] - state[FORCE + k])
        room[START + k] = state[TOLD + k]
        room[GUESS + k] = state[TOLD + k] + change
        room[GUESS + 3 + k] = state[TOLD + k] + 0.5 * change


@kernel
def lay_path(space, p, state, room, path):
    """Where the mass goes from its place now under the outer force and the guess: position by the fourth power of time.

    What the mass does not move is left as it is: y in the plane, and the columns of the winch and the lower end.
    """
    mass, h = p[0].host.mass, room[STEP]
    for k in range(3):
        if k == 1 and not space:
            continue
        start, end, mean = room[START + k], room[GUESS + k], room[GUESS + 3 + k]
        a0 = (room[LINE + k] + start) / mass
        a1 = (room[LINE + 3 + k] + 6.0 * mean - 4.0 * start - 2.0 * end) / mass
        a2 = 3.0 * (start + end - 2.0 * mean) / mass
        path[0, k] = state[TOP + k]
        path[1, k] = h * state[TOP + 3 + k]
        path[2, k] = h * h * a0 / 2.0
        path[3, k] = h * h * a1 / 6.0
        path[4, k] = h * h * a2 / 12.0
        path[5, k] = 0.0
        path[ARRIVAL, k] = path[0, k] + path[1, k] + path[2, k] + path[3, k] + path[4, k]
        path[ARRIVAL + 1, k] = state[TOP + 3 + k] + h * (a0 + a1 / 2.0 + a2 / 3.0)
        path[ARRIVAL + 2, k] = a0 + a1 + a2


@kernel
def rest_of_path(state, h, path):
    """The path of what the mass does not move, of the step after this one: y stays, all else goes on as its speed changed."""
    for i in range(path.shape[0]):
        path[i, 1] = 0.0
    path[0, 1] = path[ARRIVAL, 1] = state[TOP + 1]
    wind(state[PAID_OUT], state[WINCH_SPEED], state[WINCH_SPEED] + h * state[WINCH_ACCELERATION], h, path)
    carry(state, state[STREAM] + h * state[STREAM + 2], state[STREAM + 1] + h * state[STREAM + 3], h, path)
    go_on(state, LOWER_END, h, path)


@kernel
def settle(state, outputs, room):
    """Count what the cable has given in the step that has ended, and what the host was told: the force that the copy has."""
    told = room[KEPT + NEXT : KEPT + NEXT + 3]
    for k in range(3):
        state[DUE + k] += room[STEP] * (outputs[MEANS + k] - told[k])
        state[GIVEN + k] += room[STEP] * told[k]
        state[NEXT + k] = told[k]
    state[SINCE] += room[STEP]
    tell_exchange(state, outputs)


@kernel
def foretell(state, outputs, mean, h):
    """Tell the mean force (3,) of the next step, of h as this one, with what is due."""
    whole = max(horizon(state, h) - h, h)
    for k in range(3):
        state[NEXT + k] = mean[k] + state[DUE + k] / whole
    tell_exchange(state, outputs)
