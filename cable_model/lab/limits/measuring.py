"""Times of the kernels, apart from what calls them, and of the machine's own additions and multiplications."""

from __future__ import annotations

import json
import math
import statistics
import sys
import time as clock
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

import numba

from cable_model.kernels import grid, header, layout, vector
from cable_model.kernels.build import build
from cable_model.kernels.family import coefficients
from cable_model.kernels.fluid import in_water_now
from cable_model.kernels.path import Ends
from cable_model.kernels.staggered_step import Winding
from cable_model.lab.bench import CASES, scene_of
from cable_model.model import compiled
from cable_model.models import MODELS
from cable_model.motion import motion_of

NODES = (101, 401)  # the difference of the two is timed: what a call costs drops out
GROWTH = (101, 301, 1001, 3001)
REPETITIONS = 15


@numba.njit
def _additions(count: int, x: float) -> float:
    for _ in range(count):
        x = x + 1e-9
    return x


@numba.njit
def _multiplications(count: int, x: float) -> float:
    for _ in range(count):
        x = x * 1.0000001
    return x


@numba.njit
def _divisions(count: int, x: float) -> float:
    for _ in range(count):
        x = 1.7 / x
    return x


@numba.njit
def _roots(count: int, x: float) -> float:
    for _ in range(count):
        x = math.sqrt(x + 1.7)
    return x


@numba.njit
def _sines(count: int, x: float) -> float:
    for _ in range(count):
        x = math.sin(x + 1.7)
    return x


@numba.njit
def _divisions_side_by_side(count: int, x: float) -> float:
    a, b, c, d = x, x + 1.0, x + 2.0, x + 3.0
    for _ in range(count):
        a = 1.1 / a
        b = 1.2 / b
        c = 1.3 / c
        d = 1.4 / d
    return a + b + c + d


@numba.njit
def _side_by_side(count: int, x: float) -> float:
    a, b, c, d, e, f, g, h = x, x + 1.0, x + 2.0, x + 3.0, x + 4.0, x + 5.0, x + 6.0, x + 7.0
    for _ in range(count):
        a = a * 1.0000001 + 1e-9
        b = b * 1.0000002 + 1e-9
        c = c * 1.0000003 + 1e-9
        d = d * 1.0000004 + 1e-9
        e = e * 1.0000005 + 1e-9
        f = f * 1.0000006 + 1e-9
        g = g * 1.0000007 + 1e-9
        h = h * 1.0000008 + 1e-9
    return a + b + c + d + e + f + g + h


def _least(call: Callable[[], Any], count: int) -> float:
    """Shortest of REPETITIONS times of `count` calls, s a call: what disturbs only adds."""
    call()
    times = []
    for _ in range(REPETITIONS):
        begun = clock.perf_counter()
        for _ in range(count):
            call()
        times.append((clock.perf_counter() - begun) / count)
    return min(times)


@dataclass(frozen=True)
class Rates:
    """What the machine does by itself, scalars of double precision on one core."""

    flops: float  # additions and multiplications that wait for nothing, 1/s
    latencies: Mapping[str, float]  # s, of operations that wait for the one before, by the kinds of counting.LATENCY
    division: float  # s, of divisions that wait for nothing


def machine_rates(count: int = 100_000) -> Rates:
    def of(loop: Callable[[int, float], float], operations: float = 1.0) -> float:
        return _least(lambda: loop(count, 1.0), 3) / count / operations

    add = of(_additions)
    latencies = {
        "add": add, "multiply": of(_multiplications), "divide": of(_divisions), "root": of(_roots) - add, "sine": of(_sines) - add,
    }  # fmt: skip
    return Rates(1.0 / of(_side_by_side, 16.0), latencies, of(_divisions_side_by_side, 4.0))


def _stepper(case: str, nodes: int) -> Callable[[], int]:
    """One Newton step of one iteration, of a chain in motion, again and again from the same state."""
    scene = scene_of({**CASES[case], "solver.nodes": nodes})
    model: Any = MODELS["chain"](scene)
    motion, step = motion_of(scene), scene.run.output_step
    model.initialize(motion(0.0))
    for k in range(5):
        model.advance(k * step, step, motion(k * step), motion((k + 1) * step))
    p, state = model.numbers, model.state
    parts = in_water_now(model.parts, p, state)
    view = layout.cut(parts, p, state, model._work)
    view.yd0[:] = view.yd
    problem, c = build(parts, p, 0.0), coefficients(0, -0.9)
    top = motion(0.5)
    place, velocity = (vector.axes(parts.space, *top[3 * k : 3 * k + 3]) for k in range(2))
    winding = Winding(problem.cable.length, 0.0, 0.0)

    def step_once() -> int:
        state[header.CONTRACTION] = 1e-9
        return int(grid.newton_step(parts.box, parts, problem, view, c, 0.5, 0.005, 1.0, place, place, Ends(velocity, velocity), winding))

    return step_once


def per_node(case: str) -> float:
    """Seconds of a Newton iteration a node: prediction, assembly, elimination and new rates."""
    times = []
    for nodes in NODES:
        step = _stepper(case, nodes)
        iterations = step()
        times.append(_least(step, 200) / iterations)
    return (times[1] - times[0]) / (NODES[1] - NODES[0])


def growth(nodes: tuple[int, ...] = GROWTH, duration: float = 1.0) -> list[tuple[int, float, float]]:
    """Nodes, processor seconds per simulated second and node, and Newton iterations a step of the bare chain."""
    models = {n: MODELS["chain"](scene_of({"solver.nodes": n, "run.duration": duration}), compiled) for n in nodes}
    seconds: dict[int, list[float]] = {n: [] for n in nodes}
    for _ in range(5):
        for n, model in models.items():
            motion, step = motion_of(model.scene), model.scene.run.output_step
            tops = [(motion(k * step), motion((k + 1) * step)) for k in range(math.floor(duration / step + 0.5))]
            model.initialize(tops[0][0])
            begun = clock.process_time()
            for k, (start, end) in enumerate(tops):
                model.advance(k * step, step, start, end)
            seconds[n].append(clock.process_time() - begun)
    return [(n, statistics.median(seconds[n]) / duration / n, float(m.outputs[16] / m.outputs[15])) for n, m in models.items()]


def times_of(cases: list[str]) -> dict[str, float]:
    return {case: per_node(case) for case in cases}


if __name__ == "__main__":
    json.dump(times_of(sys.argv[1:]), sys.stdout)
