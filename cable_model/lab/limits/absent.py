"""Proof that absent effects cost nothing: the bare chain beside kernels from which the code of every effect that it lacks was cut out.

A function that begins with `if PART is None: return ...` keeps that return only, and a choice by presence its absent side only.  Both
builds run in processes of their own, in turn; their results must be the same numbers.
"""

from __future__ import annotations

import ast
import json
import os
import shutil
import statistics
import subprocess
import sys
import tempfile
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import cable_model

KEPT = ("slack",)  # what the bare chain has
BY_ANOTHER_NAME = ("add_seabed", "lower_end_terms", "lower_end_tension")  # functions that call their part `present`
ROUNDS = 41
RUNNER = """
import sys, time
import numpy as np
from cable_model.lab.bench import scene_of
from cable_model.model import compiled
from cable_model.models import MODELS
from cable_model.motion import motion_of
scene = scene_of({"run.duration": 3.0})
model, motion, step = MODELS["chain"](scene, compiled), motion_of(scene), scene.run.output_step
tops = [(motion(k * step), motion((k + 1) * step)) for k in range(30)]
def run():
    model.initialize(tops[0][0])
    begun = time.process_time()
    for k, (start, end) in enumerate(tops):
        model.advance(k * step, step, start, end)
    return time.process_time() - begun
run()
for line in sys.stdin:
    print(min(run() for _ in range(3)), model.outputs.tobytes().hex(), flush=True)
"""


@dataclass(frozen=True)
class Absent:
    """Ratio of the times, ours to the cut one's, a round each; and how many functions and choices were cut."""

    ratios: tuple[float, ...]
    cut: int

    @property
    def median(self) -> float:
        return statistics.median(self.ratios)


class _Cutter(ast.NodeTransformer):
    """Cuts what a part that is absent never reaches."""

    def __init__(self) -> None:
        self.cut = 0

    def visit_FunctionDef(self, node: ast.FunctionDef) -> ast.FunctionDef:
        for k, statement in enumerate(node.body):
            if isinstance(statement, ast.If) and self._leaves(node.name, statement):
                node.body = [*node.body[:k], *statement.body]
                self.cut += 1
                break
        return node

    @staticmethod
    def _leaves(function: str, choice: ast.If) -> bool:
        if choice.orelse or not isinstance(choice.body[-1], ast.Return):
            return False
        test = choice.test
        if not isinstance(test, ast.Compare) or not isinstance(test.ops[0], ast.Is) or ast.unparse(test.comparators[0]) != "None":
            return False
        part = ast.unparse(test.left).removeprefix("parts.")
        return part not in KEPT and (part != "present" or function in BY_ANOTHER_NAME)

    def visit_Call(self, node: ast.Call) -> ast.Call:
        if isinstance(node.func, ast.Name) and node.func.id == "by_presence":
            node.args[1] = node.args[0]
            self.cut += 1
        return node


def cut_out(folder: Path) -> int:
    """Copy the package to `folder` with the kernels cut; returns how many functions and choices were cut."""
    source = Path(cable_model.__file__).parent
    shutil.copytree(source, folder / "cable_model", ignore=shutil.ignore_patterns("__pycache__"))
    cutter = _Cutter()
    for path in sorted((folder / "cable_model" / "kernels").glob("*.py")):
        path.write_text(ast.unparse(cutter.visit(ast.parse(path.read_text(encoding="utf-8")))) + "\n", encoding="utf-8")
    return cutter.cut


def _started(root: Path) -> subprocess.Popen[str]:
    environment = {**os.environ, "PYTHONPATH": str(root)}
    return subprocess.Popen(
        [sys.executable, "-c", RUNNER], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True, cwd=root, env=environment
    )


def _asked(process: subprocess.Popen[str]) -> tuple[float, str]:
    assert process.stdin is not None and process.stdout is not None
    process.stdin.write("run\n")
    process.stdin.flush()
    seconds, outputs = process.stdout.readline().split()
    return float(seconds), outputs


def measure(rounds: int = ROUNDS, told: Callable[[str], None] = print) -> Absent:
    """Time both builds in turn.  Raises RuntimeError where their results differ in any bit."""
    with tempfile.TemporaryDirectory() as name:
        cut = cut_out(Path(name))
        told(f"bare chain against kernels with {cut} functions and choices cut")
        ours, bare = _started(Path(cable_model.__file__).parents[1]), _started(Path(name))
        ratios = []
        try:
            for k in range(rounds):
                first, second = (ours, bare) if k % 2 == 0 else (bare, ours)
                answers = {id(process): _asked(process) for process in (first, second)}
                if len({outputs for _, outputs in answers.values()}) != 1:
                    raise RuntimeError("the kernels without the code of absent effects give other numbers")
                ratios.append(answers[id(ours)][0] / answers[id(bare)][0])
        finally:
            for process in (ours, bare):
                process.communicate()
    return Absent(tuple(ratios), cut)


def sentence(found: Absent) -> str:
    """The result in words."""
    low, _, high = statistics.quantiles(found.ratios, n=4) if len(found.ratios) > 1 else (found.median,) * 3
    return (
        f"Absent effects cost nothing: the bare chain against kernels from which {found.cut} functions and choices of absent effects were "
        f"cut out gives the same bits at {found.median:.3f} of the time (median of {len(found.ratios)} interleaved rounds, quartiles "
        f"{low:.3f} and {high:.3f})."
    )


if __name__ == "__main__":
    json.dump(measure(told=lambda _: None).ratios, sys.stdout)
