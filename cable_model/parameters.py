"""What a scene may hold: one frozen data class a part, every value with its unit, rule and meaning.  SI, z up from still water."""

from __future__ import annotations

import dataclasses
import functools
import math
from dataclasses import dataclass
from typing import Any

from cable_model.quantity import quantity

INTEGRATORS = ("generalized-alpha", "backward-difference", "trapezoidal", "generalized-trapezoidal", "cornwell-malkus", "wbz")
FULL_TURN = 6.284  # rad, a full one: angles beyond it are degrees


@dataclass(frozen=True)
class Section:
    """A length of the cable that is alike."""

    length: float = quantity("m", "unstretched length", above=0.0)
    mass_per_length: float = quantity("kg/m", "mass per unstretched length", above=0.0)
    axial_stiffness: float = quantity("N", "axial stiffness EA", above=0.0)
    diameter: float = quantity("m", "diameter that meets the water", default=0.0, least=0.0)
    bending_stiffness: float = quantity("N.m2", "bending stiffness EI (0 = no bending)", default=0.0, least=0.0)
    axial_damping: float = quantity("N.s", "material axial damping: tension per strain rate (0 = none)", default=0.0, least=0.0)
    normal_drag_coefficient: float = quantity("1", "normal drag coefficient", default=0.0, least=0.0)
    tangential_drag_coefficient: float = quantity(
        "1", "tangential drag coefficient (times the diameter, not the perimeter)", default=0.0, least=0.0
    )
    added_mass_coefficient: float = quantity("1", "normal added mass over the mass of water in the diameter", default=0.0, least=0.0)
    volume_per_length: float = quantity(
        "m2", "displaced volume per length, as of a chain (-1 = that of the diameter)", default=-1.0, least=-1.0, gap=(-1.0, 0.0)
    )
    breaking_tension: float = quantity("N", "tension at which the cable breaks (0 = never)", default=0.0, least=0.0)

    @property
    def displaced_area(self) -> float:
        """Displaced volume per length, m2."""
        return self.volume_per_length if self.volume_per_length >= 0.0 else 0.25 * math.pi * self.diameter**2

    def added_mass(self, density: float) -> float:
        """Normal added mass per length in water of a density, kg/m."""
        return self.added_mass_coefficient * density * 0.25 * math.pi * self.diameter**2


@dataclass(frozen=True)
class LineBody:
    """A body on the cable between its ends, as the one on its lower end."""

    at: float = quantity("m", "unstretched length of cable below it", above=0.0)
    mass: float = quantity("kg", "mass of the body", above=0.0)
    volume: float = quantity("m3", "displaced volume of the body", default=0.0, least=0.0)
    drag_area: float = quantity("m2", "drag coefficient times frontal area of the body", default=0.0, least=0.0)
    added_mass: float = quantity("kg", "added mass of the body", default=0.0, least=0.0)


@dataclass(frozen=True)
class Cable(Section):
    """The cable itself; of one with sections what they have on the whole, see cable_model.sections."""

    quadratic_damping: float = quantity("N.s2", "axial damping: tension per square of the strain rate (0 = none)", default=0.0, least=0.0)
    stiffness_curve: tuple[tuple[float, float], ...] = quantity(
        "1, N", "table of [strain, tension] from [0, 0] up, joined smoothly, in place of axial_stiffness", default=()
    )
    compressible: bool = quantity("", "whether the cable may carry compression (linear law instead of slack)", default=False)
    inextensible: bool = quantity("", "whether stretch is left out (box grid only)", default=False)
    section: tuple[Section, ...] = quantity("", "sections from the lower end to the top", default=())
    body: tuple[LineBody, ...] = quantity("", "bodies on the cable between its ends", default=())


@dataclass(frozen=True)
class LowerEnd:
    """What holds the lower end, if anything but the body does."""

    anchored: bool = quantity("", "whether the lower end is held", default=False)
    x: float = quantity("m", "position of the anchor, x", default=0.0)
    y: float = quantity("m", "position of the anchor, y", default=0.0)
    z: float = quantity("m", "position of the anchor, z", default=0.0)
    release_force: float = quantity("N", "force along x that holds the lower end aside until the start", default=0.0)
    released: bool = quantity("", "whether an anchored lower end is let go at the start", default=False)
    driven: bool = quantity("", "whether a held lower end moves as inputs say", default=False)
    clamped: bool = quantity("", "whether a held lower end is clamped: the cable begins at the clamp's angles", default=False)
    clamp_declination: float = quantity(
        "rad", "angle from straight up at which the cable leaves the clamp", default=0.0, least=0.0, most=FULL_TURN
    )
    clamp_direction: float = quantity(
        "rad", "direction towards which it leans there, from x towards y", default=0.0, least=-FULL_TURN, most=FULL_TURN
    )


@dataclass(frozen=True)
class Parting:
    """When the cable is cut: what is below has gone, with what held the lower end, or the body there."""

    time: float = quantity("s", "time from the start at which the cable is cut (0 = never)", default=0.0, least=0.0)
    place: float = quantity(
        "m", "unstretched length below the place where it is cut; 0: the lower end is let go, or its body", default=0.0, least=0.0
    )
    by_input: bool = quantity("", "whether the input lower_end.let_go cuts it", default=False)


@dataclass(frozen=True)
class Body:
    """A body at the lower end; a point with vector drag, buoyancy and added mass."""

    mass: float = quantity("kg", "mass of the body (0 = free end)", default=0.0, least=0.0)
    volume: float = quantity("m3", "displaced volume of the body", default=0.0, least=0.0)
    drag_area: float = quantity("m2", "drag coefficient times frontal area of the body", default=0.0, least=0.0)
    added_mass: float = quantity("kg", "added mass of the body", default=0.0, least=0.0)


@dataclass(frozen=True)
class Environment:
    gravity: float = quantity("m/s2", "acceleration of gravity", default=9.80665, least=0.0)


@dataclass(frozen=True)
class Water:
    density: float = quantity("kg/m3", "density of the water (0 = none)", default=1025.0, least=0.0)
    depth: float = quantity("m", "depth that the waves feel (0 = deep water)", default=0.0, least=0.0)
    surface: bool = quantity("", "whether cable and body are dry above the surface (false: there is water everywhere)", default=True)
    current_input: bool = quantity("", "whether inputs give a current that adds to the scene's", default=False)


@dataclass(frozen=True)
class Seabed:
    """An elastic bottom, level unless it is given a slope, a profile or a grid; it needs the cable's diameter."""

    level: float = quantity("m", "height z of the seabed, where it slopes that at x = y = 0", default=0.0)
    stiffness: float = quantity("Pa/m", "pressure per depth of penetration, on the diameter (0 = no seabed)", default=0.0, least=0.0)
    damping_ratio: float = quantity("1", "damping of a node on the seabed over the critical one", default=1.0, least=0.0)
    friction_coefficient: float = quantity("1", "Coulomb friction along the seabed (0 = none)", default=0.0, least=0.0)
    friction_displacement: float = quantity("m", "displacement at which a cable begins to slide over the seabed", default=1e-3, above=0.0)
    friction_velocity: float = quantity(
        "m/s", "velocity at which it slides at once; until it slides, friction is that of a spring and a dashpot", default=0.01, above=0.0
    )
    slope: float = quantity("1", "slope of the seabed: its rise over the way along slope_direction", default=0.0)
    slope_direction: float = quantity("rad", "direction in which it rises, from x towards y", default=0.0, least=-FULL_TURN, most=FULL_TURN)
    profile: tuple[tuple[float, float], ...] = quantity(
        "m, m", "heights of a seabed that is not level along x, rows of [x, z]; cubics between them, straight on beyond", default=()
    )
    grid: tuple[tuple[float, float, float], ...] = quantity(
        "m, m, m", "heights on a rectangular grid, rows of [x, y, z], each x with the same y", default=()
    )
    laid_from_anchor: bool = quantity(
        "", "whether the cable starts with the friction of one laid out straight from its anchor (false: without friction)", default=False
    )


@dataclass(frozen=True)
class Current:
    """A current: one speed at all depths, a table of levels, or one that changes over time."""

    speed: float = quantity("m/s", "speed of the current", default=0.0)
    direction: float = quantity("rad", "direction the current flows to, from x towards y", default=0.0, least=-FULL_TURN, most=FULL_TURN)
    levels: tuple[tuple[float, float, float], ...] = quantity(
        "m, m/s, rad", "table of [z, speed, direction]; between levels linear, beyond them held", default=()
    )
    table: tuple[tuple[float, float, float, float], ...] = quantity(
        "s, m, m/s, rad", "table of [time, z, speed, direction], the same levels at every time; between them linear, beyond them held",
        default=(),
    )  # fmt: skip
    ramp_time: float = quantity("s", "time in which the current grows from nothing at the start (0 = it is there)", default=0.0, least=0.0)


@dataclass(frozen=True)
class Waves:
    """A regular wave, or an irregular sea from a spectrum or a table of components."""

    amplitude: float = quantity("m", "amplitude of the wave (0 = none)", default=0.0, least=0.0)
    period: float = quantity("s", "period of the wave", default=10.0, above=0.0)
    direction: float = quantity("rad", "direction the wave runs to, from x towards y", default=0.0, least=-FULL_TURN, most=FULL_TURN)
    phase: float = quantity("rad", "phase of the wave: elevation a cos(k s - omega t + phase)", default=0.0)
    spectrum: str = quantity("", "spectrum of an irregular sea", default="none", choices=("none", "pierson-moskowitz", "jonswap"))
    significant_height: float = quantity("m", "significant wave height of the spectrum", default=0.0, least=0.0)
    peak_period: float = quantity("s", "period of the spectrum's peak", default=10.0, above=0.0)
    peakedness: float = quantity("1", "peakedness gamma of the JONSWAP spectrum", default=3.3, least=1.0, most=10.0)
    components: int = quantity("1", "number of components of the spectrum", default=60, least=1, most=10000)
    seed: int = quantity("1", "seed of the components' phases and of their directions' order", default=1, least=0, most=2147483646)
    spreading_exponent: float = quantity(
        "1", "exponent n of the sea's spreading, energy as cos^n of the angle from waves.direction, n = 2s (0 = long-crested)",
        default=0.0, least=0.0, most=1000.0, gap=(0.0, 1.0), remedy="Take 2, as is usual, or 0.",
    )  # fmt: skip
    table: tuple[tuple[float, float, float, float], ...] = quantity(
        "m, s, rad, rad", "components: rows of [amplitude, period, direction, phase]", default=()
    )
    record: tuple[tuple[float, float], ...] = quantity(
        "s, m", "record of the elevation at x = y = 0: rows of [time, elevation] at equal steps; it repeats", default=()
    )
    ramp_time: float = quantity("s", "time in which waves grow from nothing at the start (0 = they are there)", default=0.0, least=0.0)
    surface: str = quantity(
        "", "waves above still water: as at z = 0, stretched to the surface as it is, or cut off there", default="held",
        choices=("held", "wheeler", "cut"),
    )  # fmt: skip
    exact: bool = quantity("", "whether all components are summed wherever and whenever they are needed, which takes longer", default=False)


@dataclass(frozen=True)
class Tow:
    """What only TowCable [Wang 1971] has."""

    poisson_ratio: float = quantity("1", "Poisson's ratio: thinning under stretch", default=0.0, least=0.0, most=0.5)
    reference_tension: float = quantity("N", "tension at which length and diameter were measured", default=0.0, least=0.0)
    drag_segments: int = quantity("1", "number of segments of the cable's drag", default=10, least=1, most=1000)
    minimum_tension: float = quantity("N", "floor of the mean tension (TENS)", default=0.0)
    cable_mass: bool = quantity("", "whether the cable has mass (CBMAS)", default=True)
    body_angle: float = quantity("rad", "angle of a disk-like body to the vertical; beyond pi the body is a sphere (PHIBD)", default=18.0)
    drag_area_axial: float = quantity("m2", "drag coefficient times area of a disk-like body along its axis", default=0.0, least=0.0)
    added_mass_vertical: float = quantity(
        "kg", "vertical added mass of the body (-1 = as body.added_mass)", default=-1.0, least=-1.0, gap=(-1.0, 0.0)
    )
    as_printed: bool = quantity("", "whether the report's errors are kept, to compare with its figures", default=False)
    explicit: bool = quantity("", "whether the report's explicit Kutta-Merson method is used", default=False)


@dataclass(frozen=True)
class Winch:
    """A winch at the top that pays cable out and hauls it in."""

    fitted: bool = quantity("", "whether a winch changes the cable's length", default=False)
    speeds: tuple[tuple[float, float], ...] = quantity(
        "s, m/s", "table of [time, speed paid out]; between its rows linear, beyond them held", default=()
    )


@dataclass(frozen=True)
class Motion:
    """One part of an end's motion along one axis; parts add up."""

    kind: str = quantity("", "kind of motion", choices=("sinusoid", "ramp", "step"))
    axis: str = quantity("", "axis of the motion", choices=("x", "y", "z"))
    amplitude: float = quantity("m", "amplitude of a sinusoid", default=0.0)
    angular_frequency: float = quantity("rad/s", "angular frequency of a sinusoid", default=0.0, least=0.0)
    period: float = quantity("s", "period of a sinusoid, in place of its angular frequency", default=0.0, least=0.0)
    frequency: float = quantity("1/s", "frequency of a sinusoid, in place of its angular frequency", default=0.0, least=0.0)
    phase: float = quantity("rad", "phase: amplitude sin(angular_frequency (t - start) + phase)", default=0.0)
    start: float = quantity("s", "time at which the motion begins", default=0.0, least=0.0)
    stop: float = quantity("s", "time at which the motion ends (0 = never)", default=0.0, least=0.0)
    ramp_time: float = quantity("s", "time over which it fades in", default=0.0, least=0.0)
    ramp: str = quantity("", "how it fades in: three continuous derivatives, or one", default="septic", choices=("septic", "cubic"))
    velocity: float = quantity("m/s", "change of velocity of a ramp or step", default=0.0)
    duration: float = quantity("s", "time in which a ramp changes the velocity", default=0.0, least=0.0)

    @property
    def omega(self) -> float:
        """Angular frequency of a sinusoid, rad/s, in whichever way it is given."""
        return 2.0 * math.pi / self.period if self.period > 0.0 else 2.0 * math.pi * self.frequency or self.angular_frequency


@dataclass(frozen=True)
class Top:
    """The prescribed motion of the upper end."""

    position: tuple[float, float, float] = quantity("m", "position about which the top moves", default=(0.0, 0.0, 0.0))
    motion_order: int = quantity("1", "connected inputs: 0 position, 1 and velocity, 2 and acceleration", default=1, least=0, most=2)
    inputs_at: int = quantity(
        "1", "where in the communication step a co-simulation gives its inputs: 0 at the start, 1 at the end", default=0, least=0, most=1
    )
    clamped: bool = quantity("", "whether the top is clamped: the cable leaves it at the clamp's angles", default=False)
    clamp_declination: float = quantity(
        "rad", "angle from straight down at which the cable leaves the clamp", default=0.0, least=0.0, most=FULL_TURN
    )
    clamp_direction: float = quantity(
        "rad", "direction towards which it leans there, from x towards y", default=0.0, least=-FULL_TURN, most=FULL_TURN
    )
    motion: tuple[Motion, ...] = quantity("", "parts of the motion", default=())
    table: tuple[tuple[float, float, float, float], ...] = quantity(
        "s, m, m, m", "table of [time, x, y, z], displacements that add to the position; joined by a cubic spline", default=()
    )


@dataclass(frozen=True)
class Lower:
    """The prescribed motion of a driven lower end."""

    position: tuple[float, float, float] = quantity("m", "position about which a driven lower end moves", default=(0.0, 0.0, 0.0))
    motion: tuple[Motion, ...] = quantity("", "parts of the motion", default=())
    table: tuple[tuple[float, float, float, float], ...] = quantity(
        "s, m, m, m", "table of [time, x, y, z], displacements that add to the position; joined by a cubic spline", default=()
    )


@dataclass(frozen=True)
class Host:
    """What the top is fastened to in a co-simulation whose host holds the force over a step."""

    mass: float = quantity("kg", "mass that the top is fastened to in a co-simulation (0 = its motion is as given)", default=0.0, least=0.0)


@dataclass(frozen=True)
class Solver:
    grid: str = quantity("", "finite-difference grid", default="staggered", choices=("staggered", "box"))
    nodes: int = quantity("1", "number of nodes of the chain", default=51, least=3, most=100000)
    grading: float = quantity(
        "1", "mesh: 0 equal travel time of waves, 1 uniform, above 1 finer towards the lower end",
        default=0.0, least=0.0, most=4.0, gap=(0.0, 1.0),
        remedy="Take 0 (automatic), 1 (uniform) or 2 (a free end).",
    )  # fmt: skip
    time_step: float = quantity("s", "longest internal step", default=0.01, above=0.0, remedy="Give a step above 0.")
    lambda_infinity: float = quantity(
        "1", "eigenvalue of the time integrator at infinite frequency", default=-0.9, least=-1.0, most=0.5,
        remedy="Near -1 is most accurate on smooth motion, -0.5 damps more.",
    )  # fmt: skip
    integrator: str = quantity(
        "", "member of the generalized-alpha family", default="generalized-alpha",
        choices=INTEGRATORS,
    )  # fmt: skip
    tolerance: float = quantity(
        "1", "error tolerance in time (0 = fixed step)", default=0.0, least=0.0, most=0.1, remedy="Above 0.1 nothing would be controlled."
    )
    slack_smoothing: float = quantity("1", "width of the slack law over the weight", default=1e-3, above=0.0, most=1.0)
    slack_damping: float = quantity("1", "axial damping of the slack law over h sqrt(EA m)", default=0.1, least=0.0, most=10.0)
    space: bool = quantity("", "whether the cable may leave the vertical plane", default=False)
    audit: bool = quantity("", "whether the balances of energy and momentum are audited", default=False)


@dataclass(frozen=True)
class Run:
    duration: float = quantity("s", "simulated time", default=10.0, above=0.0)
    output_step: float = quantity("s", "time between outputs", default=0.05, above=0.0)
    model: str = quantity("", "model that the scene is meant for", default="chain", choices=("chain", "tow"))


def holder_of(name: str) -> type:
    """The data class that has the value of a dotted name."""
    holder: type = globals()["".join(word.capitalize() for word in name.partition(".")[0].split("_"))]
    return holder


@functools.cache
def field_of(name: str) -> dataclasses.Field:
    """The field behind a dotted name such as "cable.length": its metadata has unit, rule and meaning."""
    return next(f for f in dataclasses.fields(holder_of(name)) if f.name == name.partition(".")[2])


def value_of(scene: Any, name: str) -> Any:
    """A scene's value by its dotted name; of a part that it lacks the default, but no water has density 0."""
    part, _, key = name.partition(".")
    holder = getattr(scene, part)
    if holder is None:
        return 0.0 if name == "water.density" else field_of(name).default
    return getattr(holder, key)
