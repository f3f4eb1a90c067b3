"""The interface table, the archives made from it, and that the two agree with the package."""

from __future__ import annotations

import dataclasses
import typing
from pathlib import Path

import pytest

from cable_model import parameters
from cable_model.effects import used_by
from cable_model.errors import ParameterError
from cable_model.kernels import family
from cable_model.scene import Scene, from_dict, load, shipped, with_values
from cable_model.signals import INPUTS, OUTPUTS, SHAPE
from fmu_src.interface import EFFECTS, generic_scene, scene_from_values, scene_name, table
from fmu_src.model_description import base_units, least

ROOT = Path(__file__).resolve().parent.parent
NOT_IN_FMUS = {
    "cable.stiffness_curve", "cable.section", "cable.body", "seabed.profile", "seabed.grid",
    "lower_end.released", "water.depth", "waves.spectrum", "waves.significant_height", "waves.peak_period",
    "waves.peakedness", "waves.components", "waves.seed", "waves.table", "waves.surface", "waves.spreading_exponent", "waves.exact",
    "waves.record", "winch.speeds", "current.levels", "current.table", "top.position", "top.motion", "top.table",
    "lower.position", "lower.motion", "lower.table", "run.duration", "run.output_step", "run.model",
}  # fmt: skip


def parameter_rows():
    return [row for row in table() if row.causality == "parameter"]


def test_inputs_and_outputs_are_those_of_both_models_in_their_order():
    assert tuple(row.name for row in table() if row.causality == "input") == INPUTS
    outputs = [row.name for row in table() if row.causality == "output"]
    outputs.remove("solver.cpu_time")
    assert tuple(outputs) == (*OUTPUTS, *SHAPE)
    assert tuple(row.name for row in table()[:10]) == INPUTS[:10]


def test_every_value_of_a_scene_is_a_parameter_or_named_as_none():
    names = {row.scene_name for row in parameter_rows()}
    for part in dataclasses.fields(Scene):
        holder = getattr(parameters, "".join(word.capitalize() for word in part.name.split("_")), None)
        if dataclasses.is_dataclass(holder):
            for field in dataclasses.fields(holder):
                name = f"{part.name}.{field.name}"
                assert (name in names) != (name in NOT_IN_FMUS), name


def test_facts_of_parameters_are_those_of_the_scene():
    for row in parameter_rows():
        part, field = row.scene_name.split(".")
        holder = getattr(parameters, "".join(word.capitalize() for word in part.split("_")))
        facts = next(f for f in dataclasses.fields(holder) if f.name == field).metadata
        kind = typing.get_type_hints(holder)[field]
        assert row.kind == {float: "Real", int: "Integer", str: "Integer", bool: "Boolean"}[kind]
        assert facts["description"] in row.description
        if kind is float:
            assert row.unit == facts["unit"]
            assert row.minimum == (facts["least"] if facts["above"] is None else facts["above"])
            assert row.maximum == facts["most"]


def test_codes_of_the_integrator_are_those_of_the_kernels():
    choices = next(row for row in parameter_rows() if row.name == "solver.integrator").choices
    codes = {name.upper().replace("-", "_"): code for code, name in enumerate(choices)}
    assert codes == {name: getattr(family, name) for name in codes}


def test_names_are_unique():
    names = [row.name for row in table()]
    assert len(set(names)) == len(names)


def test_value_references_of_released_fmus_never_change():
    """What is new is appended, in the code and, from its release on, in the file."""
    lines = (ROOT / "tests" / "data" / "value_references.txt").read_text(encoding="utf-8").splitlines()
    released = [line for line in lines if not line.startswith("#")]
    found = [f"{reference} {row.name} {row.kind}" for reference, row in enumerate(table())]
    assert found[: len(released)] == released


def test_units_are_written_in_si_base_units():
    """Against the SI brochure: N = kg m/s2, J = N m, Pa = N/m2."""
    known = {
        "1": {}, "m": {"m": 1}, "m2": {"m": 2}, "rad": {"rad": 1}, "m/s2": {"m": 1, "s": -2}, "kg/m3": {"kg": 1, "m": -3},
        "N": {"kg": 1, "m": 1, "s": -2}, "J": {"kg": 1, "m": 2, "s": -2}, "N.m2": {"kg": 1, "m": 3, "s": -2}, "N.s2": {"kg": 1, "m": 1},
        "Pa/m": {"kg": 1, "m": -2, "s": -2},
    }  # fmt: skip
    assert {unit: base_units(unit) for unit in known} == known
    bases = {base for row in table() if row.unit for base in base_units(row.unit)}
    assert bases <= {"kg", "m", "s", "A", "K", "mol", "cd", "rad"}  # all that FMI has


def _value(scene: Scene, name: str) -> object:
    part, _, field = name.partition(".")
    return getattr(getattr(scene, part), field, None)


@pytest.mark.parametrize("name", sorted(shipped()))
def test_start_values_give_back_the_scene_they_come_from(name):
    scene = load(name)
    values = {row.name: row.start for row in table(scene) if row.causality == "parameter"}
    model = scene.run.model
    assert scene_from_values(scene, values, model) == scene
    if any(_value(scene, part) != _value(generic_scene(), part) for part in NOT_IN_FMUS if not part.startswith(("top.", "run."))):
        return  # it has to be baked in
    other = dataclasses.replace(generic_scene(), top=scene.top, run=scene.run, title=scene.title, source=scene.source)
    if scene.water is None:
        scene = dataclasses.replace(scene, water=parameters.Water(density=0.0))
    used = {row.name: row.start for row in table(scene) if row.causality == "parameter" and model in used_by(row.scene_name)}
    assert scene_from_values(other, used, model) == scene


def test_start_values_of_the_inputs_are_the_scenes_top():
    starts = {row.name: row.start for row in table(load("dale_sphere")) if row.causality == "input"}
    assert starts == dict.fromkeys(INPUTS, 0.0) | {"top.z": -0.5}


def test_every_parameter_reaches_the_scene():
    """With a value other than its start, each changes the scene where it says, and nothing else."""
    base = with_values(generic_scene(), {"solver.space": True})
    for row in table(base):
        if row.causality != "parameter":
            continue
        if row.kind == "Boolean":
            value = not row.start
        elif row.kind == "Integer":
            value = row.start + 1
        else:
            value = row.gap[1] if row.gap else 0.5 * row.start + (1.0 if row.maximum is None else 0.25 * min(1.0, row.maximum))
        values = {row.name: value}
        needs = {"lower_end.anchored": {"body.mass": 0.0}, "cable.inextensible": {"solver.grid": 1, "solver.space": False}}
        needs["solver.grid"] = {"solver.space": False}
        for name in ("level", "damping_ratio", "friction_coefficient", "friction_velocity", "friction_displacement", "slope"):
            needs[f"seabed.{name}"] = {"seabed.stiffness": 1e5}
        needs["seabed.slope_direction"] = {"seabed.stiffness": 1e5, "seabed.slope": 0.1}
        for axis in "xyz":
            needs[f"lower_end.{axis}"] = {"lower_end.anchored": True, "body.mass": 0.0}
        needs["lower_end.driven"] = {"lower_end.anchored": True, "body.mass": 0.0}
        needs["tow.drag_area_axial"] = {"tow.body_angle": 0.5}
        needs["seabed.laid_from_anchor"] = {
            "seabed.stiffness": 1e5, "seabed.friction_coefficient": 0.5, "lower_end.anchored": True, "body.mass": 0.0
        }  # fmt: skip
        needs["parting.place"] = {"parting.time": 1.0}
        needs["current.ramp_time"] = {"current.speed": 0.5}
        needs["wave.ramp_time"] = {"wave.amplitude": 0.5}
        for end, held in (("top", {}), ("lower_end", {"lower_end.anchored": True, "body.mass": 0.0})):
            needs[f"{end}.clamped"] = {"cable.bending_stiffness": 10.0, **held}
            for angle in ("declination", "direction"):
                needs[f"{end}.clamp_{angle}"] = {**needs[f"{end}.clamped"], f"{end}.clamped": True}
        needs["tow.as_printed"] = {"solver.space": False}
        extra = needs.get(row.name, {})
        model = used_by(row.scene_name)[0]
        changed = scene_from_values(base, {**values, **extra}, model)
        expected = row.choices[value] if row.choices else value
        part, field = row.scene_name.split(".")
        assert getattr(getattr(changed, part), field) == expected
        starts = {r.name: r.start for r in table(base) if r.name in (*values, *extra)}
        assert scene_from_values(changed, starts, model) == base


def test_a_name_that_is_no_parameter_names_the_nearest_one():
    with pytest.raises(ParameterError, match=r"cable\.lenght: unknown parameter\. Did you mean 'cable\.length'\?"):
        scene_from_values(generic_scene(), {"cable.lenght": 3.0}, "chain")


def test_a_baked_table_of_the_current_is_not_silently_overridden():
    scene = from_dict(
        {"cable": {"length": 10.0, "diameter": 0.01, "mass_per_length": 1.0, "axial_stiffness": 1e6}, "water": {},
         "current": {"levels": [[-10.0, 0.2, 0.0], [0.0, 1.0, 0.0]]}}
    )  # fmt: skip
    assert scene_from_values(scene, {"current.speed": 0.0, "cable.length": 11.0}, "chain").current == scene.current
    with pytest.raises(ParameterError, match=r"current\.speed = 0\.5 m/s: must be 0 where a table of the current is baked in\."):
        scene_from_values(scene, {"current.speed": 0.5}, "chain")


def test_waves_are_the_one_part_with_another_name():
    assert {row.name for row in parameter_rows() if scene_name(row.name) != row.name} == {
        "wave.amplitude", "wave.period", "wave.direction", "wave.phase", "wave.ramp_time",
    }  # fmt: skip


def test_effects_are_told_as_text_and_outputs_are_all_reals():
    kinds = {row.kind for row in table() if row.causality == "output"}
    assert kinds == {"Real"}
    assert next(row for row in table() if row.name == EFFECTS).kind == "String"


def test_the_least_value_told_is_one_that_is_taken():
    """FMI's min is a bound that is reached: where a rule says "above", it is the next number."""
    base = with_values(generic_scene(), {"seabed.stiffness": 1e5})
    excluded = [row for row in parameter_rows() if row.minimum_excluded]
    assert {row.name for row in excluded} >= {"cable.length", "solver.time_step"}
    for row in excluded:
        with_values(base, {row.scene_name: least(row)})
        with pytest.raises(ParameterError, match="must be >"):
            with_values(base, {row.scene_name: row.minimum})
    assert all(least(row) == row.minimum for row in table() if not row.minimum_excluded)
