"""Natural frequencies of the hanging chain, from the matrices that the kernels assemble and from the step itself."""

import numpy as np
import pytest
from chain_support import HANGING, make, still, unroll, view, with_tensions
from scipy.linalg import eigh
from scipy.special import jn_zeros

from cable_model.kernels.build import build
from cable_model.kernels.family import Coefficients, coefficients
from cable_model.kernels.path import Ends
from cable_model.kernels.slack import floor
from cable_model.kernels.staggered import assemble
from cable_model.kernels.staggered_step import Gains, Winding, newton_step
from cable_model.parameters import INTEGRATORS

UNIT = {
    "cable": {"length": 1.0, "mass_per_length": 1.0, "axial_stiffness": 1e9},
    "environment": {"gravity": 1.0},
    "solver": {"nodes": 51, "time_step": 0.01},
}
STILL = Winding(1.0, 0.0, 0.0)
HINGED_BEAM = [1.20241, 2.76025, 4.32965, 5.91057, 7.51305]  # EI = 1e-6, hinged top: Hermite beam eigenvalues


def dense(model, gains: Gains) -> np.ndarray:
    """The Jacobian of the hanging state for the given gains, without the prescribed top."""
    now = view(model)
    n, d = now.y.shape[0] // 2, now.y.shape[1]
    s = now.scratch
    problem = build(model.parts, model.numbers, 0.0)
    s.cells[: n - 1, 0] = [t + floor(model.parts, problem.numeric, h) for t, h in zip(now.force, now.mesh[:, 0], strict=True)]
    s.cells[: n - 1, 2] = np.linalg.norm(now.y[: n - 1], axis=1)
    s.cells[: n - 1, 3 : 3 + d] = now.y[: n - 1] / s.cells[: n - 1, 2:3]
    assemble(
        model.parts,
        problem,
        gains,
        now.mesh,
        now.y[: n - 1],
        now.y[n:],
        np.zeros((n, d)),
        (0.0,) * d,
        0.0,
        0,
        s.bands,
        s.x,
        s.cells,
        s.contact,
    )
    full, _ = with_tensions(unroll(s.bands, n, d, bool(model.parts.bending)), s.x, s.cells, n)
    return full[: (n - 1) * d, : (n - 1) * d]


def matrices(model) -> tuple[np.ndarray, np.ndarray]:
    """Stiffness and mass of the linearised chain in its hanging state."""
    return dense(model, Gains(1.0, 0.0, 0.0, 0.0, 1.0, 0.01, STILL)), dense(model, Gains(0.0, 0.0, 1.0, 0.0, 1.0, 0.01, STILL))


def sideways_frequencies(nodes: int, **changes) -> np.ndarray:
    model = make(UNIT, solver__nodes=nodes, **changes)
    model.initialize(still()(0.0))
    stiffness, mass = matrices(model)
    return np.sqrt(eigh(stiffness[::2, ::2], mass[::2, ::2], eigvals_only=True))


def test_first_eight_frequencies_are_roots_of_the_bessel_function_within_2e_4():
    exact = jn_zeros(0, 8) / 2.0  # J0(2 omega) = 0
    assert np.max(np.abs(sideways_frequencies(51)[:8] / exact - 1.0)) < 2e-4


def test_frequencies_converge_at_second_order_in_the_cell_length():
    exact = jn_zeros(0, 2) / 2.0  # of higher modes the fourth-order dispersion is still larger than the error of the free end
    errors = [np.max(np.abs(sideways_frequencies(n)[:2] / exact - 1.0)) for n in (26, 51, 101)]
    assert np.log2(np.array(errors[:-1]) / errors[1:]) == pytest.approx(2.0, abs=0.1)


def test_frequencies_with_bending_are_those_of_a_hinged_heavy_beam():
    found = sideways_frequencies(101, cable__bending_stiffness=1e-6)[:5]
    assert np.max(np.abs(found / HINGED_BEAM - 1.0)) < 2e-4


def test_mass_and_stiffness_are_symmetric_and_the_mass_is_the_chain():
    model = make(UNIT, cable__bending_stiffness=1e-6)
    model.initialize(still()(0.0))
    stiffness, mass = matrices(model)
    assert np.max(np.abs(stiffness - stiffness.T)) < 1e-12 * np.max(np.abs(stiffness))
    assert np.max(np.abs(mass - mass.T)) < 1e-15
    h, split = view(model).mesh[-1]
    share_of_top = (1.0 - split - 1.0 / 12.0) * h + 2.0 / 12.0 * h  # what the prescribed node and its coupling carry
    assert mass[::2, ::2].sum() + share_of_top == pytest.approx(1.0, rel=1e-12)


@pytest.mark.parametrize("lam", [-0.5, -0.9, 0.0])
def test_a_newton_step_amplifies_every_mode_as_the_characteristic_equation_says(lam):
    # [(1-a_m) E + a_m](E-1) - i omega h [(1-a_k) E + a_k][gamma E + 1-gamma] = 0 for each omega of the linearised chain
    model = make(HANGING, solver__nodes=5, cable__axial_stiffness=171.675, solver__slack_damping=0.0)
    model.initialize(still()(0.0))
    now = view(model)
    n, h = 5, 0.02
    c = Coefficients(*coefficients(INTEGRATORS.index("generalized-alpha"), lam))
    problem = build(model.parts, model.numbers, 0.0)
    problem = problem._replace(numeric=problem.numeric._replace(tolerance=1e-12))
    stiffness, mass = matrices(model)
    free = [k for k in range(4 * n) if k // 2 not in (n - 1, 2 * n - 1)]  # all but the rows of the top

    def step(x: np.ndarray) -> np.ndarray:
        y, yd = now.y.copy().ravel(), now.y.ravel() * 0.0
        y[free] += x[: len(free)]
        yd[free] += x[len(free) :]
        y1, yd1 = y.reshape(-1, 2).copy(), yd.reshape(-1, 2).copy()
        status = newton_step(
            model.parts, problem, now.mesh, y.reshape(-1, 2), yd.reshape(-1, 2), 0.0 * now.ydd, c, 0.0, h,
            (0.0, 0.0), Ends((0.0, 0.0), (0.0, 0.0)), Winding(1.75, 0.0, 0.0), np.zeros(1), y1, yd1, now.force, now.force, 0.0, now.scratch,
        )  # fmt: skip
        assert status > 0
        return np.concatenate([y1.ravel()[free] - now.y.ravel()[free], yd1.ravel()[free]])

    matrix = np.array([(step(e) - step(-e)) / 2e-5 for e in np.eye(2 * len(free)) * 1e-5]).T
    found = np.linalg.eigvals(matrix)
    omega = np.sqrt(eigh(stiffness, mass, eigvals_only=True))
    for mode in omega:
        inertia = np.polymul([1.0 - c.alpha_m, c.alpha_m], [1.0, -1.0])
        force = np.polymul([1.0 - c.alpha_k, c.alpha_k], [c.gamma, 1.0 - c.gamma])
        for root in np.roots(np.polyadd(inertia, -1j * mode * h * force)):
            assert np.min(np.abs(found - root)) < 2e-5
    assert len(omega) == 2 * (n - 1)
