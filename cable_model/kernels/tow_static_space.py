"""The tow model in space at rest under weight, buoyancy and a steady current."""

import math

from cable_model.kernels.choice import by_presence
from cable_model.kernels.header import NO_EQUILIBRIUM, OK, TIME
from cable_model.kernels.jit import kernel
from cable_model.kernels.problem import in_calm_water
from cable_model.kernels.tow import STRETCH
from cable_model.kernels.tow_space import DIRECTION, Swing, across_only, frame_of, swing_of, top_of
from cable_model.kernels.tow_surface import lost_buoyancy
from cable_model.kernels.tow_trial import next_stretch, no_trial
from cable_model.kernels.tow_water_space import body_water_in_space, cable_water_in_space
from cable_model.kernels.vector import add, dot, mix, norm, store, unit, zero

STATIC_ITERATIONS = 300
FARTHEST = 0.2  # rad, turn of the cable in a step


@kernel
def resting_load(parts, c, time, top, e, u):
    """Generalized force on R of weight and current at a time, with the cable at rest."""
    swing = Swing(e, zero(e), e, e)
    arm, _, _ = cable_water_in_space(parts.water, in_calm_water(parts), c, top, time, swing, u, 0.0)
    load, _, _ = body_water_in_space(parts.body, parts.water, in_calm_water(parts), c, top, time, swing, u, 0.0)
    load = add(arm, load)
    return (load[0], load[1], load[2] - c.body_weight - 0.5 * c.weight)


@kernel
def _turned(frame, x1, x2):
    return swing_of(frame, (x1, 0.0, 0.0, 0.0, x2, 0.0)).e


@kernel
def _stretched(surface, parts, c, time, top, e, u):
    return dot(resting_load(parts, c, time, top, e, u), e) / c.spring


@kernel
def _stretched_at_surface(surface, parts, c, time, top, e, u):
    search = no_trial()
    for _ in range(STATIC_ITERATIONS):
        gap = dot(resting_load(parts, c, time, top, e, u), e) / c.spring - u
        if not abs(gap) * c.spring > 1e-14 * c.force:
            break
        u, search = next_stretch(surface, u, gap, search)
        if not u > -0.9 * c.length:
            break
    return u


_settled = by_presence(_stretched, _stretched_at_surface)  # the stretch at rest in a direction; in water a step towards it


@kernel
def _aside_in_water(surface, parts, c, time, top, e, u):
    return resting_load(parts, c, time, top, e, u)


@kernel
def _aside_at_surface(surface, parts, c, time, top, e, u):
    return resting_load(parts, c, time, top, e, _stretched_at_surface(surface, parts, c, time, top, e, u))


_load_aside = by_presence(_aside_in_water, _aside_at_surface)  # in a direction beside the one of u


@kernel
def _any_balance(surface, stable):
    return True


@kernel
def _stable_balance(surface, stable):
    return stable


_rests = by_presence(_any_balance, _stable_balance)  # a float is not to stand upright in the air


@kernel
def _farthest(surface, limit, across, moved):
    return limit


@kernel
def _shorter(surface, limit, across, moved):
    """Half of a way that went too far: across the surface the load turns round."""
    if dot(across, moved) < 0.0:
        return 0.5 * min(limit, norm(moved))
    return min(1.2 * limit, FARTHEST)


_allowed = by_presence(_farthest, _shorter)  # turn of the cable in the next step


@kernel
def balance(parts, c, time, top):
    """Direction and stretch at rest in the current of the moment, and whether they balance: Newton from the vertical on the part across."""
    still = (top[0], zero(top[0]), zero(top[0]))
    down = (0.0, 0.0, -c.length)
    hanging = c.body_weight + 0.5 * c.weight + lost_buoyancy(parts.surface, in_calm_water(parts), c, top[0], down) >= 0.0
    e = (0.0, 0.0, -1.0 if hanging else 1.0)
    u = abs(c.body_weight + 0.5 * c.weight) / c.spring
    gap = math.inf
    limit = FARTHEST
    moved = zero(e)
    for _ in range(STATIC_ITERATIONS):
        u = _settled(parts.surface, parts, c, time, still, e, u)
        if not u > -0.9 * c.length:
            return e, u, False
        load = resting_load(parts, c, time, still, e, u)
        gap = norm(across_only(e, load)) + abs(dot(load, e) - c.spring * u)
        frame = frame_of(e)
        d = 1e-6
        r1, r2 = dot(load, frame.a), dot(load, frame.b)
        ahead = _load_aside(parts.surface, parts, c, time, still, _turned(frame, d, 0.0), u)
        aside = _load_aside(parts.surface, parts, c, time, still, _turned(frame, 0.0, d), u)
        # across the turned cable: the load's part along e turns with it
        j11 = (dot(ahead, frame.a) - r1) / d - dot(ahead, e)
        j21 = (dot(ahead, frame.b) - r2) / d
        j12 = (dot(aside, frame.a) - r1) / d
        j22 = (dot(aside, frame.b) - r2) / d - dot(aside, e)
        det = j11 * j22 - j12 * j21
        stable = det > 0.0 and j11 + j22 < 0.0
        if gap <= 1e-13 * c.force and _rests(parts.surface, stable):
            break
        pull = max(norm(load), 1e-300)
        x1, x2 = FARTHEST * r1 / pull, FARTHEST * r2 / pull  # downhill, where Newton's way does not lead to a stable balance
        if stable:
            x1, x2 = (j12 * r2 - j22 * r1) / det, (j21 * r1 - j11 * r2) / det
        elif gap <= 1e-13 * c.force:
            x1 = FARTHEST
        size = math.sqrt(x1 * x1 + x2 * x2)
        limit = _allowed(parts.surface, limit, across_only(e, load), moved)
        if size > limit:
            x1, x2 = limit * x1 / size, limit * x2 / size
        moved = mix(x1, frame.a, x2, frame.b)
        e = unit(_turned(frame, x1, x2))
    return e, u, gap <= 1e-9 * c.force


@kernel
def hang_in_space(space, parts, c, state):
    """Put the state at rest under its top; returns a status."""
    e, u, balanced = balance(parts, c, state[TIME], top_of(state))
    if not balanced:
        return NO_EQUILIBRIUM
    row = state[DIRECTION : DIRECTION + 6].reshape(2, 3)
    store(row, 0, e)
    store(row, 1, zero(e))
    state[STRETCH] = u
    return OK
