"""CableChain: the full finite-difference chain as a model."""

from types import ModuleType

import numpy as np

from cable_model.calls import Calls
from cable_model.kernels import header
from cable_model.model import Model
from cable_model.rules import check_start


class CableChain(Model):
    """The finite-difference chain [Gobat 2002]: staggered graded grid by default, the paper's box grid on request."""

    name = "chain"

    @staticmethod
    def kernels() -> ModuleType:
        from cable_model.kernels import chain

        return chain

    def arc_lengths(self) -> np.ndarray:
        columns = 2 if self.parts.sections is None else 3
        left = self._node_count() if self.parts.parting is None else int(self.state[header.NODES]) or self._node_count()
        cells = self.state[header.HEADER :][: columns * (left - 1) : columns]  # the mesh comes first, see kernels.layout
        gone = np.zeros(self._node_count() - left + 1)
        return np.concatenate((gone, np.cumsum(cells)))

    def _just_in_time(self) -> Calls:
        """An anchored lower end that is let go at the start: statics with the anchor, then rates without it."""
        from cable_model.just_in_time import JustInTime

        held = self.parts._replace(anchor=True) if self.scene.lower_end.released else None
        return JustInTime(self.kernels(), self.motion_order, self.parts, self.numbers, held)

    def _check_start(self, inputs: np.ndarray) -> None:
        check_start(self.scene, inputs.tolist(), self.name)
