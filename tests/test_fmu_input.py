"""Bad input: one clear error each, whole; and the FMU still terminates, resets and runs again.  No error may harm the host."""

from __future__ import annotations

import math
import subprocess
import sys
import textwrap
from pathlib import Path

import numpy as np
import pytest
from fmu_support import ERROR, FMICallException, Fmu, recovers, refused, started, sway, undisturbed_runs

from cable_model.signals import INPUTS
from fmu_src.build import build as build_fmu
from fmu_src.interface import generic_scene
from fmu_src.state import SavedState, StateError, pack, unpack

STEP = 0.05
CONNECTED = "Check what is connected to this input."


def with_input(name: str, value: float) -> np.ndarray:
    inputs = sway(5 * STEP)
    inputs[INPUTS.index(name)] = value
    return inputs


BAD_STEPS = {
    "nan": (5 * STEP, STEP, with_input("top.x", math.nan), f"top.x = nan m: must be finite. {CONNECTED}"),
    "inf": (5 * STEP, STEP, with_input("top.vz", math.inf), f"top.vz = inf m/s: must be finite. {CONNECTED}"),
    "unused": (5 * STEP, STEP, with_input("top.ay", -math.inf), f"top.ay = -inf m/s2: must be finite. {CONNECTED}"),
    "zero": (5 * STEP, 0.0, sway(5 * STEP), "communication step = 0 s: must be finite and > 0. Give a positive step."),
    "negative": (5 * STEP, -0.1, sway(5 * STEP), "communication step = -0.1 s: must be finite and > 0. Give a positive step."),
    "nan step": (5 * STEP, math.nan, sway(5 * STEP), "communication step = nan s: must be finite and > 0. Give a positive step."),
    "inf step": (5 * STEP, math.inf, sway(5 * STEP), "communication step = inf s: must be finite and > 0. Give a positive step."),
    "too late": (
        6 * STEP, STEP, sway(6 * STEP),
        "communication point = 0.3 s: must be 0.25 s, where the last step ended. Go on from there, or restore a state.",
    ),
    "again": (
        4 * STEP, STEP, sway(4 * STEP),
        "communication point = 0.2 s: must be 0.25 s, where the last step ended. Go on from there, or restore a state.",
    ),
    "nan time": (
        math.nan, STEP, sway(5 * STEP), "communication point = nan s: must be finite. Give the time at which the step begins.",
    ),
}  # fmt: skip
BAD_PARAMETERS = {
    "negative length": ({"cable.length": -3.0}, "cable.length = -3 m: must be > 0. Give the unstretched length."),
    "nan": ({"cable.mass_per_length": math.nan}, "cable.mass_per_length = nan kg/m: must be finite. Give the mass per unstretched length."),
    "inf": ({"body.mass": math.inf}, "body.mass = inf kg: must be finite. Give the mass of the body (0 = free end)."),
    "zero step": ({"solver.time_step": 0.0}, "solver.time_step = 0 s: must be > 0. Give a step above 0."),
    "order": (
        {"top.motion_order": 3},
        "top.motion_order = 3: must be >= 0 and <= 2. Give the connected inputs: 0 position, 1 and velocity, 2 and acceleration.",
    ),
    "bodiless volume": (
        {"body.mass": 0.0},
        "body.mass = 0 kg: must be > 0 for a body with volume, drag area or added mass. Give the body's mass, or remove all of [body].",
    ),
    "wave of the FMU's name": (
        {"wave.amplitude": -1.0}, "wave.amplitude = -1 m: must be >= 0. Give the amplitude of the wave (0 = none).",
    ),
    "volume between none and its default": (
        {"cable.volume_per_length": -0.5},
        "cable.volume_per_length = -0.5 m2: must be -1 or >= 0. Give the displaced volume per length, as of a chain (-1 = that of the "
        "diameter).",
    ),
    "weightless waves": (
        {"environment.gravity": 0.0, "wave.amplitude": 1.0}, "environment.gravity = 0 m/s2: must be > 0 with waves. Give gravity.",
    ),
    "current without water": (
        {"water.density": 0.0, "current.speed": 1.0}, "current.speed = 1 m/s: must be 0 without water. Add [water] or remove [current].",
    ),
}  # fmt: skip
ON_SEABED = {"seabed.level": 5.0, "seabed.stiffness": 1e5}
ACROSS = {"lower_end.anchored": True, "lower_end.y": 60.0, "lower_end.z": -79.9} | dict.fromkeys(
    ("body.mass", "body.volume", "body.drag_area", "body.added_mass"), 0.0
)
USE_CHAIN = "which has no use for it. Leave it, or use CableChain."
BAD_FOR_ONE = {
    "chain": {
        "zero nodes": ({"solver.nodes": 0}, "solver.nodes = 0: must be >= 3 and <= 100000. Give the number of nodes of the chain."),
        "code": (
            {"solver.grid": 7}, "solver.grid = 7: must be a whole number from 0 to 1. Codes: finite-difference grid (CableChain only): "
            "0 staggered, 1 box.",
        ),
        "anchored body": (
            {"lower_end.anchored": True},
            "body.mass = 500 kg: must be 0 at an anchored end. Remove [body], in an FMU by zeros of all its values, or lower_end.anchored.",
        ),
        "grading": (
            {"solver.grading": 0.5},
            "solver.grading = 0.5: must be 0 or >= 1 and <= 4. Take 0 (automatic), 1 (uniform) or 2 (a free end).",
        ),
        "level of no seabed": (
            {"seabed.level": -50.0}, "seabed.stiffness = 0 Pa/m: must be > 0 for a seabed. Give the stiffness, or remove [seabed].",
        ),
        "damping of no seabed": (
            {"seabed.damping_ratio": 0.5}, "seabed.stiffness = 0 Pa/m: must be > 0 for a seabed. Give the stiffness, or remove [seabed].",
        ),
        "place of a free end": (
            {"lower_end.x": 20.0}, "lower_end.anchored = False: must be true for a lower end that has a place. "
            "Set lower_end.anchored = true, or remove lower_end.x, y and z.",
        ),
        "top below the seabed": (ON_SEABED, "top.z = 0 m: must be >= seabed.level = 5. Lower the seabed or lift the top."),
        "anchor out of the plane": (
            ACROSS,
            "lower_end.y = 60 m: must be top.y = 0 in the plane. Set solver.space = true, or turn the axes so that x is along it.",
        ),
        "the other's": (
            {"tow.drag_segments": 20},
            "tow.drag_segments = 20: must be 10 for CableChain, which has no use for it. Leave it, or use TowCable.",
        ),
    },
    "tow": {
        "nodes": ({"solver.nodes": 101}, f"solver.nodes = 101: must be 51 for TowCable, {USE_CHAIN}"),
        "anchor": ({"lower_end.anchored": True}, f"lower_end.anchored = True: must be false for TowCable, {USE_CHAIN}"),
        "bending": ({"cable.bending_stiffness": 30.0}, f"cable.bending_stiffness = 30 N.m2: must be 0 for TowCable, {USE_CHAIN}"),
        "seabed": (ON_SEABED, f"seabed.level = 5 m: must be 0 for TowCable, {USE_CHAIN}"),
        "axial drag of a sphere": (
            {"tow.drag_area_axial": 0.7}, "tow.body_angle = 18 rad: must be <= pi for a disk's drag along its axis. "
            "Give the angle of the disk, or remove tow.drag_area_axial.",
        ),
        "not a number": ({"cable.bending_stiffness": math.nan}, f"cable.bending_stiffness = nan N.m2: must be 0 for TowCable, {USE_CHAIN}"),
    },
}  # fmt: skip
BAD_PARAMETERS_OF = [(model, case) for model, own in BAD_FOR_ONE.items() for case in (*BAD_PARAMETERS, *own)]


def bad_parameters(model: str, case: str) -> tuple[dict[str, float], str]:
    """Values, and the error that they get."""
    return (BAD_PARAMETERS | BAD_FOR_ONE[model])[case]


@pytest.fixture(scope="module")
def undisturbed(fmus: dict[str, Fmu]) -> dict[str, np.ndarray]:
    return undisturbed_runs(fmus)


@pytest.mark.parametrize("case", BAD_STEPS)
def test_a_bad_step_is_one_error_that_names_the_rule(fmu: Fmu, undisturbed: dict[str, np.ndarray], capfd: pytest.CaptureFixture, case: str):
    time, step, inputs, text = BAD_STEPS[case]
    instance = started(fmu)
    before = instance.outputs()
    with pytest.raises(FMICallException) as error:
        instance.step(time, step, inputs)
    assert error.value.status == ERROR
    assert instance.errors == [text]
    assert text in capfd.readouterr().err
    assert np.array_equal(instance.outputs(), before)
    recovers(instance, undisturbed[fmu.path.stem])


def test_after_a_bad_input_the_same_step_can_be_taken_with_a_good_one(fmu: Fmu, undisturbed: dict[str, np.ndarray]):
    instance = started(fmu)
    with pytest.raises(FMICallException):
        instance.step(5 * STEP, STEP, with_input("top.x", math.nan))
    assert np.array_equal(instance.run(5, first=5), undisturbed[fmu.path.stem][5:])
    instance.close()


@pytest.mark.parametrize(("model", "case"), BAD_PARAMETERS_OF)
def test_a_bad_parameter_is_one_error_when_initialization_ends(
    fmus: dict[str, Fmu], undisturbed: dict[str, np.ndarray], model: str, case: str
):
    recovers(refused(fmus[model], *bad_parameters(model, case)), undisturbed[fmus[model].path.stem])


@pytest.mark.parametrize("name", ["top.vx", "top.x"])
def test_a_top_of_a_million_metres_a_second_is_refused(fmu: Fmu, undisturbed: dict[str, np.ndarray], name: str):
    instance = started(fmu)
    with pytest.raises(FMICallException):
        instance.step(5 * STEP, STEP, with_input(name, 1e6))
    (error,) = instance.errors
    assert error.startswith("speed of the top or lower end = ")
    assert error.endswith(" m/s: must be <= 10000. Check the units of its motion, and for jumps.")
    recovers(instance, undisturbed[fmu.path.stem])


def test_a_failed_step_is_an_error_that_lasts_until_reset_or_restore(fmus: dict[str, Fmu], undisturbed: dict[str, np.ndarray]):
    """TowCable keeps to its plane: leaving it is a failure of the step, not of an input."""
    instance = started(fmus["tow"])
    state = instance.slave.getFMUstate()
    with pytest.raises(FMICallException):
        instance.step(5 * STEP, STEP, with_input("top.vy", 0.5))
    (error,) = instance.errors
    assert error.startswith("TowCable at t = 0.25 s: the top, the lower end or a current that inputs give left the vertical plane")
    assert "Keep top.y and lower.y constant" in error
    instance.messages.clear()
    with pytest.raises(FMICallException):
        instance.step(6 * STEP, STEP, sway(6 * STEP))
    assert instance.errors == ["instance = 'failed': must be initialized and running. Initialize, reset or restore it first."]
    instance.slave.setFMUstate(state)
    assert np.array_equal(instance.run(5, first=5), undisturbed["TowCable"][5:])
    recovers(instance, undisturbed["TowCable"])


def test_calls_out_of_turn_are_errors(fmu: Fmu, undisturbed: dict[str, np.ndarray]):
    instance = fmu.instance()
    with pytest.raises(FMICallException):
        instance.slave.doStep(0.0, STEP)
    assert instance.errors == ["instance = 'instantiated': must be initialized and running. Initialize, reset or restore it first."]
    instance.messages.clear()
    instance.initialize()
    with pytest.raises(FMICallException):
        instance.set({"cable.length": 3.0})
    with pytest.raises(FMICallException):
        instance.set({"top.tension": 3.0})
    with pytest.raises(FMICallException):
        instance.set({"effects.active": "all"})
    assert instance.errors == [
        "cable.length = 3 m: must be set before the end of initialization. Reset the FMU first.",
        "top.tension = 3 N: must be left alone: it is calculated. Set inputs and parameters only.",
        "effects.active = 'all': must be left alone: it is calculated. Set inputs and parameters only.",
    ]
    instance.messages.clear()
    instance.slave.terminate()
    with pytest.raises(FMICallException):
        instance.slave.doStep(0.0, STEP)
    assert instance.errors == ["instance = 'terminated': must be initialized and running. Initialize, reset or restore it first."]
    recovers(instance, undisturbed[fmu.path.stem])


def test_unknown_references_and_wrong_types_are_errors_never_numbers(fmu: Fmu, undisturbed: dict[str, np.ndarray]):
    instance = started(fmu)
    nodes = fmu.references["solver.nodes"]
    for call in (
        lambda: instance.slave.getReal([12345]),
        lambda: instance.slave.getReal([nodes]),
        lambda: instance.slave.setReal([12345], [1.0]),
        lambda: instance.slave.getInteger([fmu.references["top.x"]]),
        lambda: instance.slave.getBoolean([nodes]),
        lambda: instance.slave.getString([nodes]),
    ):
        with pytest.raises(FMICallException):
            call()
    unknown = f"value reference = 12345: must be below {len(fmu.references)}. Use the references of modelDescription.xml."
    assert instance.errors == [
        unknown,
        "solver.nodes as Real: must be got and set as Integer. Use the types of modelDescription.xml.",
        unknown,
        "top.x as Integer: must be got and set as Real. Use the types of modelDescription.xml.",
        "solver.nodes as Boolean: must be got and set as Integer. Use the types of modelDescription.xml.",
        "solver.nodes as String: must be got and set as Integer. Use the types of modelDescription.xml.",
    ]
    recovers(instance, undisturbed[fmu.path.stem])


# -- saved states


def test_a_state_that_was_changed_is_refused(fmu: Fmu, undisturbed: dict[str, np.ndarray], capfd: pytest.CaptureFixture):
    instance = started(fmu)
    data = instance.slave.serializeFMUstate(instance.slave.getFMUstate())
    advice = "Restore only what the same FMU has saved."
    for bad, text in (
        (b"rubbish", f"saved state: must begin with CABLEFMU. {advice}"),
        (data[:20], f"saved state = 20 bytes: must be at least 48. {advice}"),
        (data[:-8], f"saved state = {len(data) - 8} bytes: must be {len(data)}. {advice}"),
        (data[:8] + b"\7" + data[9:], f"saved state version = 7: must be 2. {advice}"),
        (data[:-20] + b"\0\1\2\3" + data[-16:], "saved state: must have its checksum. It was changed; restore only what"),
    ):
        with pytest.raises(FMICallException):
            instance.slave.deSerializeFMUstate(bad)
        assert text in capfd.readouterr().err
        assert any(text in message for _, message in instance.messages)
    assert np.array_equal(instance.run(5, first=5), undisturbed[fmu.path.stem][5:])
    recovers(instance, undisturbed[fmu.path.stem])


def test_a_state_of_another_fmu_is_refused(fmus: dict[str, Fmu], tmp_path: Path, capfd: pytest.CaptureFixture):
    other = Fmu(build_fmu("chain", generic_scene(), tmp_path / "Other.fmu"), tmp_path / "x").instance()
    other.initialize()
    data = other.slave.serializeFMUstate(other.slave.getFMUstate())
    instance = started(fmus["chain"])
    with pytest.raises(FMICallException):
        instance.slave.deSerializeFMUstate(data)
    assert "saved state: must be of this build of the FMU." in capfd.readouterr().err
    instance.close()
    other.close()


def test_a_packed_state_comes_back_bit_for_bit():
    saved = SavedState(2, np.array([0.1, -0.0, 1e-310]), np.array([3.0]), np.array([np.pi, np.inf]))
    back = unpack(pack(saved, b"0123456789abcdef"), b"0123456789abcdef")
    assert back.phase == 2
    for name in ("numbers", "parameters", "model"):
        assert getattr(back, name).tobytes() == getattr(saved, name).tobytes()
    with pytest.raises(StateError, match="must be of this build"):
        unpack(pack(saved, b"0123456789abcdef"), b"0123456789abcdeF")


# -- the host


def test_the_host_survives_hundreds_of_errors_and_instances(fmus: dict[str, Fmu]):
    """Each error of pythonfmu's wrapper frees what it does not own: without the cure this process dies."""
    program = textwrap.dedent(
        f"""
        import gc, math, sys
        sys.path.insert(0, {str(Path(__file__).parent)!r})
        import fmpy
        from pathlib import Path
        from fmu_support import ERROR, FMICallException, Fmu, sway
        fmu = Fmu(Path({str(fmus["chain"].path)!r}), Path({str(Path(fmus["chain"].folder).parent / "host")!r}))
        errors = 0
        for k in range(60):
            instance = fmu.instance()
            instance.initialize()
            for bad in (0.0, math.nan):
                for again in range(3):
                    try:
                        instance.step(0.0, bad, sway(0.0))
                    except FMICallException:
                        errors += 1
            try:
                instance.slave.deSerializeFMUstate(b"rubbish")
            except FMICallException:
                errors += 1
            if k % 2:
                instance.slave.terminate()
                instance.slave.reset()
                instance.initialize()
                instance.run(2)
            gc.collect()
            if k % 3:
                instance.slave.freeInstance()
        print("alive", errors)
        """
    )
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=False)
    assert (done.returncode, done.stdout.strip().splitlines()[-1:]) == (0, ["alive 420"]), done.stderr[-2000:]


def test_the_host_ends_cleanly_after_one_instance(fmu: Fmu):
    """pythonfmu's wrapper frees its handle on the interpreter twice when it is unloaded; left alone, about half of these abort."""
    program = textwrap.dedent(
        f"""
        import sys
        sys.path.insert(0, {str(Path(__file__).parent)!r})
        from pathlib import Path
        from fmu_support import Fmu
        fmu = Fmu(Path({str(fmu.path)!r}), Path({str(Path(fmu.folder).parent / "end")!r}))
        instance = fmu.instance()
        instance.initialize()
        instance.run(1)
        """
    )
    ends = [subprocess.run([sys.executable, "-c", program], capture_output=True, check=False).returncode for _ in range(5)]
    assert ends == [0] * 5


def test_log_texts_are_safe_as_printf_formats(fmu: Fmu):
    program = textwrap.dedent(
        f"""
        import sys
        sys.path.insert(0, {str(Path(fmu.folder) / "resources")!r})
        name = open({str(Path(fmu.folder) / "resources" / "slavemodule.txt")!r}).read().strip()
        slave = getattr(__import__(name), {fmu.path.stem!r})(instance_name="50%s", resources="")
        slave.log("100 %s of %n")
        print(slave.log_queue[-1].msg)
        try:
            slave.set_real([0, 1], ["%s"])
        except Exception as error:
            print("%%s" in str(error) or "%" not in str(error))
        """
    )
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True)
    assert done.stdout.split("\n")[:2] == ["100 %%s of %%n", "True"]
