"""The water has a surface: what is above it is dry.  Shares, energies and derivatives, and the reported scenes at their right values."""

from pathlib import Path

import numpy as np
import pytest
from chain_support import kinetic_matrix, make, still, view
from test_chain_newton import WET, Step

from cable_model.cable_chain import CableChain
from cable_model.kernels import surface
from cable_model.kernels.staggered_surface import _added_energy
from cable_model.scene import from_dict, load, with_values
from cable_model.signals import OUTPUTS
from cable_model.simulation import simulate
from cable_model.tow_cable import TowCable

DATA = Path(__file__).parent / "data"
R, SPLIT = 0.3, 0.42
CELLS = [(-2.0, -1.0), (-1.0, 0.4), (-0.29, 0.2), (0.2, -0.29), (-0.2, 0.1), (0.05, 1.0), (0.5, 1.0), (0.01, 0.012), (-0.3, -0.2999)]


def sphere_share(z: float, r: float) -> float:
    """Share of a sphere's volume below z = 0, by slices."""
    x = np.linspace(-1.0, 1.0, 20001)
    below = x * r + z < 0.0
    return float(np.sum((1.0 - x * x) * below) / np.sum(1.0 - x * x))


def buoyancy(z1: float, z2: float) -> float:
    """E of a cell by its definition, M and G from sums of the sphere's share over the height."""
    at = np.linspace(-4.0, 4.0, 400001)
    wet = np.array([surface.share(z, R)[0] for z in np.linspace(-R, R, 4001)])
    share = np.interp(at, np.linspace(-R, R, 4001), wet)
    step = at[1] - at[0]
    m = np.concatenate([[0.0], np.cumsum(0.5 * (share[1:] + share[:-1]) * step)])
    m -= m[-1]
    g = np.concatenate([[0.0], np.cumsum(0.5 * (m[1:] + m[:-1]) * step)])
    g -= g[-1]
    m1, m2, g1, g2 = (float(np.interp(z, at, f)) for f in (m, g) for z in (z1, z2))
    return (g2 - g1) / (z2 - z1) + (SPLIT - 0.5) * (m1 - m2)


@pytest.mark.parametrize("z", [-0.31, -0.2, 0.0, 0.1, 0.29, 0.31])
def test_share_of_a_sphere_is_that_of_its_volume(z):
    assert surface.share(z, R)[0] == pytest.approx(sphere_share(z, R), abs=1e-4)


@pytest.mark.parametrize("z", [-0.2, 0.0, 0.25])
def test_middle_of_the_wet_part_is_its_centroid(z):
    x = np.linspace(-1.0, 1.0, 20001)
    weight = (1.0 - x * x) * (x * R + z < 0.0)
    assert surface.centre(z, R)[0] == pytest.approx(-R * np.sum(weight * x) / np.sum(weight), abs=1e-4)


@pytest.mark.parametrize("ends", CELLS)
def test_lift_of_a_cell_is_the_derivative_of_its_energy(ends):
    d = 1e-3
    cell = surface.cell_share(*ends, R, SPLIT)
    e1 = (buoyancy(ends[0] + d, ends[1]) - buoyancy(ends[0] - d, ends[1])) / (2.0 * d) if abs(ends[0] - ends[1]) > 0.01 else None
    if e1 is not None:
        assert cell.e1 == pytest.approx(e1, abs=1e-4)
    assert cell.e1 + cell.e2 == pytest.approx(cell.wet + (SPLIT - 0.5) * (surface.share(ends[0], R)[0] - surface.share(ends[1], R)[0]))


@pytest.mark.parametrize("ends", CELLS)
def test_derivatives_of_a_cells_share_are_exact(ends):
    z1, z2 = ends
    d = 1e-6
    cell = surface.cell_share(z1, z2, R, SPLIT)
    ahead1, back1 = surface.cell_share(z1 + d, z2, R, SPLIT), surface.cell_share(z1 - d, z2, R, SPLIT)
    ahead2, back2 = surface.cell_share(z1, z2 + d, R, SPLIT), surface.cell_share(z1, z2 - d, R, SPLIT)
    close = {"abs": 1e-5 / R}
    for name, by1, by2 in (("wet", "w1", "w2"), ("e1", "e11", "e12"), ("e2", "e12", "e22")):
        assert (getattr(ahead1, name) - getattr(back1, name)) / (2.0 * d) == pytest.approx(getattr(cell, by1), **close)
        assert (getattr(ahead2, name) - getattr(back2, name)) / (2.0 * d) == pytest.approx(getattr(cell, by2), **close)
    for name, by1, by2 in (("w1", "w11", "w12"), ("w2", "w12", "w22")):
        if min(abs(abs(z) - R) for z in ends) > 1e-3:
            assert (getattr(ahead1, name) - getattr(back1, name)) / (2.0 * d) == pytest.approx(getattr(cell, by1), abs=1e-4 / R**2)
            assert (getattr(ahead2, name) - getattr(back2, name)) / (2.0 * d) == pytest.approx(getattr(cell, by2), abs=1e-4 / R**2)


@pytest.mark.parametrize("ends", [(-3.0, -1.0), (-1.0, -3.0), (-2.0, -2.0)])
def test_what_is_deep_is_lifted_at_its_split_to_the_last_digits(ends):
    cell = surface.cell_share(*ends, R, SPLIT)
    assert (cell.wet, cell.e1, cell.e2) == pytest.approx((1.0, SPLIT, 1.0 - SPLIT), abs=1e-14)


STILL = {name: values for name, values in WET.items() if name not in ("waves", "current")}
CROSSING = {"body__mass": 3.0, "body__volume": 1e-3, "body__drag_area": 0.02, "body__added_mass": 0.5, "cable__axial_stiffness": 300.0}


@pytest.mark.parametrize("space", [False, True])
@pytest.mark.parametrize("height", [-0.1, 0.6, 1.4, 1.75])
def test_jacobian_is_exact_through_the_surface(space, height):
    step = Step(STILL, 3, solver__space=space, **CROSSING)
    step.top = (*step.top[:-1], height)
    v1 = step.y0[step.n :].copy()
    force = step.settled_tensions(v1)
    _, analytic = step.assemble(v1, force)
    free = (step.n - 1) * step.d
    found = np.empty((free, free))
    for k in range(free):
        shift = np.zeros(step.n * step.d)
        shift[k] = 1e-5
        ahead, _ = step.assemble(v1 + shift.reshape(v1.shape), force)
        behind, _ = step.assemble(v1 - shift.reshape(v1.shape), force)
        found[:, k] = ((ahead - behind).ravel() / 2e-5)[:free]
    assert found == pytest.approx(analytic[:free, :free], abs=3e-8 * np.max(np.abs(analytic)))


def test_added_mass_of_a_cell_that_enters_makes_no_energy():
    """The power of what the surface adds is half the rate of the wet share times twice the kinetic energy: the other half is lambda a."""
    rng = np.random.default_rng(2)
    gains = Step(STILL, 1, **CROSSING).gains
    for _ in range(5):
        cell = surface.cell_share(-0.2, 0.3, R, SPLIT)
        q, low, up = (tuple(rng.normal(size=3)) for _ in range(3))
        terms = _added_energy(cell, 2.0, SPLIT, q, low, up, (low[2], up[2]), gains)
        t = np.array(q) / np.linalg.norm(q)
        normal = np.eye(3) - np.outer(t, t)
        share = np.array([[SPLIT - 1 / 12, 1 / 12], [1 / 12, 1.0 - SPLIT - 1 / 12]])
        square = sum(share[i, j] * np.array((low, up)[i]) @ normal @ np.array((low, up)[j]) for i in range(2) for j in range(2))
        rate = cell.w1 * low[2] + cell.w2 * up[2]
        assert np.dot(terms[0], low) + np.dot(terms[1], up) == pytest.approx(0.5 * 2.0 * rate * square, rel=1e-12)


BOB = {
    "cable": {"length": 5.0, "mass_per_length": 0.5, "axial_stiffness": 1e4, "diameter": 0.02},
    "body": {"mass": 600.0, "volume": 0.3, "added_mass": 150.0},
    "water": {"density": 1025.0},
    "top": {"position": [0.0, 0.0, 7.19]},
    "solver": {"nodes": 11, "lambda_infinity": -1.0, "slack_damping": 0.0},
}


KICK = (1.5, -1.5)  # m/s


def bob_energy(model: CableChain) -> float:
    """Energy of cable and body: weights, stretch, buoyancy by U, added mass by its wet share; written from the equations."""
    now, z = view(model), model.positions()[:, 2]
    h, split = now.mesh.T
    n = len(h) + 1
    q, v = now.y[: n - 1], now.y[n:]
    cable, body, g = BOB["cable"], BOB["body"], model.scene.environment.gravity
    density = 1025.0
    area = np.pi / 4.0 * cable["diameter"] ** 2
    radius = (0.75 / np.pi * body["volume"]) ** (1.0 / 3.0)
    wet = surface.share(z[0], radius)[0]
    kinetic = 0.5 * cable["mass_per_length"] * np.sum(v * (kinetic_matrix(h, split) @ v))
    kinetic += 0.5 * (body["mass"] + wet * body["added_mass"]) * np.sum(v[0] ** 2)
    weights = cable["mass_per_length"] * g * np.sum(h * (split * z[:-1] + (1.0 - split) * z[1:])) + body["mass"] * g * z[0]
    m, big = np.array([surface.share_integrals(at, 0.5 * cable["diameter"]) for at in z]).T
    lift = density * area * g
    buoyancy = -lift * np.sum(h * ((big[1:] - big[:-1]) / np.diff(z) + (split - 0.5) * (m[:-1] - m[1:])))
    buoyancy -= density * body["volume"] * g * surface.share_integrals(z[0], radius)[0]
    f = cable["axial_stiffness"] * (np.linalg.norm(q, axis=1) - 1.0)
    numeric = model.scene.solver
    hung, own = abs((body["mass"] - density * body["volume"]) * g), abs((cable["mass_per_length"] - density * area) * g)
    w0 = np.minimum(numeric.slack_smoothing * (hung + own * cable["length"]), hung + own * h)
    strain = np.sum(h * (f * f + f * np.hypot(f, w0) + w0 * w0 * np.arcsinh(f / w0))) / (4.0 * cable["axial_stiffness"])
    return float(kinetic + weights + buoyancy + strain)


def bobbing(step: float, duration: float, **changes: object) -> tuple[np.ndarray, dict]:
    """Energies and outputs of a body that is hung from a spring above the water, kicked aside and down."""
    model = make(BOB, solver__time_step=step, **changes)
    motion = still((0.0, 0.0, 7.19))
    model.initialize(motion(0.0))
    view(model).y[11:] = np.linspace(1.0, 0.0, 11)[:, None] * KICK
    energies, rows = [bob_energy(model)], []
    for k in range(round(duration / step)):
        model.advance(k * step, step, motion(0.0), motion(0.0))
        energies.append(bob_energy(model))
        rows.append(model.outputs.copy())
    return np.array(energies), dict(zip(OUTPUTS, np.array(rows).T, strict=True))


def test_a_bobbing_sphere_keeps_its_energy_at_order_two_and_newton_takes_three_iterations_at_most():
    errors = []
    for step in (0.04, 0.02, 0.01):
        energies, run = bobbing(step, 20.0)
        errors.append(np.max(np.abs(energies - energies[0])) / (0.5 * 600.0 * (KICK[0] ** 2 + KICK[1] ** 2)))
        assert np.max(np.diff(run["solver.newton_iterations"])) <= 3
        assert run["solver.rejected_steps"][-1] == 0
    radius = (0.75 / np.pi * 0.3) ** (1.0 / 3.0)
    assert run["body.z"].min() < -0.5 * radius and run["body.z"].max() > 0.5 * radius  # it goes in and out
    # over a factor of four: where the body dips under and comes out, the share's third derivative jumps
    assert 0.5 * np.log2(errors[0] / errors[2]) == pytest.approx(2.0, abs=0.1)
    assert errors[2] < 1e-4


def test_a_body_above_the_sea_hangs_in_air_and_feels_no_waves():
    # source: public report; 500 kg on 30 m of line, 30 m above the sea: m g of body and line
    scene = load(DATA / "F1_body_in_air.toml")
    run = simulate(CableChain(scene))
    weight = (scene.body.mass + scene.cable.mass_per_length * scene.cable.length) * scene.environment.gravity
    assert weight == pytest.approx(5197.5, abs=0.05)
    assert run["top.force_z"] == pytest.approx(-weight, rel=1e-9)
    assert np.max(np.abs(run["top.force_x"])) < 1e-6 * weight


@pytest.mark.parametrize("nodes", [51, 52])
def test_the_half_of_a_chain_that_is_in_the_sea_floats_and_no_more(nodes):
    run = simulate(CableChain(with_values(load(DATA / "F1_chain_half_dry.toml"), {"solver.nodes": nodes})))
    assert run["top.force_z"] == pytest.approx(-181202.8, rel=2e-5)


def test_a_wire_in_air_feels_no_sea_current():
    run = simulate(CableChain(load(DATA / "F1_wire_in_air_in_current.toml")))
    assert run["top.force_z"] == pytest.approx(-20.0 * 30.0 * 9.80665, rel=1e-6)
    assert np.max(np.abs(run["top.force_x"])) < 1e-3
    assert np.max(np.abs(run["body.x"])) < 1e-6


def test_a_float_stays_at_the_surface_and_its_line_is_slack():
    run = simulate(CableChain(load(DATA / "F1_float_flies.toml")))
    assert run["body.z"][-1] == pytest.approx(0.0, abs=0.01)
    assert run["cable.slack_fraction"][-1] > 0.0
    weight = (0.6 - 1025.0 * np.pi / 4.0 * 0.012**2) * 9.80665 * 120.0
    assert 0.0 < run["top.tension"][-1] < weight  # no more than its line weighs, where 3065 N were reported


HEAVED = from_dict({
    "cable": {
        "length": 8.0, "mass_per_length": 4.0, "axial_stiffness": 1e5, "diameter": 0.05, "normal_drag_coefficient": 1.2,
        "tangential_drag_coefficient": 0.1, "added_mass_coefficient": 1.0,
    },
    "body": {"mass": 300.0, "volume": 0.15, "drag_area": 0.3, "added_mass": 75.0},
    "water": {"density": 1025.0},
    "current": {"speed": 0.5},
    "top": {
        "position": [0.0, 0.0, 7.0],
        "motion": [
            {"kind": "sinusoid", "axis": "z", "amplitude": 1.5, "angular_frequency": 1.3, "ramp_time": 4.0},
            {"kind": "sinusoid", "axis": "x", "amplitude": 1.5, "angular_frequency": 1.0, "ramp_time": 4.0},
        ],
    },
    "solver": {"nodes": 11, "lambda_infinity": -0.9, "slack_damping": 0.0},
    "run": {"duration": 12.0},
})  # fmt: skip


@pytest.mark.parametrize("grid", ["staggered", "box"])
def test_both_models_and_grids_take_a_top_above_the_sea_with_the_surface_and_without(grid):
    high = with_values(load("dale_sphere"), {"top.position": (0.0, 0.0, 5.0)})
    for model, scene in ((TowCable, high), (CableChain, with_values(high, {"solver.grid": grid}))):
        assert model(with_values(scene, {"water.surface": False})).parts.surface is None
        assert model(scene).parts.surface is True
