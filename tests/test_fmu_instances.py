"""FMI 2.0 to the letter, both flavours alike: what is instantiated, and what an instance logs."""

from __future__ import annotations

import ctypes
import shutil
from pathlib import Path

import pytest
from fmi_calls import ERROR, OK, Component, Library
from fmu_support import Fmu
from native_support import only_where_they_run

from fmu_src.model_description import LOG_CATEGORIES

pytestmark = only_where_they_run


@pytest.mark.parametrize(
    ("arguments", "text"),
    [
        (
            {"guid": "{00000000-0000-0000-0000-000000000000}"},
            "GUID: must be {}. The library and modelDescription.xml do not belong together.",
        ),
        ({"kind": 0}, "type: must be fmi2CoSimulation. This FMU is no model exchange."),
        ({"name": None}, "instance name: must not be empty. Give the instance a name."),
        ({"name": b""}, "instance name: must not be empty. Give the instance a name."),
    ],
)
def test_what_does_not_fit_is_not_instantiated_and_told(in_each_flavour: Fmu, new, arguments: dict, text: str):
    component = new(logging=0, **arguments)
    assert component.at is None
    assert component.messages == [(ERROR, b"logStatusError", text.format(in_each_flavour.description.guid).encode())]


def test_without_callbacks_there_is_no_instance(in_each_flavour: Fmu, library: Library):
    assert library.instantiate(b"cable", 1, in_each_flavour.description.guid.encode(), library.uri.encode(), None, 0) is None


PLACES = ["file://{}", "file:{}", "file://localhost{}", "FILE://{}/", "{}", None, "", "file:///nowhere/resources", "no uri at all"]


@pytest.mark.parametrize("name", ["plain", "a space and é", "日本 100% #1?"])
def test_every_form_of_the_resource_location_is_understood(in_each_flavour: Fmu, tmp_path: Path, name: str):
    """Also none: then the FMU looks where its library lies."""
    shutil.copytree(in_each_flavour.folder, tmp_path / name)
    library = Library(tmp_path / name, in_each_flavour.path.stem)
    encoded = library.uri.removeprefix("file://")
    for form in PLACES:
        path = str(tmp_path / name / "resources") if form == "{}" else encoded
        component = Component(library, in_each_flavour.description.guid, uri=None if form is None else form.format(path).encode())
        assert component.at is not None and component.initialize() == OK, form
        component.free()


@pytest.mark.parametrize("name", [b"\xff\xfe cable", "Kabel ä".encode(), b"50%s %n", b"x" * 3000])
def test_any_name_is_borne(new, name: bytes):
    component = new(name=name)
    assert component.initialize() == OK
    assert component.step(1.0, 0.1) == ERROR


# -- the log


def test_messages_have_a_category_of_the_description(new):
    component = new()
    component.initialize()
    component.step(7.0, 0.1)
    component.set("Real", [12345], [1.0])
    component.call("CancelStep")
    component.call("GetDirectionalDerivative", None, ctypes.c_size_t(0), None, ctypes.c_size_t(0), None, None)
    assert [(status, category.decode()) for status, category, _ in component.messages] == [(OK, "logAll"), *[(ERROR, "logStatusError")] * 4]


def test_the_host_chooses_categories(new):
    component = new(logging=0)
    assert component.initialize() == OK and component.messages == []  # only what is wrong is told
    component.step(7.0, 0.1)
    assert [status for status, *_ in component.messages] == [ERROR]
    for on, categories, told in (
        (1, (), True), (0, (), False), (1, (b"logStatusWarning", b"logStatusDiscard"), False), (1, (b"logAll",), True),
        (1, tuple(name.encode() for name in LOG_CATEGORIES), True), (0, (b"logAll",), False),
    ):  # fmt: skip
        component.messages.clear()
        assert component.choose(on, *categories) == component.call("Reset") == component.initialize() == OK
        assert [status for status, *_ in component.messages] == [OK] * told
    component.messages.clear()
    assert component.choose(1, b"logNothing") == component.choose(1, None) == ERROR
    assert component.texts == [
        f"log category = '{name}': must be one of modelDescription.xml. Choose one of its LogCategories." for name in ("logNothing", "")
    ]
