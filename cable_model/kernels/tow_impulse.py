"""The impulse of the tow model's force on its attachment over an internal step, by the quadrature that belongs to its scheme.

Radau IIA integrates it with its own weights, to order 5; Kutta-Merson by Simpson's rule.  The stages' accelerations are those of the
step's last iteration, so that no equation of motion is solved again.
"""

from cable_model.kernels.choice import by_presence
from cable_model.kernels.jit import kernel
from cable_model.kernels.tow import COUNTED, moving_forces
from cable_model.kernels.tow_schemes import C1, C2, RATES, ROOT6, moved, row, top_in_plane
from cable_model.kernels.tow_space import moving_forces_in_space, swing_of, top_in_space, turning_of

B1 = (16.0 - ROOT6) / 36.0
B2 = (16.0 + ROOT6) / 36.0
B3 = 1.0 / 9.0


@kernel
def _force_in_plane(space, parts, c, drive, elapsed, y, rates, slack):
    """Force of the cable on its attachment (x, y, z) at a stage; `rates` are those of y."""
    fx, fy, _, _, _ = moving_forces(parts, c, top_in_plane(drive, elapsed), drive.time + elapsed, y, rates[1], rates[3], slack)
    return (-fx, 0.0, fy)


@kernel
def _force_in_space(space, parts, c, drive, elapsed, y, rates, slack):
    top = top_in_space(drive, elapsed)
    swing = swing_of(drive.frame, y)
    turning = turning_of(y, swing, rates[1], rates[5])
    f, _, _, _ = moving_forces_in_space(parts, c, top, drive.time + elapsed, swing, y[2], y[3], turning, rates[3], slack)
    return (-f[0], -f[1], -f[2])


_force = by_presence(_force_in_plane, _force_in_space)


@kernel
def count_impulse(explicit, parts, c, drive, elapsed, h, y, slack, waited, work):
    """Add the impulse of a step of h from `elapsed`, just taken from y, to those in work[COUNTED:]: the first `waited` s are apart."""
    share = min(max((waited - elapsed) / h, 0.0), 1.0)
    n = len(y)
    for i in range(3):
        node = (0.0 if i == 0 else (0.5 if i == 1 else 1.0)) if explicit else (C1 if i == 0 else (C2 if i == 1 else 1.0))
        weight = (4.0 / 6.0 if i == 1 else 1.0 / 6.0) if explicit else (B1 if i == 0 else (B2 if i == 1 else B3))
        stage = moved(y, 1.0, row(work, n * i, y))
        force = _force(parts.space, parts, c, drive, elapsed + node * h, stage, row(work, RATES + n * i, y), slack)
        for k in range(3):
            work[COUNTED + k] += share * weight * h * force[k]
            work[COUNTED + 3 + k] += (1.0 - share) * weight * h * force[k]
