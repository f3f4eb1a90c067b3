"""The archives of the FMUs and the script that builds them: description, capabilities, bytes, vendored modules, the command line."""

from __future__ import annotations

import datetime
import re
import subprocess
import sys
import zipfile
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
import pytest
from fmpy.validation import validate_fmu
from fmu_support import Fmu

from cable_model.errors import ParameterError
from cable_model.scene import load, with_values
from cable_model.signals import INPUTS, OUTPUTS
from fmu_src.build import build as build_fmu
from fmu_src.interface import generic_scene, table
from fmu_src.model_description import epoch_of, least
from fmu_src.vendoring import imported, renamed, vendor

ROOT = Path(__file__).resolve().parent.parent


def test_fmpy_finds_nothing_to_complain_about(fmu: Fmu):
    assert validate_fmu(str(fmu.path)) == []


def test_the_archive_says_what_the_table_says(fmu: Fmu):
    rows = table()
    assert len(fmu.description.modelVariables) == len(rows)
    for reference, (variable, row) in enumerate(zip(fmu.description.modelVariables, rows, strict=True)):
        assert (variable.name, variable.valueReference, variable.causality, variable.variability) == (
            row.name, reference, row.causality, row.variability,
        )  # fmt: skip
        assert (variable.type, variable.unit or "", variable.description) == (row.kind, row.unit, row.description)
        for text, number in ((variable.min, least(row)), (variable.max, row.maximum), (variable.nominal, row.nominal)):
            assert (None if text is None else float(text)) == number
        if row.causality in ("input", "parameter"):
            read = {"Real": float, "Integer": int, "Boolean": lambda text: text == "true"}[row.kind]
            assert read(variable.start) == row.start


def structure_of(fmu: Fmu) -> dict[str, dict[str, set[str]]]:
    """Of each list of unknowns: the variables that each output depends on."""
    with zipfile.ZipFile(fmu.path) as archive:
        root = ElementTree.fromstring(archive.read("modelDescription.xml"))
    names = [row.name for row in table()]
    return {
        kind: {
            names[int(unknown.get("index")) - 1]: {names[int(index) - 1] for index in unknown.get("dependencies").split()}
            for unknown in root.findall(f"ModelStructure/{kind}/Unknown")
        }
        for kind in ("Outputs", "InitialUnknowns")
    }


def test_outputs_after_a_step_depend_on_no_input_so_that_no_loop_is_seen(fmu: Fmu):
    assert structure_of(fmu)["Outputs"] == {row.name: set() for row in table() if row.causality == "output"}


def test_outputs_at_the_start_depend_on_what_changes_them(fmu: Fmu):
    """Every input and parameter that moves an output, in any of some scenes, is among its dependencies."""
    told = structure_of(fmu)["InitialUnknowns"]
    assert list(told) == [row.name for row in table() if row.causality == "output"]
    key = {"CableChain": "chain", "TowCable": "tow"}[fmu.path.stem]
    found: dict[str, set[str]] = {name: set() for name in OUTPUTS}
    start = np.array([0.0, 0.0, -1.0, 0.1, 0.0, 0.2, 0.1, 0.0, 0.1, 0.0, *[0.0] * 12])
    base = {"top.motion_order": 2, "current.speed": 0.5, **({"solver.nodes": 11} if key == "chain" else {})}
    driven = {"lower_end.anchored": True, "lower_end.driven": True, "solver.space": True}
    driven |= {f"body.{name}": 0.0 for name in ("mass", "volume", "drag_area", "added_mass")}
    flowing = {"water.current_input": True, **({} if key == "tow" else {"solver.space": True})}
    scenes = ({}, {"solver.space": True}, flowing) if key == "tow" else ({"solver.space": True}, {"winch.fitted": True}, driven, flowing)
    for scene in scenes:
        plain = instance_outputs(fmu, base | scene, start)
        for k, name in enumerate(INPUTS):
            lacking = {
                "lower_end.": True,
                "lower.": scene is not driven,
                "water.": scene is not flowing,
                "winch.": "winch.fitted" not in scene,
            }
            across = key == "tow" and name in ("top.vy", "water.current_y") and "solver.space" not in scene
            if across or any(name.startswith(part) for part, absent in lacking.items() if absent):
                continue  # refused
            moved = instance_outputs(fmu, base | scene, start + 0.3 * np.eye(len(INPUTS))[k])
            for output in np.array(OUTPUTS)[moved != plain]:
                found[output].add(name)
        for name, value in {"cable.length": 90.0, "water.density": 1000.0, "current.speed": 0.6}.items():
            for output in np.array(OUTPUTS)[instance_outputs(fmu, base | scene | {name: value}, start) != plain]:
                found[output].add(name)
    assert {"top.x", "top.z"} <= found["body.x"] | found["body.z"] and "top.vz" in found["top.force_z"]
    for output in OUTPUTS:
        assert found[output] <= told[output], output
    assert told["solver.steps"] == set() and "body.mass" in told["top.tension"]


def instance_outputs(fmu: Fmu, values: dict[str, object], inputs: np.ndarray) -> np.ndarray:
    """Outputs at the end of initialization."""
    instance = fmu.instance()
    given = dict(zip(INPUTS, inputs.tolist(), strict=True))
    instance.initialize(values | given | {"lower_end.let_go": False})
    outputs = instance.outputs()
    instance.close()
    return outputs


def test_capabilities_and_date_are_as_hosts_need_them(fmu: Fmu):
    capabilities = fmu.description.coSimulation
    assert capabilities.needsExecutionTool is False
    assert capabilities.canHandleVariableCommunicationStepSize
    assert capabilities.canGetAndSetFMUstate
    assert capabilities.canSerializeFMUstate
    assert not capabilities.canBeInstantiatedOnlyOncePerProcess
    datetime.datetime.strptime(fmu.description.generationDateAndTime, "%Y-%m-%dT%H:%M:%SZ")
    assert re.fullmatch(r"\{[0-9a-f-]{36}\}", fmu.description.guid)
    units = {unit.name: unit.baseUnit for unit in fmu.description.unitDefinitions}
    assert (units["N"].kg, units["N"].m, units["N"].s) == (1, 1, -2)


def test_people_read_degrees_and_the_author(fmu: Fmu):
    with zipfile.ZipFile(fmu.path) as archive:
        root = ElementTree.fromstring(archive.read("modelDescription.xml"))
    shown = root.find("UnitDefinitions/Unit[@name='rad']/DisplayUnit")
    assert shown is not None and shown.get("name") == "deg" and float(shown.get("factor")) == pytest.approx(180.0 / np.pi)
    angles = {v.get("name") for v in root.iter("ScalarVariable") for real in v if real.get("displayUnit") == "deg"}
    assert angles == {row.name for row in table() if row.unit == "rad"} and "top.declination" in angles
    assert root.get("author") == "The cable-fmu contributors"
    experiment = root.find("DefaultExperiment")
    assert experiment is not None and experiment.attrib == {
        "startTime": "0.0",
        "stopTime": "60.0",
        "tolerance": "0.001",
        "stepSize": "0.05",
    }


def test_an_fmu_carries_the_date_that_it_is_given(tmp_path: Path):
    done = run_script("hanging_chain", "-o", "a.fmu", "--no-precompile", "--date", "2026-05-31T12:00:00+02:00", folder=tmp_path)
    assert done.returncode == 0, done.stderr
    assert Fmu(tmp_path / "a.fmu", tmp_path / "x").description.generationDateAndTime == "2026-05-31T10:00:00Z"
    assert epoch_of("2026-05-31") == 1780185600
    for bad in ("yesterday", "1970-01-01", "2026-13-01"):
        with pytest.raises(ParameterError, match=f"date = '{bad}': must be a date from 1980 to 2099"):
            epoch_of(bad)


def test_the_port_of_the_osp_description_names_variables_that_exist(fmu: Fmu):
    name = "{https://open-simulation-platform.com/OspModelDescription/1.0.0}"
    beside = fmu.path.with_name(f"{fmu.path.stem}_OspModelDescription.xml").read_bytes()
    with zipfile.ZipFile(fmu.path) as archive:
        assert archive.read("resources/OspModelDescription.xml") == beside
    root = ElementTree.fromstring(beside)
    port = root.find(f"{name}VariableGroups/{name}LinearMechanicalPort")
    assert [[v.get("ref") for v in group] for group in port] == [
        ["top.force_x", "top.force_y", "top.force_z"], ["top.vx", "top.vy", "top.vz"],
    ]  # fmt: skip
    assert {v.get("ref") for v in root.iter(f"{name}Variable")} <= set(fmu.references)


def test_the_same_input_gives_the_same_bytes(fmu: Fmu, tmp_path: Path):
    key = {"CableChain": "chain", "TowCable": "tow"}[fmu.path.stem]
    again = build_fmu(key, generic_scene(), tmp_path / fmu.path.name)
    assert again.read_bytes() == fmu.path.read_bytes()


def test_another_scene_gives_another_guid(fmus: dict[str, Fmu], tmp_path: Path):
    scene = with_values(generic_scene(), {"cable.length": 101.0})
    other = Fmu(build_fmu("chain", scene, tmp_path / "CableChain.fmu", precompile=False), tmp_path / "x")
    assert other.description.guid != fmus["chain"].description.guid
    assert next(v for v in other.description.modelVariables if v.name == "cable.length").start == "101.0"


def test_an_archive_holds_no_path_of_this_machine_and_no_bytecode(fmu: Fmu):
    with zipfile.ZipFile(fmu.path) as archive:
        for info in archive.infolist():
            assert info.date_time == (1980, 1, 1, 0, 0, 0)
            assert not info.filename.endswith(".pyc")
            if not info.filename.startswith(("binaries/", "resources/pythonfmu/")):
                content = archive.read(info)
                assert str(ROOT).encode() not in content
                assert str(Path.home()).encode() not in content


def test_vendored_modules_import_nothing_by_its_public_name():
    vendored = vendor(ROOT, ("fmu_src.slave",))
    for name, content in vendored.files.items():
        assert name.split("/")[0] in (vendored.package, vendored.kernels)
        assert imported(content.decode(), name) == set()


def test_kernels_keep_their_name_when_the_rest_changes(tmp_path: Path):
    for package in ("cable_model", "fmu_src"):
        for path in sorted((ROOT / package).rglob("*.py")):
            to = tmp_path / path.relative_to(ROOT)
            to.parent.mkdir(parents=True, exist_ok=True)
            to.write_bytes(path.read_bytes())
    before = vendor(tmp_path, ("fmu_src.slave",))
    scene = tmp_path / "cable_model" / "scene.py"
    scene.write_text(scene.read_text() + "\n# changed\n")
    after = vendor(tmp_path, ("fmu_src.slave",))
    assert after.kernels == before.kernels
    assert after.package != before.package
    kernel = tmp_path / "cable_model" / "kernels" / "vector.py"
    kernel.write_text(kernel.read_text() + "\n# changed\n")
    assert vendor(tmp_path, ("fmu_src.slave",)).kernels != before.kernels


def test_renaming_touches_imports_and_whole_names_only():
    source = 'from cable_model.scene import load\nfrom cable_model.kernels import path\nx = "cable_model"\ny = "cable_modelling"\n'
    new = renamed(source, "here", {"cable_model": "p.cable_model", "cable_model.kernels": "k"})
    assert new == 'from p.cable_model.scene import load\nfrom k import path\nx = "p.cable_model"\ny = "cable_modelling"\n'
    for refused in ("import cable_model\n", "from cable_model import kernels\n"):
        with pytest.raises(ValueError, match="line 1: "):
            renamed(refused, "here", {"cable_model": "p.cable_model", "cable_model.kernels": "k"})


# -- the command line


def run_script(*arguments: str, folder: Path) -> subprocess.CompletedProcess[str]:
    return subprocess.run([sys.executable, str(ROOT / "build_fmu.py"), *arguments], cwd=folder, capture_output=True, text=True, check=False)


def test_the_script_bakes_a_shipped_scene(tmp_path: Path):
    done = run_script("towed_body", "-o", "My tow.fmu", "--no-precompile", folder=tmp_path)
    assert done.returncode == 0, done.stderr
    made = Fmu(tmp_path / "My tow.fmu", tmp_path / "x")
    assert made.description.coSimulation.modelIdentifier == "My_tow"
    assert next(v for v in made.description.modelVariables if v.name == "current.speed").start == "-2.0"
    assert validate_fmu(str(made.path)) == []


def test_the_script_refuses_bad_scenes_in_one_line(tmp_path: Path):
    (tmp_path / "empty.toml").write_text("")
    (tmp_path / "wrong.toml").write_text('[cable]\nlength = "long"\nmass_per_length = 1.0\naxial_stiffness = 1e6\n')
    (tmp_path / "key.toml").write_text("[cable]\nlenght = 3.0\nmass_per_length = 1.0\naxial_stiffness = 1e6\n")
    for scene, text in (
        ("missing.toml", "missing.toml: no such file."),
        ("empty.toml", "empty.toml: an empty scene."),
        ("wrong.toml", "cable.length = 'long' m: must be a number."),
        ("key.toml", "cable.lenght: unknown key. Did you mean 'cable.length'?"),
    ):
        done = run_script(scene, folder=tmp_path)
        assert done.returncode == 2
        assert text in done.stderr
        assert len(done.stderr.strip().splitlines()) == 1
    assert not list(tmp_path.rglob("*.fmu"))


@pytest.mark.parametrize("curve", [[], [[0.0, 0.0], [0.1, 1e4]]])
def test_an_fmu_asks_for_scipy_where_rows_of_a_stiffness_are_joined(tmp_path, curve):
    scene = with_values(load("hanging_chain"), {"cable.stiffness_curve": curve})
    built = build_fmu("chain", scene, tmp_path / "Chain.fmu", precompile=False)
    with zipfile.ZipFile(built) as archive:
        assert (b"scipy" in archive.read("resources/requirements.txt")) == bool(curve)
