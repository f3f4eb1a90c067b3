"""What the audit of a run found, read from a model's state: what is missing in the balances, and what to hold it against."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from cable_model.kernels import header


class Audit(NamedTuple):
    """Both balances so far, see kernels.audit: what is missing, and beside it the scale of what was balanced."""

    energy: float  # J, the output audit.energy
    exchanged: float  # J: the most that any energy or work has been
    momentum: float  # N, the output audit.momentum
    forces: float  # N: sum of the sizes of the outer forces, root mean square

    @property
    def energy_share(self) -> float:
        return abs(self.energy) / self.exchanged

    @property
    def momentum_share(self) -> float:
        return self.momentum / self.forces if self.forces > 0.0 else 0.0


def audit_of(state: np.ndarray) -> Audit:
    """Of a model that is audited."""
    energy, momentum, exchanged, forces = state[header.AUDIT : header.AUDIT + 4].tolist()
    return Audit(energy, exchanged, momentum, forces)
