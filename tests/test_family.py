"""The generalized-alpha family: spectral radii on M y' + K y = 0 from the stepping formulas [Gobat 2002, eqs 17-24, figure 1]."""

import numpy as np
import pytest

from cable_model.kernels.family import coefficients
from cable_model.parameters import INTEGRATORS

DECAYS = (0.01, 0.1, 1.0, 10.0, 1e4)  # z = dt K/M
LAMBDAS = (-0.9, -0.7, -0.5, -0.25, 0.0)


def amplification(name: str, lam: float, z: float) -> np.ndarray:
    """Eigenvalues, by falling size, of the matrix that takes (y, dt y') over one step."""
    c = coefficients(INTEGRATORS.index(name), lam)
    implicit = np.array([[z * (1.0 - c.alpha_k), 1.0 - c.alpha_m], [1.0, -c.gamma]])
    explicit = np.array([[-z * c.alpha_k, -c.alpha_m], [1.0, 1.0 - c.gamma]])
    values = np.linalg.eigvals(np.linalg.solve(implicit, explicit))
    return values[np.argsort(-np.abs(values))]


def radius(name: str, lam: float, z: float) -> float:
    return float(abs(amplification(name, lam, z)[0]))


def largest_root(inertia: list, stiffness: list, z: float) -> float:
    """Largest root of (inertia)(E - 1) + z (stiffness) = 0, the characteristic equation written out by hand."""
    return float(max(abs(np.roots(np.polyadd(np.polymul(inertia, [1.0, -1.0]), z * np.asarray(stiffness))))))


def test_lambda_of_minus_a_half_has_the_published_spectral_radii():
    figures = [radius("generalized-alpha", -0.5, z) for z in DECAYS]
    assert figures == pytest.approx([0.99005, 0.90474, 0.3129, 0.4230, 0.4999], abs=6e-5)


@pytest.mark.parametrize(
    ("lam", "fractions"),
    [
        (-0.5, (1 / 3, 1 / 6, 2 / 3)),
        (-0.7, (7 / 17, 11 / 34, 10 / 17)),
        (0.0, (0, -1 / 2, 1)),
        (-1.0, (1 / 2, 1 / 2, 1 / 2)),
        (0.25, (-1 / 3, -7 / 6, 4 / 3)),
    ],
)
def test_alpha_k_alpha_m_and_gamma_are_the_fractions_of_the_paper(lam, fractions):
    assert tuple(coefficients(INTEGRATORS.index("generalized-alpha"), lam)) == pytest.approx(fractions, abs=1e-15)


@pytest.mark.parametrize("z", DECAYS)
@pytest.mark.parametrize("lam", [-1.0, *LAMBDAS, 0.25, 0.5])
def test_generalized_alpha_has_the_roots_of_its_quadratic(lam, z):
    # (lam+3) E - (3 lam+1) over 2 (1-lam), and (E - lam)^2 over (1-lam)^2: eqs 19-21 inserted in eqs 17-18
    mu = 1.0 - lam
    expected = largest_root([(lam + 3.0) / (2.0 * mu), -(3.0 * lam + 1.0) / (2.0 * mu)], np.array([1.0, -2.0 * lam, lam * lam]) / mu**2, z)
    assert radius("generalized-alpha", lam, z) == pytest.approx(expected, rel=1e-7)


@pytest.mark.parametrize("z", DECAYS)
@pytest.mark.parametrize("lam", LAMBDAS)
def test_cornwell_malkus_and_wbz_have_the_roots_of_their_quadratics(lam, z):
    alpha = lam / (lam - 1.0)
    gamma = 0.5 + alpha
    expected = largest_root([1.0, 0.0], np.polymul([1.0 - alpha, alpha], [gamma, 1.0 - gamma]), z)
    assert radius("cornwell-malkus", lam, z) == pytest.approx(expected, rel=1e-7)
    gamma = 1.0 / (1.0 - lam)
    alpha = 0.5 - gamma
    expected = largest_root([1.0 - alpha, alpha], [gamma, 1.0 - gamma, 0.0], z)
    assert radius("wbz", lam, z) == pytest.approx(expected, rel=1e-7)


@pytest.mark.parametrize("z", DECAYS)
def test_one_parameter_members_have_their_closed_forms(z):
    assert radius("backward-difference", 0.0, z) == pytest.approx(1.0 / (1.0 + z), rel=1e-12)
    trapezoidal = abs(1.0 - z / 2.0) / (1.0 + z / 2.0)
    assert radius("trapezoidal", 0.0, z) == pytest.approx(trapezoidal, rel=1e-12)
    assert abs(amplification("generalized-alpha", -1.0, z)) == pytest.approx([1.0, trapezoidal], rel=1e-9)  # the box method rings
    for lam in LAMBDAS:
        gamma = 1.0 / (1.0 - lam)
        assert radius("generalized-trapezoidal", lam, z) == pytest.approx(abs(1.0 - (1.0 - gamma) * z) / (1.0 + gamma * z), rel=1e-12)


@pytest.mark.parametrize("lam", LAMBDAS)
def test_eigenvalue_at_infinite_frequency_is_lambda(lam):
    for name in ("generalized-alpha", "generalized-trapezoidal", "wbz"):
        assert radius(name, lam, 1e12) == pytest.approx(abs(lam), abs=2e-5)  # a double root: square root of 1/z
    other = abs((lam + 1.0) / (3.0 * lam - 1.0))
    assert radius("cornwell-malkus", lam, 1e12) == pytest.approx(max(abs(lam), other), abs=2e-5)


@pytest.mark.parametrize(
    ("name", "order"),
    [
        ("generalized-alpha", 2),
        ("cornwell-malkus", 2),
        ("wbz", 2),
        ("trapezoidal", 2),
        ("generalized-trapezoidal", 1),
        ("backward-difference", 1),
    ],
)
def test_principal_root_follows_the_exponential_to_the_order_of_the_member(name, order):
    errors = [abs(amplification(name, -0.5, z)[0].real - np.exp(-z)) for z in (0.02, 0.01)]
    assert np.log2(errors[0] / errors[1]) == pytest.approx(order + 1, abs=0.05)
