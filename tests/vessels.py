"""A vessel (mass, spring, damper, wave force) on a cable: its own motion, and both together solved at once, apart from the package.

Heave only: the cable is then an elastic bar with a body at its end, which scipy integrates together with the vessel's mass.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy.integrate import solve_ivp
from scipy.sparse import lil_matrix

from cable_model.model import Model
from cable_model.scene import Scene, with_values
from fmu_src.interface import generic_scene

DAMPER = 200.0  # N s/m
NO_BODY = {"body.mass": 0.0, "body.volume": 0.0, "body.drag_area": 0.0, "body.added_mass": 0.0}
HEAVY = {"cable.mass_per_length": 20.0, "cable.axial_stiffness": 1e8, "cable.diameter": 0.05, **NO_BODY}


@dataclass(frozen=True)
class Vessel:
    """Mass kg, spring N/m, amplitude of the wave's force N, and the values of the cable that it hangs on."""

    mass: float
    spring: float
    wave: float
    cable: tuple[tuple[str, float], ...] = ()

    def driven(self, time: float) -> float:
        """The wave's force, of 8 s, faded in."""
        return 0.5 * self.wave * (1.0 - math.cos(math.pi * min(time, 8.0) / 8.0)) * math.sin(0.25 * math.pi * time)

    def acceleration(self, time: float, z: float, v: float, force: float) -> float:
        return (force + self.driven(time) - self.spring * z - DAMPER * v) / self.mass

    def moved(self, time: float, step: float, z: float, v: float, force: float) -> tuple[float, float]:
        """Place and velocity after a step under a held force, by Runge-Kutta in pieces of 5 ms."""
        n = max(1, math.ceil(step / 0.005))
        d = step / n
        for k in range(n):
            t = time + k * d
            a1 = self.acceleration(t, z, v, force)
            a2 = self.acceleration(t + d / 2, z + d / 2 * v, v + d / 2 * a1, force)
            a3 = self.acceleration(t + d / 2, z + d / 2 * v + d * d / 4 * a1, v + d / 2 * a2, force)
            a4 = self.acceleration(t + d, z + d * v + d * d / 2 * a2, v + d * a3, force)
            z, v = z + d * v + d * d / 6 * (a1 + a2 + a3), v + d / 6 * (a1 + 2 * a2 + 2 * a3 + a4)
        return z, v


VESSELS = {
    "200 t": Vessel(200e3, 1e6, 1e6),
    "20 t": Vessel(20e3, 1e5, 1e5),
    "5 t": Vessel(5e3, 5e4, 5e4),
    "2 t": Vessel(2e3, 1e4, 3e3),
    "0.5 t": Vessel(500.0, 1e4, 3e3),
    "heavy 20 t": Vessel(20e3, 1e4, 3e3, tuple(HEAVY.items())),
    "heavy 2 t": Vessel(2e3, 1e4, 3e3, tuple(HEAVY.items())),
}


def scene(vessel: Vessel, order: int = 1) -> Scene:
    """The generic 100 m wire with a body, or the heavy one without, in water that is everywhere."""
    return with_values(generic_scene(), {"water.surface": False, "top.motion_order": order, **dict(vessel.cable)})


def together(vessel: Vessel, times: np.ndarray, cells: int = 40) -> np.ndarray:
    """The vessel's heave and the cable's force on it less that at rest (times, 2): one system of a bar of equal cells and the vessel.

    Mass is lumped; springs are linear, as the cable stays taut; drag is the body's and the skin's.
    """
    made = scene(vessel)
    cable, body, water = made.cable, made.body, made.water
    assert water is not None
    h = cable.length / cells
    mass = np.full(cells + 1, cable.mass_per_length * h)
    drag = np.full(cells + 1, 0.5 * water.density * cable.diameter * cable.tangential_drag_coefficient * h)
    mass[[0, -1]] *= 0.5
    drag[[0, -1]] *= 0.5
    half = mass[-1]
    mass[0] += body.mass + body.added_mass
    drag[0] += 0.5 * water.density * body.drag_area
    mass[-1] += vessel.mass
    spring = cable.axial_stiffness / h

    def pulls(z: np.ndarray, v: np.ndarray) -> np.ndarray:
        tension = spring * np.diff(z)
        force = -drag * np.abs(v) * v
        force[:-1] += tension
        force[1:] -= tension
        return force

    def rates(time: float, y: np.ndarray) -> np.ndarray:
        z, v = np.split(y, 2)
        force = pulls(z, v)
        force[-1] += vessel.driven(time) - vessel.spring * z[-1] - DAMPER * v[-1]
        return np.concatenate([v, force / mass])

    n = cells + 1
    pattern = lil_matrix((2 * n, 2 * n))
    for i in range(n):
        pattern[i, n + i] = pattern[n + i, n + i] = 1
        pattern[n + i, max(i - 1, 0) : i + 2] = 1
    solved = solve_ivp(
        rates, (0.0, times[-1]), np.zeros(2 * n), method="Radau", t_eval=times, rtol=1e-6, atol=1e-9, jac_sparsity=pattern.tocsc()
    )
    found = []
    for time, y in zip(solved.t, solved.y.T, strict=True):
        z, v = np.split(y, 2)
        found.append((z[-1], pulls(z, v)[-1] - half * rates(time, y)[-1]))
    return np.array(found)


def exchanged(
    step: Callable[[float, np.ndarray], tuple[float, float]], vessel: Vessel, size: float, until: float, held: tuple[float, float]
) -> np.ndarray:
    """Heave and force less that at rest (steps + 1, 2) where both step at once: the vessel under the force it was told last, held.

    `step(time, inputs)` steps the cable by `size` and gives the force that it then tells, to be held, and its force then.  `held`: these at
    the start.
    """
    told, rest = held
    z = v = 0.0
    rows = [(z, 0.0)]
    force = rest
    for k in range(round(until / size)):
        inputs = np.zeros(10)
        inputs[2], inputs[5], inputs[8] = z, v, vessel.acceleration(k * size, z, v, force - rest)
        new, force = step(k * size, inputs)
        z, v = vessel.moved(k * size, size, z, v, told - rest)
        told = new
        rows.append((z, force - rest))
        if not abs(z) < 50.0:
            break
    return np.array(rows)


def on(model: Model, vessel: Vessel, size: float, until: float, told: int, each: Callable[[Any], None] | None = None) -> np.ndarray:
    """`exchanged` with a model of the library that tells the output `told`; `each` sees it after every step."""
    model.initialize(np.zeros(10))

    def step(time: float, inputs: np.ndarray) -> tuple[float, float]:
        model.step(time, size, inputs)
        if each is not None:
            each(model)
        return float(model.outputs[told]), float(model.outputs[2])

    return exchanged(step, vessel, size, until, (float(model.outputs[told]), float(model.outputs[2])))
