"""Checks of the box grid that need many variants but few numbers; run as a script without numba they print JSON.

NUMBA_DISABLE_JIT=1 python box_plain.py
"""

import itertools
import json
import sys

import numpy as np
from chain_support import HANGING, WEIGHT, drive, every, make, still, swing, view
from scipy.linalg import eig

from cable_model.effects import Parts
from cable_model.errors import SolverError
from cable_model.kernels import box, box_step
from cable_model.kernels.almost_block_diagonal import solve
from cable_model.kernels.box_law import Gains, unknowns
from cable_model.kernels.family import coefficients
from cable_model.kernels.problem import Body, Cable, Numeric, Problem, Water
from cable_model.sea import table_of
from cable_model.signals import OUTPUTS

WAVES = table_of(np.array([[0.1, 2.0, 0.4, 0.0, 0.3, 0.0]]))
SHEARED = np.array([[-5.0, 0.2, 0.0], [-0.5, 1.0, 0.0], [1.0, 2.0, 0.0]])
STILL, FLOWING, WAVY = (True, None, None), (True, SHEARED, None), (True, SHEARED, WAVES)


def dense(blocks, lower, upper):
    """The almost block diagonal matrix and right-hand side in full."""
    n, size, _ = blocks.shape
    half = size // 2
    matrix = np.zeros((n * size, n * size))
    right = np.zeros(n * size)
    matrix[:half, :size] = lower[:, :size]
    right[:half] = lower[:, size]
    for i in range(n - 1):
        rows = slice(half + i * size, half + (i + 1) * size)
        matrix[rows, i * size : (i + 2) * size] = blocks[i, :, :-1]
        right[rows] = blocks[i, :, -1]
    matrix[-half:, -size:] = upper[:, :size]
    right[-half:] = upper[:, size]
    return matrix, right


class Step:
    """One step of 0.02 s from a random state of four nodes, on which rows and their derivatives can be looked at."""

    def __init__(self, parts, pull=0.0, seed=1, roughness=0.3, height=-0.2, thick=False):
        rng = np.random.default_rng(seed)
        self.parts = parts
        self.like = unknowns(parts.bending)
        size = len(self.like)
        self.n = 4
        self.c = coefficients(0, -0.5)
        self.h = 0.02
        self.mesh = np.array([[0.3, 0.5], [0.5, 0.5], [0.9, 0.5]])
        self.problem = Problem(
            Cable(1.7, 0.4 if thick else 0.01, 0.8, 50.0, 9.81, 0.6 * 9.81),
            Water(3.0, 0.4, *((20.0, 30.0) if thick else (0.2, 0.3))) if parts.water else None,
            Body(1.3, *((20.0, 30.0) if thick else (0.4, 0.2)), 9.0, 2.0, 0.3 if thick else 0.1) if parts.body else None,
            Numeric(0.0, 0.0, 0.0, 0.0, 0.3 if parts.voigt else 0.0, 0.02 if parts.bending else 0.0, pull, 1e-9, 0.0),
            None,
            None,
        )
        to_rate = 1.0 / (self.c.gamma * self.h)
        gain = 1.0 - self.c.alpha_k
        self.gains = Gains(gain, (1.0 - self.c.alpha_m) * to_rate, 0.5 * gain * self.h, 0.1)
        self.back = (1.0 - self.c.gamma) / self.c.gamma
        self.y0 = roughness * rng.normal(size=(self.n, size))
        self.yd0 = rng.normal(size=(self.n, size))
        self.y1 = self.y0 + 0.1 * rng.normal(size=(self.n, size))
        self.s = box_step.cut_scratch(np.zeros(box_step.scratch_size(self.n, size)), self.n, self.like)
        box_step._place(parts.water, parts.inextensible, self.mesh, self.y0, (0.1, height), self.gains.reach, self.s.base)

    def rows(self, y1):
        s = self.s
        box_step._average(self.c, self.gains, self.back, self.y0, self.yd0, y1, s.a, s.d)
        box.assemble(self.parts, self.problem, self.gains, self.mesh, s.a, s.d, y1, s.base, 0.3, (0.5, 0.2),
                     s.blocks, s.lower, s.upper, self.like)  # fmt: skip
        return dense(s.blocks, s.lower, s.upper)


def jacobian_misfits():
    """Largest difference of the Jacobian from central differences, by variant, in units of its largest entry."""
    misfits = {}
    for bending, kind, end, (water, current, waves), pull in itertools.product(
        (None, True), ("elastic", "voigt", "inextensible"), ("free", "body", "anchor"),
        ((None, None, None), STILL, FLOWING, WAVY), (0.0, 0.7),
    ):  # fmt: skip
        if pull and end == "anchor":
            continue
        parts = Parts(
            box=True, bending=bending, voigt=True if kind == "voigt" else None,
            inextensible=True if kind == "inextensible" else None, body=True if end == "body" else None,
            anchor=True if end == "anchor" else None, water=water, current=current, waves=waves,
        )  # fmt: skip
        misfit = misfit_of(Step(parts, pull))
        flow = "waves" if waves is not None else "current" if current is not None else "water" if water else "air"
        name = f"{'bending' if bending else 'flexible'} {kind} {end} {flow}{' pulled' if pull else ''}"
        misfits[name] = misfit
    return misfits


def misfit_of(step):
    exact, _ = step.rows(step.y1)
    found = np.zeros_like(exact)
    for k in range(step.y1.size):
        shift = np.zeros(step.y1.size)
        shift[k] = 1e-6
        shift = shift.reshape(step.y1.shape)
        found[:, k] = (step.rows(step.y1 - shift)[1] - step.rows(step.y1 + shift)[1]) / 2e-6
    return float(np.abs(exact - found).max() / np.abs(exact).max())


def surface_misfits():
    """As jacobian_misfits, of cables that cross the water's surface, their ends in it."""
    misfits = {}
    for bending, stiff, body, height in itertools.product((None, True), (None, True), (None, True), (0.1, 0.5, 0.9, 1.3, 1.7)):
        parts = Parts(box=True, bending=bending, inextensible=stiff, body=body, water=True, surface=True)
        misfits[f"{bending} {stiff} {body} {height}"] = misfit_of(Step(parts, height=height, thick=True))
    return misfits


def solver_misfits():
    """Residual of the elimination on random matrices, relative to the largest solution, by unknowns a node."""
    misfits = {}
    for size in (4, 6):
        rng = np.random.default_rng(size)
        n, half = 9, size // 2
        blocks = rng.normal(size=(n, size, 2 * size + 1))
        lower, upper = rng.normal(size=(half, size + 1)), rng.normal(size=(half, size + 1))
        matrix, right = dense(blocks, lower, upper)
        x = np.zeros((n, size))
        solve(blocks, lower, upper, np.zeros((size + half, 2 * size + 1)), x, (0.0,) * size)
        misfits[str(size)] = float(np.abs(matrix @ x.ravel() - right).max() / np.abs(x).max())
    return misfits


def newton_changes():
    """Sizes of successive Newton changes of one hard step, until rounding."""
    step = Step(Parts(box=True, bending=True), roughness=0.05)
    y1, changes = step.y0.copy(), []
    for _ in range(12):
        matrix, right = step.rows(y1)
        change = np.linalg.solve(matrix, right)
        y1 = y1 + change.reshape(y1.shape)
        changes.append(float(np.abs(change).max()))
    return changes


def frequencies():
    """First four natural frequencies of a hanging chain L = m = g = 1, EI 1e-6, EA 1e9, by number of nodes, from the rows themselves."""
    return {str(n): natural_frequencies(n) for n in (51, 100, 101)}


def wet_frequencies():
    """Ratios of the first four frequencies with weight 0.6 and added mass 0.8 in water without drag to those in air."""
    water = Water(0.0, 0.0, 0.8, 0.4)
    wet, dry = natural_frequencies(51, 0.6, water, 1e-9), natural_frequencies(51, 1.0, None, 1e-9)
    return [w / d for w, d in zip(wet, dry, strict=True)]


def natural_frequencies(n, weight=1.0, water=None, bending=1e-6):
    """Of a chain of unit length, mass and gravity with the top hinged."""
    like = unknowns(True)
    numeric = Numeric(0.0, 0.0, 0.0, 0.0, 0.0, bending, 0.0, 1e-9, 0.0)
    problem = Problem(Cable(1.0, 0.01, 1.0, 1e9, 1.0, weight), water, None, numeric, None, None)
    parts = Parts(box=True, bending=True, water=True if water else None)
    mesh = np.full((n - 1, 2), 1.0 / (n - 1))
    y = np.zeros((n, 6))
    y[:, 0] = weight * np.linspace(0.0, 1e-9, n)
    none = np.zeros((n, 6))
    s = box_step.cut_scratch(np.zeros(box_step.scratch_size(n, 6)), n, like)

    def rows(k, m):
        box.assemble(parts, problem, Gains(k, m, 0.0, 1.0), mesh, y, none, y, s.base, 0.0, (0.0, 0.0),
                     s.blocks, s.lower, s.upper, like)  # fmt: skip
        return dense(s.blocks, s.lower, s.upper)[0]

    stiffness = rows(1.0, 0.0)
    mass = rows(1.0, 1.0) - stiffness
    values = eig(-stiffness, mass, right=False, homogeneous_eigvals=True)
    finite = np.abs(values[1]) > 1e-12 * np.abs(values[1]).max()
    found = np.imag(values[0][finite] / values[1][finite])
    return [float(w) for w in np.sort(found[found > 0.5])[:4]]


def power_misfit():
    """Largest defect of the power balance of a weightless cell in a random state, relative to the power at its ends."""
    step = Step(Parts(box=True, bending=True))
    step.problem = step.problem._replace(cable=step.problem.cable._replace(weight=0.0))
    step.rows(step.y1)
    worst = 0.0
    for i in range(step.n - 1):
        mean, rate = 0.5 * (step.s.a[i] + step.s.a[i + 1]), 0.5 * (step.s.d[i] + step.s.d[i + 1])
        h, mass, pull = step.mesh[i, 0], step.problem.cable.mass, step.problem.cable.stiffness
        right = step.s.blocks[i, :, -1] / np.array([0.1, 0.1, 1.0, 1.0, 1.0, 0.1])
        supplied = pull * (step.s.a[i + 1, 0] * step.s.a[i + 1, 2] - step.s.a[i, 0] * step.s.a[i, 2])
        supplied += step.s.a[i + 1, 1] * step.s.a[i + 1, 3] - step.s.a[i, 1] * step.s.a[i, 3]
        stored = mass * (mean[2] * rate[2] + mean[3] * rate[3]) + pull * mean[0] * rate[0] + mean[1] * (1.0 + mean[0]) * rate[4]
        rows = right @ np.array([mean[2], mean[3], pull * mean[0], mean[1], 0.0, 0.0])
        worst = max(worst, abs(supplied - h * stored + rows) / abs(supplied))
    return float(worst)


def frame_misfit():
    """Change of a cell's forces when it turns and moves with a uniform current, against the same motion in still water."""
    step = Step(Parts(box=True, water=True, bending=True))
    step.rows(step.y1)
    a, d, s = step.s.a, step.s.d, step.s
    speed = 0.8
    before = np.zeros((6, 13))
    after = np.zeros((6, 13))
    arguments = (step.problem, step.gains, 0.3)
    box._cell(step.parts, *arguments, a, d, step.y1, s.base, 0.3, 0, before, step.like)
    phi, spin = 0.5 * (a[0, 4] + a[1, 4]), 0.5 * (d[0, 4] + d[1, 4])
    # the same motion seen from the bank: velocities and, as the axes turn, their rates
    a[:2, 2] += speed * np.sin(phi)
    a[:2, 3] += speed * np.cos(phi)
    d[:2, 2] += speed * np.cos(phi) * spin
    d[:2, 3] -= speed * np.sin(phi) * spin
    parts = step.parts._replace(current=np.array([[0.0, speed, 0.0]]))
    box._cell(parts, *arguments, a, d, step.y1, s.base, 0.3, 0, after, step.like)
    return float(np.abs(after[:2, 12] - before[:2, 12]).max() / np.abs(before[:2, 12]).max())


SOFT = WEIGHT * 1.75**2 * 1e-4  # N m2
HELD = {"lower_end": {"anchored": True, "x": 1.0, "z": -0.5}}
WET = {"water": {"density": 1025.0}, "current": {"speed": 0.3}, "cable": {"diameter": 0.01, "normal_drag_coefficient": 1.2}}
BODY = {"body": {"mass": 0.5, "volume": 1e-4, "drag_area": 0.01, "added_mass": 0.05}}
AT_REST = {
    "chain": {},
    "chain with bending": {"cable": {"bending_stiffness": SOFT}},
    "inextensible": {"cable": {"bending_stiffness": SOFT, "inextensible": True}},
    "body in a current": WET | BODY,
    "bending in a current": WET | {"cable": WET["cable"] | {"bending_stiffness": SOFT}},
    "anchored": HELD | {"cable": {"bending_stiffness": SOFT}},
    "anchored in a current": HELD | WET,
    "buoyant": WET | {"body": BODY["body"] | {"volume": 2e-3}},
}


def boxed(tables):
    """The hanging chain of eleven nodes on the box grid with further entries."""
    base = {part: dict(HANGING.get(part, {})) | tables.get(part, {}) for part in {*HANGING, *tables}}
    base["cable"]["mass_per_length"] = 0.15
    return make(base, solver__grid="box", solver__nodes=11, solver__time_step=0.1)


def rest():
    """Of a cable in equilibrium left alone for ten steps: largest change of any output; gap between shape, outputs, top and anchor."""
    changes = {}
    for name, tables in AT_REST.items():
        model = boxed(tables)
        series = drive(model, every(0.1, 1.0), still())
        moved = max(np.abs(v - v[0]).max() for key, v in series.items() if key != "time" and not key.startswith("solver"))
        shape = model.positions()
        end = [series["body.x"][-1], 0.0, series["body.z"][-1]]
        gap = max(np.abs(shape[0] - end).max(), np.abs(shape[-1]).max())
        held = np.abs(shape[0] - [1.0, 0.0, -0.5]).max() if "lower_end" in tables else 0.0
        changes[name] = [float(moved), float(gap), float(held)]
    return changes


def pulled_end():
    """Force at the tip, (T t + S n) + P, of a chain that a horizontal P holds aside: the largest component, in units of P."""
    model = boxed({"cable": {"bending_stiffness": SOFT}, "lower_end": {"release_force": 0.2}})
    model.initialize(still()(0.0))
    stiffness = model.scene.cable.axial_stiffness
    now = view(model)
    t = np.array([np.sin(now.y[0, 4]), np.cos(now.y[0, 4])])
    n = np.array([t[1], -t[0]])
    return float(np.abs(stiffness * now.y[0, 0] * t + now.y[0, 1] * n + [0.2, 0.0]).max() / 0.2)


def starting_turns():
    """Rates of phi, from the tip up, of a chain whose top is struck sideways."""
    model = boxed({"cable": {"bending_stiffness": SOFT}})
    model.initialize(np.array([0.0, 0.0, 0.0, 0.15, 0.0, 0.0, 0.0, 0.0, 0.0]))
    return view(model).yd[:, 4].tolist()


THICK = {"length": 8.0, "mass_per_length": 4.0, "axial_stiffness": 1e5, "axial_damping": 3e4, "diameter": 0.05}
HEAVED = {
    "cable": THICK | {"normal_drag_coefficient": 1.2, "tangential_drag_coefficient": 0.1, "added_mass_coefficient": 1.0},
    "body": {"mass": 300.0, "volume": 0.15, "drag_area": 0.3, "added_mass": 75.0},
    "water": {"density": 1025.0},
    "top": {"position": [0.0, 0.0, 7.0]},
}


def surface_gaps():
    """Largest distance of the body's ways on the two grids, as shares of its heave, while it is heaved through the surface."""
    gaps = []
    for nodes, step in ((6, 0.08), (11, 0.04)):
        runs = []
        for grid in ("box", "staggered"):
            model = make(HEAVED, solver__grid=grid, solver__nodes=nodes, solver__time_step=step)
            motion = swing((0.8, 0.0, 1.5), 1.3, ramp_time=2.0)
            series = drive(model, every(0.08, 5.6), lambda t, motion=motion: motion(t) + still((0.0, 0.0, 7.0))(t))
            runs.append(np.array([series["body.x"], series["body.z"]]))
        gaps.append(float(np.abs(runs[0] - runs[1]).max() / np.ptp(runs[1][1])))
    return gaps


def afloat():
    """Height of a float that a soft line holds down, the top's vertical force of the thick cable half in air, and what is refused."""
    line = {"length": 30.0, "mass_per_length": 0.9, "axial_stiffness": 4e3, "diameter": 0.02}
    scene = {"cable": line, "body": {"mass": 300.0, "volume": 0.5}, "water": {"density": 1025.0}, "solver": {"grid": "box", "nodes": 9}}
    model = make(scene)
    model.initialize(still((0.0, 0.0, -30.2))(0.0))
    hung = make(
        {"cable": THICK, "water": {"density": 1025.0}, "solver": {"grid": "box", "nodes": 12}, "top": {"position": [0.0, 0.0, 4.0]}}
    )
    hung.initialize(still((0.0, 0.0, 4.0))(0.0))
    try:
        make(scene).initialize(still((0.0, 0.0, -20.0))(0.0))
        refused = ""
    except SolverError as error:
        refused = str(error)
    return [float(model.outputs[OUTPUTS.index("body.z")]), float(hung.outputs[OUTPUTS.index("top.force_z")]), refused]


CHECKS = (
    jacobian_misfits, surface_misfits, solver_misfits, newton_changes, frequencies, wet_frequencies,
    power_misfit, frame_misfit, rest, pulled_end, starting_turns, surface_gaps, afloat,
)  # fmt: skip

if __name__ == "__main__":
    json.dump({check.__name__: check() for check in CHECKS}, sys.stdout)
