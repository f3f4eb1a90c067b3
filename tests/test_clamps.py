"""Clamped ends against beams: cantilevers, taut and built-in beams, their moments, their modes and their balances."""

import numpy as np
import pytest
from chain_support import drive, every, make, still, swing, view
from scipy.integrate import solve_bvp

from cable_model import simulate
from cable_model.errors import ParameterError
from cable_model.kernels.build import build
from cable_model.kernels.cells import turn_stiffness
from cable_model.kernels.clamps import BELOW, TOP, clamp_of
from cable_model.signals import OUTPUTS

GRAVITY = 9.81
BEAM = {  # 2 m, held at its top so that it leaves it level along x
    "cable": {"length": 2.0, "mass_per_length": 0.05, "axial_stiffness": 1e6, "bending_stiffness": 10.0},
    "environment": {"gravity": GRAVITY},
    "top": {"clamped": True, "clamp_declination": np.pi / 2.0},
    "solver": {"nodes": 21, "grading": 1.0, "time_step": 0.01, "lambda_infinity": -0.5},
}
HUNG = {  # 1 t on 10 m of a stiff cable without weight, which leaves its top at 0.05 rad
    "cable": {"length": 10.0, "mass_per_length": 1e-3, "axial_stiffness": 1e8},
    "environment": {"gravity": GRAVITY}, "body": {"mass": 1000.0},
    "top": {"clamped": True, "clamp_declination": 0.05},
    "solver": {"nodes": 41, "grading": 1.0},
}  # fmt: skip


def at_rest(model, place=(0.0, 0.0, 0.0)) -> dict[str, float]:
    model.initialize(still(place)(0.0))
    return dict(zip(OUTPUTS, model.outputs.tolist(), strict=True))


def weights(model) -> np.ndarray:
    """Of the cable that nodes carry, N."""
    mesh = view(model).mesh
    lengths = np.append(mesh[:, 0] * mesh[:, 1], 0.0) + np.insert(mesh[:, 0] * (1.0 - mesh[:, 1]), 0, 0.0)
    return GRAVITY * 0.05 * lengths


def elastica(length: float, weight: float, bending: float, tip: float) -> tuple[float, float, float, float]:
    """Place (x, z) of the free end and moment at the clamp, N m, of an inextensible beam that begins level and carries `tip` at its end.

    With the angle a below the level EI a'' = -V cos a, V the weight beyond s: the moment EI a' falls from the clamp to nothing.
    """

    def slope(s: np.ndarray, y: np.ndarray) -> np.ndarray:
        angle, turn = y[0], y[1]
        return np.array([turn, -(tip + weight * (length - s)) * np.cos(angle) / bending, np.cos(angle), -np.sin(angle)])

    s = np.linspace(0.0, length, 201)
    found = solve_bvp(
        slope, lambda a, b: np.array([a[0], a[2], a[3], b[1]]), s, np.zeros((4, s.size)) + 0.1 * s, tol=1e-9, max_nodes=100000
    )
    assert found.success
    return found.y[2, -1], found.y[3, -1], bending * found.y[1, 0], found.y[0, -1]


@pytest.mark.parametrize(("bending", "mass"), [(10.0, 0.0), (1.0, 0.0), (0.3, 0.0), (1.0, 0.1)])
def test_a_cantilever_sags_as_the_elastica(bending, mass):
    """From 5 % of its length to a beam that hangs nearly straight down."""
    body = {"body__mass": mass} if mass else {}
    x, z, moment, _ = elastica(2.0, 0.05 * GRAVITY, bending, mass * GRAVITY)
    errors = []
    for nodes in (11, 21, 41):
        model = make(BEAM, cable__bending_stiffness=bending, solver__nodes=nodes, **body)
        found = at_rest(model)
        errors.append(np.hypot(found["body.x"] - x, found["body.z"] - z))
        assert found["top.moment_y"] == pytest.approx(moment, rel=6.0 / nodes**2)
        assert found["cable.bending_moment_max"] == pytest.approx(found["top.moment_y"], rel=1e-2)
        # and in balance with the weights, whatever the mesh
        carried = weights(model)
        carried[0] += mass * GRAVITY
        assert found["top.moment_y"] == pytest.approx(np.sum(carried * model.positions()[:, 0]), rel=1e-6)
    assert errors[-1] < 2e-3
    assert np.log2(errors[0] / errors[1]) > 1.8 and np.log2(errors[1] / errors[2]) > 1.9


@pytest.mark.parametrize("grading", [1.0, 2.0, 4.0])
def test_a_moment_is_in_balance_with_the_weights_on_any_mesh(grading):
    model = make(BEAM, cable__bending_stiffness=0.5, solver__grading=grading, top__clamp_declination=2.4)
    found = at_rest(model)
    assert np.ptp(view(model).mesh[:, 0]) > 1e-3 or grading == 1.0
    assert found["top.moment_y"] == pytest.approx(np.sum(weights(model) * model.positions()[:, 0]), rel=1e-6)


@pytest.mark.plain
@pytest.mark.parametrize("grading", [1.0, 4.0])
def test_the_flexibilities_of_clamps_and_nodes_add_up_to_that_of_the_cable(grading):
    """Turns under one moment all along: of the halves of cells at both clamps and about each node, L/EI in all."""
    pieces = [{"length": 0.7, "bending_stiffness": 4.0}, {"length": 1.3, "bending_stiffness": 10.0}]
    model = make(
        BEAM, cable__section=pieces, solver__grading=grading, lower_end__anchored=True, lower_end__clamped=True, lower_end__x=1.9,
    )  # fmt: skip
    at_rest(model)
    parts, mesh = model.parts, view(model).mesh
    problem = build(parts, model.numbers, 0.0)
    turns = sum(1.0 / turn_stiffness(parts.sections, parts, problem, mesh, j) for j in range(1, mesh.shape[0]))
    turns += sum(1.0 / clamp_of(upper, parts, problem, mesh).stiffness for upper in (BELOW, TOP))
    assert turns == pytest.approx(0.7 / 4.0 + 1.3 / 10.0, rel=1e-12)


@pytest.mark.parametrize("nodes", [21, 41])
def test_a_beam_that_leaves_its_clamp_upwards_is_pressed_by_what_it_carries(nodes):
    """N of the cell at the clamp, t.F with F the weight of all nodes but the top."""
    model = make(BEAM, cable__bending_stiffness=0.5, solver__nodes=nodes, top__clamp_declination=2.4)
    found = at_rest(model)
    across = np.diff(model.positions(), axis=0)[-1]
    pressed = np.sum(weights(model)[:-1]) * across[2] / np.linalg.norm(across)
    assert pressed < -0.2
    assert found["cable.tension_min"] == pytest.approx(pressed, rel=1e-4)


@pytest.mark.parametrize("nodes", [11, 41, 161])
def test_a_straight_cable_that_is_stretched_does_not_bend(nodes):
    soft = {**HUNG, "top": {"clamped": True}}
    result = simulate(make(soft, cable__axial_stiffness=3e5, cable__bending_stiffness=1000.0, solver__nodes=nodes), duration=0.02)
    assert result.warnings == ()
    assert result["cable.bending_moment_max"] == pytest.approx(0.0, abs=1e-3)
    model = make(soft, cable__axial_stiffness=3e5, cable__bending_stiffness=1000.0, solver__nodes=nodes)
    at_rest(model)
    assert np.linalg.norm(np.diff(model.positions(), axis=0), axis=1) == pytest.approx([10.327 / (nodes - 1)] * (nodes - 1), rel=1e-4)


@pytest.mark.parametrize("reach", [2.0, 1.0, 0.5])
def test_a_taut_cable_turns_from_its_clamp_within_the_root_of_bending_over_tension(reach):
    """M = phi sqrt(EI T), and the body hangs phi sqrt(EI/T) aside; the cells' share of it is 0.12 of its square."""
    tension = 1000.0 * GRAVITY
    found = at_rest(make(HUNG, cable__bending_stiffness=tension * reach**2))
    error = 0.13 * (0.25 / reach) ** 2
    end = np.tanh(10.0 / reach)
    assert found["top.moment_y"] == pytest.approx(0.05 * tension * reach * end, rel=error)
    assert found["body.x"] == pytest.approx(0.05 * reach * end, rel=error)
    assert found["top.tension"] == pytest.approx(tension * np.cos(0.05), rel=1e-4)  # along the clamp
    assert found["top.declination"] == pytest.approx(0.05, abs=1e-12)


@pytest.mark.parametrize(("nodes", "told"), [(41, False), (15, True)])
def test_cells_that_do_not_resolve_the_bend_are_told(nodes, told):
    result = simulate(make(HUNG, cable__bending_stiffness=1000.0 * GRAVITY, solver__nodes=nodes), duration=0.05)
    assert [text.endswith("or the last metres a cable.section of their own.") for text in result.warnings] == [True] * told


@pytest.mark.parametrize("declination", [1.6, 2.5, 3.0])
def test_a_clamp_that_leans_against_its_load_is_told_where_cells_are_too_long(declination):
    """The tension along it is then small, or negative."""
    model = make(HUNG, cable__bending_stiffness=500.0, top__clamp_declination=declination, solver__nodes=21)
    assert len([text for text in simulate(model, duration=0.01).warnings if "at a clamped end: cells there are too long" in text]) == 1


def test_cells_that_do_not_resolve_the_bend_at_an_anchor_are_told():
    model = make({
        **HUNG, "body": {}, "top": {}, "cable": {**HUNG["cable"], "bending_stiffness": 300.0},
        "lower_end": {"anchored": True, "clamped": True, "clamp_declination": 0.05, "z": -10.01},
    })  # fmt: skip
    (warning,) = simulate(model, duration=0.05).warnings
    assert "rad in half a cell of 0.25 m at a clamped end" in warning


@pytest.mark.parametrize("space", [False, True])
def test_a_beam_built_in_at_both_ends_has_their_moments(space):
    """w L^2/12 at both, f = w L^4/(384 EI): a beam that nothing stretches."""
    level = {"clamped": True, "clamp_declination": np.pi / 2.0, "clamp_direction": np.pi}
    changes = {"solver__space": space, "cable__bending_stiffness": 1000.0}
    model = make({**BEAM, "top": level, "lower_end": {**level, "anchored": True, "clamp_direction": 0.0}}, **changes)
    found = at_rest(model, (2.0, 0.0, 0.0))
    moment = 0.05 * GRAVITY * 4.0 / 12.0
    assert found["top.moment_y"] == pytest.approx(-moment, rel=5e-3)
    assert found["lower.moment_y"] == pytest.approx(moment, rel=5e-3)
    assert model.positions()[10, 2] == pytest.approx(-0.05 * GRAVITY * 16.0 / (384.0 * 1000.0), rel=2e-2)
    assert [found[f"{end}.moment_{axis}"] for end in ("top", "lower") for axis in "xz"] == pytest.approx([0.0] * 4, abs=1e-9)


def test_which_way_a_clamp_turns_makes_no_difference():
    base = {**BEAM, "cable": {**BEAM["cable"], "bending_stiffness": 0.5}, "top": {"clamped": True, "clamp_declination": 1.1}}
    plane, turned = at_rest(make(base)), at_rest(make(base, top__clamp_direction=0.8, solver__space=True))
    c, s = np.cos(0.8), np.sin(0.8)
    assert [turned[f"body.{k}"] for k in "xyz"] == pytest.approx([c * plane["body.x"], s * plane["body.x"], plane["body.z"]], abs=1e-6)
    moment = plane["top.moment_y"]
    assert [turned[f"top.moment_{k}"] for k in "xyz"] == pytest.approx([-s * moment, c * moment, 0.0], abs=1e-6)


def test_the_end_that_is_called_top_makes_no_difference():
    """A cable between two clamps, once each way round."""
    ends = ((0.0, 0.0, 0.0), (1.6, 0.0, 0.3))
    cable, solver = {**BEAM["cable"], "bending_stiffness": 0.5}, {**BEAM["solver"], "slack_smoothing": 1e-4}
    common = {"cable": cable, "environment": BEAM["environment"], "solver": solver}
    one = make({
        **common, "top": {"clamped": True, "clamp_declination": 0.3, "clamp_direction": np.pi},
        "lower_end": {"anchored": True, "clamped": True, "clamp_declination": 2.5, "x": ends[0][0], "z": ends[0][2]},
    })  # fmt: skip
    other = make({
        **common, "top": {"clamped": True, "clamp_declination": np.pi - 2.5},
        "lower_end": {
            "anchored": True, "clamped": True, "clamp_declination": np.pi - 0.3, "clamp_direction": np.pi, "x": ends[1][0], "z": ends[1][2],
        },
    })  # fmt: skip
    found, turned = at_rest(one, ends[1]), at_rest(other, ends[0])
    assert other.positions()[::-1] == pytest.approx(one.positions(), abs=2e-5)
    assert turned["top.moment_y"] == pytest.approx(found["lower.moment_y"], rel=1e-3)
    assert turned["lower.moment_y"] == pytest.approx(found["top.moment_y"], rel=1e-3)
    assert turned["top.tension"] == pytest.approx(found["body.tension"], abs=2e-3)
    assert turned["body.tension"] == pytest.approx(found["top.tension"], abs=2e-3)


@pytest.mark.parametrize(("modes", "both"), [(3.5160, False), (22.373, True)])
def test_a_beam_swings_with_its_own_frequency(modes, both):
    """omega = c sqrt(EI/(m L^4)): shaken at it, it takes the motion up fastest; measured by its free swings after the top has stopped."""
    omega = modes * np.sqrt(10.0 / (0.05 * 2.0**4))
    turned = {"clamped": True, "clamp_declination": np.pi / 2.0, "clamp_direction": np.pi}
    base = {**BEAM, "top": {**turned, "clamp_direction": np.pi if both else 0.0}}
    if both:
        base["lower_end"] = {**turned, "anchored": True, "clamp_direction": 0.0}
    model = make(
        base, environment__gravity=0.0, solver__lambda_infinity=-1.0, solver__time_step=2.0 * np.pi / omega / 100.0,
        cable__compressible=True,
    )  # fmt: skip
    place = np.array([2.0 if both else 0.0, *[0.0] * 8])
    period, step = 2.0 * np.pi / omega, 2.0 * np.pi / omega / 100.0

    def push(t: float) -> np.ndarray:
        """One smooth jolt of the top, of half a period."""
        s = min(t / (0.5 * period), 1.0)
        state = place.copy()
        state[2] = 1e-4 * s**3 * (10.0 - 15.0 * s + 6.0 * s * s)
        state[5] = 1e-4 * 30.0 * (s - s * s) ** 2 / (0.5 * period) if s < 1.0 else 0.0
        return state

    heights = []
    drive(model, every(step, 8.0 * period), push, lambda t: heights.append(model.positions()[10 if both else 0, 2] - 1e-4))
    swing_of = np.array(heights)[60:]
    middle = swing_of - swing_of.mean()
    k = np.nonzero((middle[:-1] < 0.0) & (middle[1:] >= 0.0))[0]
    crossed = (k + middle[k] / (middle[k] - middle[k + 1])) * step
    assert 2.0 * np.pi / np.diff(crossed).mean() == pytest.approx(omega, rel=0.02)


def test_energy_and_momentum_close_between_two_clamps():
    found = []
    base = {
        **BEAM, "top": {"clamped": True, "clamp_declination": 0.8, "clamp_direction": np.pi},
        "lower_end": {"anchored": True, "clamped": True, "clamp_declination": 0.5},
    }  # fmt: skip
    for step in (0.01, 0.005):
        model = make(
            base, cable__bending_stiffness=1.0, cable__axial_stiffness=1e3, solver__nodes=11, solver__time_step=step, solver__audit=True,
            solver__slack_damping=0.0,
        )  # fmt: skip
        motion = swing((0.02, 0.0, 0.03), 6.0, ramp_time=0.5)
        drive(model, every(step, 2.0), lambda t, motion=motion: motion(t) + np.array([0.8, 0.0, 1.4, *[0.0] * 6]))
        found.append(model.audit)
    coarse, fine = found
    assert fine.energy_share < 1e-3 and fine.momentum_share < 1e-4
    assert abs(fine.energy) < 0.4 * abs(coarse.energy)
    assert fine.momentum < 0.4 * coarse.momentum


@pytest.mark.parametrize(
    ("changes", "text"),
    [
        ({"cable__bending_stiffness": 0.0}, "top.clamped = True: must be false without bending stiffness"),
        ({"top__clamped": False}, "top.clamp_declination = .*: must be 0 where nothing clamps the end"),
        ({"top__clamp_direction": 0.5}, "top.clamp_direction = 0.5 rad: must be 0 or pi in the plane"),
        ({"lower_end__clamped": True}, "lower_end.clamped = True: must be false for an end that nothing holds"),
        ({"solver__grid": "box"}, "top.clamped"),
        ({"top__clamp_declination": 45.0}, "top.clamp_declination = 45 rad: must be >= 0 and <= 6.284"),
    ],
)
def test_what_cannot_be_clamped_is_refused(changes, text):
    with pytest.raises(ParameterError, match=text):
        make(BEAM, **changes)


@pytest.mark.parametrize(
    ("place", "named"), [({"top": {"clamped": True}}, 1), ({"lower_end": {"anchored": True, "clamped": True, "z": -2.0}}, 0)]
)
def test_a_section_that_does_not_bend_can_not_be_clamped(place, named):
    pieces = [{"length": 1.0, "mass_per_length": 0.05, "axial_stiffness": 1e6, "bending_stiffness": 5.0 * (k != named)} for k in range(2)]
    with pytest.raises(ParameterError, match=rf"clamped = True: must be false where cable.section\[{named}\] has no bending stiffness"):
        make({"cable": {"section": pieces}, "solver": {"nodes": 11}, **place})


# -- springs and dampers as sections

SPRING = {"length": 1.0, "mass_per_length": 0.1, "axial_stiffness": 5e4, "axial_damping": 0.0}
SPRUNG = {  # 1 t on 50 m of wire below a spring
    "cable": {"section": [{"length": 50.0, "mass_per_length": 0.5, "axial_stiffness": 2e7}, SPRING]},
    "environment": {"gravity": GRAVITY}, "body": {"mass": 1000.0},
    "solver": {"nodes": 9, "lambda_infinity": -1.0, "time_step": 0.01, "slack_damping": 0.0},
}  # fmt: skip


@pytest.mark.parametrize("damping", [0.0, 2000.0])
def test_a_section_is_a_spring_at_the_end_and_a_damper(damping):
    """The load's place at rest, and its bounce after a jolt: omega^2 = k/M (1 - zeta^2), with its decrement."""
    spring = {**SPRING, "axial_damping": damping}
    model = make(SPRUNG, cable__section=[SPRUNG["cable"]["section"][0], spring])
    weight, hung = 1000.0 * GRAVITY, 25.1 * GRAVITY
    found = at_rest(model)
    stretch = (weight + 0.5 * 25.0 * GRAVITY) / 2e7 * 50.0 + (weight + hung) / 5e4
    assert found["body.z"] == pytest.approx(-51.0 - stretch, abs=1e-4)
    k, mass = 1.0 / (1.0 / 5e4 + 50.0 / 2e7), 1000.0 + 25.0 * (1.0 - 0.5 * 5e4 / (2e7 / 50.0))
    omega, zeta = np.sqrt(k / mass), damping * (k / 5e4) ** 2 / (2.0 * np.sqrt(k * mass))
    step = 0.01

    def jolt(t: float) -> np.ndarray:
        s = min(t / 0.3, 1.0)
        state = np.zeros(9)
        state[2] = 0.05 * s**3 * (10.0 - 15.0 * s + 6.0 * s * s)
        state[5] = 0.05 * 30.0 * (s - s * s) ** 2 / 0.3 if s < 1.0 else 0.0
        return state

    heights = drive(model, every(step, 6.0), jolt)["body.z"][40:] - found["body.z"] - 0.05
    peaks = np.nonzero((heights[1:-1] > heights[:-2]) & (heights[1:-1] >= heights[2:]))[0] + 1
    assert np.diff(peaks).mean() * step == pytest.approx(2.0 * np.pi / (omega * np.sqrt(1.0 - zeta**2)), rel=0.01)
    decrement = np.log(heights[peaks[0]] / heights[peaks[-1]]) / (len(peaks) - 1)
    assert decrement == pytest.approx(2.0 * np.pi * zeta / np.sqrt(1.0 - zeta**2), abs=0.02 * max(zeta, 0.01) * 2.0 * np.pi + 2e-3)
