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

    def _just_in_time(self) -> Calls:
        """An anchored lower end that is let go at the start: statics with the anchor, then rates without it."""
        from cable_model.just_in_time import JustInTime

        held = self.parts._replace(anchor=True) if self.scene.lower_end.released else None
        return JustInTime(self.kernels(), self.motion_order, self.parts, self.numbers, held)

    def _check_start(self, inputs: np.ndarray) -> None:
        check_start(self.scene, inputs.tolist(), self.name)

    def tensions(self) -> np.ndarray | None:
        """Axial forces (n - 1,) of the cells now, from the lower end to the top, N; None on the box grid, whose strains are of nodes.

        Their largest and smallest are the outputs cable.tension_max, where the top has no larger one, and cable.tension_min.
        """
        if self.parts.box is not None:
            return None
        state, cells = self.state, self.scene.solver.nodes - 1
        start = header.HEADER + 2 * cells + 6 * (cells + 1) * (2 if self.parts.space is None else 3)  # see kernels.layout
        found, before = state[start : start + 2 * cells].reshape(2, cells)  # at the averaged times of the last two internal steps
        between = state[header.STEP] - state[header.LAG] + state[header.LAG_BEFORE]
        now = found.copy()
        if state[header.STEP] > 0.0:
            now += (state[header.LAG] + state[header.PENDING]) / between * (found - before)
        if self.parts.slack is not None:
            now[found > 0.0] = np.maximum(now[found > 0.0], 0.0)  # what loses its tension within a step is not led on to push
        return now if self.parts.bending is None else now + self._bent()

    def _bent(self) -> np.ndarray:
        """What bending adds to the axial forces (n - 1,), N: EI kappa^2 in the limit of small cells, as kernels.staggered.bent has it.

        Formed anew from positions: the compiled kernels tell places and outputs only.
        """
        cells = self.scene.solver.nodes - 1
        lengths, shares = self.state[header.HEADER : header.HEADER + 2 * cells].reshape(cells, 2).T
        vectors = np.diff(self.positions(), axis=0) / lengths[:, None]
        between = (1.0 - shares[:-1]) * lengths[:-1] + shares[1:] * lengths[1:]
        moments = self.scene.cable.bending_stiffness * np.diff(vectors, axis=0) / between[:, None]
        gradient = np.diff(np.pad(moments, ((1, 1), (0, 0))), axis=0)
        return -np.sum(gradient * vectors, axis=1) / (np.linalg.norm(vectors, axis=1) * lengths)
