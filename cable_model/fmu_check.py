"""Simulating a built FMU through fmpy under given top motion, to compare it with a reference."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

import numpy as np

from cable_model.motion import TopMotion
from cable_model.signals import INPUTS, OUTPUTS


def simulate_fmu(
    fmu: Path, times: np.ndarray, inputs: np.ndarray, parameters: Mapping[str, object] | None = None
) -> tuple[tuple[str, ...], np.ndarray]:
    """Simulate an FMU at equal communication steps `times` (n,) with `inputs` (n, 10); returns columns and table as a library run has."""
    import fmpy

    layout = [("time", float), *((name, float) for name in INPUTS)]
    signals = np.array([(t, *row) for t, row in zip(times, inputs, strict=True)], dtype=layout)
    outputs = [*OUTPUTS, "solver.cpu_time"]
    result = fmpy.simulate_fmu(
        str(fmu),
        start_time=float(times[0]),
        stop_time=float(times[-1]),
        step_size=float(times[1] - times[0]),
        output_interval=float(times[1] - times[0]),
        input=signals,
        output=outputs,
        start_values={**dict(zip(INPUTS, inputs[0], strict=True)), **(parameters or {})},
        fmi_type="CoSimulation",
    )
    table = np.column_stack([result["time"], inputs[: len(result)], *(result[name] for name in outputs)])
    return ("time", *INPUTS, *outputs), table


def sampled_motion(motion: TopMotion, duration: float, step: float) -> tuple[np.ndarray, np.ndarray]:
    """Times k * step and the top's motion there, (n, 10)."""
    times = step * np.arange(round(duration / step) + 1)
    return times, np.array([motion(t) for t in times])
