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
INPUTS = 40  # 40..75: four inputs, the newest first: the highest that is given of the top's motion, winch speed, the lower end's, stream
INPUT_STEPS = 76  # 76..79: from each of them to the one after it, from the newest to the inputs now, s; 0 where there is none
DRIFT_STEP = 80  # step that sets the time in which the drift of a held cable's top is removed, s
OFFSET = 81  # by which the time of the rates kept is after the end of the last internal step, (alpha_m - alpha_k) h, s
LAG_BEFORE = 82  # LAG of the internal step before
EXCHANGE = 83  # 83..104: what exchange.py keeps
RINGING = 105  # 105..194: what ringing.py keeps
HOST = 195  # 195..254: what host.py keeps
DOUBTS = 255  # how many kinds of doubt.py have been seen
DOUBT = 256  # 256..319: a pair of numbers for each kind, 0 until it is seen; the last few are free
WATCH = 320  # 320..342: what watch.py keeps
INSTANTS = 343  # 343..355: what instants.py keeps
AUDIT = 356  # 356..383: what audit.py keeps
LOWER = 384  # 384..392: position, velocity, acceleration of a driven lower end now; else 0
KEPT_LOWER = 393  # 393..401: the same at the end of the last internal step, where time is pending since then
LOWER_EXCHANGE = 402  # 402..419: what exchange.py keeps of a driven lower end
LOWER_WATCH = 420  # 420..442: what watch.py keeps of one
LOWER_RINGING = 443  # 443..532: what ringing.py keeps of one
STREAM = 533  # 533..536: x and y of the current that inputs give, now, m/s; and what they change by, m/s2
KEPT_STREAM = 537  # 537..538: x and y at the end of the last internal step, where time is pending since then
START = 539  # time of the initialization, s
PARTED = 540  # 0: the cable is whole; 1: what was below has gone, with what held the lower end; 2: all of it has gone
NODES = 541  # of what is left
LOST = 542  # unstretched length that has gone, m
RESUMES = 543  # 1: it has parted within a communication step, and the next call goes on there
RESUMES_AFTER = 544  # and how long after its start, s
CUT = 545  # 0: the cable is not cut; an input cuts it, 1: at the start of this communication step, 2: at its end; 3: it was cut before
LOAD = 546  # the largest tension over the tension at which the cable breaks there, at the end of the last internal step
FRONT = 547  # 1 while internal steps grow slowly, behind a front that runs up from an end which is suddenly free; then -1
HEADER = 548

WHOLE, SHORTER, ALL_LOST = 0.0, 1.0, 2.0  # of PARTED
AT_START, AT_END, DONE = 1.0, 2.0, 3.0  # of CUT

CELLS_OF_A_SECTION = 2  # at least
SUNK = 10.0  # diameters below a seabed: an end that lies on it sinks in a little; rules refuse it, watch_outputs.py tells of it

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
NO_STREAM = 12  # inputs gave a current, and none is asked for
NOT_LET_GO = 13  # an input let the lower end go, and that is not asked for
TOO_WEAK = 14  # the cable breaks at rest
LAST_STATUS = TOO_WEAK
PARTING = -3  # the cable parts within a communication step, whose rest is another call's; beside those of host_trials and calls
