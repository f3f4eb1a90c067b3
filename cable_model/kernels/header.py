"""The head of every model's state vector: clock, counters, the top's motion and its last inputs; and the status codes of kernels.

A state vector is one contiguous float64 array: HEADER numbers, then the model's own.  Copying it copies the whole state.
"""

TIME = 0
STEP = 1  # last internal step, s; 0 before the first
NEXT_STEP = 2  # step that the error control proposes, s
STEPS = 3
NEWTON = 4
REJECTED = 5
TOP = 6  # 6..14: position, velocity, acceleration of the top now
INPUT = 15  # 15..23: the inputs of the last communication step
INPUT_STEP = 24  # its size, s; 0 before the first
ERROR_TIME = 25  # where a failed step began, s
ERROR_NODE = 26  # node of the largest residual or change then
ERROR_SIZE = 27  # its size
INPUT_STEP_2 = 28  # size of the communication step before, s; 0 where there was none
INPUT_STEP_3 = 29  # and of the one before that
PAID_OUT = 30  # cable that the winch has paid out since the start, m
WINCH_SPEED = 31  # now, m/s; paying out is positive
WINCH_INPUT = 32  # the input of the last communication step
MESH_LENGTH = 33  # unstretched length that the mesh now has, m
WINCH_ACCELERATION = 34
LAST_ERROR = 35  # that the error control found in the last step, m/s2
CONTRACTION = 36  # of Newton's changes, see convergence.py
LARGEST_MOTION = 37  # largest rms acceleration that the error control has seen, m/s2
DOUBTS = 40  # how many kinds of doubt watch.py has seen
DOUBT = 41  # 41..52: a pair of numbers for each kind, 0 until it is seen
WATCH = 53  # 53..67: what watch.py keeps
HEADER = 68

OK = 0
STEP_TOO_SMALL = 1  # Newton failed down to the smallest step
NOT_FINITE = 2
NO_EQUILIBRIUM = 3
OUT_OF_PLANE = 4
NO_WINCH = 5  # the winch turned, and there is none
HAULED_IN = 6  # next to no cable is left
