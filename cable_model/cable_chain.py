"""CableChain: the full finite-difference chain as a model."""

from cable_model.kernels import chain, header
from cable_model.model import Model


class CableChain(Model):
    """The finite-difference chain [Gobat 2002]: staggered graded grid by default, the paper's box grid on request."""

    name = "chain"
    kernels = chain

    def _start(self, time: float) -> int:
        """An anchored lower end that is let go at the start: statics with the anchor, then rates without it."""
        if not self.scene.lower_end.released:
            return super()._start(time)
        status = chain.settle(self.parts._replace(anchor=True), self.numbers, time, self.state, self._work)
        return status if status != header.OK else chain.set_off(self.parts, self.numbers, time, self.state, self._work)
