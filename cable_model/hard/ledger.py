"""The energy of a chain and the work done on it, written from the equations apart from the kernels; it may not change a model.

Stored: kinetic energy of cable and body (their own mass), potential energy (their own weight), strain energy of the axial law and
bending energy.  Work: of the top's force on the prescribed motion, and of the water (buoyancy, drag, added mass, Froude-Krylov).
What a seabed and the damping take is not counted: a ledger may only lose.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from cable_model.cable_chain import CableChain
from cable_model.kernels import header, layout
from cable_model.kernels.build import build
from cable_model.kernels.fluid import water_motion
from cable_model.kernels.surface import Share, cell_share, centre, level_over, share

SHARE = 1.0 / 12.0  # of a cell's inertia that couples its two nodes


class Ledger:
    """Reads a staggered chain after every step: `stored()` in J, `power(velocity)` of top and water in W."""

    def __init__(self, model: CableChain) -> None:
        self.model = model
        scene = model.scene
        self.gravity = scene.environment.gravity
        self.density = scene.water.density if scene.water is not None else 0.0
        cable = scene.cable
        self.displaced_area, self.added = cable.displaced_area, cable.added_mass(self.density)
        self.now = layout.cut(model.parts, model.numbers, model.state, model._work)
        self.numeric = build(model.parts, model.numbers, 0.0).numeric

    @property
    def weight(self) -> float:
        """Force scale W, N: weights in the medium of cable and body."""
        scene = self.model.scene
        cable = (scene.cable.mass_per_length - self.density * self.displaced_area) * self.gravity * scene.cable.length
        return abs(cable) + abs((scene.body.mass - self.density * scene.body.volume) * self.gravity)

    def _shape(self) -> tuple[np.ndarray, ...]:
        h, split = self.now.mesh[:, 0], self.now.mesh[:, 1]
        n = len(h) + 1
        d = self.now.y.shape[1]
        at = self.model.positions()
        return h, split, self.now.y[: n - 1], self.now.y[n:], at if d == 3 else at[:, [0, 2]]

    def stored(self) -> float:
        """Kinetic, potential, strain and bending energy, J."""
        h, split, q, v, at = self._shape()
        scene = self.model.scene
        m = scene.cable.mass_per_length
        low, up = v[:-1], v[1:]
        speeds = (split - SHARE) * np.sum(low * low, 1) + 2.0 * SHARE * np.sum(low * up, 1) + (1.0 - split - SHARE) * np.sum(up * up, 1)
        kinetic = 0.5 * m * np.sum(h * speeds) + 0.5 * scene.body.mass * np.sum(v[0] ** 2)
        z = at[:, -1]
        potential = m * self.gravity * np.sum(h * (split * z[:-1] + (1.0 - split) * z[1:])) + scene.body.mass * self.gravity * z[0]
        return float(kinetic + potential + self._strain(h, np.linalg.norm(q, axis=1)) + self._bending(h, split, q))

    def _strain(self, h: np.ndarray, stretch: np.ndarray) -> float:
        cable = self.model.scene.cable
        f = cable.axial_stiffness * (stretch - 1.0)
        if cable.compressible:
            return float(np.sum(h * f * f) / (2.0 * cable.axial_stiffness))
        held = 0.0 if self.model.parts.bending is None else 2.0 * cable.bending_stiffness / (h * h)  # T_c of slack.py
        lost = h * held * (stretch - 1.0) + h * held * held / (2.0 * cable.axial_stiffness)  # what it takes from the law of f + T_c
        f = f + held
        w0 = np.maximum(np.minimum(self.numeric.smoothing, self.numeric.hung + self.numeric.own * h), 1e-300)  # of slack.py
        law = h * (f * f + f * np.hypot(f, w0) + w0 * w0 * np.arcsinh(f / w0)) / (4.0 * cable.axial_stiffness)
        return float(np.sum(law - lost))

    def _bending(self, h: np.ndarray, split: np.ndarray, q: np.ndarray) -> float:
        between = (1.0 - split[:-1]) * h[:-1] + split[1:] * h[1:]
        return float(np.sum(self.model.scene.cable.bending_stiffness * np.sum(np.diff(q, axis=0) ** 2, axis=1) / (2.0 * between)))

    def power(self, top_velocity: np.ndarray) -> float:
        """Power of the attachment and of the water on cable and body, W; `top_velocity` (3,) is the prescribed one."""
        force = -self.model.outputs[:3]  # on the cable
        return float(force @ top_velocity) + (self._water_power() if self.density > 0.0 else 0.0)

    def _water_power(self) -> float:
        h, split, q, v, at = self._shape()
        scene, parts = self.model.scene, self.model.parts
        n = len(h) + 1
        time, offset = self.model.state[header.TIME], self.model.state[header.OFFSET]
        a = self.now.yd[n:] - offset * self.now.ydd[n:]
        stretch = np.linalg.norm(q, axis=1, keepdims=True)
        t = q / stretch
        middle = 0.5 * (at[:-1] + at[1:])
        cells, rises = self._shares(at, v[:, -1], split, time)
        wet = cells.wet[:, None]
        middle[:, -1] -= 0.5 * (1.0 - cells.wet) * np.abs(np.diff(at[:, -1]))
        flow, flow_rate = self._flow(parts, middle, time)

        def across(x: np.ndarray) -> np.ndarray:
            return x - np.sum(x * t, axis=1, keepdims=True) * t

        u = 0.5 * (v[:-1] + v[1:]) - flow
        un, ut = across(u), u - across(u)
        half = 0.5 * self.density * scene.cable.diameter * np.sqrt(stretch)
        pull = -half * scene.cable.normal_drag_coefficient * np.linalg.norm(un, axis=1, keepdims=True) * un
        pull -= half * scene.cable.tangential_drag_coefficient * np.linalg.norm(ut, axis=1, keepdims=True) * ut
        pull += self.added * across(flow_rate) + self.density * self.displaced_area * flow_rate
        b = split[:, None]
        low = wet * (b * pull - self.added * across((b - SHARE) * a[:-1] + SHARE * a[1:]))
        up = wet * ((1.0 - b) * pull - self.added * across((1.0 - b - SHARE) * a[1:] + SHARE * a[:-1]))
        # added mass that depends on the place: m_a (lambda' z_t N w - 1/2 lambda' w.N w e_z), shared as the inertia is
        ul, uu = v[:-1] - flow, v[1:] - flow
        nl, nu = across((b - SHARE) * ul + SHARE * uu), across((1.0 - b - SHARE) * uu + SHARE * ul)
        square = np.sum(ul * nl + uu * nu, axis=1)
        low -= self.added * rises[:, None] * nl
        up -= self.added * rises[:, None] * nu
        lift = self.density * self.displaced_area * self.gravity
        low[:, -1] += lift * cells.e1 + 0.5 * self.added * cells.w1 * square
        up[:, -1] += lift * cells.e2 + 0.5 * self.added * cells.w2 * square
        return float(np.sum(h[:, None] * (low * v[:-1] + up * v[1:]))) + self._body_power(v[0], a[0], at[:1], time)

    def _level(self, at: np.ndarray, time: float) -> tuple[float, float]:
        """Height of the water's surface over a place, and its rate; without a surface far above it."""
        if self.model.parts.surface is None:
            return np.inf, 0.0
        height, rate = level_over(self.model.parts, tuple(at), time, -np.inf)
        return float(height), float(rate)

    def _shares(self, at: np.ndarray, rise: np.ndarray, split: np.ndarray, time: float) -> tuple[Any, np.ndarray]:
        """Wet shares of the cells, a Share of arrays, and the rates of the shares; `rise` are the nodes' vertical velocities."""
        rows, rates = [], []
        for i, b in enumerate(split):
            level, rate = self._level(0.5 * (at[i] + at[i + 1]), time)
            r = 0.5 * self.model.scene.cable.diameter
            ends = at[i : i + 2, -1] - level
            deep = bool(np.all(ends <= -r))
            row = Share(1.0, 0.0, 0.0, 0.0, 0.0, 0.0, b, 1.0 - b, 0.0, 0.0, 0.0) if deep else cell_share(ends[0], ends[1], r, b)
            rows.append(row)
            rates.append(row.w1 * (rise[i] - rate) + row.w2 * (rise[i + 1] - rate))
        return Share(*np.array(rows).T), np.array(rates)

    def _body_power(self, v: np.ndarray, a: np.ndarray, at: np.ndarray, time: float) -> float:
        body = self.model.scene.body
        if body.mass == 0.0:
            return 0.0
        level, rate = self._level(at[0], time)
        radius = max((0.75 / np.pi * body.volume) ** (1.0 / 3.0), 0.5 * self.model.scene.cable.diameter)
        wet, slope, _ = share(at[0, -1] - level, radius)
        at = at.copy()
        at[0, -1] -= centre(at[0, -1] - level, radius)[0]
        flow, flow_rate = self._flow(self.model.parts, at, time)
        u = v - flow[0]
        force = -0.5 * self.density * body.drag_area * np.linalg.norm(u) * u - body.added_mass * a
        force += (self.density * body.volume + body.added_mass) * flow_rate[0]
        force = wet * force - body.added_mass * slope * (v[-1] - rate) * u
        force[-1] += wet * self.density * body.volume * self.gravity + 0.5 * body.added_mass * slope * (u @ u)
        return float(force @ v)

    @staticmethod
    def _flow(parts: Any, places: np.ndarray, time: float) -> tuple[np.ndarray, np.ndarray]:
        """Velocity and acceleration of the water at places (k, D)."""
        if parts.current is None and parts.waves is None:
            return np.zeros_like(places), np.zeros_like(places)
        found = [water_motion(parts, tuple(place), time)[:2] for place in places]
        return np.array([f[0] for f in found]), np.array([f[1] for f in found])
