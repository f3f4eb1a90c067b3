"""Energy of the chain: what the top's force puts in is kinetic, potential, strain and bending energy, and what the water takes."""

import numpy as np
import pytest
from chain_support import (
    HANGING,
    SECOND_MODE,
    SHORT_BENDING,
    WEIGHT,
    WIRE,
    Motion,
    cubic,
    drive,
    energy,
    every,
    make,
    swing,
    view,
)  # fmt: skip
from scipy.integrate import cumulative_simpson

SWAY = swing((0.02, 0.0, 0.01), SECOND_MODE, phase=(0.0, 0.0, 0.5))
HEAVE = swing((0.5, 0.0, 1.0), 2.0 * np.pi / 8.0, ramp_time=8.0, phase=(0.0, 0.0, np.pi / 2.0))


def drag_power(model) -> float:
    """Work that the still water does on cable and body per second, from the Morison law: never positive."""
    scene, now = model.scene, view(model)
    h, split = now.mesh.T
    n = len(h) + 1
    q, v = now.y[: n - 1], now.y[n:]
    stretch = np.linalg.norm(q, axis=1)
    t = q / stretch[:, None]
    u = 0.5 * (v[:-1] + v[1:])
    along = np.sum(u * t, axis=1)[:, None] * t
    across = u - along
    half = 0.5 * scene.water.density * scene.cable.diameter * np.sqrt(stretch)[:, None]
    force = -half * scene.cable.normal_drag_coefficient * np.linalg.norm(across, axis=1)[:, None] * across
    force -= half * scene.cable.tangential_drag_coefficient * np.linalg.norm(along, axis=1)[:, None] * along
    power = np.sum(h * np.sum(force * (split[:, None] * v[:-1] + (1.0 - split[:, None]) * v[1:]), axis=1))
    return power - 0.5 * scene.water.density * scene.body.drag_area * np.linalg.norm(v[0]) ** 3


def imbalance(base: dict, motion: Motion, step: float, duration: float, **changes: object) -> tuple[np.ndarray, np.ndarray]:
    """Series of (energy gained - work of the top's force - work of the drag), and of that work, J."""
    model = make(base, solver__time_step=step, **changes)
    times = every(step, duration)
    gained, drained = [], []

    def each(_: float) -> None:
        gained.append(energy(model))
        drained.append(drag_power(model) if model.scene.water else 0.0)

    run = drive(model, times, motion, each)
    force = np.array([run["top.force_x"], run["top.force_y"], run["top.force_z"]]).T
    power = -np.sum(force * np.array([motion(t)[3:6] for t in times]), axis=1)
    work = cumulative_simpson(power + np.array(drained), x=times, initial=0.0)
    return np.array(gained) - gained[0] - work, work


def orders(worst: list[float]) -> np.ndarray:
    return np.log2(np.array(worst[:-1]) / np.array(worst[1:]))


@pytest.mark.parametrize(
    "changes",
    [{}, {"cable__axial_stiffness": 100.0 * WEIGHT}, {"cable__bending_stiffness": SHORT_BENDING}, {"solver__lambda_infinity": -0.9}],
    ids=["stiff", "soft", "bending", "lambda -0.9"],
)
def test_energy_in_vacuum_closes_at_second_order(changes):
    steps = (0.01, 0.005, 0.0025)
    worst, scale = [], 0.0
    for step in steps:
        miss, work = imbalance(HANGING, SWAY, step, 2.0, solver__slack_damping=0.0, **changes)
        worst.append(np.max(np.abs(miss)))
        scale = np.max(np.abs(work))
    assert orders(worst) == pytest.approx(2.0, abs=0.1)
    assert worst[-1] < 1e-4 * scale


def test_energy_closes_with_the_work_of_the_drag():
    worst = []
    for step in (0.1, 0.05, 0.025):
        miss, work = imbalance(
            WIRE, HEAVE, step, 16.0, cable__axial_stiffness=1e6, cable__tangential_drag_coefficient=0.1, solver__slack_damping=0.0
        )
        worst.append(np.max(np.abs(miss)))
    assert orders(worst) == pytest.approx(2.0, abs=0.15)
    assert worst[-1] < 1e-3 * np.max(np.abs(work))


def test_axial_damping_only_takes_energy():
    miss, work = imbalance(HANGING, SWAY, 0.001, 2.0, cable__axial_stiffness=100.0 * WEIGHT, cable__axial_damping=0.3)
    free, _ = imbalance(HANGING, SWAY, 0.001, 2.0, cable__axial_stiffness=100.0 * WEIGHT, solver__slack_damping=0.0)
    assert miss[-1] < -10.0 * np.max(np.abs(free))
    assert np.max(np.diff(miss - free)) < 1e-8 * np.max(np.abs(work))


@pytest.mark.parametrize("lam", [-0.5, -0.9])
@pytest.mark.parametrize("nodes", [51, 101])
@pytest.mark.parametrize("step", [0.01, 0.002])
def test_energy_in_the_collapse_never_exceeds_start_plus_work_by_one_percent(step, nodes, lam):
    # the top shaken by 0.0875 m at the second mode: the tip whips over and goes slack
    shake = swing((0.0875, 0.0, 0.0), 6.535, cubic)
    miss, _ = imbalance(
        HANGING, shake, step, 10.0, cable__bending_stiffness=SHORT_BENDING, solver__nodes=nodes, solver__lambda_infinity=lam
    )
    assert np.max(miss) < 0.01 * WEIGHT * 1.75
