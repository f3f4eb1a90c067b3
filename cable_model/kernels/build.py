"""The problem that the parameters of a scene describe: cable, water, body, seabed and the numerical constants of a run."""

import math

from cable_model.kernels.bottom import slope_of
from cable_model.kernels.cells import presence, wave_damping
from cable_model.kernels.choice import by_presence
from cable_model.kernels.jit import kernel
from cable_model.kernels.problem import (
    Body,
    Numeric,
    Problem,
    body_part,
    body_weight,
    cable_part,
    density_of,
    own_weight,
    slack_weight,
    total_weight,
    water_of,
    with_some_weight,
)
from cable_model.kernels.seabed import Ground
from cable_model.kernels.vector import axes


@kernel
def build(parts, p, pull, moves=1.0):
    """The problem that the parameters describe; `moves` 0 for statics.  Of a cable with sections it is that of the whole: see cells.py."""
    cable = with_some_weight(cable_part(parts.water, p), 1.0 - moves)
    reference = math.sqrt(max(cable.gravity, 1e-3) * cable.length)
    numeric = Numeric(
        p[0].solver.slack_smoothing * slack_weight(parts, p),
        abs(body_weight(body_part(parts.body, parts.water, p))),
        own_weight(cable),
        presence(parts.slack, wave_damping(p, cable)),
        presence(parts.voigt, p[0].cable.axial_damping),
        presence(parts.bending, p[0].cable.bending_stiffness),
        pull,
        1e-8 * reference,
        1e-8 * reference,
        0.0,
        0.0,
        1.0 - moves,
        1e300,
        0.0,
    )
    ground = _ground(parts.seabed, parts, p, cable, moves)
    return Problem(cable, _medium(parts.water, p), _body(parts.body, parts.water, p), numeric, ground, p)


@kernel
def _absent(part, p):
    return None


@kernel
def _wet(water, p):
    return water_of(p[0].cable, density_of(water, p))


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
def _upright(slope, parts, p):
    return axes(parts.space, 0.0, 0.0, 1.0)


@kernel
def _inclined(slope, parts, p):
    along_x, along_y = slope_of(p)
    c = 1.0 / math.sqrt(1.0 + along_x * along_x + along_y * along_y)
    return axes(parts.space, -c * along_x, -c * along_y, c)


_normal = by_presence(_upright, _inclined)  # of the bottom, where it is a plane


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
    density = density_of(parts.water, p)
    normal = _normal(parts.slope, parts, p)
    level = bed.level * normal[len(normal) - 1]
    return Ground(
        level, stiffness, lag, moves, friction, grip, drag, laid, hung, smoothing, parts.sections, weight, density, p,
        parts.line_bodies, 0.0, parts.slope, normal, parts.relief,
    )  # fmt: skip


_ground = by_presence(_no_ground, _grounded)
