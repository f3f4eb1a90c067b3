"""The mooring chain of 33 m in a basin: measured mean cycle maxima of the tension at 18 conditions."""

import numpy as np
import pytest
from chain_support import drive

from cable_model import scene
from cable_model.cable_chain import CableChain
from cable_model.lab.hard.basin import maxima
from cable_model.motion import PrescribedMotion
from cable_model.parameters import Motion, Top
from cable_model.simulation import simulate

MEASURED = maxima()  # [Bergdahl et al. 2016, table 8]
CENTRE = (32.554, 0.0, 0.3)
CYCLES, LAST = 12, 6


def circle(radius: float, period: float) -> Top:
    """Up, then away from the anchor, as the measured series; two periods to fade in."""
    common = {"kind": "sinusoid", "amplitude": radius, "angular_frequency": 2.0 * np.pi / period, "ramp_time": 2.0 * period}
    return Top(CENTRE, motion=(Motion(axis="x", phase=0.5 * np.pi, **common), Motion(axis="z", phase=np.pi, **common)))


def mean_cycle_maximum(radius: float, period: float, steps: int, **changes: object) -> tuple[float, dict]:
    base = scene.load("basin_chain")
    table = {name.replace("__", "."): value for name, value in changes.items()} | {"solver.time_step": period / steps}
    model = CableChain(scene.with_values(base, table))
    series = drive(model, period / steps * np.arange(CYCLES * steps + 1), PrescribedMotion(circle(radius, period)))
    tops = series["top.tension"][1:].reshape(CYCLES, steps).max(axis=1)
    return tops[-LAST:].mean(), series


def error_of(steps: int, **changes: object) -> float:
    found = [mean_cycle_maximum(radius, period, steps, **changes)[0] for radius, period, _ in MEASURED]
    return float(np.sqrt(np.mean((np.array(found) - MEASURED[:, 2]) ** 2)))


@pytest.mark.parametrize(("nodes", "steps"), [(41, 125), (81, 250)])
def test_mean_cycle_maxima_are_within_one_and_a_half_newtons_of_the_measured_ones(nodes, steps):
    assert error_of(steps, solver__nodes=nodes) < 1.5


def test_the_tension_is_lost_in_every_fast_cycle_and_the_peak_is_measured_to_5_percent():
    largest, series = mean_cycle_maximum(0.2, 1.25, 125)
    cycles = series["top.tension"][1:].reshape(CYCLES, 125)[-LAST:]
    assert (cycles.min(axis=1) < 0.5).all()
    assert largest == pytest.approx(70.3, rel=0.05)


def test_the_series_has_the_sense_of_rotation_of_the_measured_one():
    """Turned the other way, the mean maximum at 0.2 m and 3.5 s is 17 % above the measured one; this way within 4 %."""
    mean, _ = mean_cycle_maximum(0.2, 3.5, 125)
    assert mean == pytest.approx(50.1, rel=0.04)


def test_error_control_takes_at_most_eight_times_the_steps_of_the_fixed_step():
    """Nodes that land are no truncation error: 26 times as many steps at a tolerance of 0.1 once, 180 at 0.01."""
    base = scene.load("basin_chain")
    steps = [simulate(CableChain(scene.with_values(base, {"solver.tolerance": t})), 7.0, 0.028)["solver.steps"][-1] for t in (0.0, 1e-2)]
    assert steps[1] < 8.0 * steps[0]
