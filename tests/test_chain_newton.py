"""Newton's method on the staggered grid: the analytic Jacobian against central differences, and quadratic convergence."""

import itertools

import numpy as np
import pytest
from chain_support import HANGING, make, unroll, view, with_tensions

from cable_model.kernels import seabed
from cable_model.kernels.block_elimination import solve
from cable_model.kernels.build import build
from cable_model.kernels.contact import BEFORE, CHANGE, FORCE, NOW
from cable_model.kernels.family import Coefficients, coefficients
from cable_model.kernels.staggered import FADING, assemble, prescribe_ends
from cable_model.kernels.staggered_step import Gains, Winding, _update_tensions, average
from cable_model.parameters import INTEGRATORS

pytestmark = pytest.mark.plain

STEP = 0.02
PLAIN = {**HANGING, "solver": {"nodes": 7, "time_step": STEP, "lambda_infinity": -0.5, "slack_smoothing": 0.05}}
WET = {
    **PLAIN,
    "cable": {
        **HANGING["cable"], "diameter": 0.01, "normal_drag_coefficient": 1.2, "tangential_drag_coefficient": 0.3,
        "added_mass_coefficient": 1.0, "bending_stiffness": 1e-3, "axial_damping": 0.7,
    },
    "body": {"mass": 0.3, "volume": 1e-4, "drag_area": 1e-3, "added_mass": 0.05},
    "water": {"density": 1025.0},
    "current": {"levels": [[-2.0, 0.3, 0.0], [-0.5, 0.8, 0.0], [1.0, 0.2, 0.0]]},
    "waves": {"amplitude": 0.1, "period": 2.0, "phase": 0.4},
}  # fmt: skip


class Step:
    """One time step of a chain in a bent, partly slack, moving state; the unknowns are its new node velocities."""

    def __init__(self, base: dict, seed: int, **changes: object) -> None:
        self.model = make(base, **changes)
        top = np.zeros(9)
        top[2] = -0.8
        self.model.initialize(top)
        self.now = view(self.model)
        self.n, self.d = self.now.y.shape[0] // 2, self.now.y.shape[1]
        rng = np.random.default_rng(seed)
        self.y0 = self.now.y.copy()
        self.y0[: self.n - 1] += 0.2 * rng.standard_normal((self.n - 1, self.d))
        lengths = np.linalg.norm(self.y0[: self.n - 1], axis=1, keepdims=True)
        soft = 1.0 / self.model.scene.cable.axial_stiffness
        self.y0[: self.n - 1] *= (1.0 + soft * rng.uniform(-1.0, 2.0, (self.n - 1, 1))) / lengths  # some cells are slack
        self.y0[self.n :] = 0.3 * rng.standard_normal((self.n, self.d))
        self.yd0 = 0.5 * rng.standard_normal(self.y0.shape)
        self.yd0[: self.n - 1] = np.diff(self.y0[self.n :], axis=0) / self.now.mesh[:, :1]
        self.c = Coefficients(*coefficients(INTEGRATORS.index("generalized-alpha"), -0.5))
        self.problem = build(self.model.parts, self.model.numbers, 0.0)
        self.top = (0.1, -0.8) if self.d == 2 else (0.1, 0.05, -0.8)
        alpha_k, alpha_m, gamma = self.c
        reach = STEP * gamma * (1.0 - alpha_k) / (1.0 - alpha_m)  # of the position by the velocity, both new
        averaged = reach * (1.0 - alpha_k)
        self.gains = Gains(averaged, 1.0 - alpha_k, (1.0 - alpha_m) / (gamma * STEP), averaged, 1.0, STEP, Winding(1.75, 0.2, 0.4))
        parts, contact = self.model.parts, self.now.scratch.contact
        self.now.sliders[:, :-1] = 1e-2 * rng.standard_normal((len(self.now.sliders), self.d - 1))  # some nodes hold, some slide
        seabed.recall_sliders(parts.friction, self.now.sliders, self.top, contact)
        ground = self.problem.ground
        seabed.start_contacts(parts.seabed, parts.friction, ground, self.now.mesh, self.y0, self.n - 1, STEP, self.top, contact)
        self.fading = rng.uniform(0.0, 1.0, self.n - 1)  # shares of the slack damping
        self.contacts = self.now.scratch.contact[:, FORCE].copy()

    def assemble(self, v1: np.ndarray, force: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Residual (n, D) and full Jacobian at new velocities v1 (n, D); cell tensions are expanded about `force`."""
        _alpha_k, alpha_m, gamma = self.c
        s = self.now.scratch
        y1 = self.y0.copy()
        y1[self.n :] = v1
        s.cells[: self.n - 1, 0] = force
        s.cells[: self.n - 1, FADING] = self.fading
        s.contact[:, FORCE] = self.contacts
        s.contact[:, BEFORE:NOW] = 0.0  # no slider pulled the other way before
        s.length[: self.n - 1] = np.linalg.norm(self.y0[: self.n - 1], axis=1)
        mixed = (alpha_m / (1.0 - alpha_m), 1.0 / (1.0 - alpha_m), 1.0 / (gamma * STEP), (1.0 - gamma) / gamma)
        average(self.now.mesh, self.y0, self.yd0, y1, self.c, STEP, *mixed, s, self.top)
        assemble(
            self.model.parts, self.problem, self.gains, self.now.mesh, s.q, s.v, s.a, self.top, 0.3, 0, s.bands, s.x, s.cells, s.contact
        )
        full, right = with_tensions(unroll(s.bands, self.n, self.d, bool(self.model.parts.bending)), s.x, s.cells, self.n)
        return -right, full

    def solve(self) -> None:
        parts, s = self.model.parts, self.now.scratch
        prescribe_ends(parts, s.bands, s.x, self.n, self.top)
        solve(parts.bending, parts.anchor, s.bands, s.x, s.cells, self.n, self.top)

    def settled_tensions(self, v1: np.ndarray) -> np.ndarray:
        """Tensions that obey their law at v1: where the pending change vanishes."""
        force = np.full(self.n - 1, 1.0)
        for _ in range(200):
            self.assemble(v1, force)
            change = self.now.scratch.cells[: self.n - 1, 1].copy()
            self.contacts = np.maximum(self.contacts + self.now.scratch.contact[:, CHANGE], 0.1 * self.contacts)
            force = np.maximum(force + change, 0.1 * force) if self.model.parts.slack else force + change
        assert np.max(np.abs(change)) < 1e-10 * np.max(np.abs(force))
        return force


GROUND = {
    "cable__diameter": 0.01, "lower_end__anchored": True, "lower_end__x": 0.9, "lower_end__z": -1.9,
    "seabed__level": -1.8, "seabed__stiffness": 1e3, "seabed__friction_coefficient": 0.4, "seabed__friction_displacement": 1e-2,
    "seabed__friction_velocity": 3.0,
}  # fmt: skip
HILLS = [[-1.0, -1.9], [-0.2, -1.7], [0.4, -1.85], [1.0, -1.6], [2.0, -1.8]]
LANDSCAPE = [[x, y, z + 0.1 * np.sin(3.0 * y + x)] for x, z in HILLS for y in (-1.0, -0.3, 0.2, 1.0)]
RELIEF = {**GROUND, "seabed__level": 0.0}
CLAMP = {"top__clamped": True, "top__clamp_declination": 0.7}
JOINTS = {
    "cable__section": [
        {"length": 0.7, "mass_per_length": 0.3, "axial_stiffness": 4e4, "diameter": 0.03, "bending_stiffness": 3e-3},
        {"length": 1.05},
    ],
    "cable__body": [{"at": 0.7, "mass": 0.2, "volume": 1e-4, "drag_area": 1e-3, "added_mass": 0.1}, {"at": 1.2, "mass": 0.1}],
}  # fmt: skip
SCENES = {
    "sections and bodies, current": (WET, {**JOINTS, "waves__amplitude": 0.0}),
    "sections and bodies on a seabed with friction, in space": (PLAIN, {**JOINTS, **GROUND, "solver__space": True}),
    "plane": (PLAIN, {}),
    "plane, compressible": (PLAIN, {"cable__compressible": True}),
    "plane, bending, body, current, waves": (WET, {}),
    "space": (PLAIN, {"solver__space": True}),
    "plane, seabed with friction": (PLAIN, GROUND),
    "space, seabed with friction": (PLAIN, {**GROUND, "solver__space": True}),
    "plane, slope with friction": (PLAIN, {**GROUND, "seabed__slope": 0.3}),
    "space, slope with friction": (PLAIN, {**GROUND, "seabed__slope": 0.3, "seabed__slope_direction": 1.0, "solver__space": True}),
    "plane, profile with friction": (PLAIN, {**RELIEF, "seabed__profile": HILLS}),
    "space, profile": (PLAIN, {**RELIEF, "seabed__profile": HILLS, "seabed__friction_coefficient": 0.0, "solver__space": True}),
    "space, grid with friction": (PLAIN, {**RELIEF, "seabed__grid": LANDSCAPE, "solver__space": True}),
    "plane, clamped top": (PLAIN, {**CLAMP, "cable__bending_stiffness": 1e-2}),
    "space, both ends clamped": (
        PLAIN,
        {
            **CLAMP,
            "top__clamp_direction": 0.5,
            "lower_end__anchored": True,
            "lower_end__x": 0.9,
            "lower_end__z": -1.9,
            "lower_end__clamped": True,
            "lower_end__clamp_declination": 0.4,
            "cable__bending_stiffness": 1e-2,
            "solver__space": True,
        },
    ),
    "plane, winch": (PLAIN, {"winch__fitted": True}),
    "plane, table of the stiffness": (PLAIN, {"cable__stiffness_curve": [[0.0, 0.0], [0.01, 1.5], [0.05, 20.0]]}),
    "plane, winch, quadratic damping": (PLAIN, {"winch__fitted": True, "cable__quadratic_damping": 0.3}),
    "space, bending, body, current, waves": (WET, {"solver__space": True, "waves__direction": 0.7}),
}


@pytest.mark.parametrize("seed", [3, 5])  # on the seabed with 3 the nodes slide, with 5 some hold
@pytest.mark.parametrize(("base", "changes"), SCENES.values(), ids=SCENES)
def test_jacobian_is_the_derivative_of_the_residual(base, changes, seed):
    step = Step(base, seed, cable__axial_stiffness=300.0, **changes)
    v1 = step.y0[step.n :].copy()
    force = step.settled_tensions(v1)
    assert force.min() < 0.1 * force.max()  # slack cells are among them
    _, analytic = step.assemble(v1, force)
    columns = []
    for k in range((step.n - 1) * step.d):  # the top is prescribed
        shift = np.zeros(step.n * step.d)
        shift[k] = 1e-5
        ahead, _ = step.assemble(v1 + shift.reshape(v1.shape), force)
        behind, _ = step.assemble(v1 - shift.reshape(v1.shape), force)
        columns.append((ahead - behind).ravel() / 2e-5)
    numeric = np.array(columns).T
    allowed = 3e-8 * np.max(np.abs(analytic))
    if "waves" in base:  # within a step the water's acceleration is taken as uniform: its gradient k omega^2 a is left out
        omega, body = 2.0 * np.pi / 2.0, base["body"]
        displaced = 1025.0 * (2.0 * np.pi / 4.0 * 0.01**2 * 1.75 / 3.0 + body["volume"]) + body["added_mass"]
        allowed += displaced * 0.1 * omega**4 / 9.81 * step.gains.r
    free = (step.n - 1) * step.d  # the top's rows are not solved
    assert numeric[:free] == pytest.approx(analytic[:free, :free], abs=allowed)


def check_elimination(base: dict, changes: dict, stiffness: float) -> None:
    """The elimination against the whole system of velocities and tensions."""
    step = Step(base, 4, cable__axial_stiffness=stiffness, **changes)
    n, d, parts, s = step.n, step.d, step.model.parts, step.now.scratch
    step.assemble(step.y0[n:].copy(), np.linspace(0.5, 1.5, n - 1))
    prescribe_ends(parts, s.bands, s.x, n, step.top)
    size = n * d
    whole = np.zeros((size + n - 1, size + n - 1))
    whole[:size, :size] = unroll(s.bands, n, d, bool(parts.bending))
    right = np.concatenate([s.x[:n].ravel(), s.cells[: n - 1, 1]])
    for i in range(n - 1):  # T - b.(x_up - x_low) = c; on the nodes -T t below and T t above
        rise = s.cells[i, 3 + d : 3 + 2 * d]
        whole[size + i, size + i] = 1.0
        whole[size + i, i * d : i * d + 2 * d] = np.concatenate([rise, -rise])
        whole[i * d : i * d + 2 * d, size + i] = np.concatenate([-s.cells[i, 3 : 3 + d], s.cells[i, 3 : 3 + d]])
    held = [n - 1] if parts.anchor is None else [0, n - 1]
    for node in held:
        whole[node * d : node * d + d, size:] = 0.0
    step.assemble(step.y0[n:].copy(), np.linspace(0.5, 1.5, n - 1))
    step.solve()
    found = np.concatenate([s.x[:n].ravel(), s.cells[: n - 1, 1]])
    terms = np.abs(whole) @ np.abs(found) + np.abs(right)
    assert np.all(np.abs(whole @ found - right) <= 1e-9 * terms)
    if stiffness < 1e3:
        assert found == pytest.approx(np.linalg.solve(whole, right), rel=1e-8, abs=1e-9 * np.max(np.abs(found)))


@pytest.mark.parametrize("stiffness", [1e2, 1e12])
@pytest.mark.parametrize(("base", "changes"), SCENES.values(), ids=SCENES)
def test_elimination_is_stable_at_every_stiffness(base, changes, stiffness):
    if changes.get("lower_end__anchored"):
        stiffness = min(stiffness, 1e4)  # see below
    check_elimination(base, changes, stiffness)


@pytest.mark.parametrize("stiffness", [1e2, 1e6])  # the cell above a held node is a plain spring: digits go as its stiffness grows
def test_elimination_of_an_anchored_chain_is_exact(stiffness):
    check_elimination(PLAIN, {"lower_end__anchored": True}, stiffness)


@pytest.mark.parametrize("seed", [5, 6, 7])
@pytest.mark.parametrize(("base", "changes"), SCENES.values(), ids=SCENES)
def test_newton_squares_the_size_of_its_change_every_iteration(base, changes, seed):
    step = Step(base, seed, cable__axial_stiffness=1e4, **changes)
    parts, s = step.model.parts, step.now.scratch
    v1 = step.y0[step.n :].copy()
    force = np.full(step.n - 1, 1.0)
    sizes = []
    while len(sizes) < 25 and (not sizes or sizes[-1] > 1e-11):
        step.assemble(v1, force)
        step.solve()
        _update_tensions(parts.slack, parts, step.problem, step.now.mesh, s.cells)
        contacts = step.contacts
        seabed.update_contacts(parts.seabed, parts.friction, step.problem.ground, step.gains, step.now.mesh, s.x, step.top, s.contact)
        step.contacts = s.contact[:, FORCE].copy()
        v1 += s.x[: step.n]
        new = s.cells[: step.n - 1, 0].copy()
        pressed = np.abs(step.contacts - contacts)[: step.n - 1] / np.abs(step.contacts[: step.n - 1]) if parts.seabed else 0.0
        # m/s, and shares of the tensions and of the seabed's forces
        sizes.append(max(np.max(np.abs(s.x[: step.n])), np.max(np.abs(new - force) / np.abs(new)), np.max(pressed)))
        force = new
    near = [(before, after) for before, after in itertools.pairwise(sizes) if before < 0.1]
    assert len(near) >= 2
    for before, after in near:
        assert after < 5.0 * before**2 + 1e-10
