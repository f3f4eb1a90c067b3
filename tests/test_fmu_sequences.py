"""Any sequence of FMI calls: no crash, nothing fatal, no OK with a NaN, no leak above 1 kB a sequence."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest
from fmu_support import Fmu
from native_support import only_where_they_run

from fmu_src.native import build, link

pytestmark = only_where_they_run
HERE = Path(__file__).resolve().parent


def run_sequences(fmu: Fmu, count: int, folder: Path, **also: str) -> None:
    crumb = folder / "sequence.txt"
    path = os.pathsep.join([str(HERE.parent), str(HERE)])
    environment = {**os.environ, "PYTHONMALLOC": "malloc", "PYTHONPATH": path, **also}
    command = [sys.executable, str(HERE / "fmu_sequences.py"), str(fmu.folder), fmu.path.stem, fmu.description.guid, str(count), str(crumb)]
    done = subprocess.run(command, env=environment, capture_output=True, text=True, check=False)
    last = crumb.read_text(encoding="utf-8") if crumb.exists() else "none"
    assert done.returncode == 0, f"status {done.returncode} in {last}\n{done.stdout}\n{done.stderr[-3000:]}"


@pytest.mark.parametrize("model", ["chain", "tow"])
@pytest.mark.parametrize("flavour", ["native", "fmus"])
def test_any_sequence_of_calls_is_borne(flavour: str, model: str, request: pytest.FixtureRequest, tmp_path: Path):
    run_sequences(request.getfixturevalue(flavour)[model], 50, tmp_path)


@pytest.mark.long
@pytest.mark.parametrize("model", ["chain", "tow"])
@pytest.mark.parametrize("flavour", ["native", "fmus"])
def test_any_of_many_sequences_of_calls_is_borne(flavour: str, model: str, request: pytest.FixtureRequest, tmp_path: Path):
    run_sequences(request.getfixturevalue(flavour)[model], 1000, tmp_path)


def sanitizer() -> str:
    """The library of gcc's sanitizer for addresses; "" where the C compiler has none."""
    compiler = link.compiler()
    if compiler is None:
        return ""
    named = subprocess.run([compiler, "-print-file-name=libasan.so"], capture_output=True, text=True, check=False).stdout.strip()
    return named if Path(named).is_file() else ""


@pytest.mark.long
@pytest.mark.skipif(not sanitizer(), reason="the C compiler has no sanitizers")
@pytest.mark.parametrize("model", ["chain", "tow"])
def test_the_sanitizers_find_nothing_in_the_c_layer(model: str, monkeypatch: pytest.MonkeyPatch, tmp_path: Path):
    """gcc's for addresses and undefined behaviour, over random sequences; the kernels' object code is as it is."""
    flags = [flag for flag in link.FLAGS if flag != "-Wl,-s"]
    monkeypatch.setattr(link, "has_zig", lambda: False)
    monkeypatch.setattr(link, "FLAGS", (*flags, "-g", "-fsanitize=address,undefined", "-fno-sanitize-recover=all"))
    fmu = Fmu(build.build_native(model, tmp_path / f"{build.IDENTIFIERS[model]}.fmu"), tmp_path / "x")
    run_sequences(fmu, 300, tmp_path, LD_PRELOAD=sanitizer(), ASAN_OPTIONS="detect_leaks=0", LEAKS="not counted")
