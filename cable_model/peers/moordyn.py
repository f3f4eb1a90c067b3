"""MoorDyn (C++, lumped masses, explicit) on a scene: its coupled point is driven with the scene's top motion."""

from __future__ import annotations

import numpy as np

from cable_model.errors import ParameterError
from cable_model.motion import top_motion
from cable_model.peers import deck
from cable_model.scene import Scene
from cable_model.studies.timed import Timed

LONGEST_RELAXATION = 60.0  # s
MOST_PIECES = 20  # of an output step: the point keeps its velocity over each, and jumps of it make waves


def run(scene: Scene, segments: int, step: float) -> Timed:
    """Run a scene with RK4, after MoorDyn's own relaxation of at most twice the run, which is not timed.

    Raises ParameterError where MoorDyn is not installed, and for effects that are not translated.
    """
    try:
        import moordyn
    except ImportError as absent:
        raise ParameterError("moordyn: not installed. Install it with pip install 'cable-fmu[peers]'.") from absent
    deck.refuse_untranslated(scene, "MoorDyn")
    relaxation = min(LONGEST_RELAXATION, 2.0 * scene.run.duration)
    options = ("0 writeLog", f"{step} dtM", "RK4 tScheme", "0 kBot", "0 cBot", f"{relaxation} TmaxIC", "0.1 dtIC", "10 CdScaleIC",
               "1e-6 threshIC")  # fmt: skip
    start = top_motion(scene.top)(0.0, 1)
    with deck.written(deck.text(scene, segments, options)) as path:
        system = moordyn.Create(str(path))
        try:
            if moordyn.Init(system, list(start[:3]), list(start[3:6])) != 0:
                return Timed(np.zeros(0), np.zeros(0), np.zeros((0, 3)), 0.0, "MoorDyn's initialization failed")
            line = moordyn.GetLine(system, 1)
            force = moordyn.GetLineNodeTen(line, segments)
            if deck.let_go(scene):
                moordyn.BreakLine(system, moordyn.GetPoint(system, 1), line)

            def move(time: float, h: float, before: np.ndarray, after: np.ndarray) -> None:
                nonlocal force
                force = moordyn.Step(system, list(before[:3]), list((after[:3] - before[:3]) / h), time, h)

            def read() -> tuple[float, np.ndarray]:
                return float(np.linalg.norm(force)), np.array(moordyn.GetLineNodePos(line, 0))

            return deck.drive(scene, deck.pieces(scene, step, MOST_PIECES), move, read)
        finally:
            moordyn.Close(system)
