"""Statics of cables that are much longer than the way between their ends: folds, heaps on the seabed, loops, on every mesh."""

from pathlib import Path

import numpy as np
import pytest
from chain_support import drive, every, make, still
from scipy.integrate import solve_ivp
from scipy.optimize import fsolve

from cable_model import scene
from cable_model.cable_chain import CableChain
from cable_model.errors import SolverError
from cable_model.kernels import header

FOLDED = scene.load(Path(__file__).parent / "data" / "F5_slack_mooring_801.toml")
FORCE = slice(0, 3)  # of the outputs
GRAVITY, DENSITY = 9.80665, 1025.0
WIRE = {
    "cable": {
        "length": 100.0, "mass_per_length": 3.0, "axial_stiffness": 5e7, "diameter": 0.025,
        "normal_drag_coefficient": 1.2, "tangential_drag_coefficient": 0.01,
    },
    "water": {"density": DENSITY},
    "lower_end": {"anchored": True, "z": -60.0},
    "seabed": {"level": -60.0, "stiffness": 1e6},
}  # fmt: skip
WET = (3.0 - DENSITY * np.pi / 4.0 * 0.025**2) * GRAVITY
FEW, MANY = (3, 4, 10, 51), (201, 401, 801, 1000, 3000)


def at_rest(model: CableChain, top: tuple[float, float, float] = (0.0, 0.0, 0.0)) -> np.ndarray:
    """Force of the cable on its top, N."""
    model.initialize(still(top)(0.0))
    return model.outputs[FORCE].copy()


@pytest.mark.parametrize("nodes", [*FEW, *(pytest.param(n, marks=pytest.mark.long) for n in MANY)])
def test_a_slack_mooring_hangs_straight_down_on_every_mesh(nodes):
    """198.1 kN [found/README.md]: the weight of what reaches to the seabed; its last cell is on the way to it, or lies."""
    force = at_rest(CableChain(scene.with_values(FOLDED, {"solver.nodes": nodes})))
    weight = (113.35 - DENSITY * np.pi / 4.0 * 0.0766**2) * GRAVITY
    assert weight * 186.0 == pytest.approx(198.1e3, rel=1e-3)
    assert -force[2] == pytest.approx(weight * 186.0, abs=0.51 * weight * 1050.0 / (nodes - 1))
    assert abs(force[0]) < 1e-6 * weight * 186.0


LOOSE = {  # what the top of WIRE carries: the length of cable that hangs from it, m
    "above its anchor on the seabed": ({}, (0.0, 0.0, 0.0), 60.0),
    "ten times too long": ({"cable__length": 600.0}, (0.0, 0.0, 0.0), 60.0),
    "a hair beside its anchor": ({"lower_end__x": 1e-3}, (0.0, 0.0, 0.0), 60.0),
    "both ends in one place": ({"lower_end__z": -5.0}, (0.0, 0.0, -5.0), 50.0),
    "below its anchor": ({"lower_end__z": -10.0}, (0.0, 0.0, -50.0), 10.0),
    "the top on the seabed": ({"lower_end__x": 60.0}, (0.0, 0.0, -60.0), 0.0),
    "lifted by nothing but its own buoyancy": ({"cable__mass_per_length": 0.3}, (0.0, 0.0, -20.0), 20.0),
}


@pytest.mark.parametrize("name", LOOSE)
@pytest.mark.parametrize("nodes", [*FEW, *(pytest.param(n, marks=pytest.mark.long) for n in MANY)])
def test_a_loose_cable_pulls_with_the_weight_of_what_hangs_from_its_top(name, nodes):
    changes, top, hangs = LOOSE[name]
    model = make(WIRE, solver__nodes=nodes, **changes)
    force = at_rest(model, top)
    cable = model.scene.cable
    wet = (cable.mass_per_length - DENSITY * np.pi / 4.0 * cable.diameter**2) * GRAVITY
    assert -force[2] == pytest.approx(wet * hangs, abs=0.51 * abs(wet) * cable.length / (nodes - 1) + 1e-3 * abs(wet) * hangs)
    assert abs(force[0]) < 1e-4 * abs(wet) * cable.length
    assert model.positions()[0] == pytest.approx([model.scene.lower_end.x, 0.0, model.scene.lower_end.z], abs=1e-9)


def test_a_run_from_a_heap_on_the_seabed_stays_at_rest():
    series = drive(make(WIRE, solver__nodes=21, solver__time_step=0.05), every(0.05, 2.0), still())
    assert series["top.force_z"] == pytest.approx(np.full(41, series["top.force_z"][0]), rel=1e-6)


def streaming(speed: float) -> np.ndarray:
    """Force on the top of WIRE, straight above its anchor, no seabed, in a current: integrated from the anchor on."""
    cable = WIRE["cable"]

    def end(foot: np.ndarray) -> np.ndarray:
        def slope(s: float, state: np.ndarray) -> np.ndarray:
            size = np.linalg.norm(state[2:])
            tangent, stretch = state[2:] / size, 1.0 + size / cable["axial_stiffness"]
            along = speed * tangent[0] * tangent
            across = np.array([speed, 0.0]) - along
            drag = cable["normal_drag_coefficient"] * np.linalg.norm(across) * across
            drag += cable["tangential_drag_coefficient"] * np.linalg.norm(along) * along
            load = 0.5 * DENSITY * cable["diameter"] * np.sqrt(stretch) * drag - np.array([0.0, WET])
            return np.concatenate([stretch * tangent, -load])

        return solve_ivp(slope, (0.0, cable["length"]), [0.0, 0.0, *foot], rtol=1e-10, atol=1e-10, max_step=1.0).y[:, -1]

    foot = fsolve(lambda f: end(f)[:2] - [0.0, 60.0], [400.0, -300.0], xtol=1e-12)
    return -end(foot)[2:]


@pytest.mark.parametrize("nodes", [51, 101, 201, *(pytest.param(n, marks=pytest.mark.long) for n in (401, 801, 3000))])
def test_a_slack_line_straight_above_its_anchor_streams_in_a_current(nodes):
    right = streaming(1.0)
    assert right == pytest.approx([825.06, -1741.58], abs=0.01)
    deep = {"seabed__stiffness": 0.0, "seabed__level": 0.0, "lower_end__z": -61.0}  # and no cell at the surface
    force = at_rest(make(WIRE, current__speed=1.0, solver__nodes=nodes, **deep), (0.0, 0.0, -1.0))
    assert np.linalg.norm(force[[0, 2]] - right) < max(2.5e-4 * (50.0 / (nodes - 1)) ** 2, 2e-6) * np.linalg.norm(right)


@pytest.mark.parametrize(
    ("status", "text"),
    [
        (header.NO_EQUILIBRIUM, "Check the places of top, lower end and seabed, weight in water and current."),
        (header.WEIGHTLESS, "Give the cable or body some weight in water, or a current, or anchor the lower end."),
        (header.NO_SLACK, 'Set solver.grid = "staggered" and cable.compressible = false, or check the places of both ends'),
        (header.BELOW_WAVES, "Set water.depth to the depth, or 0 for deep water, or give a seabed."),
    ],
)
def test_where_there_is_no_equilibrium_the_error_names_why(status, text):
    model = CableChain.__new__(CableChain)
    model._calls = type("Calls", (), {"state": np.zeros(header.HEADER), "outputs": np.zeros(18), "end_speed": 0.0})()
    with pytest.raises(SolverError, match="no static equilibrium was found") as error:
        model._must(status, 0.0)
    assert text in str(error.value)
