"""The native FMUs as files: valid, small, the same bytes every time, and no Python where they run."""

from __future__ import annotations

import re
import shutil
import subprocess
import sys
import zipfile
from pathlib import Path
from xml.etree import ElementTree

import numba
import pytest
from fmpy.validation import validate_fmu
from fmu_support import Fmu
from native_support import KEYS, library_of, only_where_they_run

from cable_model.errors import ParameterError
from cable_model.kernels import jit
from cable_model.models import MODELS
from fmu_src.native import build, export, link, object_code

ROOT = Path(__file__).resolve().parent.parent
pytestmark = only_where_they_run


@pytest.fixture(params=sorted(MODELS))
def fmu(request: pytest.FixtureRequest, native: dict[str, Fmu]) -> Fmu:
    return native[request.param]


def test_a_native_fmu_is_a_valid_fmu_below_320_kilobytes(fmu: Fmu):
    assert validate_fmu(str(fmu.path)) == []
    assert fmu.path.stat().st_size < 320_000


def test_a_native_fmu_describes_itself_as_the_python_fmu_does(fmu: Fmu, fmus: dict[str, Fmu]):
    def description(path: Path, interpolates: str) -> str:
        with zipfile.ZipFile(path) as archive:
            root = ElementTree.fromstring(archive.read("modelDescription.xml"))
        for name in ("guid", "generationTool"):
            assert root.attrib.pop(name)
        capabilities = root.find("CoSimulation")
        assert capabilities is not None
        del capabilities.attrib["canNotUseMemoryManagementFunctions"]
        assert capabilities.attrib.pop("canInterpolateInputs") == interpolates  # pythonfmu has no call for it
        return ElementTree.canonicalize(ElementTree.tostring(root, encoding="unicode"), strip_text=True)

    key = KEYS[fmu.path.stem]
    assert description(fmu.path, "true") == description(fmus[key].path, "false")


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


@pytest.mark.long
def test_the_same_kernels_give_the_same_bytes_in_another_process_and_folder(
    native: dict[str, Fmu], monkeypatch: pytest.MonkeyPatch, tmp_path: Path
):
    elsewhere = tmp_path / "a folder with a name of another length"
    for package in ("cable_model", "fmu_src"):
        shutil.copytree(ROOT / package, elsewhere / package, ignore=shutil.ignore_patterns("__pycache__"))
    monkeypatch.setattr(export, "ROOT", elsewhere)
    again = export.export("tow", object_code.GENERIC["tow"])
    monkeypatch.setattr(build, "bitcode", lambda model, variants: again)
    monkeypatch.setattr(build, "object_code", lambda model, variants, target: export.object_file(again, target))
    assert build.build_native("tow", tmp_path / "TowCable.fmu", platforms=["linux64"]).read_bytes() == native["tow"].path.read_bytes()


def test_kernels_edited_since_the_process_started_are_not_exported_under_the_old_name(monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr(jit, "source_hash", lambda: "another")
    with pytest.raises(RuntimeError, match="the kernels' sources have changed"):
        export.export("tow", object_code.GENERIC["tow"])


def test_without_a_compiler_the_error_says_what_to_install(monkeypatch: pytest.MonkeyPatch, tmp_path: Path, capsys: pytest.CaptureFixture):
    monkeypatch.setattr(link, "compiler", lambda: None)
    monkeypatch.setattr(link, "has_zig", lambda: False)
    with pytest.raises(ParameterError, match=r"linker for linux64 = none: must be zig or, on 64-bit Linux, a C compiler\. Run `pip"):
        build.build_native("tow", tmp_path / "TowCable.fmu")
    assert build.build_all(tmp_path) == []
    text = "No native FMUs: they need zig (pip install ziglang) or, on 64-bit Linux, a C compiler (cc, gcc or clang).\n"
    assert capsys.readouterr().err == text


def test_no_name_in_the_object_code_counts_what_is_not_in_it(tmp_path: Path):
    # numba names some constants by addresses: how many there are before optimization changes from process to process
    path = tmp_path / "kernels.o"
    path.write_bytes(object_code.object_code("tow", object_code.GENERIC["tow"]))
    listed = subprocess.run(["nm", str(path)], capture_output=True, text=True, check=True).stdout
    numbers = [int(name) for name in re.findall(r"^\S+ [a-z] _(\d+)$", listed, flags=re.MULTILINE)]
    assert len(numbers) > 5 and sorted(numbers) == list(range(len(numbers)))
