"""The built pythonfmu FMUs against the library, and the promises of a co-simulation component: state, reset, steps, versions."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest
from fmu_support import (
    Fmu,
    a_mooring_follows_the_top_during_initialization,
    assert_same,
    fresh,
    goes_back_before_initialization,
    goes_on_from_a_state_saved_in_a_sliver,
    outputs_follow_what_is_set_during_initialization,
    sway,
)
from native_support import lean

from cable_model.fmu_check import sampled_motion, simulate_fmu
from cable_model.models import MODELS
from cable_model.motion import PrescribedMotion, motion_of
from cable_model.parameters import Motion, Top
from cable_model.signals import OUTPUTS
from fmu_src.build import build as build_fmu
from fmu_src.interface import generic_scene, scene_from_values

ROOT = Path(__file__).resolve().parent.parent
SCENES = [("chain", "hanging_chain"), ("tow", "dale_sphere")]
LONGER = [("chain", "towed_body"), ("chain", "dale_sphere"), ("chain", "free_chain"), ("tow", "towed_body")]
SCENES += [pytest.param(*case, marks=pytest.mark.long) for case in LONGER]
SMOOTH = PrescribedMotion(
    Top(
        motion=tuple(
            Motion(kind="sinusoid", axis=axis, amplitude=1.0, angular_frequency=2.0 * math.pi / 7.0, phase=phase, ramp_time=8.0)
            for axis, phase in (("x", 0.0), ("z", 0.7))
        )
    )
)
KEYS = {"CableChain": "chain", "TowCable": "tow"}
LONE_CHANGES = {"cable.length": 40.0, "solver.time_step": 0.02, "water.density": 1000.0}
LAID_OUT = {
    "lower_end.anchored": True, "lower_end.x": 60.0, "lower_end.z": -60.0, "body.mass": 0.0, "body.volume": 0.0, "body.drag_area": 0.0,
    "body.added_mass": 0.0, "seabed.level": -60.0, "seabed.stiffness": 1e5, "seabed.friction_coefficient": 0.5,
    "seabed.laid_from_anchor": True,
}  # fmt: skip


def library(fmu: Fmu, values: dict[str, object] | None = None):
    """The library's model that an FMU with these parameters stands for."""
    return MODELS[KEYS[fmu.path.stem]](scene_from_values(generic_scene(), values or {}, KEYS[fmu.path.stem]))


@pytest.mark.parametrize(("key", "name"), SCENES)
def test_shipped_scenes_give_in_an_fmu_what_the_library_gives(tmp_path: Path, key: str, name: str):
    """fmpy's own simulation loop, the library's steps; numba compiles the kernels in the FMU, the library runs on object code."""
    scene = lean(name, key)
    path = build_fmu(key, scene, tmp_path / f"{name}.fmu", precompile=False)
    step, count = scene.run.output_step, 40
    times, inputs = sampled_motion(motion_of(scene), count * step, step)
    columns, table = simulate_fmu(path, times, inputs)
    model = MODELS[key](scene)
    model.initialize(inputs[0])
    rows = [model.outputs.copy()]
    for k in range(count):
        model.step(times[k], times[k + 1] - times[k], inputs[k])
        rows.append(model.outputs.copy())
    first = columns.index(OUTPUTS[0])
    assert table[:, 0] == pytest.approx(times, abs=1e-9)
    scale = np.abs(np.array(rows)).max(axis=0) + 1e-300
    assert (np.abs(table[:, first : first + len(OUTPUTS)] - rows) / scale).max() < 1e-9


def test_steps_are_the_librarys_within_rounding(fmu: Fmu):
    """To 1e-12 of each signal's size; both on one object code, which test_fmu_native.py holds against what numba compiles."""
    model, instance = library(fmu, LONE_CHANGES), fmu.instance()
    instance.initialize(LONE_CHANGES, sway(0.0))
    model.initialize(sway(0.0))
    found, expected = [instance.outputs()], [model.outputs.copy()]
    for k in range(40):
        model.step(k * 0.05, 0.05, sway(k * 0.05))
        expected.append(model.outputs.copy())
        found.append(instance.step(k * 0.05, 0.05, sway(k * 0.05)))
    assert_same(np.array(found), np.array(expected))
    instance.close()


def test_it_hangs_in_equilibrium_under_the_start_values_of_the_inputs(fmu: Fmu):
    instance = fmu.instance()
    instance.initialize({"top.x": 3.0, "top.z": -2.0})
    scene = generic_scene()
    area = 0.25 * math.pi * scene.cable.diameter**2
    weight = (scene.body.mass - 1025.0 * scene.body.volume) + (scene.cable.mass_per_length - 1025.0 * area) * scene.cable.length
    assert instance.get("top.force_z") == pytest.approx(-weight * scene.environment.gravity, rel=1e-9)
    assert instance.get("top.tension") == pytest.approx(weight * scene.environment.gravity, rel=1e-9)
    assert instance.get("body.x") == pytest.approx(3.0, abs=1e-9)
    assert instance.get("body.z") == pytest.approx(-2.0 - scene.cable.length, rel=1e-3)
    assert "body (body.mass = 500 kg)" in str(instance.get("effects.active"))
    assert any("simulates: body (body.mass = 500 kg)" in text for _, text in instance.messages)
    instance.close()


def test_outputs_read_during_initialization_follow_what_is_set_then(fmu: Fmu):
    outputs_follow_what_is_set_during_initialization(fmu)


def test_a_mooring_follows_the_top_that_is_set_during_initialization(fmus: dict[str, Fmu]):
    a_mooring_follows_the_top_during_initialization(fmus["chain"])


# -- instances


def test_two_instances_share_nothing(fmu: Fmu):
    alone = fresh(fmu)
    other = fresh(fmu, values=LONE_CHANGES)
    one, two = fmu.instance(), fmu.instance()
    one.initialize(None, sway(0.0))
    two.initialize(LONE_CHANGES, sway(0.0))
    for k in range(20):
        assert np.array_equal(one.step(k * 0.05, 0.05, sway(k * 0.05)), alone[k])
        assert np.array_equal(two.step(k * 0.05, 0.05, sway(k * 0.05)), other[k])
    one.close()
    assert np.array_equal(two.run(1, first=20), fresh(fmu, 21, LONE_CHANGES)[20:])
    two.close()


def test_a_reset_instance_is_a_new_one(fmu: Fmu):
    instance = fmu.instance()
    instance.initialize(LONE_CHANGES, sway(0.0))
    instance.run(10)
    instance.slave.reset()
    assert [instance.get(name) for name in LONE_CHANGES] == [100.0, 0.01, 1025.0]
    assert instance.get("top.x") == 0.0
    instance.initialize(None, sway(0.0))
    assert np.array_equal(instance.run(20), fresh(fmu))
    instance.slave.terminate()
    instance.slave.reset()
    instance.initialize(None, sway(0.0))
    assert np.array_equal(instance.run(20), fresh(fmu))
    instance.close()


def test_a_second_instantiation_gives_the_same(fmu: Fmu):
    assert np.array_equal(fresh(fmu), fresh(fmu))


# -- state


def test_a_restored_run_is_bit_identical(fmu: Fmu):
    instance = fmu.instance()
    instance.initialize(LONE_CHANGES, sway(0.0))
    instance.run(10)
    state = instance.slave.getFMUstate()
    kept = instance.outputs()
    ahead = instance.run(20, first=10)
    instance.slave.setFMUstate(state)
    assert np.array_equal(instance.outputs(), kept)
    assert np.array_equal(instance.run(20, first=10), ahead)
    instance.slave.reset()
    instance.slave.setFMUstate(state)
    assert instance.get("cable.length") == 40.0
    assert np.array_equal(instance.run(20, first=10), ahead)
    instance.slave.freeFMUstate(state)
    instance.close()


def test_a_state_saved_in_a_sliver_goes_on_bit_for_bit(fmu: Fmu):
    goes_on_from_a_state_saved_in_a_sliver(fmu)


def test_a_serialized_state_goes_on_in_another_instance(fmu: Fmu):
    one, two = fmu.instance(), fmu.instance()
    one.initialize(LONE_CHANGES, sway(0.0))
    one.run(10)
    data = one.slave.serializeFMUstate(one.slave.getFMUstate())
    ahead = one.run(20, first=10)
    one.close()
    two.slave.setFMUstate(two.slave.deSerializeFMUstate(data))
    assert np.array_equal(two.run(20, first=10), ahead)
    assert two.slave.serializeFMUstate(two.slave.getFMUstate()) != data
    two.close()


def test_a_serialized_state_has_the_friction_of_a_cable_on_the_seabed(fmus: dict[str, Fmu]):
    one, two = fmus["chain"].instance(), fmus["chain"].instance()
    one.initialize(LAID_OUT, sway(0.0))
    one.run(10)
    data = one.slave.serializeFMUstate(one.slave.getFMUstate())
    ahead = one.run(20, first=10)
    two.slave.setFMUstate(two.slave.deSerializeFMUstate(data))
    assert np.array_equal(two.run(20, first=10), ahead)
    one.close()
    two.close()


def test_a_state_from_before_initialization_takes_one_back_there(fmu: Fmu):
    goes_back_before_initialization(fmu)


def test_the_state_holds_no_pickle_and_is_read_by_its_head(fmu: Fmu):
    instance = fmu.instance()
    instance.initialize()
    data = instance.slave.serializeFMUstate(instance.slave.getFMUstate())
    assert data[:8] == b"CABLEFMU"
    assert int.from_bytes(data[8:12], "little") == 2
    instance.close()


# -- communication step


def few_nodes(fmu: Fmu) -> dict[str, object]:
    """So that a chain is fast; the straight cable has none."""
    return {"solver.nodes": 21} if KEYS[fmu.path.stem] == "chain" else {}


def deviation(fmu: Fmu, order: int, step: float, duration: float) -> np.ndarray:
    """Rms deviation of force_x, force_z, body.x, body.z from a run whose top is known exactly, over their half ranges."""
    # a top in water: forces have kinks of their own where it heaves through z = 0
    values = {"top.motion_order": order, "solver.time_step": 0.003125, "water.surface": False, **few_nodes(fmu)}
    if few_nodes(fmu):
        # a cable whose own waves, which the samples excite, die out as they did under the slack law's damping 0.1 h sqrt(EA m)
        values |= {"cable.axial_damping": 1.3e3}
    watched = [OUTPUTS.index(name) for name in ("top.force_x", "top.force_z", "body.x", "body.z")]
    model, instance = library(fmu, values), fmu.instance()
    instance.initialize(values, SMOOTH(0.0))
    model.initialize(SMOOTH(0.0))
    rows = []
    for k in range(round(duration / step)):
        time = k * step
        model.advance(time, step, SMOOTH(time), SMOOTH((k + 1) * step))
        rows.append((instance.step(time, step, SMOOTH(time))[watched], model.outputs[watched]))
    instance.close()
    got, exact = np.array(rows).transpose(1, 0, 2)
    return np.sqrt(np.mean((got - exact) ** 2, axis=0)) / (0.5 * np.ptp(exact, axis=0))


@pytest.mark.parametrize("order", [0, 1, 2])
def test_error_of_sampled_inputs_falls_with_the_fourth_power_of_the_communication_step(fmu: Fmu, order: int):
    """Positions to 0.15 of order 4; forces, which ring with the cable's own waves, at order 2 or better between ends."""
    steps = np.array([0.2, 0.1, 0.05, 0.025])
    errors = np.array([deviation(fmu, order, step, 14.0) for step in steps])
    forces = np.log(errors[0, :2] / errors[-1, :2]) / np.log(steps[0] / steps[-1])
    assert (forces > 2.0).all()
    assert np.log2(errors[1, 3] / errors[2, 3]) == pytest.approx(4.0, abs=0.15)
    assert errors[2].max() < 1.0e-3


def test_what_is_extrapolated_exactly_does_not_depend_on_the_communication_step(fmu: Fmu):
    """A top of constant velocity: the same internal steps, whatever the communication step."""
    values = {"solver.time_step": 0.0125, **few_nodes(fmu)}

    def tow(time: float) -> np.ndarray:
        return np.array([0.3 * time, 0.0, 0.1 * time, 0.3, 0.0, 0.1, 0.0, 0.0, 0.0])

    ends = []
    for step in (0.0125, 0.025, 0.1, 0.5):
        instance = fmu.instance()
        instance.initialize(values, tow(0.0))
        for k in range(round(2.0 / step)):
            row = instance.step(k * step, step, tow(k * step))
        ends.append(row[: OUTPUTS.index("solver.steps")])
        instance.close()
    scale = np.abs(ends[0]) + 1e-6 * np.abs(ends[0]).max()
    assert (np.abs(np.array(ends[1:]) - ends[0]) / scale).max() < 1e-6


def test_any_step_is_taken(fmu: Fmu):
    instance, model = fmu.instance(), library(fmu)
    instance.initialize(None, SMOOTH(0.0))
    model.initialize(SMOOTH(0.0))
    time, random = 0.0, np.random.default_rng(1)
    for step in (1e-6, 0.001, *random.uniform(0.005, 0.08, 100), 0.2, 1e-3):
        got = instance.step(time, step, SMOOTH(time))
        model.advance(time, step, SMOOTH(time), SMOOTH(time + step))
        time += step
    for name in ("body.x", "body.z"):
        assert got[OUTPUTS.index(name)] == pytest.approx(model.outputs[OUTPUTS.index(name)], abs=0.02)
    instance.close()
