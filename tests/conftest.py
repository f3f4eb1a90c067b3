"""What tests share: the FMUs, built once a session."""

from __future__ import annotations

import functools
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numba
import pytest
from fmi3_support import Fmu3
from fmi_calls import Component, Library
from fmu_support import Fmu
from native_support import KEYS

from cable_model import CableChain, load, ready, simulate
from cable_model.model import Model
from cable_model.models import MODELS
from cable_model.precompiled import ObjectCode
from cable_model.simulation import Result
from fmu_src.build import build as build_fmu
from fmu_src.interface import generic_scene
from fmu_src.native import build, object_code
from fmu_src.native.build import IDENTIFIERS
from fmu_src.native.targets import LIBRARY


def pytest_collection_modifyitems(config: pytest.Config, items: list[pytest.Item]) -> None:
    """One worker builds the generic FMUs, once, and runs their tests first: the others would wait for it.

    test_plain runs what is to run as plain Python.
    """
    plain = [item for item in items if item.get_closest_marker("plain")]
    if not numba.config.DISABLE_JIT and plain:
        config.hook.pytest_deselected(items=plain)
        items[:] = [item for item in items if item not in plain]

    for item in items:
        if {"fmu", "fmus", "native", "native3"} & set(getattr(item, "fixturenames", ())):
            item.add_marker(pytest.mark.xdist_group("native"))
    items.sort(key=lambda item: all(mark.args[0] != "native" for mark in item.iter_markers("xdist_group")))


@functools.cache
def _for_every_scene(model: str) -> ObjectCode:
    variants = ready.EVERY[model]
    return ObjectCode(object_code.object_code(model, variants, LIBRARY), variants)


@pytest.fixture(autouse=True, scope="session")
def _kernels() -> Iterator[None]:
    """Models run on object code for every scene, compiled once, and not by numba for each set of parts."""
    before = Model.offered
    if object_code.can_export() and ready.is_recent() and not numba.config.DISABLE_JIT:
        Model.offered = staticmethod(lambda model: _for_every_scene(model.name).calls(model))
    yield
    Model.offered = before


@pytest.fixture(scope="session")
def fmus(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Fmu]:
    """The generic FMUs of both models, by the model's key."""
    folder = tmp_path_factory.mktemp("fmus")
    made = {key: build_fmu(key, generic_scene(), folder / f"{IDENTIFIERS[key]}.fmu") for key in MODELS}
    return {key: Fmu(path, folder / key) for key, path in made.items()}


@pytest.fixture(scope="session")
def native(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Fmu]:
    """The generic native FMUs, by the model's key."""
    folder = tmp_path_factory.mktemp("native")
    return {KEYS[path.stem]: Fmu(path, folder / path.stem) for path in build.build_all(folder, ["linux64"])}


@pytest.fixture(scope="session")
def native3(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Fmu]:
    """The generic FMUs of FMI 3.0 for all platforms, by the model's key."""
    folder = tmp_path_factory.mktemp("fmi3")
    return {KEYS[path.stem]: Fmu3(path, folder / path.stem) for path in build.build_all(folder, fmi="3.0")}


@pytest.fixture(params=sorted(MODELS))
def fmu(request: pytest.FixtureRequest, fmus: dict[str, Fmu]) -> Fmu:
    """Each generic FMU in turn."""
    return fmus[request.param]


@pytest.fixture(params=["native", "python"])
def in_each_flavour(request: pytest.FixtureRequest) -> Fmu:
    """One model's FMU in each flavour."""
    flavours: dict[str, Fmu] = request.getfixturevalue({"native": "native", "python": "fmus"}[request.param])
    return flavours["tow"]


@pytest.fixture
def library(in_each_flavour: Fmu) -> Library:
    """Its library, called by C's interface."""
    return Library(Path(in_each_flavour.folder), in_each_flavour.path.stem)


@pytest.fixture
def new(in_each_flavour: Fmu, library: Library) -> Iterator[Callable[..., Component]]:
    """Makes instances, and frees them in the end."""
    made: list[Component] = []

    def make(**arguments: Any) -> Component:
        made.append(Component(library, arguments.pop("guid", in_each_flavour.description.guid), **arguments))
        return made[-1]

    yield make
    for component in made:
        component.free()


@pytest.fixture(scope="module")
def scene(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A file of the SCENE of a test's module."""
    path: Path = tmp_path_factory.mktemp("scene") / "chain.toml"
    path.write_text(request.module.SCENE, encoding="utf-8")
    return path


@pytest.fixture(scope="module")
def run(scene: Path) -> Result:
    """The chain's run of it."""
    return simulate(CableChain(load(scene)))
