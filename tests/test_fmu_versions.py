"""FMUs that run Python beside other versions of themselves, and the files that they are staged in."""

from __future__ import annotations

import shutil
import subprocess
import sys
from pathlib import Path

import fmpy
import numpy as np
import pytest
from fmu_support import (
    HEAD,
    Fmu,
    Instance,
    fresh,
    sway,
)

from cable_model.signals import INPUTS
from fmu_src import staging
from fmu_src.build import build as build_fmu
from fmu_src.interface import generic_scene, table

ROOT = Path(__file__).resolve().parent.parent


def changed_sources(folder: Path, factor: float) -> Path:
    """A copy of both packages in which gravity is multiplied."""
    for package in ("cable_model", "fmu_src"):
        shutil.copytree(ROOT / package, folder / package, ignore=shutil.ignore_patterns("__pycache__", "*.toml"))
    scene = folder / "cable_model" / "simulated.py"
    text = scene.read_text(encoding="utf-8")
    wrapped = f"""

_plain_numbers = numbers_of


def numbers_of(scene):
    numbers = _plain_numbers(scene)
    numbers.environment.gravity *= {factor}
    return numbers
"""
    scene.write_text(text + wrapped, encoding="utf-8")
    return folder


def test_two_versions_live_in_one_process(fmus: dict[str, Fmu], tmp_path: Path):
    root = changed_sources(tmp_path / "sources", 2.0)
    other = Fmu(build_fmu("chain", generic_scene(), tmp_path / "CableChain.fmu", root), tmp_path / "x")
    assert other.description.guid != fmus["chain"].description.guid
    one, two = fmus["chain"].instance(), other.instance()
    one.initialize()
    two.initialize()
    assert two.get("top.tension") == pytest.approx(2.0 * float(one.get("top.tension")), rel=1e-6)
    foreign = one.slave.serializeFMUstate(one.slave.getFMUstate())
    with pytest.raises(fmpy.fmi1.FMICallException):
        two.slave.deSerializeFMUstate(foreign)
    one.close()
    two.close()


def test_an_instance_outlives_its_unzipped_folder(fmu: Fmu, tmp_path: Path):
    gone = Fmu(fmu.path, tmp_path / "x")
    instance = gone.instance()
    shutil.rmtree(tmp_path / "x")
    instance.initialize(None, sway(0.0))
    assert np.array_equal(instance.run(20), fresh(fmu))
    instance.close()


def vendored(folder: Path) -> Path:
    package = folder / "some_package"
    package.mkdir(parents=True)
    (package / "__init__.py").write_text("VALUE = 3\n")
    return package


def test_staging_finds_the_same_content_again(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))
    one, two = vendored(tmp_path / "a"), vendored(tmp_path / "b")
    assert staging.staged(one) == staging.staged(two)
    assert staging.staged(one).is_relative_to(tmp_path / "cache")
    assert not list((tmp_path / "cache").rglob("new-*"))
    (two / "__init__.py").write_text("VALUE = 4\n")
    assert staging.staged(one) != staging.staged(two)


def test_a_damaged_staged_file_is_laid_anew(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))
    package = vendored(tmp_path / "a")
    lasting = staging.staged(package)
    for damage in (
        lambda: (lasting / "__init__.py").write_text("VALUE = 5\n"),
        lambda: (lasting / "__init__.py").unlink(),
        lambda: (lasting / "strange.py").write_text(""),
    ):
        damage()
        assert staging.staged(package) == lasting
        assert [path.name for path in lasting.iterdir()] == ["__init__.py"]
        assert (lasting / "__init__.py").read_text() == "VALUE = 3\n"
    assert [path.name for path in lasting.parents[1].iterdir()] == [lasting.parent.name]


def test_staging_falls_back_where_nothing_can_be_written(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    (tmp_path / "file").write_text("")
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "file"))
    package = vendored(tmp_path / "a")
    assert staging.staged(package) == package
    assert staging.load("some_package", tmp_path / "a").VALUE == 3
    del sys.modules["some_package"]


def test_a_half_written_copy_is_never_used(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))
    package = vendored(tmp_path / "a")

    def broken(*arguments: object, **keywords: object) -> None:
        raise OSError("disk full")

    with monkeypatch.context() as patch:
        patch.setattr(staging.shutil, "copytree", broken)
        assert staging.staged(package) == package
    assert staging.staged(package) != package
    assert (staging.staged(package) / "__init__.py").read_text() == "VALUE = 3\n"


def test_an_instance_needs_neither_scipy_nor_matplotlib_of_ours(fmu: Fmu):
    """What the slave itself imports; numba looks at scipy's version, and at its BLAS when it first loads a kernel."""
    program = (
        "import sys; sys.argv = ['x']; sys.path.insert(0, sys.path.pop())\n"
        "from pythonfmu import Fmi2Slave\n"
        f"sys.path.insert(0, {str(Path(fmu.folder) / 'resources')!r})\n"
        f"__import__(open({str(Path(fmu.folder) / 'resources' / 'slavemodule.txt')!r}).read().strip())\n"
        "print([name for name in ('scipy.linalg', 'scipy.interpolate', 'matplotlib', 'fmpy', 'typer') if name in sys.modules])\n"
    )
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"


def test_an_instance_is_driven_by_the_names_of_the_signals(fmu: Fmu):
    """The helper of these tests and the table agree on value references."""
    instance: Instance = fmu.instance()
    assert fmu.references == {row.name: reference for reference, row in enumerate(table())}
    assert [fmu.references[name] for name in INPUTS[:HEAD]] == list(range(HEAD))
    instance.slave.freeInstance()
