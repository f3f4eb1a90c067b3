"""What is doubtful about a run: warnings of one form, `<what was seen, with both numbers>: <what it means>. <what to do>`.

They never change a number.  What must not happen at all is an error, see rules.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator, Sequence
from typing import Any

import numpy as np

from cable_model import tables
from cable_model.effects import BY_NAME, CHAIN
from cable_model.kernels import header
from cable_model.sea import rows_of
from cable_model.signals import OUTPUTS
from cable_model.simulated import is_on

FEWEST_STEPS = 20  # a period: the phase of a second-order method of this family errs by (omega h)^2/12, here 0.8 %
LONGEST_PHASE = 1.0  # rad of a wave in a cell: 26 graded nodes have it in the eighth mode of a hanging chain, whose frequency errs by 0.2 %
SAME_BOTTOM = 0.01  # of the depth
STEPS_A_ROW = 10  # internal steps between two rows of a current: with 2 a body in it was 9 % off, with 13 0.05 %
MEETING = 2.0  # times the longest step of a record: a longer one from its end to its start is a jump
FEWEST_ROWS = 4  # of a table of motion
SWING = 0.01  # of all that a table moves, between two rows that are alike
FELT = 0.95  # of the velocity's variance in a sea: what its shortest waves add beyond it does not count


def shaking(scene: Any, axes: str = "xyz") -> float:
    """The highest angular frequency of the sinusoids of both ends along some axes, rad/s; 0 without any."""
    parts = (*scene.top.motion, *scene.lower.motion)
    moving = [part for part in parts if part.kind == "sinusoid" and part.amplitude != 0.0 and part.axis in axes]
    return max((part.omega for part in moving), default=0.0)


def forcing(scene: Any, axes: str = "xyz") -> float:
    """The same, and of the waves that are felt."""
    found = [shaking(scene, axes)]
    sea = tables.waves(scene) if is_on(BY_NAME["waves"], scene, CHAIN) else None
    if sea is not None:
        rows = rows_of(sea)
        rows = rows[np.argsort(rows[:, 1])]
        variance = np.cumsum((rows[:, 0] * rows[:, 1]) ** 2)
        found.append(float(rows[np.searchsorted(variance, FELT * variance[-1]), 1]))
    return max(found)


def before_the_run(scene: Any) -> Iterator[str]:
    """What a scene alone makes doubtful; the kernels look at waves and steps."""
    yield from _two_bottoms(scene)
    yield from _changing_water(scene)
    step, omega = min(scene.solver.time_step, scene.run.output_step), shaking(scene)
    if omega * step * FEWEST_STEPS > 2.0 * math.pi and scene.solver.tolerance == 0.0:
        period = 2.0 * math.pi / omega
        yield (
            f"time step = {step:.3g} s under a forcing of {period:.3g} s: {period / step:.3g} steps a period leave errors of about "
            f"{100.0 * (omega * step) ** 2 / 12.0:.2g} % in phase. Set solver.time_step = {period / FEWEST_STEPS:.2g}, or solver.tolerance."
        )


def _changing_water(scene: Any) -> Iterator[str]:
    """Currents over time and records of waves that a run does not follow."""
    current = np.array(scene.current.table) if is_on(BY_NAME["current_table"], scene, CHAIN) else np.zeros((0, 4))
    times = np.unique(current[:, 0])
    step = scene.solver.time_step
    if len(times) > 1 and scene.solver.tolerance == 0.0 and np.diff(times).min() < STEPS_A_ROW * step:
        yield (
            f"rows of current.table {np.diff(times).min():.3g} s apart, internal step = {step:.3g} s: the push of water that changes "
            f"within a few steps is lost in part. Set solver.time_step = {np.diff(times).min() / STEPS_A_ROW:.2g}, or give smoother rows."
        )
    if len(current) and current[:, 1].min() > 0.0:
        yield (
            f"levels of current.table from z = {current[:, 1].min():g} to {current[:, 1].max():g} m: all above the water. "
            "z points up from still water: give depths as negative z."
        )
    heights = np.array(scene.waves.record)[:, 1] if scene.waves.record else np.zeros(1)
    jump, usual = abs(heights[0] - heights[-1]), np.abs(np.diff(heights)).max(initial=0.0)
    if jump > MEETING * usual:
        yield (
            f"waves.record = {jump:.3g} m from its last row to its first, at most {usual:.3g} m from any other row to the next: it repeats "
            "with a jump, which its waves have all the time. Cut or fade it so that both ends meet."
        )


def _swings_between_rows(name: str, table: Sequence[Sequence[float]]) -> Iterator[str]:
    """A table whose spline moves where two rows after one another say that nothing does."""
    rows = np.array(table)
    if len(rows) < FEWEST_ROWS or not np.all(np.diff(rows[:, 0]) > 0.0):
        return  # motion.py refuses it
    from scipy.interpolate import CubicSpline  # here only: FMUs, which no table moves, do without scipy

    spline, size = CubicSpline(rows[:, 0], rows[:, 1:]), float(np.ptp(rows[:, 1:], axis=0).max())
    for before, after in itertools.pairwise(rows):
        if np.array_equal(before[1:], after[1:]):
            times = np.linspace(before[0], after[0], 9)
            off = float(np.abs(spline(times) - before[1:]).max())
            if off > SWING * size:
                yield (
                    f"{name} = {off:.3g} m off between rows that are alike at {before[0]:g} and {after[0]:g} s, of {size:.3g} m in all: "
                    "the spline through sparse rows swings. Give more rows where the motion begins and ends, or ramps in place of it."
                )
                return


def _two_bottoms(scene: Any) -> Iterator[str]:
    seabed, depth = scene.seabed, scene.water.depth if scene.water is not None else 0.0
    if not depth or seabed is None or not seabed.stiffness or not is_on(BY_NAME["waves"], scene, CHAIN):
        return
    heights = [row[-1] for row in seabed.grid or seabed.profile]
    if not heights:
        held = scene.lower.position if scene.lower_end.driven else (scene.lower_end.x, scene.lower_end.y)
        ends = [scene.top.position[:2], *([held[:2]] if scene.lower_end.anchored else [])]
        rise = seabed.slope * math.cos(seabed.slope_direction), seabed.slope * math.sin(seabed.slope_direction)
        heights = [seabed.level + rise[0] * x + rise[1] * y for x, y in ends]
    low, high, off = min(heights), max(heights), SAME_BOTTOM * depth
    if not low - off <= -depth <= high + off:
        where = f"at z = {low:g} m" if low == high else f"from z = {low:g} to {high:g} m"
        yield (
            f"water.depth = {depth:g} m over a seabed {where}: waves feel another bottom than the cable. "
            f"Set water.depth = {-0.5 * (low + high):g}."
        )


def under_a_given_motion(scene: Any) -> Iterator[str]:
    """What a run makes nothing of, as its motion of the top is known ahead, and what is doubtful about that motion."""
    if scene.host.mass > 0.0:
        yield (
            f"host.mass = {scene.host.mass:g} kg in a run whose top moves as the scene says: it changes nothing. "
            "Set host.mass = 0, or couple the host that has it by the FMU."
        )
    if is_on(BY_NAME["stream"], scene, scene.run.model):
        yield (
            "water.current_input = true in a run without a host: nothing gives this current, and it is 0. "
            "Give current.table, or couple the host that has it by the FMU."
        )
    if is_on(BY_NAME["parting"], scene, scene.run.model):
        cut = scene.parting
        if cut.by_input and cut.time == 0.0:
            yield (
                "parting.by_input = true in a run without a host: nothing cuts the cable. "
                "Give parting.time, or couple the host that does by the FMU."
            )
        if cut.time > scene.run.duration:
            yield f"parting.time = {cut.time:g} s in a run of {scene.run.duration:g} s: nothing is cut. Give another time, or a longer run."
    for end in ("top", "lower"):
        yield from _swings_between_rows(f"{end}.table", getattr(scene, end).table)


def at_the_start(scene: Any, model: str, outputs: Sequence[float]) -> Iterator[str]:
    """What the static equilibrium, with these outputs in the order of signals.OUTPUTS, makes doubtful."""
    cable = scene.cable
    if model != CHAIN:
        return
    tensions = [outputs[OUTPUTS.index(name)] for name in ("cable.tension_min", "cable.tension_max")]
    density = scene.water.density if scene.water is not None else 0.0
    mean = max(0.5 * (tensions[0] + tensions[1]), 1e-3 * tensions[1])
    rows = cable.section or (cable,)  # cells go to sections by the time that waves take through them
    heavy = sum(row.length * math.sqrt(row.mass_per_length + row.added_mass(density)) for row in rows) / cable.length
    across = math.sqrt(mean) / heavy if mean > 0.0 else math.inf
    along = cable.length / sum(row.length * math.sqrt(row.mass_per_length / row.axial_stiffness) for row in rows)
    cells = scene.solver.nodes - 1
    for words, omega, speed in (("across", forcing(scene, "xy"), across), ("along", forcing(scene, "z"), along)):
        phase = omega * cable.length / speed / cells
        if phase > LONGEST_PHASE:
            yield (
                f"cells = {cable.length / cells:.3g} m for waves {words} the cable of {2.0 * math.pi * speed / omega:.3g} m: they are not "
                f"resolved. Set solver.nodes = {math.ceil(phase / LONGEST_PHASE * cells) + 1}."
            )


# Kinds that the kernels see while a run goes on, in the order of kernels.watch: printf formats of their two numbers, for C as for Python
SEEN = (
    "top = %.3g m from where its inputs led, in a step of %.3g s: it jumps, and the cable feels a blow. "
    "Give start values of the inputs that go with the first step, and a motion without jumps.",
    "way of the top = %.3g m, of which its velocities miss %.3g m: what is led on between the steps is wrong. "
    "Give top.vx, top.vy and top.vz of the same motion, or set top.motion_order = 0.",
    "velocity of the top changed by %.3g m/s, of which its accelerations miss %.3g m/s: what is led on between the steps is wrong. "
    "Give top.ax, top.ay and top.az of the same motion, or set top.motion_order = 1.",
    "an end of the cable or a body at z = %.3g m, above %.3g m: what is in air is simulated as if under water. Set water.surface = true.",
    "lower end at z = %.4g m, the bottom of the waves at %.4g m: it hangs through the bottom. Set water.depth, or give a seabed.",
    "strain = %.3g under %.4g N, beyond 0.1: few cables have it, and none keeps its diameter. "
    "Check cable.length against the distance of its ends, and the unit of cable.axial_stiffness (N).",
    "weight in water = %.3g N of a mass of %.4g kg: there is no unique rest position, and the run starts from one of many. "
    "Give cable or body some weight, or a current.",
    "weight in water = %.3g N of a mass of %.4g kg between two held ends: the slack cable rests in any shape, and the run starts from one. "
    "Give the cable some weight, or a current.",
    "motion led on from input to input = %.3g N of kicks, beside %.3g N of its own inertia: the cable rings. "
    "Give inputs of the end of each step with top.inputs_at = 1, accelerations too with top.motion_order = 2, or shorter steps.",
    "internal step = %.3g s under a motion of %.3g s: fewer than twenty steps a period leave its phase and tension wrong. "
    "Set solver.time_step to a twentieth of it, or solver.tolerance.",
    "motion across the cable = felt down to %.3g m of %.4g m: the cable bends, and the lower end of a straight one moves too far. "
    "Check against CableChain; the tension is better than the place.",
    "tension = %.4g N, beside a weight of %.4g N: a straight cable pushes, a real one goes slack. "
    "Set tow.minimum_tension, or use CableChain.",
    "wave = %.3g m high, %.4g m long: beyond 0.142 of its length a wave breaks. Check amplitude and period of the waves.",
    "ringing of the force = %.2g of its size, fed by the exchange with the host at %.3g 1/s: force and motion are exchanged too seldom for "
    "the host's mass, and what comes out is wrong. Give shorter communication steps, a heavier host, or one that repeats its steps.",
    "an end starts at %.3g m/s along a cable that is still at rest: a blow of some %.3g N. "
    "Give a motion that fades in, or begins at the turn of a swing.",
    "drag and weight across the cable = a sag of %.3g m in %.4g m: a straight cable takes its force and its lower end elsewhere. "
    "Check against CableChain, or use it.",
    "waves = %.3g m high over still water, the lower end or a body at z = %.3g m: it is as wet as in still water, as waves do not move the "
    "surface. "
    'Set waves.surface = "cut" or "wheeler" in a scene, and bake it in for an FMU.',
    "internal step = %.3g s under waves of %.3g s: fewer than twenty steps a period leave their phase and forces wrong. "
    "Set solver.time_step to a twentieth of it, or solver.tolerance.",
    "force at the end of a communication step = %.3g N off what the mean forces about it say, which differ by %.3g N from step to step: it "
    "swings within a step, and tells little. Set top.inputs_at = 1, take top.force_mean, or give shorter steps.",
    "lower end = %.3g m from where its inputs led, in a step of %.3g s: it jumps, and the cable feels a blow. "
    "Give start values of the inputs that go with the first step, and a motion without jumps.",
    "way of the lower end = %.3g m, of which its velocities miss %.3g m: what is led on between the steps is wrong. "
    "Give lower.vx, lower.vy and lower.vz of the same motion, or set top.motion_order = 0.",
    "velocity of the lower end changed by %.3g m/s, of which its accelerations miss %.3g m/s: what is led on between the steps is wrong. "
    "Give lower.ax, lower.ay and lower.az of the same motion, or set top.motion_order = 1.",
    "an end of the cable at z = %.4g m, the seabed at %.4g m: it is pushed into the bottom, which holds against it. "
    "Check its place, its motion, or the seabed's height.",
    "ends of the cable = %.3g m apart at the start, of a length of %.4g m: it hangs in a fold. "
    "Connect lower.x, y and z, and give them start values.",
    "cable parted at t = %.6g s with %.6g m left above: the rest has gone. Check cable.breaking_tension and [parting] where it should not.",
    "cable parted at its top at t = %.6g s with %.6g m below: nothing is left. "
    "Check cable.breaking_tension and [parting] where it should not.",
    "solver.lambda_infinity = %.3g, above %.3g, where an end is suddenly free: the end goes too fast, up to several times. "
    "Set solver.lambda_infinity = -0.5.",
    "the cable turns by %.3g rad in half a cell of %.3g m at a clamped end: cells there are too long, and its moment too small. "
    "Give more solver.nodes, or the last metres a cable.section of their own.",
    "the cable lies %.3g m deeper in the seabed in the middle of a cell of %.3g m than at its ends: it cuts through what is narrower. "
    "Give more solver.nodes, or smoother heights.",
)


def seen(state: np.ndarray) -> tuple[str, ...]:
    """What the kernels saw in a run up to this state."""
    if state[header.DOUBTS] == 0.0:
        return ()
    pairs = state[header.DOUBT : header.DOUBT + 2 * len(SEEN)].reshape(-1, 2)
    return tuple(text % tuple(pair) for text, pair in zip(SEEN, pairs, strict=True) if pair.any())
