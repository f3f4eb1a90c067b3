"""No parameter of an FMU is accepted and ignored: each changes an output in some setting, or is refused."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest
from fmu_support import FMICallException, Fmu, sway
from native_support import only_where_they_run

from cable_model.effects import used_by
from cable_model.models import MODELS
from fmu_src.interface import Variable, table

STEP, STEPS = 0.4, 8  # over a swing down, in which tension falls
PARAMETERS = [row for row in table() if row.causality == "parameter"]
MOORED = {
    "lower_end.anchored": True, "lower_end.x": 60.0, "lower_end.z": -60.0, "body.mass": 0.0, "body.volume": 0.0, "body.drag_area": 0.0,
    "body.added_mass": 0.0, "seabed.level": -60.0, "seabed.stiffness": 1e5, "seabed.friction_coefficient": 0.5,
}  # fmt: skip
SEA = {"current.speed": 0.5, "wave.amplitude": 1.0, "wave.period": 7.0}
# what is set beside the parameter, one after the other until it shows
SETTINGS: dict[str, tuple[dict[str, Any], ...]] = {
    "chain": (
        {}, SEA, MOORED, {"cable.compressible": True}, {"cable.quadratic_damping": 1e4}, {**SEA, "solver.space": True},
        {"solver.tolerance": 1e-3, "solver.time_step": 0.05}, {"winch.fitted": True}, {**MOORED, "solver.space": True},
        {"solver.grid": 1}, {"cable.breaking_tension": 4500.0}, {"parting.time": 1.0, "parting.place": 40.0},
        {"body.mass": 0.0, "body.volume": 0.0, "body.drag_area": 0.0, "body.added_mass": 0.0},
        {**MOORED, "lower_end.x": 0.0, "lower_end.z": 0.0}, {**MOORED, "seabed.slope": 0.05},
        {"cable.bending_stiffness": 500.0, "top.clamped": True, "top.clamp_declination": 0.2},
        {**MOORED, "cable.bending_stiffness": 500.0},
        {**MOORED, "cable.bending_stiffness": 500.0, "lower_end.clamped": True, "lower_end.clamp_declination": 1.0},
    ),
    "tow": (
        {}, SEA, {"tow.poisson_ratio": 0.3, "tow.reference_tension": 1e3}, {"tow.body_angle": 0.5, "tow.drag_area_axial": 0.7},
        {**SEA, "solver.space": True}, {"tow.poisson_ratio": 0.3, "tow.explicit": True}, {"body.mass": 60.0, "body.volume": 0.06},
        {"tow.minimum_tension": 4100.0},
    ),
}  # fmt: skip


def others(row: Variable, value: Any) -> list[Any]:
    """Values that differ from one."""
    if row.kind == "Boolean":
        return [not value]
    if row.kind == "Integer":
        return [k for k in (0, 1, 2, 3, 25) if k != value and (row.minimum or 0) <= k <= (row.maximum or math.inf)]
    if row.unit == "rad":
        return [value + math.pi, value + 0.5]
    most = math.inf if row.maximum is None else row.maximum
    return [
        other for other in (min(row.gap[1] if row.gap else 1.3 * value or 0.4, most), 0.7 * value, min(value + 1e3, most)) if other != value
    ]


def outputs(fmu: Fmu, values: dict[str, Any]) -> np.ndarray:
    """Outputs of a few steps with the winch turning, a current by inputs, and an end let go, where they are asked for.

    Raises FMICallException where the FMU refuses the values.
    """
    instance = fmu.instance()
    given = [0.05 if values.get("winch.fitted") else 0.0, *[0.0] * 9]
    given += [0.3 if values.get("water.current_input") else 0.0, 0.0, float(values.get("parting.by_input", False))]
    try:
        instance.initialize(values, [*sway(0.0), *given])
        rows = [instance.step(k * STEP, STEP, [*sway(k * STEP), *given]) for k in range(STEPS)]
        instance.slave.terminate()
    finally:
        instance.slave.freeInstance()
    return np.array(rows)


class Seen:
    """Remembers what each setting gives as it is."""

    def __init__(self, fmu: Fmu, model: str) -> None:
        self.fmu, self.model = fmu, model
        self._plain: dict[int, np.ndarray] = {}

    def plain(self, k: int) -> np.ndarray:
        if k not in self._plain:
            self._plain[k] = outputs(self.fmu, SETTINGS[self.model][k])
        return self._plain[k]

    def runs(self, k: int) -> bool:
        """Whether the FMU has the setting: the native one has no box grid."""
        try:
            self.plain(k)
        except FMICallException:
            return False
        return True

    def verdict(self, row: Variable) -> str:
        """Whether a parameter "changes" an output, is always "refused", or is "ignored"."""
        accepted = False
        for k, setting in enumerate(SETTINGS[self.model]):
            if not self.runs(k):
                continue
            for value in others(row, setting.get(row.name, row.start)):
                try:
                    found = outputs(self.fmu, {**setting, row.name: value})
                except FMICallException:
                    continue
                accepted = True
                if not np.array_equal(found, self.plain(k)):
                    return "changes"
        return "ignored" if accepted else "refused"


@pytest.fixture(scope="module")
def seen(fmus: dict[str, Fmu]) -> dict[str, Seen]:
    return {model: Seen(fmu, model) for model, fmu in fmus.items()}


@pytest.fixture(scope="module")
def seen_natively(native: dict[str, Fmu]) -> dict[str, Seen]:
    return {model: Seen(fmu, model) for model, fmu in native.items()}


def expected(row: Variable, model: str) -> str:
    return "changes" if model in used_by(row.scene_name) else "refused"


@pytest.mark.parametrize("row", PARAMETERS, ids=lambda row: row.name)
@pytest.mark.parametrize("model", sorted(MODELS))
def test_a_parameter_changes_an_output_or_is_refused(seen: dict[str, Seen], model: str, row: Variable):
    assert seen[model].verdict(row) == expected(row, model)


class TestNatively:
    pytestmark = only_where_they_run

    @pytest.mark.parametrize("row", PARAMETERS, ids=lambda row: row.name)
    @pytest.mark.parametrize("model", sorted(MODELS))
    def test_a_parameter_changes_an_output_or_is_refused(self, seen_natively: dict[str, Seen], model: str, row: Variable):
        not_compiled_in = model == "chain" and row.name in ("solver.grid", "cable.inextensible", "solver.audit")  # by baking only
        assert seen_natively[model].verdict(row) == ("refused" if not_compiled_in else expected(row, model))
