"""The native FMUs: the numbers of the library, complete states, clear errors, and no Python where they run."""

from __future__ import annotations

import random
import shutil
import subprocess
import sys
import zipfile
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import fmpy
import numba
import numpy as np
import pytest
from fmpy.validation import validate_fmu
from fmu_support import FMICallException, Fmu, Instance, assert_same, sway
from test_fmu_input import BAD_PARAMETERS, BAD_STEPS, STEP

from cable_model.effects import effects, one_line
from cable_model.errors import ParameterError
from cable_model.kernels import jit
from cable_model.kernels.parts import PARAMETERS
from cable_model.models import MODELS
from cable_model.motion import top_motion
from cable_model.scene import Scene, load, numbers_of, parts_of, with_values
from cable_model.signals import INPUTS, OUTPUTS
from fmu_src.entries import ABSENT, PRESENT
from fmu_src.interface import generic_scene, scene_from_values, table
from fmu_src.native import build, export, object_code
from fmu_src.native.rules import Literal, Rules

ROOT = Path(__file__).resolve().parent.parent
STEPS = 20 if numba.config.DISABLE_JIT else 300
KEYS = {"CableChain": "chain", "TowCable": "tow"}
SCENES = [("chain", "hanging_chain"), ("chain", "towed_body"), ("tow", "dale_sphere"), ("tow", "towed_body")]
ANCHORED = {
    "lower_end.anchored": True, "lower_end.x": 60.0, "lower_end.z": -60.0, "body.mass": 0.0, "body.volume": 0.0,
    "body.drag_area": 0.0, "body.added_mass": 0.0,
}  # fmt: skip
DRY = {"water.density": 0.0}
# few sets of parts, because the library compiles each of them
CASES: dict[str, tuple[str, dict[str, Any]]] = {
    "chain as it is": ("chain", {}),
    "chain, positions only": ("chain", {"top.motion_order": 0}),
    "chain, accelerations too": ("chain", {"top.motion_order": 2}),
    "chain, error control": ("chain", {"solver.tolerance": 1e-3, "solver.time_step": 0.05}),
    "chain, other integrator": ("chain", {"solver.integrator": 1, "solver.grading": 2.0}),
    "chain, waves, bending, damping": (
        "chain",
        {"current.speed": -0.7, "wave.amplitude": 1.0, "wave.period": 7.0, "wave.phase": 0.3}
        | {"cable.bending_stiffness": 30.0, "cable.axial_damping": 1e4},
    ),
    "chain, dry, anchored, compressible": ("chain", ANCHORED | DRY | {"cable.compressible": True}),
    "chain in space, anchored": (
        "chain",
        ANCHORED | {"solver.space": True, "lower_end.y": 20.0, "current.speed": 0.5, "current.direction": 1.0, "wave.amplitude": 0.5},
    ),
    "tow as it is": ("tow", {}),
    "tow, dry, no cable mass": ("tow", DRY | {"tow.cable_mass": False}),
    "tow, current and waves": ("tow", {"current.speed": -0.7, "wave.amplitude": 1.0, "cable.axial_damping": 1e4}),
    "tow as printed, explicit": ("tow", {"tow.as_printed": True, "tow.explicit": True, "tow.added_mass_vertical": 5.0}),
}

pytestmark = [
    pytest.mark.skipif(build.compiler() is None or sys.platform != "linux", reason="native FMUs need Linux and a C compiler"),
    pytest.mark.xdist_group("native"),  # one worker compiles the FMUs, once
]


@pytest.fixture(scope="session")
def native(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Fmu]:
    """The generic native FMUs, by the model's key."""
    folder = tmp_path_factory.mktemp("native")
    return {KEYS[path.stem]: Fmu(path, folder / path.stem) for path in build.build_all(folder)}


@pytest.fixture(params=sorted(MODELS))
def fmu(request: pytest.FixtureRequest, native: dict[str, Fmu]) -> Fmu:
    return native[request.param]


def library_of(fmu: Fmu) -> Path:
    return Path(fmu.folder) / "binaries" / "linux64" / f"{fmu.path.stem}.so"


def values_of(scene: Scene) -> dict[str, Any]:
    """The parameter values that make a generic FMU simulate a scene."""
    return {row.name: row.start for row in table(scene) if row.causality == "parameter"}


def started(fmu: Fmu, values: dict[str, Any] | None = None, steps: int = 5) -> Instance:
    instance = fmu.instance()
    instance.initialize(values, sway(0.0))
    instance.run(steps)
    instance.messages.clear()
    return instance


def library_run(key: str, scene: Scene, inputs: np.ndarray, step: float) -> np.ndarray:
    """Outputs of the library under inputs (steps, 9) as FMI gives them, with the start first."""
    model = MODELS[key](scene)
    model.initialize(inputs[0])
    rows = [model.outputs.copy()]
    for k, row in enumerate(inputs):
        model.step(k * step, step, row)
        rows.append(model.outputs.copy())
    return np.array(rows)


def native_run(instance: Instance, values: dict[str, Any], inputs: np.ndarray, step: float) -> np.ndarray:
    instance.initialize(values, inputs[0])
    return np.array([instance.outputs(), *(instance.step(k * step, step, row) for k, row in enumerate(inputs))])


# -- the archive


def test_a_native_fmu_is_a_valid_fmu_below_200_kilobytes(fmu: Fmu):
    assert validate_fmu(str(fmu.path)) == []
    assert fmu.path.stat().st_size < 200_000


def test_a_native_fmu_describes_itself_as_the_python_fmu_does(fmu: Fmu, fmus: dict[str, Fmu]):
    def description(path: Path) -> str:
        with zipfile.ZipFile(path) as archive:
            root = ElementTree.fromstring(archive.read("modelDescription.xml"))
        for name in ("guid", "generationTool"):
            assert root.attrib.pop(name)
        capabilities = root.find("CoSimulation")
        assert capabilities is not None
        del capabilities.attrib["canNotUseMemoryManagementFunctions"]
        return ElementTree.canonicalize(ElementTree.tostring(root, encoding="unicode"), strip_text=True)

    key = KEYS[fmu.path.stem]
    assert description(fmu.path) == description(fmus[key].path)


def test_the_library_needs_only_libc_and_libm_and_exports_only_fmi(fmu: Fmu):
    def names(*options: str) -> set[str]:
        done = subprocess.run(["nm", "-D", *options, str(library_of(fmu))], capture_output=True, text=True, check=True)
        return {line.split()[-1] for line in done.stdout.splitlines()}

    exported = names("--defined-only")
    assert len(exported) == 34
    assert all(name.startswith("fmi2") for name in exported)
    wanted = {name.split("@")[0] for name in names("--undefined-only")}
    assert not {name for name in wanted if name.startswith(("Py", "_Py", "NRT", "numba"))}
    done = subprocess.run(["ldd", str(library_of(fmu))], capture_output=True, text=True, check=True)
    loaded = {line.split()[0].rpartition("/")[2].split(".")[0] for line in done.stdout.splitlines()}
    assert loaded <= {"linux-vdso", "libm", "libc", "ld-linux-x86-64"}


def test_the_library_names_no_folder_of_this_machine(fmu: Fmu):
    code = library_of(fmu).read_bytes()
    for folder in (ROOT, Path(sys.prefix), Path(numba.__file__).parent, Path.home()):
        assert len(folder.parts) < 3 or str(folder).encode() not in code


def test_the_same_kernels_give_the_same_bytes_in_another_process_and_folder(
    native: dict[str, Fmu], monkeypatch: pytest.MonkeyPatch, tmp_path: Path
):
    elsewhere = tmp_path / "a folder with a name of another length"
    for package in ("cable_model", "fmu_src"):
        shutil.copytree(ROOT / package, elsewhere / package, ignore=shutil.ignore_patterns("__pycache__"))
    monkeypatch.setattr(export, "ROOT", elsewhere)
    again = export.export("tow", object_code.GENERIC["tow"])
    monkeypatch.setattr(build, "object_code", lambda model, variants: again)
    assert build.build_native("tow", tmp_path / "TowCable.fmu").read_bytes() == native["tow"].path.read_bytes()


def test_kernels_edited_since_the_process_started_are_not_exported_under_the_old_name(monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr(jit, "source_hash", lambda: "another")
    with pytest.raises(RuntimeError, match="the kernels' sources have changed"):
        export.export("tow", object_code.GENERIC["tow"])


def test_without_a_compiler_the_error_says_what_to_install(monkeypatch: pytest.MonkeyPatch, tmp_path: Path, capsys: pytest.CaptureFixture):
    monkeypatch.setattr(build, "compiler", lambda: None)
    with pytest.raises(ParameterError, match=r"C compiler = none: must be cc, gcc or clang on 64-bit Linux\. Install one"):
        build.build_native("tow", tmp_path / "TowCable.fmu")
    assert build.build_all(tmp_path) == []
    assert capsys.readouterr().err == "No native FMUs: they need Linux and a C compiler (cc, gcc or clang).\n"


# -- the numbers


@pytest.mark.parametrize(("key", "name"), SCENES)
def test_a_shipped_scene_gives_what_the_library_gives(native: dict[str, Fmu], key: str, name: str):
    scene = load(name)
    motion, step = top_motion(scene.top), scene.run.output_step
    inputs = np.array([motion(k * step) for k in range(STEPS)])
    instance = native[key].instance()
    assert_same(native_run(instance, values_of(scene), inputs, step), library_run(key, scene, inputs, step))
    assert instance.get("effects.active") == one_line(scene, key)
    instance.close()


@pytest.mark.parametrize("case", CASES)
def test_the_parameters_decide_on_the_effects_as_in_the_library(native: dict[str, Fmu], case: str):
    key, values = CASES[case]
    scene = scene_from_values(generic_scene(), values)
    inputs = np.array([sway(k * STEP) for k in range(min(STEPS, 30))])
    instance = native[key].instance()
    assert_same(native_run(instance, values, inputs, STEP), library_run(key, scene, inputs, STEP))
    assert instance.get("effects.active") == one_line(scene, key)
    instance.close()


def test_a_baked_scene_has_exactly_its_own_parts(tmp_path: Path):
    scene = with_values(load("dale_sphere"), {"current.levels": [[-1.0, 0.05, 0.0], [-3.0, 0.02, 0.0]]})
    (variant,) = object_code.variants_of("tow", scene)
    assert {name for name, kind in variant.items() if kind} == {"body", "water", "current", "cable_mass", "tension_floor"}
    assert set(variant.values()) == {ABSENT, PRESENT}
    fmu = Fmu(build.build_native("tow", tmp_path / "Sphere.fmu", scene), tmp_path / "x")
    inputs = np.array([sway(k * STEP, 0.05) + np.eye(9)[2] * -0.5 for k in range(20)])
    instance = fmu.instance()
    assert_same(native_run(instance, {}, inputs, STEP), library_run("tow", scene, inputs, STEP))
    assert instance.get("effects.active") == one_line(scene, "tow")
    instance.close()
    other = fmu.instance()
    with pytest.raises(FMICallException):
        other.initialize({"tow.cable_mass": False})
    assert other.errors == [
        "tow.cable_mass = False: must be other than 0: this native FMU was compiled with the part 'cable_mass'. "
        "Use the FMU that runs Python, or bake the scene."
    ]
    other.close()


def test_a_host_without_python_gets_the_same_bits_in_two_threads_and_all_memory_back(fmu: Fmu, tmp_path: Path):
    host = tmp_path / "host"
    source = Path(__file__).parent / "native_host.c"
    command = [str(build.compiler()), "-Wall", "-Wextra", "-Werror", "-O1", f"-I{build.fmi_headers()}", "-o", str(host), str(source)]
    subprocess.run([*command, "-ldl", "-lpthread"], check=True)
    guid, count = fmpy.read_model_description(str(fmu.path)).guid, 40
    inputs = np.array([[*sway(k * STEP), 0.0] for k in range(count)])
    arguments = [str(library_of(fmu)), guid, str(count), repr(STEP), str(len(OUTPUTS)), str(len(INPUTS)), "threads"]
    lines = "\n".join(" ".join(map(repr, row)) for row in inputs.tolist())
    done = subprocess.run([str(host), *arguments], input=lines, capture_output=True, text=True, env={}, check=False)
    assert (done.returncode, done.stderr) == (0, "")
    found = np.array([float.fromhex(line) for line in done.stdout.split()]).reshape(count, len(OUTPUTS))
    instance = fmu.instance()
    assert np.array_equal(found, native_run(instance, {}, inputs, STEP)[1:])
    instance.close()


# -- the rules that C has from Python


def _hold(literals: tuple[Literal, ...] | None, values: list[Any], rules: Rules) -> bool:
    def nonzero(vr: int) -> bool:
        return abs(np.sin(values[vr])) > 1e-9 if rules.rows[vr].unit == "rad" else values[vr] != 0

    return literals is not None and all(nonzero(vr) == on for vr, on in literals)


@pytest.mark.parametrize("key", sorted(MODELS))
def test_the_rules_written_for_c_are_those_of_scenes(key: str):
    """Any values, not only the few changes from which the rules were found."""
    base, rows = generic_scene(), table()
    rules, draw = Rules(rows, base, key), random.Random(7)
    parts, refusals, reasons, numbers = rules.parts(), rules.refusals(), rules.reasons(), rules.numbers()
    accepted = 0
    for _ in range(600):
        values = [row.start for row in rows]
        for vr, row in enumerate(rows):
            if row.causality == "parameter" and (row.minimum or 0.0) <= 0.0 and not row.minimum_excluded and draw.random() < 0.35:
                real = 0.3 if row.maximum is None else min(0.3, row.maximum)
                values[vr] = {"Boolean": True, "Integer": 1, "Real": real}[row.kind] if draw.random() < 0.6 else type(row.start)(0)
        values[next(vr for vr, row in enumerate(rows) if row.name == "environment.gravity")] = 9.8
        named = {row.name: values[vr] for vr, row in enumerate(rows) if row.causality == "parameter"}
        broken = [r for r in refusals if _hold(r.literals, values, rules)]
        try:
            scene = scene_from_values(base, named)
        except ParameterError as error:
            assert any(f"must be {r.text}" in str(error) and str(error).startswith(rows[r.variable].scene_name) for r in broken)
            continue
        accepted += 1
        assert broken == []
        present = parts_of(scene, key)._asdict()
        assert {name: _hold(literals, values, rules) for name, literals in parts.items()} == {
            name: part is not None for name, part in present.items()
        }
        active = [effect.name for effect in effects(scene, key) if effect.active]
        assert [r.words.split(" (")[0] for r in reasons if _hold(r.literals, values, rules)] == [name.split(" (")[0] for name in active]
        made = [values[vr] if vr2 < 0 or values[vr] >= 0 else values[vr2] for vr, vr2 in numbers]
        assert dict(zip(PARAMETERS, made, strict=True)) == dict(zip(PARAMETERS, numbers_of(scene), strict=True))
    assert accepted > 50


# -- states


@pytest.mark.parametrize("order", [0, 1, 2])
def test_a_restored_run_is_bit_identical(fmu: Fmu, order: int):
    instance = started(fmu, {"top.motion_order": order, "body.mass": 450.0}, 7)
    state = instance.slave.getFMUstate()
    data = instance.slave.serializeFMUstate(state)
    expected = instance.run(20, first=7)
    instance.slave.setFMUstate(state)
    assert np.array_equal(instance.run(20, first=7), expected)
    instance.slave.freeFMUstate(state)
    other = fmu.instance()
    other.slave.setFMUstate(other.slave.deSerializeFMUstate(data))
    assert other.get("body.mass") == 450.0
    assert np.array_equal(other.run(20, first=7), expected)
    instance.close()
    other.close()


def test_a_state_holds_the_inputs_and_the_outputs(fmu: Fmu):
    instance = started(fmu)
    instance.set_inputs(np.arange(float(len(INPUTS))))
    outputs, state = instance.outputs(), instance.slave.getFMUstate()
    instance.slave.reset()
    instance.slave.setFMUstate(state)
    assert [instance.get(name) for name in INPUTS] == list(range(len(INPUTS)))
    assert np.array_equal(instance.outputs(), outputs)
    instance.close()


def test_a_state_from_before_initialization_restores_that(fmu: Fmu):
    instance = fmu.instance()
    instance.set({"cable.length": 80.0})
    state = instance.slave.getFMUstate()
    instance.initialize(None, sway(0.0))
    expected = instance.run(5)
    instance.slave.setFMUstate(state)
    instance.initialize(None, sway(0.0))
    assert np.array_equal(instance.run(5), expected)
    instance.close()


def test_a_reset_instance_is_a_new_one(fmu: Fmu):
    fresh = fmu.instance()
    fresh.initialize(None, sway(0.0))
    expected = fresh.run(10)
    instance = started(fmu, {"cable.length": 40.0, "solver.nodes": 15})
    instance.slave.reset()
    assert [instance.get(name) for name in ("cable.length", "solver.nodes", "top.x")] == [100.0, 51, 0.0]
    instance.initialize(None, sway(0.0))
    assert np.array_equal(instance.run(10), expected)
    for each in (fresh, instance):
        each.close()


def test_a_changed_state_is_refused(fmu: Fmu, native: dict[str, Fmu]):
    instance = started(fmu)
    data = instance.slave.serializeFMUstate(instance.slave.getFMUstate())
    (other,) = (started(each) for each in native.values() if each is not fmu)
    foreign = other.slave.serializeFMUstate(other.slave.getFMUstate())
    advice = "Restore only what the same FMU has saved."
    for bad, text in (
        (b"rubbish", f"saved state = 7 bytes: must be at least {len(data) - 8 * instance_numbers(fmu)}. {advice}"),
        (data[:-8], f"saved state = {len(data) - 8} bytes: must be complete. {advice}"),
        (b"x" + data[1:], f"saved state: must be of this build of the FMU. {advice}"),
        (foreign, f"saved state: must be of this build of the FMU. {advice}"),
        (
            data[:-20] + b"\0\1\2\3" + data[-16:],
            "saved state: must have its checksum. It was changed; restore only what the same FMU has saved.",
        ),
    ):
        instance.messages.clear()
        with pytest.raises(FMICallException):
            instance.slave.deSerializeFMUstate(bad)
        assert instance.errors == [text]
    assert np.array_equal(instance.run(3, first=5), started(fmu, steps=5).run(3, first=5))
    instance.close()
    other.close()


def instance_numbers(fmu: Fmu) -> int:
    """Size of the model's own state at its start values."""
    return len(MODELS[KEYS[fmu.path.stem]](generic_scene()).state)


# -- errors


@pytest.fixture(scope="module")
def undisturbed(native: dict[str, Fmu]) -> dict[str, np.ndarray]:
    found = {}
    for fmu in native.values():
        instance = fmu.instance()
        instance.initialize(None, sway(0.0))
        found[fmu.path.stem] = instance.run(10)
        instance.close()
    return found


def recovers(instance: Instance, expected: np.ndarray) -> None:
    """It terminates, resets, and then runs as if nothing had been."""
    instance.slave.terminate()
    instance.slave.reset()
    instance.initialize(None, sway(0.0))
    assert np.array_equal(instance.run(10), expected)
    instance.close()


@pytest.mark.parametrize("case", BAD_STEPS)
def test_a_bad_step_is_the_same_one_error_as_in_the_python_fmu(fmu: Fmu, undisturbed: dict[str, np.ndarray], case: str):
    time, step, inputs, text = BAD_STEPS[case]
    instance = started(fmu)
    before = instance.outputs()
    with pytest.raises(FMICallException):
        instance.step(time, step, inputs)
    assert instance.errors == [text]
    assert np.array_equal(instance.outputs(), before)
    assert np.array_equal(instance.run(5, first=5), undisturbed[fmu.path.stem][5:])
    recovers(instance, undisturbed[fmu.path.stem])


@pytest.mark.parametrize("case", BAD_PARAMETERS)
def test_a_bad_parameter_is_the_same_one_error_as_in_the_python_fmu(fmu: Fmu, undisturbed: dict[str, np.ndarray], case: str):
    values, text = BAD_PARAMETERS[case]
    instance = fmu.instance()
    with pytest.raises(FMICallException, match="fmi2ExitInitializationMode"):
        instance.initialize(values)
    assert instance.errors == [text]
    recovers(instance, undisturbed[fmu.path.stem])


def test_a_grid_that_was_not_compiled_is_refused_at_the_end_of_initialization(native: dict[str, Fmu], undisturbed: dict[str, np.ndarray]):
    instance = native["chain"].instance()
    with pytest.raises(FMICallException, match="fmi2ExitInitializationMode"):
        instance.initialize({"solver.grid": 1})
    assert instance.errors == [
        "solver.grid = 1: must be 0: this native FMU was compiled without the part 'box'. Use the FMU that runs Python, or bake the scene."
    ]
    recovers(instance, undisturbed["CableChain"])


def test_a_top_of_a_million_metres_a_second_is_refused(fmu: Fmu, undisturbed: dict[str, np.ndarray]):
    instance = started(fmu)
    inputs = sway(5 * STEP)
    inputs[INPUTS.index("top.x")] = 1e6
    with pytest.raises(FMICallException):
        instance.step(5 * STEP, STEP, inputs)
    (error,) = instance.errors
    assert error.startswith("speed of the top = ")
    assert error.endswith(" m/s: must be <= 10000. Check the units of the top's motion, and for jumps.")
    recovers(instance, undisturbed[fmu.path.stem])


def test_a_failed_step_says_what_the_library_says_and_lasts_until_restored(native: dict[str, Fmu], undisturbed: dict[str, np.ndarray]):
    """TowCable keeps to its plane."""
    inputs = sway(5 * STEP)
    inputs[INPUTS.index("top.vy")] = 0.5
    model = MODELS["tow"](generic_scene())
    model.initialize(sway(0.0))
    for k in range(5):
        model.step(k * STEP, STEP, sway(k * STEP))
    with pytest.raises(RuntimeError) as expected:
        model.step(5 * STEP, STEP, inputs)
    instance = started(native["tow"])
    state = instance.slave.getFMUstate()
    with pytest.raises(FMICallException):
        instance.step(5 * STEP, STEP, inputs)
    with pytest.raises(FMICallException):
        instance.step(6 * STEP, STEP, sway(6 * STEP))
    assert instance.errors == [
        str(expected.value),
        "instance = 'failed': must be initialized and running. Initialize, reset or restore it first.",
    ]
    instance.slave.setFMUstate(state)
    assert np.array_equal(instance.run(5, first=5), undisturbed["TowCable"][5:])
    recovers(instance, undisturbed["TowCable"])


def test_calls_out_of_turn_are_errors(fmu: Fmu, undisturbed: dict[str, np.ndarray]):
    instance = fmu.instance()
    for call in (
        lambda: instance.slave.doStep(0.0, STEP),
        instance.slave.exitInitializationMode,
        lambda: instance.slave.setupExperiment(startTime=float("nan")),
    ):
        with pytest.raises(FMICallException):
            call()
    instance.initialize()
    for call in (
        lambda: instance.set({"cable.length": 3.0}),
        lambda: instance.set({"top.tension": 3.0}),
        lambda: instance.set({"effects.active": "all"}),
        instance.slave.enterInitializationMode,
        lambda: instance.slave.getReal([12345]),
        lambda: instance.slave.getReal([fmu.references["solver.nodes"]]),
    ):
        with pytest.raises(FMICallException):
            call()
    assert instance.errors == [
        "instance = 'instantiated': must be initialized and running. Initialize, reset or restore it first.",
        "instance = 'instantiated': must be initializing. Enter the initialization mode first.",
        "start time = nan s: must be finite. Give the time at which the simulation starts.",
        "cable.length = 3 m: must be set before the end of initialization. Reset the FMU first.",
        "top.tension = 3 N: must be left alone: it is calculated. Set inputs and parameters only.",
        "effects.active = 'all': must be left alone: it is calculated. Set inputs and parameters only.",
        "instance = 'running': must be new. Reset it first.",
        "value reference = 12345: must be of a Real. Use the references of modelDescription.xml.",
        f"value reference = {fmu.references['solver.nodes']}: must be of a Real. Use the references of modelDescription.xml.",
    ]
    recovers(instance, undisturbed[fmu.path.stem])


def test_outputs_read_during_initialization_depend_on_no_input_set_then(fmu: Fmu):
    instance = fmu.instance()
    instance.slave.setupExperiment(startTime=0.0)
    instance.slave.enterInitializationMode()
    before = instance.outputs()
    instance.set({"top.x": 5.0})
    assert np.array_equal(instance.outputs(), before)
    assert before[OUTPUTS.index("top.tension")] > 0.0
    instance.slave.exitInitializationMode()
    assert instance.get("body.x") == pytest.approx(5.0, abs=1e-9)
    instance.close()


def test_a_library_of_another_build_is_not_instantiated(fmu: Fmu):
    instance = fmu.instance()
    arguments = (b"x", 1, b"{00000000-0000-0000-0000-000000000000}", None, instance._callbacks, 0, 0)
    assert not instance.slave.fmi2Instantiate(*arguments)
    assert instance.errors == [f"GUID: must be {fmu.description.guid}. The library and modelDescription.xml do not belong together."]
    instance.close()
