"""Native FMUs with a scene baked in: the numbers of the library, exactly its parts, and what a parameter may still change."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pytest
from fmu_support import FMICallException, Fmu, assert_same, goes_on_from_a_state_saved_in_a_sliver, sway
from native_support import BAKED, library_run, native_run, only_where_they_run
from test_fmu_input import STEP

from cable_model.entries import ABSENT, PRESENT
from cable_model.errors import ParameterError
from cable_model.scene import Scene, from_dict, load, shipped, with_values
from cable_model.simulated import one_line
from fmu_src.interface import in_variables, scene_from_values, table
from fmu_src.native import build, object_code
from fmu_src.native.rules import Rules

pytestmark = only_where_they_run


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


def same_when_baked(scene: Scene, key: str, steps: int, step: float, folder: Path) -> Fmu:
    """The native FMU of a scene, which gives what the library gives, and goes on alike from a saved state."""
    fmu = Fmu(build.build_native(key, folder / "Baked.fmu", scene, ["linux64"]), folder / "x")
    start = np.array([*scene.top.position, *[0.0] * 6])
    inputs = np.array([start + sway(k * step, 0.05) for k in range(steps)])
    if scene.water is not None and scene.water.current_input:
        inputs = np.column_stack((inputs, np.zeros((steps, 10)), 0.01 * np.arange(steps), np.zeros(steps)))
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
    scene = from_dict(BAKED["chain of sections with bodies on it, moored in space on a bottom by a grid, with friction"][1])
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
