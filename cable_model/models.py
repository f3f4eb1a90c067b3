"""The two models by the name that scenes use."""

from cable_model.cable_chain import CableChain
from cable_model.model import Model
from cable_model.tow_cable import TowCable

MODELS: dict[str, type[Model]] = {"chain": CableChain, "tow": TowCable}
