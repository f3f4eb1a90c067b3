"""What further accuracy costs: measured where a search met it, else by the second order of the methods in nodes and step."""

from __future__ import annotations

import math
from dataclasses import dataclass

from cable_model.scene import Scene
from cable_model.studies.advice import Advice, cheapest
from cable_model.studies.cost import expected
from cable_model.studies.timed import Setting, worst

TRUSTED = 0.3  # share of an error that the reference's own may be for the error to count as measured


@dataclass(frozen=True)
class Price:
    """Times the time for times the accuracy, with the setting that has it; `measured`, or expected by second order."""

    factor: float
    dearer: float
    setting: Setting
    measured: bool

    @property
    def words(self) -> str:
        how = "measured" if self.measured else "expected"
        return f"{how}: {self.factor:.2g} times the accuracy for {self.dearer:.2g} times the time ({self.setting.label})"


def finer(scene: Scene, setting: Setting, factor: float) -> Setting:
    """A chain's fixed step with its error of second order cut by `factor`: sqrt(factor) more cells and steps."""
    c, root = setting.changes, math.sqrt(factor)
    cells = math.ceil((int(str(c["solver.nodes"])) - 1) * root)
    step = float(str(c["solver.time_step"])) / root
    if c["solver.tolerance"]:
        return Setting(
            setting.method, setting.model, {**c, "solver.nodes": cells + 1, "solver.tolerance": float(str(c["solver.tolerance"])) / factor}
        )
    return Setting(setting.method, setting.model, {**c, "solver.nodes": cells + 1, "solver.time_step": step})


def price(advice: Advice, scene: Scene, factor: float) -> Price | None:
    """What `factor` times the accuracy of the choice costs; None where it takes another model: TowCable has its error for good.

    `scene` is the one asked about, with all of its effects.
    """
    choice = advice.choice
    if choice is None:
        return None
    wanted = worst(choice.errors, advice.signals) / factor
    if worst(advice.reference.own_error, advice.signals) <= TRUSTED * wanted:
        good = cheapest([p for p in advice.points if worst(p.errors, advice.signals) <= wanted], math.inf, advice.signals)
        if good is not None:
            gain = worst(choice.errors, advice.signals) / worst(good.errors, advice.signals)
            return Price(gain, good.cost / choice.cost, good.setting, True)
    if choice.setting.model == "tow":
        return None
    setting = finer(scene, choice.setting, factor)
    return Price(factor, expected(scene, setting) / expected(scene, choice.setting), setting, False)
