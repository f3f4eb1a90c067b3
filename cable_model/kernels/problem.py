"""Cable, body and water as named constants, from the record `p` of all numbers (parts.NUMBERS)."""

from typing import NamedTuple

from cable_model.kernels.choice import without
from cable_model.kernels.jit import kernel

NEUTRAL = 1e-6  # share of the weight in air below which a weight in water is one of rounding and of measured densities
in_calm_water = without("waves", "finite_depth", "stretched", "cut")  # the same parts without waves


class Cable(NamedTuple):
    length: float
    diameter: float
    mass: float  # per unstretched length, kg/m
    stiffness: float  # EA, N
    gravity: float
    weight: float  # in the medium, per unstretched length, N/m


class Body(NamedTuple):
    mass: float
    added_mass: float
    displaced_mass: float
    weight: float  # in the medium, N
    drag: float  # 1/2 rho Cd A, kg/m
    radius: float  # of the sphere of its volume, no less than the cable's, m


class Water(NamedTuple):
    normal_drag: float  # 1/2 rho d Cn, kg/m2
    tangential_drag: float  # 1/2 rho d Ct, kg/m2
    added_mass: float  # per unstretched length, kg/m
    displaced_mass: float  # per unstretched length, kg/m


@kernel
def displaced_area(p):
    """Displaced volume per unstretched length, m2: that of the diameter unless given."""
    cable = p[0].cable
    if cable.volume_per_length >= 0.0:
        return cable.volume_per_length
    return 0.25 * 3.141592653589793 * cable.diameter * cable.diameter


@kernel
def cable_part(water, p):
    area = displaced_area(p)
    cable, gravity = p[0].cable, p[0].environment.gravity
    mass = cable.mass_per_length
    density = 0.0
    if water is not None:
        density = p[0].water.density
    return Cable(cable.length, cable.diameter, mass, cable.axial_stiffness, gravity, (mass - density * area) * gravity)


@kernel
def body_part(body, water, p):
    if body is None:
        return None
    hung = p[0].body
    density = 0.0
    if water is not None:
        density = p[0].water.density
    added = 0.0
    if water is not None:
        added = hung.added_mass
    weight = (hung.mass - density * hung.volume) * p[0].environment.gravity
    radius = max((0.75 / 3.141592653589793 * hung.volume) ** (1.0 / 3.0), 0.5 * p[0].cable.diameter)
    return Body(hung.mass, added, density * hung.volume, weight, 0.5 * density * hung.drag_area, radius)


@kernel
def water_part(water, p):
    if water is None:
        return None
    cable, density = p[0].cable, p[0].water.density
    added = density * 0.25 * 3.141592653589793 * cable.diameter * cable.diameter * cable.added_mass_coefficient
    drag = 0.5 * density * cable.diameter
    return Water(drag * cable.normal_drag_coefficient, drag * cable.tangential_drag_coefficient, added, density * displaced_area(p))


@kernel
def body_weight(body):
    """Weight of the body in the medium, N; 0 without a body."""
    if body is None:
        return 0.0
    return body.weight


@kernel
def body_mass(body):
    if body is None:
        return 0.0
    return body.mass


@kernel
def is_neutral(parts, p):
    """Whether cable and body weigh next to nothing in the water, either way; and what they weigh, N, and their mass, kg."""
    cable = cable_part(parts.water, p)
    body = body_part(parts.body, parts.water, p)
    weight = abs(cable.weight) * cable.length + abs(body_weight(body))
    mass = cable.mass * cable.length + body_mass(body)
    return weight <= NEUTRAL * mass * cable.gravity, weight, mass


@kernel
def node_count(p):
    return int(p[0].solver.nodes)


@kernel
def total_weight(parts, p):
    """Force scale W: weights in the medium of cable and body, N; never zero."""
    cable = cable_part(parts.water, p)
    weight = abs(cable.weight) * cable.length
    weight += abs(body_weight(body_part(parts.body, parts.water, p)))
    return max(weight, 1e-6 * cable.mass * cable.gravity * cable.length, 1e-12 * cable.stiffness)
