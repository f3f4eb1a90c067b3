"""What FMUs say of themselves to people: one page without a network, the licences of what is in them, a picture."""

from __future__ import annotations

import dataclasses
import re
import struct
import subprocess
import zipfile
from html.parser import HTMLParser
from xml.etree import ElementTree

import pytest
from fmu_support import Fmu
from native_support import only_where_they_run

from cable_model.errors import ParameterError
from cable_model.scene import with_values
from fmu_src.documentation import licences
from fmu_src.documentation.build import page
from fmu_src.interface import generic_scene, table
from fmu_src.native import build, header, link, object_code
from fmu_src.native.targets import TARGETS

pytestmark = only_where_they_run
ELF = [target for target in TARGETS if target.suffix == ".so"]


class Page(HTMLParser):
    """The rows of a page's tables; every element that is opened is closed."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.open: list[str] = []
        self.rows: list[list[str]] = []
        self.feed(text)
        assert self.open == []

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        if tag == "tr":
            self.rows.append([])
        if tag in ("td", "th"):
            self.rows[-1].append("")
        if tag != "meta":
            self.open.append(tag)

    def handle_startendtag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        assert "svg" in self.open

    def handle_endtag(self, tag: str) -> None:
        assert self.open.pop() == tag

    def handle_data(self, data: str) -> None:
        if self.open and self.open[-1] == "td":
            self.rows[-1][-1] += data


def documents(fmu: Fmu) -> dict[str, bytes]:
    with zipfile.ZipFile(fmu.path) as archive:
        return {name: archive.read(name) for name in archive.namelist() if name.startswith(("documentation/", "model"))}


def test_the_page_lists_every_variable_of_the_model_description(in_each_flavour: Fmu):
    text = documents(in_each_flavour)["documentation/index.html"].decode()
    variables = in_each_flavour.description.modelVariables
    found = {row[0]: row for row in Page(text).rows[1:]}
    assert list(found) == [variable.name for variable in variables]
    for variable in variables:
        row = found[variable.name]
        assert (row[1], row[2], row[3], row[6]) == (variable.causality, variable.type, variable.unit or "", variable.description)
        if variable.type == "Real" and variable.start is not None:
            assert float(row[4]) == pytest.approx(float(variable.start), rel=1e-5)


def test_the_page_is_one_small_file_that_asks_for_nothing(in_each_flavour: Fmu):
    content = documents(in_each_flavour)["documentation/index.html"]
    assert len(content) < 60_000
    assert re.findall(rb"(?:src|href|url)\s*[=(]\s*\"?([^\s\">)]+)", content) == [b"#tip", b"licenses/license.txt"]
    assert b"http" not in content and b"<script" not in content and b"$" not in content
    ElementTree.fromstring(re.search(rb"<svg.*</svg>", content, re.DOTALL)[0])


def test_the_picture_is_a_png_of_200_pixels(in_each_flavour: Fmu):
    content = documents(in_each_flavour)["model.png"]
    assert content[:8] == b"\x89PNG\r\n\x1a\n" and struct.unpack(">II", content[16:24]) == (200, 200)
    assert len(content) < 10_000


def test_an_fmu_has_the_licences_of_what_is_in_it(native: dict[str, Fmu], fmus: dict[str, Fmu]):
    place = "documentation/licenses/"
    for fmu, others, word in ((native["tow"], [], "binaries/linux64 "), (fmus["tow"], ["pythonfmu.txt"], "resources/pythonfmu")):
        found = {name.removeprefix(place): text.decode() for name, text in documents(fmu).items() if name.startswith(place)}
        assert sorted(found) == sorted(["license.txt", "fmi.txt", *others])
        assert word in found["license.txt"] and "The cable-fmu contributors" in found["license.txt"]
        assert "Modelica Association" in found["fmi.txt"] and "ARISING IN ANY WAY" in found["fmi.txt"]
        assert all(f" {name}" in found["license.txt"] for name in found if name != "license.txt")


def test_an_fmu_that_runs_python_names_as_pythonfmus_what_is():
    """Where no C compiler was there our library is not before theirs, and nothing of ours was compiled."""
    alone, launched = (licences.of_python(whether) for whether in (False, True))
    assert sorted(alone) == ["license.txt", "pythonfmu.txt"]
    assert "binaries/win64 and binaries/linux64 are PythonFMU's" in alone["license.txt"]
    assert not re.search("headers|atexit|_pythonfmu", alone["license.txt"])
    assert sorted(launched) == ["fmi.txt", "license.txt", "pythonfmu.txt"]
    assert "the library that ends in _pythonfmu" in launched["license.txt"]


def test_a_library_for_windows_brings_the_licences_of_mingw_and_zig():
    pytest.importorskip("ziglang")
    found = licences.of_native(["linux64", "win64"])
    assert "Zope Public License" in found["mingw-w64.txt"] and "Zig contributors" in found["zig.txt"] and "musl" in found["musl.txt"]
    assert "binaries/linux64 is this project's code alone" in found["license.txt"]


@pytest.mark.parametrize("layer", build.LAYERS.values(), ids=build.LAYERS)
@pytest.mark.parametrize("target", ELF, ids=lambda target: target.folder)
def test_zig_links_nothing_into_libraries_of_linux_but_this_projects_code(target, layer, monkeypatch, tmp_path):
    pytest.importorskip("ziglang")
    unit, variants = layer.sources[0], object_code.GENERIC["tow"]
    files = {
        "model.h": header.c_header("X", table(), generic_scene(), "tow", variants).encode() + b'\n#define MODEL_GUID "x"\n',
        "kernels.o": object_code.object_code("tow", variants, target),
    }
    monkeypatch.setattr(link, "FLAGS", tuple(flag for flag in link.FLAGS if flag != "-Wl,-s"))
    sources = [build.HERE / name for name in layer.sources]
    whole, own = (
        link.library(target._replace(flags=flags), files, sources, units, ["-lm"])
        for flags, units in ((target.flags, [unit, "kernels.o"]), ((*target.flags, "-c", "-fno-lto"), [unit]))
    )
    assert defined(whole, tmp_path) - {"_DYNAMIC"} <= defined(own, tmp_path) | defined(files["kernels.o"], tmp_path)


def defined(code: bytes, folder) -> set[str]:
    """The names that a library or object file defines."""
    path = folder / "code"
    path.write_bytes(code)
    done = subprocess.run(["nm", "--defined-only", str(path)], capture_output=True, text=True, check=True)
    return {line.split()[-1] for line in done.stdout.splitlines()}


def test_a_scenes_own_words_are_shown_as_they_are():
    scene = with_values(generic_scene(), {"cable.length": 1234.5})
    text = page("chain", "X", table(scene), dataclasses.replace(scene, title="a <b> & $c"), "")
    assert "<strong>a &lt;b&gt; &amp; $c</strong>" in text
    assert ["cable.length", "parameter", "Real", "m", "1234.5", "> 0", "unstretched length"] in Page(text).rows


def test_a_licence_that_was_not_installed_is_told():
    with pytest.raises(ParameterError, match=r"^numpy: must be installed with its licence none\. Install it again with pip\.$"):
        licences._text("numpy", "none")
