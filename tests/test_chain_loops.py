"""Loops of every bending stiffness between two ends at one level, against the heavy elastica; and what is reported of them."""

from functools import cache
from pathlib import Path

import numpy as np
import pytest
from chain_support import drive, energy, every, make, still
from scipy.integrate import solve_bvp
from scipy.optimize import brentq

from cable_model import scene
from cable_model.cable_chain import CableChain
from cable_model.signals import OUTPUTS

DATA = Path(__file__).parent / "data"
LENGTH, MASS, GRAVITY = 20.0, 0.5, 9.81
WEIGHT = MASS * GRAVITY * LENGTH


@cache
def elastica(stiffness: float, span: float) -> tuple[float, float]:
    """Horizontal tension over wL, and sag over L, of an inextensible beam of EI = `stiffness` w L^3 hung by hinges `span` L apart.

    From the lowest point up, angle a from the horizontal: EI a'' = H sin a - w s cos a, x' = cos a, z' = sin a, and a(0) = x(0) = z(0) = 0,
    a'(1/2) = 0, x(1/2) = span/2; continued in EI from the catenary.
    """
    pull = brentq(lambda h: 2.0 * h * np.arcsinh(0.5 / h) - span, 1e-6, 1e3)
    s = np.concatenate([np.linspace(0.0, 0.2, 400), np.linspace(0.2, 0.5, 401)[1:]])
    shape = np.array([np.arctan2(s, pull), pull / (pull**2 + s**2), pull * np.arcsinh(s / pull), np.hypot(pull, s) - pull])
    start = 1e-6
    for ei in np.geomspace(start, stiffness, 1 + int(np.ceil(6.0 * abs(np.log10(stiffness / start))))):

        def slopes(s, y, p, ei=ei):
            return np.array([y[1], (p[0] * np.sin(y[0]) - s * np.cos(y[0])) / ei, np.cos(y[0]), np.sin(y[0])])

        def ends(low, up, p):
            return np.array([low[0], low[2], low[3], up[1], up[2] - 0.5 * span])

        found = solve_bvp(slopes, ends, s, shape, p=[pull], tol=1e-8, max_nodes=60000)
        assert found.success
        s, shape, pull = found.x, found.y, found.p[0]
    return float(pull), float(shape[3, -1])


def answers(model: CableChain, position: tuple[float, float, float] = (0.0, 0.0, 0.0)) -> tuple[dict[str, float], np.ndarray]:
    """Outputs at rest, and the nodes."""
    model.initialize(still(position)(0.0))
    return dict(zip(OUTPUTS, model.outputs, strict=True)), model.positions()


def loop(stiffness: float, span: float, nodes: int, **changes: object) -> CableChain:
    cable = {"length": LENGTH, "mass_per_length": MASS, "bending_stiffness": stiffness * MASS * GRAVITY * LENGTH**3}
    cable["axial_stiffness"] = 1e11 if stiffness > 1e-2 else 1e9
    held = {"anchored": True, "x": -span * LENGTH, "z": 0.0}
    base = {"cable": cable, "environment": {"gravity": GRAVITY}, "lower_end": held, "solver": {"nodes": nodes}}
    return make(base, **changes)


def arc(shape: np.ndarray) -> float:
    return float(np.sum(np.linalg.norm(np.diff(shape, axis=0), axis=1)))


POINTS = [(1e-8, 0.6), (1e-5, 0.05), (1e-5, 0.95), (1e-3, 0.2), (0.1, 0.05), (0.1, 0.6), (10.0, 0.95)]


@pytest.mark.parametrize(("stiffness", "span"), POINTS)
def test_a_loop_is_the_heavy_elastica_at_second_order(stiffness, span):
    pull, sag = elastica(stiffness, span)
    errors = []
    for nodes in (51, 101, 201):
        out, shape = answers(loop(stiffness, span, nodes))
        assert arc(shape) == pytest.approx(LENGTH, rel=1e-5)
        errors.append(abs(-out["top.force_x"] / WEIGHT - pull))
    assert errors[0] < 0.02 * max(abs(pull), 0.05)  # of the force or, where there is next to none, of a twentieth of the weight
    assert -shape[:, 2].min() == pytest.approx(sag * LENGTH, abs=1e-3 * LENGTH)
    assert np.log2(errors[1] / errors[2]) == pytest.approx(2.0, abs=0.1)


# [beam boundary-value problem of found/README.md]: force along x, height of the lowest point below the ends, smallest axial force
UMBILICALS = {"F3_umbilical_u_ei5": (-1.5479, 9.233, 1.547), "F3_umbilical_u_ei300": (20.8575, 8.448, -20.8575)}


@pytest.mark.parametrize("compressible", [False, True])
@pytest.mark.parametrize("name", UMBILICALS)
def test_an_umbilical_with_bending_keeps_its_length_and_pulls_as_a_beam(name, compressible):
    force, low, smallest = UMBILICALS[name]
    table = scene.load(DATA / f"{name}.toml")
    out, shape = answers(CableChain(scene.with_values(table, {"cable.compressible": compressible})), table.top.position)
    assert out["top.force_x"] == pytest.approx(force, rel=5e-3)
    assert -5.0 - shape[:, 2].min() == pytest.approx(low, abs=2e-3)
    assert arc(shape) == pytest.approx(20.0, abs=2e-4)
    assert out["cable.tension_min"] == pytest.approx(smallest, rel=2e-2)
    if smallest > 0.0:
        assert out["cable.slack_fraction"] == 0.0


@pytest.mark.parametrize("nodes", [21, 31, 41, 61, 81, 101])
def test_statics_find_on_every_mesh_the_branch_that_the_hanging_chain_reaches(nodes):
    table = scene.load(DATA / "F3_umbilical_u_ei300.toml")
    out, _ = answers(CableChain(scene.with_values(table, {"solver.nodes": nodes})), table.top.position)
    assert out["top.force_x"] == pytest.approx(UMBILICALS["F3_umbilical_u_ei300"][0], rel=0.03 * (20.0 / (nodes - 1)) ** 2)


@pytest.mark.parametrize(
    ("bending", "span", "lost", "stretched"),
    [(300.0, 0.1, 1e-9, 1e-3), (5.0, 0.2, 2e-3, 2e-3)],  # the whip of the softer one reaches the floor of the law in single cells
)
def test_a_loop_that_is_let_go_keeps_its_energy_and_its_length(bending, span, lost, stretched):
    stiffness = bending / (MASS * GRAVITY * LENGTH**3)
    changes = {"cable__axial_stiffness": 1e6, "cable__bending_stiffness": bending, "solver__slack_damping": 0.0}
    model = loop(stiffness, span, 51, solver__time_step=0.005, lower_end__released=True, solver__lambda_infinity=-1.0, **changes)
    stored, arcs = [], []

    def each(t: float) -> None:
        stored.append(energy(model))
        arcs.append(arc(model.positions()))

    drive(model, every(0.005, 3.0), still(), each)
    change = (np.array(stored) - stored[0]) / (WEIGHT * LENGTH)
    assert np.max(change) < 1e-9
    assert np.min(change) > -lost
    assert max(arcs) < LENGTH * (1.0 + stretched)
    assert min(arcs) > LENGTH * (1.0 - stretched)
