"""MoorDyn (C++, lumped masses, explicit) on a scene: writes its input file, drives its coupled point with the scene's top motion."""

from __future__ import annotations

import contextlib
import itertools
import math
import os
import tempfile
import time as clock
from collections.abc import Iterator
from pathlib import Path

import numpy as np

from cable_model.errors import ParameterError, refuse
from cable_model.motion import top_motion
from cable_model.scene import Scene, parts_of
from cable_model.studies.timed import Timed

THIN = 1e-9  # kg/m3: the water of a scene without water
MOST_PIECES = 20  # of an output step, in which the top is moved
UNSUPPORTED = ("waves", "current", "seabed", "winch", "curve", "bending")


@contextlib.contextmanager
def _quiet_in(folder: str) -> Iterator[None]:
    """Run in a folder, for the logs, and send to nowhere what compiled code prints."""
    here, out, err = os.getcwd(), os.dup(1), os.dup(2)
    nowhere = os.open(os.devnull, os.O_WRONLY)
    try:
        os.chdir(folder)
        os.dup2(nowhere, 1)
        os.dup2(nowhere, 2)
        yield
    finally:
        os.dup2(out, 1)
        os.dup2(err, 2)
        for descriptor in (out, err, nowhere):
            os.close(descriptor)
        os.chdir(here)


def _input_file(scene: Scene, segments: int, step: float, scheme: str, settle: float) -> str:
    cable, body = scene.cable, scene.body
    density = scene.water.density if scene.water is not None else THIN
    top = top_motion(scene.top)(0.0, 1)[:3]
    wet = (cable.mass_per_length - density * 0.25 * np.pi * cable.diameter**2) * cable.length
    hung = wet / 2.0 + body.mass - density * body.volume
    low = top[2] - cable.length * (1.0 + hung * scene.environment.gravity / cable.axial_stiffness)
    diameter = cable.diameter or 1e-3
    added = body.added_mass / (density * body.volume) if scene.water is not None and body.volume > 0.0 else 0.0
    damping = cable.axial_damping or -0.1  # negative: share of the critical one of a segment
    rows = [
        "MoorDyn input", "--- LINE TYPES ---", "Name Diam MassDen EA BA EI Cd Ca CdAx CaAx",
        "(-) (m) (kg/m) (N) (N-s) (N-m2) (-) (-) (-) (-)",
        f"cable {diameter} {cable.mass_per_length} {cable.axial_stiffness} {damping} 0 {cable.normal_drag_coefficient} "
        f"{cable.added_mass_coefficient} {cable.tangential_drag_coefficient / np.pi} 0",
        "--- POINTS ---", "ID Type X Y Z Mass Volume CdA Ca", "(-) (-) (m) (m) (m) (kg) (m3) (m2) (-)",
        f"1 Free {top[0]} {top[1]} {low} {body.mass} {body.volume} {body.drag_area} {added}",
        f"2 Coupled {top[0]} {top[1]} {top[2]} 0 0 0 0",
        "--- LINES ---", "ID LineType AttachA AttachB UnstrLen NumSegs Outputs", "(-) (-) (-) (-) (m) (-) (-)",
        f"1 cable 1 2 {cable.length} {segments} -",
        "--- OPTIONS ---", "0 writeLog", f"{step} dtM", f"{scheme} tScheme", f"{scene.environment.gravity} g", f"{density} WtrDnsty",
        f"{10.0 * cable.length + 100.0} WtrDpth", "0 kBot", "0 cBot", f"{settle} TmaxIC", "0.1 dtIC", "10 CdScaleIC", "1e-6 threshIC",
        "--- END ---",
    ]  # fmt: skip
    return "\n".join(rows) + "\n"


def run(scene: Scene, segments: int, step: float, scheme: str = "RK4", settle: float = 60.0) -> Timed:
    """Run a scene; sampled at its output step.  `settle`: seconds of MoorDyn's own relaxation before the start, which are not timed.

    Raises ParameterError where MoorDyn is not installed, or for what is not translated: waves, current, seabed, winch, bending,
    tables of the stiffness and anchored ends.
    """
    try:
        import moordyn
    except ImportError as absent:
        raise ParameterError("moordyn: not installed. Install it with pip install 'cable-fmu[peers]'.") from absent
    parts = parts_of(scene, "chain")
    for name in (*UNSUPPORTED, "anchor"):
        if getattr(parts, name) is not None:
            raise refuse(name, "present", "", "absent for MoorDyn", "Leave it out of the scene.")
    motion = top_motion(scene.top)
    every = scene.run.output_step
    count = round(scene.run.duration / every)
    tops = [motion(k * every, 1) for k in range(count + 1)]
    tension, place = np.zeros(count + 1), np.zeros((count + 1, 3))
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "lines.txt"
        path.write_text(_input_file(scene, segments, step, scheme, settle), encoding="utf-8")
        with _quiet_in(folder):
            system = moordyn.Create(str(path))
            error = "" if moordyn.Init(system, list(tops[0][:3]), list(tops[0][3:6])) == 0 else "MoorDyn's initialization failed"
            line, end = moordyn.GetLine(system, 1), moordyn.GetPoint(system, 1)

            def read(k: int, force: list[float]) -> None:
                tension[k] = np.linalg.norm(force)
                place[k] = np.array(moordyn.GetPointPos(end)) - tops[k][:3]

            reached, seconds = 0, 0.0
            if not error:
                read(0, moordyn.GetLineNodeTen(line, segments))
            for k in range(count if not error else 0):
                # MoorDyn moves the point at the velocity it is given: one that jumps between long steps makes waves of its own
                pieces = max(1, min(MOST_PIECES, math.floor(every / step + 1e-9)))
                h = every / pieces
                places = np.array([motion((k + j / pieces) * every, 1)[:3] for j in range(pieces + 1)])
                calls = [(list(a), list((b - a) / h), k * every + j * h) for j, (a, b) in enumerate(itertools.pairwise(places))]
                force: list[float] = []
                begun = clock.process_time()
                for at, velocity, now in calls:
                    force = moordyn.Step(system, at, velocity, now, h)
                seconds += clock.process_time() - begun
                read(k + 1, force)
                if not np.isfinite(tension[k + 1]) or not np.isfinite(place[k + 1]).all():
                    error = f"not finite at {k * every:.4g} s"
                    break
                reached = k + 1
            moordyn.Close(system)
    kept = slice(0, reached + 1)
    return Timed(every * np.arange(count + 1)[kept], tension[kept], place[kept], seconds, error)
