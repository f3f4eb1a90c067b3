"""CableChain: the full finite-difference chain as a model."""

from cable_model.errors import refuse
from cable_model.kernels import chain, header
from cable_model.model import Model


class CableChain(Model):
    """The finite-difference chain [Gobat 2002]: staggered graded grid by default, the paper's box grid on request."""

    name = "chain"
    kernels = chain

    def _start(self, time: float) -> int:
        """An anchored lower end that is let go at the start: statics with the anchor, then rates without it."""
        self._check_above_seabed()
        if not self.scene.lower_end.released:
            return super()._start(time)
        status = chain.settle(self.parts._replace(anchor=True), self.numbers, time, self.state, self._work)
        return status if status != header.OK else chain.set_off(self.parts, self.numbers, time, self.state, self._work)

    def _check_above_seabed(self) -> None:
        level, depth = self.scene.seabed.level, 10.0 * self.scene.cable.diameter  # a lying end sinks in a little
        if self.parts.seabed is None:
            return
        z = float(self.state[header.TOP + 2])
        if z < level - depth:
            raise refuse("top.z", z, "m", f">= seabed.level = {level:g}", "Lower the seabed or lift the top.")
        if self.scene.lower_end.anchored and self.scene.lower_end.z < level - depth:
            raise refuse("lower_end.z", self.scene.lower_end.z, "m", f">= seabed.level = {level:g}", "Lower the seabed or lift the anchor.")
