"""Tests marked `plain`, with kernels as plain Python: they ask for few numbers of many sets of parts, each half a minute of compilation."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import numba
import pytest

HERE = Path(__file__).parent
TESTS = (path for path in HERE.rglob("test_*.py") if path != Path(__file__))
FILES = sorted(str(path.relative_to(HERE)) for path in TESTS if "mark.plain" in path.read_text(encoding="utf-8"))


@pytest.mark.skipif(bool(numba.config.DISABLE_JIT), reason="this is such a process")
@pytest.mark.parametrize("file", FILES)
def test_in_plain_python(file: str):
    done = subprocess.run(
        [sys.executable, "-m", "pytest", "-q", "-m", "plain", "-p", "no:cacheprovider", str(HERE / file)],
        env={**os.environ, "NUMBA_DISABLE_JIT": "1"}, cwd=HERE.parent, capture_output=True, text=True, check=False,
    )  # fmt: skip
    assert done.returncode == 0, done.stdout[-6000:]
    assert " passed" in done.stdout
