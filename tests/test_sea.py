"""The sea is its spectrum: what the components keep of it, whether they repeat, and how they spread."""

import dataclasses
import itertools
import math
import subprocess
import sys

import numpy as np
import pytest
from scipy.integrate import quad
from scipy.optimize import brentq

from cable_model.effects import Parts
from cable_model.errors import ParameterError
from cable_model.kernels.waves import elevation, wave_motion
from cable_model.parameters import Waves
from cable_model.scene import from_dict
from cable_model.sea import components, spectral_density, table_of

G = 9.81
HEIGHT, PERIOD = 3.0, 9.0
PEAK = 2.0 * math.pi / PERIOD
SPECTRA = [("pierson-moskowitz", 1.0), ("jonswap", 1.0), ("jonswap", 3.3), ("jonswap", 10.0)]
WET = {"cable": {"length": 10.0, "mass_per_length": 1.0, "axial_stiffness": 1e6, "diameter": 0.1}, "water": {}}
LONG = {"spectrum": "jonswap", "significant_height": 2.0}
SPREAD = {"spectrum": "jonswap", "significant_height": HEIGHT, "peak_period": PERIOD, "direction": 0.4}


def table(spectrum: str = "jonswap", peakedness: float = 3.3, count: int = 60, seed: int = 1) -> np.ndarray:
    waves = Waves(
        spectrum=spectrum, peakedness=peakedness, components=count, seed=seed, significant_height=HEIGHT, peak_period=PERIOD,
    )  # fmt: skip
    return components(waves, G, 0.0)


def density(ratio: float, peakedness: float) -> float:
    """The spectrum's shape over the frequency's ratio to the peak [Hasselmann et al. 1973], the test's own."""
    width = 0.07 if ratio <= 1.0 else 0.09
    return ratio**-5 * math.exp(-1.25 / ratio**4) * peakedness ** math.exp(-((ratio - 1.0) ** 2) / (2.0 * width**2))


def integral(order: int, peakedness: float, low: float = 0.2, high: float = math.inf) -> float:
    """Integral of the shape times ratio^order; below 0.2 of the peak there is exp(-780)."""
    breaks = [low, *(at for at in (0.6, 1.0, 1.5, 4.0) if low < at < high), high]
    pieces = itertools.pairwise(breaks)
    return sum(quad(lambda r: r**order * density(r, peakedness), a, b, epsabs=0.0, epsrel=1e-12, limit=400)[0] for a, b in pieces)


def moments(rows: np.ndarray, weight: np.ndarray | float = 1.0) -> list[float]:
    return [float(np.sum(rows[:, 0] ** 2 / 2.0 * rows[:, 1] ** n * weight)) for n in range(3)]


def test_the_density_is_the_published_shape():
    ratios = np.array([0.5, 0.95, 1.0, 1.05, 2.0, 8.0])
    given = spectral_density(Waves(spectrum="jonswap", peak_period=PERIOD, peakedness=3.3), PEAK * ratios)
    assert given == pytest.approx([density(r, 3.3) for r in ratios], rel=1e-13)


@pytest.mark.parametrize("count", [2, 5, 20, 60, 200, 10000])
def test_a_pierson_moskowitz_sea_has_the_closed_moments(count):
    m0, m1, m2 = moments(table("pierson-moskowitz", count=count))
    # substituting r = t^-1/4: the moment of order n is 1/4 (5/4)^(n/4 - 1) Gamma(1 - n/4), over the peak's powers
    assert 4.0 * math.sqrt(m0) == pytest.approx(HEIGHT, rel=1e-14)
    assert m2 / m0 == pytest.approx(PEAK**2 * math.sqrt(5.0 * math.pi) / 2.0, rel=1e-12)
    assert m1 / m0 == pytest.approx(PEAK * math.gamma(0.75) * 1.25**0.25, rel=0.02 / count)


@pytest.mark.parametrize("count", [20, 60, 200])
@pytest.mark.parametrize(("spectrum", "peakedness"), SPECTRA)
def test_components_keep_the_moments_of_the_whole_spectrum(spectrum, peakedness, count):
    found = moments(table(spectrum, peakedness, count))
    exact = [integral(n, peakedness) * PEAK**n for n in range(3)]
    assert 4.0 * math.sqrt(found[0]) == pytest.approx(HEIGHT, rel=1e-14)
    assert found[2] / found[0] == pytest.approx(exact[2] / exact[0], rel=1e-10)
    assert found[1] / found[0] == pytest.approx(exact[1] / exact[0], rel=4e-4 if count == 20 else 1.2e-4)


@pytest.mark.parametrize("peakedness", [1.0, 2.0, 3.3, 5.0])
def test_mean_and_zero_crossing_periods_are_those_that_engineers_take(peakedness):
    m0, m1, m2 = moments(table(peakedness=peakedness))
    # over the peak's period: DNV-RP-C205's fits, as public codes print them; good to three digits
    powers = [1.0, peakedness, -(peakedness**2), peakedness**3]
    assert 2.0 * math.pi * m0 / m1 / PERIOD == pytest.approx(np.dot([0.7303, 0.04936, 0.006556, 0.0003610], powers), abs=2e-3)
    assert 2.0 * math.pi * math.sqrt(m0 / m2) / PERIOD == pytest.approx(np.dot([0.6673, 0.05037, 0.006230, 0.0003341], powers), abs=2e-3)


@pytest.mark.parametrize("peakedness", [1.0, 3.3])
def test_each_component_is_the_energy_and_rms_frequency_of_a_band_of_equal_mean_frequency_content(peakedness):
    rows, bands = table(peakedness=peakedness, count=20), 19
    scale = HEIGHT**2 / 16.0 / integral(0, peakedness)
    share = integral(1, peakedness) / bands

    def edge(number: int) -> float:
        return brentq(lambda r: integral(1, peakedness, high=r) - number * share, 0.3, 10.0, xtol=1e-13)

    edges = [0.2, *(edge(number) for number in range(1, bands)), math.inf]
    for row, low, high in zip(rows, edges[:-2], edges[1:-1], strict=False):
        energy, square = (integral(n, peakedness, low, high) for n in (0, 2))
        assert row[0] ** 2 / 2.0 == pytest.approx(scale * energy, rel=1e-4)
        assert row[1] == pytest.approx(PEAK * math.sqrt(square / energy), rel=1e-5)
    tail = [scale * integral(n, peakedness, edges[-2]) * PEAK**n for n in range(3)]
    assert moments(rows[-2:]) == pytest.approx(tail, rel=1e-4)
    assert rows[-2, 1] > PEAK * edges[-2]


def test_one_component_has_the_height_and_the_zero_crossing_period():
    row = table("pierson-moskowitz", count=1)
    assert row.shape == (1, 6)
    assert row[0, :2] == pytest.approx([HEIGHT / math.sqrt(8.0), PEAK * math.sqrt(math.sqrt(5.0 * math.pi) / 2.0)], rel=1e-12)


LAGS = np.arange(60.0, 10800.0 * PERIOD / 5.0, 0.2)  # three hours of a sea of 5 s too


def largest_return(rows: np.ndarray) -> float:
    """Largest autocorrelation of the elevation, of either sign, beyond a minute."""
    share = rows[:, 0] ** 2 / np.sum(rows[:, 0] ** 2)
    return float(np.max(np.abs(sum(v * np.cos(omega * LAGS) for v, omega in zip(share, rows[:, 1], strict=True)))))


def chance(rows: np.ndarray) -> float:
    """What one sea in a thousand of independent frequencies returns to.

    Over the lags their autocorrelation is near a Gaussian process of variance v = sum share^2/2, which by Rice passes a level x from
    either side 2 T/Tz exp(-x^2/(2 v)) times in the time T: the level that is passed a thousandth of a time.
    """
    share = rows[:, 0] ** 2 / np.sum(rows[:, 0] ** 2)
    crossing = 2.0 * math.pi / math.sqrt(np.sum(share * rows[:, 1] ** 2))
    return math.sqrt(np.sum(share**2) * math.log(1000.0 * 2.0 * (LAGS[-1] - LAGS[0]) / crossing))


@pytest.mark.parametrize("count", [20, 60, 200])
@pytest.mark.parametrize(("spectrum", "peakedness"), SPECTRA)
def test_a_sea_returns_within_three_hours_no_nearer_than_independent_frequencies_do(spectrum, peakedness, count):
    found = largest_return(table(spectrum, peakedness, count))
    assert found < chance(table(spectrum, peakedness, count))
    assert found < math.sqrt(0.5)  # more of the sea is new than is not


def test_frequencies_of_equal_spacing_would_be_found_to_repeat():
    rows = table()
    rows[:, 1] = np.linspace(0.5, 2.0, 60)
    assert largest_return(rows) == pytest.approx(1.0, abs=1e-3) and chance(rows) < 0.6


def test_a_seed_gives_one_sea_and_another_seed_another():
    first, again, other = table(), table(), table(seed=2)
    assert np.array_equal(first, again)
    assert np.array_equal(first[:, :4], other[:, :4])
    assert not np.array_equal(first[:, 4], other[:, 4])


def test_the_surface_in_time_has_the_significant_height():
    rows = table(count=200)
    heights = [elevation(table_of(rows), None, (0.0, 0.0, 0.0), t)[0] for t in np.arange(0.0, 10800.0, 1.0)]
    assert 4.0 * np.std(heights) == pytest.approx(HEIGHT, rel=0.03)


def spread(exponent: float, count: int = 60, seed: int = 1) -> np.ndarray:
    return components(Waves(**SPREAD, spreading_exponent=exponent, components=count, seed=seed), G, 0.0)


@pytest.mark.parametrize("seed", [1, 2, 7])
@pytest.mark.parametrize("exponent", [1.0, 2.0, 4.0, 10.0, 500.0])
def test_directions_have_the_energy_weighted_moments_of_their_distribution(exponent, seed):
    rows = spread(exponent, 200, seed)
    off = rows[:, 3] - 0.4
    half = 0.5 * exponent
    # of cos^n over a right angle to either side, by the beta function
    mean = math.exp(2.0 * math.lgamma(1.0 + half) - math.lgamma(0.5 + half) - math.lgamma(1.5 + half))
    energy = moments(rows)[0]
    assert np.all(np.abs(off) < 0.5 * math.pi)
    assert moments(rows, np.cos(off))[0] / energy == pytest.approx(mean, rel=6e-4)
    assert moments(rows, np.cos(off) ** 2)[0] / energy == pytest.approx((exponent + 1.0) / (exponent + 2.0), rel=6e-4)
    assert moments(rows, np.sin(off))[0] / energy == pytest.approx(0.0, abs=3e-4)
    assert moments(rows, np.sin(off) ** 2)[0] / energy == pytest.approx(1.0 / (exponent + 2.0), rel=1e-2)


@pytest.mark.parametrize("seed", range(1, 6))
def test_short_waves_and_long_waves_spread_alike(seed):
    rows = spread(2.0, seed=seed)
    for part in (rows[:20], rows[20:40], rows[40:]):
        sine, cosine = np.sin(part[:, 3] - 0.4), np.cos(part[:, 3] - 0.4)
        energy = moments(part)[0]
        assert moments(part, cosine**2)[0] / energy == pytest.approx(0.75, abs=0.04)
        assert moments(part, sine)[0] / energy == pytest.approx(0.0, abs=0.1)


def test_spreading_turns_waves_and_changes_nothing_else():
    long_crested, short_crested = spread(0.0), spread(4.0)
    assert np.all(long_crested[:, 3] == 0.4)
    same = [0, 1, 2, 4, 5]
    assert np.array_equal(long_crested[:, same], short_crested[:, same])
    assert len(np.unique(short_crested[:, 3])) == 60
    assert not np.array_equal(short_crested[:, 3], spread(4.0, seed=2)[:, 3])
    assert np.array_equal(short_crested, spread(4.0))


def test_the_water_of_a_spread_sea_moves_across_the_main_direction_by_the_closed_share():
    parts = Parts(waves=table_of(spread(2.0, 200)), space=True)
    velocity = np.array([wave_motion(parts, (0.0, 0.0, 0.0), t)[0] for t in np.arange(0.0, 10800.0)])
    along = velocity[:, 0] * math.cos(0.4) + velocity[:, 1] * math.sin(0.4)
    across = velocity[:, 1] * math.cos(0.4) - velocity[:, 0] * math.sin(0.4)
    assert np.var(across) / np.var(along) == pytest.approx(1.0 / 3.0, rel=0.04)  # 1/(n + 1)
    assert np.var(velocity[:, 2]) == pytest.approx(HEIGHT**2 / 16.0 * PEAK**2 * integral(2, 3.3) / integral(0, 3.3), rel=0.02)


def test_regular_waves_and_tables_are_their_numbers():
    one = components(Waves(amplitude=0.7, period=8.0, direction=0.3, phase=0.1), G, 0.0)
    omega = 2.0 * math.pi / 8.0
    assert one.tolist() == [[0.7, omega, omega**2 / G, 0.3, 0.1, 0.0]]
    assert np.array_equal(one, components(Waves(table=((0.7, 8.0, 0.3, 0.1),)), G, 0.0))


def test_a_sea_is_made_without_scipy():
    code = (
        "import sys; sys.modules['scipy'] = None\n"
        "from cable_model.parameters import Waves; from cable_model.sea import components\n"
        "print(len(components(Waves(spectrum='jonswap', significant_height=2.0, spreading_exponent=4.0), 9.81, 30.0)))"
    )
    run = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert run.stdout == "60\n"


@pytest.mark.parametrize(
    ("waves", "space", "text"),
    [
        ({"amplitude": 1.0, "spreading_exponent": 2.0}, True,
         "waves.spreading_exponent = 2: must be 0 without a spectrum. Give waves.spectrum, or remove the exponent."),
        ({**SPREAD, "spreading_exponent": 0.5}, True,
         "waves.spreading_exponent = 0.5: must be 0 or >= 1 and <= 1000. Take 2, as is usual, or 0."),
        ({**SPREAD, "spreading_exponent": 2.0}, False,
         "waves.spreading_exponent = 2: must be 0 in the plane. Set solver.space = true, or remove the exponent."),
    ],
)  # fmt: skip
def test_spreading_that_means_nothing_is_refused(waves, space, text):
    with pytest.raises(ParameterError) as error:
        from_dict({**WET, "waves": waves, "solver": {"space": space}})
    assert str(error.value) == text


@pytest.mark.parametrize(
    ("waves", "text"),
    [
        ({"significant_height": 2.0}, 'waves.spectrum = \'none\': must be jonswap or pierson-moskowitz beside values of a spectrum. '),
        ({"amplitude": 1.0, "peak_period": 8.0}, "waves.spectrum = 'none': must be jonswap or pierson-moskowitz beside "),
        ({"amplitude": 1.0, "peakedness": 2.0}, "waves.spectrum = 'none': must be jonswap or pierson-moskowitz beside "),
        ({"table": [[1.0, 8.0, 0.0, 0.0]], "components": 20}, "waves.spectrum = 'none': must be jonswap or pierson-moskowitz beside "),
        ({"table": [[1.0, 8.0, 0.0, 0.0]], "seed": 2}, "waves.spectrum = 'none': must be jonswap or pierson-moskowitz beside "),
        ({**LONG, "spectrum": "pierson-moskowitz", "peakedness": 2.0}, "waves.peakedness = 2: must be left out of a pierson-moskowitz "),
        ({**LONG, "period": 8.0}, "waves.period = 8 s: must be left out beside a spectrum, a table or a record. "),
        ({**LONG, "phase": 1.0}, "waves.phase = 1 rad: must be 0 beside a spectrum, a table or a record. "),
        ({"table": [[1.0, 8.0, 0.0, 0.0]], "period": 9.0}, "waves.period = 9 s: must be left out beside a spectrum, a table or a record. "),
        ({"table": [[1.0, 8.0, 0.0, 0.0]], "phase": 1.0}, "waves.phase = 1 rad: must be 0 beside a spectrum, a table or a record. "),
        ({"table": [[1.0, 8.0, 0.0, 0.0]], "direction": math.pi}, "waves.direction = 3.141592654 rad: must be 0 beside waves.table. "),
    ],
)  # fmt: skip
def test_values_that_another_kind_of_sea_has_are_refused(waves, text):
    with pytest.raises(ParameterError) as error:
        from_dict({**WET, "waves": waves})
    assert str(error.value).startswith(text)


@pytest.mark.parametrize(
    "kind", [{"amplitude": 1.0}, {"table": [[1.0, 8.0, 0.0, 0.5]]}, {"spectrum": "pierson-moskowitz", "significant_height": 1.0},
             {"spectrum": "jonswap", "significant_height": 1.0}, {"record": [[0.5 * k, math.cos(k)] for k in range(40)]}],
)  # fmt: skip
def test_no_value_of_the_waves_is_accepted_and_ignored(kind):
    """Each, changed alone in each kind of sea, changes the components, or is refused."""

    def of(changes):
        scene = from_dict({**WET, "waves": {**kind, **changes}, "solver": {"space": True}})
        return components(scene.waves, G, 0.0)

    changed = {
        "amplitude": 2.0, "period": 8.0, "direction": 0.7, "phase": 0.3, "significant_height": 2.0, "peak_period": 7.0, "peakedness": 2.0,
        "components": 40, "seed": 7, "spreading_exponent": 4.0, "spectrum": "jonswap", "table": [[2.0, 9.0, 0.0, 0.5]],
        "record": [[0.5 * k, math.sin(k)] for k in range(40)],
    }  # fmt: skip
    rest = {field.name for field in dataclasses.fields(Waves)} - {"surface", "ramp_time", "exact"}  # how they are read
    assert set(changed) == rest
    for name, value in changed.items():
        if kind.get(name) == value:
            continue
        try:
            found = of({name: value})
        except ParameterError:
            continue
        before = of({})
        assert found.shape != before.shape or not np.array_equal(found, before), name


def test_a_spread_sea_in_space_and_a_long_crested_one_in_the_plane_are_accepted():
    from_dict({**WET, "waves": {**SPREAD, "spreading_exponent": 2.0}, "solver": {"space": True}})
    from_dict({**WET, "waves": {**SPREAD, "direction": 0.0}})
