"""Positions and tensions along the cable: closed forms, the outputs at its ends, and what FMUs tell of it where it is asked for."""

import itertools

import numpy as np
import pytest
from chain_support import HANGING, WEIGHT, make
from fmu_support import FMICallException, Fmu, started, sway
from native_support import FLAVOURS

from cable_model import CableChain, TowCable, load, simulate
from cable_model.errors import ParameterError
from cable_model.kernels import header
from cable_model.motion import motion_of
from cable_model.scene import from_dict, with_values
from cable_model.signals import OUTPUTS, SHAPE
from fmu_src.interface import generic_scene

SURGE = {"kind": "sinusoid", "axis": "x", "amplitude": 1.0, "angular_frequency": 2.0, "ramp_time": 2.0}


def test_a_hanging_cable_carries_at_each_node_what_hangs_below_it():
    for nodes, grading, grid in ((51, 1.0, "staggered"), (26, 0.0, "staggered"), (26, 0.0, "box")):
        run = simulate(make(HANGING, solver__grading=grading, solver__nodes=nodes, solver__grid=grid), duration=0.1)
        below = (run.shapes[-1, :, 2] - run.shapes[-1, 0, 2]) / 1.75
        assert run.tensions.shape == (len(run.table), nodes)
        assert run.tensions[-1] == pytest.approx(WEIGHT * below, abs=1e-4 * WEIGHT)
        assert run.tensions[-1, -1] == run["top.tension"][-1]
        assert run.tensions[-1, 0] == run["body.tension"][-1]


@pytest.mark.parametrize("nodes", [4, 11, 40])
def test_points_of_the_shape_are_evenly_spaced_along_the_unstretched_cable(nodes):
    """On a mesh that is not: a soft cable that hangs by its weight stretches as in closed form, s + w s (L - s/2)/EA from the top."""
    model = make(HANGING, solver__nodes=nodes, cable__axial_stiffness=20.0 * WEIGHT)
    model.initialize(np.zeros(9))
    shape = model.shape()
    s = np.linspace(1.75, 0.0, 11)
    deep = s + s * (1.75 - 0.5 * s) / (20.0 * 1.75)
    assert shape[:, 2] == pytest.approx(-deep, abs=0.3 / nodes**2)
    assert shape[:, 3] == pytest.approx(WEIGHT * (1.0 - s / 1.75), abs=1e-6 * WEIGHT)
    assert model.shape(2)[:, :3] == pytest.approx(model.positions()[[0, -1]], abs=1e-12)


@pytest.mark.parametrize(
    ("name", "changes", "duration"),
    [
        ("basin_chain", {}, 8.0),  # goes slack
        ("hard/whirl", {}, 12.0),  # in space
        ("hard/loops", {"cable.bending_stiffness": 500.0, "top.motion": [SURGE]}, 5.0),  # what bending adds is not little
    ],
)
def test_they_lie_between_the_largest_and_the_smallest_of_the_outputs(name, changes, duration):
    run = simulate(CableChain(with_values(load(name), changes)), duration)
    largest, smallest = run["cable.tension_max"], run["cable.tension_min"]
    little = 1e-9 * largest.max()
    inner = run.tensions[:, 1:-1]
    assert np.ptp(largest) > 0.1 * largest.mean()
    assert (inner.max(axis=1) <= largest + little).all()
    assert (inner.min(axis=1) >= smallest - little).all()
    assert (inner.max(axis=1) >= 0.8 * largest).all()
    assert run.tensions[:, -1] == pytest.approx(run["top.tension"], abs=little)
    assert run.tensions[:, 0] == pytest.approx(run["body.tension"], abs=little)


def test_they_lead_on_over_time_that_waits_for_an_internal_step():
    model, motion = CableChain(load("hanging_chain")), motion_of(load("hanging_chain"))
    model.initialize(motion(0.0, 1))
    times = [*np.linspace(0.0, 2.0, 201), 2.001]
    for before, after in itertools.pairwise(times):
        model.advance(before, after - before, motion(before, 1), motion(after, 1))
    assert model.state[header.PENDING] == pytest.approx(0.001)
    assert model.nodes()[-1] == pytest.approx([*motion(2.001, 1)[:3], model.outputs[OUTPUTS.index("top.tension")]], rel=1e-12)


def test_a_straight_cable_has_a_straight_line_of_tensions():
    model = TowCable(with_values(generic_scene(), {"current.speed": 0.5}))
    model.initialize(np.zeros(9))
    shape = model.shape()
    ends = [model.outputs[OUTPUTS.index(f"{end}.tension")] for end in ("body", "top")]
    assert shape[:, 3] == pytest.approx(np.linspace(*ends, 11), rel=1e-12)
    assert np.diff(shape, axis=0) == pytest.approx(np.tile(np.diff(shape[:2], axis=0), (10, 1)), abs=1e-9)


# -- FMUs


@pytest.mark.parametrize("flavour", FLAVOURS)
@pytest.mark.parametrize("kind", [CableChain, TowCable])
def test_every_fmu_tells_the_shape_of_the_library_where_it_is_asked_for(request, flavour, kind):
    fmu: Fmu = request.getfixturevalue(flavour)[kind.name]
    model, instance = kind(generic_scene()), fmu.instance()
    places = [fmu.references[name] for name in SHAPE]
    model.initialize(sway(0.0))
    instance.slave.setupExperiment(startTime=0.0)
    with pytest.raises(FMICallException):
        instance.slave.getReal(places)
    instance.slave.enterInitializationMode()
    instance.set_inputs(sway(0.0))
    assert instance.slave.getReal(places) == pytest.approx(model.shape().ravel(), abs=1e-9)
    instance.slave.exitInitializationMode()
    for k in range(20):
        instance.step(0.05 * k, 0.05, sway(0.05 * k))
        model.step(0.05 * k, 0.05, sway(0.05 * k))
        if k in (3, 4, 19):
            told = instance.slave.getReal(places)
            assert told == pytest.approx(model.shape().ravel(), rel=1e-12, abs=1e-9)
            assert instance.slave.getReal(places[5:6]) == told[5:6]
    saved = instance.slave.getFMUstate()
    instance.step(1.0, 0.05, sway(1.0))
    assert instance.slave.getReal(places) != told
    instance.slave.setFMUstate(saved)
    assert instance.slave.getReal(places) == told
    assert instance.get("shape.tension[11]") == pytest.approx(instance.get("top.tension"), rel=1e-12)
    instance.close()


@pytest.mark.parametrize("flavour", FLAVOURS)
def test_what_the_shape_is_after_a_failed_step_is_not_told(request, flavour):
    """Nor when the simulation has been ended then."""
    instance = request.getfixturevalue(flavour)["chain"].instance()
    instance.initialize({}, np.zeros(19))
    instance.step(0.0, 0.05, np.zeros(19))
    given = np.zeros(19)
    given[1] = 1.0  # out of the plane
    with pytest.raises(FMICallException):
        instance.step(0.05, 0.05, given)
    for end in (lambda: None, instance.slave.terminate):
        end()
        with pytest.raises(FMICallException):
            instance.get("shape.x[1]")
        assert instance.errors[-1] == "shape.x[1]: must be asked for before a step fails. Restore a state, or reset the FMU."
    with pytest.raises(FMICallException):
        instance.slave.doStep(0.05, 0.05)
    assert instance.errors[-1].startswith("instance = 'failed and terminated': must be initialized and running.")
    instance.slave.freeInstance()


@pytest.mark.parametrize("flavour", FLAVOURS)
def test_the_shape_of_a_run_that_was_ended_is_that_of_its_last_step(request, flavour):
    fmu = request.getfixturevalue(flavour)["chain"]
    asked, late = (started(fmu) for _ in range(2))
    expected = [asked.get(name) for name in SHAPE]
    for instance in (asked, late):
        instance.slave.terminate()
        assert [instance.get(name) for name in SHAPE] == expected
        instance.slave.freeInstance()


@pytest.mark.parametrize("kind", [CableChain, TowCable])
def test_a_shape_of_fewer_than_its_two_ends_is_refused(kind):
    model = kind(generic_scene())
    model.initialize(np.zeros(9))
    with pytest.raises(ParameterError, match=r"^count = 1 points: must be >= 2\. "):
        model.shape(1)


def test_a_moored_cable_lies_where_its_shape_says():
    """In a baked scene: on the bottom from the anchor to where it lifts off."""
    model = CableChain(from_dict({
        "cable": {"length": 200.0, "diameter": 0.1, "mass_per_length": 50.0, "axial_stiffness": 1e8},
        "lower_end": {"anchored": True, "x": -180.0, "z": -50.0}, "water": {}, "seabed": {"level": -50.0, "stiffness": 1e6},
    }))  # fmt: skip
    model.initialize(np.zeros(9))
    shape = model.shape(41)
    assert shape[:8, 2] == pytest.approx(-50.0, abs=0.01)
    assert shape[0, 0] == pytest.approx(-180.0, abs=1e-6)
    assert np.linalg.norm(np.diff(shape[:, :3], axis=0), axis=1) == pytest.approx(5.0, rel=5e-3)
