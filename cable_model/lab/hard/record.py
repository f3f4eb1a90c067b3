"""One run of a hard case: every communication step is one base step of the solver, and staggered chains are audited."""

from __future__ import annotations

import time as clock
from dataclasses import dataclass, field

import numpy as np

from cable_model.cable_chain import CableChain
from cable_model.driving import follow, output_steps
from cable_model.errors import SolverError
from cable_model.kernels import header, layout
from cable_model.kernels.slack import HELD
from cable_model.motion import PrescribedMotion, motion_of
from cable_model.scene import Scene, with_values
from cable_model.signals import OUTPUTS

SHAPES = 24  # snapshots kept for the picture
WEIGHTLESS = 1e-6  # share of its weight in air below which a cable counts as weightless


@dataclass
class Record:
    """What a run left behind; arrays have one entry a communication step, the start included."""

    scene: Scene
    weight: float  # force scale W, N
    times: np.ndarray
    outputs: np.ndarray  # (rows, outputs)
    excess: np.ndarray  # energy that no work explains, J; empty where nothing was audited
    drift: np.ndarray  # between the top as prescribed and as the lower end's velocity brings it, m
    top_error: float  # between the reported and the prescribed top, m
    arc_error: float  # between the drawn length and the sum of the stretched cells, m
    substeps: np.ndarray  # internal steps of each communication step
    error: str
    seconds: float  # processor time
    shapes: list[np.ndarray] = field(default_factory=list)
    lengths: np.ndarray = field(default_factory=lambda: np.zeros(0))  # of the drawn cable, m; empty where no ledger was kept
    turn: float = 0.0  # largest angle between neighbouring cells, rad
    pressed: float = 0.0  # largest push of a cell beyond what its bending holds, 2 EI/h^2, N; of chains that bend and are watched
    middle: np.ndarray = field(default_factory=lambda: np.zeros((0, 3)))  # path (rows, 3) of the middle one of an odd number of nodes, m

    def __getitem__(self, name: str) -> np.ndarray:
        return self.outputs[:, OUTPUTS.index(name)]

    @property
    def is_weightless(self) -> bool:
        cable = self.scene.cable
        return self.weight < WEIGHTLESS * cable.mass_per_length * cable.length * self.scene.environment.gravity

    @property
    def force_scale(self) -> float:
        """W, or where there is no weight the largest tension at the top, N."""
        return float(self["top.tension"].max()) if self.is_weightless else self.weight

    @property
    def reached(self) -> float:
        """Time that the run reached, s."""
        return float(self.times[-1])

    @property
    def followed(self) -> np.ndarray:
        """Path (rows, 3) to compare with finer runs', m: of the lower end or, where that is held and cells are equal, of the middle."""
        return self.middle if self.held else self.body

    @property
    def held(self) -> bool:
        """Whether the middle is followed, as the lower end stays where it is."""
        end = self.scene.lower_end
        return end.anchored and not end.released and self.scene.solver.grading == 1.0

    @property
    def body(self) -> np.ndarray:
        """Path (rows, 3) of the lower end, m."""
        first = OUTPUTS.index("body.x")
        return self.outputs[:, first : first + 3]


class _Watch:
    """Reads a staggered chain after every step; the box grid has another state, of which the outputs alone are kept."""

    def __init__(self, model: CableChain, motion: PrescribedMotion) -> None:
        self.model, self.motion = model, motion
        self.drift: list[float] = []
        self.top_error = 0.0
        self.arc_error = 0.0
        self.lengths: list[float] = []
        self.turn = 0.0
        self.pressed = 0.0

    def read(self, time: float) -> None:
        model = self.model
        if model.parts.box is not None:
            return
        prescribed = self.motion(time, -1)[:3]
        at = model.positions()
        self.top_error = max(self.top_error, float(np.abs(at[-1] - prescribed).max()))
        if model.parts.parting is not None and model.state[header.PARTED] == header.ALL_LOST:
            self.drift.append(0.0)
            return
        now = layout.cut(model.parts, model.numbers, model.state, model._work)
        n = now.mesh.shape[0] + 1
        at = at[-n:]  # where it has parted those below have gone
        cells = np.diff(at, axis=0)
        drawn = np.linalg.norm(cells, axis=1)
        self.lengths.append(float(drawn.sum()))
        along = np.sum(cells[1:] * cells[:-1], axis=1) / (drawn[1:] * drawn[:-1])
        self.turn = max(self.turn, float(np.arccos(np.clip(along.min(), -1.0, 1.0))))
        self.arc_error = max(self.arc_error, abs(float(drawn.sum() - now.mesh[:, 0] @ np.linalg.norm(now.y[: n - 1], axis=1))))
        held = HELD * model.scene.cable.bending_stiffness / now.mesh[:, 0] ** 2
        self.pressed = max(self.pressed, float(np.max(-now.force - held)))
        brought = now.y[n - 1]
        own = prescribed if len(brought) == 3 else prescribed[[0, 2]]
        self.drift.append(float(np.linalg.norm(brought - own)))


def _weight(scene: Scene) -> float:
    """Force scale W, N: weights in the medium of cable and body."""
    density = scene.water.density if scene.water is not None else 0.0
    made = sum(abs(row.mass_per_length - density * row.displaced_area) * row.length for row in scene.cable.section or (scene.cable,))
    hung = abs(scene.body.mass - density * scene.body.volume)
    return (made + hung + sum(abs(body.mass - density * body.volume) for body in scene.cable.body)) * scene.environment.gravity


def record(scene: Scene, step: float | None = None, duration: float | None = None, watch: bool = True) -> Record:
    """Run a scene with communication steps of `step` (default: the solver's own) over `duration`; never raises SolverError.

    watch: keep the balances and the geometry; what the audit does not have, as winches, is refused then.
    """
    step = scene.solver.time_step if step is None else step
    duration = scene.run.duration if duration is None else duration
    motion = motion_of(scene)
    audited = watch and scene.solver.grid == "staggered"
    model = CableChain(with_values(scene, {"solver.audit": audited}))
    watcher = _Watch(model, motion)
    outputs = output_steps(duration, step)
    moments = set(np.linspace(0, len(outputs), SHAPES).astype(int))
    rows, shapes, middle, times, substeps = [], [], [], [0.0], [0.0]
    error = ""
    begun = clock.process_time()
    try:
        model.initialize(motion(0.0, 1))
        rows.append(model.outputs.copy())
        middle.append(model.positions()[scene.solver.nodes // 2])
        if watch:
            watcher.read(0.0)
        for k, output in enumerate(outputs):
            before = model.state[header.STEPS]
            follow(model.advance, motion, output, scene.solver.time_step)
            rows.append(model.outputs.copy())
            middle.append(model.positions()[scene.solver.nodes // 2])
            times.append(output.end)
            substeps.append(model.state[header.STEPS] - before)
            if watch:
                watcher.read(times[-1])
            if k + 1 in moments:
                shapes.append(model.positions())
    except SolverError as failure:
        error = str(failure)
    seconds = clock.process_time() - begun
    rows = rows or [np.zeros(len(OUTPUTS))]
    table = np.array(rows)
    excess = table[:, OUTPUTS.index("audit.energy")] if audited else np.zeros(0)
    return Record(
        scene, _weight(scene), np.array(times[: len(rows)]), table, excess, np.array(watcher.drift),
        watcher.top_error, watcher.arc_error, np.array(substeps[: len(rows)]), error, seconds, shapes,
        np.array(watcher.lengths), watcher.turn, watcher.pressed, np.array(middle),
    )  # fmt: skip
