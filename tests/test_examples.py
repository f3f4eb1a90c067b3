"""The example scenes: at rest as closed forms and separately integrated equilibria have it, by halving changed as little as they say."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from catenaries import between_points, touchdown
from scipy.integrate import solve_ivp
from scipy.interpolate import PchipInterpolator
from scipy.optimize import brentq, fsolve

from cable_model import CableChain, load, simulate
from cable_model.motion import motion_of
from cable_model.scene import Scene, shipped, with_values
from cable_model.signals import OUTPUTS
from cable_model.simulation import Result

NAMES = [name for name in shipped() if name.startswith("examples/")]
IRREGULAR = {"examples/lift", "examples/umbilical"}  # numba compiles their seas for half a minute
CALM = {  # without the sea
    f"waves.{name}": value for name, value in {"spectrum": "none", "significant_height": 0.0, "peak_period": 10.0, "components": 60}.items()
} | {"waves.surface": "held"}  # fmt: skip


def example(name: str, **changes: Any) -> Scene:
    return with_values(load(f"examples/{name}"), changes)


def at_rest(scene: Scene) -> dict[str, float]:
    """The outputs at the start."""
    model = CableChain(scene)
    model.initialize(motion_of(scene)(0.0, 1))
    return dict(zip(OUTPUTS, model.outputs.tolist(), strict=True))


def wet_weight(scene: Scene) -> float:
    """Weight in water by length, N/m."""
    return (scene.cable.mass_per_length - scene.water.density * scene.cable.displaced_area) * scene.environment.gravity


def flow(scene: Scene, z: float) -> float:
    """The current at a height, m/s, along x."""
    levels = np.array(scene.current.levels or [[0.0, scene.current.speed, 0.0]])
    return float(np.interp(z, levels[:, 0], levels[:, 1]))


def body_force(scene: Scene, z: float) -> np.ndarray:
    """Force (x, z) of weight, buoyancy and current on the body."""
    body, density, u = scene.body, scene.water.density, flow(scene, z)
    return np.array([0.5 * density * body.drag_area * abs(u) * u, (density * body.volume - body.mass) * scene.environment.gravity])


def equilibrium(scene: Scene, low: np.ndarray, pull: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Place (x, z) of the top and tension (x, z) there, of a cable at rest in the current that is pulled by `pull` at its lower end `low`.

    The cable below the surface has its weight in water and Morison's drag, above it its weight; without bending.
    """
    cable, density = scene.cable, scene.water.density
    wet, dry = wet_weight(scene), cable.mass_per_length * scene.environment.gravity

    def slope(s: float, state: np.ndarray) -> np.ndarray:
        place, force = state[:2], state[2:]
        size = np.linalg.norm(force)
        t, stretch = force / size, 1.0 + size / cable.axial_stiffness
        if place[1] > 0.0:
            return np.concatenate([stretch * t, [0.0, dry]])
        u = np.array([flow(scene, place[1]), 0.0])
        along = (u @ t) * t
        across = u - along
        drag = cable.normal_drag_coefficient * np.linalg.norm(across) * across
        drag = drag + cable.tangential_drag_coefficient * np.linalg.norm(along) * along
        load = 0.5 * density * cable.diameter * np.sqrt(stretch) * drag - np.array([0.0, wet])
        return np.concatenate([stretch * t, -load])

    end = solve_ivp(slope, (0.0, cable.length), [*low, *pull], rtol=1e-10, atol=1e-8, max_step=cable.length / 200).y[:, -1]
    return end[:2], end[2:]


def shot(scene: Scene, guess: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Tensions (x, z) at the lower end and the top of a cable between two held ends."""
    low, top = np.array(scene.lower.position)[[0, 2]], np.array(scene.top.position)[[0, 2]]
    pull = fsolve(lambda force: equilibrium(scene, low, force)[0] - top, guess, xtol=1e-10)
    place, force = equilibrium(scene, low, pull)
    assert place == pytest.approx(top, abs=1e-5)
    return pull, force


def end_forces(found: dict[str, float]) -> tuple[np.ndarray, np.ndarray]:
    """Tensions (x, z) at the lower end and the top: the cable's force on what holds them is the former, and minus the latter."""
    return tuple(sign * np.array([found[f"{end}.force_x"], found[f"{end}.force_z"]]) for end, sign in (("lower", 1.0), ("top", -1.0)))


def test_the_umbilical_hangs_in_its_current_as_the_continuous_equilibrium():
    """Which has no bending; that of the umbilical moves the tension by 1e-5 of itself."""
    scene = example("umbilical", **CALM)
    found = at_rest(scene)
    low, top = shot(scene, np.array([100.0, 100.0]))
    assert end_forces(found)[0] == pytest.approx(low, abs=1e-3 * np.linalg.norm(top))
    assert end_forces(found)[1] == pytest.approx(top, abs=1e-3 * np.linalg.norm(top))
    assert found["top.tension"] == pytest.approx(np.linalg.norm(top), rel=1e-3)


def test_the_lift_weighs_what_hangs_in_air_and_in_the_end_in_water():
    scene = example("lift", **CALM)
    cable, body, g = scene.cable, scene.body, scene.environment.gravity
    assert at_rest(scene)["top.tension"] == pytest.approx(g * (body.mass + cable.mass_per_length * cable.length), rel=1e-9)
    result = simulate(CableChain(scene))
    lowered = result["time"] > 192.0 - 1e-9  # four heaves of 7 s
    dry = scene.top.position[2]
    hanging = -body_force(scene, 0.0)[1] + g * cable.mass_per_length * dry + wet_weight(scene) * (105.0 - dry)
    assert result["top.tension"][lowered][:-1].mean() == pytest.approx(hanging, rel=2e-3)
    assert result["body.z"][lowered].mean() == pytest.approx(-80.0, abs=0.3)


def test_the_mooring_pulls_as_the_catenary_that_touches_down_with_friction():
    scene = example("mooring")
    found = at_rest(scene)
    span, rise = scene.top.position[0], scene.top.position[2] - scene.lower_end.z
    weight, mu = wet_weight(scene), scene.seabed.friction_coefficient
    pull, hanging = touchdown(scene.cable.length, weight, scene.cable.axial_stiffness, span, rise, mu)
    assert -found["top.force_x"] == pytest.approx(pull, rel=1e-3)
    assert -found["top.force_z"] == pytest.approx(weight * hanging, rel=1e-3)
    assert found["top.tension"] == pytest.approx(np.hypot(pull, weight * hanging), rel=1e-3)
    left = pull - mu * weight * (scene.cable.length - hanging)  # at the anchor, whose half cell has no friction
    assert found["body.tension"] == pytest.approx(left, abs=mu * weight * scene.cable.length / (scene.solver.nodes - 1))


def test_the_bank_mooring_goes_from_its_bank_into_catenaries_in_pieces():
    """Without friction T (1 + T/(2 EA)) - w z is the same along what lies; what hangs begins along the bank, a cubic of scipy's."""
    scene = example("bank_mooring", **{"solver.nodes": 141})
    found = at_rest(scene)
    chain, rope, upper = scene.cable.section
    bank = PchipInterpolator(*np.array(scene.seabed.profile).T)
    top = np.array(scene.top.position)[[0, 2]]

    def weighs(part: Any) -> float:
        area = part.volume_per_length if part.volume_per_length >= 0.0 else 0.25 * np.pi * part.diameter**2
        return (part.mass_per_length - scene.water.density * area) * scene.environment.gravity

    def hung(place: np.ndarray, across: float, up: float, part: Any, length: float) -> tuple[np.ndarray, float]:
        weight, ea = weighs(part), part.axial_stiffness
        high = up + weight * length
        x = across * (length / ea + (np.arcsinh(high / across) - np.arcsinh(up / across)) / weight)
        z = (high**2 - up**2) / (2.0 * ea * weight) + (np.hypot(across, high) - np.hypot(across, up)) / weight
        return place + np.array([x, z]), high

    def miss(unknown: np.ndarray) -> np.ndarray:
        at, across = unknown[0], 1e5 * unknown[1]
        place, up = np.array([at, bank(at)]), across * bank(at, 1)
        x = np.linspace(0.0, at, 4001)
        tension, weight, ea = np.hypot(across, up), weighs(chain), chain.axial_stiffness
        energy = tension * (1.0 + tension / (2.0 * ea)) + weight * (bank(x) - bank(at))
        lies = np.trapezoid(np.hypot(1.0, bank(x, 1)) / (np.sqrt(1.0 + 2.0 * energy / ea)), x)
        for part, length in ((chain, chain.length - lies), (rope, rope.length), (upper, upper.length)):
            place, up = hung(place, across, up, part, length)
        forces[:] = across, up
        return place - top

    forces = np.zeros(2)
    at, _ = fsolve(miss, [240.0, 3.0], xtol=1e-10)
    assert -found["top.force_x"] == pytest.approx(forces[0], rel=2e-3)
    assert -found["top.force_z"] == pytest.approx(forces[1], rel=2e-3)
    assert found["seabed.touchdown_x"] == pytest.approx(at, abs=10.0)


def test_the_tow_line_hangs_as_the_continuous_equilibrium_and_nearly_as_a_catenary():
    scene = example("tow_line")
    found = at_rest(scene)
    across, up = between_points(600.0, wet_weight(scene), scene.cable.axial_stiffness, 600.0, -1.0)
    low, top = shot(scene, np.array([across, up - 600.0 * wet_weight(scene)]))
    assert end_forces(found)[0] == pytest.approx(low, abs=1e-3 * np.linalg.norm(top))
    assert end_forces(found)[1] == pytest.approx(top, abs=1e-3 * np.linalg.norm(top))
    assert found["top.tension"] == pytest.approx(np.hypot(across, up), rel=0.05)  # what is dry weighs more, and the current drags


def test_the_tow_line_is_as_stiff_as_a_shallow_parabola():
    """1/k = L/EA + (w L)^2 L/(12 T^3) [DNV-RP-H103, towline stiffness]; of parabolas, with the tow point moved by 0.1 m."""
    scene = example("tow_line")
    pulls = [-at_rest(with_values(scene, {"top.position": [x, 0.0, 3.0]}))["top.force_x"] for x in (599.9, 600.0, 600.1)]
    length, weight = scene.cable.length, wet_weight(scene)
    flexible = length / scene.cable.axial_stiffness + (weight * length) ** 2 * length / (12.0 * pulls[1] ** 3)
    assert (pulls[2] - pulls[0]) / 0.2 == pytest.approx(1.0 / flexible, rel=0.05)


def test_the_towed_array_streams_as_the_continuous_equilibrium_behind_its_drogue():
    scene = example("towed_array")
    found = at_rest(scene)
    place, force = equilibrium(scene, np.array([0.0, -30.0]), -body_force(scene, -30.0))
    assert [found["body.x"], found["body.z"] + 10.0] == pytest.approx([-place[0], -30.0 - place[1]], abs=1e-3 * 300.0)
    assert found["top.tension"] == pytest.approx(np.linalg.norm(force), rel=1e-3)
    # by hand: friction of 300 m and the drogue's drag
    assert found["top.tension"] == pytest.approx(0.5 * 1025.0 * 2.5**2 * (0.01 * 0.05 * 300.0 + 0.1), rel=0.02)


def test_the_floats_of_the_instrument_mooring_lie_as_the_continuous_equilibrium_in_the_current():
    scene = example("instrument_mooring", **{"waves.amplitude": 0.0})
    found = at_rest(scene)

    def miss(z: float) -> float:
        return equilibrium(scene, np.array([0.0, z]), -body_force(scene, z))[0][1] + 200.0

    z = brentq(miss, -60.0, -40.0)
    place, force = equilibrium(scene, np.array([0.0, z]), -body_force(scene, z))
    assert [found["body.x"], found["body.z"]] == pytest.approx([-place[0], z], abs=1e-3 * 160.0)
    assert found["top.tension"] == pytest.approx(np.linalg.norm(force), rel=1e-3)


@pytest.mark.parametrize("name", NAMES)
def test_the_ends_of_an_example_begin_at_rest(name: str):
    """A spline through sparse rows of a table does not: 0.13 m/s at a vehicle were 150 N in the umbilical, of 400 N, without a warning."""
    start = motion_of(load(name))(0.0, 1)
    assert np.abs(start[[3, 4, 5, 13, 14, 15]]).max() < 1e-3


def top_tension(result: Result) -> np.ndarray:
    return np.array([result["top.tension"].min(), result["top.tension"].max()])


@pytest.mark.parametrize("name", [pytest.param(name, marks=pytest.mark.long) if name in IRREGULAR else name for name in NAMES])
def test_an_example_runs_without_a_warning_and_changes_by_halving_as_it_says(name: str):
    text = Path(shipped()[name]).read_text(encoding="utf-8")
    (said,) = re.findall(r"(?m)^# halving the cells and the step changes .* by less than ([0-9.]+) % of that range$", text)
    scene = load(name)
    solver = scene.solver
    result = simulate(CableChain(scene))
    finer = simulate(CableChain(with_values(scene, {"solver.nodes": 2 * solver.nodes - 1, "solver.time_step": 0.5 * solver.time_step})))
    assert [text for run in (result, finer) for text in run.warnings if not text.startswith("cable parted at t = ")] == []
    ends = top_tension(result)
    assert np.abs(top_tension(finer) - ends).max() < 0.01 * float(said) * np.ptp(ends)
