"""The audit of a run: the energy and the momentum of cable and body against what outer forces do, step by step.

    audit.energy    E - E0 - W, J: the energy stored less that at the start, less the work of ends, water and seabed, plus what damping took
    audit.momentum  |dP/dt - F|, N: what the outer forces lack to change the momentum as it changes; root mean square over the time so far

E is kinetic, potential, strain and bending energy of the state.  The work of an end is that of top.force, or lower.force, at the ends of
the internal steps along the prescribed way; F has top.force_mean, which an internal step has in its middle.  All other loads are
staggered_audit's and seabed_audit's, by their own formulas: of the equations that were solved nothing is used but these forces, the share
at which the slack damping acted, the stretch of the friction's springs, and at a held lower end the tension of the lowest cell, which is
cut there.  So a right run leaves what its steps are wrong by, and falls with their square; a wrong load, mass or force leaves all of
itself.

An account is kept in the state's head; it changes no number of the model.
"""

from cable_model.kernels.chain_outputs import in_axes
from cable_model.kernels.choice import by_presence
from cable_model.kernels.exchange import TO_LOWER, TOLD
from cable_model.kernels.header import AUDIT, LAG, STEPS
from cable_model.kernels.jit import kernel
from cable_model.kernels.pending import ahead_to_end
from cable_model.kernels.problem import total_weight
from cable_model.kernels.seabed_audit import bed_in_step
from cable_model.kernels.staggered import FADING
from cable_model.kernels.staggered_audit import change_of_momentum, pull_of_anchor, stored, taken_by_damping, water_in_step
from cable_model.kernels.staggered_chain import end_forces, tensions_now, unwound
from cable_model.kernels.vector import add, axes, dot, norm, scale, sub

ENERGY = AUDIT  # what lacks, J
MOMENTUM = AUDIT + 1  # what lacks, N
EXCHANGED = AUDIT + 2  # the most of any energy or work so far, J
FORCES = AUDIT + 3  # sum of the sizes of the outer forces, root mean square so far, N
START = AUDIT + 4  # kinetic, potential and elastic energy at the start
END_WORK = AUDIT + 7  # work so far, J
WATER_WORK = AUDIT + 8
BED_WORK = AUDIT + 9
TAKEN = AUDIT + 10  # by damping
FORCE = AUDIT + 11  # of the cable on its attachment at the end of the last internal step, N; three numbers
# AUDIT + 14 .. 16: and at that of the one before
GAP = AUDIT + 17  # from one to the other, s; 0 where there are not two
TIME = AUDIT + 18  # audited, s
LACKING = AUDIT + 19  # squares of the force that lacks, over that time, N2 s
ACTING = AUDIT + 20  # and of FORCES
STORED = AUDIT + 21  # energy now, J
LOWER_FORCE = AUDIT + 22  # the six numbers from FORCE on, of a driven lower end

NOTHING = 1e-6  # of weight times length: less energy counts as none that is exchanged


@kernel
def _no_account(audit, parts, problem, view, state, top):
    return


@kernel
def _open(audit, parts, problem, view, state, top):
    state[START], state[START + 1], state[START + 2] = stored(parts, problem, view.mesh, view.y, top)
    state[STORED] = state[START] + state[START + 1] + state[START + 2]
    state[EXCHANGED] = NOTHING * total_weight(parts, problem.numbers) * problem.cable.length


open_audit = by_presence(_no_account, _open)  # at the start, with the cable in place and the top's velocity in the state


@kernel
def _reopen(audit, parts, problem, view, state, top):
    kinetic, potential, strained = stored(parts, problem, view.mesh, view.y, top)
    begun = state[START] + state[START + 1] + state[START + 2] + kinetic + potential + strained - state[STORED]
    state[START], state[START + 1], state[START + 2] = begun - potential - strained, potential, strained
    state[GAP] = 0.0


reopen_audit = by_presence(_no_account, _reopen)  # where a cable has parted: the energy of what has gone counts as never there


@kernel
def forces_at_end(parts, problem, view, state, c, time, h, top, lower):
    """Forces as outputs would tell them at the end of the step of h just taken, where `top` is and `time`; before y1 is the state."""
    n = view.mesh.shape[0] + 1
    offset = (c.alpha_m - c.alpha_k) * h
    for i in range(n):
        for k in range(len(top)):
            view.scratch.a[i, k] = view.yd1[n + i, k] - offset * view.ydd[n + i, k]
    ahead = ahead_to_end(state, c, h)
    tensions_now(parts, problem, view.mesh, view.y1, view.force, view.force_old, ahead, top, view.scratch.cells)
    return end_forces(parts, problem, view.mesh, view.y1, view.scratch.a, top, lower, unwound(problem), time, view.scratch)


@kernel
def tension_in_middle(view, state, c, h):
    """Of the lowest cell, N, from those at the averaged times of the last two steps."""
    if state[STEPS] == 0.0:
        return view.force[0]
    late = (0.5 - c.alpha_k) * h / (h - c.alpha_k * h + state[LAG])
    return view.force[0] - late * (view.force[0] - view.force_old[0])


@kernel
def _count_end(parts, state, kept, told, force, way, faster, h):
    """Work over a step of h of the force that is `force` at its end, on an end of the cable that goes `way` and gets `faster` in it.

    `kept`: place of the last two forces; `told`: of that at the start.
    """
    force, way, faster = in_axes(parts.space, force, 0.0), in_axes(parts.space, way, 0.0), in_axes(parts.space, faster, 0.0)
    gap = state[GAP]
    work = 0.0
    for k in range(3):
        old = state[kept + k] if state[STEPS] > 0.0 else state[told + k]
        rise = force[k] - old
        bend = 0.0
        if gap > 0.0:
            bend = (rise / h - (old - state[kept + 3 + k]) / gap) / (h + gap)
        work -= (0.5 * (force[k] + old) - h * h / 6.0 * bend) * way[k] + h / 12.0 * rise * faster[k]
        state[kept + 3 + k] = old
        state[kept + k] = force[k]
    state[END_WORK] += work


@kernel
def _not_counted(audit, parts, problem, view, state, c, time, h, begun, ended, faster, force):
    return


@kernel
def _count(audit, parts, problem, view, state, c, time, h, begun, ended, faster, force):
    mesh, y0, y1 = view.mesh, view.y, view.y1
    before, after = begun.top, ended.top
    water, water_work = water_in_step(parts, problem, mesh, y0, y1, before, after, h, time + 0.5 * h)
    bed, bed_work = bed_in_step(parts.seabed, parts, problem, mesh, y0, y1, before, after, view.sliders, view.scratch.contact, h)
    fading = view.scratch.cells[:, view.scratch.cells.shape[1] + FADING]
    state[TAKEN] += taken_by_damping(parts, problem, mesh, y0, y1, fading, h, after)
    state[WATER_WORK] += water_work
    state[BED_WORK] += bed_work
    change, weight = change_of_momentum(parts, problem, mesh, y0, y1, after)
    anchor = pull_of_anchor(parts.anchor, parts, problem, mesh, y0, y1, tension_in_middle(view, state, c, h), after)
    on_top = axes(parts.space, -force[0], -force[1], -force[2])
    lacking = sub(scale(1.0 / h, change), add(add(weight, on_top), add(water, add(bed, anchor))))
    acting = norm(on_top) + norm(weight) + norm(water) + norm(bed) + norm(anchor)
    kinetic, potential, strained = stored(parts, problem, mesh, y1, after)
    forces = forces_at_end(parts, problem, view, state, c, time + h, h, after, ended.lower)
    _count_end(parts, state, FORCE, TOLD, forces.top, sub(after, before), faster.top, h)
    if parts.driven is not None:
        _count_end(parts, state, LOWER_FORCE, TO_LOWER + TOLD, forces.lower, sub(ended.lower, begun.lower), faster.lower, h)
    state[GAP] = h
    _settle(state, h, kinetic, potential, strained, dot(lacking, lacking), acting * acting)


# an internal step of h from `time`, whose y is still the state and whose y1 the next one; the ends go from the places `begun` to those
# `ended` and get `faster`, with the force (Fx, Fy, Fz) on the attachment in the middle of the step
count_step = by_presence(_not_counted, _count)


@kernel
def _settle(state, h, kinetic, potential, strained, lacking, acting):
    state[STORED] = kinetic + potential + strained
    worked = state[END_WORK] + state[WATER_WORK] + state[BED_WORK] - state[TAKEN]
    state[ENERGY] = state[STORED] - (state[START] + state[START + 1] + state[START + 2]) - worked
    most = max(state[EXCHANGED], kinetic)
    for gained in (potential - state[START + 1], strained - state[START + 2]):
        most = max(most, abs(gained))
    for k in range(END_WORK, TAKEN + 1):
        most = max(most, abs(state[k]))
    state[EXCHANGED] = most
    state[TIME] += h
    state[LACKING] += h * lacking
    state[ACTING] += h * acting
    state[MOMENTUM] = (state[LACKING] / state[TIME]) ** 0.5
    state[FORCES] = (state[ACTING] / state[TIME]) ** 0.5
