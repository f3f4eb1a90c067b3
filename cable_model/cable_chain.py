"""CableChain: the full finite-difference chain as a model."""

from cable_model.kernels import chain
from cable_model.model import Model


class CableChain(Model):
    """The finite-difference chain [Gobat 2002]: staggered graded grid by default, the paper's box grid on request."""

    name = "chain"
    kernels = chain
