"""The list of hard cases: which scenes, in which variants, how each is judged; it runs nothing."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field

Changes = Mapping[str, object]
NEVER = math.inf


@dataclass(frozen=True)
class Variant:
    """One run of a case: values that differ from its scene's; judged by the rules, or reported only."""

    label: str
    changes: Changes = field(default_factory=dict)
    judged: bool = True
    refined: bool = True  # compared with finer runs


@dataclass(frozen=True)
class Case:
    """A hard case: variants of one scene, the time its motion becomes chaotic, and how far a finer run may be before (over L)."""

    key: str
    scene: str
    variants: tuple[Variant, ...]
    chaos: float = NEVER  # s
    tolerance: float = 0.01
    statistics: float = 0.0  # s of motion over which rms and mean are compared with the reference's; 0: they are not
    reference: Changes = field(default_factory=dict)  # the finer grid and step of these statistics
    check: str = ""  # a further finding: its name in checks.py


def grid_of(nodes: int, step: float, lam: float, stiffness: float) -> Variant:
    label = f"n {nodes}, dt {step:g}, lambda {lam:g}, EA/W {stiffness:.0e}"
    changes = {"solver.nodes": nodes, "solver.time_step": step, "solver.lambda_infinity": lam, "cable.axial_stiffness": stiffness * CHAIN}
    return Variant(label, changes)


CHAIN = 0.1 * 9.81 * 1.75  # N, weight of the 1.75 m chain
MEMBERS = (
    ("box method (lambda -1)", {"solver.lambda_infinity": -1.0}),
    ("lambda -0.9", {"solver.lambda_infinity": -0.9}),
    ("lambda -0.7", {"solver.lambda_infinity": -0.7}),
    ("lambda 0", {"solver.lambda_infinity": 0.0}),
    ("trapezoidal", {"solver.integrator": "trapezoidal"}),
    ("backward difference", {"solver.integrator": "backward-difference"}),
    ("generalized trapezoidal, lambda -0.5", {"solver.integrator": "generalized-trapezoidal"}),
    ("Cornwell-Malkus, lambda -0.5", {"solver.integrator": "cornwell-malkus"}),
    ("WBZ, lambda -0.5", {"solver.integrator": "wbz"}),
)
FAMILY = tuple(Variant(label, changes, judged=False, refined=False) for label, changes in MEMBERS)
BOX = (
    Variant("box grid", {"solver.grid": "box"}, judged=False, refined=False),
    Variant("box grid, box method", {"solver.grid": "box", "solver.lambda_infinity": -1.0}, judged=False, refined=False),
    Variant("box grid, lambda 0", {"solver.grid": "box", "solver.lambda_infinity": 0.0}, judged=False, refined=False),
)
COLLAPSE = tuple(
    grid_of(nodes, step, lam, stiffness)
    for stiffness in (1e4, 1e9)
    for nodes in (100, 200)
    for step in (0.01, 0.001)
    for lam in (-0.5, -0.7)
)
FIRST_MODE = 2.8469  # rad/s
WHIRLS = tuple(
    Variant(
        f"{factor:g} of the first mode",
        {"top.motion": [
            {"kind": "sinusoid", "axis": "x", "amplitude": 0.05, "angular_frequency": factor * FIRST_MODE, "ramp_time": 1.0,
             "ramp": "cubic"},
            {"kind": "sinusoid", "axis": "y", "amplitude": 5e-5, "angular_frequency": math.pi, "stop": 1.0},
        ]},
    )
    for factor in (0.95, 1.0, 1.05)
)  # fmt: skip
PEERS_WHIRL = Variant(
    "0.02 m at 6.5 rad/s, y 1e-4 m in quadrature",
    {"top.motion": [
        {"kind": "sinusoid", "axis": "x", "amplitude": 0.02, "angular_frequency": 6.5, "ramp_time": 1.0},
        {"kind": "sinusoid", "axis": "y", "amplitude": 1e-4, "angular_frequency": 6.5, "phase": 0.5 * math.pi, "ramp_time": 1.0},
    ]},
    judged=True,
)  # fmt: skip
STIFFNESSES = tuple(Variant(f"EA/W {10.0**k:.0e}", {"cable.axial_stiffness": 10.0**k * CHAIN}) for k in (2, 4, 6, 8, 10, 12))
INEXTENSIBLE = Variant(
    "inextensible, box grid, n 201", {"solver.grid": "box", "cable.inextensible": True, "solver.nodes": 201}, judged=False, refined=False
)
BODIES = tuple(
    Variant(f"body/cable {10.0**k:.0e}", {"body.mass": 0.175 * 10.0**k, "cable.axial_stiffness": 1e4 * CHAIN * (1.0 + 10.0**k)})
    for k in (-6, -4, -2, 0, 2, 4, 6)
)
GRIDS = tuple(
    Variant(f"n {nodes}", {"solver.nodes": nodes, "run.duration": 2.0 if nodes > 100 else 10.0}, refined=nodes == 10)
    for nodes in (3, 5, 10, 1000, 3000)
)
HEAVE_4S = {"kind": "sinusoid", "axis": "z", "amplitude": 3.0, "angular_frequency": 0.5 * math.pi, "ramp_time": 4.0}
SNAPS = tuple(
    Variant(f"n {nodes}, dt {step:g}", {"solver.nodes": nodes, "solver.time_step": step}, refined=nodes == 51 and step == 0.01)
    for nodes, step in ((26, 0.02), (51, 0.01), (101, 0.005), (201, 0.0025))
)

SLACK = tuple(Variant(variant.label, {**variant.changes, "top.motion": [HEAVE_4S]}, refined=variant.refined) for variant in SNAPS)
BOTH = (Variant("lambda -0.5"), Variant("lambda -0.9", {"solver.lambda_infinity": -0.9}))
FINE = {"solver.nodes": 200, "solver.time_step": 0.001}

BASIN_RADII, BASIN_PERIODS = (0.075, 0.125, 0.2), (1.25, 1.5, 2.0, 2.5, 3.0, 3.5)  # m, s: those measured
BASIN_CYCLES = 12


def basin_label(radius: float, period: float) -> str:
    return f"radius {radius:g} m, period {period:g} s"


TURN = 40.0  # s: the current that the cable of H12 sees has begun to turn round, and the cable folds
BASIN = tuple(  # [Bergdahl et al. 2016]: up, then away from the anchor, twelve periods
    Variant(
        basin_label(radius, period),
        {
            "top.motion": [
                {"kind": "sinusoid", "axis": axis, "amplitude": radius, "angular_frequency": 2.0 * math.pi / period, "phase": phase,
                 "ramp_time": 2.0 * period}
                for axis, phase in (("x", 0.5 * math.pi), ("z", math.pi))
            ],
            "solver.time_step": period / 125.0,
            "run.duration": BASIN_CYCLES * period,
        },
    )
    for radius in BASIN_RADII
    for period in BASIN_PERIODS
)  # fmt: skip

HEAVED = {"kind": "sinusoid", "axis": "z", "angular_frequency": 1.2, "ramp_time": 5.0}
FLOAT = {"body.mass": 153.75, "top.position": (0.0, 0.0, -5.25)}  # 0.5 of the water's density, on a wire from below
BOBS = tuple(
    Variant(
        f"{label}, dt {step:g}",
        {**changes, "solver.time_step": step, "top.motion": [{**HEAVED, "amplitude": amplitude}]},
        refined=step == 0.02,
    )
    for label, changes, amplitude in (("heavy", {}, 0.7), ("float", FLOAT, 0.15), ("float goes slack", FLOAT, 0.7))
    for step in (0.04, 0.02, 0.01)
)
LOWERED = (
    Variant("waves of 1.5 m, stretched"),
    Variant("waves of 3 m, stretched", {"waves.amplitude": 1.5}),
    Variant("waves of 1.5 m up to z = 0", {"waves.surface": "held"}),
    BOX[0],
)
HOSES = (
    Variant("its end moves"),
    Variant("waves of 1.5 m", {"top.motion": [], "waves.amplitude": 0.75, "waves.period": 6.0, "waves.surface": "wheeler"}),
)

UMBILICAL = 4.6625 * 20.0**3  # w L^3, N m2
STIFF = 1e11  # N: the axial stiffness of a loop whose bending alone presses it by tens of kN


def loop(number: float, changes: Changes, label: str = "", judged: bool = True, refined: bool = True) -> Variant:
    """A loop of EI = `number` w L^3."""
    values: dict[str, object] = {"cable.bending_stiffness": number * UMBILICAL}
    if number >= 1.0:
        values["cable.axial_stiffness"] = STIFF
    return Variant(f"EI {number:g} w L3{label}", {**values, **changes}, judged, refined)


def shaken(x: float, z: float, omega: float) -> Changes:
    """The top's motion: x at `omega`, z at one and a half of it."""
    motion = [
        {"kind": "sinusoid", "axis": axis, "amplitude": amplitude, "angular_frequency": factor * omega, "ramp_time": 5.0}
        for axis, amplitude, factor in (("x", x, 1.0), ("z", z, 1.5))
    ]
    return {"top.motion": motion}


GENTLY, HARD = shaken(0.5, 0.2, 0.6), shaken(1.0, 0.5, 2.0)
LOOPS = (
    *(loop(number, GENTLY) for number in (1e-8, 1e-6, 1e-4, 1e-2, 1.0, 10.0)),
    *(loop(number, HARD, ", shaken hard") for number in (1e-4, 1e-2, 1.0, 10.0)),
    # these two go slack, and bend over less than their cells
    *(loop(number, HARD, ", shaken hard", judged=False, refined=False) for number in (1e-8, 1e-6)),
)
FREE = {"lower_end.released": True}
LET_GO = (
    loop(1e-4, FREE),
    loop(1e-2, FREE),
    loop(1.0, {**FREE, "solver.time_step": 0.0025}),
    loop(10.0, {**FREE, "solver.time_step": 0.0005, "run.duration": 2.0}),
    loop(1e-6, {**FREE, "solver.nodes": 401}, ", n 401", refined=False),
    loop(1e-8, FREE, judged=False, refined=False),  # what it bends over is finer than its cells, which lose length as it falls slack
)


PARTINGS = (
    Variant("at its anchor"),
    Variant("in its middle", {"parting.place": 50.0}),
    Variant("at its top", {"parting.place": 100.0}),
    Variant(
        "its payload let go", {"lower_end.anchored": False, "lower_end.x": 0.0, "lower_end.z": 0.0, "body.mass": 1e4, "body.volume": 1.3}
    ),
)
GENTLE = {"top.motion": [{"kind": "sinusoid", "axis": axis, "amplitude": 0.2, "period": 5.0, "ramp_time": 5.0} for axis in "xz"]}


def beads(power: int, more: Changes | None = None) -> Variant:
    """A bead of 10^power times the line's 522 kg, above it steel as much stiffer as it then carries."""
    share = 10.0**power
    sections = [
        {"length": 10.0, "mass_per_length": 27.0, "axial_stiffness": 5e7, "diameter": 0.04},
        {"length": 40.0, "mass_per_length": 0.3, "axial_stiffness": 5e4, "diameter": 0.02},
        {"length": 80.0, "mass_per_length": 3.0, "axial_stiffness": 5e7 * (1.0 + share), "diameter": 0.025},
    ]
    return Variant(
        f"bead/line {share:.0e}", {"cable.section": sections, "cable.body": [{"at": 50.0, "mass": 522.0 * share}], **(more or {})}
    )


CASES = (
    Case("H1", "hard/collapse", (*COLLAPSE, *FAMILY, *BOX), chaos=2.0, statistics=240.0, reference=FINE),
    Case("H2", "hard/impulsive_start", (Variant("lambda -0.5"), *FAMILY, *BOX), chaos=1.5, statistics=240.0, reference=FINE),
    Case("H2 step", "hard/velocity_step", (Variant("lambda -0.5"), *FAMILY, *BOX), chaos=1.5),
    Case("H3", "hard/whirl", (*WHIRLS, PEERS_WHIRL, *FAMILY), chaos=10.0),
    Case("H4", "hard/folded_fall", BOTH, chaos=0.37, check="folded fall"),
    Case("H5", "hard/snap", SNAPS, check="peaks"),
    Case("H5 at 4 s", "hard/snap", SLACK, chaos=6.0, check="peaks"),
    Case("H6", "hard/stiffness", (*STIFFNESSES, INEXTENSIBLE), check="one motion"),
    Case("H7", "hard/bungee", BOTH, chaos=2.0, check="bounces"),
    Case("H8", "hard/weightless", (Variant("lambda -0.5"),)),
    Case("H9", "hard/bodies", BODIES),
    Case("H10", "hard/grids", GRIDS),
    Case("H11", "hard/tow_circle", (Variant("lambda -0.5"),)),
    Case("H12", "hard/slack_current", (Variant("lambda -0.5"),), chaos=TURN),
    Case("H13", "basin_chain", BASIN, check="basin"),
    Case("H14", "hard/three_hours", (Variant("lambda -0.5", refined=False),), check="drift"),
    Case("H16", "hard/bob", (*BOBS, BOX[0]), check="crossing"),
    Case("H16 lowered", "hard/lowered", LOWERED, check="crossing"),
    Case("H16 hose", "hard/hose", HOSES, check="crossing"),
    Case("H17", "hard/loops", LOOPS, check="loops"),
    Case("H17 let go", "hard/loops", LET_GO, check="loops"),
    Case("H19 tow", "hard/two_ships", SNAPS[:3], check="peaks"),
    Case("H20", "hard/dragged", (Variant("an hour", refined=False), Variant("a minute", {"run.duration": 60.0})), check="held"),
    Case("H20 storm", "hard/storm_mooring", (Variant("lambda -0.5", refined=False),), check="touchdown"),
    Case("H21", "hard/parting", PARTINGS, chaos=3.0),
    Case("H22", "hard/sections", tuple(beads(power) for power in (-3, -1, 0, 1, 3)), chaos=6.0),
    Case("H22 gently", "hard/sections", tuple(beads(power, GENTLE) for power in (-3, 0, 3))),
)
