"""What is simulated, as named constants from the record `p` of all numbers (parts.NUMBERS): cable, body, water, and those of the method."""

from typing import NamedTuple

from cable_model.kernels.choice import by_presence, without
from cable_model.kernels.jit import kernel
from cable_model.kernels.line_bodies import sizes_of_bodies
from cable_model.kernels.sections import sizes_of_weights

NEUTRAL = 1e-6  # share of the weight in air below which a weight in water is one of rounding and of measured densities
LEAST_WEIGHT = 1e-9  # of its weight in air, which a cable has at rest at least
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


class Numeric(NamedTuple):
    """Constants of a run that are neither cable nor water."""

    smoothing: float  # largest w0 of the slack law, N; see slack.width
    hung: float  # weight of the body, N
    own: float  # weight of the cable, N/m
    damping: float  # slack law: axial damping per cell length, zeta sqrt(EA m), N s/m
    voigt: float  # material axial damping, N s
    bending: float  # EI, N m2
    pull: float  # horizontal force on the lower end, N
    tolerance: float  # of the Newton iteration on velocities, m/s
    rounding: float  # changes of velocities that may be rounding errors, m/s
    blunt: float = 0.0  # of a cell: sqrt(q^2 + blunt^2) is its stretch, so that one that vanishes keeps a direction; 0 but in statics
    turn: float = 0.0  # largest change of a cell vector within an iteration; 0: any
    rests: float = 0.0  # 1 in statics
    stiffest: float = 1e300  # EA that statics let a cell have, N
    thinnest: float = 0.0  # and diameter, m


class Problem(NamedTuple):
    """What moves: see the classes above."""

    cable: object
    medium: object
    body: object
    numeric: object
    ground: object  # the seabed
    numbers: object  # the record of all numbers, for effects that need no more than their own


@kernel
def with_tolerance(problem, tolerance, rounding):
    """The same problem in motion with other limits of Newton's method, m/s."""
    old = problem.numeric
    numeric = Numeric(
        old.smoothing, old.hung, old.own, old.damping, old.voigt, old.bending, old.pull, tolerance, rounding, 0.0, 0.0, 0.0, 1e300, 0.0
    )
    return Problem(problem.cable, problem.medium, problem.body, numeric, problem.ground, problem.numbers)


@kernel
def shortened(problem, length):
    """The same problem with what is left of the cable; the width of the slack law goes with its weight."""
    old, numeric = problem.cable, problem.numeric
    cable = Cable(length, old.diameter, old.mass, old.stiffness, old.gravity, old.weight)
    numeric = Numeric(
        length / old.length * numeric.smoothing, numeric.hung, numeric.own, numeric.damping, numeric.voigt, numeric.bending, numeric.pull,
        numeric.tolerance, numeric.rounding, numeric.blunt, numeric.turn, numeric.rests, numeric.stiffest, numeric.thinnest,
    )  # fmt: skip
    return Problem(cable, problem.medium, problem.body, numeric, problem.ground, problem.numbers)


@kernel
def density_of(water, p):
    """Of the water, kg/m3; 0 without any."""
    if water is None:
        return 0.0
    return p[0].water.density


@kernel
def displaced_area(made):
    """Displaced volume per unstretched length of what a cable is made of, m2: that of the diameter unless given."""
    if made.volume_per_length >= 0.0:
        return made.volume_per_length
    return 0.25 * 3.141592653589793 * made.diameter * made.diameter


@kernel
def cable_part(water, p):
    return cable_of(p[0].cable, p[0].cable.length, density_of(water, p), p[0].environment.gravity)


@kernel
def cable_of(made, length, density, gravity):
    """A cable of this length, all of which is made as `made` says."""
    mass = made.mass_per_length
    return Cable(length, made.diameter, mass, made.axial_stiffness, gravity, (mass - density * displaced_area(made)) * gravity)


@kernel
def with_some_weight(cable, rests):
    """The cable, which at rest (`rests` 1, else 0) hangs straight down where it weighs next to nothing: rounding would crumple it."""
    weight = cable.weight
    least = rests * LEAST_WEIGHT * cable.mass * cable.gravity
    if abs(weight) < least:
        weight = least
    return Cable(cable.length, cable.diameter, cable.mass, cable.stiffness, cable.gravity, weight)


@kernel
def own_weight(cable):
    """Of a metre in the scale of the slack law, N/m; never zero."""
    return max(abs(cable.weight), 1e-6 * cable.mass * cable.gravity, 1e-12 * cable.stiffness / cable.length)


@kernel
def body_part(body, water, p):
    if body is None:
        return None
    return body_of(p[0].body, water, p)


@kernel
def body_of(hung, water, p):
    """What `hung` is in the medium."""
    density = density_of(water, p)
    added = 0.0
    if water is not None:
        added = hung.added_mass
    weight = (hung.mass - density * hung.volume) * p[0].environment.gravity
    radius = max((0.75 / 3.141592653589793 * hung.volume) ** (1.0 / 3.0), 0.5 * p[0].cable.diameter)
    return Body(hung.mass, added, density * hung.volume, weight, 0.5 * density * hung.drag_area, radius)


@kernel
def thickened(body, diameter):
    """The body with at least this diameter, m: over it statics spread the water's surface."""
    return Body(body.mass, body.added_mass, body.displaced_mass, body.weight, body.drag, max(body.radius, 0.5 * diameter))


@kernel
def water_of(made, density):
    """Water of this density about a cable that is made as `made` says."""
    added = density * 0.25 * 3.141592653589793 * made.diameter * made.diameter * made.added_mass_coefficient
    drag = 0.5 * density * made.diameter
    return Water(drag * made.normal_drag_coefficient, drag * made.tangential_drag_coefficient, added, density * displaced_area(made))


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
def _as_one(sections, parts, p):
    cable = cable_part(parts.water, p)
    return abs(cable.weight) * cable.length


@kernel
def _in_pieces(sections, parts, p):
    return sizes_of_weights(sections, density_of(parts.water, p), p[0].environment.gravity)


_cable_weight = by_presence(_as_one, _in_pieces)  # sum of the sizes of the weights of all of the cable, N


@kernel
def is_neutral(parts, p):
    """Whether cable and body weigh next to nothing in the water, either way; and what they weigh, N, and their mass, kg."""
    cable = cable_part(parts.water, p)
    body = body_part(parts.body, parts.water, p)
    on_line, their_mass = sizes_of_bodies(parts.line_bodies, density_of(parts.water, p), cable.gravity)
    weight = _cable_weight(parts.sections, parts, p) + abs(body_weight(body)) + on_line
    mass = cable.mass * cable.length + body_mass(body) + their_mass
    return weight <= NEUTRAL * mass * cable.gravity, weight, mass


@kernel
def node_count(p):
    return int(p[0].solver.nodes)


@kernel
def total_weight(parts, p):
    """Force scale W: sizes of the weights in the medium of cable and bodies, N; never zero."""
    on_line, _ = sizes_of_bodies(parts.line_bodies, density_of(parts.water, p), p[0].environment.gravity)
    return slack_weight(parts, p) + on_line


@kernel
def slack_weight(parts, p):
    """The same without the bodies on the cable, N, which some of its lengths hang from and others do not: the scale of what is slack."""
    cable = cable_part(parts.water, p)
    weight = _cable_weight(parts.sections, parts, p)
    weight += abs(body_weight(body_part(parts.body, parts.water, p)))
    return max(weight, 1e-6 * cable.mass * cable.gravity * cable.length, 1e-12 * cable.stiffness)
