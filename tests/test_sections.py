"""A cable in sections and with bodies on it: catenaries in pieces, pulses at joints, no difference where there should be none, balances."""

from __future__ import annotations

import dataclasses
import itertools
import tomllib
from pathlib import Path

import numpy as np
import pytest
from chain_support import Motion, drive, every, make, still, swing, view
from driven_support import OTHER_WAY_ROUND, about, inputs, run
from scipy.integrate import solve_ivp
from scipy.optimize import fsolve

from cable_model import CableChain, TowCable, simulate
from cable_model.errors import ParameterError
from cable_model.parameters import Section
from cable_model.scene import from_dict, to_toml, with_values
from cable_model.sections import pieces, whole
from cable_model.signals import OUTPUTS
from cable_model.studies.settings import METHODS, methods

GRAVITY, DENSITY = 9.80665, 1025.0
WET = {"density": DENSITY, "surface": False}
CHAIN = {
    "length": 150.0, "mass_per_length": 100.0, "axial_stiffness": 8e8, "diameter": 0.1, "volume_per_length": 0.0127,
    "normal_drag_coefficient": 2.0, "added_mass_coefficient": 1.0,
}  # fmt: skip
ROPE = {
    "length": 250.0, "mass_per_length": 6.0, "axial_stiffness": 2e6, "diameter": 0.08, "normal_drag_coefficient": 1.2,
    "added_mass_coefficient": 1.0,
}  # fmt: skip
UPPER = {**CHAIN, "length": 80.0, "mass_per_length": 80.0, "axial_stiffness": 6e8, "diameter": 0.09, "volume_per_length": 0.0102}
WIRE = {"length": 300.0, "mass_per_length": 6.0, "axial_stiffness": 2e7, "diameter": 0.05, "normal_drag_coefficient": 1.2}
FLOAT, CLUMP = {"mass": 300.0, "volume": 1.5, "drag_area": 1.0, "added_mass": 500.0}, {"mass": 3000.0, "volume": 0.4}


def weights(cable) -> tuple[list[tuple[float, float, float]], list[float]]:
    """Rows of weight in water (N/m), stiffness and length of the pieces from the lower end up, and the body's weight below each, N."""
    rows, above = pieces(cable)
    below = [0.0] * (len(rows) + 1)
    for k, body in zip(above, cable.body, strict=True):
        below[k] += (body.mass - DENSITY * body.volume) * GRAVITY
    made = [((row.mass_per_length - DENSITY * row.displaced_area) * GRAVITY, row.axial_stiffness, row.length) for row in rows]
    return made, below


def catenary(cable, guess: tuple[float, float], span: float, rise: float) -> tuple[float, float, float, list[tuple[float, float]]]:
    """Horizontal force, vertical ones at the lower end and the top, and the joints, of elastic catenaries one after the other [Irvine]."""
    made, below = weights(cable)

    def ends(unknown: np.ndarray) -> tuple[float, float, float, list[tuple[float, float]]]:
        h, v = unknown
        x, z, joints = 0.0, 0.0, []
        for (weight, stiffness, length), hung in zip(made, below, strict=False):
            v = v + hung
            up = v + weight * length
            x += h * length / stiffness + h / weight * (np.arcsinh(up / h) - np.arcsinh(v / h))
            z += (np.hypot(h, up) - np.hypot(h, v)) / weight + (up * up - v * v) / (2.0 * weight * stiffness)
            v = up
            joints.append((x, z))
        return x, z, v, joints

    found, _, status, text = fsolve(lambda u: np.array(ends(u)[:2]) - (span, rise), guess, xtol=1e-13, full_output=True)
    assert status == 1, text
    _, _, up, joints = ends(found)
    return found[0], found[1], up, joints


MOORINGS = {
    "chain, rope, chain": ({"section": [CHAIN, ROPE, UPPER]}, 420.0, 180.0),
    "a float on a line": ({**WIRE, "body": [{"at": 120.0, **FLOAT}]}, 150.0, 150.0),
    "a clump on a line": ({**WIRE, "body": [{"at": 120.0, **CLUMP}]}, 230.0, 150.0),
    "chain and rope with a float above their joint": (
        {"section": [{**CHAIN, "length": 100.0}, ROPE], "body": [{"at": 140.0, **FLOAT}, {"at": 140.0, "mass": 20.0}]}, 250.0, 190.0,
    ),
}  # fmt: skip


@pytest.mark.parametrize("space", [False, pytest.param(True, marks=pytest.mark.long)])
@pytest.mark.parametrize("name", MOORINGS)
def test_at_rest_it_hangs_in_catenaries_one_after_the_other(name, space):
    """Force, tensions and joints, of second order in the cells."""
    cable, span, rise = MOORINGS[name]
    base = {"cable": cable, "lower_end": {"anchored": True, "x": -span, "z": -rise}, "water": WET}
    for nodes in (21, 41) if space else (21, 41, 81):
        scene = from_dict({**base, "solver": {"nodes": nodes, "space": space}})
        model = CableChain(scene)
        model.initialize(still()(0.0))
        found = dict(zip(OUTPUTS, model.outputs, strict=True))
        total = sum(weight * length for weight, _, length in weights(scene.cable)[0]) + sum(weights(scene.cable)[1])
        h, low, up, joints = catenary(scene.cable, (-found["top.force_x"], -found["top.force_z"] - total), span, rise)
        size = np.hypot(h, up)
        assert -model.outputs[[0, 2]] == pytest.approx([h, up], abs=2.0 / nodes**2 * size)
        assert found["body.tension"] == pytest.approx(np.hypot(h, low), abs=4.0 / nodes**2 * size)
        arcs = np.concatenate([[0.0], np.cumsum(view(model).mesh[:, 0])])
        places = model.positions()[:, [0, 2]] + (span, rise)
        for arc, joint in zip(np.cumsum([row.length for row in pieces(scene.cable)[0]]), joints, strict=True):
            k = int(np.argmin(np.abs(arcs - arc)))
            assert arcs[k] == pytest.approx(arc, rel=1e-9)
            assert places[k] == pytest.approx(joint, abs=5.0 / nodes**2 * scene.cable.length)


def pulse(size: float, duration: float, axis: int) -> Motion:
    """A top that goes aside and back, with three continuous derivatives."""

    def motion(t: float) -> np.ndarray:
        state, s = np.zeros(9), t / duration
        if 0.0 < s < 1.0:
            b, c = s * (1.0 - s), 1.0 - 2.0 * s
            state[axis] = 256.0 * size * b**4
            state[3 + axis] = 1024.0 * size * b**3 * c / duration
            state[6 + axis] = 256.0 * size * (12.0 * b * b * c * c - 8.0 * b**3) / duration**2
        return state

    return motion


TAUT, EA = 1e4, 1e7  # N


def field(cable: dict, nodes: int, fastest: float, length: float, duration: float, motion: Motion, axis: int):
    """Displacements of the nodes of a taut cable, 100 m long, and their arc lengths, after a motion of its top."""
    base = {
        "cable": {**cable, "compressible": True}, "lower_end": {"anchored": True, "z": -length}, "environment": {"gravity": 0.0},
        "solver": {"nodes": nodes, "lambda_infinity": -0.9},
    }  # fmt: skip
    count = int(np.ceil(duration / (50.0 / (nodes - 1) / fastest)))
    step = duration / count
    model = make(base, solver__time_step=1.0001 * step)
    model.initialize(motion(0.0))
    before = model.positions()
    for k in range(count):
        model.advance(k * step, step, motion(k * step), motion((k + 1) * step))
    return (model.positions() - before)[:, axis], np.concatenate([[0.0], np.cumsum(view(model).mesh[:, 0])])


@pytest.mark.parametrize(
    ("mass", "stiffer", "axis"), [(4.0, 1.0, 0), (1.0 / 9.0, 1.0, 0), (4.0, 0.25, 2), (1.0, 10.0, 2)],
    ids=["across, heavy", "across, light", "along, heavy and soft", "along, stiff"],
)  # fmt: skip
def test_a_pulse_goes_on_and_back_at_a_joint_as_the_impedances_say(mass, stiffer, axis):
    """Reflected (Z2 - Z1)/(Z2 + Z1) and passed on 2 Z2/(Z1 + Z2), Z = sqrt(T m) across the cable and sqrt(EA m) along it."""
    lower = TAUT / (1.0 + TAUT / (EA * stiffer)) if axis == 0 else EA * stiffer
    upper = TAUT / (1.0 + TAUT / EA) if axis == 0 else EA
    slow, fast = np.sqrt(lower / mass), np.sqrt(upper)
    z1, z2 = np.sqrt(lower * mass), np.sqrt(upper)
    fastest = max(slow, fast)
    motion, duration = pulse(1e-3, 30.0 / fastest, axis), 50.0 / fast + 45.0 / fastest
    cable = {
        "section": [
            {"length": 50.0, "mass_per_length": mass, "axial_stiffness": EA * stiffer},
            {"length": 50.0, "mass_per_length": 1.0, "axial_stiffness": EA},
        ]
    }
    errors = []
    for nodes in (101, 201):
        length = 50.0 * (2.0 + TAUT / EA + TAUT / (EA * stiffer))
        moved, arcs = field(cable, nodes, fastest, length, duration, motion, axis)
        at_joint = duration - 50.0 / fast

        def expected(s: float, at_joint: float = at_joint) -> float:
            if s < 50.0:
                return 2.0 * z2 / (z1 + z2) * motion(at_joint - (50.0 - s) / slow)[axis]
            back = (z2 - z1) / (z2 + z1) * motion(at_joint - (s - 50.0) / fast)[axis]
            return motion(duration - (100.0 - s) / fast)[axis] + back

        errors.append(np.abs(moved - [expected(s) for s in arcs]).max() / 1e-3)
    assert errors[0] < 0.08 and np.log2(errors[0] / errors[1]) > 1.9


@pytest.mark.parametrize("mass", [2.0, 20.0])
def test_a_pulse_goes_past_a_bead_as_its_inertia_says(mass):
    """M y'' = 2 Z (g' - y') for a string of impedance Z on either side, on which g comes in."""
    pull = TAUT / (1.0 + TAUT / EA)
    speed, z = np.sqrt(pull), np.sqrt(pull)
    motion, duration = pulse(1e-3, 20.0 / speed, 0), 95.0 / speed
    late = 50.0 / speed
    solved = solve_ivp(
        lambda t, y: [y[1], 2.0 * z / mass * (motion(t - late)[3] - y[1])], (0.0, duration), [0.0, 0.0], rtol=1e-10, atol=1e-14,
        dense_output=True, max_step=0.4 / speed,
    )  # fmt: skip

    def bead(t: float) -> float:
        return solved.sol(t)[0] if t > 0.0 else 0.0

    def expected(s: float) -> float:
        if s < 50.0:
            return bead(duration - (50.0 - s) / speed)
        there = duration - (s - 50.0) / speed
        return motion(duration - (100.0 - s) / speed)[0] + bead(there) - motion(there - late)[0]

    errors = []
    cable = {"length": 100.0, "mass_per_length": 1.0, "axial_stiffness": EA, "body": [{"at": 50.0, "mass": mass}]}
    for nodes in (101, 201):
        moved, arcs = field(cable, nodes, speed, 100.0 * (1.0 + TAUT / EA), duration, motion, 0)
        errors.append(np.abs(moved - [expected(s) for s in arcs]).max() / 1e-3)
    assert errors[0] < 0.08 and np.log2(errors[0] / errors[1]) > 1.9


ALIKE = {  # a mooring with all that the staggered grid has, on equal cells
    "cable": {
        "length": 60.0, "mass_per_length": 3.0, "axial_stiffness": 1e6, "diameter": 0.05, "normal_drag_coefficient": 1.2,
        "tangential_drag_coefficient": 0.03, "added_mass_coefficient": 1.0, "bending_stiffness": 20.0, "axial_damping": 1e3,
        "quadratic_damping": 10.0,
    },
    "lower_end": {"anchored": True, "z": -20.0},
    "water": {},
    "current": {"speed": 0.3},
    "waves": {"amplitude": 0.3, "period": 5.0},
    "seabed": {"level": -20.0, "stiffness": 1e5, "friction_coefficient": 0.4},
    "top": {"position": [52.0, 0.0, 0.2]},
    "solver": {"nodes": 31, "time_step": 0.05, "audit": True},
}  # fmt: skip
MOVING = about((52.0, 0.0, 0.2), (0.5, 0.0, 0.6), 1.1)


def in_three(base: dict) -> dict:
    """The same scene with its cable in three sections that are alike."""
    shared = {field.name for field in dataclasses.fields(Section)}
    alike = {name: value for name, value in base["cable"].items() if name in shared and name != "length"}
    rest = {name: value for name, value in base["cable"].items() if name not in shared}
    third = {"length": base["cable"]["length"] / 3.0}
    return {**base, "cable": {**rest, **alike, "section": [third, third, {**third, **alike}]}}


def test_sections_that_are_alike_are_one_cable():
    one, three = (drive(make(base), every(0.05, 6.0), MOVING) for base in (ALIKE, in_three(ALIKE)))
    for name in OUTPUTS:
        size = max(np.abs(one[name]).max(), 1e-9)
        assert np.abs(one[name] - three[name]).max() < 1e-6 * size, name


LIFTED = {  # a line between two ships, heavy at one end, with a clump and a float
    "cable": {
        "section": [
            {"length": 40.0, "mass_per_length": 20.0, "axial_stiffness": 2e7, "diameter": 0.04, "bending_stiffness": 4e3},
            {"length": 60.0, "mass_per_length": 2.0, "axial_stiffness": 3e6, "diameter": 0.05, "bending_stiffness": 1e3},
            {"length": 20.0, "mass_per_length": 5.0, "axial_stiffness": 5e6, "diameter": 0.06, "bending_stiffness": 0.0},
        ],
        "normal_drag_coefficient": 1.2, "tangential_drag_coefficient": 0.02, "added_mass_coefficient": 1.0,
        "body": [
            {"at": 25.0, "mass": 300.0, "volume": 0.05, "drag_area": 0.3, "added_mass": 40.0},
            {"at": 80.0, "mass": 30.0, "volume": 0.06, "drag_area": 0.3, "added_mass": 30.0},
        ],
    },
    "water": {"density": 1025.0, "surface": False},
    "current": {"speed": 0.4},
    "lower_end": {"anchored": True, "driven": True},
    "solver": {"nodes": 37, "time_step": 0.02, "grading": 1.0},
}  # fmt: skip


def turned(base: dict) -> dict:
    """The same cable with its other end up."""
    cable = dict(base["cable"])
    length = sum(section["length"] for section in cable["section"])
    cable["section"] = cable["section"][::-1]
    cable["body"] = [{**body, "at": length - body["at"]} for body in cable["body"]]
    return {**base, "cable": cable}


BOTTOM = {"seabed__level": -30.0, "seabed__stiffness": 1e4, "seabed__friction_coefficient": 0.5, "current__speed": 0.0}


@pytest.mark.parametrize("changes", [pytest.param({}, marks=pytest.mark.long, id="hanging"), pytest.param(BOTTOM, id="on the bottom")])
def test_it_makes_no_difference_which_end_of_it_is_called_the_top(changes):
    far = (100.0, 0.0, -12.0)
    moved, fixed = about((0.0, 0.0, -2.0), (0.8, 0.0, 0.6), 0.6), still(far)
    one = run(make(LIFTED, **changes), inputs(moved, fixed), 0.02, 6.0)
    other = run(make(turned(LIFTED), **changes), inputs(fixed, moved), 0.02, 6.0)
    for here, there in OTHER_WAY_ROUND:
        size = np.abs(one[:, here]).max()
        assert np.abs(one[:, here] - other[:, there]).max() < (2e-3 if changes else 2e-4) * size


def test_what_its_balances_lack_falls_with_the_square_of_the_step():
    """Of energy and momentum, with all that sections and bodies have, on a seabed and through the surface."""
    sections = [
        {**ALIKE["cable"], "length": 25.0, "mass_per_length": 12.0, "axial_stiffness": 3e6, "diameter": 0.03},
        {**ALIKE["cable"], "length": 35.0, "bending_stiffness": 60.0, "axial_damping": 3e3, "diameter": 0.08},
    ]
    for section in sections:
        del section["quadratic_damping"]
    cable = {
        "section": sections, "quadratic_damping": 10.0,
        "body": [
            {"at": 40.0, "mass": 50.0, "volume": 0.06, "drag_area": 0.2, "added_mass": 20.0}, {"at": 54.0, "mass": 5.0, "volume": 0.02},
        ],
    }  # fmt: skip
    lacking = []
    for step in (0.02, 0.01):
        model = make({**ALIKE, "cable": cable}, solver__time_step=step, solver__nodes=41, solver__lambda_infinity=-1.0)
        found = drive(model, every(step, 6.0), MOVING)
        assert model.audit is not None
        lacking.append((np.abs(found["audit.energy"]).max() / model.audit.exchanged, found["audit.momentum"][-1] / model.audit.forces))
    assert max(lacking[1]) < 5e-3
    assert all(coarse > 2.8 * fine for coarse, fine in zip(*lacking, strict=True)), lacking


def test_the_whole_of_a_cable_is_what_its_sections_are_in_sum():
    sections = (Section(**CHAIN), Section(**ROPE), Section(**UPPER))
    of_all = whole(sections)
    assert of_all["length"] == 480.0
    assert of_all["mass_per_length"] * 480.0 == pytest.approx(150.0 * 100.0 + 250.0 * 6.0 + 80.0 * 80.0)
    assert 480.0 / of_all["axial_stiffness"] == pytest.approx(150.0 / 8e8 + 250.0 / 2e6 + 80.0 / 6e8)
    drag = sum(s.length * s.diameter * s.normal_drag_coefficient for s in sections)
    assert of_all["normal_drag_coefficient"] * of_all["diameter"] * 480.0 == pytest.approx(drag)


def test_sections_take_what_they_do_not_give_from_the_cable_and_come_back_as_they_were_written():
    scene = from_dict(
        {"cable": {"axial_stiffness": 1e6, "section": [{"length": 2.0, "mass_per_length": 1.0}, {**ROPE, "axial_stiffness": 2e6}]}}
    )
    assert [section.axial_stiffness for section in scene.cable.section] == [1e6, 2e6]
    text = to_toml(scene)
    assert from_dict(tomllib.loads(text)) == scene and "cable.length" not in text and tomllib.loads(text)["cable"].keys() == {"section"}


TWO = {"section": [CHAIN, ROPE]}
WRONG = [
    ({**TWO, "length": 300.0}, {}, "cable.length = 300 m: must be 400, that of its sections. Remove it, or mend the sections."),
    (
        {**TWO, "diameter": 0.3}, {},
        "cable.diameter: every section has its own. Remove it from [cable], or from the sections that share it.",
    ),
    ({"section": [CHAIN, {"length": 3.0}]}, {}, "cable.section[1].mass_per_length: missing. Give the mass per unstretched length."),
    ({"section": [{**CHAIN, "lenght": 3.0}]}, {}, "cable.section[0].lenght: unknown key. Did you mean 'cable.section[0].length'? Known: "),
    (
        {"section": [CHAIN, {**ROPE, "diameter": 0.0}]}, {},
        "cable.section[1].diameter = 0 m: must be > 0 in water or on a seabed. Give the diameter.",
    ),
    (
        TWO, {"solver": {"nodes": 4}},
        "solver.nodes = 4: must be >= 5 with 2 lengths of cable between joints and bodies. Give more nodes.",
    ),
    (
        TWO, {"winch": {"fitted": True}},
        "winch.fitted = True: must be false with sections or bodies on the cable. Leave the winch out, or make the cable alike all along.",
    ),
    (
        {**WIRE, "body": [{"at": 300.0, "mass": 1.0}]}, {},
        "cable.body[0].at = 300 m: must be between 0 and cable.length = 300. An end's is in [body].",
    ),
    (
        TWO, {"solver": {"grid": "box"}},
        'cable.section = 2 rows: must be empty on the box grid. Set solver.grid = "staggered".',
    ),
    (
        {**TWO, "stiffness_curve": [[0.0, 0.0], [0.1, 1e5]]}, {},
        "cable.stiffness_curve = 2 rows: must be empty beside sections or bodies on the cable. Give axial_stiffness.",
    ),
    ({"section": [CHAIN, 3]}, {}, "cable.section[1] = 3: must be a table. "),
    ({"section": 3}, {}, "cable.section = 3: must be a list of tables. Write each as [[cable.section]]."),
]  # fmt: skip


@pytest.mark.parametrize(("cable", "more", "text"), WRONG)
def test_sections_and_bodies_that_cannot_be_are_refused(cable, more, text):
    with pytest.raises(ParameterError) as refused:
        from_dict({"cable": cable, "water": {}, **more})
    assert str(refused.value).startswith(text)


def test_tow_cable_refuses_sections():
    with pytest.raises(ParameterError, match=r"^cable\.section = 2 rows: must be empty for TowCable\. Use CableChain\."):
        TowCable(from_dict({"cable": {"section": [CHAIN, ROPE]}}))


def test_a_value_of_the_whole_cable_cannot_be_changed_beside_its_sections():
    scene = from_dict({"cable": {"section": [CHAIN, ROPE]}})
    assert with_values(scene, {"solver.nodes": 31}).cable == scene.cable
    assert with_values(scene, {"cable.section": [CHAIN]}).cable.length == CHAIN["length"]
    with pytest.raises(ParameterError, match=r"^cable\.mass_per_length: is of the cable's sections in this scene\. Give cable\.section"):
        with_values(scene, {"cable.mass_per_length": 3.0})
    with pytest.raises(ParameterError, match=r"^cable\.mass_per_length = 3: must be 41\.25, that of its sections\."):
        dataclasses.replace(scene, cable=dataclasses.replace(scene.cable, mass_per_length=3.0))


def test_arc_lengths_go_over_all_sections():
    model = make({"cable": MOORINGS["chain and rope with a float above their joint"][0], "water": WET, "solver": {"nodes": 21}})
    model.initialize(still()(0.0))
    arcs = model.arc_lengths()
    assert arcs[-1] == pytest.approx(350.0) and np.all(np.diff(arcs) > 0.0)
    assert min(abs(arcs - 100.0)) < 1e-9 and min(abs(arcs - 140.0)) < 1e-9


def test_the_scene_of_the_guide_is_one():
    page = (Path(__file__).parents[1] / "docs" / "how_to" / "sections.md").read_text(encoding="utf-8")
    scene = from_dict(tomllib.loads(page.split("```toml\n")[1].split("```")[0]))
    assert len(scene.cable.section) == 2 and len(pieces(scene.cable)[0]) == 3


def two_segments(lengths, bodies, top: Motion, times: np.ndarray) -> np.ndarray:
    """Places (times, 2, 2), x and z, of bodies on two straight massless segments under a moved top, from rest straight down.

    By Lagrange with the angles theta of both segments from straight down: r_i = r_top + sum_(j <= i) l_j (sin theta_j, -cos theta_j), and
    sum_i (m_i + m_a,i) a_i . dr_i/dtheta_j = sum_i F_i . dr_i/dtheta_j with weight in water and drag of each body in water at rest.
    """
    masses = np.array([body["mass"] + body["added_mass"] for body in bodies])
    drags = np.array([0.5 * DENSITY * body["drag_area"] for body in bodies])
    loads = np.array([-(body["mass"] - DENSITY * body["volume"]) * GRAVITY for body in bodies])

    def along(theta: np.ndarray) -> np.ndarray:
        """l_j (cos theta_j, sin theta_j): derivatives of all places below joint j."""
        return lengths[:, None] * np.column_stack((np.cos(theta), np.sin(theta)))

    def rates(t: float, state: np.ndarray) -> np.ndarray:
        theta, omega = state[:2], state[2:]
        at = top(t)
        turn, toward = along(theta), lengths[:, None] * np.column_stack((-np.sin(theta), np.cos(theta)))
        matrix, right = np.zeros((2, 2)), np.zeros(2)
        for i in range(2):
            v = at[[3, 5]] + omega[: i + 1] @ turn[: i + 1]
            force = -drags[i] * np.linalg.norm(v) * v + (0.0, loads[i])
            force = force - masses[i] * (at[[6, 8]] + omega[: i + 1] ** 2 @ toward[: i + 1])
            for j in range(i + 1):
                right[j] += force @ turn[j]
                for k in range(i + 1):
                    matrix[j, k] += masses[i] * turn[j] @ turn[k]
        return np.concatenate([omega, np.linalg.solve(matrix, right)])

    angles = solve_ivp(rates, (0.0, times[-1]), np.zeros(4), t_eval=times, rtol=1e-9, atol=1e-12).y[:2].T
    steps = lengths[None, :, None] * np.stack((np.sin(angles), -np.cos(angles)), axis=-1)
    return np.array([top(t)[[0, 2]] for t in times])[:, None, :] + np.cumsum(steps, axis=1)


def test_a_body_at_mid_length_swings_as_the_lower_of_two_segments_says():
    """Wang's own next step from two degrees of freedom: a body along the cable."""
    upper = {"mass": 120.0, "volume": 0.02, "drag_area": 0.2, "added_mass": 10.0}
    lower = {"mass": 300.0, "volume": 0.1, "drag_area": 0.4, "added_mass": 60.0}
    base = {
        "cable": {"length": 50.0, "mass_per_length": 1e-4, "axial_stiffness": 1e8, "diameter": 1e-5, "body": [{"at": 30.0, **upper}]},
        "body": lower, "water": WET, "solver": {"nodes": 5, "time_step": 0.01, "slack_damping": 0.0},
    }  # fmt: skip
    top, times = swing((3.0, 0.0, 0.5), 0.6, ramp_time=6.0), every(0.01, 40.0)
    model = make(base)
    model.initialize(top(0.0))
    places = [model.positions()[[2, 0]][:, [0, 2]]]
    for before, after in itertools.pairwise(times):
        model.advance(before, after - before, top(before), top(after))
        places.append(model.positions()[[2, 0]][:, [0, 2]])
    right = two_segments(np.array([20.0, 30.0]), (upper, lower), top, times)
    size = np.ptp(right[:, 1, 0])
    assert size > 2.0 and np.abs(np.array(places) - right).max() < 1e-3 * size


def test_tensions_at_joints_and_bodies_are_those_of_what_hangs_below():
    """Where the tension jumps it is the larger one that is told, and the largest is at a joint below a float."""
    sections = [{**CHAIN, "length": 20.0}, {**ROPE, "length": 30.0}]
    bodies = [{"at": 20.0, **FLOAT}, {"at": 35.0, "mass": 100.0}]
    base = {"cable": {"section": sections, "body": bodies}, "body": {"mass": 4000.0}, "water": WET}
    for nodes in (9, 17, 33):
        model = make(base, solver__nodes=nodes)
        model.initialize(still()(0.0))
        made, hung = weights(model.scene.cable)
        loads = np.cumsum([4000.0 * GRAVITY, *np.ravel([(w * length, b) for (w, _, length), b in zip(made, hung[1:], strict=True)])])
        arcs, tensions = model.arc_lengths(), model.nodes()[:, 3]
        at = [tensions[np.argmin(np.abs(arcs - place))] for place in (0.0, 20.0, 35.0, 50.0)]
        assert at == pytest.approx([loads[0], max(loads[1:3]), max(loads[3:5]), loads[5]], rel=1e-6)
        assert model.outputs[OUTPUTS.index("cable.tension_max")] == pytest.approx(loads.max(), rel=1e-6)


def test_a_clump_on_a_seabed_sinks_in_as_deep_as_the_cable_whatever_the_mesh():
    """w/(K d), with the weight and the diameter of the cable about it."""
    clump = {"at": 20.0, "mass": 500.0, "volume": 0.1}
    cable = {"length": 80.0, "mass_per_length": 5.0, "axial_stiffness": 1e6, "diameter": 0.04, "body": [clump]}
    base = {
        "cable": cable, "water": {}, "lower_end": {"anchored": True, "x": -70.0, "z": -30.0}, "seabed": {"level": -30.0, "stiffness": 1e5},
    }  # fmt: skip
    depth = (5.0 - DENSITY * np.pi / 4.0 * 0.04**2) * GRAVITY / (1e5 * 0.04)
    for nodes in (21, 41, 81):
        model = make(base, solver__nodes=nodes)
        model.initialize(still((0.0, 0.0, -5.0))(0.0))
        place = np.argmin(np.abs(model.arc_lengths() - 20.0))
        assert -30.0 - model.positions()[place, 2] == pytest.approx(depth, rel=0.05)


def test_a_light_cable_with_a_float_between_two_anchors_arches_up():
    """Cells that can be pressed too: a V that hangs down would stand on its legs."""
    cable = {
        "length": 30.0, "mass_per_length": 1.0, "axial_stiffness": 1e5, "diameter": 0.02, "compressible": True,
        "body": [{"at": 15.0, "mass": 20.0, "volume": 0.2}],
    }  # fmt: skip
    model = make({"cable": cable, "water": WET, "lower_end": {"anchored": True, "x": -16.0, "z": -40.0}, "solver": {"nodes": 21}})
    model.initialize(still((0.0, 0.0, -40.0))(0.0))
    assert model.positions()[:, 2].max() == pytest.approx(-40.0 + np.sqrt(15.0**2 - 8.0**2), abs=0.3)
    assert model.outputs[OUTPUTS.index("cable.tension_min")] > 0.0


def test_error_control_follows_its_tolerance_with_sections_and_bodies():
    motion = swing((0.6, 0.0, 0.5), 1.3, ramp_time=3.0)
    base = {
        "cable": {"section": [{**ROPE, "length": 40.0}, {**WIRE, "length": 60.0}], "body": [{"at": 70.0, **CLUMP}]}, "water": WET,
        "body": {"mass": 200.0}, "solver": {"nodes": 33, "time_step": 0.5},
    }  # fmt: skip
    fine = drive(make(base, solver__time_step=0.0025), every(0.05, 12.0), motion)
    found = drive(make(base, solver__tolerance=1e-2), every(0.05, 12.0), motion)
    tension = fine["top.tension"]
    assert np.abs(found["top.tension"] - tension).max() < 5e-2 * np.ptp(tension)
    assert found["solver.steps"][-1] < 0.25 * fine["solver.steps"][-1]


def test_study_has_the_chain_for_a_cable_of_many_sections():
    scene = from_dict({"cable": {"section": [CHAIN, ROPE, UPPER, ROPE]}, "solver": {"nodes": 41}})
    assert set(methods(scene)) >= {name for name, changes in METHODS.items() if changes.get("solver.grid") != "box"}


BUOY = {"at": 40.0, "mass": 100.0, "volume": 0.5, "drag_area": 0.5, "added_mass": 150.0}


def test_a_float_on_the_cable_that_the_water_does_not_lift_is_told():
    """In waves that are held it is as wet as in still water, and above water without a surface it is in water."""
    cable = {"length": 50.0, "mass_per_length": 0.3, "axial_stiffness": 1e5, "diameter": 0.01, "body": [{**BUOY, "at": 30.0}]}
    base = {"cable": cable, "lower_end": {"anchored": True, "z": -20.0}, "solver": {"nodes": 31}}
    above = make({**base, "water": {"surface": False}})
    above.initialize(still((15.0, 0.0, -2.0))(0.0))
    assert "an end of the cable or a body at z" in str(above.warnings())
    held = make({**base, "water": {}, "waves": {"amplitude": 0.5}})
    held.initialize(still((15.0, 0.0, -2.0))(0.0))
    assert "the lower end or a body at z" in str(held.warnings())


@pytest.mark.long
def test_a_slack_pennant_under_a_float_gains_no_energy():
    """The slack law's width goes by what hangs from a length of cable, not by a float that others hold."""
    rope = {"mass_per_length": 0.3, "axial_stiffness": 1e5, "diameter": 0.01, "volume_per_length": 1e-4, "normal_drag_coefficient": 1.2}
    sections = [{**rope, "length": 40.0}, {**rope, "length": 30.0, "mass_per_length": 0.1, "volume_per_length": 7e-5}]
    scene = from_dict({
        "cable": {"section": sections, "added_mass_coefficient": 1.0, "body": [BUOY]},
        "lower_end": {"anchored": True, "x": -20.0, "z": -30.0},
        "seabed": {"level": -30.0, "stiffness": 1e5}, "water": {}, "waves": {"amplitude": 0.5, "period": 10.0, "surface": "wheeler"},
        "top": {"position": [10.0, 0.0, -1.0]}, "solver": {"nodes": 41, "time_step": 0.01, "audit": True}, "run": {"duration": 40.0},
    })  # fmt: skip
    run = simulate(CableChain(scene))
    assert run.audit is not None and run.audit.energy_share < 0.01
    assert run["cable.tension_max"].max() < 90.0


@pytest.mark.long
def test_a_cable_that_is_let_down_onto_the_bottom_in_a_heap_can_be_audited():
    base = {
        "cable": {"length": 14.0, "mass_per_length": 0.5, "axial_stiffness": 1e5, "diameter": 0.02, "volume_per_length": 1e-4},
        "body": {"mass": 30.0, "volume": 0.02}, "water": {"surface": False}, "seabed": {"level": -10.0, "stiffness": 1e6},
        "top": {"position": [0.0, 0.0, -2.0]}, "solver": {"nodes": 31, "time_step": 0.005}, "run": {"duration": 2.0, "output_step": 0.1},
    }  # fmt: skip
    plain, audited = (simulate(CableChain(from_dict({**base, "solver": {**base["solver"], "audit": audit}}))) for audit in (False, True))
    assert np.array_equal(plain["body.z"], audited["body.z"])
