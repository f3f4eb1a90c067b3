"""An independent statement of the tow model for tests: energies by quadrature, forces point by point, nothing from the kernels.

Axes x right, y down.  Functions of energy accept complex arguments, so that derivatives by complex steps are exact to rounding.
"""

from dataclasses import dataclass, field

import numba
import numpy as np

from cable_model.effects import Parts
from cable_model.sea import rows_of, table_of
from cable_model.tow_cable import TowCable

SLOW = bool(numba.config.DISABLE_JIT)  # plain Python: shorter runs
GAUSS_AT, GAUSS_WEIGHT = (np.polynomial.legendre.leggauss(4)[0] + 1.0) / 2.0, np.polynomial.legendre.leggauss(4)[1] / 2.0

NUMBERS = {
    "cable.length": 60.0,
    "cable.diameter": 0.02,
    "cable.mass_per_length": 0.9,
    "cable.axial_stiffness": 2.0e5,
    "cable.axial_damping": 4.0e3,
    "cable.normal_drag_coefficient": 1.2,
    "cable.tangential_drag_coefficient": 0.03,
    "cable.added_mass_coefficient": 1.0,
    "body.mass": 150.0,
    "body.volume": 0.05,
    "body.drag_area": 0.3,
    "body.added_mass": 60.0,
    "tow.added_mass_vertical": 140.0,
    "tow.drag_area_axial": 0.05,
    "environment.gravity": 9.81,
    "water.density": 1025.0,
    "tow.poisson_ratio": 0.4,
    "tow.reference_tension": 800.0,
    "tow.drag_segments": 7.0,
    "solver.tolerance": 1e-8,
}
SHEAR = np.array([[-80.0, -0.1, 0.0], [-40.0, 0.4, 0.0], [-5.0, 1.1, 0.0], [0.0, 1.3, 0.0]])
WAVES = table_of(np.array([[0.8, 0.9, 0.9**2 / 9.81, 0.0, 0.4, 0.0], [0.3, 1.7, 1.7**2 / 9.81, np.pi, -1.0, 0.0]]))
WET = Parts(voigt=True, body=True, water=True, current=SHEAR, cable_mass=True)
DRY = Parts(body=True, cable_mass=True)


def turned_sea(waves: np.ndarray, angle: float) -> np.ndarray:
    """A table of waves whose directions are turned by an angle, rad."""
    return table_of(rows_of(waves) + np.array([0.0, 0.0, 0.0, angle, 0.0, 0.0]))


@dataclass
class Reference:
    """The model of [Wang 1971] for given numbers and parts, errors corrected."""

    parts: Parts
    numbers: dict = field(default_factory=lambda: dict(NUMBERS))

    def __post_init__(self):
        p, n = self.parts, self.numbers
        wet = 1.0 if p.water is not None else 0.0
        self.rho = n.get("water.density", 0.0) * wet
        self.lr = n["cable.length"]
        self.k = n["cable.axial_stiffness"] / self.lr
        self.l0 = self.lr - n.get("tow.reference_tension", 0.0) / self.k
        self.p = n.get("tow.poisson_ratio", 0.0)
        # thinning from zero tension such that the given diameter is that of the reference tension
        self.d0 = n.get("cable.diameter", 0.0) / (1.0 - self.p * (self.lr - self.l0) / self.lr)
        g = n["environment.gravity"]
        area = np.pi / 4.0 * n.get("cable.diameter", 0.0) ** 2
        self.mc = n["cable.mass_per_length"] * self.lr
        self.wc = (n["cable.mass_per_length"] - self.rho * area) * self.lr * g
        self.gamma = n.get("cable.added_mass_coefficient", 0.0)
        if p.cable_mass is None:
            self.mc, self.gamma = 0.0, 0.0
        self.mx = n["body.mass"] + wet * n.get("body.added_mass", 0.0)
        self.my = n["body.mass"] + wet * n.get("tow.added_mass_vertical", 0.0)
        self.wb = (n["body.mass"] - self.rho * n.get("body.volume", 0.0)) * g
        self.c = n.get("cable.axial_damping", 0.0) / self.lr if p.voigt is not None else 0.0

    def diameter(self, u):
        return self.d0 * (1.0 - self.p * u / self.lr)

    def kinetic(self, phi, w, u, ud, vx, vy):
        length = self.l0 + u
        n, t = (-np.cos(phi), -np.sin(phi)), (-np.sin(phi), np.cos(phi))
        bx = vx + t[0] * ud + n[0] * length * w
        by = vy + t[1] * ud + n[1] * length * w
        total = 0.5 * (self.mx * bx * bx + self.my * by * by)
        added = self.gamma * self.rho * np.pi / 4.0 * self.diameter(u) ** 2 * length
        for share, weight in zip(GAUSS_AT, GAUSS_WEIGHT, strict=True):
            along = vx * t[0] + vy * t[1] + share * ud
            across = vx * n[0] + vy * n[1] + share * length * w
            total = total + 0.5 * weight * (self.mc * along * along + (self.mc + added) * across * across)
        return total

    def height(self, phi, u, y):
        """Potential energy of the weights."""
        length = self.l0 + u
        return -self.wb * (y + length * np.cos(phi)) - self.wc * (y + 0.5 * length * np.cos(phi))

    def water(self, x, y, time):
        vx = vy = 0.0
        if self.parts.current is not None:
            vx += np.interp(-y, self.parts.current[:, 0], self.parts.current[:, 1])
        if self.parts.waves is not None:
            for a, omega, k, direction, phase, _ in rows_of(self.parts.waves):
                side = np.sign(np.cos(direction))
                angle = k * side * x - omega * time + phase
                size = a * omega * np.exp(-k * max(y, 0.0))
                vx += side * size * np.cos(angle)
                vy -= size * np.sin(angle)
        return np.array([vx, vy])

    def water_acceleration(self, place, time):
        """Of the water in waves at a place (a steady current has none)."""
        return self.water(*place, time + 1e-30j).imag / 1e-30

    def drags(self, top, time, motion):
        """(force, velocity of its point, derivative of its point by phi and by u) of the water on the body and on every segment.

        Drag; and displaced mass times the water's acceleration, as in static buoyancy, added mass times its part across.
        """
        phi, w, u, ud = motion
        length = self.l0 + u
        n, t = np.array([-np.cos(phi), -np.sin(phi)]), np.array([-np.sin(phi), np.cos(phi)])
        xs, vs = np.array([top[0], top[3]]), np.array([top[1], top[4]])
        if self.parts.water is None:
            return []
        q = self.numbers
        velocity = vs + t * ud + n * length * w
        relative = self.water(*(xs + t * length), time) - velocity
        angle = q.get("tow.body_angle", 18.0)
        if abs(angle) > np.pi:
            force = 0.5 * self.rho * q["body.drag_area"] * np.linalg.norm(relative) * relative
        else:
            bn, bt = np.array([-np.cos(angle), -np.sin(angle)]), np.array([-np.sin(angle), np.cos(angle)])
            an, at = relative @ bn, relative @ bt
            force = 0.5 * self.rho * (q["body.drag_area"] * abs(an) * an * bn + q["tow.drag_area_axial"] * abs(at) * at * bt)
        push = self.water_acceleration(xs + t * length, time)
        masses = (q["body.added_mass"], q["tow.added_mass_vertical"])
        force = force + (self.rho * q["body.volume"] + np.array(masses)) * push
        found = [(force, velocity, length * n, t)]
        displaced = self.rho * np.pi / 4.0 * q["cable.diameter"] ** 2 * self.lr / int(q["tow.drag_segments"])
        added = self.gamma * self.rho * np.pi / 4.0 * self.diameter(u) ** 2 * length / int(q["tow.drag_segments"])
        count = int(q["tow.drag_segments"])
        for i in range(count):
            share = (i + 0.5) / count
            velocity = vs + t * ud * share + n * length * share * w
            relative = self.water(*(xs + t * length * share), time) - velocity
            an, at = relative @ n, relative @ t
            wetted = 0.5 * self.rho * self.diameter(u) * length / count
            cn, ct = q["cable.normal_drag_coefficient"], q["cable.tangential_drag_coefficient"]
            force = wetted * (cn * abs(an) * an * n + ct * abs(at) * at * t)
            push = self.water_acceleration(xs + t * length * share, time)
            force = force + displaced * push + added * (push @ n) * n
            found.append((force, velocity, length * share * n, share * t))
        return found

    def tension(self, motion):
        return self.k * motion[2] + self.c * motion[3]

    def path(self, top, motion, rates, s):
        """Top velocity and motion a (complex or small) time s later."""
        phi, w, u, ud = motion
        wd, udd = rates
        later = (phi + s * (w + 0.5 * s * wd), w + s * wd, u + s * (ud + 0.5 * s * udd), ud + s * udd)
        return later, top[1] + s * top[2], top[4] + s * top[5]

    def momenta(self, top, motion, rates, s):
        (phi, w, u, ud), vx, vy = self.path(top, motion, rates, s)
        return np.array(
            [
                self.kinetic(phi, w + 1e-30j, u, ud, vx, vy).imag / 1e-30,
                self.kinetic(phi, w, u, ud + 1e-30j, vx, vy).imag / 1e-30,
            ]
        )

    def accelerations(self, top, time, motion):
        """phi'' and u'' from d/dt(dL/dq') - dL/dq = Q with numerical derivatives of the energies."""
        phi, w, u, ud = motion
        step = 1e-3 * np.array([1.0, 2.0, 3.0])

        def inertia(rates):
            high = [self.momenta(top, motion, rates, s) - self.momenta(top, motion, rates, -s) for s in step]
            return (45.0 * high[0] - 9.0 * high[1] + high[2]) / (60.0 * step[0])

        rest = inertia((0.0, 0.0))
        mass = np.column_stack([inertia((1.0, 0.0)) - rest, inertia((0.0, 1.0)) - rest])
        vx, vy = top[1], top[4]
        by_phi = self.kinetic(phi + 1e-30j, w, u, ud, vx, vy) - self.height(phi + 1e-30j, u, top[3])
        by_u = self.kinetic(phi, w, u + 1e-30j, ud, vx, vy) - self.height(phi, u + 1e-30j, top[3])
        force = np.array([by_phi.imag, by_u.imag]) / 1e-30
        force[1] -= self.tension(motion)
        for drag, _, arm_phi, arm_u in self.drags(top, time, motion):
            force += [drag @ arm_phi, drag @ arm_u]
        return np.linalg.solve(mass, force - rest)

    def energy_rate(self, top, motion, rates):
        """d/dt of kinetic energy and potential energy of the weights along the motion."""
        s = 1e-30j
        (phi, w, u, ud), vx, vy = self.path(top, motion, rates, s)
        return (self.kinetic(phi, w, u, ud, vx, vy) + self.height(phi, u, top[3] + s * top[4])).imag / 1e-30


def tow(parts, **changes):
    """A TowCable of NUMBERS with changes; keywords spell dots as double underscores."""
    return TowCable.from_numbers(NUMBERS | {k.replace("__", "."): v for k, v in changes.items()}, parts)


def still(x=0.0, z=0.0):
    return np.array([x, 0.0, z, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0])


def follow(model, motion, step, count, start=0.0, see=None):
    """Advance `count` steps along motion(t) -> (9,); the clock is start + n step."""
    for i in range(count):
        t, t_end = start + i * step, start + (i + 1) * step
        model.advance(t, t_end - t, motion(t), motion(t_end))
        if see is not None:
            see(t_end)


def circling(amplitude, omega, ramp):
    """Top motion: a circle in the vertical plane that grows smoothly over `ramp` seconds."""

    def at(t):
        s = min(max(t / ramp, 0.0), 1.0)
        r, rd, rdd = s**3 * (10 - 15 * s + 6 * s * s), 30 * s * s * (1 - s) ** 2 / ramp, 60 * s * (1 - s) * (1 - 2 * s) / ramp**2
        out = np.zeros(9)
        for axis, phase in ((0, 0.0), (2, np.pi / 2)):
            q, qd, qdd = np.sin(omega * t + phase), omega * np.cos(omega * t + phase), -omega * omega * np.sin(omega * t + phase)
            out[axis], out[3 + axis], out[6 + axis] = (
                amplitude * r * q,
                amplitude * (rd * q + r * qd),
                amplitude * (rdd * q + 2 * rd * qd + r * qdd),
            )
        return out

    return at
