"""The record of a hard case closes where a cable and its body go in and out of the water."""

import numpy as np
from test_surface import HEAVED

from cable_model.lab.hard.record import record
from cable_model.scene import with_values


def test_the_ledger_of_a_body_and_cable_that_go_in_and_out_closes_as_steps_get_shorter():
    gaps = []
    for step in (0.01, 0.0025):
        run = record(with_values(HEAVED, {"solver.time_step": step}))
        gaps.append(np.max(np.abs(run.excess)) / (run.weight * run.scene.cable.length))
    assert gaps[1] < 5e-5
    assert gaps[0] / gaps[1] > 8.0  # order 1.5 at least: the power is sampled at steps, and it jumps where water is met
