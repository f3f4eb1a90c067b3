"""Whether a straight cable may stand for the scene, by its scales: drag, bow, bending, resonance, slack; it runs TowCable alone."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from cable_model.motion import motion_of
from cable_model.scene import Scene
from cable_model.sea import rows_of
from cable_model.simulated import lacking, parts_of
from cable_model.studies.settings import TOW, allowed, straight
from cable_model.studies.timed import Setting, timed

RESONANT = 3.0  # forcing nearer to the first axial frequency than this factor
BOW = 2.0  # a bow of so many times the accuracy still moves the ends, which the cable is asked about, by less than the accuracy
SAMPLES = 500  # of the top's motion


@dataclass(frozen=True)
class Check:
    """One reason for or against the cheap model."""

    words: str
    holds: bool


def forcing(scene: Scene, axes: str = "xyz") -> list[float]:
    """Angular frequencies of the top along some axes, and of waves, rad/s; of a table, ramp or step the mean one of each axis."""
    moving = [part for part in scene.top.motion if part.kind == "sinusoid" and part.amplitude != 0.0 and part.axis in axes]
    found = [part.omega for part in moving]
    if scene.top.table or any(part.kind != "sinusoid" for part in scene.top.motion):
        speed, rate = _sampled(scene)
        spread = speed.std(axis=0)
        found += [float(np.sqrt(np.mean(rate[:, k] ** 2)) / spread[k]) for k in map("xyz".index, axes) if spread[k] > 0.0]
    waves = parts_of(scene, "chain").waves
    if isinstance(waves, np.ndarray):
        found += rows_of(waves)[:, 1].tolist()
    return [omega for omega in found if omega > 0.0]


def _sampled(scene: Scene) -> tuple[np.ndarray, np.ndarray]:
    """Velocities and accelerations of the top, (SAMPLES, 3)."""
    motion = motion_of(scene)
    rows = np.array([motion(t) for t in np.linspace(0.0, scene.run.duration, SAMPLES)])
    return rows[:, 3:6], rows[:, 6:9]


def lateral_motion(scene: Scene) -> tuple[float, float, float]:
    """Of the top's horizontal motion: amplitude of the unsteady velocity, its angular frequency, and the steady speed through the water."""
    speed, rate = _sampled(scene)
    mean = speed[:, :2].mean(axis=0)
    unsteady = math.sqrt(2.0 * float(np.mean(np.sum((speed[:, :2] - mean) ** 2, axis=1))))
    acceleration = math.sqrt(2.0 * float(np.mean(np.sum(rate[:, :2] ** 2, axis=1))))
    current = parts_of(scene, "chain").current
    stream = np.asarray(current)[:, 1:].mean(axis=0) if current is not None else np.zeros(2)
    return unsteady, acceleration / unsteady if unsteady > 0.0 else 0.0, float(np.linalg.norm(mean - stream))


def _drag(scene: Scene, speed: float) -> float:
    """Normal drag per length over the speed, N s/m2."""
    if scene.water is None:
        return 0.0
    return 0.5 * scene.water.density * scene.cable.normal_drag_coefficient * scene.cable.diameter * speed


def penetration(scene: Scene, tension: float) -> float:
    """Depth over the length to which lateral motion of the top reaches before drag stops it: sqrt(2 T/(c omega))/L; infinite without drag.

    c is the linearised drag 1/2 rho C_D d of 8/(3 pi) v of the top's lateral velocity v, or of twice a steady speed if that is more.
    """
    unsteady, omega, steady = lateral_motion(scene)
    drag = _drag(scene, max(8.0 / (3.0 * math.pi) * unsteady, 2.0 * steady))
    if drag * omega == 0.0:
        return math.inf
    return math.sqrt(2.0 * tension / (drag * omega)) / scene.cable.length


def least_depth(accuracy: float) -> float:
    """Penetration depth over the length from which on drag bows the motion by no more than an accuracy of the ends allows."""
    return 0.5 / math.sqrt(BOW * accuracy)


def steady_bow(scene: Scene, tension: float) -> float:
    """Sag over the length of a cable under the drag of the steady speed: q L/(8 T)."""
    steady = lateral_motion(scene)[2]
    return _drag(scene, steady) * steady * scene.cable.length / (8.0 * tension)


def axial_frequency(scene: Scene) -> float:
    """First axial frequency of body and a third of the cable on the cable's spring, rad/s."""
    cable = scene.cable
    mass = scene.body.mass + scene.body.added_mass + cable.mass_per_length * cable.length / 3.0
    return math.sqrt(cable.axial_stiffness / cable.length / mass)


def axial_phase(scene: Scene) -> float:
    """Phase of the fastest forcing's wave along the length, rad: omega L/c.  A spring and a third of the mass err by about phase^2/4.

    Top force of a bar with mass ratio mu at its end, over EA/L: phase (tan(phase) + mu phase)/(1 - mu phase tan(phase)); the lumped one
    differs by phase^2 (2/9 + mu/3)/(1 + mu) of it.
    """
    cable = scene.cable
    return max(forcing(scene), default=0.0) * cable.length * math.sqrt(cable.mass_per_length / cable.axial_stiffness)


def lateral_frequency(scene: Scene, tension: float) -> float:
    """First frequency at which the cable, and the water that it moves, bends as a string under its mean tension, rad/s."""
    cable = scene.cable
    water = cable.added_mass(scene.water.density) if scene.water is not None else 0.0
    return math.pi / cable.length * math.sqrt(tension / (cable.mass_per_length + water))


def straight_enough(scene: Scene, accuracy: float = 0.01) -> list[Check]:
    """The checks that speak for or against TowCable to an accuracy, each with its number and limit.

    Motion that drag or inertia damps within the cable bows it, by (L/depth)^2/4 and (omega/omega_1)^2 pi^2/8 of the top's motion; the
    tension is taken constant along the cable.
    """
    if not allowed(scene, Setting(TOW, "tow", straight(scene))):
        lacks = ", ".join(effect.words for effect in lacking(scene, "tow") if not effect.left_out)
        return [Check(f"the scene has what TowCable lacks: {lacks}", False)]
    run = timed(scene, Setting(TOW, "tow", {**straight(scene), "solver.tolerance": 1e-4}))
    if run.error:
        return [Check(f"TowCable stops: {run.error}", False)]
    tension = max(float(run.tension.mean()), 1e-9)
    limit = BOW * accuracy
    depth, deep = penetration(scene, tension), least_depth(accuracy)
    bow = steady_bow(scene, tension)
    omegas = forcing(scene)
    phase, short = axial_phase(scene), 2.0 * math.sqrt(limit)
    axial, lateral = axial_frequency(scene), lateral_frequency(scene, tension)
    apart = min((max(axial / w, w / axial) for w in omegas), default=math.inf)
    highest, slow = max(forcing(scene, "xy"), default=0.0), lateral * math.sqrt(8.0 * limit) / math.pi
    return [
        Check(f"drag penetrates {depth:.2g} lengths (at least {deep:.2g})", depth >= deep),
        Check(f"steady drag bows the cable by {bow:.2g} of its length (at most {limit:.2g})", bow <= limit),
        Check(f"nearest forcing is {apart:.3g} times off the axial frequency {axial:.3g} rad/s (at least {RESONANT:g})", apart >= RESONANT),
        Check(f"fastest forcing is {phase:.2g} rad of a wave along the cable (at most {short:.2g})", phase <= short),
        Check(f"lateral forcing up to {highest:.3g} rad/s (at most {slow:.3g}; the cable bends at {lateral:.3g})", highest <= slow),
        Check(f"least tension {run.tension.min():.3g} N of a mean of {tension:.3g} N: not slack", bool(run.tension.min() > 0.02 * tension)),
    ]
