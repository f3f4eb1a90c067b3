"""Static shapes of the chain against separately integrated continuous equilibria and closed forms."""

import numpy as np
import pytest
from catenaries import between_points
from chain_support import make, still, view
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

from cable_model.signals import OUTPUTS

TOWED = {  # the shipped scene `towed_body` without its motion
    "cable": {
        "length": 400.0, "diameter": 0.013, "mass_per_length": 0.68, "axial_stiffness": 9.5e6, "normal_drag_coefficient": 1.2,
        "tangential_drag_coefficient": 0.02, "added_mass_coefficient": 1.0,
    },
    "body": {"mass": 600.0, "volume": 0.15, "drag_area": 0.15, "added_mass": 150.0},
    "environment": {"gravity": 9.80665},
    "water": {"density": 1025.0},
    "current": {"speed": -2.0},
    "solver": {"nodes": 201},
}  # fmt: skip
GRAVITY, DENSITY = 9.80665, 1025.0


def drag_per_length(cable: dict, flow: np.ndarray, tangent: np.ndarray, stretch: float) -> np.ndarray:
    """Morison drag of water that moves at `flow` past a cable at rest, per unstretched length."""
    along = np.dot(flow, tangent) * tangent
    across = flow - along
    half = 0.5 * DENSITY * cable["diameter"] * np.sqrt(stretch)
    normal = cable["normal_drag_coefficient"] * np.linalg.norm(across) * across
    return half * (normal + cable["tangential_drag_coefficient"] * np.linalg.norm(along) * along)


def hang_down(scene: dict, flow_at, low: float) -> tuple[np.ndarray, np.ndarray]:
    """Lower end's force and the chord (x, z) from it to the top, for a lower end at depth z = low; plane."""
    cable, body = scene["cable"], scene["body"]
    wet = (cable["mass_per_length"] - DENSITY * np.pi / 4.0 * cable["diameter"] ** 2) * GRAVITY
    flow = flow_at(low)
    pull = 0.5 * DENSITY * body["drag_area"] * np.linalg.norm(flow) * flow[0]
    foot = np.array([-pull, (body["mass"] - DENSITY * body["volume"]) * GRAVITY])

    def slope(s: float, state: np.ndarray) -> np.ndarray:
        force = state[2:]
        size = np.linalg.norm(force)
        tangent, stretch = force / size, 1.0 + size / cable["axial_stiffness"]
        load = drag_per_length(cable, flow_at(low + state[1]), tangent, stretch) - np.array([0.0, wet])
        return np.concatenate([stretch * tangent, -load])

    end = solve_ivp(slope, (0.0, cable["length"]), [0.0, 0.0, *foot], rtol=1e-11, atol=1e-9, max_step=2.0).y[:, -1]
    return end[:2], end[2:]


def test_towed_body_hangs_as_the_continuous_equilibrium():
    chord, force = hang_down(TOWED, lambda z: np.array([-2.0, 0.0]), 0.0)
    model = make(TOWED)
    model.initialize(still()(0.0))
    assert model.positions()[0, [0, 2]] == pytest.approx(-chord, abs=1e-4 * 400.0)
    assert model.outputs[3] == pytest.approx(np.linalg.norm(force), rel=1e-4)
    assert model.outputs[[0, 2]] == pytest.approx(-force, abs=1e-4 * np.linalg.norm(force))


def test_towed_body_in_a_sheared_current_hangs_as_the_continuous_equilibrium():
    levels = [[-350.0, -0.4, 0.0], [-150.0, -1.0, 0.0], [0.0, -2.2, 0.0]]

    def flow(z: float) -> np.ndarray:
        return np.array([np.interp(z, [row[0] for row in levels], [row[1] for row in levels]), 0.0])

    low = brentq(lambda z: z + hang_down(TOWED, flow, z)[0][1], -399.0, -100.0, xtol=1e-9)
    chord, force = hang_down(TOWED, flow, low)
    model = make({**TOWED, "current": {"levels": levels}})
    model.initialize(still()(0.0))
    assert model.positions()[0, [0, 2]] == pytest.approx([-chord[0], low], abs=1e-4 * 400.0)
    assert model.outputs[3] == pytest.approx(np.linalg.norm(force), rel=1e-4)


def test_cable_towed_without_a_body_is_straight_at_its_critical_angle():
    scene = {part: values for part, values in TOWED.items() if part != "body"}
    cable = scene["cable"]
    wet = (cable["mass_per_length"] - DENSITY * np.pi / 4.0 * cable["diameter"] ** 2) * GRAVITY

    def load(angle: float) -> tuple[float, float]:
        """Weight and drag along and across a cable that streams at `angle` below the horizontal, tangent towards the top."""
        tangent = np.array([np.cos(angle), np.sin(angle)])
        total = drag_per_length(cable, np.array([-2.0, 0.0]), tangent, 1.0) - np.array([0.0, wet])
        return -np.dot(total, tangent), np.dot(total, [-tangent[1], tangent[0]])

    angle = brentq(lambda a: load(a)[1], 0.01, 1.5)
    model = make(scene)
    model.initialize(still()(0.0))
    shape = model.positions()
    expected = -400.0 * np.array([np.cos(angle), np.sin(angle)])
    assert shape[0, [0, 2]] == pytest.approx(expected, abs=1e-4 * 400.0)
    assert model.outputs[3] == pytest.approx(400.0 * load(angle)[0], rel=1e-4)
    aside = shape[:, 0] * expected[1] - shape[:, 2] * expected[0]
    assert np.max(np.abs(aside)) < 1e-4 * 400.0**2


@pytest.mark.parametrize("stiffness", [1e9, 500.0], ids=["stiff", "elastic"])
def test_cable_between_two_points_is_the_elastic_catenary(stiffness):
    base = {
        "cable": {"length": 10.0, "mass_per_length": 1.0, "axial_stiffness": stiffness},
        "environment": {"gravity": 10.0},
        "lower_end": {"anchored": True},
        "solver": {"nodes": 201},
    }
    model = make(base)
    model.initialize(still((7.0, 0.0, 3.0))(0.0))
    h, v = between_points(10.0, 10.0, stiffness, 7.0, 3.0)
    assert model.outputs[0] == pytest.approx(-h, rel=1e-4)
    assert model.outputs[2] == pytest.approx(-v, rel=1e-4)
    assert model.outputs[11] == pytest.approx(np.hypot(h, v - 100.0), rel=1e-3)
    assert model.positions()[0] == pytest.approx([0.0, 0.0, 0.0], abs=1e-9)


@pytest.mark.parametrize("grid", ["staggered", "box"])
@pytest.mark.parametrize("nodes", [5, 11, 51])
@pytest.mark.parametrize(
    ("length", "stiffness", "mass", "span", "rise"),
    [(85.0, 1e6, 2.0, 40.0, 55.0), (6000.0, 4e8, 25.0, 3000.0, 4495.0), (10.0, 500.0, 1.0, 7.0, 3.0)],
)
def test_tensions_and_angle_at_both_ends_are_of_second_order(length, stiffness, mass, span, rise, nodes, grid):
    """On the elastic catenary, on graded and equal cells."""
    cable = {"length": length, "axial_stiffness": stiffness, "mass_per_length": mass}
    model = make({"cable": cable, "lower_end": {"anchored": True, "x": -span, "z": -rise}, "solver": {"nodes": nodes, "grid": grid}})
    model.initialize(still()(0.0))
    across, up = between_points(length, mass * 9.80665, stiffness, span, rise)
    found = dict(zip(OUTPUTS, model.outputs, strict=True))
    assert found["top.tension"] == pytest.approx(np.hypot(across, up), rel=5.0 / nodes**2)
    assert found["body.tension"] == pytest.approx(np.hypot(across, up - mass * 9.80665 * length), rel=5.0 / nodes**2)
    assert found["top.declination"] == pytest.approx(np.arctan2(across, up), abs=5.0 / nodes**2)


@pytest.mark.parametrize("grid", ["staggered", "box"])
@pytest.mark.parametrize("nodes", [5, 11, 51])
def test_the_angle_at_the_top_of_a_towed_cable_is_of_second_order(nodes, grid):
    _, force = hang_down(TOWED, lambda z: np.array([-2.0, 0.0]), 0.0)
    model = make(TOWED, solver__nodes=nodes, solver__grid=grid)
    model.initialize(still()(0.0))
    assert model.outputs[OUTPUTS.index("top.declination")] == pytest.approx(np.arctan2(abs(force[0]), force[1]), abs=1.0 / nodes**2)


@pytest.mark.parametrize("grid", ["staggered", "box"])
def test_a_free_end_without_a_body_bears_nothing(grid):
    """In a current that drags along the cable too."""
    base = {part: values for part, values in TOWED.items() if part != "body"}
    model = make(base, solver__nodes=11, solver__grid=grid)
    model.initialize(still()(0.0))
    assert abs(model.outputs[OUTPUTS.index("body.tension")]) < 1e-9 * model.outputs[3]


@pytest.mark.parametrize("nodes", [26, 51, 52, 101, 102])
def test_a_deep_loop_errs_as_a_midpoint_sum_over_its_bend_does(nodes):
    # 1000 m between ends 100 m apart, a = H/w = 11.1 m: the sum over cells of 1/sqrt(1 + (s/a)^2) errs by 2 exp(-2 pi a/h), and its sign is
    # that of a cell or a node at the lowest point
    a = brentq(lambda a: 2.0 * a * np.arcsinh(500.0 / a) - 100.0, 1.0, 100.0)
    base = {
        "cable": {"length": 1000.0, "mass_per_length": 1.0, "axial_stiffness": 1e9},
        "environment": {"gravity": 10.0},
        "lower_end": {"anchored": True, "x": -100.0},
        "solver": {"nodes": nodes},
    }
    model = make(base)
    model.initialize(still()(0.0))
    assert abs(-model.outputs[0] / (10.0 * a) - 1.0) < 2.0 * np.exp(-2.0 * np.pi * a * (nodes - 1) / 1000.0)


def test_hanging_chain_stretches_under_its_own_weight():
    base = {"cable": {"length": 2.0, "mass_per_length": 1.0, "axial_stiffness": 100.0}, "environment": {"gravity": 10.0}}
    model = make(base)
    model.initialize(still()(0.0))
    # w L^2/(2 EA); the smooth slack law softens the last cells only
    assert model.positions()[0, 2] == pytest.approx(-2.0 - 10.0 * 4.0 / 200.0, rel=2e-4)
    assert model.outputs[3] == pytest.approx(20.0, rel=1e-9)
    assert model.outputs[11] == pytest.approx(0.0, abs=2e-3 * 20.0)


@pytest.mark.parametrize(("grid", "body"), [("staggered", {}), ("box", {}), ("staggered", {"mass": 11.5, "volume": 11.5 / DENSITY})])
@pytest.mark.parametrize("last_digit", [-1, 0, 1])
def test_a_cable_of_the_density_of_the_water_hangs_straight_down_whatever_rounding_makes_of_its_weight(grid, body, last_digit):
    """Any place is one of rest; the one that the straight cable has is what a user means, and no cell of it is crumpled."""
    mass = DENSITY * 0.25 * np.pi * 0.02**2
    cable = {"length": 100.0, "diameter": 0.02, "mass_per_length": mass + last_digit * np.spacing(mass), "axial_stiffness": 1e5}
    model = make({"cable": cable, "body": body, "water": {"density": DENSITY}, "solver": {"nodes": 51, "grid": grid}})
    model.initialize(still()(0.0))
    assert model.positions()[0] == pytest.approx([0.0, 0.0, -100.0], abs=1e-4)
    assert np.linalg.norm(np.diff(model.positions(), axis=0), axis=1).sum() == pytest.approx(100.0, rel=1e-6)


@pytest.mark.parametrize(("length", "diameter", "mass"), [(100.0, 0.0076, 400.0), (20.0, 0.008, 10000.0)])
def test_the_cells_of_a_neutral_tether_under_a_heavy_body_are_equal(length, diameter, mass):
    """Waves across it are as fast everywhere: its tension is that of the body."""
    neutral = DENSITY * 0.25 * np.pi * diameter**2
    cable = {"length": length, "diameter": diameter, "mass_per_length": neutral, "axial_stiffness": 1e7}
    model = make({"cable": cable, "body": {"mass": mass}, "water": {"density": DENSITY}, "solver": {"nodes": 51}})
    model.initialize(still()(0.0))
    assert view(model).mesh == pytest.approx(np.tile([length / 50, 0.5], (50, 1)), rel=1e-6)
