"""The chain on a seabed that is not level: a slope, a profile and a grid against closed forms, invariances and one another."""

import numpy as np
import pytest
from chain_support import drive, every, make, scene_of, still, swing, view
from scipy.optimize import fsolve

from cable_model import simulate
from cable_model.doubts import before_the_run
from cable_model.errors import ParameterError
from cable_model.kernels.bottom import shape_at
from cable_model.signals import OUTPUTS
from cable_model.tables import relief

WEIGHT, STIFFNESS, LENGTH = 0.08 * 9.81, 1e4, 33.0  # N/m, N, m
MOORING = {
    "cable": {"length": LENGTH, "mass_per_length": 0.08, "axial_stiffness": STIFFNESS, "diameter": 0.0022},
    "lower_end": {"anchored": True, "z": -3.0},
    "environment": {"gravity": 9.81},
    "seabed": {"level": -3.0, "stiffness": 3e9},
    "solver": {"nodes": 51, "time_step": 0.01, "lambda_infinity": -0.5},
}
TOP = (32.3, 0.0, 0.3)
HILLS = [[-5.0, -3.2], [3.0, -3.0], [10.0, -2.2], [16.0, -2.9], [22.0, -2.5], [40.0, -4.0]]
LYING = {  # 10 m of cable straight on a slope, held by its top
    "cable": {"length": 10.0, "mass_per_length": 2.0, "axial_stiffness": 1e6, "diameter": 0.02},
    "environment": {"gravity": 10.0},
    "seabed": {"level": 0.0, "stiffness": 1e6},
    "solver": {"nodes": 11, "grading": 1.0, "time_step": 0.01, "lambda_infinity": -0.5},
}


def told(model, name: str) -> float:
    return model.outputs[OUTPUTS.index(name)]


def over_slope(slope: float) -> tuple[float, ...]:
    """Force at the top along x and z, N, where the cable touches down, m along x, and its tension at the anchor, N.

    It is an elastic catenary that goes over into a slope.  Without friction the tension of what lies falls by its weight along the slope.
    """
    angle = np.arctan(slope)
    span, rise = TOP[0], TOP[2] + 3.0

    def parts(unknown: np.ndarray) -> tuple[float, ...]:
        pull, hangs = np.exp(unknown[0]), LENGTH / (1.0 + np.exp(-unknown[1]))
        low, high = pull * slope, pull * slope + WEIGHT * hangs
        lies = LENGTH - hangs
        x = pull * hangs / STIFFNESS + pull / WEIGHT * (np.arcsinh(high / pull) - np.arcsinh(low / pull))
        z = (high**2 - low**2) / (2.0 * STIFFNESS * WEIGHT) + (np.hypot(pull, high) - np.hypot(pull, low)) / WEIGHT
        on_it = lies * (1.0 + pull / np.cos(angle) / STIFFNESS) - WEIGHT * np.sin(angle) * lies**2 / (2.0 * STIFFNESS)
        return (
            x + on_it * np.cos(angle) - span,
            z + on_it * np.sin(angle) - rise,
            pull,
            high,
            on_it * np.cos(angle),
            pull / np.cos(angle) - WEIGHT * np.sin(angle) * lies,
        )

    found = fsolve(lambda unknown: parts(unknown)[:2], [np.log(0.1 * WEIGHT * LENGTH), 0.0], xtol=1e-13)
    off_x, off_z, *told = parts(found)
    assert max(abs(off_x), abs(off_z)) < 1e-9
    return tuple(told)


def as_heights(slope: float, across: float = 0.0) -> dict[str, dict[str, object]]:
    """The same plane by a profile and by grids, of even and uneven rows; `across` is its slope along y."""
    ends = [(-5.0, -1.0), (7.0, 2.0), (40.0, 5.0)]
    grid = [[x, y, -3.0 + slope * x + across * y] for x, _ in ends for _, y in ends]
    return {
        "profile": {"seabed__level": 0.0, "seabed__profile": [[x, -3.0 + slope * x] for x, _ in ends]},
        "grid": {"seabed__level": 0.0, "seabed__grid": grid, "solver__space": True},
        "grid from its end": {"seabed__level": 0.0, "seabed__grid": grid[::-1], "solver__space": True},
    }


@pytest.mark.parametrize("slope", [0.05, -0.05, -0.2])
def test_a_mooring_over_a_slope_is_the_catenary_that_goes_over_into_it(slope):
    pull, lift, touches, held = over_slope(slope)
    for nodes in (51, 101):
        model = make(MOORING, seabed__slope=slope, solver__nodes=nodes)
        model.initialize(still(TOP)(0.0))
        bend = (pull / WEIGHT) / (LENGTH / (nodes - 1))  # cells in the bend at touchdown, which falls anywhere in a cell
        assert np.hypot(-model.outputs[0] - pull, -model.outputs[2] - lift) < 1.0 / bend**2 * np.hypot(pull, lift)
        assert told(model, "seabed.touchdown_x") == pytest.approx(touches, abs=LENGTH / (nodes - 1))
        assert told(model, "seabed.touchdown_z") == pytest.approx(-3.0 + slope * told(model, "seabed.touchdown_x"), abs=0.01)
        long = LENGTH / (nodes - 1)
        lies = touches * np.hypot(1.0, slope) - 0.5 * long  # the anchor holds half a cell
        assert model.outputs[11] == pytest.approx(held, abs=1.0 / bend**2 * np.hypot(pull, lift))
        assert told(model, "seabed.force_z") == pytest.approx(WEIGHT * lies / (1.0 + slope**2), abs=0.5 * WEIGHT * long)
        for heights in as_heights(slope).values():
            other = make(MOORING, solver__nodes=nodes, **heights)
            other.initialize(still(TOP)(0.0))
            assert other.outputs == pytest.approx(model.outputs, abs=2e-6)


@pytest.mark.parametrize("nodes", [51, 101, 201])
def test_without_friction_tension_less_weight_times_height_is_the_same_all_along_any_bottom(nodes):
    """As a cable stretches, T (1 + T/(2 EA)) - w z; touchdown falls anywhere in a cell h, of height h^2/(8 R), at both ends and on crests.

    R = 15 m is where it leaves the bottom, H/w.
    """
    lost = WEIGHT * (LENGTH / (nodes - 1)) ** 2 / (8.0 * 15.0)

    def differs(model) -> float:
        low, high = (tension * (1.0 + tension / (2.0 * STIFFNESS)) for tension in model.outputs[[11, 3]])
        return abs(high - low - WEIGHT * 3.3)

    model = make(MOORING, seabed__level=0.0, seabed__profile=HILLS, solver__nodes=nodes, seabed__stiffness=3e8)
    model.initialize(still(TOP)(0.0))
    assert differs(model) < 3.0 * lost
    model = make(
        MOORING, solver__nodes=nodes, solver__space=True, seabed__stiffness=3e8, seabed__level=0.0,
        seabed__grid=[[x, y, z + 0.02 * y * (1.0 + 0.05 * x)] for x, z in HILLS for y in (-8.0, -1.0, 3.0, 9.0)],
    )  # fmt: skip
    model.initialize(still((32.0, 1.0, 0.3))(0.0))
    x, y, _ = model.positions().T
    assert np.abs(y - x / 32.0).max() > 0.3  # it does not lie straight
    assert differs(model) < 3.0 * lost


def test_a_cable_over_a_hump_is_pressed_by_its_tension_over_the_radius_as_well():
    """On the top of a circle of radius R the bottom carries w + T/R per metre, in a hollow w - T/R."""
    radius, pull = 200.0, 60.0
    for bend in (-1.0, 1.0):
        x = np.linspace(-20.0, 20.0, 41)
        model = make(
            MOORING, cable__length=30.0, lower_end__x=-15.0, lower_end__z=bend * 15.0**2 / (2.0 * radius), seabed__stiffness=1e7,
            seabed__profile=np.column_stack((x, bend * (radius - np.sqrt(radius**2 - x**2)))).tolist(), seabed__level=0.0,
        )  # fmt: skip
        model.initialize(still((15.05 + 30.0 * pull / STIFFNESS, 0.0, bend * 15.0**2 / (2.0 * radius)))(0.0))
        middle = np.abs(model.positions()[:-1, 0]) < 5.0
        contact, mesh = view(model).scratch.contact[:50, 0], view(model).mesh
        carried = 0.5 * (mesh[:, 0] + np.roll(mesh[:, 0], 1))
        tension = model.outputs[12]
        assert 0.8 * pull < tension < 1.6 * pull
        assert (contact / carried)[middle].mean() == pytest.approx(WEIGHT - bend * tension / radius, rel=0.03)


@pytest.mark.parametrize("slope", [0.1, -0.3])
def test_which_way_a_slope_rises_makes_no_difference_but_for_the_way(slope):
    plane = make(MOORING, seabed__slope=slope)
    plane.initialize(still(TOP)(0.0))
    turned = make(MOORING, seabed__slope=-slope, seabed__slope_direction=0.7 + np.pi, solver__space=True)
    turned.initialize(still((TOP[0] * np.cos(0.7), TOP[0] * np.sin(0.7), TOP[2]))(0.0))
    assert turned.outputs[[0, 1]] == pytest.approx(plane.outputs[0] * np.array([np.cos(0.7), np.sin(0.7)]), abs=1e-6)
    assert turned.outputs[[2, 3, 4, 11, 12]] == pytest.approx(plane.outputs[[2, 3, 4, 11, 12]], abs=1e-6)
    away = make(MOORING, seabed__slope=slope, lower_end__z=-3.0 - 7.0 * slope, lower_end__x=-7.0, seabed__slope_direction=0.0)
    away.initialize(still((TOP[0] - 7.0, 0.0, TOP[2] - 7.0 * slope))(0.0))
    assert away.outputs[[0, 2, 3, 4, 11]] == pytest.approx(plane.outputs[[0, 2, 3, 4, 11]], abs=1e-6)


def down(slope: float, acceleration: float, length: float = 10.0, sunk: float = 0.0):
    """The top of a cable that lies down a slope from it moves down with this acceleration along it."""
    c = 1.0 / np.hypot(1.0, slope)
    way = np.array([-c, 0.0, -c * slope])

    def motion(t: float) -> np.ndarray:
        place = 0.5 * acceleration * t * t * way - sunk * np.array([-c * slope, 0.0, c])
        return np.concatenate([place, acceleration * t * way, acceleration * way])

    return motion


@pytest.mark.parametrize(("friction", "by"), [(0.0, "slope"), (0.0, "profile"), (0.2, "slope"), (0.2, "profile")])
def test_a_cable_that_slides_down_as_a_block_does_is_not_pulled(friction, by):
    """Its top led down with g (sin - mu cos), the cable follows of its own, straight: the top pulls the half cell that it holds itself.

    Let go from the tension of its own weight it recoils by its stretch, at most T/sqrt(EA m) fast.
    """
    slope = 0.5
    c = 1.0 / np.hypot(1.0, slope)
    sunk = 20.0 * c / (1e6 * 0.02)
    changes = {"seabed__slope": slope} if by == "slope" else {"seabed__profile": [[-60.0, -30.0], [-9.0, -4.5], [1.0, 0.5]]}
    model = make(LYING, **changes, seabed__friction_coefficient=friction, seabed__friction_displacement=1e-4)
    motion = down(slope, 10.0 * c * (slope - friction), sunk=sunk)
    drive(model, every(0.05, 2.0), motion)
    weight = 2.0 * 10.0 * 10.0
    assert told(model, "seabed.force_z") == pytest.approx(0.95 * weight * c * c, rel=2e-3)  # the top holds half a cell
    assert model.outputs[3] == pytest.approx(0.05 * weight * c * friction, abs=1e-3 * weight)
    from_top = model.positions()[0] - motion(2.0)[:3]
    assert from_top[2] / from_top[0] == pytest.approx(slope, rel=1e-3)
    assert 10.0 - 2.0 * weight * c * slope / np.sqrt(1e6 * 2.0) < np.linalg.norm(from_top) < 10.0


@pytest.mark.parametrize("up", [1.0, -1.0])
def test_dragging_along_a_slope_takes_friction_and_the_share_of_weight(up):
    slope, friction = 0.2, 0.5
    c = 1.0 / np.hypot(1.0, slope)
    way = up * np.array([c, 0.0, c * slope])
    start = still(tuple(20.0 * c / (1e6 * 0.02) * np.array([c * slope, 0.0, -c])))(0.0)
    # it lies below its top, as it comes to rest, and is dragged up; or above it, held there until the start, and is dragged down
    model = make(
        LYING, seabed__slope=slope, seabed__friction_coefficient=friction, lower_end__release_force=0.0 if up > 0.0 else 300.0,
    )  # fmt: skip

    def motion(t: float) -> np.ndarray:
        s = min(t / 2.0, 1.0)
        far, rate, change = 0.5 * (s**3 - 0.5 * s**4) + 0.25 * max(t - 2.0, 0.0), 0.25 * (3.0 * s**2 - 2.0 * s**3), 0.75 * (s - s**2)
        return start + np.concatenate([far * way, rate * way, change * way])

    drive(model, every(0.05, 6.0), motion)
    assert model.outputs[3] == pytest.approx(200.0 * c * (0.95 * friction + up * slope), rel=5e-3)  # the top holds half a cell


# -- the shape


def test_a_bottom_goes_through_its_heights_and_never_beyond_them():
    scene = scene_of(MOORING, seabed__level=0.0, seabed__profile=HILLS)
    table = relief(scene)
    x, z = np.array(HILLS).T
    assert [shape_at(table, at, 0.0)[0] for at in x] == pytest.approx(z)
    for k in range(len(x) - 1):
        between = [shape_at(table, at, 0.0)[0] for at in np.linspace(x[k], x[k + 1], 50)]
        assert np.all(np.diff(between) * np.sign(z[k + 1] - z[k]) >= -1e-12)
    beyond = [shape_at(table, at, 0.0)[:2] for at in (-25.0, -15.0)]
    assert beyond[0][1] == beyond[1][1] == pytest.approx(0.2 / 8.0)  # straight on
    assert beyond[1][0] - beyond[0][0] == pytest.approx(10.0 * 0.2 / 8.0)


@pytest.mark.parametrize("place", [(1.3, 0.4), (-0.9, -2.0), (2.0, 0.0), (4.5, 3.3), (-3.0, 5.0)])
def test_slopes_and_curvatures_are_the_derivatives_of_the_height(place):
    rows = [[x, y, np.sin(x) * np.cos(0.7 * y) + 0.1 * x * y] for x in (-2.0, -0.5, 0.1, 1.7, 3.0) for y in (-2.5, 0.2, 1.0, 2.0)]
    table = relief(scene_of(MOORING, seabed__level=0.0, seabed__grid=rows, solver__space=True))
    x, y = place
    e = 1e-6
    ahead, behind, left, right = (shape_at(table, x + dx, y + dy) for dx, dy in ((e, 0.0), (-e, 0.0), (0.0, e), (0.0, -e)))
    _, bx, by, bxx, bxy, byy = shape_at(table, x, y)
    assert [bx, by] == pytest.approx([(ahead[0] - behind[0]) / 2e-6, (left[0] - right[0]) / 2e-6], abs=1e-7)
    assert [bxx, bxy] == pytest.approx([(ahead[1] - behind[1]) / 2e-6, (ahead[2] - behind[2]) / 2e-6], abs=1e-6)
    assert [bxy, byy] == pytest.approx([(left[1] - right[1]) / 2e-6, (left[2] - right[2]) / 2e-6], abs=1e-6)


def test_finer_heights_come_nearer_to_a_smooth_bottom():
    """At a peak between its points both slopes there may be 0, and are up to h |b''| else: a cubic then errs by 4/27 h^2 |b''|."""
    for count in (11, 21, 41, 81):
        x = np.linspace(0.0, 4.0, count)
        table = relief(scene_of(MOORING, seabed__level=0.0, seabed__profile=np.column_stack((x, np.sin(x))).tolist()))
        error = max(abs(shape_at(table, at, 0.0)[0] - np.sin(at)) for at in np.linspace(0.5, 3.5, 301))
        assert error < 4.0 / 27.0 * (4.0 / (count - 1)) ** 2


def test_x_and_y_of_a_grid_are_alike():
    rng = np.random.default_rng(3)
    rows = [[x, y, rng.uniform(-4.0, -2.0)] for x in (0.0, 3.0, 5.0, 9.0) for y in (-4.0, 1.0, 2.0)]
    one, other = (
        relief(scene_of(MOORING, seabed__level=0.0, seabed__grid=each, solver__space=True))
        for each in (rows, [[y, x, z] for x, y, z in rows])
    )
    for x, y in rng.uniform((-1.0, -5.0), (10.0, 3.0), (50, 2)):
        height, by_x, by_y, *_ = shape_at(one, x, y)
        assert shape_at(other, y, x)[:3] == pytest.approx((height, by_y, by_x), abs=1e-12)


# -- what is refused, and told


@pytest.mark.parametrize(("nodes", "told"), [(41, True), (401, False)])
def test_cells_that_cut_through_a_ridge_are_told(nodes, told):
    x = np.linspace(0.0, 40.0, 161)
    ridge = np.column_stack((x, -3.0 + 1.5 * np.exp(-0.5 * ((x - 15.0) / 0.5) ** 2))).tolist()
    model = make(MOORING, seabed__level=0.0, seabed__profile=ridge, solver__nodes=nodes, top__position=[32.3, 0.0, -2.0])
    assert [text.endswith("Give more solver.nodes, or smoother heights.") for text in simulate(model, duration=0.01).warnings] == [
        True
    ] * told


def test_a_soft_bottom_into_which_a_cable_sinks_is_not_taken_for_a_ridge():
    level = [[x, -3.0] for x in (-5.0, 10.0, 20.0, 40.0)]
    model = make(MOORING, seabed__level=0.0, seabed__profile=level, seabed__stiffness=1e3, top__position=[32.3, 0.0, -2.0])
    assert simulate(model, duration=0.01).warnings == ()


@pytest.mark.parametrize(("depth", "told"), [(30.0, True), (20.0, False)])
def test_the_depth_that_waves_feel_is_held_against_a_slope_where_the_mooring_is(depth, told):
    """At x = 100 to 132 m on a slope of 0.1 that is 30 m deep at x = 0."""
    scene = scene_of(
        MOORING, seabed__level=-30.0, seabed__slope=0.1, lower_end__x=100.0, lower_end__z=-20.0, top__position=[132.0, 0.0, -14.0],
        water__density=1025.0, water__depth=depth, waves__amplitude=0.1,
    )  # fmt: skip
    assert [text for text in before_the_run(scene) if "waves feel another bottom" in text] == [
        "water.depth = 30 m over a seabed from z = -20 to -16.8 m: waves feel another bottom than the cable. Set water.depth = 18.4."
    ] * told


@pytest.mark.parametrize(
    ("changes", "text"),
    [
        ({"seabed__slope": 0.1, "seabed__profile": HILLS, "seabed__level": 0.0}, "seabed.slope = 0.1: must be 0 beside"),
        ({"seabed__profile": HILLS}, r"seabed.level = -3 m: must be 0 beside the heights"),
        ({"seabed__level": 0.0, "seabed__profile": HILLS[:1]}, "seabed.profile = 1 rows: must be at least two rows"),
        ({"seabed__level": 0.0, "seabed__profile": [[0.0, 0.0], [0.0, 1.0]]}, "seabed.profile = 2 rows: must be at least two rows"),
        ({"seabed__level": 0.0, "seabed__grid": [[0, 0, 0], [0, 1, 0], [1, 0, 0], [1, 1, 0]]}, "seabed.grid = 4 rows: must be empty in"),
        ({"seabed__slope_direction": 0.5}, "seabed.slope_direction = 0.5 rad: must be 0 without seabed.slope"),
        ({"seabed__slope": 0.1, "seabed__slope_direction": 0.5}, "seabed.slope_direction = 0.5 rad: must be 0 or pi in the plane"),
        ({"seabed__slope": 0.1, "solver__grid": "box"}, "seabed"),
        ({"seabed__stiffness": 0.0, "seabed__level": 0.0, "seabed__slope": 0.1}, "seabed.stiffness = 0 Pa/m: must be > 0 for a seabed"),
        (
            {"seabed__slope": 0.1, "seabed__friction_coefficient": 0.5, "seabed__laid_from_anchor": True},
            "seabed.laid_from_anchor = True: must be false where the bottom is not level",
        ),
        (
            {"seabed__level": 0.0, "solver__space": True, "seabed__grid": [[0, 0, 0], [0, 1, 0], [1, 0, 0], [1, 2, 0]]},
            "seabed.grid = 4 rows: must be at least two x",
        ),
    ],
)
def test_what_a_bottom_cannot_be_is_refused(changes, text):
    with pytest.raises(ParameterError, match=text):
        make(MOORING, **changes)


@pytest.mark.parametrize("heights", [{"seabed__slope": 0.2}, {"seabed__level": 0.0, "seabed__profile": [[0.0, -3.0], [40.0, 5.0]]}])
@pytest.mark.parametrize("buried", ["top", "anchor"])
def test_an_end_below_a_bottom_that_is_not_level_is_told(heights, buried):
    place = {"top__position": [30.0, 0.0, 1.0]} if buried == "top" else {"lower_end__x": 5.0, "top__position": [32.0, 0.0, 6.0]}
    result = simulate(make(MOORING, **heights, **place, solver__nodes=11), duration=0.02)
    (warning,) = [text for text in result.warnings if "pushed into the bottom" in text]
    assert ("z = 1 m, the seabed at 3 m" if buried == "top" else "z = -3 m, the seabed at -2 m") in warning


# -- energy and momentum


X = np.linspace(-25.0, 25.0, 26)
RIPPLES = np.column_stack((X, 0.4 * np.sin(0.3 * X))).tolist()
ROUGH = [[x, y, z * (1.0 + 0.02 * y) + 0.01 * y * y] for x, z in RIPPLES for y in (-4.0, -1.0, 1.0, 4.0)]


@pytest.mark.parametrize(
    ("changes", "energy", "force"),
    [
        ({"seabed__profile": RIPPLES}, 1e-5, 2e-5),
        ({"seabed__grid": ROUGH, "solver__space": True}, 1e-5, 2e-5),
        ({"seabed__profile": RIPPLES, "seabed__friction_coefficient": 0.2}, 3e-4, 2e-4),  # a kink where a slider turns: of first order
    ],
    ids=["profile", "grid in space", "profile with friction"],
)
def test_energy_and_momentum_close_where_a_cable_is_pulled_over_ripples(changes, energy, force):
    found = []
    for step in (0.02, 0.01):
        model = make(
            MOORING, **{"seabed__level": 0.0, **changes}, cable__length=30.0, lower_end__x=-15.0, lower_end__z=0.4 * np.sin(-4.5),
            solver__nodes=17, solver__time_step=step, seabed__stiffness=3e6, solver__audit=True, solver__slack_damping=0.0,
        )  # fmt: skip
        motion = swing((0.03, 0.0, 0.0), 1.5, ramp_time=2.0)
        place = np.array([15.3, 0.0, 0.4 * np.sin(4.59), *[0.0] * 6])
        drive(model, every(step, 4.0), lambda t, motion=motion, place=place: motion(t) + place)
        found.append(model.audit)
    coarse, fine = found
    assert fine.energy_share < energy
    assert fine.momentum_share < force
    assert abs(fine.energy) < 0.6 * abs(coarse.energy)
