"""Measured and computed amplitudes of a sphere on a cable [Wang 1971, table 2]."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass

import matplotlib.pyplot as plt
import numpy as np

from cable_model.lab.published.page import Page
from cable_model.scene import Scene, load, with_values
from cable_model.studies.timed import Setting, timed

NAME = "table_2_sphere"
FOOT = 0.3048  # m
NATURAL = 1.14  # rad/s, measured
RATIOS = (0.5, 1.0, 1.5, 2.0)
DIGIT = 0.005  # ft: half the last digit printed
MEASURED = ((0.23, 0.21, 0.12, 0.10), (0.21, 0.21, 0.21, 0.21))  # across, vertical, ft [table 2]
REPORT = ((0.23, 0.22, 0.15, 0.12), (0.20, 0.20, 0.20, 0.20))  # computed there, with inputs that are not all in the report
SETTLING, MEASURED_CYCLES = 25, 3  # cycles before, cycles measured
INPUTS: Mapping[str, Mapping[str, object]] = {
    "cable C_D 1.2": {},
    "cable C_D 1.8": {"cable.normal_drag_coefficient": 1.8},
    "cable C_D 2.6": {"cable.normal_drag_coefficient": 2.6},
}
MODELS = {"chain": "CableChain", "tow": "TowCable"}


@dataclass(frozen=True)
class Amplitudes:
    """Half the ranges of the body's motion, ft, by (model, inputs, ratio): across, vertical."""

    of: dict[tuple[str, str, float], tuple[float, float]]

    def row(self, model: str, inputs: str, axis: int) -> list[float]:
        return [self.of[model, inputs, ratio][axis] for ratio in RATIOS if (model, inputs, ratio) in self.of]


def scene_at(ratio: float, quick: bool) -> Scene:
    """The shipped scene, its circle at a multiple of the natural frequency; the amplitude of table 1, 2.5 inches."""
    omega = ratio * NATURAL
    period = 2.0 * math.pi / omega
    base = load("dale_sphere")
    parts = [
        {"kind": part.kind, "axis": part.axis, "amplitude": part.amplitude, "angular_frequency": omega, "phase": part.phase,
         "ramp_time": 4.0 * period} for part in base.top.motion
    ]  # fmt: skip
    cycles = (8 if quick else SETTLING) + MEASURED_CYCLES
    return with_values(
        base,
        {"top.motion": parts, "run.duration": cycles * period, "run.output_step": period / 100.0, "solver.time_step": period / 200.0},
    )


def amplitudes(scene: Scene, model: str, changes: Mapping[str, object]) -> tuple[float, float]:
    run = timed(scene, Setting(model, model, {**changes, "solver.tolerance": 1e-6 if model == "tow" else 0.0}))
    omega = scene.top.motion[0].omega
    late = run.times > run.times[-1] - MEASURED_CYCLES * 2.0 * math.pi / omega - 1e-9
    motion = {part.axis: part.amplitude * np.sin(omega * run.times[late] + part.phase) for part in scene.top.motion}
    x, z = run.position[late, 0] + motion["x"], run.position[late, 2] + motion["z"]
    return 0.5 * float(np.ptp(x)) / FOOT, 0.5 * float(np.ptp(z)) / FOOT


def measure(quick: bool = False, told: Callable[[str], None] | None = None) -> Amplitudes:
    found = {}
    for ratio in RATIOS:
        scene = scene_at(ratio, quick)
        for model in MODELS:
            for inputs, changes in list(INPUTS.items())[: 1 if quick else None]:
                if told is not None:
                    told(f"{MODELS[model]}, {inputs}, {ratio:g} times the natural frequency")
                found[model, inputs, ratio] = amplitudes(scene, model, changes)
    return Amplitudes(found)


def page(found: Amplitudes) -> Page:
    inputs = list(dict.fromkeys(key[1] for key in found.of))
    figure, (left, right) = plt.subplots(1, 2, figsize=(10, 4.5))
    for axis, k, title in ((left, 0, "across"), (right, 1, "vertical")):
        axis.errorbar(RATIOS, MEASURED[k], yerr=DIGIT, fmt="ks", capsize=4, label="measured, to half a digit")
        axis.plot(RATIOS, REPORT[k], "k_", markersize=14, label="computed in the report")
        for i, (model, name) in enumerate(MODELS.items()):
            low, high = found.row(model, inputs[0], k), found.row(model, inputs[-1], k)
            axis.plot(RATIOS, low, "o-", color=f"C{i}", markersize=4, label=f"{name}, {inputs[0]}")
            if len(inputs) > 1:
                axis.plot(RATIOS, high, "v--", color=f"C{i}", markersize=4, label=f"{name}, {inputs[-1]}")
                axis.fill_between(RATIOS, low, high, color=f"C{i}", alpha=0.15)
        axis.set(title=f"body's amplitude {title}", xlabel="frequency / 1.14 rad/s", ylabel="amplitude [ft]", ylim=(0.0, 0.3))
        axis.grid(alpha=0.3)
    left.legend(fontsize=7, loc="lower left")

    def worst(model: str, name: str) -> float:
        return max(abs(a - b) for a, b in zip(found.row(model, name, 0), MEASURED[0], strict=True))

    def told(model: str, name: str) -> str:
        row = ", ".join(f"{a:.3f}" for a in found.row(model, name, 0))
        return f"{MODELS[model]} {row} ({name}: within {worst(model, name):.3f} ft)"

    vertical = [abs(a - b) for model in MODELS for a, b in zip(found.row(model, inputs[0], 1), MEASURED[1], strict=True)]
    caption = (
        f"[Wang 1971, table 2]: body's amplitude across, measured {', '.join(f'{a:.2f}' for a in MEASURED[0])} ft at "
        f"{', '.join(f'{r:g}' for r in RATIOS)} times 1.14 rad/s, digits of 0.01 ft; "
        + "; ".join(told(model, name) for name in dict.fromkeys((inputs[0], inputs[-1])) for model in MODELS)
        + f".  Vertical: within {max(vertical):.3f} ft of 0.21.  Drag coefficients, stiffness and cable mass are guesses of the report "
        "or of ours: the shaded range between two drag coefficients of the cable shows what that may change."
    )
    rows: list[tuple[object, ...]] = [("measured", "", "across", *MEASURED[0]), ("measured", "", "vertical", *MEASURED[1])]
    rows += [("report", "", "across", *REPORT[0]), ("report", "", "vertical", *REPORT[1])]
    for model, name in MODELS.items():
        for which in inputs:
            rows += [(name, which, axis, *found.row(model, which, k)) for k, axis in enumerate(("across", "vertical"))]
    shown: list[tuple[object, ...]] = [("amplitude [ft] at omega/omega_n", *(f"{r:g}" for r in RATIOS))]
    shown += [(", ".join(filter(None, map(str, row[:3]))), *(f"{float(str(v)):.3f}" if k > 3 else f"{float(str(v)):.2f}" for v in row[3:]))
              for k, row in enumerate(rows)]  # fmt: skip
    head = ("source", "inputs", "axis", *(f"{ratio:g}" for ratio in RATIOS))
    return Page(NAME, "Wang's table 2: a sphere on a cable", caption, figure, head, rows, shown)
