"""What both models have in common: numbers, state and outputs as arrays, and the calls of a co-simulation component."""

from __future__ import annotations

from collections.abc import Callable
from types import ModuleType
from typing import ClassVar

import numpy as np

from cable_model.audit import Audit, audit_of
from cable_model.calls import FASTEST_END, TOO_FAST, Calls
from cable_model.doubts import at_the_start, before_the_run, seen
from cable_model.errors import SolverError, refuse
from cable_model.kernels import header
from cable_model.scene import Scene
from cable_model.signals import INPUTS, SHAPE_POINTS
from cable_model.simulated import numbers_of, parts_of

_UNITS_OF_AN_END = ("m",) * 3 + ("m/s",) * 3 + ("m/s2",) * 3
UNITS = (*_UNITS_OF_AN_END, "m/s", *_UNITS_OF_AN_END, "m/s", "m/s", "")  # of the inputs
_REASONS = {
    header.STEP_TOO_SMALL: "Newton's method found no solution even with steps a millionth of solver.time_step",
    header.NOT_FINITE: "the solution is not finite",
    header.NO_EQUILIBRIUM: "no static equilibrium was found",
    header.NO_WINCH: "the winch turned, but the cable has none",
    header.HAULED_IN: "the winch hauled in the whole cable",
    header.WEIGHTLESS: "no static equilibrium was found, and cable and body weigh less than a millionth of their weight in air",
    header.BELOW_WAVES: "no static equilibrium was found, and the cable is long enough to hang through the bottom of the waves",
    header.NO_SLACK: "no static equilibrium was found for a cable that does not go slack",
    header.OUT_OF_PLANE: "the top, the lower end or a current that inputs give left the vertical plane y = const in which the model moves",
    header.TOO_MANY_STEPS: "a communication step would take more than a million internal steps",
    header.NOT_DRIVEN: "the inputs lower.* say where the lower end is, but they do not drive it",
    header.NO_STREAM: "the inputs water.current_x and y give a current, but are not asked for",
    header.NOT_LET_GO: "the input lower_end.let_go is true, but is not asked for",
    header.TOO_WEAK: "the tension at rest is more than the cable bears",
}
_SAID = (  # where no number says more
    header.OUT_OF_PLANE, header.NO_WINCH, header.HAULED_IN, header.TOO_MANY_STEPS, header.NOT_DRIVEN, header.NO_STREAM,
    header.NOT_LET_GO,
)  # fmt: skip
_REMEDIES = {
    header.STEP_TOO_SMALL: "Try a smaller solver.time_step, solver.lambda_infinity = -0.5, more slack_damping, or a smoother motion",
    header.NOT_FINITE: "Check the motion of the ends for jumps, and try a smaller solver.time_step",
    header.NO_EQUILIBRIUM: "Check the places of top, lower end and seabed, weight in water and current",
    header.NO_WINCH: "Leave winch.speed at 0, or set winch.fitted = true (chain only)",
    header.HAULED_IN: "Stop the winch before a hundredth of cable.length is left",
    header.WEIGHTLESS: "Give the cable or body some weight in water, or a current, or anchor the lower end",
    header.BELOW_WAVES: "Set water.depth to the depth, or 0 for deep water, or give a seabed",
    header.TOO_MANY_STEPS: "Raise solver.time_step, or solver.tolerance where the motion is a sequence of shocks, or take shorter steps",
    header.NO_SLACK: 'Set solver.grid = "staggered" and cable.compressible = false, or check the places of both ends',
    header.OUT_OF_PLANE: "Keep top.y and lower.y constant and water.current_y at 0, or set solver.space = true",
    header.NOT_DRIVEN: "Leave all of them at 0, or set lower_end.anchored and lower_end.driven = true (chain only)",
    header.NO_STREAM: "Leave both at 0, or set water.current_input = true",
    header.NOT_LET_GO: "Leave it false, or set parting.by_input = true (chain only)",
    header.TOO_WEAK: "Check cable.breaking_tension (N), and weight and places of the ends",
}


def _lying_ready(model: Model) -> Calls | None:
    from cable_model import ready

    return ready.calls(model)


def compiled(model: Model) -> Calls | None:
    """In place of what lies ready: nothing, so that numba compiles kernels for exactly the effects of the model's scene."""
    return None


class Model:
    """A cable under a moving top end, stepped like a co-simulation component.

    Subclasses name their kernels.  `state` is the complete state in one float64 array: copy it to save, write it back (`state[:] = `)
    to restore; a restored run is bit-identical.  `outputs` is in the order of signals.OUTPUTS, `positions()` gives the shape.
    """

    name = ""
    offered: ClassVar[Callable[[Model], Calls | None]] = staticmethod(_lying_ready)  # kernels for models that are not given their own
    _at_rest = np.zeros(13)  # the inputs beyond the top's, of a winch, a lower end and water that stand still

    def __init__(self, scene: Scene, precompiled: Callable[[Model], Calls | None] | None = None) -> None:
        """`precompiled` (else `offered`) offers kernels that are compiled already, or None where it has none: then numba compiles them.

        `compiled` in its place asks for kernels of exactly the scene's effects.
        """
        self.scene = scene
        self.motion_order = scene.top.motion_order
        self.parts = parts_of(scene, self.name)
        self.numbers = numbers_of(scene)
        self._at_rest = np.array([0.0, *scene.lower.position, *[0.0] * 9])
        self._at_start: tuple[str, ...] = ()
        self._calls = (precompiled or type(self).offered)(self) or self._just_in_time()

    @staticmethod
    def kernels() -> ModuleType:
        """The module of the model's kernels; importing it imports numba."""
        raise NotImplementedError

    def _just_in_time(self) -> Calls:
        from cable_model.just_in_time import JustInTime

        return JustInTime(self.kernels(), self.motion_order, self.parts, self.numbers)

    @property
    def state(self) -> np.ndarray:
        return self._calls.state

    @property
    def outputs(self) -> np.ndarray:
        return self._calls.outputs

    @property
    def _work(self) -> np.ndarray:
        return self._calls.work

    def initialize(self, inputs: np.ndarray, time: float = 0.0) -> None:
        """Static equilibrium between the ends that `inputs` (22,) place; the last may be left out, see `complete`.

        Raises ParameterError where they do not go with the scene, SolverError where there is no equilibrium.
        """
        inputs = self.complete(inputs)
        self._check_start(inputs)
        self.state[:] = 0.0
        self._must(self._calls.start(float(time), inputs), time)
        if hasattr(self, "scene"):  # one that is made from numbers has none
            self._at_start = (*before_the_run(self.scene), *at_the_start(self.scene, self.name, self.outputs.tolist()))

    def warnings(self) -> tuple[str, ...]:
        """What is doubtful about the run so far; none before `initialize`."""
        return (*self._at_start, *seen(self.state))

    @property
    def audit(self) -> Audit | None:
        """Balances of energy and momentum so far; None where solver.audit does not ask for them."""
        return None if self.parts.audit is None else audit_of(self.state)

    @property
    def doubts(self) -> int:
        """How many kinds of doubt the run itself has brought up so far; only where it grows does `warnings`."""
        return int(self.state[header.DOUBTS])

    def _check_start(self, inputs: np.ndarray) -> None:
        """Refuse ends that do not go with the scene."""

    def step(self, time: float, step: float, inputs: np.ndarray) -> None:
        """One communication step from `time`, with inputs (22,) held as FMI holds them: their values at the start of the step.

        The ends move on by extrapolation, see kernels.ends.predict; what they were off by at the start is removed smoothly.
        """
        inputs = self.complete(inputs)
        step = self._positive(step)
        self._must(self._calls.step(float(time), step, inputs), time)

    def advance(self, time: float, step: float, start: np.ndarray, end: np.ndarray) -> None:
        """One step with the inputs (22,) known at both ends of it, in the order of signals.INPUTS."""
        step = self._positive(step)
        start, end = self.complete(start), self.complete(end)
        self._must(self._calls.advance(float(time), step, start, end), time)

    def positions(self) -> np.ndarray:
        """Positions (n, 3) of the cable from the lower end to the top, m."""
        return self.nodes()[:, :3]

    def nodes(self) -> np.ndarray:
        """Position (m) and tension (N) at the nodes of the cable from the lower end to the top, (n, 4)."""
        return self._points(False, self._node_count())

    def arc_lengths(self) -> np.ndarray:
        """Unstretched length (n,) of the cable from its lower end to each node, m; a winch changes it."""
        raise NotImplementedError

    def shape(self, count: int = SHAPE_POINTS) -> np.ndarray:
        """The same at `count` points that are evenly spaced along the unstretched cable, (count, 4).  Raises ParameterError below 2."""
        if count < 2:
            raise refuse("count", count, "points", ">= 2", "The first is the lower end, the last the top.")
        return self._points(True, count)

    def _points(self, even: bool, count: int) -> np.ndarray:
        at = np.zeros((count, 4))
        self._calls.points(even, at)
        return at

    def _node_count(self) -> int:
        return self.scene.solver.nodes

    def _must(self, status: int, time: float) -> None:
        if status == header.OK and np.isfinite(self.outputs).all():
            return
        if status == TOO_FAST:
            speed = self._calls.end_speed
            fastest = f"<= {FASTEST_END:g}"
            raise refuse("speed of the top or lower end", speed, "m/s", fastest, "Check the units of its motion, and for jumps.")
        status = status or header.NOT_FINITE
        where = max(float(self.state[header.ERROR_TIME]), time)
        how_bad = "" if status in _SAID else f" ({self._measure(status)})"
        raise SolverError(
            f"{type(self).__name__} at t = {where:.6g} s: {_REASONS[status]}{how_bad}. "
            f"{_REMEDIES[status]}. Results before this time are valid."
        )

    def _measure(self, status: int) -> str:
        """How bad a failed step is."""
        size, node = self.state[header.ERROR_SIZE], int(self.state[header.ERROR_NODE])
        if status == header.TOO_WEAK:
            return f"{size:.3g} times that at node {node} from the lower end"
        return f"largest last Newton change {size:.3g} at node {node} from the lower end"

    @staticmethod
    def _positive(step: float) -> float:
        if not step > 0.0 or not np.isfinite(step):
            raise refuse("communication step", float(step), "s", "finite and > 0", "Give a positive step.")
        return float(step)

    def complete(self, inputs: np.ndarray) -> np.ndarray:
        """Inputs (22,), of which (9,), (10,), (19,) or (21,) will do: the rest stands still and does nothing."""
        inputs = np.asarray(inputs, dtype=np.float64)
        if inputs.shape in ((9,), (10,), (19,), (21,)):
            inputs = np.concatenate([inputs, self._at_rest[len(inputs) - 9 :]])
        return self._finite(inputs)

    @staticmethod
    def _finite(inputs: np.ndarray) -> np.ndarray:
        inputs = np.ascontiguousarray(inputs, dtype=np.float64)
        if inputs.shape != (len(INPUTS),):
            given = (
                "Give position, velocity and acceleration of the top; with a winch its speed, a driven lower end 19, a current 21, or all."
            )
            raise refuse("inputs", inputs.shape, "", "(9,), (10,), (19,), (21,) or (22,)", given)
        if not np.isfinite(inputs).all():
            first = int(np.argmin(np.isfinite(inputs)))
            raise refuse(INPUTS[first], float(inputs[first]), UNITS[first], "finite", "Check what is connected to this input.")
        return inputs
