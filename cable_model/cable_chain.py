"""CableChain: the full finite-difference chain as a model."""

from types import ModuleType

import numpy as np

from cable_model.calls import Calls
from cable_model.errors import refuse
from cable_model.model import Model


class CableChain(Model):
    """The finite-difference chain [Gobat 2002]: staggered graded grid by default, the paper's box grid on request."""

    name = "chain"

    @staticmethod
    def kernels() -> ModuleType:
        from cable_model.kernels import chain

        return chain

    def _just_in_time(self) -> Calls:
        """An anchored lower end that is let go at the start: statics with the anchor, then rates without it."""
        from cable_model.just_in_time import JustInTime

        held = self.parts._replace(anchor=True) if self.scene.lower_end.released else None
        return JustInTime(self.kernels(), self.motion_order, self.parts, self.numbers, held)

    def _check_start(self, inputs: np.ndarray) -> None:
        """No end begins below the seabed."""
        level, depth = self.scene.seabed.level, 10.0 * self.scene.cable.diameter  # a lying end sinks in a little
        if self.parts.seabed is None:
            return
        z = float(inputs[2])
        if z < level - depth:
            raise refuse("top.z", z, "m", f">= seabed.level = {level:g}", "Lower the seabed or lift the top.")
        if self.scene.lower_end.anchored and self.scene.lower_end.z < level - depth:
            raise refuse("lower_end.z", self.scene.lower_end.z, "m", f">= seabed.level = {level:g}", "Lower the seabed or lift the anchor.")
