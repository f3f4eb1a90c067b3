"""Where a straight cable is enough: TowCable against CableChain over how deep drag lets lateral motion reach."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import astuple, dataclass, fields

import matplotlib.pyplot as plt
import numpy as np

from cable_model.lab.published.page import Page
from cable_model.scene import Scene, load, with_values
from cable_model.studies.timed import Setting, Timed, timed
from cable_model.studies.validity import least_depth, penetration

NAME = "straight_cable"
HEAVE = 0.5  # m
SMALL = 2.0  # m, of the top across: the wire stays nearly upright
CYCLES = 12  # simulated, the last three measured
SAMPLES = 40  # a cycle
EARLIER = ((1.9, 0.01), (0.97, 0.045), (0.65, 0.05), (0.49, 0.12))  # depth/L and error of the amplitude of another wire and chain program
LENGTHS, AMPLITUDES = "length 60 to 2000 m", "amplitude 0.1 to 8 m"
FAMILIES: Mapping[str, tuple[tuple[float, float, float], ...]] = {  # (length m, lateral amplitude m, period s)
    LENGTHS: tuple((length, 1.0, 20.0) for length in (60.0, 80.0, 120.0, 160.0, 200.0, 250.0, 300.0, 400.0, 600.0, 800.0, 1200.0, 2000.0)),
    "period 60 to 5 s": tuple((200.0, 1.0, period) for period in (60.0, 40.0, 30.0, 25.0, 20.0, 16.0, 13.0, 10.0, 8.0, 6.0, 5.0)),
    AMPLITUDES: tuple((200.0, amplitude, 20.0) for amplitude in (0.1, 0.2, 0.4, 0.7, 1.0, 2.0, 3.0, 5.0, 8.0)),
}
REFUSED = 0.4  # depth over the length below which the straight cable is not asked about lateral motion
ASKED = 0.1  # accuracy whose limit is drawn


@dataclass(frozen=True)
class Case:
    """One wire; errors are TowCable's over the chain's."""

    family: str
    length: float  # m
    amplitude: float  # m, of the top across
    period: float  # s
    depth: float  # to which lateral motion of the top reaches, over the length
    lateral: float  # amplitude of the body across over that of the top: the chain's
    lateral_straight: float  # TowCable's
    lateral_error: float
    motion_error: float  # rms difference across over the chain's rms
    tension_error: float  # of the amplitude of the top tension


def scene_of(length: float, amplitude: float, period: float) -> Scene:
    """The shipped 13 mm wire and 600 kg body in still water, its top moved across and up and down."""
    omega = 2.0 * math.pi / period
    common = {"kind": "sinusoid", "angular_frequency": omega, "ramp_time": 2.0 * period}
    changes = {
        "current.speed": 0.0,
        "cable.bending_stiffness": 0.0,
        "cable.length": length,
        "top.motion": [{**common, "axis": "x", "amplitude": amplitude}, {**common, "axis": "z", "amplitude": HEAVE, "phase": 1.0}],
        "solver.time_step": period / SAMPLES,
        "run.duration": CYCLES * period,
        "run.output_step": period / SAMPLES,
    }
    return with_values(load("towed_body"), changes)


def compared(family: str, length: float, amplitude: float, period: float) -> Case:
    scene = scene_of(length, amplitude, period)
    chain = timed(scene, Setting("chain", "chain", {}))
    tow = timed(scene, Setting("tow", "tow", {"solver.tolerance": 1e-5}))
    late = chain.times > chain.times[-1] - 3.0 * period - 1e-9
    top = amplitude * np.sin(2.0 * math.pi / period * chain.times)

    def across(run: Timed) -> np.ndarray:
        return np.asarray((run.position[:, 0] + top)[late])

    def half_range(values: np.ndarray) -> float:
        return 0.5 * float(np.ptp(values))

    ours, straight = across(chain), across(tow)
    apart = float(np.sqrt(np.mean((straight - ours) ** 2)) / ours.std())
    tension = half_range(tow.tension[late]) / half_range(chain.tension[late]) - 1.0
    return Case(
        family, length, amplitude, period, penetration(scene, float(tow.tension[late].mean())), half_range(ours) / amplitude,
        half_range(straight) / amplitude, half_range(straight) / half_range(ours) - 1.0, apart, tension,
    )  # fmt: skip


def measure(quick: bool = False, told: Callable[[str], None] | None = None) -> list[Case]:
    """All families; quick: four lengths of the first."""
    wanted = [(LENGTHS, *values) for values in FAMILIES[LENGTHS][::3]]
    if not quick:
        wanted = [(family, *values) for family, table in FAMILIES.items() for values in table]
    found = []
    for family, length, amplitude, period in wanted:
        if told is not None:
            told(f"{family}: {length:g} m, {amplitude:g} m at {period:g} s")
        found.append(compared(family, length, amplitude, period))
    return found


def shallowest(found: list[Case], allowed: float) -> float:
    """Least depth down to which every deeper case of the families has an error of the body's motion below `allowed`."""
    deep = sorted(found, key=lambda case: -case.depth)
    kept = math.inf
    for case in deep:
        if case.motion_error > allowed:
            break
        kept = case.depth
    return kept


def at_depth(found: list[Case], depth: float) -> float:
    """Error of the amplitude at a depth, between the neighbouring cases of all families on a logarithmic scale."""
    ordered = sorted(found, key=lambda case: case.depth)
    sizes = [math.log(max(abs(case.lateral_error), 1e-4)) for case in ordered]
    return math.exp(float(np.interp(math.log(depth), [math.log(case.depth) for case in ordered], sizes)))


def page(found: list[Case]) -> Page:
    figure, (left, right) = plt.subplots(1, 2, figsize=(11, 5), sharex=True, sharey=True)
    asked = least_depth(ASKED)
    for k, family in enumerate(dict.fromkeys(case.family for case in found)):
        own = sorted((case for case in found if case.family == family), key=lambda case: case.depth)
        depths = [case.depth for case in own]
        left.plot(depths, [abs(case.lateral_error) for case in own], "o-", color=f"C{k}", markersize=4, label=f"amplitude, {family}")
        left.plot(depths, [case.motion_error for case in own], "--", color=f"C{k}", linewidth=1.0, label=f"rms with phase, {family}")
        right.plot(depths, [abs(case.tension_error) for case in own], "o-", color=f"C{k}", markersize=4, label=family)
    left.plot(*zip(*EARLIER, strict=True), "k*", markersize=9, label="amplitude, found before on another wire")
    titles = ("lateral motion of the body", "amplitude of the top tension")
    for axis, title in zip((left, right), titles, strict=True):
        axis.axvline(asked, color="grey", linestyle="--", linewidth=1.0, label=f"least depth of `advise` for {100 * ASKED:g} %")
        axis.axvline(REFUSED, color="grey", linestyle=":", label=f"{REFUSED:g}: nothing said of lateral motion")
        axis.axhline(0.1, color="grey", linewidth=0.6)
        axis.set(xscale="log", yscale="log", xlabel="depth that drag lets lateral motion reach / length", title=title, ylim=(1e-3, 30.0))
        axis.grid(alpha=0.3, which="both")
        axis.legend(fontsize=7)
    left.set_ylabel("error of the straight cable")
    near = [case for case in found if REFUSED <= case.depth < 1.0]
    deep = [case for case in found if case.depth >= 1.0]
    last = min(found, key=lambda case: case.depth)
    small = [case for case in found if case.amplitude <= SMALL]
    worst_deep = 100 * max((abs(c.lateral_error) for c in deep), default=math.nan)
    worst_near = 100 * max((abs(c.lateral_error) for c in near), default=math.nan)
    caption = (
        f"TowCable against CableChain: 13 mm wire, 600 kg body, still water, top moved across and {HEAVE:g} m up and down.  Error of "
        f"the body's lateral amplitude: at most {worst_deep:.1f} % at depths of a "
        f"length and more, at most {worst_near:.0f} % between {REFUSED:g} and "
        f"1, {100 * at_depth(found, REFUSED):.0f} % at {REFUSED:g}, {100 * at_depth(found, asked):.1f} % at the least depth {asked:.2g} "
        f"that `advise` asks for {100 * ASKED:g} %, a factor of {1.0 + last.lateral_error:.2g} at {last.depth:.2f}; with "
        f"phase the motion is within 10 % down to {shallowest(found, 0.1):.2f}.  The tension's amplitude is within "
        f"{100 * max(abs(c.tension_error) for c in small):.1f} % where the top moves at most {SMALL:g} m across, else within "
        f"{100 * max(abs(c.tension_error) for c in found):.0f} %."
    )
    head = tuple(field.name for field in fields(Case))
    rows = [astuple(case) for case in sorted(found, key=lambda case: (case.family, -case.depth))]
    shown: list[tuple[object, ...]] = [("depth / length", "lateral amplitude", "with phase, rms", "tension amplitude")]
    for case in sorted((c for c in found if c.family == LENGTHS), key=lambda case: -case.depth):
        errors = (case.lateral_error, case.motion_error, case.tension_error)
        shown.append((f"{case.depth:.2f}", *(f"{100 * e:.1f} %" for e in errors)))
    return Page(NAME, "Where the straight cable is enough", caption, figure, head, rows, shown)
