"""Floating-point operations of one Newton iteration, counted by running the kernels as plain Python on numbers that count themselves.

Each number also carries the time at which a machine without any other limit would have it: operations wait for their operands only.
The longest such path is what no compiler can get below without another algorithm.  Run with NUMBA_DISABLE_JIT=1; times, of each kind
of operation, as JSON, then cases.
"""

from __future__ import annotations

import json
import math
import sys
from typing import Any, ClassVar

import numpy as np

from cable_model.kernels import grid, header, layout, vector
from cable_model.kernels.build import build
from cable_model.kernels.family import coefficients
from cable_model.kernels.fluid import in_water_now
from cable_model.kernels.path import Ends
from cable_model.kernels.staggered_step import Winding
from cable_model.lab.bench import CASES, scene_of
from cable_model.models import MODELS

LATENCY = {"add": 4.0, "multiply": 4.0, "divide": 14.0, "root": 18.0, "sine": 50.0}  # times, in any unit; cycles unless others are given
NODES = (21, 41)  # the difference of the two is counted: what belongs to the ends drops out


class Counted(float):
    """A number that counts the operations that made it, in `operations`, and knows when it is ready."""

    operations: ClassVar[dict[str, int]] = dict.fromkeys(LATENCY, 0)
    __slots__ = ("ready",)
    ready: float

    def __new__(cls, value: float, ready: float = 0.0) -> Counted:
        made = super().__new__(cls, value)
        made.ready = ready
        return made

    @classmethod
    def _made(cls, kind: str, value: float, *operands: float) -> Counted:
        cls.operations[kind] += 1
        return cls(value, max(getattr(operand, "ready", 0.0) for operand in operands) + LATENCY[kind])

    def __add__(self, other: Any) -> Counted:
        return self._made("add", float(self) + float(other), self, other)

    def __sub__(self, other: Any) -> Counted:
        return self._made("add", float(self) - float(other), self, other)

    def __rsub__(self, other: Any) -> Counted:
        return self._made("add", float(other) - float(self), self, other)

    def __mul__(self, other: Any) -> Counted:
        return self._made("multiply", float(self) * float(other), self, other)

    def __truediv__(self, other: Any) -> Counted:
        return self._made("divide", float(self) / float(other), self, other)

    def __rtruediv__(self, other: Any) -> Counted:
        return self._made("divide", float(other) / float(self), self, other)

    def __pow__(self, other: Any, modulus: None = None) -> Any:
        assert other == 0.5, "kernels raise to a half only"
        return self._made("root", float(self) ** 0.5, self)

    def __neg__(self) -> Counted:
        return type(self)(-float(self), self.ready)  # a change of sign joins the next operation

    def __abs__(self) -> Counted:
        return type(self)(abs(float(self)), self.ready)

    __radd__, __rmul__ = __add__, __mul__


def _counting(function: Any, kind: str) -> Any:
    def call(x: float) -> float:
        return Counted._made(kind, function(float(x)), x) if isinstance(x, Counted) else function(x)

    return call


def _count_functions() -> None:
    """Let the functions that kernels take from `math` count too; for a process that does nothing else."""
    for name, kind in {"sqrt": "root", "sin": "sine", "cos": "sine"}.items():
        setattr(math, name, _counting(getattr(math, name), kind))


def _counted(array: np.ndarray) -> np.ndarray:
    return np.array([Counted(x) for x in array], dtype=object)


def _iteration(case: str, nodes: int) -> tuple[dict[str, int], float]:
    """Operations and longest path of one Newton iteration of a moving chain, with prediction and new rates."""
    scene = scene_of({**CASES[case], "solver.nodes": nodes})
    model: Any = MODELS["chain"](scene)
    model.initialize(np.zeros(10))
    p = model.numbers
    parts = in_water_now(model.parts, p, model.state)
    state, work = _counted(model.state), _counted(model._work)
    state[header.CONTRACTION] = 1e-9  # known to converge fast: one iteration
    view = layout.cut(parts, p, state, work)
    problem, c = build(parts, p, 0.0), coefficients(0, -0.9)
    like = vector.axes(parts.space, 0.0, 0.0, 0.0)
    Counted.operations = dict.fromkeys(LATENCY, 0)
    iterations = grid.newton_step(
        parts.box, parts, problem, view, c, 0.0, 0.005, 1.0, like, like, Ends(like, like), Winding(problem.cable.length, 0.0, 0.0)
    )
    assert iterations == 1, f"{case}: {iterations} iterations instead of one"
    longest = max(getattr(x, "ready", 0.0) for x in (*view.y1.ravel(), *view.yd1.ravel()))
    return dict(Counted.operations), longest


def per_node(case: str) -> dict[str, float]:
    """Operations by kind, their sum `flops`, and `path`, the longest path, of a node and Newton iteration."""
    (few, short), (many, long) = (_iteration(case, nodes) for nodes in NODES)
    more = NODES[1] - NODES[0]
    found = {kind: (many[kind] - few[kind]) / more for kind in LATENCY}
    return {**found, "flops": sum(found.values()), "path": (long - short) / more}


if __name__ == "__main__":
    _count_functions()
    LATENCY.update(json.loads(sys.argv[1]))
    json.dump({case: per_node(case) for case in sys.argv[2:]}, sys.stdout)
