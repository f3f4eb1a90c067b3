"""The note on the kernels' limits: operations counted, bounds, times of a vector and a scalar build, growth with the nodes."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from cable_model.lab.limits import measuring
from cable_model.machine import machine

# us per node and Newton iteration that the kernels are meant to keep
TARGETS = {
    "bare chain": 0.1,
    "bending": 0.2,
    "space": 0.25,
    "space and bending": 0.5,
    "box grid": 0.5,
    "water": None,
    "box grid and bending": None,
}
COUNTED = ("bare chain", "bending", "water", "space", "space and bending")  # the box grid's pivoting depends on its numbers
SCALAR = {"NUMBA_CPU_NAME": "x86-64", "NUMBA_CPU_FEATURES": "", "NUMBA_LOOP_VECTORIZE": "0", "NUMBA_SLP_VECTORIZE": "0"}


@dataclass(frozen=True)
class Limits:
    """Everything that the note shows."""

    counts: Mapping[str, Mapping[str, float]]
    vector: Mapping[str, float]  # s per node and Newton iteration, compiled for this machine
    scalar: Mapping[str, float]  # for any x86-64 machine, no vectors
    rates: measuring.Rates
    growth: Sequence[tuple[int, float, float]]


def _asked(module: str, arguments: Sequence[str], environment: Mapping[str, str]) -> Any:
    """What a module of this package prints as JSON, in a process of its own."""
    done = subprocess.run(
        [sys.executable, "-m", module, *arguments], env={**os.environ, **environment}, capture_output=True, text=True, check=True
    )
    return json.loads(done.stdout)


def measure(quick: bool = False, told: Callable[[str], None] = print) -> Limits:
    """Count and time; a scalar build in a process of its own.  `quick`: the bare chain only, and no scalar build."""
    cases = list(TARGETS)[: 1 if quick else None]
    told("counting operations")
    rates = measuring.machine_rates()
    counted = [json.dumps(dict(rates.latencies)), *(case for case in cases if case in COUNTED)]
    counts = _asked("cable_model.lab.limits.counting", counted, {"NUMBA_DISABLE_JIT": "1"})
    told("times of a build for this machine")
    vector = measuring.times_of(cases)
    scalar: Mapping[str, float] = {}
    if not quick:
        told("times of a scalar build")
        scalar = _asked("cable_model.lab.limits.measuring", cases, SCALAR)
    told("growth with the nodes")
    growth = measuring.growth((26, 51), 0.5) if quick else measuring.growth()
    return Limits(counts, vector, scalar, rates, growth)


def _row(case: str, found: Limits) -> str:
    target = TARGETS[case]
    cells = [case]
    if case in found.counts:
        count = found.counts[case]
        work, divider = count["flops"] / found.rates.flops, count["divide"] * found.rates.division
        cells += [f"{count['flops']:.0f}", f"{count['divide']:.0f} + {count['root']:.0f}"]
        cells += [f"{1e9 * seconds:.0f}" for seconds in (work, divider, count["path"])]
    else:
        cells += ["-"] * 5
    cells += [f"{1e9 * found.vector[case]:.0f}", f"{1e9 * found.scalar[case]:.0f}" if case in found.scalar else "-"]
    cells += [f"{1e3 * target:.0f}" if target is not None else "-"]
    return f"| {' | '.join(cells)} |"


def markdown(found: Limits) -> str:
    """The note."""
    growth = [(n, n * cost, iterations) for n, cost, iterations in found.growth]
    (n_low, low, _), (n_high, high, _) = growth[0], growth[-1]
    slope = (high - low) / (n_high - n_low)
    latencies = ", ".join(f"{kind} {1e9 * seconds:.2g}" for kind, seconds in found.rates.latencies.items())
    lines = [
        "# How near the kernels are to what the machine can do",
        "",
        "Written by `python -m cable_model.lab limits -o docs/limits.md`."
        "  Nanoseconds per node and Newton iteration, everything of it counted",
        "in: averages, residual, Jacobian, elimination, new rates.  Times are differences between 401 and 101 nodes, so that the cost of",
        f"a call drops out, and the shortest of {measuring.REPETITIONS}.  {machine()}.",
        "",
        "Operations are counted by running the kernels on numbers that count themselves.  *Work* is their number over the rate at which",
        f"this core adds and multiplies scalars that wait for nothing ({found.rates.flops / 1e9:.1f} GFlop/s).  *Divider* is what the",
        f"divisions alone take that wait for nothing ({1e9 * found.rates.division:.2f} ns each), beside the rest.  *Path* is the longest",
        f"chain of operations that wait for one another, at the latencies of this core ({latencies} ns): elimination",
        "upwards, then substitution downwards.  No order of the same operations is faster than the largest of the three without vectors",
        "across nodes; loads, stores and comparisons are in none of them.",
        "",
        "| chain | flops | divisions + roots | work | divider | path | measured | scalar build | target |",
        "|---|---:|---:|---:|---:|---:|---:|---:|---:|",
        *(_row(case, found) for case in found.vector),
        "",
        "Vectors help little: the recurrences of the elimination run from node to node, and only averages and assembly could share",
        "an instruction among nodes.  Arrays of 101 nodes in the plane take 40 kB, so all is in the nearest caches.  Using a factorisation",
        "again does not pay: with the prediction by rates, one iteration a step is the rule, and a second elimination is rare.",
        "",
        "## Growth with the number of nodes",
        "",
        "Bare chain, 0.005 s, whole steps with outputs after each; processor milliseconds per simulated second, medians of five, beside",
        f"the straight line through the first and the last: {1e3 * (low - slope * n_low):.2f} ms for the calls, "
        f"{1e6 * slope:.2f} us for each node.",
        "",
        "| nodes | ms per s | straight line | off it | Newton iterations a step |",
        "|---:|---:|---:|---:|---:|",
        *(
            f"| {n} | {1e3 * cost:.2f} | {1e3 * (line := low + slope * (n - n_low)):.2f} | {100.0 * (cost / line - 1.0):+.1f} % "
            f"| {iterations:.2f} |"
            for n, cost, iterations in growth
        ),
    ]
    return "\n".join(lines) + "\n"
