"""What further accuracy costs: measured where a search met it, else by the order that the reference's refinements show."""

from __future__ import annotations

import math
from dataclasses import dataclass

from cable_model.scene import Scene
from cable_model.studies.advice import Advice, cheapest
from cable_model.studies.cost import work
from cable_model.studies.timed import Setting, worst

TRUSTED = 0.3  # share of an error that the reference's own may be for the error to count as measured


@dataclass(frozen=True)
class Price:
    """Times the time for times the accuracy, with the setting that has it; `measured`, or expected by the order of the refinements."""

    factor: float
    dearer: float
    setting: Setting
    measured: bool

    @property
    def words(self) -> str:
        how, way = "measured" if self.measured else "expected", f"{self.setting.method}: {self.setting.label}"
        return f"{how}: {self.factor:.2g} times the accuracy for {self.dearer:.2g} times the time ({way})"


def finer(setting: Setting, factor: float, order: float = 2.0) -> Setting:
    """A chain's fixed step with its error of an order cut by `factor`: at second order sqrt(factor) more cells and steps."""
    c, root = setting.changes, factor ** (1.0 / order)
    cells = math.ceil((int(str(c["solver.nodes"])) - 1) * root)
    return Setting(
        setting.method, setting.model, {**c, "solver.nodes": cells + 1, "solver.time_step": float(str(c["solver.time_step"])) / root}
    )


def price(advice: Advice, scene: Scene, factor: float) -> Price | None:
    """What `factor` times the accuracy of the choice costs; None where there is no choice, or no fixed step of the chain to go by.

    `scene` is the one asked about, with all of its effects.  TowCable has its error for good and error control need not be near its
    tolerance: from both it is the chain's best fixed step that is refined.
    """
    choice, signals = advice.choice, advice.signals
    if choice is None:
        return None
    wanted = worst(choice.errors, signals) / factor
    if worst(advice.reference.own_error, signals) <= TRUSTED * wanted:
        good = cheapest([p for p in advice.points if worst(p.errors, signals) <= wanted], math.inf, signals)
        if good is not None:
            return Price(worst(choice.errors, signals) / worst(good.errors, signals), good.cost / choice.cost, good.setting, True)
    fixed = [p for p in advice.points if p.setting.model == "chain" and not p.setting.changes["solver.tolerance"]]
    base = choice if choice in fixed else cheapest(fixed, advice.accuracy, signals)
    if base is None:
        return None
    setting = finer(base.setting, max(1.0, worst(base.errors, signals) / wanted), advice.reference.order(signals))
    finest = advice.reference.levels[-1]  # so fine that calls cost next to nothing: it tells what this scene's effects cost a node
    each = finest.run.seconds / work(scene, finest.setting) / scene.run.duration
    more = each * (work(scene, setting) - work(scene, base.setting))
    return Price(factor, (base.cost + more) / choice.cost, setting, False)
