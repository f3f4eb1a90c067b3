"""The problem that the parameters of a scene describe: cable, water, body, seabed and the numerical constants of a run."""

import math

from cable_model.kernels.choice import by_presence
from cable_model.kernels.jit import kernel
from cable_model.kernels.problem import Body, Water, body_part, body_weight, cable_part, total_weight, water_part
from cable_model.kernels.seabed import Ground
from cable_model.kernels.staggered_step import Numeric, Problem


@kernel
def _presence(present, value):
    if present is None:
        return 0.0
    return value


@kernel
def build(parts, p, pull, moves=1.0):
    """The problem that the parameters describe; `moves` 0 for statics."""
    cable = cable_part(parts.water, p)
    wave_damping = p[26] * math.sqrt(cable.stiffness * cable.mass)
    reference = math.sqrt(max(cable.gravity, 1e-3) * cable.length)
    numeric = Numeric(
        p[25] * total_weight(parts, p),
        abs(body_weight(body_part(parts.body, parts.water, p))),
        max(abs(cable.weight), 1e-6 * cable.mass * cable.gravity, 1e-12 * cable.stiffness / cable.length),
        _presence(parts.slack, wave_damping),
        _presence(parts.voigt, p[5]),
        _presence(parts.bending, p[4]),
        pull,
        1e-8 * reference,
        1e-8 * reference,
    )
    ground = _ground(parts.seabed, parts, p, cable, moves)
    return Problem(cable, _medium(parts.water, p), _body(parts.body, parts.water, p), numeric, ground)


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
    return Body(body.mass, body.added_mass, body.displaced_mass, body.weight, body.drag)


_body = by_presence(_no_body, _hung)


@kernel
def _no_ground(seabed, parts, p, cable, moves):
    return None


@kernel
def _grounded(seabed, parts, p, cable, moves):
    stiffness = p[36] * cable.diameter
    length = cable.length
    weight = max(abs(cable.weight), 1e-6 * total_weight(parts, p) / length)
    hung = abs(body_weight(body_part(parts.body, parts.water, p))) / weight
    lag = moves * 2.0 * p[37] * math.sqrt(cable.mass / stiffness)
    return Ground(p[35], stiffness, lag, moves, p[38], p[39], hung, p[25] * weight)


_ground = by_presence(_no_ground, _grounded)
