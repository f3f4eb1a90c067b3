"""MoorDyn (C++, lumped masses, explicit) on a scene: its coupled point is driven with the scene's top motion."""

from __future__ import annotations

import numpy as np

from cable_model.errors import ParameterError
from cable_model.lab.peers import deck
from cable_model.motion import motion_of
from cable_model.scene import Scene
from cable_model.simulated import parts_of
from cable_model.studies.timed import Timed

LONGEST_RELAXATION = 60.0  # s
CAN = ("seabed", "friction", "anchor")


def seabed_options(scene: Scene) -> tuple[str, ...]:
    """Its options; they are on the input file's diameter, and damping is per velocity."""
    seabed, cable = scene.seabed, scene.cable
    if parts_of(scene, "chain").seabed is None:
        return ("0 kBot", "0 cBot")
    diameter = deck.displaced_diameter(cable)
    stiffness = seabed.stiffness * cable.diameter  # per length
    water = cable.added_mass(scene.water.density) if scene.water is not None else 0.0
    damping = 2.0 * seabed.damping_ratio * np.sqrt(stiffness * (cable.mass_per_length + water))
    return (f"{stiffness / diameter} kBot", f"{damping / diameter} cBot", f"{seabed.friction_coefficient} FrictionCoefficient",
            "1 StatDynFricScale")  # fmt: skip


def run(scene: Scene, segments: int, step: float, calls: int) -> Timed:
    """Run a scene with RK4, after MoorDyn's own relaxation of at most twice the run, which is not timed.

    The top is moved `calls` times an output step: it keeps its velocity over each, and jumps of it make waves.
    Raises ParameterError where MoorDyn is not installed, and for effects that are not translated.
    """
    try:
        import moordyn
    except ImportError as absent:
        raise ParameterError("moordyn: not installed. Install it with pip install 'cable-fmu[peers]'.") from absent
    deck.refuse_untranslated(scene, "MoorDyn", CAN)
    relaxation = min(LONGEST_RELAXATION, 2.0 * scene.run.duration)
    options = ("0 writeLog", f"{step} dtM", "RK4 tScheme", *seabed_options(scene), f"{relaxation} TmaxIC", "0.1 dtIC", "10 CdScaleIC",
               "1e-6 threshIC")  # fmt: skip
    start = motion_of(scene)(0.0, 1)
    with deck.written(deck.text(scene, segments, options)) as path:
        system = moordyn.Create(str(path))
        try:
            if moordyn.Init(system, list(start[:3]), list(start[3:6])) != 0:
                return Timed(np.zeros(0), np.zeros(0), np.zeros((0, 3)), 0.0, "MoorDyn's initialization failed")
            line = moordyn.GetLine(system, 1)
            force = moordyn.GetPointForce(moordyn.GetPoint(system, 2))
            if deck.let_go(scene):
                moordyn.BreakLine(system, moordyn.GetPoint(system, 1), line)

            def move(time: float, h: float, before: np.ndarray, after: np.ndarray) -> None:
                nonlocal force
                force = moordyn.Step(system, list(before[:3]), list((after[:3] - before[:3]) / h), time, h)

            def read() -> tuple[float, np.ndarray]:
                return float(np.linalg.norm(force)), np.array(moordyn.GetLineNodePos(line, 0))

            return deck.drive(scene, calls, move, read)
        finally:
            moordyn.Close(system)
