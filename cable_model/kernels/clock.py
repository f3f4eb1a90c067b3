"""A run's clock and counters at its start."""

from cable_model.kernels import header
from cable_model.kernels.jit import kernel


@kernel
def start_clock(state, time):
    """Begin at `time`: nothing else of the head, where the ends, their inputs and the winch are those of start_ends."""
    state[header.TIME] = time
    for k in (header.STEP, header.NEXT_STEP, header.STEPS, header.NEWTON, header.REJECTED, header.LAST_ERROR, header.LARGEST_MOTION):
        state[k] = 0.0
    for k in (header.PENDING, header.LAG, header.LAG_BEFORE, header.OFFSET, header.DRIFT_STEP):
        state[k] = 0.0
    for k in range(header.AUDIT, header.LOWER):
        state[k] = 0.0
