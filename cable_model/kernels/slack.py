"""The tension law of a cell with and without slack, and the rules by which Newton's method moves a tension.

Tension is an unknown of its own, T.  With f = EA e + C e' (or another rising law of e and e') the law without compression is
T = (f + sqrt(f^2 + w0^2))/2; its inverse, f = T - w0^2/(4 T) with T > 0, is the barrier form of an interior-point method, on which
Newton's method does not see the kink.  It is monotone in e', so damping only dissipates.

With bending the law is that of T + T_c, T_c = HELD EI/h^2: a cell may be pressed, as a beam is that is shorter than its buckling length.
Its axial force is N = T + EI kappa^2 (see `staggered.bent`), so in a loop T < 0 where N > 0, and a law that held T >= 0 would
shorten them.  Cells in a zig-zag buckle at T = -4 EI/h^2, a flat fold is in equilibrium at -2 EI/h^2.  With EI = 0 it is the law above.

The law's own damping, without which what is slack chatters, fades out as a cell becomes taut: C = C0 h phi(T), phi = 1 for T <= 0,
1 - 3 y^2 + 2 y^3 with y = T/(FADED times the weight that hangs below) up to y = 1, and 0 beyond.  T is there the tension that the last two
steps foretell: of second order in the step, and a number within it, so that C >= 0 dissipates.  As a function of the strain phi would
fall within a strain of FADED W/EA, where C e' is much more than W in a stiff cable: Newton's method had to find its way in that fall.
"""

from cable_model.kernels.choice import by_presence
from cable_model.kernels.jit import kernel

HELD = 2.0  # T_c over EI/h^2: half of what buckles the mesh from cell to cell, so that no shape that the mesh resolves reaches the floor
UNBENT = 0.01  # of w0: what Newton's method may leave of the barrier's curvature when it stops
FADED = 0.2  # of the weight below, all of which a cable carries where it hangs at rest: nearly slack is what has lost most of it


@kernel
def width(numeric, h):
    """w0 of a cell of length h, N: a share of the whole weight, but no more than what body and cell weigh.

    At a free end the tension falls below any share of the whole weight; a law that is soft there would rule the smallest cells.
    """
    return min(numeric.smoothing, numeric.hung + numeric.own * h)


@kernel
def floor(parts, numeric, h):
    """T_c, the compression that bending holds a cell of length h against, N."""
    if parts.bending is None:
        return 0.0
    return _held(parts.slack, numeric.bending, h)


@kernel
def _held(slack, bending, h):
    if slack is None:
        return 0.0
    return HELD * bending / (h * h)


@kernel
def limited(parts, numeric, h, tension):
    """The tension at an end of the cable, where its cell of length h ends: none below -T_c.

    `tension` is the cell's, carried to the end by the weight and the inertia of the part between, which hold for a straight cable.
    One that is slack and is thrown, or lies, gives way there instead of pushing.
    """
    if parts.slack is None:
        return tension
    return max(tension, 0.0 - floor(parts, numeric, h))


@kernel
def _linear(curve, stiffness, strain):
    return stiffness * strain, stiffness


@kernel
def _by_table(curve, stiffness, strain):
    """Cubic between the rows, and straight on beyond them."""
    last = curve.shape[0] - 1
    if strain <= curve[0, 0]:
        return curve[0, 1] + curve[0, 2] * (strain - curve[0, 0]), curve[0, 2]
    if strain >= curve[last, 0]:
        return curve[last, 1] + curve[last, 2] * (strain - curve[last, 0]), curve[last, 2]
    i = 1
    while curve[i, 0] < strain:
        i += 1
    width = curve[i, 0] - curve[i - 1, 0]
    s = (strain - curve[i - 1, 0]) / width
    rise = curve[i, 1] - curve[i - 1, 1]
    c1 = curve[i - 1, 2] * width
    c2 = 3.0 * rise - 2.0 * c1 - curve[i, 2] * width
    c3 = c1 + curve[i, 2] * width - 2.0 * rise
    return curve[i - 1, 1] + s * (c1 + s * (c2 + s * c3)), (c1 + s * (2.0 * c2 + s * 3.0 * c3)) / width


elastic = by_presence(_linear, _by_table)  # tension of the elastic law, and its slope


@kernel
def fading(slack, tension, below):
    """phi, the share of the slack damping that acts at a tension; `below` is the weight that hangs below the cell's upper end, N."""
    if slack is None:
        return 0.0
    y = min(max(tension / (FADED * below), 0.0), 1.0)
    return 1.0 - y * y * (3.0 - 2.0 * y)


@kernel
def with_quadratic_damping(quadratic, p, rate, f, damping):
    """The tension `f` with c |e'| e' added to it, and its slope by the strain rate e', which is `damping` without it."""
    if quadratic is None:
        return f, damping
    slope = p[0].cable.quadratic_damping * abs(rate)
    return f + slope * rate, damping + 2.0 * slope


@kernel
def constitutive(slack, smoothing, f, force):
    """Slope dT/df at the iterate `force`, and the misfit of the law there."""
    if slack is None:
        return 1.0, f - force
    barrier = 0.25 * smoothing * smoothing / force
    return force / (force + barrier), f - force + barrier


@kernel
def iterate(slack, smoothing, f, force):
    """The tension to linearise about: the iterate, but the law's at f = 0 where a slack cell has become taut.

    The barrier form raises a small tension by a factor of 2 an iteration only.
    """
    if slack is None:
        return force
    if f > 0.0 and force < 1e-3 * smoothing:
        return 0.5 * smoothing
    return force


@kernel
def step_tension(slack, smoothing, force, change):
    """Tension after a Newton change; with slack it stays positive.  Also whether another iteration is needed for it.

    It is where the change was cut by more than a trifle, or where the barrier's curvature alone, which the linearised law leaves out,
    would move the tension by more than UNBENT of the law's width: at the end of slack that is a snap which velocities do not show yet.
    """
    if slack is None:
        return force + change, False
    if change < -0.999 * force:
        return 0.001 * force, force > 1e-5 * smoothing
    new = force + change
    left_out = (0.5 * smoothing * change / force) ** 2 / new  # of w0^2/(4 T): its value at `new` minus its tangent's
    return new, left_out * new * new > UNBENT * smoothing * (new * new + 0.25 * smoothing * smoothing)


@kernel
def shortfall(slack, cells, i):
    """What the averaged strain of a cell leaves out of the strain before the step, where that was deep in slack."""
    if slack is None:
        return 0.0
    return cells[i, cells.shape[1] - 1]
