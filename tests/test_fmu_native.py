"""The native FMUs: the numbers of the library, and complete states."""

from __future__ import annotations

import random
import re
import subprocess
from pathlib import Path
from typing import Any

import fmpy
import numba
import numpy as np
import pytest
from fmu_support import FIRST, HEAD, FMICallException, Fmu, Instance, assert_same, goes_on_from_a_state_saved_in_a_sliver, started, sway
from native_support import KEYS, lean, library_of, only_where_they_run, values_of
from test_fmu_input import STEP

from cable_model.condition import CHANGED, Literal
from cable_model.effects import PARAMETERS
from cable_model.errors import ParameterError
from cable_model.models import MODELS
from cable_model.motion import motion_of
from cable_model.parameters import field_of
from cable_model.scene import Scene, from_dict, load, shipped, with_values
from cable_model.signals import INPUTS
from cable_model.simulated import effects, numbers_of, one_line, parts_of
from fmu_src.entries import ABSENT, PRESENT
from fmu_src.interface import generic_scene, in_variables, scene_from_values, table
from fmu_src.native import build, link, object_code
from fmu_src.native.rules import Rules

STEPS = 20 if numba.config.DISABLE_JIT else 300
SCENES = [("chain", "hanging_chain"), ("chain", "towed_body"), ("tow", "dale_sphere"), ("tow", "towed_body")]
ANCHORED = {
    "lower_end.anchored": True, "lower_end.x": 60.0, "lower_end.z": -60.0, "body.mass": 0.0, "body.volume": 0.0,
    "body.drag_area": 0.0, "body.added_mass": 0.0,
}  # fmt: skip
SEABED = {"seabed.level": -60.0, "seabed.stiffness": 1e5, "seabed.friction_coefficient": 0.5, "seabed.laid_from_anchor": True}
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
    "chain in space, anchored, laid out on a seabed": (
        "chain",
        ANCHORED
        | SEABED
        | {"solver.space": True, "lower_end.y": 20.0, "current.speed": 0.5, "current.direction": 1.0, "wave.amplitude": 0.5},
    ),
    "tow as it is": ("tow", {}),
    "tow, dry, no cable mass": ("tow", DRY | {"tow.cable_mass": False}),
    "tow, current and waves": ("tow", {"current.speed": -0.7, "wave.amplitude": 1.0, "cable.axial_damping": 1e4}),
    "tow as printed, explicit": ("tow", {"tow.as_printed": True, "tow.explicit": True, "tow.added_mass_vertical": 5.0}),
}

pytestmark = only_where_they_run


@pytest.fixture(params=sorted(MODELS))
def fmu(request: pytest.FixtureRequest, native: dict[str, Fmu]) -> Fmu:
    return native[request.param]


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


# -- the numbers


@pytest.mark.parametrize(("key", "name"), SCENES)
def test_a_shipped_scene_gives_what_the_library_gives(native: dict[str, Fmu], key: str, name: str):
    scene = lean(name, key)
    motion, step = motion_of(scene), scene.run.output_step
    inputs = np.array([motion(k * step) for k in range(STEPS)])
    instance = native[key].instance()
    assert_same(native_run(instance, values_of(scene, key), inputs, step), library_run(key, scene, inputs, step))
    assert instance.get("effects.active") == in_variables(one_line(scene, key))
    instance.close()


@pytest.mark.parametrize("case", CASES)
def test_the_parameters_decide_on_the_effects_as_in_the_library(native: dict[str, Fmu], case: str):
    key, values = CASES[case]
    scene = scene_from_values(generic_scene(), values, key)
    inputs = np.array([sway(k * STEP) for k in range(min(STEPS, 30))])
    instance = native[key].instance()
    assert_same(native_run(instance, values, inputs, STEP), library_run(key, scene, inputs, STEP))
    assert instance.get("effects.active") == in_variables(one_line(scene, key))
    instance.close()


def test_a_baked_scene_has_exactly_its_own_parts(tmp_path: Path):
    scene = with_values(load("dale_sphere"), {"current.levels": [[-1.0, 0.05, 0.0], [-3.0, 0.02, 0.0]]})
    (variant,) = object_code.variants_of("tow", scene)
    assert {name for name, kind in variant.items() if kind} == {"body", "water", "surface", "current", "cable_mass", "tension_floor"}
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
        "tow.cable_mass = False: must be true: this native FMU was compiled with the part 'cable_mass'. "
        "Use the FMU that runs Python, or bake the scene."
    ]
    other.close()


WATER = {"density": 1025.0, "depth": 60.0}
BAKED: dict[str, tuple[str, dict[str, Any]]] = {
    "chain let go in a stretched sea over a bottom, with a table of its stiffness and the audit": ("chain", {
        "cable": {
            "length": 50.0, "mass_per_length": 2.0, "diameter": 0.03, "stiffness_curve": [[0.0, 0.0], [0.05, 5e3], [0.2, 8e4]],
            "axial_stiffness": 1e5, "normal_drag_coefficient": 1.2,
        },
        "water": WATER, "top": {"position": [0.0, 0.0, 2.0]},
        "waves": {
            "spectrum": "jonswap", "significant_height": 1.0, "peak_period": 5.0, "components": 12, "surface": "wheeler",
        },
        "lower_end": {"anchored": True, "released": True, "x": 30.0, "z": -30.0}, "solver": {"nodes": 21, "audit": True},
    }),
    "chain of sections with bodies on it, moored on a bottom": ("chain", {
        "cable": {
            "section": [
                {"length": 40.0, "mass_per_length": 8.0, "axial_stiffness": 1e6, "diameter": 0.03, "volume_per_length": 1e-3},
                {"length": 30.0, "mass_per_length": 1.0, "axial_stiffness": 2e5, "diameter": 0.04},
            ],
            "normal_drag_coefficient": 1.2, "added_mass_coefficient": 1.0,
            "body": [{"at": 55.0, "mass": 20.0, "volume": 0.04, "drag_area": 0.1, "added_mass": 15.0}],
        },
        "water": {}, "current": {"speed": 0.2}, "lower_end": {"anchored": True, "x": -50.0, "z": -30.0},
        "seabed": {"level": -30.0, "stiffness": 1e5}, "solver": {"nodes": 27},
    }),
    "chain on the box grid": ("chain", {
        "cable": {"length": 50.0, "mass_per_length": 2.0, "diameter": 0.03, "axial_stiffness": 1e5, "normal_drag_coefficient": 1.2},
        "water": {"density": 1025.0}, "body": {"mass": 50.0}, "solver": {"nodes": 21, "grid": "box"},
        "top": {"position": [0.0, 0.0, -1.0]},
    }),
    "tow in space, in a spread sea that is cut, over a bottom, and a current of a table": ("tow", {
        "cable": {"length": 50.0, "mass_per_length": 2.0, "diameter": 0.03, "axial_stiffness": 1e5, "normal_drag_coefficient": 1.2},
        "body": {"mass": 200.0, "volume": 0.02}, "water": WATER, "solver": {"space": True},
        "current": {"levels": [[-60.0, 0.1, 0.0], [0.0, 0.5, 1.0]]},
        "waves": {
            "spectrum": "pierson-moskowitz", "significant_height": 1.0, "peak_period": 6.0, "components": 15, "surface": "cut",
            "direction": 0.4, "spreading_exponent": 4.0,
        },
    }),
}  # fmt: skip


def same_when_baked(scene: Scene, key: str, steps: int, step: float, folder: Path) -> Fmu:
    """The native FMU of a scene, which gives what the library gives, and goes on alike from a saved state."""
    fmu = Fmu(build.build_native(key, folder / "Baked.fmu", scene, ["linux64"]), folder / "x")
    start = np.array([*scene.top.position, *[0.0] * 6])
    inputs = np.array([start + sway(k * step, 0.05) for k in range(steps)])
    instance = fmu.instance()
    assert_same(native_run(instance, {}, inputs, step), library_run(key, scene, inputs, step))
    assert instance.get("effects.active") == in_variables(one_line(scene, key))
    instance.close()
    return fmu


@pytest.mark.parametrize("case", [pytest.param(case, marks=pytest.mark.long if "box" in case else ()) for case in BAKED])
def test_any_scene_can_be_baked(case: str, tmp_path: Path):
    key, values = BAKED[case]
    same_when_baked(from_dict(values), key, 20, STEP, tmp_path)


def test_what_a_baked_fmu_does_not_have_is_named_and_what_its_sea_was_made_of_is_kept(tmp_path: Path):
    key, values = BAKED["tow in space, in a spread sea that is cut, over a bottom, and a current of a table"]
    fmu = same_when_baked(from_dict(values), key, 5, STEP, tmp_path)
    goes_on_from_a_state_saved_in_a_sliver(fmu)
    kept = "where a sea is baked into a native FMU. Bake it with this value."
    other = "Use the FMU that runs Python, or bake the scene."
    for name, value, text in (
        ("environment.gravity", 9.9, f"environment.gravity = 9.9 m/s2: must be 9.80665 {kept}"),
        ("wave.direction", 0.1, f"wave.direction = 0.1 rad: must be 0.4 {kept}"),
        ("wave.period", 9.0, "wave.period = 9 s: must be 10 where a spectrum of waves is baked in. Bake a scene without waves.spectrum."),
        (
            "cable.axial_damping",
            9.0,
            f"cable.axial_damping = 9 N.s: must be 0: this native FMU was compiled without the part 'voigt'. {other}",
        ),
        ("water.surface", False, f"water.surface = False: must be true: this native FMU was compiled with the part 'surface'. {other}"),
        (
            "solver.space",
            False,
            "wave.direction = 0.4 rad: must be 0 or pi in the plane. Set solver.space = true, or turn the axes so that x is along it.",
        ),
    ):
        instance = fmu.instance()
        with pytest.raises(FMICallException):
            instance.initialize({name: value})
        assert instance.errors == [text]
        instance.close()


def test_an_end_that_is_let_go_is_an_anchored_one_at_the_start():
    key, values = next(iter(BAKED.values()))
    scene = from_dict(values)
    text = "true where a lower end that is let go is baked in. Bake a scene without lower_end.released."
    assert Rules(table(scene), scene, key).kept["lower_end.anchored"] == text
    with pytest.raises(ParameterError, match=re.escape(f"lower_end.anchored = False: must be {text}")):
        scene_from_values(scene, {"lower_end.anchored": False}, key)


def test_what_sections_were_made_of_is_kept_in_fmus():
    scene = from_dict(BAKED["chain of sections with bodies on it, moored on a bottom"][1])
    kept = Rules(table(scene), scene, "chain").kept
    for name in ("cable.length", "cable.mass_per_length", "cable.diameter", "cable.volume_per_length", "solver.nodes"):
        assert kept[name].endswith("where a cable with bodies on it is baked in. Bake the scene with the other value.")
        with pytest.raises(ParameterError, match=re.escape(f"{name} = ")):
            scene_from_values(scene, {name: 50 if name == "solver.nodes" else 1.5}, "chain")


@pytest.mark.long
@pytest.mark.parametrize("name", shipped())
def test_every_shipped_scene_can_be_baked(name: str, tmp_path: Path):
    scene = load(name)
    same_when_baked(scene, scene.run.model, 20, scene.solver.time_step, tmp_path)


def test_a_host_without_python_gets_the_same_bits_in_two_threads_and_all_memory_back(fmu: Fmu, tmp_path: Path):
    host = tmp_path / "host"
    source = Path(__file__).parent / "native_host.c"
    command = [str(link.compiler()), "-Wall", "-Wextra", "-Werror", "-O1", f"-I{link.fmi_headers()}", "-o", str(host), str(source)]
    subprocess.run([*command, "-ldl", "-lpthread"], check=True)
    guid, count = fmpy.read_model_description(str(fmu.path)).guid, 40
    inputs = np.array([[*sway(k * STEP), 0.0] for k in range(count)])
    arguments = [str(library_of(fmu)), guid, str(count), repr(STEP), str(FIRST), str(HEAD), "threads"]
    lines = "\n".join(["0", *(" ".join(map(repr, row)) for row in inputs.tolist())])
    done = subprocess.run([str(host), *arguments], input=lines, capture_output=True, text=True, env={}, check=False)
    assert (done.returncode, done.stderr) == (0, "")
    found = np.array([float.fromhex(line) for line in done.stdout.split()]).reshape(count, FIRST)
    instance = fmu.instance()
    assert np.array_equal(found, native_run(instance, {}, inputs, STEP)[1:, :FIRST])
    instance.close()


# -- the rules that C has from Python


def _hold(literals: tuple[Literal, ...] | None, values: list[Any], rules: Rules) -> bool:
    def nonzero(vr: int) -> bool:
        if vr >= CHANGED:
            row = rules.rows[vr - CHANGED]
            return values[vr - CHANGED] != field_of(row.scene_name).default
        return abs(np.sin(values[vr])) > 1e-9 if rules.rows[vr].unit == "rad" else values[vr] != 0

    return literals is not None and all(nonzero(vr) == on for vr, on in literals)


@pytest.mark.parametrize("key", sorted(MODELS))
def test_the_rules_written_for_c_are_those_of_scenes(key: str):
    """Any values, not only the few changes from which the rules were found."""
    base, rows = generic_scene(), table()
    rules, draw = Rules(rows, base, key), random.Random(7)
    parts, refusals, reasons, numbers = rules.parts(), rules.refusals(), rules.reasons(), rules.numbers()
    accepted = draws = 0
    while draws < 1500 or accepted <= 50:
        draws += 1
        assert draws < 10_000
        values = [row.start for row in rows]
        for vr, row in enumerate(rows):
            free = row.causality == "parameter" and row.name not in rules.kept
            if free and (row.minimum or 0.0) <= 0.0 and not row.minimum_excluded and draw.random() < 0.35:
                real = row.gap[1] if row.gap else (0.3 if row.maximum is None else min(0.3, row.maximum))
                values[vr] = {"Boolean": True, "Integer": 1, "Real": real}[row.kind] if draw.random() < 0.6 else type(row.start)(0)
        values[next(vr for vr, row in enumerate(rows) if row.name == "environment.gravity")] = 9.8
        named = {row.name: values[vr] for vr, row in enumerate(rows) if row.causality == "parameter"}
        broken = [r for r in refusals if _hold(r.literals, values, rules)]
        try:
            scene = scene_from_values(base, named, key)
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
        assert dict(zip(PARAMETERS, made, strict=True)) == dict(zip(PARAMETERS, numbers_of(scene).view(float), strict=True))


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


def test_a_state_saved_in_a_sliver_goes_on_bit_for_bit(fmu: Fmu):
    goes_on_from_a_state_saved_in_a_sliver(fmu)


@pytest.mark.parametrize("space", [False, True], ids=["plane", "space"])
def test_a_saved_state_has_the_friction_of_a_cable_on_the_seabed(native: dict[str, Fmu], space: bool):
    instance = started(native["chain"], ANCHORED | SEABED | {"solver.space": space}, 7)
    state = instance.slave.serializeFMUstate(instance.slave.getFMUstate())
    expected = instance.run(20, first=7)
    other = native["chain"].instance()
    other.slave.setFMUstate(other.slave.deSerializeFMUstate(state))
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
    instance = started(fmu, {"cable.length": 40.0, "solver.time_step": 0.02})
    instance.slave.reset()
    assert [instance.get(name) for name in ("cable.length", "solver.time_step", "top.x")] == [100.0, 0.01, 0.0]
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
