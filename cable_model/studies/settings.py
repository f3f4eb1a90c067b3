"""Which settings of a scene are worth trying: ladders of nodes, steps and tolerances about the scene's own, and effects to leave out."""

from __future__ import annotations

import itertools
from collections.abc import Iterator, Mapping

from cable_model.effects import CHAIN, EFFECTS
from cable_model.errors import ParameterError
from cable_model.scene import Scene, with_values
from cable_model.sections import fewest_cells
from cable_model.simulated import is_on, left_out_for, parts_of
from cable_model.studies.timed import Setting

FEWEST_CELLS = 4
TOLERANCES = (1e-1, 3e-2, 1e-2, 3e-3, 1e-3, 3e-4, 1e-4)
TOW = "TowCable"
METHODS: Mapping[str, Mapping[str, object]] = {
    "chain, lambda -0.9": {},
    "chain, lambda -0.5": {"solver.lambda_infinity": -0.5},
    "chain, lambda 0": {"solver.lambda_infinity": 0.0},
    "chain, uniform mesh": {"solver.grading": 1.0},
    "box grid, lambda -0.9": {"solver.grid": "box"},
    "box grid, box method": {"solver.grid": "box", "solver.lambda_infinity": -1.0},
}
CONTROLLED = "chain, error control"
BASE = {"solver.grid": "staggered", "solver.lambda_infinity": -0.9, "solver.grading": 0.0, "solver.integrator": "generalized-alpha",
        "cable.inextensible": False}  # fmt: skip


def cells_ladder(scene: Scene, quick: bool = False) -> list[int]:
    """From an eighth of the scene's cells to twice as many."""
    fewest = max(FEWEST_CELLS, fewest_cells(scene.cable))
    cells = max(scene.solver.nodes - 1, fewest)
    factors = (0.25, 0.5, 1.0) if quick else (0.125, 0.25, 0.5, 1.0, 2.0)
    return sorted({max(fewest, round(cells * factor)) for factor in factors})


def steps_ladder(scene: Scene, quick: bool = False) -> list[float]:
    """From the output step, which no internal step exceeds, by halves to a quarter of the scene's step."""
    steps = [scene.run.output_step]
    while steps[-1] >= scene.solver.time_step * (0.5 - 1e-9):
        steps.append(0.5 * steps[-1])
    return steps[::2] if quick else steps


def allowed(scene: Scene, setting: Setting) -> bool:
    """Whether the scene can be run so at all: the box grid has no seabed, TowCable no winch."""
    try:
        parts_of(with_values(scene, setting.changes), setting.model)
    except ParameterError:
        return False
    return True


def straight(scene: Scene) -> Mapping[str, object]:
    """The values without what a straight cable lacks and a scene can do without."""
    return {"solver.grid": "staggered", "cable.inextensible": False, **left_out_for(scene, "tow")[1]}


def of_method(scene: Scene, method: str, quick: bool = False) -> Iterator[Setting]:
    """All settings of a method; cheap ones first."""
    if method == TOW:
        for tolerance in (1e-2, 1e-4, 1e-6):
            yield Setting(TOW, "tow", {**straight(scene), "solver.tolerance": tolerance})
        return
    if method == CONTROLLED:
        longest = 0.1 * scene.run.duration
        for cells, tolerance in itertools.product(cells_ladder(scene, quick), TOLERANCES[::3] if quick else TOLERANCES):
            changes = {"solver.nodes": cells + 1, "solver.tolerance": tolerance, "solver.time_step": longest}
            yield Setting(method, "chain", {**BASE, **changes})
        return
    for cells, step in itertools.product(cells_ladder(scene, quick), steps_ladder(scene, quick)):
        changes = {"solver.nodes": cells + 1, "solver.time_step": step, "solver.tolerance": 0.0}
        yield Setting(method, "chain", {**BASE, **METHODS[method], **changes})


def methods(scene: Scene) -> list[str]:
    """The methods that the scene allows."""
    names = [TOW, *METHODS, CONTROLLED]
    return [name for name in names if allowed(scene, next(of_method(scene, name)))]


def leave_out(scene: Scene) -> dict[str, Mapping[str, object]]:
    """Changes that leave out each optional effect that the scene has, by what people call it, where it can be left out alone."""
    return {
        effect.called or effect.words: effect.left_out
        for effect in EFFECTS
        if effect.left_out and is_on(effect, scene, CHAIN) and allowed(scene, Setting(effect.name, CHAIN, effect.left_out))
    }
