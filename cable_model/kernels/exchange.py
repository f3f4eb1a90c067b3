"""What the cable gives to what holds its ends over a communication step: the impulse of its force, told as its mean.

The impulse is that of the model's own steps, so that it is the change of momentum of cable and body less the impulse of all other forces.
Over time that waits (pending.py) nothing is integrated: the force that the outputs lead on is told, and what the internal step that ends
the waiting finds to be wrong with it is told afterwards, over no less than an internal step.  The sum of mean times step over all
communication steps is then the impulse so far, but for what is still owed.

The numbers of a driven lower end lie TO_LOWER after those of the top; `end` in what follows is 0 or TO_LOWER.
"""

from cable_model.kernels.header import AUDIT, DOUBTS, EXCHANGE, LOWER_EXCHANGE, LOWER_WATCH, PENDING, STEP
from cable_model.kernels.jit import kernel

IMPULSE = EXCHANGE  # of the force over the communication step, from its own internal steps, N s; three numbers, as all that follow
OWED = EXCHANGE + 3  # impulse over time that waited, less what was told then
AHEAD = EXCHANGE + 6  # impulse told over time that still waits
MEAN = EXCHANGE + 9  # force told for the last communication step, N
LAST = EXCHANGE + 12  # force at the averaged time of the last internal step, N
TOLD = EXCHANGE + 15  # force at the end of the last communication step, N
NEXT = EXCHANGE + 18  # force for a host to hold over the next communication step, N: that told, or with host.mass what host.py foretells
GROWTH = EXCHANGE + 21  # rate at which the exchange feeds a ringing, 1/s; see ringing.py
TO_LOWER = LOWER_EXCHANGE - EXCHANGE
MEANS = 18  # of the outputs, the first of three
LOWER_FORCES, LOWER_MEANS = 27, 30  # likewise
SHORTEST = 1e-300  # s: a step that is none divides nothing


@kernel
def begin_exchange(state):
    for k in range(3):
        state[IMPULSE + k] = 0.0
        state[TO_LOWER + IMPULSE + k] = 0.0


@kernel
def add_impulse(end, state, force, h, done, span):
    """Count the force (Fx, Fy, Fz) over an internal step of h that began `done` after the start of the communication step of `span`."""
    waited = min(max(-done / h, 0.0), 1.0)
    for k in range(3):
        state[end + OWED + k] += waited * h * force[k]
        state[end + IMPULSE + k] += (1.0 - waited) * h * force[k]


@kernel
def pass_over(driven, state, h, done, span):
    """The same for a sliver that is not integrated: under the forces that were told last."""
    add_impulse(0, state, state[TOLD : TOLD + 3], h, done, span)
    if driven:
        add_impulse(TO_LOWER, state, state[TO_LOWER + TOLD : TO_LOWER + TOLD + 3], h, done, span)


@kernel
def add_averaged(end, state, force, late, gap, h, done, span):
    """The same for a force that holds `late` after the step's middle, and `gap` after that of the step before; that in the middle."""
    share = late / gap if state[STEP] > 0.0 else 0.0  # 0 at the start, and where the cable has parted
    last = end + LAST
    middle = (
        force[0] - share * (force[0] - state[last]),
        force[1] - share * (force[1] - state[last + 1]),
        force[2] - share * (force[2] - state[last + 2]),
    )
    add_impulse(end, state, middle, h, done, span)
    for k in range(3):
        state[last + k] = force[k]
    return middle


@kernel
def start_exchange(state, outputs):
    """Begin with the outputs of the initialization."""
    for k in range(EXCHANGE, DOUBTS):
        state[k] = 0.0
    for k in range(LOWER_EXCHANGE, LOWER_WATCH):
        state[k] = 0.0
    for k in range(3):
        state[MEAN + k] = outputs[k]
        state[TOLD + k] = outputs[k]
        state[NEXT + k] = outputs[k]
        state[TO_LOWER + MEAN + k] = outputs[LOWER_FORCES + k]
        state[TO_LOWER + TOLD + k] = outputs[LOWER_FORCES + k]
    tell_exchange(state, outputs)


@kernel
def _settle(end, state, span, share, force):
    """The mean of an end's force, which at the end of the step is `force` (3,)."""
    for k in range(3):
        if state[PENDING] > 0.0:
            state[end + MEAN + k] = force[k]
            state[end + AHEAD + k] += span * force[k]
        else:
            owed = state[end + OWED + k] - state[end + AHEAD + k]
            state[end + MEAN + k] = (state[end + IMPULSE + k] + share * owed) / span
            state[end + OWED + k] = (1.0 - share) * owed
            state[end + AHEAD + k] = 0.0
        state[end + TOLD + k] = force[k]


@kernel
def end_exchange(driven, state, span, outputs):
    """Settle a communication step of `span` that left these outputs, into which its mean forces go; `driven`: of both ends."""
    share = 0.0
    if state[PENDING] == 0.0:
        share = min(span / max(state[STEP], SHORTEST), 1.0)
    _settle(0, state, span, share, outputs[0:3])
    for k in range(3):
        state[NEXT + k] = outputs[k]
    if driven:
        _settle(TO_LOWER, state, span, share, outputs[LOWER_FORCES : LOWER_FORCES + 3])
    tell_exchange(state, outputs)


@kernel
def tell_exchange(state, outputs):
    """The mean forces, the growth and the force to be held that the state has, and what its audit says."""
    for k in range(3):
        outputs[MEANS + k] = state[MEAN + k]
        outputs[LOWER_MEANS + k] = state[TO_LOWER + MEAN + k]
        outputs[MEANS + 6 + k] = state[NEXT + k]
    outputs[MEANS + 3] = state[GROWTH]
    outputs[MEANS + 4] = state[AUDIT]
    outputs[MEANS + 5] = state[AUDIT + 1]
