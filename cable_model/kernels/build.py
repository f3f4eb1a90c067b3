"""The problem that the parameters of a scene describe: cable, water, body, seabed and the numerical constants of a run."""

import math

from cable_model.kernels.choice import by_presence
from cable_model.kernels.jit import kernel
from cable_model.kernels.problem import Body, Cable, Water, body_part, body_weight, cable_part, total_weight, water_part
from cable_model.kernels.seabed import Ground
from cable_model.kernels.staggered_step import Numeric, Problem

LEAST_WEIGHT = 1e-9  # of its weight in air, which a cable has at rest at least


@kernel
def _presence(present, value):
    if present is None:
        return 0.0
    return value


@kernel
def _with_some_weight(cable, rests):
    """The cable, which at rest (`rests` 1, else 0) hangs straight down where it weighs next to nothing: rounding would crumple it."""
    weight = cable.weight
    least = rests * LEAST_WEIGHT * cable.mass * cable.gravity
    if abs(weight) < least:
        weight = least
    return Cable(cable.length, cable.diameter, cable.mass, cable.stiffness, cable.gravity, weight)


@kernel
def build(parts, p, pull, moves=1.0):
    """The problem that the parameters describe; `moves` 0 for statics."""
    cable = _with_some_weight(cable_part(parts.water, p), 1.0 - moves)
    wave_damping = p[0].solver.slack_damping * math.sqrt(cable.stiffness * cable.mass)
    reference = math.sqrt(max(cable.gravity, 1e-3) * cable.length)
    numeric = Numeric(
        p[0].solver.slack_smoothing * total_weight(parts, p),
        abs(body_weight(body_part(parts.body, parts.water, p))),
        max(abs(cable.weight), 1e-6 * cable.mass * cable.gravity, 1e-12 * cable.stiffness / cable.length),
        _presence(parts.slack, wave_damping),
        _presence(parts.voigt, p[0].cable.axial_damping),
        _presence(parts.bending, p[0].cable.bending_stiffness),
        pull,
        1e-8 * reference,
        1e-8 * reference,
        0.0,
        0.0,
    )
    ground = _ground(parts.seabed, parts, p, cable, moves)
    return Problem(cable, _medium(parts.water, p), _body(parts.body, parts.water, p), numeric, ground, p)


@kernel
def _absent(part, p):
    return None


@kernel
def _wet(water, p):
    medium = water_part(water, p)
    return Water(medium.normal_drag, medium.tangential_drag, medium.added_mass, medium.displaced_mass)


_medium = by_presence(_absent, _wet)


@kernel
def _no_body(part, water, p):
    return None


@kernel
def _hung(part, water, p):
    body = body_part(part, water, p)
    return Body(body.mass, body.added_mass, body.displaced_mass, body.weight, body.drag, body.radius)


_body = by_presence(_no_body, _hung)


@kernel
def _no_ground(seabed, parts, p, cable, moves):
    return None


@kernel
def _grounded(seabed, parts, p, cable, moves):
    bed = p[0].seabed
    stiffness = bed.stiffness * cable.diameter
    length = cable.length
    weight = max(abs(cable.weight), 1e-6 * total_weight(parts, p) / length)
    hung = abs(body_weight(body_part(parts.body, parts.water, p))) / weight
    lag = moves * 2.0 * bed.damping_ratio * math.sqrt(cable.mass / stiffness)
    smoothing = p[0].solver.slack_smoothing * weight
    laid = (1.0 - moves) * bed.laid_from_anchor
    friction = max(moves, laid) * bed.friction_coefficient
    grip, drag = friction * weight / bed.friction_displacement, moves * friction * weight / bed.friction_velocity
    return Ground(bed.level, stiffness, lag, moves, friction, grip, drag, laid, hung, smoothing)


_ground = by_presence(_no_ground, _grounded)
