"""What the peers have in common: MoorDyn's input file, which CableDyn reads too, and runs sampled at the scene's output step."""

from __future__ import annotations

import contextlib
import itertools
import math
import os
import tempfile
import time as clock
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path

import numpy as np

from cable_model.effects import CHAIN, EFFECTS
from cable_model.errors import ParameterError
from cable_model.models import MODELS
from cable_model.motion import motion_of
from cable_model.parameters import Cable
from cable_model.scene import Scene
from cable_model.simulated import is_on, parts_of
from cable_model.studies.timed import Timed

THIN = 1e-9  # kg/m3: the water of a scene without water


class NotTranslated(ParameterError):
    """A peer cannot simulate the scene, or is not told here how."""


def refuse_untranslated(scene: Scene, peer: str, can: Sequence[str] = ()) -> None:
    """NotTranslated for what the input file below does not say, and what is not among the parts that this peer `can`."""
    missing = [e.name for e in EFFECTS if not e.told_to_peers and e.name not in can and is_on(e, scene, CHAIN)]
    if missing:
        raise NotTranslated(f"{', '.join(missing)}: must be absent for {peer}. Leave it out of the scene.")


def let_go(scene: Scene) -> bool:
    """Whether the lower end is held until the start: a fixed point in the input file, which the driver must break."""
    return scene.lower_end.released or scene.lower_end.release_force != 0.0


def _held_aside(scene: Scene) -> np.ndarray:
    """Where our chain holds the lower end before it is let go."""
    model = MODELS["chain"](scene)
    model.initialize(motion_of(scene)(0.0, 1))
    return model.positions()[0]


def displaced_diameter(cable: Cable) -> float:
    """The diameter that displaces the cable's volume, m: the only one that the input file has, for drag, added mass and seabed too."""
    return 2.0 * math.sqrt(cable.displaced_area / math.pi) or 1e-3


def text(scene: Scene, segments: int, options: Sequence[str]) -> str:
    """The input file; the cable's damping, where it has none, is a tenth of the critical one of a segment."""
    cable, body = scene.cable, scene.body
    density = scene.water.density if scene.water is not None else THIN
    on_seabed = parts_of(scene, "chain").seabed is not None
    depth = -scene.seabed.level if on_seabed else 10.0 * cable.length + 100.0
    top = motion_of(scene)(0.0, 1)[:3]
    diameter = displaced_diameter(cable)
    wider = cable.diameter / diameter if cable.diameter > 0.0 else 1.0
    wet = (cable.mass_per_length - density * 0.25 * np.pi * diameter**2) * cable.length
    hung = wet / 2.0 + body.mass - density * body.volume
    low = np.array([top[0], top[1], top[2] - cable.length * (1.0 + hung * scene.environment.gravity / cable.axial_stiffness)])
    kind = "Free"
    if let_go(scene):
        low, kind = _held_aside(scene), "Fixed"
    elif scene.lower_end.anchored:
        low, kind = np.array([scene.lower_end.x, scene.lower_end.y, scene.lower_end.z]), "Fixed"
    added = body.added_mass / (density * body.volume) if scene.water is not None and body.volume > 0.0 else 0.0
    damping = cable.axial_damping or -0.1  # negative: share of the critical one
    rows = [
        "MoorDyn input", "--- LINE TYPES ---", "Name Diam MassDen EA BA EI Cd Ca CdAx CaAx",
        "(-) (m) (kg/m) (N) (N-s) (N-m2) (-) (-) (-) (-)",
        f"cable {diameter} {cable.mass_per_length} {cable.axial_stiffness} {damping} 0 {wider * cable.normal_drag_coefficient} "
        f"{wider**2 * cable.added_mass_coefficient} {wider * cable.tangential_drag_coefficient / np.pi} 0",
        "--- POINTS ---", "ID Type X Y Z Mass Volume CdA Ca", "(-) (-) (m) (m) (m) (kg) (m3) (m2) (-)",
        f"1 {kind} {low[0]} {low[1]} {low[2]} {body.mass} {body.volume} {body.drag_area} {added}",
        f"2 Coupled {top[0]} {top[1]} {top[2]} 0 0 0 0",
        "--- LINES ---", "ID LineType AttachA AttachB UnstrLen NumSegs Outputs", "(-) (-) (-) (-) (m) (-) (-)",
        f"1 cable 1 2 {cable.length} {segments} -",
        "--- OPTIONS ---", f"{scene.environment.gravity} g", f"{density} WtrDnsty", f"{depth} WtrDpth", *options,
        "--- END ---",
    ]  # fmt: skip
    return "\n".join(rows) + "\n"


@contextlib.contextmanager
def written(content: str) -> Iterator[Path]:
    """The input file in a folder of its own, which is the working folder, for the logs; what compiled code prints goes nowhere."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "lines.txt"
        path.write_text(content, encoding="utf-8")
        here, out, err = os.getcwd(), os.dup(1), os.dup(2)
        nowhere = os.open(os.devnull, os.O_WRONLY)
        try:
            os.chdir(folder)
            os.dup2(nowhere, 1)
            os.dup2(nowhere, 2)
            yield path
        finally:
            os.dup2(out, 1)
            os.dup2(err, 2)
            for descriptor in (out, err, nowhere):
                os.close(descriptor)
            os.chdir(here)


def drive(
    scene: Scene, calls: int, move: Callable[[float, float, np.ndarray, np.ndarray], None], read: Callable[[], tuple[float, np.ndarray]]
) -> Timed:
    """`move(time, h, from, to)` the top, `calls` times an output step, and `read` tension and lower end after each output step.

    `from` and `to` are position, velocity and acceleration, (9,).  A run ends early where a number is not finite or `move` raises
    RuntimeError.
    """
    every = scene.run.output_step
    count = round(scene.run.duration / every)
    motion = motion_of(scene)
    h = every / calls
    tension, place = np.zeros(count + 1), np.zeros((count + 1, 3))
    at = motion(0.0, 1)[:9]
    tension[0], lower = read()
    place[0] = lower - at[:3]
    reached, seconds, error = 0, 0.0, ""
    for k in range(count):
        times = [(k + j / calls) * every for j in range(calls + 1)]  # equal: CableDyn takes whole numbers of its steps only
        tops = [(motion(a, 1)[:9], motion(b, -1)[:9]) for a, b in itertools.pairwise(times)]
        begun = clock.process_time()
        try:
            for j, (start, end) in enumerate(tops):
                move(k * every + j * h, h, start, end)
        except RuntimeError as failure:
            error = f"{failure} (at {k * every:.4g} s)"
            break
        seconds += clock.process_time() - begun
        tension[k + 1], lower = read()
        place[k + 1] = lower - tops[-1][1][:3]
        if not np.isfinite(tension[k + 1]) or not np.isfinite(place[k + 1]).all():
            error = f"not finite at {k * every:.4g} s"
            break
        reached = k + 1
    kept = slice(0, reached + 1)
    return Timed(every * np.arange(count + 1)[kept], tension[kept], place[kept], seconds, error)
