"""What a node of the box grid holds: [eps, S, u, v, phi, Omega] with bending, [eps, u, v, phi] without; T for eps if inextensible."""

from typing import NamedTuple

from cable_model.kernels.choice import by_presence
from cable_model.kernels.jit import kernel


class Gains(NamedTuple):
    """Derivatives by the new state, and what a row is divided by."""

    k: float  # of the state at the averaged time
    m: float  # of the rates, 1/s
    reach: float  # from a velocity to the place at the averaged time, s
    scale: float  # 1/N, makes the forces of a row comparable to speeds


@kernel
def _four(bending):
    return (0.0, 0.0, 0.0, 0.0)


@kernel
def _six(bending):
    return (0.0, 0.0, 0.0, 0.0, 0.0, 0.0)


unknowns = by_presence(_four, _six)  # of a node, as a tuple of zeros


@kernel
def strain(inextensible, value):
    """Strain from a node's first unknown."""
    if inextensible is None:
        return value
    return 0.0


@kernel
def tension(inextensible, cable, numeric, value, rate):
    """Tension from a node's first unknown and its rate."""
    if inextensible is None:
        return cable.stiffness * value + numeric.voigt * rate
    return value


@kernel
def tension_gain(inextensible, cable, numeric, gains):
    """Derivative of the averaged tension by the new first unknown."""
    if inextensible is None:
        return cable.stiffness * gains.k + numeric.voigt * gains.m
    return gains.k
