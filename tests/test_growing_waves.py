"""Waves that grow from the start, and records of them."""

import math

import numpy as np
import pytest
from chain_support import drive, every, make, scene_of, still
from changing_water_support import BOTH, DEEP, LINE, WAY

from cable_model import simulate
from cable_model.effects import Parts
from cable_model.kernels.waves import Ramp, elevation, wave_motion
from cable_model.models import MODELS
from cable_model.sea import rows_of, table_of
from cable_model.signals import OUTPUTS
from cable_model.tables import waves


def test_a_ramp_counts_from_the_start_of_the_run():
    one, later = (
        drive(
            make(LINE, current__speed=0.5, current__ramp_time=10.0, waves__amplitude=1.0, waves__period=5.0, waves__ramp_time=10.0),
            times,
            DEEP,
        )
        for times in (every(0.1, 4.0), 35.0 + every(0.1, 4.0))
    )  # seven periods later
    for name in OUTPUTS[:12]:
        assert later[name] == pytest.approx(one[name], rel=1e-8, abs=1e-6), name


@pytest.mark.parametrize("t", [-1.0, 0.0, 2.0, 4.9, 8.0, 10.0, 30.0])
@pytest.mark.parametrize("parts", [Parts(), Parts(stretched=True), Parts(cut=True)], ids=["held", "stretched", "cut"])
def test_waves_that_grow_have_the_acceleration_and_the_gradient_of_their_velocity(parts, t):
    wave = table_of(np.array([[0.8, 1.1, 1.1**2 / 9.81, 0.6, 0.3, 0.0], [0.3, 1.9, 1.9**2 / 9.81, -0.4, 1.3, 0.0]]))
    ramp = Ramp(0.0, 10.0)
    parts = parts._replace(waves=wave, wave_ramp=ramp)
    place = np.array([2.0, -1.0, -0.4])
    s = min(max(t / 10.0, 0.0), 1.0)
    share = 10.0 * s**3 - 15.0 * s**4 + 6.0 * s**5
    velocity, acceleration, gradient = wave_motion(parts, tuple(place), t)
    if parts.stretched is None and parts.cut is None:
        whole = wave_motion(parts._replace(wave_ramp=None), tuple(place), t)
        assert velocity == pytest.approx(share * np.array(whole[0]), abs=1e-13)
    height, rate, slope = elevation(wave, ramp, tuple(place), t)
    assert height == pytest.approx(share * elevation(wave, None, tuple(place), t)[0], abs=1e-13)
    d = 1e-5
    ahead, behind = (elevation(wave, ramp, tuple(place), t + sign * d)[0] for sign in (1.0, -1.0))
    assert rate == pytest.approx((ahead - behind) / (2.0 * d), abs=1e-8)
    later, before = (np.array(wave_motion(parts, tuple(place), t + sign * d)[0]) for sign in (1.0, -1.0))
    if parts.cut is None:  # where it is cut the edge moves, and its own speed is no acceleration of the water
        assert acceleration == pytest.approx((later - before) / (2.0 * d), abs=1e-7)
    for k in range(3):
        step = d * np.eye(3)[k]
        up, down = (np.array(wave_motion(parts, tuple(place + sign * step), t)[0]) for sign in (1.0, -1.0))
        assert np.reshape(gradient, (3, 3))[:, k] == pytest.approx((up - down) / (2.0 * d), rel=1e-6, abs=1e-7)
        over, under = (elevation(wave, ramp, tuple(place + sign * step), t)[0] for sign in (1.0, -1.0))
        assert slope[k] == pytest.approx((over - under) / (2.0 * d), abs=1e-8)


@pytest.mark.parametrize(("model", "way"), WAY)
def test_waves_that_grow_begin_at_rest_and_end_as_the_whole_waves(model, way):
    wave = {
        "waves__amplitude": 1.5, "waves__period": 5.0, "solver__time_step": 0.05, "top__position": [0.0, 0.0, -4.0],
        "cable__axial_damping": 1e4,
    }  # fmt: skip
    motion = still((0.0, 0.0, -4.0))
    grown = drive(MODELS[model](scene_of(LINE, **way, **wave, waves__ramp_time=20.0)), every(0.1, 500.0), motion)
    full = drive(MODELS[model](scene_of(LINE, **way, **wave)), every(0.1, 500.0), motion)
    assert grown["top.force_x"][0] == pytest.approx(0.0, abs=1e-9)
    for name in ("top.force_x", "top.force_z"):
        steady = full[name][-50:]
        size = np.ptp(steady)
        assert np.ptp(grown[name][:10]) < 2e-3 * size, name  # growth by the third power of time
        assert grown[name][-50:] == pytest.approx(steady, abs=0.03 * size), name


def test_a_record_of_waves_is_what_they_do_at_its_place():
    t = 30.0 + 0.5 * np.arange(600)
    known = [(0.9, 10.0, 0.4), (0.5, 7.5, 2.0), (0.2, 300.0 / 71.0, -1.0)]  # all of which fit into 300 s
    heights = sum(a * np.cos(phase - 2.0 * math.pi * t / period) for a, period, phase in known)
    rows = [[float(time), float(height) + 0.7] for time, height in zip(t, heights, strict=True)]  # with a tide
    components = waves(scene_of(LINE, waves__record=rows))
    assert components.shape[1] == 3
    for (a, period, phase), row in zip(known, rows_of(components), strict=True):
        assert row[0] == pytest.approx(a, rel=1e-9)
        assert row[1] == pytest.approx(2.0 * math.pi / period, rel=1e-12)
        assert row[4] % (2.0 * math.pi) == pytest.approx(phase % (2.0 * math.pi), abs=1e-9)
    assert [elevation(components, None, (0.0, 0.0), time)[0] for time in t] == pytest.approx(heights, abs=1e-9)


@pytest.mark.parametrize("count", [400, 401])
def test_a_record_of_noise_is_kept_but_for_a_hundredth_of_its_deviation(count):
    rng = np.random.default_rng(1)
    t = 0.7 * np.arange(count)
    noise = np.convolve(rng.standard_normal(count + 40), np.hanning(41), mode="valid")[:count]
    components = waves(scene_of(LINE, waves__record=np.column_stack((t, noise)).tolist()))
    heights = np.array([elevation(components, None, (0.0, 0.0), time)[0] for time in t])
    assert np.std(heights - (noise - noise.mean())) <= 0.0101 * np.std(noise)
    assert components.shape[1] < count // 2


@BOTH
def test_a_run_in_a_record_is_the_run_in_its_components(model):
    t = 0.5 * np.arange(240)
    rows = np.column_stack((t, 0.8 * np.cos(0.3 - 2.0 * math.pi * t / 8.0))).tolist()
    recorded = simulate(model(scene_of(LINE, waves__record=rows, run__duration=5.0)))
    known = simulate(model(scene_of(LINE, waves__amplitude=0.8, waves__period=8.0, waves__phase=0.3, run__duration=5.0)))
    assert recorded["top.tension"] == pytest.approx(known["top.tension"], rel=1e-9)
