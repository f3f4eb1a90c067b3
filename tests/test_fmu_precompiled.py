"""The object code in the pythonfmu FMUs: it runs without numba, gives the library's numbers, and steps aside where it cannot serve."""

from __future__ import annotations

import hashlib
import json
import subprocess
import sys
import zipfile
from pathlib import Path

import numpy as np
import pytest
from fmu_support import FMICallException, Fmu, assert_same, sway

from cable_model import precompiled
from cable_model.effects import Parts
from cable_model.entries import ABSENT, ALWAYS, EITHER, PRESENT, serves
from cable_model.models import MODELS
from cable_model.precompiled import ObjectCode
from cable_model.scene import load
from cable_model.simulated import parts_of
from fmu_src.build import build as build_fmu
from fmu_src.interface import generic_scene, scene_from_values
from fmu_src.native import object_code
from fmu_src.native.export import ExportError

ROOT = Path(__file__).resolve().parent.parent
KEYS = {"CableChain": "chain", "TowCable": "tow"}
STEP = 0.05
BOX = {"solver.grid": 1, "solver.nodes": 11}
CURRENT_AND_WAVES = {"current.speed": -0.7, "wave.amplitude": 1.0, "wave.period": 7.0, "cable.axial_damping": 1e4}

pytestmark = pytest.mark.skipif(not object_code.can_export(), reason="object code is for 64-bit x86 Linux")


def steps_of(model, count: int) -> np.ndarray:
    model.initialize(sway(0.0))
    rows = []
    for k in range(count):
        model.step(k * STEP, STEP, sway(k * STEP))
        rows.append(model.outputs.copy())
    return np.array(rows)


def library(key: str, values: dict[str, object], count: int) -> np.ndarray:
    """What numba's kernels, compiled for this machine, give."""
    return steps_of(MODELS[key](scene_from_values(generic_scene(), values, key)), count)


def in_a_new_process(path: Path, values: dict[str, object], setup: str = "") -> dict[str, object]:
    """What an FMU logs, how it ends and which of the compilers it loads, where nothing was loaded before."""
    program = f"""
import json, sys, tempfile
sys.path.insert(0, {str(Path(__file__).parent)!r})
from fmu_support import Fmu, sway
from pathlib import Path
{setup}
instance = Fmu(Path({str(path)!r}), Path(tempfile.mkdtemp())).instance()
instance.initialize({values!r}, sway(0.0))
rows = instance.run(10)
texts = [text for _, text in instance.messages]
instance.close()
loaded = [name for name in ("numba", "llvmlite") if sys.modules.get(name)]
print(json.dumps({{"rows": rows.tolist(), "texts": texts, "loaded": loaded}}))
"""
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=False)
    assert (done.returncode, done.stderr) == (0, "")
    return json.loads(done.stdout)


# -- it is used


@pytest.mark.parametrize("values", [{}, CURRENT_AND_WAVES], ids=["as it is", "current and waves"])
def test_an_fmu_steps_without_numba_and_gives_what_the_library_gives(fmu: Fmu, values: dict[str, object]):
    found = in_a_new_process(fmu.path, values)
    assert found["loaded"] == ["llvmlite"]
    assert not any("numba" in text for text in found["texts"])
    assert_same(np.array(found["rows"]), library(KEYS[fmu.path.stem], values, 10))


def test_a_baked_scene_ships_exactly_its_own_parts(tmp_path: Path):
    scene = load("dale_sphere")
    path = build_fmu("tow", scene, tmp_path / "Sphere.fmu")
    found = in_a_new_process(path, {})
    assert found["loaded"] == ["llvmlite"]
    assert_same(np.array(found["rows"]), steps_of(MODELS["tow"](scene), 10))
    (variant,) = object_code.variants_of("tow", scene)
    assert serves(variant, parts_of(scene, "tow"))
    assert not serves(variant, parts_of(scene, "tow")._replace(anchor=True))
    assert not serves(variant, parts_of(scene, "tow")._replace(body=None))


@pytest.mark.parametrize(
    ("kind", "served"), [(ABSENT, (True, False)), (PRESENT, (False, True)), (EITHER, (True, True)), (ALWAYS, (True, True))]
)
def test_a_variant_serves_what_it_was_compiled_with(kind: int, served: tuple[bool, bool]):
    variant = dict.fromkeys(Parts._fields, ABSENT) | {"body": kind}
    assert (serves(variant, Parts()), serves(variant, Parts(body=True))) == served
    assert not serves(variant, Parts(body=True, box=True))


def test_all_instances_share_one_object_code(fmus: dict[str, Fmu], monkeypatch: pytest.MonkeyPatch):
    """The machine code is loaded once a process."""
    import llvmlite.binding as llvm

    instances, loads = [fmus["tow"].instance()], []
    instances[0].initialize()
    monkeypatch.setattr(llvm, "create_mcjit_compiler", lambda *arguments: loads.append(arguments))
    instances += [fmus["tow"].instance() for _ in range(3)]
    for instance in instances[1:]:
        instance.initialize()
    assert not loads
    assert not any("numba" in text for instance in instances for _, text in instance.messages)
    for instance in instances:
        instance.close()


@pytest.mark.xdist_group("native")
@pytest.mark.parametrize("key", ["chain", "tow"])
def test_a_motion_known_ahead_and_the_shape_are_the_librarys(key: str):
    variants = object_code.GENERIC[key]
    code = ObjectCode(object_code.object_code(key, variants), variants)
    models = [MODELS[key](generic_scene(), offer) for offer in (code.calls, None)]
    shapes = []
    for model in models:
        model.initialize(sway(0.0))
        for k in range(5):
            model.advance(k * STEP, STEP, sway(k * STEP), sway((k + 1) * STEP))
        shapes.append(model.positions())
        outputs = model.outputs.copy()
        model.outputs[:] = 0.0
        model._calls.read_outputs()
        assert np.array_equal(model.outputs, outputs)
    assert_same(shapes[0], shapes[1])
    assert_same(models[0].outputs, models[1].outputs)


# -- it steps aside


def test_parts_that_no_variant_has_are_compiled_by_numba_and_the_log_says_why(fmus: dict[str, Fmu]):
    instance = fmus["chain"].instance()
    instance.initialize(BOX, sway(0.0))
    rows = instance.run(10)
    assert np.array_equal(rows, library("chain", BOX, 10))
    assert [text for _, text in instance.messages if "numba" in text] == [
        "numba compiled the kernels: no variant in the object code has these effects"
    ]
    instance.slave.reset()
    instance.messages.clear()
    instance.initialize(None, sway(0.0))
    assert_same(instance.run(10), library("chain", {}, 10))
    assert not any("numba" in text for _, text in instance.messages)
    instance.close()


NOT_LOADED = "llvmlite could not load the object code (import of llvmlite.binding halted; None in sys.modules)"


@pytest.mark.parametrize(
    ("setup", "why"),
    [
        ("sys.modules['llvmlite.binding'] = None", NOT_LOADED),
        ("import os\nos.uname = lambda: type('', (), {'machine': 'aarch64'})", "the object code is for 64-bit x86 Linux"),
    ],
    ids=["no llvmlite", "another machine"],
)
def test_where_the_object_code_cannot_be_loaded_the_library_is_asked(setup: str, why: str):
    """A model made with that object code is the one that numba compiles."""
    program = f"""
import sys
import numpy as np
from cable_model.models import MODELS
from fmu_src.interface import generic_scene
from fmu_src.native.object_code import GENERIC
from cable_model.precompiled import ObjectCode
code = ObjectCode(b"code", GENERIC["tow"])
from cable_model.model import Model
Model._just_in_time = lambda model: "numba"
{setup}
model = MODELS["tow"](generic_scene(), code.calls)
print(model._calls, code.refusal(model), sep="\\n")
"""
    done = subprocess.run([sys.executable, "-c", program], cwd=ROOT, capture_output=True, text=True, check=False)
    assert (done.returncode, done.stderr) == (0, "")
    assert done.stdout.splitlines() == ["numba", why]


def test_object_code_that_was_changed_does_not_run(fmus: dict[str, Fmu], tmp_path: Path):
    with zipfile.ZipFile(fmus["tow"].path) as archive:
        code = archive.read("resources/kernels.o")
    digest, model = hashlib.sha256(code).hexdigest(), MODELS["tow"](generic_scene())
    (tmp_path / "kernels.o").write_bytes(code[:-1] + b"\1")
    bad = precompiled.shared(digest, tmp_path / "kernels.o", object_code.GENERIC["tow"])
    assert bad.refusal(model) == "the object code is not the one that the FMU was built with" and bad.calls(model) is None
    assert precompiled.shared(digest, tmp_path / "none", ()).refusal(model) == bad.refusal(model)
    (tmp_path / "kernels.o").write_bytes(code)
    good = precompiled.shared(digest, tmp_path / "kernels.o", object_code.GENERIC["tow"])
    assert good.refusal(model) == "" and precompiled.shared(digest, tmp_path / "none", ()) is good


def test_an_fmu_without_object_code_says_so():
    model = MODELS["tow"](generic_scene(), ObjectCode().calls)
    assert ObjectCode().refusal(model) == "the FMU was built without object code"
    assert np.array_equal(steps_of(model, 5), library("tow", {}, 5))


def test_an_export_that_fails_leaves_an_fmu_without_object_code_and_a_line_on_stderr(
    fmus: dict[str, Fmu], tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture
):
    def broken(model: str, variants: object) -> bytes:
        raise ExportError("the export of the kernels failed:\nsome reason")

    monkeypatch.setattr("fmu_src.build.object_code", broken)
    path = build_fmu("tow", generic_scene(), tmp_path / "TowCable.fmu")
    lines = "the export of the kernels failed:\nsome reason\nNo object code in the FMU: numba compiles the kernels where it runs.\n"
    assert capsys.readouterr().err == lines
    with zipfile.ZipFile(path) as archive, zipfile.ZipFile(fmus["tow"].path) as other:
        assert "resources/kernels.o" not in archive.namelist()
        assert "resources/kernels.o" in other.namelist()
    assert Fmu(path, tmp_path / "x").description.guid != fmus["tow"].description.guid


# -- states and errors


def test_states_of_both_ways_are_the_same_vector(fmus: dict[str, Fmu]):
    """The step after a restored state is the library's step from that state, within rounding."""
    instance = fmus["chain"].instance()
    instance.initialize(None, sway(0.0))
    instance.run(10)
    data = instance.slave.serializeFMUstate(instance.slave.getFMUstate())
    model = MODELS["chain"](generic_scene())
    size = 8 * len(model.state)
    model.state[:] = np.frombuffer(data[-4 - size : -4])
    model.step(10 * STEP, STEP, sway(10 * STEP))
    assert_same(instance.run(1, first=10), model.outputs[None, :])
    instance.close()


def test_a_state_saved_on_one_grid_is_restored_from_the_other(fmus: dict[str, Fmu]):
    """From numba's kernels to the object code and back."""
    instance = fmus["chain"].instance()
    instance.initialize(BOX, sway(0.0))
    instance.run(5)
    by_numba = instance.slave.getFMUstate()
    expected = instance.run(5, first=5)
    instance.slave.reset()
    instance.initialize(None, sway(0.0))
    instance.run(5)
    by_object_code = instance.slave.getFMUstate()
    others = instance.run(5, first=5)
    instance.slave.setFMUstate(by_numba)
    assert np.array_equal(instance.run(5, first=5), expected)
    instance.slave.setFMUstate(by_object_code)
    assert np.array_equal(instance.run(5, first=5), others)
    instance.close()


def test_a_failed_step_says_what_the_library_says(fmus: dict[str, Fmu]):
    inputs = sway(0.0)
    cases = {"speed of the top or lower end = ": 0, "the top, the lower end or a current that inputs give left the vertical plane": 4}
    for text, changed in cases.items():
        wrong = inputs.copy()
        wrong[changed] = 1e6 if changed == 0 else 0.5
        model = MODELS["chain"](generic_scene())
        model.initialize(inputs)
        with pytest.raises((ValueError, RuntimeError), match=text) as expected:
            model.step(0.0, STEP, wrong)
        instance = fmus["chain"].instance()
        instance.initialize(None, inputs)
        before = instance.outputs()
        with pytest.raises(FMICallException):
            instance.step(0.0, STEP, wrong)
        assert instance.errors == [str(expected.value)]
        assert np.array_equal(instance.outputs(), before)
        instance.close()
