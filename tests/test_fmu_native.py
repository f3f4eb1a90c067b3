"""The native FMUs: the numbers of the library, and complete states."""

from __future__ import annotations

import random
import subprocess
from pathlib import Path
from typing import Any

import fmpy
import numba
import numpy as np
import pytest
from fmu_support import FIRST, HEAD, Fmu, assert_same, sway
from native_support import ANCHORED, SEABED, lean, library_of, library_run, native_run, only_where_they_run, values_of
from test_fmu_input import STEP

from cable_model.condition import CHANGED, Literal
from cable_model.effects import PARAMETERS
from cable_model.errors import ParameterError
from cable_model.models import MODELS
from cable_model.motion import motion_of
from cable_model.parameters import field_of
from cable_model.simulated import effects, numbers_of, one_line, parts_of
from fmu_src.interface import generic_scene, in_variables, scene_from_values, table
from fmu_src.native import link
from fmu_src.native.rules import Rules

STEPS = 20 if numba.config.DISABLE_JIT else 300
SCENES = [("chain", "hanging_chain"), ("chain", "towed_body"), ("tow", "dale_sphere"), ("tow", "towed_body")]
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
        assert draws < 40_000
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
        assert {name: any(_hold(case, values, rules) for case in cases) for name, cases in parts.items()} == {
            name: part is not None for name, part in present.items()
        }
        active = [effect.name for effect in effects(scene, key) if effect.active]
        told = [r.words.split(" (")[0] for r in reasons if _hold(r.literals, values, rules)]
        assert list(dict.fromkeys(told)) == [name.split(" (")[0] for name in active]
        made = [values[vr] if vr2 < 0 or values[vr] >= 0 else values[vr2] for vr, vr2 in numbers]
        assert dict(zip(PARAMETERS, made, strict=True)) == dict(zip(PARAMETERS, numbers_of(scene).view(float), strict=True))


# -- states
