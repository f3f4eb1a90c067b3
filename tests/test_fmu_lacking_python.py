"""FMUs that run Python where Python, or what they need of it, is lacking, and in a host that is not Python."""

from __future__ import annotations

import ast
import subprocess
import sys
import sysconfig
from pathlib import Path

import numpy as np
import pytest
from fmi_calls import ERROR, Component, Library
from fmu_support import FIRST, HEAD, Fmu
from native_support import only_where_they_run

from cable_model.signals import OUTPUTS
from fmu_src.interface import table
from fmu_src.native import link

pytestmark = only_where_they_run
PLACE = {row.name: reference for reference, row in enumerate(table())}


def python(program: str) -> str:
    """What a program of its own prints."""
    path = f"import sys\nsys.path[:0] = [{str(Path(__file__).parent)!r}]\n"
    done = subprocess.run([sys.executable, "-c", path + program], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    return done.stdout


@pytest.mark.parametrize(
    ("missing", "end"),
    [
        ("sys.modules['numpy'] = None", "numpy: must be installed where this FMU runs. "),
        (
            "sys.modules['numba'] = sys.modules['llvmlite'] = None",
            "numba: must be installed where this FMU runs (import of numba halted; None in sys.modules). ",
        ),
        ("sys.version_info = (3, 10, 13)", "Python = 3.10: must be 3.11 or newer. Run the host with such a Python, or use the native FMU."),
    ],
    ids=["numpy", "numba", "Python 3.11"],
)
def test_a_host_that_lacks_something_is_told_so_in_one_line(fmus: dict[str, Fmu], missing: str, end: str):
    fmu = fmus["tow"]
    wanted = end if end.endswith("FMU.") else f"{end}Install what resources/requirements.txt lists, or use the native FMU."
    told = python(
        f"""
from pathlib import Path
import fmi_calls
{missing}
component = fmi_calls.Component(fmi_calls.Library(Path({str(fmu.folder)!r}), "TowCable"), {fmu.description.guid!r}, logging=0)
if component.at is not None:
    assert component.initialize() == fmi_calls.ERROR
print(*component.messages, sep="\\n")
"""
    )
    status, category, text = ast.literal_eval(told)
    assert (status, category) == (ERROR, b"logStatusError")
    assert text.decode().removeprefix("ImportError('").removesuffix("')") == wanted


@pytest.fixture
def plain_host(fmus: dict[str, Fmu], tmp_path: Path):
    """A C program that knows nothing of Python, and runs TowCable; `values` are its environment, the whole of it."""
    fmu, host = fmus["tow"], tmp_path / "host"
    source = Path(__file__).parent / "native_host.c"
    subprocess.run([str(link.compiler()), "-O1", f"-I{link.fmi_headers()}", "-o", str(host), str(source), "-ldl", "-lpthread"], check=True)
    library = Path(fmu.folder) / "binaries" / "linux64" / "TowCable.so"
    arguments = [str(host), str(library), fmu.description.guid, "3", "0.05", str(FIRST), str(HEAD)]

    def run(**values: str) -> subprocess.CompletedProcess[str]:
        return subprocess.run(arguments, input="0 " * 31, env=values, capture_output=True, text=True, check=False)

    return run


def test_a_plain_host_that_finds_no_python_is_told_so_and_ends_in_order(plain_host):
    bare = plain_host()
    assert bare.returncode == 1 and ("must be installed where this FMU runs" in bare.stderr or "libpython: must be found" in bare.stderr)
    wrong = plain_host(CABLE_FMU_LIBPYTHON="/nowhere/libpython.so")
    assert wrong.returncode == 1 and "CABLE_FMU_LIBPYTHON = '/nowhere/libpython.so': must be the path of a libpython (" in wrong.stderr


@pytest.mark.skipif(not sysconfig.get_config_var("Py_ENABLE_SHARED"), reason="this Python is no library that another program could load")
def test_a_plain_host_runs_an_fmu_with_python_where_libpython_is_found(plain_host, fmus: dict[str, Fmu], tmp_path: Path):
    """Without preloading; the numbers are those of a host that is Python."""
    fmu = fmus["tow"]
    folder, packages = sysconfig.get_config_var("LIBDIR"), str(Path(np.__file__).parents[1])
    chosen = str(Path(folder) / sysconfig.get_config_var("INSTSONAME"))
    done = plain_host(HOME=str(tmp_path), CABLE_FMU_LIBPYTHON=chosen, PYTHONHOME=sys.base_prefix, PYTHONPATH=packages)
    assert (done.returncode, done.stderr) == (0, "")
    weight = float.fromhex(done.stdout.split()[OUTPUTS.index("top.force_z")])
    component = Component(Library(Path(fmu.folder), "TowCable"), fmu.description.guid)
    component.initialize()
    component.step(0.0, 0.05)
    assert weight == component.get("Real", [PLACE["top.force_z"]])[1][0]
    component.free()
