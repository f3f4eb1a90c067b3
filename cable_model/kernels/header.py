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
KEPT_TOP = 15  # 15..23: the same at the end of the last internal step, where time is pending since then
CLOSING = 24  # time over which the top at least closes on where its inputs lead, s
ERROR_TIME = 25  # where a failed step began, s
ERROR_NODE = 26  # node of the largest residual or change then
ERROR_SIZE = 27  # its size
SHORTEST = 28  # time that is never stepped over alone, s
LAG = 29  # by which the averaged time of the last internal step is before its end, alpha_k h, s
PAID_OUT = 30  # cable that the winch has paid out since the start, m
WINCH_SPEED = 31  # now, m/s; paying out is positive
KEPT_PAID_OUT = 32  # the winch at the end of the last internal step, where time is pending since then
MESH_LENGTH = 33  # unstretched length that the mesh now has, m
WINCH_ACCELERATION = 34
LAST_ERROR = 35  # that the error control found in the last step, m/s2
CONTRACTION = 36  # of Newton's changes, see convergence.py
LARGEST_MOTION = 37  # largest rms acceleration that the error control has seen, m/s2
PENDING = 38  # time since the last internal step, s: outputs lead on from it, and the next step begins there
KEPT_WINCH_SPEED = 39
INPUTS = 40  # 40..67: four inputs, the newest first: the highest that is given of the top's motion, winch speed, the lower end's
INPUT_STEPS = 68  # 68..71: from each of them to the one after it, from the newest to the inputs now, s; 0 where there is none
DRIFT_STEP = 72  # step that sets the time in which the drift of a held cable's top is removed, s
OFFSET = 73  # by which the time of the rates kept is after the end of the last internal step, (alpha_m - alpha_k) h, s
LAG_BEFORE = 74  # LAG of the internal step before
EXCHANGE = 75  # 75..96: what exchange.py keeps
RINGING = 97  # 97..186: what ringing.py keeps
HOST = 187  # 187..246: what host.py keeps
DOUBTS = 247  # how many kinds of doubt watch.py has seen
DOUBT = 248  # 248..295: a pair of numbers for each kind, 0 until it is seen
WATCH = 296  # 296..318: what watch.py keeps
INSTANTS = 319  # 319..331: what instants.py keeps
AUDIT = 332  # 332..359: what audit.py keeps
LOWER = 360  # 360..368: position, velocity, acceleration of a driven lower end now; else 0
KEPT_LOWER = 369  # 369..377: the same at the end of the last internal step, where time is pending since then
LOWER_EXCHANGE = 378  # 378..395: what exchange.py keeps of a driven lower end
LOWER_WATCH = 396  # 396..418: what watch.py keeps of one
LOWER_RINGING = 419  # 419..508: what ringing.py keeps of one
HEADER = 509

CELLS_OF_A_SECTION = 2  # at least
SUNK = 10.0  # diameters below a seabed: an end that lies on it sinks in a little; what rules refuse at the start, and watch.py tells of

OK = 0
STEP_TOO_SMALL = 1  # Newton failed down to the smallest step
NOT_FINITE = 2
NO_EQUILIBRIUM = 3
OUT_OF_PLANE = 4
NO_WINCH = 5  # the winch turned, and there is none
HAULED_IN = 6  # next to no cable is left
WEIGHTLESS = 7  # no static equilibrium: nothing says where the cable rests
BELOW_WAVES = 8  # the cable reaches below the bottom of the waves
NO_SLACK = 9  # no static equilibrium, or only that of a column, of a cable that can be pressed
TOO_MANY_STEPS = 10  # a communication step that would not end
NOT_DRIVEN = 11  # the lower end was moved, and nothing moves with it
LAST_STATUS = NOT_DRIVEN
