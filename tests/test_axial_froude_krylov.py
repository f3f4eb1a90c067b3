"""Waves push a cable along itself too: effective tension takes static buoyancy in full, and so the dynamic pressure."""

from pathlib import Path

import numpy as np
import pytest

from cable_model.cable_chain import CableChain
from cable_model.scene import load, with_values
from cable_model.simulation import simulate
from cable_model.tow_cable import TowCable

# source: public report F2; a vertical pipe from -5 to -55 m in a wave of 5 m and 10 s, water of 1000 kg/m3
PIPE = load(Path(__file__).parent / "data" / "F2_vertical_pipe_wave.toml")
NUMBER = (2.0 * np.pi / 10.0) ** 2 / 9.81  # of the wave, 1/m
PER_METRE = 1000.0 * np.pi / 4.0 * 0.4**2 * 9.81 * (np.exp(-5.0 * NUMBER) - np.exp(-55.0 * NUMBER))  # N: dynamic pressures at both ends
VARIANTS = {
    "chain": (CableChain, {}),
    "chain in space": (CableChain, {"solver.space": True, "waves.direction": 0.7}),
    "box": (CableChain, {"solver.grid": "box"}),
    "tow": (TowCable, {}),
    "tow in space": (TowCable, {"solver.space": True, "waves.direction": 0.7}),
}


def vertical_load(variant: str, amplitude: float) -> float:
    """Amplitude of the vertical force on the top at the wave's frequency, N: the wave begins at once and rings the pipe's axial mode."""
    model, changes = VARIANTS[variant]
    run = simulate(model(with_values(PIPE, {**changes, "waves.amplitude": amplitude})))
    last = run["time"] > 30.0
    angle = 2.0 * np.pi / 10.0 * run["time"][last]
    columns = np.column_stack([f(k * angle) for k in (1, 2, 3) for f in (np.cos, np.sin)] + [np.ones(last.sum())])
    return float(np.hypot(*np.linalg.lstsq(columns, run["top.force_z"][last], rcond=None)[0][:2]))


def test_the_pipes_load_in_a_wave_of_one_metre_is_the_reported_one_over_five():
    assert pytest.approx(4366.0, abs=1.0) == 5.0 * PER_METRE


@pytest.mark.parametrize("variant", [pytest.param(v, marks=pytest.mark.long) if "space" in v else v for v in VARIANTS])
def test_a_vertical_pipe_feels_the_difference_of_the_waves_pressure_at_its_ends(variant):
    assert vertical_load(variant, 0.05) == pytest.approx(0.05 * PER_METRE, rel=0.01)


def test_both_models_give_the_same_load_in_the_reported_wave():
    loads = [vertical_load(variant, 5.0) for variant in ("chain", "tow")]
    assert loads == pytest.approx([5.0 * PER_METRE] * 2, rel=0.01)
