"""The laboratory's own loops drive a model as the library's does."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from cable_model.lab.hard.record import record
from cable_model.lab.published import bounded
from cable_model.scene import load, with_values
from cable_model.studies import timed

DATA = Path(__file__).parents[1] / "data"


def test_every_loop_that_drives_a_model_follows_the_winch():
    """Triangle of 4 m/s over 0.4 s: 0.8 m; the wire itself gives 0.3 mm by its own swing and stretch."""
    scene = with_values(load(DATA / "F9_winch_pulse.toml"), {"run.duration": 20.0, "run.output_step": 1.0})
    fallen = [
        -np.diff(timed.timed(scene).position[[0, -1], 2]),
        -np.diff(bounded.run(scene)[0].position[[0, -1], 2]),
        -np.diff(record(scene, step=1.0, watch=False).body[[0, -1], 2]),
    ]
    assert np.ravel(fallen) == pytest.approx(0.8, abs=5e-4)
