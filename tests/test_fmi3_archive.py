"""The FMUs of FMI 3.0 as files: they say what those of FMI 2.0 say, on every platform; and the command that builds them."""

from __future__ import annotations

import re
import subprocess
import zipfile
from pathlib import Path

import fmpy
import pytest
import typer
from fmi3_support import ARRAYS, CALLS, library_of
from fmpy.validation import validate_fmu
from fmu_support import Fmu
from lxml import etree
from native_support import only_where_they_run
from test_fmu_documentation import Page
from test_fmu_platforms import windows_names, with_zig
from typer.testing import CliRunner

from cable_model.models import MODELS
from cable_model.signals import SHAPE, SHAPE_POINTS
from fmu_src import build as command
from fmu_src.native import build

pytestmark = only_where_they_run
PLACES = {
    "x86_64-linux": ".so", "x86_64-windows": ".dll", "x86_64-darwin": ".dylib", "aarch64-darwin": ".dylib", "aarch64-linux": ".so",
}  # fmt: skip


@pytest.mark.parametrize("key", sorted(MODELS))
def test_it_says_what_the_fmu_of_fmi_2_says(native: dict[str, Fmu], native3: dict[str, Fmu], key: str):
    assert validate_fmu(str(native3[key].path)) == []
    old, new = native[key].description, native3[key].description
    assert (new.fmiVersion, repr(new.defaultExperiment)) == ("3.0", repr(old.defaultExperiment))
    kinds = {"Float64": "Real", "Int32": "Integer", "Boolean": "Boolean", "String": "String"}

    def facts(variable) -> tuple[object, ...]:
        v = variable
        kind = kinds.get(v.type, v.type)
        return v.name, v.valueReference, kind, v.causality, v.variability, v.initial, v.unit, v.displayUnit, v.min, v.max, v.start

    arrays = {v.name: v for v in new.modelVariables if v.dimensions}
    scalars = [v for v in new.modelVariables if v.name not in (*arrays, "time")]
    assert [facts(v) for v in scalars] == [facts(v) for v in old.modelVariables if v.name not in SHAPE]
    assert [v.description for v in scalars] == [v.description for v in old.modelVariables if v.name not in SHAPE]
    assert {name: (v.shape, v.valueReference) for name, v in arrays.items()} == {
        name: ((SHAPE_POINTS,), native[key].references[f"{name}[1]"]) for name in ARRAYS
    }
    assert arrays["shape.z"].description == "z of 11 points, evenly along the unstretched cable from the lower end to the top"
    for group in ("outputs", "initialUnknowns"):
        found = {u.variable.name: [v.name for v in u.dependencies] for u in getattr(new, group)}
        assert found == {
            name.removesuffix("[1]"): [v.name for v in u.dependencies]
            for u in getattr(old, group)
            if (name := u.variable.name) not in SHAPE or name.endswith("[1]")
        }


def test_each_end_is_a_terminal_of_variables_that_there_are(native3: dict[str, Fmu]):
    fmu = native3["chain"]
    folder = Path(fmu.folder) / "terminalsAndIcons"
    root = etree.parse(folder / "terminalsAndIcons.xml")
    etree.XMLSchema(file=Path(fmpy.__file__).parent / "schema" / "fmi3" / "fmi3TerminalsAndIcons.xsd").assertValid(root)
    members = {t.get("name"): {m.get("memberName"): m.get("variableName") for m in t} for t in root.iter("Terminal")}
    names = ["force_x", "force_y", "force_z", "x", "y", "z", "vx", "vy", "vz"]
    assert members == {end: {name: f"{end}.{name}" for name in names} for end in ("top", "lower")}
    assert {name for of in members.values() for name in of.values()} <= set(fmu.references)
    assert (folder / "icon.png").is_file()


def test_its_page_is_about_fmi_3_and_lists_its_variables(native3: dict[str, Fmu]):
    fmu = native3["tow"]
    folder = Path(fmu.folder) / "documentation"
    text = (folder / "index.html").read_text(encoding="utf-8")
    assert "FMI 3.0 co-simulation" in text and "FMI 2.0" not in text and "same instantiation token." in text
    assert [row[:3] for row in Page(text).rows[1:]] == [[v.name, v.causality, v.type] for v in fmu.description.modelVariables]
    assert "FMI 2.0 and 3.0 headers" in (folder / "licenses" / "license.txt").read_text(encoding="utf-8")
    assert (folder / "licenses" / "fmi.txt").read_text(encoding="utf-8").count("Copyright (C)") == 2


def test_it_exports_the_calls_of_fmi_3_and_no_others(native3: dict[str, Fmu]):
    library = library_of(native3["tow"])._name
    done = subprocess.run(["nm", "-D", "--defined-only", library], capture_output=True, text=True, check=True)
    assert {line.split()[-1] for line in done.stdout.splitlines()} == CALLS
    assert len(CALLS) == 75


@with_zig
@pytest.mark.parametrize("key", sorted(MODELS))
def test_one_archive_has_every_platform_by_the_names_of_fmi_3(native3: dict[str, Fmu], key: str):
    fmu = native3[key]
    with zipfile.ZipFile(fmu.path) as archive:
        found = {name: archive.read(name) for name in archive.namelist() if name.startswith("binaries/")}
    assert set(found) == {f"binaries/{folder}/{fmu.path.stem}{suffix}" for folder, suffix in PLACES.items()}
    exported, imported = windows_names(found[f"binaries/x86_64-windows/{fmu.path.stem}.dll"])
    assert set(exported) == CALLS
    assert all(re.fullmatch(r"kernel32\.dll|api-ms-win-crt-\w+-l1-1-0\.dll", name.lower()) for name in imported)
    for processor, code in (("x86_64", 0x01000007), ("aarch64", 0x0100000C)):
        thin = found[f"binaries/{processor}-darwin/{fmu.path.stem}.dylib"]
        assert (int.from_bytes(thin[:4], "little"), int.from_bytes(thin[4:8], "little")) == (0xFEEDFACF, code)


# -- the command


@pytest.mark.parametrize("option", [[], ["--fmi3"], ["--no-fmi3"]])
@pytest.mark.parametrize("scene", [[], ["dale_sphere", "--native"]])
def test_the_command_builds_it_beside_the_others_of_a_scene_where_it_is_asked_for(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path, scene: list[str], option: list[str]
):
    built = []

    def note(model: str, to: Path, scene=None, platforms=(), fmi: str = "2.0") -> Path:
        built.append((to.relative_to(tmp_path).as_posix(), fmi))
        to.parent.mkdir(exist_ok=True)
        to.write_bytes(b"")
        return to

    monkeypatch.setattr(build, "build_native", note)
    monkeypatch.setattr(command, "build", lambda model, scene, to, precompile: note(model, to))
    monkeypatch.setattr(command, "prepare", lambda: None)
    app = typer.Typer()
    app.command()(command.main)
    done = CliRunner().invoke(app, [*scene, *option, "-o", str(tmp_path / "x.fmu" if scene else tmp_path)])
    assert done.exit_code == 0
    wanted = option == ["--fmi3"] or (not scene and not option)
    names = ["x.fmu"] if scene else ["CableChain.fmu", "TowCable.fmu"]
    assert [path for path, fmi in built if fmi == "3.0"] == [f"fmi3/{name}" for name in names if wanted]


def test_it_is_refused_where_no_native_fmu_is_built(tmp_path: Path):
    app = typer.Typer()
    app.command()(command.main)
    done = CliRunner().invoke(app, ["dale_sphere", "-o", str(tmp_path / "x.fmu"), "--fmi3"])
    assert (done.exit_code, done.stderr) == (2, "--fmi3: must be left out where no native FMU is built. Add --native.\n")
