"""The tow model in space: Lagrange's equations, checked symbolically, its power balance, and that it is the plane's where it should be."""

import numpy as np
import pytest
import sympy
from tow_reference import DRY, NUMBERS, SHEAR, WAVES, WET, circling, follow, still, tow, turned_sea

from cable_model import TowCable, load
from cable_model.effects import record
from cable_model.errors import ParameterError
from cable_model.kernels import tow as plane
from cable_model.kernels import tow_space
from cable_model.scene import with_values
from cable_model.sea import rows_of

SPACE = WET._replace(space=True)
VARIANTS = {
    "all": ({}, SPACE._replace(waves=turned_sea(WAVES, 0.7))),
    "disk": ({"tow.body_angle": -0.6}, SPACE),
    "dry": ({}, DRY._replace(space=True)),
    "no cable mass": ({}, SPACE._replace(cable_mass=None)),
}


def numbers(changes):
    values = NUMBERS | {"tow.body_angle": 18.0, "cable.volume_per_length": -1.0} | changes
    return record(values)


def states(count, seed):
    """Tops (position, velocity, acceleration), directions and their rates, stretch and its rate; at random."""
    random = np.random.default_rng(seed)
    for _ in range(count):
        top = [tuple(random.normal(size=3) * size + shift) for size, shift in ((5.0, [0, 0, -8.0]), (1.0, 0.0), (1.0, 0.0))]
        e = random.normal(size=3)
        e /= np.linalg.norm(e)
        rate = np.cross(random.normal(size=3) * 0.3, e)
        swing = tow_space.Swing(tuple(e), tuple(rate), tuple(e), tuple(e))
        yield tuple(top), swing, 0.3 + random.normal() * 0.2, random.normal() * 0.5


def symbolic_equations():
    """Lagrange's equations by sympy in two angles and the stretch: the energies are integrals over the cable, taken exactly."""
    t, s = sympy.symbols("t s")
    constants = sympy.symbols("M_c gamma p l_r l_0 M_x M_y W_b W_c")
    mass, added, poisson, l_r, l_0, mass_x, mass_y, body_weight, weight = constants
    phi, psi, u = (sympy.Function(name)(t) for name in ("phi", "psi", "u"))
    top = sympy.Matrix([sympy.Function(f"r{k}")(t) for k in range(3)])
    e = sympy.Matrix([-sympy.sin(phi) * sympy.cos(psi), sympy.sin(psi), -sympy.cos(phi) * sympy.cos(psi)])
    length = l_0 + u
    velocity = top.diff(t) + s * (length * e).diff(t)
    along = velocity.dot(e)
    thin = 1 - poisson * u / l_r
    density = mass * velocity.dot(velocity) + added * thin**2 * length * (velocity.dot(velocity) - along**2)
    kinetic = sympy.integrate(sympy.expand(density), (s, 0, 1)) / 2
    end = (top + length * e).diff(t)
    kinetic += (mass_x * (end[0] ** 2 + end[1] ** 2) + mass_y * end[2] ** 2) / 2
    height = (body_weight + weight / 2) * length * e[2]
    coordinates = (phi, psi, u)
    left = [(kinetic.diff(q.diff(t))).diff(t) - kinetic.diff(q) + height.diff(q) for q in coordinates]
    return t, constants, top, e, coordinates, left


@pytest.mark.long
def test_accelerations_are_those_of_the_symbolic_lagrangian():
    """Forces of water and spring enter by virtual work, which the power balance tests."""
    t, constants, top, e, (phi, psi, u), left = symbolic_equations()
    names = sympy.symbols("phi0:3 psi0:3 u0:3 x0:3 y0:3 z0:3")
    replaced = []
    for q, group in zip((phi, psi, u, *top), (names[3 * i : 3 * i + 3] for i in range(6)), strict=True):
        replaced += [(q.diff(t, 2), group[2]), (q.diff(t), group[1]), (q, group[0])]
    equations = sympy.Matrix([term.subs(replaced) for term in left])
    direction = [[term.subs(replaced) for term in vector] for vector in (e, e.diff(t), e.diff(t, 2))]
    evaluate = sympy.lambdify((names, constants), list(equations))
    directions = sympy.lambdify((names,), direction)
    parts = DRY._replace(space=True)
    values = NUMBERS | {"tow.reference_tension": 800.0}
    c = plane.constants(parts, numbers({}))._replace(added=31.0 / 60.0, added_inertia=31.0 / 60.0, mass_x=210.0, mass_y=290.0)
    known = (c.mass, c.added, values["tow.poisson_ratio"], c.reference_length, c.length, c.mass_x, c.mass_y, c.body_weight, c.weight)
    random = np.random.default_rng(5)
    for _ in range(20):
        state = random.normal(size=18) * 0.5
        stretch, rate = state[6], state[7]
        e0, e1, _ = directions(state)
        moves = tuple(tuple(state[9 + k : 18 : 3]) for k in range(3))
        swing = tow_space.Swing(tuple(e0), tuple(e1), tuple(e0), tuple(e0))
        spring = c._replace(spring=0.0, damper=0.0)
        got = tow_space.turning_and_stretching(parts._replace(tension_floor=None), spring, moves, 0.0, swing, stretch, rate, 0.0)
        # the equations are linear in the accelerations: solve them
        rest = np.array(state)
        rest[[2, 5, 8]] = 0.0
        base = np.array(evaluate(rest, known))
        inertia = np.empty((3, 3))
        for k, at in enumerate((2, 5, 8)):
            one = rest.copy()
            one[at] = 1.0
            inertia[:, k] = np.array(evaluate(one, known)) - base
        rest[[2, 5, 8]] = np.linalg.solve(inertia, -base)
        turning = np.array(directions(rest)[2])
        turning -= np.dot(turning, e0) * np.array(e0)
        assert got[1] == pytest.approx(rest[8], rel=1e-9, abs=1e-11)
        assert np.array(got[0]) - np.dot(got[0], e0) * np.array(e0) == pytest.approx(turning, rel=1e-9, abs=1e-11)


def energies(c, top, swing, stretch, rate):
    """Kinetic energy and that of the weights, by quadrature; complex numbers allowed."""
    position, velocity, _ = map(np.array, top)
    e, w = np.array(swing.e), np.array(swing.rate)
    length = c.length + stretch
    at, weight = (np.polynomial.legendre.leggauss(4)[0] + 1.0) / 2.0, np.polynomial.legendre.leggauss(4)[1] / 2.0
    added = c.added * (1.0 - c.contraction * stretch) ** 2 * length
    total = 0.0
    for share, part in zip(at, weight, strict=True):
        v = velocity + share * (rate * e + length * w)
        along = v @ e
        total += 0.5 * part * (c.mass * (v @ v) + added * (v @ v - along * along))
    v = velocity + rate * e + length * w
    total += 0.5 * (c.mass_x * (v[0] ** 2 + v[1] ** 2) + c.mass_y * v[2] ** 2)
    return total + (c.body_weight + c.weight) * position[2] + (c.body_weight + 0.5 * c.weight) * length * e[2]


@pytest.mark.parametrize("variant", VARIANTS)
def test_power_balance_closes_at_any_state(variant):
    """d(K + V_g)/dt = F.v_top + sum D.v - T u'; the water's forces by their own statement here."""
    changes, parts = VARIANTS[variant]
    c = plane.constants(parts, numbers(changes))
    p = NUMBERS | {"tow.body_angle": 18.0} | changes
    for top, swing, u, ud in states(20, 2):
        turning, stretching = tow_space.turning_and_stretching(parts, c, top, 2.3, swing, u, ud, 0.0)
        force, _, tension, _ = tow_space.end_forces_in_space(parts, c, top, 2.3, swing, u, ud, 0.0)
        h = 1e-30j
        e, w = np.array(swing.e), np.array(swing.rate)
        later = tow_space.Swing(e + h * w, w + h * np.array(turning), e, e)
        moved = (np.array(top[0]) + h * np.array(top[1]), np.array(top[1]) + h * np.array(top[2]), top[2])
        gain = energies(c, moved, later, u + h * ud, ud + h * stretching).imag / 1e-30
        powers = [np.dot(force, top[1]), -tension * ud]
        if parts.water is not None:
            length = c.length + u
            diameter = (1.0 - c.contraction * u) * 2.0 * c.normal_drag / (1025.0 * p["cable.normal_drag_coefficient"])
            for share, weight, body in [((i + 0.5) / c.segments, 1.0 / c.segments, False) for i in range(c.segments)] + [(1.0, 1.0, True)]:
                place = np.array(top[0]) + share * length * e
                v = np.array(top[1]) + share * (ud * e + length * w)
                flow = np.array([np.interp(place[2], SHEAR[:, 0], SHEAR[:, 1]), 0.0, 0.0])
                rate = np.zeros(3)
                for a, omega, k, direction, phase, _ in rows_of(parts.waves) if parts.waves is not None else ():
                    ahead = np.array([np.cos(direction), np.sin(direction), 0.0])
                    angle = k * place @ ahead - omega * 2.3 + phase
                    size = a * omega * np.exp(k * min(place[2], 0.0))
                    flow = flow + size * (np.cos(angle) * ahead + np.array([0.0, 0.0, np.sin(angle)]))
                    rate = rate + omega * size * (np.sin(angle) * ahead - np.array([0.0, 0.0, np.cos(angle)]))
                relative = flow - v
                axis, cn, ct = (
                    e,
                    p["cable.normal_drag_coefficient"] * diameter * length,
                    p["cable.tangential_drag_coefficient"] * diameter * length,
                )
                if body:
                    tilt = p["tow.body_angle"]
                    axis, cn, ct = np.array([-np.sin(tilt), 0.0, -np.cos(tilt)]), p["body.drag_area"], p["tow.drag_area_axial"]
                along = relative @ axis
                across = relative - along * axis
                drag = cn * np.linalg.norm(across) * across + ct * abs(along) * along * axis
                if body and abs(p["tow.body_angle"]) > np.pi:
                    drag = p["body.drag_area"] * np.linalg.norm(relative) * relative
                displaced = 1025.0 * p["body.volume"] + np.array([p["body.added_mass"]] * 2 + [p["tow.added_mass_vertical"]])
                push = displaced * rate
                if not body:
                    displaced = 1025.0 * np.pi / 4.0 * p["cable.diameter"] ** 2 * p["cable.length"] * weight
                    added = c.added * (1.0 - c.contraction * u) ** 2 * length * weight
                    push = displaced * rate + added * (rate - rate @ e * e)
                powers.append((0.5 * 1025.0 * weight * drag + push) @ v)
        assert sum(powers) == pytest.approx(gain, abs=1e-11 * sum(map(abs, powers)))


def turned_run(parts, angle, count=30, **changes):
    """Outputs, turned back, of a run whose top motion, current and waves are turned by `angle` about the vertical."""
    cos, sin = np.cos(angle), np.sin(angle)
    turn = np.array([[cos, -sin, 0.0], [sin, cos, 0.0], [0.0, 0.0, 1.0]])
    current = parts.current.copy()
    current[:, 1:] = current[:, 1:] @ turn[:2, :2].T
    waves = turned_sea(parts.waves, angle)
    model = tow(parts._replace(current=current, waves=waves), **changes)
    base = circling(1.0, 0.9, 4.0)

    def motion(t):
        at = base(t)
        return np.concatenate([turn @ at[i : i + 3] for i in (0, 3, 6)])

    rows = []

    def see(_):
        o = model.outputs
        rows.append(np.concatenate([turn.T @ o[0:3], o[3:5], turn.T @ o[5:8], turn.T @ o[8:11], o[11:15]]))

    model.initialize(motion(0.0))
    follow(model, motion, 0.1, count, see=see)
    return np.array(rows), model


def test_a_motion_in_one_plane_is_that_of_the_plane_model():
    flat, _ = turned_run(WET._replace(waves=WAVES), 0.0)
    free, _ = turned_run(SPACE._replace(waves=WAVES), 0.0)
    assert free == pytest.approx(flat, rel=1e-10, abs=1e-10)
    assert np.ptp(flat[:, 5]) > 0.1  # it moved


def test_turning_a_scene_about_the_vertical_turns_the_answer():
    parts = SPACE._replace(waves=turned_sea(WAVES, 0.4))
    before, _ = turned_run(parts, 0.0)
    for angle in (0.7, 2.9):
        after, _ = turned_run(parts, angle)
        assert after == pytest.approx(before, rel=1e-9, abs=1e-9)
    assert np.ptp(before[:, 6]) > 0.01  # out of the plane


@pytest.mark.parametrize("tilt", [0.2, 0.9, 1.4])
def test_conical_pendulum(tilt):
    """A body on a massless cable circles at omega^2 = g/(L cos tilt), its stretch M g/(k cos tilt); it comes round to where it began."""
    p = {
        "cable__axial_stiffness": 1e6,
        "tow__reference_tension": 0.0,
        "tow__poisson_ratio": 0.0,
        "cable__axial_damping": 0.0,
        "solver__tolerance": 1e-10,
    }
    model = tow(DRY._replace(space=True, cable_mass=None), **p, cable__mass_per_length=1e-9)
    model.initialize(still())
    stretch = 150.0 * 9.81 / np.cos(tilt) / (1e6 / 60.0)
    length = 60.0 + stretch
    omega = np.sqrt(9.81 / (length * np.cos(tilt)))
    e = np.array([np.sin(tilt), 0.0, -np.cos(tilt)])
    model.set_motion(e, omega * np.array([0.0, np.sin(tilt), 0.0]), stretch, 0.0)
    follow(model, lambda t: still(), 2.0 * np.pi / omega / 16, 16)
    assert model.state[tow_space.DIRECTION : tow_space.DIRECTION + 3] == pytest.approx(e, abs=1e-7)
    assert model["top.tension"] == pytest.approx(150.0 * 9.81 / np.cos(tilt), rel=1e-7)


def test_rest_in_a_current_that_turns_with_depth_stays_at_rest():
    current = np.array([[-80.0, 0.0, 0.6], [-30.0, 0.5, 0.4], [0.0, 1.2, 0.0]])
    model = tow(SPACE._replace(current=current))
    model.initialize(still())
    start = model.outputs.copy()
    assert start[6] > 1.0 and start[5] > 1.0
    follow(model, lambda t: still(), 0.5, 10)
    assert model.outputs[:12] == pytest.approx(start[:12], rel=1e-6, abs=1e-5)


def test_the_whole_force_of_a_sideways_current_is_that_of_the_same_current_along_x():
    along, across = (tow(SPACE._replace(current=np.array([[0.0, *flow]]))) for flow in ((0.8, 0.0), (0.0, 0.8)))
    for model in (along, across):
        model.initialize(still())
    assert across["top.force_y"] == pytest.approx(along["top.force_x"], rel=1e-12)
    assert across["body.y"] == pytest.approx(along["body.x"], rel=1e-12)


def test_state_saved_and_restored_in_space_is_bit_identical():
    model = tow(SPACE._replace(waves=turned_sea(WAVES, 0.4)))
    motion = circling(1.0, 0.9, 4.0)
    model.initialize(motion(0.0))
    follow(model, motion, 0.1, 7)
    saved = model.state.copy()
    follow(model, motion, 0.1, 5, start=0.7)
    first = model.state.copy()
    model.state[:] = saved
    follow(model, motion, 0.1, 5, start=0.7)
    assert np.array_equal(model.state, first)


def test_scenes_choose_space():
    scene = with_values(load("towed_body"), {"cable.bending_stiffness": 0.0})
    assert TowCable(with_values(scene, {"solver.space": True})).parts.space is True
    assert TowCable(scene).parts.space is None
    with pytest.raises(ParameterError, match="as_printed"):
        with_values(scene, {"solver.space": True, "tow.as_printed": True})
