"""The axial law as a table: statics, frequency and refusals."""

import numpy as np
import pytest
from chain_support import drive, every, make, still

from cable_model import scene
from cable_model.errors import ParameterError
from cable_model.kernels.slack import elastic
from cable_model.simulated import parts_of

ROPE = {
    "cable": {
        "length": 10.0, "mass_per_length": 0.01, "axial_stiffness": 1e4,
        "stiffness_curve": [[0.0, 0.0], [0.02, 100.0], [0.05, 400.0], [0.1, 1500.0]],
    },
    "body": {"mass": 30.0},
    "environment": {"gravity": 10.0},
    "solver": {"nodes": 6, "time_step": 0.002},
}  # fmt: skip


def curve() -> np.ndarray:
    return parts_of(scene.from_dict(ROPE), "chain").curve


def test_the_law_passes_through_the_rows_and_rises_smoothly():
    table = curve()
    for strain, tension in ROPE["cable"]["stiffness_curve"]:
        assert elastic(table, 1e4, strain)[0] == pytest.approx(tension, abs=1e-9)
    strains = np.linspace(-0.02, 0.13, 3001)
    tensions, slopes = np.array([elastic(table, 1e4, e) for e in strains]).T
    assert (np.diff(tensions) > 0.0).all()
    assert slopes[1:-1] == pytest.approx((tensions[2:] - tensions[:-2]) / (strains[2:] - strains[:-2]), rel=2e-2)
    assert elastic(None, 1e4, 0.01) == (100.0, 1e4)


def test_a_load_hangs_at_the_strain_that_the_table_gives():
    model = make(ROPE)
    model.initialize(still()(0.0))
    assert -model.outputs[7] == pytest.approx(10.0 * (1.0 + np.interp(300.0, *_inverse())), rel=1e-4)


def _inverse() -> tuple[np.ndarray, np.ndarray]:
    strains = np.linspace(0.0, 0.1, 20001)
    return np.array([elastic(curve(), 1e4, e)[0] for e in strains]), strains


def test_a_load_bounces_with_the_slope_of_the_table_where_it_hangs():
    model = make(ROPE)

    def nudge(t: float) -> np.ndarray:
        s = min(t / 0.1, 1.0)
        rise = 1e-3 * s**3 * (10.0 - 15.0 * s + 6.0 * s**2)
        speed = 1e-3 * 30.0 * s**2 * (1.0 - s) ** 2 / 0.1
        return np.array([0, 0, rise, 0, 0, speed, 0, 0, 1e-3 * 60.0 * s * (1.0 - s) * (1.0 - 2.0 * s) / 0.01])

    series = drive(model, every(0.002, 6.0), nudge)
    z = series["body.z"][100:] - series["body.z"][100:].mean()
    crossings = series["time"][100:-1][(z[:-1] < 0.0) & (z[1:] >= 0.0)]
    frequency = 2.0 * np.pi / np.diff(crossings).mean()
    strain = np.interp(300.0, *_inverse())
    slope = elastic(curve(), 1e4, strain)[1]
    assert frequency == pytest.approx(np.sqrt(slope / (10.0 * (30.0 + 0.1 / 3.0))), rel=3e-3)


@pytest.mark.long
def test_a_straight_table_is_the_linear_law():
    straight = make(ROPE, cable__stiffness_curve=[[0.0, 0.0], [0.05, 500.0], [0.1, 1000.0]])
    linear = make(ROPE, cable__stiffness_curve=[])
    assert linear.parts.curve is None
    for model in (straight, linear):
        model.initialize(still()(0.0))
    assert straight.outputs[:12] == pytest.approx(linear.outputs[:12], rel=1e-9, abs=1e-9)


@pytest.mark.parametrize(
    ("rows", "changes", "text"),
    [
        (
            [[0.0, 0.0], [0.1, 5.0], [0.05, 9.0]],
            {},
            "cable.stiffness_curve = 3 rows: must be [0, 0] and rows of rising strain and tension.",
        ),
        ([[0.01, 0.0], [0.1, 5.0]], {}, "cable.stiffness_curve = 2 rows: must be [0, 0] and rows of rising strain and tension."),
        ([[0.0, 0.0], [0.1, 5.0]], {"solver__grid": "box"}, "cable.stiffness_curve = 2 rows: must be empty on the box grid."),
    ],
)
def test_tables_that_are_no_law_are_refused(rows, changes, text):
    with pytest.raises(ParameterError) as error:
        make(ROPE, cable__stiffness_curve=rows, **changes)
    assert str(error.value).startswith(text)


def test_tow_cable_takes_no_table():
    with pytest.raises(ParameterError, match=r"cable.stiffness_curve = 4 rows: must be empty for TowCable. Use CableChain."):
        parts_of(scene.from_dict(ROPE), "tow")
