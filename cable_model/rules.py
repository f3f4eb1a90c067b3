"""The rules that join values of a scene, as data: checked here, and written as tables for C by fmu_src/native."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from cable_model import sections, table_rules
from cable_model.condition import Changed, Chosen, Condition, Given, On
from cable_model.effects import CHAIN
from cable_model.errors import ParameterError, refuse
from cable_model.kernels.header import SUNK
from cable_model.parameters import Motion, field_of, value_of
from cable_model.signals import INPUTS
from cable_model.simulated import given, refused_on_grid, true

WET, SPACE = On("water"), Given("solver.space")
AMPLITUDE, SPECTRUM, TABLE, RECORD = Given("waves.amplitude"), Given("waves.spectrum"), Given("waves.table"), Given("waves.record")
SEAS = (AMPLITUDE, SPECTRUM, TABLE, RECORD)
SEA = AMPLITUDE | SPECTRUM | TABLE | RECORD
OTHER_THAN_ONE = SPECTRUM | TABLE | RECORD
LEVELS, CHANGING = Given("current.levels"), Given("current.table")
OF_A_SPECTRUM = (
    Given("waves.significant_height") | Changed("waves.peak_period") | Changed("waves.peakedness") | Changed("waves.components")
    | Changed("waves.seed")
)  # fmt: skip
OF_ONE_WAVE = "Remove it: it belongs to waves.amplitude."
HEIGHTS = Given("seabed.profile") | Given("seabed.grid")
SLIDING = Changed("seabed.friction_velocity") | Changed("seabed.friction_displacement")
DISK = Given("tow.drag_area_axial") | Changed("tow.body_angle")
TURN = "Set solver.space = true, or turn the axes so that x is along it."
ACROSS = ("0 or pi in the plane", TURN)
NO_WAVES, NO_CURRENT = "Add [water] or remove [waves].", "Add [water] or remove [current]."


@dataclass(frozen=True)
class Rule:
    """Where `broken` holds, the value `name` must be `must`, and `remedy` says what to do.

    `column` of a table: the error names the first row that says something there.
    """

    broken: Condition
    name: str
    must: str
    remedy: str
    column: int = -1

    def error(self, scene: Any) -> ParameterError:
        """The error of a scene that breaks the rule."""
        if self.name == "waves":
            return refuse(self.name, sum(true(kind, scene, CHAIN) for kind in SEAS), "kinds", self.must, self.remedy)
        value, unit = value_of(scene, self.name), field_of(self.name).metadata["unit"]
        if self.column >= 0:
            unit = unit.split(", ")[self.column]
            at = next(k for k, row in enumerate(value) if given(row[self.column], unit))
            return refuse(f"{self.name}[{at}]", value[at][self.column], unit, self.must, self.remedy)
        if isinstance(value, tuple):
            return refuse(self.name, len(value), "rows", self.must, self.remedy)
        return refuse(self.name, value, unit, self.must, self.remedy)


RULES = (
    Rule(~WET & (Given("current.speed") | LEVELS), "current.speed", "0 without water", NO_CURRENT),
    Rule(~WET & CHANGING, "current.table", "none without water", NO_CURRENT),
    Rule(~WET & Given("water.current_input"), "water.current_input", "false without water", "Give water.density, or set it to false."),
    Rule(~WET & AMPLITUDE, "waves.amplitude", "0 without water", NO_WAVES),
    Rule(~WET & SPECTRUM, "waves.spectrum", "none without water", NO_WAVES),
    Rule(~WET & TABLE, "waves.table", "none without water", NO_WAVES),
    Rule(~WET & RECORD, "waves.record", "none without water", NO_WAVES),
    Rule(
        AMPLITUDE & OTHER_THAN_ONE | SPECTRUM & (TABLE | RECORD) | TABLE & RECORD, "waves", "one of amplitude, spectrum, table and record",
        "Keep one of them.",
    ),
    Rule(
        (Chosen("waves.surface", "wheeler") | Chosen("waves.surface", "cut")) & ~SEA, "waves.surface", "held without waves",
        "Give waves, or remove it.",
    ),
    Rule(
        Given("water.depth") & ~SEA, "water.depth", "0 without waves, which alone feel it",
        "Give waves, or remove it: the cable's bottom is [seabed].",
    ),
    Rule(Given("waves.ramp_time") & ~SEA, "waves.ramp_time", "0 without waves", "Give waves, or remove it."),
    Rule(Given("waves.exact") & ~SEA, "waves.exact", "false without waves", "Give waves, or remove it."),
    Rule(
        Given("current.ramp_time") & ~(Given("current.speed") | LEVELS | CHANGING), "current.ramp_time", "0 without a current",
        "Give a current, or remove it.",
    ),
    Rule(SEA & ~Given("environment.gravity"), "environment.gravity", "> 0 with waves", "Give gravity."),
    Rule(
        SPECTRUM & ~Given("waves.significant_height"), "waves.significant_height", "> 0 with a spectrum",
        "Give the significant wave height.",
    ),
    Rule(
        OF_A_SPECTRUM & ~SPECTRUM, "waves.spectrum", 'jonswap or pierson-moskowitz beside values of a spectrum',
        "Give the spectrum, or remove significant_height, peak_period, peakedness, components and seed.",
    ),
    Rule(
        Chosen("waves.spectrum", "pierson-moskowitz") & Changed("waves.peakedness"), "waves.peakedness",
        "left out of a pierson-moskowitz spectrum", 'Remove it, or set waves.spectrum = "jonswap".',
    ),
    Rule(OTHER_THAN_ONE & Changed("waves.period"), "waves.period", "left out beside a spectrum, a table or a record", OF_ONE_WAVE),
    Rule(OTHER_THAN_ONE & Given("waves.phase"), "waves.phase", "0 beside a spectrum, a table or a record", OF_ONE_WAVE),
    Rule(TABLE & Changed("waves.direction"), "waves.direction", "0 beside waves.table", "Give the directions in the table."),
    Rule(
        Given("waves.spreading_exponent") & ~SPECTRUM, "waves.spreading_exponent", "0 without a spectrum",
        "Give waves.spectrum, or remove the exponent.",
    ),
    Rule(
        Given("waves.spreading_exponent") & ~SPACE, "waves.spreading_exponent", "0 in the plane",
        "Set solver.space = true, or remove the exponent.",
    ),
    Rule(WET & ~Given("cable.diameter"), "cable.diameter", "> 0 in water", "Give the diameter, or remove [water]."),
    Rule(
        On("anchor") & Given("body.mass"), "body.mass", "0 at an anchored end",
        "Remove [body], in an FMU by zeros of all its values, or lower_end.anchored.",
    ),
    Rule(
        On("anchor") & Given("lower_end.release_force"), "lower_end.release_force", "0 at an anchored end",
        "Remove it, or lower_end.anchored.",
    ),
    Rule(
        Given("seabed.stiffness") & ~Given("cable.diameter"), "cable.diameter", "> 0 on a seabed", "Give the diameter, or remove [seabed]."
    ),
    Rule(
        ~Given("body.mass") & ~On("anchor") & (Given("body.volume") | Given("body.drag_area") | Given("body.added_mass")), "body.mass",
        "> 0 for a body with volume, drag area or added mass", "Give the body's mass, or remove all of [body].",
    ),
    Rule(
        ~Given("seabed.stiffness") & (
            Given("seabed.level") | Given("seabed.friction_coefficient") | Changed("seabed.damping_ratio") | SLIDING
            | Given("seabed.slope") | Changed("seabed.slope_direction") | HEIGHTS
        ), "seabed.stiffness", "> 0 for a seabed", "Give the stiffness, or remove [seabed].",
    ),
    Rule(
        ~Given("body.mass") & (DISK | Changed("tow.added_mass_vertical")), "body.mass", "> 0 for the body that [tow] describes",
        "Give the body's mass, or remove its values from [tow].",
    ),
    Rule(
        Given("tow.drag_area_axial") & ~Changed("tow.body_angle"), "tow.body_angle", "<= pi for a disk's drag along its axis",
        "Give the angle of the disk, or remove tow.drag_area_axial.",
    ),
    Rule(
        Given("seabed.laid_from_anchor") & ~(Given("seabed.friction_coefficient") & Given("lower_end.anchored")), "seabed.laid_from_anchor",
        "false without friction and an anchor", "Give seabed.friction_coefficient and set lower_end.anchored = true.",
    ),
    Rule(HEIGHTS & Given("seabed.level"), "seabed.level", "0 beside the heights of seabed.profile or grid", "Add it to the heights."),
    Rule(HEIGHTS & Given("seabed.slope"), "seabed.slope", "0 beside seabed.profile or grid", "Keep one of them."),
    Rule(Given("seabed.profile") & Given("seabed.grid"), "seabed.profile", "empty beside seabed.grid", "Keep one of them."),
    Rule(
        Changed("seabed.slope_direction") & ~Given("seabed.slope"), "seabed.slope_direction", "0 without seabed.slope",
        "Give the slope, or remove its direction.",
    ),
    Rule(
        Given("seabed.laid_from_anchor") & (HEIGHTS | Given("seabed.slope")), "seabed.laid_from_anchor",
        "false where the bottom is not level", "Start without the friction of a cable that was laid out.",
    ),
    Rule(LEVELS & Given("current.speed"), "current.speed", "0 beside current.levels", "Keep one of them."),
    Rule(LEVELS & Given("current.direction"), "current.direction", "0 beside current.levels", "Keep one of them."),
    Rule(CHANGING & Given("current.speed"), "current.speed", "0 beside current.table", "Keep one of them."),
    Rule(CHANGING & Given("current.direction"), "current.direction", "0 beside current.table", "Keep one of them."),
    Rule(CHANGING & LEVELS, "current.levels", "empty beside current.table", "Keep one of them."),
    Rule(
        Given("lower_end.released") & ~Given("lower_end.anchored"), "lower_end.released", "false without an anchor",
        "Set lower_end.anchored = true and its x, y, z.",
    ),
    *(
        rule for key in ("driven", "clamped") for rule in (
            Rule(
                Given(f"lower_end.{key}") & ~Given("lower_end.anchored"), f"lower_end.{key}", "false for an end that nothing holds",
                "Set lower_end.anchored = true.",
            ),
            Rule(
                Given(f"lower_end.{key}") & Given("lower_end.released"), f"lower_end.{key}", "false for an end that is let go",
                "Set lower_end.released = false.",
            ),
        )
    ),
    Rule(
        Given("lower_end.driven") & (Given("lower_end.x") | Given("lower_end.y") | Given("lower_end.z")), "lower_end.driven",
        "false beside lower_end.x, y or z, which place an anchor", "Give the place by lower.position, in an FMU by lower.x, y and z.",
    ),
    Rule(
        ~Given("lower_end.driven") & (Changed("lower.position") | Given("lower.motion") | Given("lower.table")), "lower_end.driven",
        "true for a lower end that [lower] moves", "Set lower_end.anchored and driven = true, or remove [lower].",
    ),
    Rule(
        ~Given("lower_end.anchored") & (Given("lower_end.x") | Given("lower_end.y") | Given("lower_end.z")), "lower_end.anchored",
        "true for a lower end that has a place", "Set lower_end.anchored = true, or remove lower_end.x, y and z.",
    ),
    *(
        rule for end in ("top", "lower_end") for rule in (
            Rule(
                Given(f"{end}.clamped") & ~Given("cable.bending_stiffness"), f"{end}.clamped", "false without bending stiffness",
                "Give cable.bending_stiffness.",
            ),
            *(
                Rule(
                    Changed(f"{end}.{angle}") & ~Given(f"{end}.clamped"), f"{end}.{angle}", "0 where nothing clamps the end",
                    f"Set {end}.clamped = true, or remove it.",
                ) for angle in ("clamp_declination", "clamp_direction")
            ),
            Rule(~SPACE & Given(f"{end}.clamp_direction"), f"{end}.clamp_direction", *ACROSS),
        )
    ),
    Rule(
        Given("parting.place") & ~(Given("parting.time") | Given("parting.by_input")), "parting.place", "0 where nothing cuts the cable",
        "Give parting.time or set parting.by_input = true, or remove it.",
    ),
    Rule(
        (Given("parting.time") | Given("parting.by_input")) & ~Given("parting.place") & ~Given("body.mass")
        & (~Given("lower_end.anchored") | Given("lower_end.released")), "parting.place", "> 0 where the lower end is free",
        "Give the place where the cable is cut.",
    ),
    Rule(
        Given("host.mass") & ~Given("top.motion_order"), "top.motion_order", ">= 1 with host.mass",
        "Give the host's velocities too, or set host.mass = 0.",
    ),
    Rule(
        Given("host.mass") & Given("top.inputs_at"), "top.inputs_at", "0 with host.mass",
        "Give inputs at the start of the step, or set host.mass = 0.",
    ),
    Rule(
        (Given("cable.section") | Given("cable.body")) & Given("winch.fitted"), "winch.fitted",
        "false with sections or bodies on the cable",
        "Leave the winch out, or make the cable alike all along.",
    ),
    Rule(
        (Given("cable.section") | Given("cable.body")) & Given("cable.stiffness_curve"), "cable.stiffness_curve",
        "empty beside sections or bodies on the cable", "Give axial_stiffness.",
    ),
    Rule(Given("winch.speeds") & ~Given("winch.fitted"), "winch.speeds", "empty without a winch", "Set winch.fitted = true."),
    Rule(
        On("audit") & On("winch"), "solver.audit", "false with a winch",
        "Leave the audit out, or set winch.fitted = false.",
    ),
    Rule(
        Given("tow.as_printed") & SPACE, "tow.as_printed", "false in space", "The report moves in one plane: set solver.space = false."
    ),
    Rule(~SPACE & Given("current.direction"), "current.direction", *ACROSS),
    Rule(~SPACE & Given("seabed.slope_direction"), "seabed.slope_direction", *ACROSS),
    Rule(~SPACE & Given("seabed.grid"), "seabed.grid", "empty in the plane", "Give seabed.profile along x, or set solver.space = true."),
    Rule(~SPACE & Given("waves.direction"), "waves.direction", *ACROSS),
    Rule(~SPACE & Given("waves.table", column=2), "waves.table", *ACROSS, column=2),
    Rule(~SPACE & Given("current.levels", column=2), "current.levels", *ACROSS, column=2),
    Rule(~SPACE & Given("current.table", column=3), "current.table", *ACROSS, column=3),
)  # fmt: skip


@dataclass(frozen=True)
class StartRule:
    """Where `when` holds, `name` must at the start be `other`, or (unless `equal`) at least `other` less `times` of the value `slack`.

    Names are of inputs or of a scene's values.
    """

    when: Condition
    name: str
    other: str
    remedy: str
    equal: bool = False
    slack: str = ""
    times: float = 0.0
    where: str = ""

    @property
    def words(self) -> tuple[str, str]:
        """What stands before and after the number in "must be"."""
        return f"{'' if self.equal else '>= '}{self.other} = ", f"{self.where}. {self.remedy}"


LEVEL = On("seabed") & ~On("slope") & ~On("relief")  # what an end may not be below; kernels watch other bottoms

START_RULES = (
    StartRule(LEVEL, "top.z", "seabed.level", "Lower the seabed or lift the top.", slack="cable.diameter", times=SUNK),
    StartRule(
        LEVEL & On("anchor") & ~On("driven"), "lower_end.z", "seabed.level", "Lower the seabed or lift the anchor.",
        slack="cable.diameter", times=SUNK,
    ),
    StartRule(
        LEVEL & On("driven"), "lower.z", "seabed.level", "Lower the seabed or lift the lower end.",
        slack="cable.diameter", times=SUNK,
    ),
    StartRule(On("anchor") & ~On("driven") & ~SPACE, "lower_end.y", "top.y", TURN, equal=True, where=" in the plane"),
    StartRule(On("driven") & ~SPACE, "lower.y", "top.y", TURN, equal=True, where=" in the plane"),
    StartRule(On("parting") & ~On("winch"), "cable.length", "parting.place", "Cut it at a place on the cable."),
)  # fmt: skip


def check_start(scene: Any, inputs: Sequence[float], model: str) -> None:
    """Raises the ParameterError of the first rule that the inputs at the start break."""
    at = dict(zip(INPUTS, inputs, strict=True))
    for rule in START_RULES:
        if not true(rule.when, scene, model):
            continue
        value, other = (float(at[name] if name in at else value_of(scene, name)) for name in (rule.name, rule.other))
        slack = rule.times * value_of(scene, rule.slack) if rule.slack else 0.0
        if value != other if rule.equal else value < other - slack:
            raise refuse(rule.name, value, "m", f"{rule.words[0]}{other:.10g}{rule.where}", rule.remedy)


PACES = ("angular_frequency", "period", "frequency")
KEYS = {"sinusoid": ("amplitude", *PACES, "phase", "ramp_time", "ramp"), "ramp": ("velocity", "duration"), "step": ("velocity",)}


def _check_motion(name: str, part: Motion) -> None:
    """Raises the ParameterError of a part of a motion that is given twice, or what it has no use for."""
    given = [pace for pace in PACES if getattr(part, pace) > 0.0]
    if len(given) > 1:
        raise refuse(name, " and ".join(given), "", "one of angular_frequency, period and frequency", "Keep one.")
    for kind, keys in KEYS.items():
        for key in keys:
            value = getattr(part, key)
            if key not in KEYS[part.kind] and value != field_of(f"motion.{key}").default:
                raise refuse(f"{name}.{key}", value, "", f"left out of a {part.kind}", f"It belongs to a {kind}.")
    turned = abs(math.sin(part.phase)) > 1e-9
    if part.kind == "sinusoid" and not given and not turned:
        raise refuse(name, "no frequency", "", "a sinusoid with one of angular_frequency, period and frequency", "Give one.")
    if 0.0 < part.stop <= part.start:
        raise refuse(f"{name}.stop", part.stop, "s", f"0 or > start = {part.start:g}", "Mend one of them.")
    if part.start > 0.0 and part.ramp_time == 0.0 and turned and part.amplitude != 0.0:
        raise refuse(
            f"{name}.phase", part.phase, "rad", "0 or pi in a sinusoid that begins later without ramp_time: else it begins with a jump",
            "Give ramp_time, or start = 0.",
        )  # fmt: skip


def check(scene: Any) -> None:
    """Raises the ParameterError of the first rule that a scene breaks; effects that rules ask for are the chain's."""
    for rule in RULES:
        if true(rule.broken, scene, CHAIN):
            raise rule.error(scene)
    for end in ("top", "lower"):
        for k, part in enumerate(getattr(scene, end).motion):
            _check_motion(f"{end}.motion[{k}]", part)
    sections.check(scene.cable, scene.solver.nodes, true(WET | Given("seabed.stiffness"), scene, CHAIN))
    clamped = {"lower_end": scene.lower_end.clamped, "top": scene.top.clamped}
    if scene.cable.section:
        sections.check_clamps(scene.cable, {k: f"{end}.clamped" for k, end in ((0, "lower_end"), (-1, "top")) if clamped[end]})
    for error in refused_on_grid(scene):
        raise error
    table_rules.check(scene)
