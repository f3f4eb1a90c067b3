"""What the tests of the chain share: scenes, exact top motions, runs, and the energy of a state written from the equations."""

import itertools
from collections.abc import Callable

import numpy as np

from cable_model import scene
from cable_model.cable_chain import CableChain
from cable_model.kernels import layout
from cable_model.signals import OUTPUTS

Motion = Callable[[float], np.ndarray]  # time -> (9,): position, velocity, acceleration of the top

SECOND_MODE = 6.5348  # rad/s, of the 1.75 m chain at 9.81 m/s2
WEIGHT = 0.1 * 9.81 * 1.75  # N, of that chain
HANGING = {
    "cable": {"length": 1.75, "mass_per_length": 0.1, "axial_stiffness": 1e4 * WEIGHT},
    "environment": {"gravity": 9.81},
    "solver": {"nodes": 51, "time_step": 0.01, "lambda_infinity": -0.5},
}
SHORT_BENDING = 1e-6 * WEIGHT * 1.75**2  # N m2: EI* = EI/(m g L^3) = 1e-6
WIRE = {  # 200 m of 25 mm steel wire with a 1000 kg body in still water, which is above z = 0 too, as where its numbers come from
    "cable": {"length": 200.0, "mass_per_length": 3.0, "axial_stiffness": 5e7, "diameter": 0.025, "normal_drag_coefficient": 1.2},
    "body": {"mass": 1000.0, "volume": 0.4, "drag_area": 1.0, "added_mass": 400.0},
    "water": {"density": 1025.0, "surface": False},
    "solver": {"nodes": 51, "time_step": 0.05, "lambda_infinity": -0.5},
}


def scene_of(base: dict, **changes: object) -> scene.Scene:
    """A scene from a nested dictionary; changes are by name, `cable__length=2.0`."""
    tables = {part: dict(values) for part, values in base.items()}
    for name, value in changes.items():
        part, _, field = name.partition("__")
        tables.setdefault(part, {})[field] = value
    return scene.from_dict(tables)


def make(base: dict, **changes: object) -> CableChain:
    """A chain from a nested dictionary, likewise."""
    return CableChain(scene_of(base, **changes))


def still(position: tuple[float, float, float] = (0.0, 0.0, 0.0)) -> Motion:
    return lambda t: np.array([*position, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0])


def product(f: tuple, g: tuple) -> tuple:
    """Value and two derivatives of a product."""
    return f[0] * g[0], f[1] * g[0] + f[0] * g[1], f[2] * g[0] + 2.0 * f[1] * g[1] + f[0] * g[2]


def septic(t: float, duration: float) -> tuple:
    """Step from 0 to 1 with three vanishing derivatives at both ends: s^4 (35 - 84 s + 70 s^2 - 20 s^3)."""
    s = t / duration
    if s >= 1.0:
        return 1.0, 0.0, 0.0
    rate = 140.0 * (s - s * s) ** 3 / duration
    return s**4 * (35.0 + s * (-84.0 + s * (70.0 - 20.0 * s))), rate, 420.0 * (s - s * s) ** 2 * (1.0 - 2.0 * s) / duration**2


def cubic(t: float, duration: float) -> tuple:
    """The step s^2 (3 - 2 s), whose acceleration jumps at both ends."""
    s = t / duration
    if s >= 1.0:
        return 1.0, 0.0, 0.0
    return s * s * (3.0 - 2.0 * s), 6.0 * (s - s * s) / duration, (6.0 - 12.0 * s) / duration**2


def no_ramp(t: float, duration: float) -> tuple:
    return 1.0, 0.0, 0.0


def swing(amplitude: tuple, omega: float, ramp: Callable = septic, ramp_time: float = 1.0, phase: tuple = (0.0, 0.0, 0.0)) -> Motion:
    """Harmonic top motion a sin(omega t + phase) along x, y, z about the origin, faded in."""

    def motion(t: float) -> np.ndarray:
        state = np.zeros(9)
        for k in range(3):
            s, c = np.sin(omega * t + phase[k]), np.cos(omega * t + phase[k])
            wave = (amplitude[k] * s, amplitude[k] * omega * c, -amplitude[k] * omega * omega * s)
            state[k::3] = product(ramp(t, ramp_time), wave)
        return state

    return motion


def drive(model: CableChain, times: np.ndarray, motion: Motion, each: Callable | None = None) -> dict[str, np.ndarray]:
    """Series of all outputs at `times` (the first is the start), the top following `motion` exactly."""
    model.initialize(motion(times[0]), times[0])
    rows = [model.outputs.copy()]
    if each is not None:
        each(times[0])
    for start, end in itertools.pairwise(times):
        model.advance(start, end - start, motion(start), motion(end))
        rows.append(model.outputs.copy())
        if each is not None:
            each(end)
    table = np.array(rows)
    return {"time": np.asarray(times), **{name: table[:, k] for k, name in enumerate(OUTPUTS)}}


def every(step: float, duration: float) -> np.ndarray:
    return step * np.arange(round(duration / step) + 1)


def view(model: CableChain) -> layout.View:
    """The named arrays of the model's state: mesh, y (cell vectors, then velocities), force and the rest."""
    return layout.cut(model.parts, model.numbers, model.state, model._work)


def observed_orders(answers: list[np.ndarray]) -> list[float]:
    """Orders from answers at steps halved each time, by successive differences in the maximum norm."""
    gaps = [np.max(np.abs(a - b)) for a, b in itertools.pairwise(answers)]
    return [float(np.log2(a / b)) for a, b in itertools.pairwise(gaps)]


def kinetic_matrix(h: np.ndarray, split: np.ndarray) -> np.ndarray:
    """Mass matrix over m of the nodes: weights b - 1/12, 1/12, 1 - b - 1/12 of every cell (theta = 1/6)."""
    n = len(h) + 1
    matrix = np.zeros((n, n))
    for i in range(n - 1):
        matrix[i : i + 2, i : i + 2] += h[i] * np.array([[split[i] - 1 / 12, 1 / 12], [1 / 12, 1.0 - split[i] - 1 / 12]])
    return matrix


def energy(model: CableChain) -> float:
    """Kinetic, potential, strain (slack law integrated at rest) and bending energy of the chain and its body, J."""
    table = model.scene
    now = view(model)
    h, split = now.mesh[:, 0], now.mesh[:, 1]
    n = len(h) + 1
    q, v = now.y[: n - 1], now.y[n:]
    z = model.positions()[:, 2]
    gravity = table.environment.gravity
    density = table.water.density if table.water else 0.0
    weight = (table.cable.mass_per_length - density * np.pi / 4.0 * table.cable.diameter**2) * gravity
    kinetic = 0.5 * table.cable.mass_per_length * np.sum(v * (kinetic_matrix(h, split) @ v))
    potential = weight * np.sum(h * (split * z[:-1] + (1.0 - split) * z[1:]))
    body = table.body
    kinetic += 0.5 * (body.mass + (body.added_mass if density else 0.0)) * np.sum(v[0] ** 2)
    body_weight = (body.mass - density * body.volume) * gravity
    potential += body_weight * z[0]
    stretch = np.sqrt(np.sum(q * q, axis=1))
    f = table.cable.axial_stiffness * (stretch - 1.0)
    w0 = table.solver.slack_smoothing * (abs(weight) * table.cable.length + abs(body_weight))
    w0 = np.minimum(w0, abs(body_weight) + abs(weight) * h)  # a cell's is no more than what body and cell weigh
    held = 2.0 * table.cable.bending_stiffness / h**2 * (not table.cable.compressible)  # the law is that of T + 2 EI/h^2
    lost = h * held * (stretch - 1.0 + held / (2.0 * table.cable.axial_stiffness))
    f = f + held
    strain = np.sum(h * (f * f + f * np.hypot(f, w0) + w0 * w0 * np.arcsinh(f / w0))) / (4.0 * table.cable.axial_stiffness)
    strain -= np.sum(lost)
    between = (1.0 - split[:-1]) * h[:-1] + split[1:] * h[1:]
    bending = np.sum(table.cable.bending_stiffness * np.sum(np.diff(q, axis=0) ** 2, axis=1) / (2.0 * between))
    return float(kinetic + potential + strain + bending)


def unroll(bands: np.ndarray, n: int, d: int, outer: bool) -> np.ndarray:
    """Full matrix from the bands -2 ... 2 of d x d blocks; the outer two are in use with bending only."""
    full = np.zeros((n * d, n * d))
    for band in range(5) if outer else range(1, 4):
        for i in range(n):
            j = i + band - 2
            if 0 <= j < n:
                full[i * d : i * d + d, j * d : j * d + d] = bands[band, i].reshape(d, d)
    return full


def with_tensions(full: np.ndarray, x: np.ndarray, cells: np.ndarray, n: int) -> tuple[np.ndarray, np.ndarray]:
    """Matrix and right side (n D) of the node velocities alone: the changes of the cells' tensions are put in."""
    d = x.shape[1]
    matrix, right = full.copy(), x[:n].copy()
    for i in range(n - 1):
        tangent, slope = cells[i, 3 : 3 + d], cells[i, 3 + d : 3 + 2 * d]
        low, up = slice(i * d, i * d + d), slice(i * d + d, i * d + 2 * d)
        for row, sign in ((low, -1.0), (up, 1.0)):
            matrix[row, up] += sign * np.outer(tangent, slope)
            matrix[row, low] -= sign * np.outer(tangent, slope)
        right[i] += cells[i, 1] * tangent
        right[i + 1] -= cells[i, 1] * tangent
    return matrix, right
