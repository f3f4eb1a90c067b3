"""Processes that work for another end with it, however it ends."""

from __future__ import annotations

import functools
import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

SWEEP = """
scene = "basin_chain"
[vary]
"run.duration" = [1e5]
"cable.length" = [33.0, 33.01, 33.02]
"""


def _is_alive(process: int) -> bool:
    """Whether it runs; what has ended and waits to be reaped does not."""
    try:
        return Path(f"/proc/{process}/stat").read_text(encoding="utf-8").rpartition(")")[2].split()[0] not in "ZX"
    except OSError:
        return False


def _wait_for(condition, seconds=60.0):
    end = time.monotonic() + seconds
    while time.monotonic() < end:
        found = condition()
        if found:
            return found
        time.sleep(0.05)
    return condition()


@pytest.mark.skipif(not Path("/proc/self/task").is_dir(), reason="finds processes in /proc")
@pytest.mark.parametrize("how", [signal.SIGTERM, signal.SIGINT, signal.SIGKILL], ids=lambda how: how.name)
def test_a_killed_sweep_leaves_no_worker(tmp_path, how):
    file, folder = tmp_path / "sweep.toml", tmp_path / "found"
    file.write_text(SWEEP, encoding="utf-8")
    command = [sys.executable, "-m", "cable_model", "sweep", str(file), "-o", str(folder), "--workers", "2"]
    heard = functools.partial(signal.signal, signal.SIGINT, signal.SIG_DFL)  # where tests run in a shell's background it is ignored
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True, preexec_fn=heard) as sweep:
        try:
            assert len(_wait_for(lambda: len(list(folder.glob("*.begun"))) == 2 and list(folder.glob("*.begun")))) == 2
            workers = [int(k) for k in Path(f"/proc/{sweep.pid}/task/{sweep.pid}/children").read_text(encoding="utf-8").split()]
            assert len([worker for worker in workers if _is_alive(worker)]) >= 2
            os.kill(sweep.pid, how)
            shown = sweep.communicate(timeout=20)[0]
        finally:
            sweep.kill()
    assert _wait_for(lambda: not any(map(_is_alive, workers)), 20.0)
    assert sweep.returncode == (130 if how == signal.SIGINT else -how)
    if how == signal.SIGINT:
        assert shown.strip() == f"interrupted: 0 of 3 runs are in {folder}; the same command does the rest"
