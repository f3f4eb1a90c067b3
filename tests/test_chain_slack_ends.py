"""What is reported at the ends of a cable that cannot push: no pushing, whatever its inertia and its supports do."""

from pathlib import Path

import numpy as np
import pytest
from chain_support import WIRE, drive, every, make, still, view

from cable_model import scene
from cable_model.cable_chain import CableChain
from cable_model.simulation import simulate

LANDED = {  # 1 t in air, 100 m of rope, above a floor
    "cable": {"length": 100.0, "mass_per_length": 8.0, "axial_stiffness": 1e7, "diameter": 0.1},
    "body": {"mass": 1000.0},
    "seabed": {"level": -102.0, "stiffness": 1e6},
    "solver": {"nodes": 21, "time_step": 0.02},
}


def lowered(t: float) -> np.ndarray:
    """The top sinks by 4 m within 8 s and rests."""
    s = min(t / 8.0, 1.0)
    depth = 4.0 * s**3 * (10.0 - 15.0 * s + 6.0 * s**2)
    rate = 4.0 * 30.0 * s**2 * (1.0 - s) ** 2 / 8.0
    return np.array([0, 0, -depth, 0, 0, -rate, 0, 0, -4.0 * 60.0 * s * (1.0 - s) * (1.0 - 2.0 * s) / 64.0])


def test_a_winch_that_starts_at_once_finds_a_slack_cable_but_no_push():
    series = simulate(CableChain(scene.load(Path(__file__).parent / "data" / "F7_winch_step.toml")))
    assert np.max(series["top.force_z"]) > 1000.0  # the attachment does push cable ahead of it: that is its momentum
    assert np.min(series["top.tension"]) >= 0.0
    assert np.min(series["body.tension"]) >= 0.0


def test_a_payload_on_the_seabed_hangs_on_no_cable():
    """Without damping the slack rope above it swings on, and tugs now and then; with that of a rope it comes to rest."""
    weight = 9.80665 * 1000.0
    for damping in (0.0, 1e4):
        series = drive(make(LANDED, cable__axial_damping=damping), every(0.05, 20.0), lowered)
        assert series["body.tension"][0] == pytest.approx(weight, rel=1e-6)
        assert np.min(series["body.tension"]) >= 0.0
        assert series["body.z"][-1] == pytest.approx(-102.0, abs=0.1)
    assert series["body.tension"][-100:] == pytest.approx(0.0, abs=1e-3 * weight)


def test_of_a_payload_that_is_partly_lifted_the_seabed_takes_its_share_of_the_lowest_node():
    model = make(LANDED, seabed__level=-100.05, seabed__stiffness=1e5)
    model.initialize(still()(0.0))
    held = model.outputs[11]
    weight, share = 1000.0 * 9.80665, view(model).mesh[0].prod() * 8.0 * 9.80665  # of the body, and of the cable that the node carries
    pressed = weight + share - view(model).force[0]  # the node's balance: all that the seabed bears
    assert 0.1 * weight < held < 0.9 * weight
    assert held == pytest.approx(weight - pressed * weight / (weight + share), rel=1e-6)


def let_down_at_once(t: float) -> np.ndarray:
    """The top starts down at 5 m/s."""
    speed = 5.0 if t > 0.0 else 0.0
    return np.array([0.0, 0.0, -5.0 * t, 0.0, 0.0, -speed, 0.0, 0.0, 0.0])


@pytest.mark.parametrize("bending", [0.0, 200.0])
def test_a_top_that_starts_down_at_once_is_followed_without_a_push(bending):
    model = make(WIRE, cable__bending_stiffness=bending, solver__nodes=11)
    series = drive(model, every(0.05, 1.0), let_down_at_once)
    bottom, top = view(model).mesh[[0, -1], 0]
    assert np.max(series["top.force_z"]) > 100.0  # momentum of the cable that the top drives down
    assert np.min(series["top.tension"]) >= -2.0 * bending / top**2  # what bending holds
    assert np.min(series["body.tension"]) >= -2.0 * bending / bottom**2


def test_a_wire_that_may_be_pressed_reports_how_it_is_pressed():
    series = drive(make(WIRE, cable__compressible=True, solver__nodes=11), every(0.05, 0.5), let_down_at_once)
    assert np.min(series["top.tension"]) < -1000.0


def test_a_cell_that_loses_its_tension_within_a_step_is_not_reported_to_push():
    """The whirl of a chain with next to no bending stiffness; nowhere by more than a hundredth of its weight, as hard cases are judged."""
    whirl = scene.with_values(scene.load("hard/whirl"), {"top.motion": [
        {"kind": "sinusoid", "axis": "x", "amplitude": 0.05, "angular_frequency": 0.95 * 2.8469, "ramp_time": 1.0, "ramp": "cubic"},
        {"kind": "sinusoid", "axis": "y", "amplitude": 5e-5, "angular_frequency": np.pi, "stop": 1.0},
    ], "run.output_step": 0.01})  # fmt: skip
    series = simulate(CableChain(whirl))
    assert np.min(series["cable.tension_min"]) >= -0.01 * 0.1 * 1.75 * 9.81
