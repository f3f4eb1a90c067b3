"""The chain in space: a chain shaken in a plane leaves it and whirls."""

from functools import cache

import numpy as np
import pytest
from chain_support import HANGING, drive, every, make, no_ramp, swing

WHIRL = {
    **HANGING,
    "cable": {"length": 1.75, "mass_per_length": 0.2, "axial_stiffness": 1e6, "bending_stiffness": 1e-6 * 0.2 * 9.81 * 1.75**3},
}
WINDOWS = ((5.0, 10.0), (10.0, 15.0), (15.0, 20.0))
# rms of the tip's x and y in these windows, m: an independent staggered code with a numerical Jacobian, alike for 51 and 101 nodes
FOUND = ((0.196, 0.034), (0.076, 0.086), (0.131, 0.148))


@cache
def whirl(lam: float, step: float) -> np.ndarray:
    """Tip x and y at every 0.01 s, the top swinging by 20 mm along x and by 0.1 mm along y, in quadrature, from rest at once."""
    model = make(WHIRL, solver__space=True, solver__lambda_infinity=lam, solver__time_step=step)
    shake = swing((0.02, 1e-4, 0.0), 6.5, no_ramp, phase=(0.0, np.pi / 2.0, 0.0))

    def about_rest(t: float) -> np.ndarray:
        return shake(t) - np.array([0.0, 1e-4, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0])

    run = drive(model, every(0.01, 20.0), about_rest)
    assert run["solver.rejected_steps"][-1] == 0
    return np.array([run["body.x"], run["body.y"]]).T


@pytest.mark.parametrize("lam", [-0.5, -0.9])
@pytest.mark.parametrize("step", [0.01, 0.005])
def test_whirl_out_of_the_plane_of_shaking_is_that_of_an_independent_code(lam, step):
    path = whirl(lam, step)
    times = 0.01 * np.arange(len(path))
    for (start, end), expected in zip(WINDOWS, FOUND, strict=True):
        inside = (times >= start) & (times < end)
        rms = np.sqrt(np.mean(path[inside] ** 2, axis=0))
        assert np.all(np.abs(rms - expected) <= 0.02 * np.array(expected))
