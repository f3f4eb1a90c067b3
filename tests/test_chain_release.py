"""The chain let go from a small sideways pull at its tip, against its modes [Gobat 2002, figures 3-5]."""

import numpy as np
import pytest
from chain_support import drive, every, make, still
from scipy.linalg import eigh
from scipy.special import j0, j1, jn_zeros

FREE = {  # the shipped scene `free_chain`: m = g = L = 1, tip force 0.001 N
    "cable": {"length": 1.0, "mass_per_length": 1.0, "axial_stiffness": 1e9},
    "environment": {"gravity": 1.0},
    "lower_end": {"release_force": 0.001},
    "solver": {"nodes": 101, "time_step": 0.01},
}
TIMES = every(0.05, 30.0)


def tip(**changes: object) -> np.ndarray:
    return drive(make(FREE, **changes), TIMES, still())["body.x"]


def beam_modes(elements: int, bending: float) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Stiffness, mass, frequencies and modes of the heavy hinged beam by Hermite elements, finer towards the free end."""
    nodes = (np.arange(elements + 1) / elements) ** 1.5
    xi, weights = np.polynomial.legendre.leggauss(5)
    xi, weights = 0.5 * (xi + 1.0), 0.5 * weights
    size = 2 * (elements + 1)
    stiffness, mass = np.zeros((size, size)), np.zeros((size, size))
    for e in range(elements):
        h = nodes[e + 1] - nodes[e]
        shape = np.array([1 - 3 * xi**2 + 2 * xi**3, h * (xi - 2 * xi**2 + xi**3), 3 * xi**2 - 2 * xi**3, h * (xi**3 - xi**2)])
        slope = np.array([-6 * xi + 6 * xi**2, h * (1 - 4 * xi + 3 * xi**2), 6 * xi - 6 * xi**2, h * (3 * xi**2 - 2 * xi)]) / h
        bend = np.array([-6 + 12 * xi, h * (-4 + 6 * xi), 6 - 12 * xi, h * (6 * xi - 2)]) / h**2
        at = slice(2 * e, 2 * e + 4)
        tension = nodes[e] + h * xi
        stiffness[at, at] += h * ((slope * weights * tension) @ slope.T + bending * (bend * weights) @ bend.T)
        mass[at, at] += h * (shape * weights) @ shape.T
    free = [k for k in range(size) if k != size - 2]  # the top is hinged
    stiffness, mass = stiffness[np.ix_(free, free)], mass[np.ix_(free, free)]
    squares, modes = eigh(stiffness, mass)
    return stiffness, mass, np.sqrt(squares), modes


def test_modal_amplitudes_of_the_bessel_series_are_the_published_ones():
    frequencies, amplitudes = bessel_series(4)
    assert frequencies == pytest.approx([1.20241, 2.76004, 4.32686, 5.89577], abs=6e-6)
    assert amplitudes == pytest.approx([2.56262e-3, 1.12527e-3, 7.11660e-4, 5.14665e-4], rel=2e-5)


def bessel_series(count: int) -> tuple[np.ndarray, np.ndarray]:
    """Frequencies and tip amplitudes of the catenary H (asinh(1/H) - asinh(s/H)) released at rest, s = x^2."""
    frequencies = jn_zeros(0, count) / 2.0
    pull = 0.001
    x, weights = np.polynomial.legendre.leggauss(600)
    x, weights = 0.5 * (x + 1.0), 0.5 * weights
    start = pull * (np.arcsinh(1.0 / pull) - np.arcsinh(x * x / pull)) * 2.0 * x * weights
    return frequencies, np.array([np.dot(start, j0(2.0 * w * x)) / j1(2.0 * w) ** 2 for w in frequencies])


def miss(found: np.ndarray, expected: np.ndarray) -> float:
    return float(np.sqrt(np.mean((found - expected) ** 2) / np.mean(expected**2)))


def test_a_stiff_chain_without_bending_finds_its_catenary():
    model = make(FREE)
    model.initialize(still()(0.0))
    assert model.outputs[5] == pytest.approx(0.001 * np.arcsinh(1000.0), rel=0.01)


def test_release_with_bending_follows_the_modes_of_the_heavy_beam_within_one_percent():
    stiffness, mass, frequencies, modes = beam_modes(80, 1e-6)
    assert frequencies[:5] == pytest.approx([1.20241, 2.76025, 4.32965, 5.91057, 7.51305], abs=2e-5)
    pull = np.zeros(len(mass))
    pull[0] = 0.001
    start = np.linalg.solve(stiffness, pull)
    expected = np.cos(np.outer(TIMES, frequencies)) @ (modes[0] * (modes.T @ mass @ start))
    assert miss(tip(cable__bending_stiffness=1e-6, solver__time_step=0.0025), expected) < 0.01
