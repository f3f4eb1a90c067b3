"""Which effects a scene switches on, and why: the words behind the parts that the kernels get."""

from __future__ import annotations

from dataclasses import dataclass

from cable_model.scene import Scene, parts_of


@dataclass(frozen=True)
class Effect:
    """One optional effect of a scene."""

    name: str
    active: bool
    why: str


def _number(name: str, value: float, unit: str) -> str:
    return f"{name} = {value:g} {unit}".rstrip()


def effects(scene: Scene, model: str | None = None) -> tuple[Effect, ...]:
    """Every effect of a model ("chain" or "tow"), whether the scene has it, and the value that decides."""
    model = model or scene.run.model
    parts = parts_of(scene, model)
    cable, body, wet = scene.cable, scene.body, parts.water is not None
    dry = "no [water]"
    listed = [
        ("body", parts.body, _number("body.mass", body.mass, "kg")),
        ("anchored lower end", parts.anchor, f"lower_end.anchored = {str(scene.lower_end.anchored).lower()}"),
        ("water: buoyancy, drag, added mass", parts.water, _number("water.density", scene.water.density, "kg/m3") if scene.water else dry),
        ("current", parts.current, _current(scene) if wet else dry),
        ("waves", parts.waves, _waves(scene) if wet else dry),
        ("finite depth of the waves", parts.finite_depth, _number("water.depth", scene.water.depth, "m") if scene.water and wet else dry),
        ("waves up to the surface as it is", parts.stretched or parts.cut, f"waves.surface = {scene.waves.surface}" if wet else dry),
        ("material axial damping", parts.voigt, _number("cable.axial_damping", cable.axial_damping, "N.s")),
        ("motion out of the vertical plane", parts.space, f"solver.space = {str(scene.solver.space).lower()}"),
    ]
    if model == "chain":
        box = parts.box is not None
        listed += [
            ("bending", parts.bending, _number("cable.bending_stiffness", cable.bending_stiffness, "N.m2")),
            ("stretch", None if parts.inextensible else True, f"cable.inextensible = {str(cable.inextensible).lower()}"),
            (
                "slack (no compression)",
                parts.slack,
                "the box grid uses the linear law" if box else f"cable.compressible = {str(cable.compressible).lower()}",
            ),
            ("seabed", parts.seabed, _number("seabed.stiffness", scene.seabed.stiffness, "Pa/m")),
            ("friction along the seabed", parts.friction, _number("seabed.friction_coefficient", scene.seabed.friction_coefficient, "")),
            ("winch", parts.winch, f"winch.fitted = {str(scene.winch.fitted).lower()}"),
            ("table of the axial stiffness", parts.curve, f"cable.stiffness_curve has {len(cable.stiffness_curve)} rows"),
        ]
    else:
        listed += [
            ("cable mass", parts.cable_mass, f"tow.cable_mass = {str(scene.tow.cable_mass).lower()}"),
            ("tension floor", parts.tension_floor, _number("tow.minimum_tension", scene.tow.minimum_tension, "N")),
            ("thinning under stretch", scene.tow.poisson_ratio or None, _number("tow.poisson_ratio", scene.tow.poisson_ratio, "")),
            ("the report's misprints", parts.as_printed, f"tow.as_printed = {str(scene.tow.as_printed).lower()}"),
        ]
    return tuple(Effect(name, present is not None, why) for name, present, why in listed)


def _waves(scene: Scene) -> str:
    if scene.waves.spectrum != "none":
        return f"waves.spectrum = {scene.waves.spectrum}, {scene.waves.components} components"
    if scene.waves.table:
        return f"waves.table has {len(scene.waves.table)} rows"
    return _number("waves.amplitude", scene.waves.amplitude, "m")


def _current(scene: Scene) -> str:
    if scene.current.levels:
        return f"current.levels has {len(scene.current.levels)} rows"
    return _number("current.speed", scene.current.speed, "m/s")


def unknowns_per_node(scene: Scene, model: str | None = None) -> int:
    """Unknowns that are solved for at each node of the chain; for TowCable its degrees of freedom in all."""
    model = model or scene.run.model
    parts = parts_of(scene, model)
    if model == "tow":
        return 3 if parts.space is not None else 2
    if parts.box is not None:
        return 6 if parts.bending is not None else 4
    return 3 if parts.space is not None else 2


def one_line(scene: Scene, model: str | None = None) -> str:
    """The active effects and what switched each on, on one line for a log."""
    return "; ".join(f"{e.name} ({e.why})" for e in effects(scene, model) if e.active)
