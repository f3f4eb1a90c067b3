"""Whether a straight cable may stand for the scene, by its scales: drag penetration, resonance, slack; it runs TowCable alone."""

from __future__ import annotations

import math
from dataclasses import dataclass

from cable_model.scene import Scene, parts_of
from cable_model.studies.settings import TOW, allowed
from cable_model.studies.timed import Setting, timed

SHALLOW = 0.4  # penetration depth over the length below which a straight cable says nothing about lateral motion
RESONANT = 3.0  # forcing nearer to the first axial frequency than this factor


@dataclass(frozen=True)
class Check:
    """One reason for or against the cheap model."""

    words: str
    holds: bool


def forcing(scene: Scene) -> list[float]:
    """Angular frequencies of top and waves, rad/s."""
    found = [part.angular_frequency for part in scene.top.motion if part.kind == "sinusoid" and part.amplitude != 0.0]
    waves = parts_of(scene, "chain").waves
    if waves is not None:
        found += [float(row[1]) for row in waves]
    return [omega for omega in found if omega > 0.0]


def penetration(scene: Scene, tension: float) -> float:
    """Depth over the length to which lateral motion of the top reaches before drag stops it: sqrt(2 T/(c omega))/L; infinite without drag.

    c is the linearised drag 8/(3 pi) 1/2 rho C_D d v of the top's lateral velocity v.
    """
    speeds = [abs(m.amplitude) * m.angular_frequency for m in scene.top.motion if m.kind == "sinusoid" and m.axis != "z"]
    speed = max(speeds, default=0.0)
    if scene.water is None or speed == 0.0:
        return math.inf
    omega = max(m.angular_frequency for m in scene.top.motion if m.kind == "sinusoid" and m.axis != "z" and m.amplitude != 0.0)
    drag = 8.0 / (3.0 * math.pi) * 0.5 * scene.water.density * scene.cable.normal_drag_coefficient * scene.cable.diameter * speed
    if drag == 0.0:
        return math.inf
    return math.sqrt(2.0 * tension / (drag * omega)) / scene.cable.length


def axial_frequency(scene: Scene) -> float:
    """First axial frequency of body and a third of the cable on the cable's spring, rad/s."""
    cable = scene.cable
    mass = scene.body.mass + scene.body.added_mass + cable.mass_per_length * cable.length / 3.0
    return math.sqrt(cable.axial_stiffness / cable.length / mass)


def lateral_frequency(scene: Scene, tension: float) -> float:
    """First frequency at which the cable bends as a string under its mean tension, rad/s."""
    return math.pi / scene.cable.length * math.sqrt(tension / scene.cable.mass_per_length)


def straight_enough(scene: Scene) -> list[Check]:
    """The checks that rule TowCable out at once, each with its number."""
    if not allowed(scene, Setting(TOW, "tow", {})):
        return [Check("the scene has what TowCable lacks (anchor, seabed, winch or table of the stiffness)", False)]
    run = timed(scene, Setting(TOW, "tow", {"solver.grid": "staggered", "solver.tolerance": 1e-4, "cable.inextensible": False}))
    if run.error:
        return [Check(f"TowCable stops: {run.error}", False)]
    tension = max(float(run.tension.mean()), 1e-9)
    depth = penetration(scene, tension)
    omegas = forcing(scene)
    axial, lateral = axial_frequency(scene), lateral_frequency(scene, tension)
    apart = min((max(axial / w, w / axial) for w in omegas), default=math.inf)
    below = max(omegas, default=0.0)
    return [
        Check(f"drag penetrates {depth:.2g} lengths (at least {SHALLOW})", depth >= SHALLOW),
        Check(f"nearest forcing is {apart:.3g} times off the axial frequency {axial:.3g} rad/s (at least {RESONANT:g})", apart >= RESONANT),
        Check(f"forcing up to {below:.3g} rad/s, the cable bends from {lateral:.3g} rad/s on", below < lateral),
        Check(f"least tension {run.tension.min():.3g} N of a mean of {tension:.3g} N: not slack", bool(run.tension.min() > 0.02 * tension)),
    ]
