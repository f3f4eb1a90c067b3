"""The tow model's shape, at rest too: equilibrium under weight, buoyancy and a steady current, and the state that starts from it."""

import math

from cable_model.kernels.choice import by_presence
from cable_model.kernels.clock import start_clock
from cable_model.kernels.fluid import in_water_now
from cable_model.kernels.header import HEADER, NO_EQUILIBRIUM, OK, OUT_OF_PLANE, SHORTEST, START, STREAM, TIME, TOP
from cable_model.kernels.jit import kernel
from cable_model.kernels.problem import in_calm_water
from cable_model.kernels.tow import ANGLE, PLANE, STATE, STRETCH, constants, shortest_step
from cable_model.kernels.tow_space import STATE_IN_SPACE
from cable_model.kernels.tow_static_space import hang_in_space
from cable_model.kernels.tow_surface import lost_buoyancy
from cable_model.kernels.tow_trial import next_stretch, no_trial
from cable_model.kernels.tow_water import body_water, cable_water

SCAN = 36  # intervals on each side of the vertical in which equilibria are looked for


@kernel
def still_loads(parts, c, time, x, y, phi, u):
    """Turning moment on the cable at rest in the current at a time, and the mean tension that holds it."""
    top = (x, 0.0, 0.0, y, 0.0, 0.0)
    motion = (phi, 0.0, u, 0.0)
    sin = math.sin(phi)
    cos = math.cos(phi)
    q1, q2, _, _, _ = cable_water(parts.water, in_calm_water(parts), c, top, time, motion)
    dx, dy, _, _ = body_water(parts.body, parts.water, in_calm_water(parts), c, top, time, motion)
    weight = c.body_weight + 0.5 * c.weight
    return (c.length + u) * (-sin * weight - dx * cos - dy * sin) + q1, cos * weight - dx * sin + dy * cos + q2


@kernel
def _heaviness(parts, c, x, y, phi, u):
    """Weight in water and air that turns the cable at an angle, N."""
    length = c.length + u
    reach = (-length * math.sin(phi), -length * math.cos(phi))
    return c.body_weight + 0.5 * c.weight + lost_buoyancy(parts.surface, in_calm_water(parts), c, (x, -y), reach)


@kernel
def stable_angle(parts, c, time, x, y, u):
    """Angle of stable balance nearest to the vertical that gravity and buoyancy prefer; NaN where there is none."""
    hang = 0.0
    if _heaviness(parts, c, x, y, 0.0, u) < 0.0:
        hang = math.pi
    middle, _ = still_loads(parts, c, time, x, y, hang, u)
    held_up = hang > 0.0 and _heaviness(parts, c, x, y, hang, u) > 0.0  # afloat, but not in the air
    if held_up and abs(middle) <= 1e-12 * c.force * c.length:
        middle = 0.0
    if middle == 0.0 and not held_up:
        return hang
    first = -1.0 if held_up and middle < 0.0 else 1.0  # of two floats at rest the one that the current pulls at
    step = math.pi / SCAN
    for j in range(SCAN):
        for side in (first, -first):
            low = hang + min(side * j * step, side * (j + 1) * step)
            high = low + step
            m_low, _ = still_loads(parts, c, time, x, y, low, u)
            m_high, _ = still_loads(parts, c, time, x, y, high, u)
            if held_up and j == 0:
                if side > 0.0:
                    m_low = middle
                else:
                    m_high = middle
            if m_low >= 0.0 and m_high <= 0.0 and m_low > m_high:
                for _ in range(60):
                    phi = 0.5 * (low + high)
                    m, _ = still_loads(parts, c, time, x, y, phi, u)
                    if m > 0.0:
                        low = phi
                    else:
                        high = phi
                return 0.5 * (low + high)
    return math.nan


@kernel
def equilibrium(parts, c, time, x, y):
    """Angle and stretch at rest in the current of the moment, and whether they balance."""
    u = (c.body_weight + 0.5 * c.weight) / c.spring
    search = no_trial()
    for _ in range(200):
        phi = stable_angle(parts, c, time, x, y, u)
        if not abs(phi) < 10.0:
            return 0.0, 0.0, False
        _, pull = still_loads(parts, c, time, x, y, phi, u)
        gap = pull / c.spring - u
        u, search = next_stretch(parts.surface, u, gap, search)
        if not u > -0.9 * c.length:
            return 0.0, 0.0, False
        if abs(gap) * c.spring <= 1e-13 * c.force:
            break
    _, pull = still_loads(parts, c, time, x, y, phi, u)
    balanced = abs(pull - c.spring * u) <= 1e-9 * c.force
    return phi, u, balanced


@kernel
def above_floor(tension_floor, c, u):
    if tension_floor is None:
        return True
    return c.spring * u >= c.floor - 1e-9 * c.force


@kernel
def hang_in_plane(space, parts, c, state):
    state[PLANE] = state[TOP + 1]
    phi, u, balanced = equilibrium(parts, c, state[TIME], state[TOP], -state[TOP + 2])
    state[ANGLE] = phi
    state[STRETCH] = u
    return OK if balanced else NO_EQUILIBRIUM


_hang = by_presence(hang_in_plane, hang_in_space)  # puts the state at rest in the current of the moment under its top; returns a status


@kernel
def stays_in_plane(space, c, state):
    if space is None:
        return abs(state[TOP + 4]) <= 1e-9 * c.reference_length * c.pendulum and state[STREAM + 1] == 0.0
    return True


@kernel
def state_size(parts, p):
    return STATE if parts.space is None else STATE_IN_SPACE


@kernel
def initialize(parts, p, time, state, work):
    """Hang the cable in equilibrium in the current of the moment under the top of state[TOP:TOP+9], moving with it; returns a status."""
    c = constants(parts, p)
    if not stays_in_plane(parts.space, c, state):
        return OUT_OF_PLANE
    start_clock(state, time)
    state[START] = time
    parts = in_water_now(parts, p, state)
    for i in range(HEADER, state.shape[0]):
        state[i] = 0.0
    state[SHORTEST] = shortest_step(c)
    status = _hang(parts.space, parts, c, state)
    if status == OK and (not above_floor(parts.tension_floor, c, state[STRETCH]) or not c.mass_y + c.mass_inertia > 0.0):
        return NO_EQUILIBRIUM
    return status


@kernel
def points(parts, p, state, work, told, even, out):
    """Position (m) and tension (N) of points of the straight cable, (m, 4), evenly from its lower end to the top; `told`: outputs now."""
    m = out.shape[0]
    for i in range(m):
        up = i / (m - 1)
        for k in range(3):
            out[i, k] = told[5 + k] + up * (state[TOP + k] - told[5 + k])
        out[i, 3] = told[11] + up * (told[3] - told[11])
