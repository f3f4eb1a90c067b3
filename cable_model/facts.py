"""What is known of every variable that a run tells: FMUs, the pages about them and files of results have it from here."""

from __future__ import annotations

from typing import NamedTuple

from cable_model.signals import INPUTS, SHAPE_POINTS

CPU_TIME = "solver.cpu_time"


class Facts(NamedTuple):
    """Unit, meaning and usual size of a variable; `starts_from`: inputs that its value at the end of initialization depends on."""

    unit: str
    description: str
    size: float = 1.0
    starts_from: tuple[str, ...] = ()


_OF_INPUTS = {"": ("m", "position of {}"), "v": ("m/s", "velocity of {}"), "a": ("m/s2", "acceleration of {}")}
_PLACES, _SPEEDS, _NONE = (*INPUTS[:3], *INPUTS[10:13], *INPUTS[19:21]), (*INPUTS[3:6], *INPUTS[13:16]), ()
_DRIVEN = "(needs lower_end.driven)"
# of an output: unit, text, size, and the inputs that its value at the end of initialization depends on, in one model or the other
_OF_OUTPUTS: dict[str, tuple[str, str, float, tuple[str, ...]]] = {
    "top.force_x": ("N", "force of the cable on its attachment, x", 1e3, INPUTS),
    "top.force_y": ("N", "force of the cable on its attachment, y", 1e3, INPUTS),
    "top.force_z": ("N", "force of the cable on its attachment, z", 1e3, INPUTS),
    "top.tension": ("N", "tension at the top", 1e3, INPUTS),
    "top.declination": ("rad", "angle of the cable's top from straight down", 1.0, _PLACES),
    "body.x": ("m", "position of the lower end, x", 100.0, _PLACES),
    "body.y": ("m", "position of the lower end, y", 100.0, _PLACES),
    "body.z": ("m", "position of the lower end, z", 100.0, _PLACES),
    "body.vx": ("m/s", "velocity of the lower end, x", 1.0, _SPEEDS),
    "body.vy": ("m/s", "velocity of the lower end, y", 1.0, _SPEEDS),
    "body.vz": ("m/s", "velocity of the lower end, z", 1.0, _SPEEDS),
    "body.tension": ("N", "tension at the lower end", 1e3, INPUTS),
    "cable.tension_max": ("N", "largest tension along the cable", 1e3, INPUTS),
    "cable.tension_min": ("N", "smallest tension along the cable", 1e3, INPUTS),
    "cable.slack_fraction": ("1", "slack share of the cable's length", 1.0, _PLACES),
    "solver.steps": ("1", "internal steps since initialization", 1e3, _NONE),
    "solver.newton_iterations": ("1", "Newton iterations since initialization", 1e3, _NONE),
    "solver.rejected_steps": ("1", "internal steps that were repeated", 10.0, _NONE),
    CPU_TIME: ("s", "processor time spent in steps", 1.0, _NONE),
    "top.force_mean_x": ("N", "force of the cable on its attachment, x: mean over the last communication step", 1e3, INPUTS),
    "top.force_mean_y": ("N", "force of the cable on its attachment, y: mean over the last communication step", 1e3, INPUTS),
    "top.force_mean_z": ("N", "force of the cable on its attachment, z: mean over the last communication step", 1e3, INPUTS),
    "coupling.growth": (
        "1/s",
        "rate at which the exchange of force and motion with the host feeds a ringing of the force (0 = none)",
        1.0,
        _NONE,
    ),
    "audit.energy": (
        "J",
        "energy that nothing explains: gained since the start, less all work, plus what damping took (needs solver.audit)",
        1.0,
        _NONE,
    ),
    "audit.momentum": (
        "N",
        "force that changes the momentum and is no outer one: root mean square so far (needs solver.audit)",
        1.0,
        _NONE,
    ),
    "top.force_next_x": ("N", "force of the cable for a host to hold over the next communication step, x", 1e3, INPUTS),
    "top.force_next_y": ("N", "force of the cable for a host to hold over the next communication step, y", 1e3, INPUTS),
    "top.force_next_z": ("N", "force of the cable for a host to hold over the next communication step, z", 1e3, INPUTS),
    **{f"lower.force_{axis}": ("N", f"force of the cable on what drives its lower end, {axis} {_DRIVEN}", 1e3, INPUTS) for axis in "xyz"},
    **{
        f"lower.force_mean_{axis}": (
            "N",
            f"force of the cable on what drives its lower end, {axis}: mean over the last communication step {_DRIVEN}",
            1e3,
            INPUTS,
        )
        for axis in "xyz"
    },
    "cable.bending_moment_max": ("N.m", "largest bending moment along the cable", 1e3, _PLACES),
    "cable.suspended_length": (
        "m",
        "unstretched length from the top to where the cable touches down, else all of it",
        100.0,
        _PLACES,
    ),
    "seabed.force_z": (
        "N",
        "push of the seabed on the cable, upwards, friction apart; an anchor holds its own half of a cell",
        1e3,
        _PLACES,
    ),
    **{
        f"seabed.touchdown_{axis}": ("m", f"where the cable, from its top, touches down, else its lower end, {axis}", 100.0, _PLACES)
        for axis in "xyz"
    },
    "winch.paid_out": ("m", "cable that the winch has paid out since the start", 10.0, _NONE),
    "water.elevation": ("m", "height of the waves over still water at the top's place", 1.0, _PLACES),
    "cable.parted": ("1", "0: the cable is whole, 1: a part has gone from its lower end up, 2: all of it has", 1.0, _NONE),
    "cable.remaining_length": ("m", "unstretched length of cable below the top", 100.0, _PLACES),
    **{
        f"{end}.moment_{axis}": ("N.m", f"moment of the cable on what clamps its {word}, {axis} (needs {key}.clamped)", 1e3, _PLACES)
        for end, word, key in (("top", "top", "top"), ("lower", "lower end", "lower_end"))
        for axis in "xyz"
    },
    "lower.declination": ("rad", f"angle of the cable's lower end from straight down {_DRIVEN}", 1.0, _PLACES),
}
_OF_PROFILES = {  # one value a point of the cable
    "arc_length": ("m", "unstretched length of the cable from its lower end"),
    "x": ("m", "position along the cable, x"),
    "y": ("m", "position along the cable, y"),
    "z": ("m", "position along the cable, z"),
    "tension": ("N", "tension along the cable"),
    "curvature": ("1/m", "curvature along the cable as it lies, stretched"),
}
TIME = "time"
PROFILE = (TIME, *_OF_PROFILES)  # the columns of a table of profiles


def facts_of(name: str) -> Facts:
    """Of the time, an input, an output, a point of a shape (signals.SHAPE) or a column of PROFILE; KeyError for what is none."""
    if name == TIME:
        return Facts("s", "simulated time")
    if name in INPUTS:
        return _of_input(name)
    if name.startswith("shape."):
        return _of_shape(name)
    return Facts(*_OF_OUTPUTS[name]) if name in _OF_OUTPUTS else Facts(*_OF_PROFILES[name])


def _of_input(name: str) -> Facts:
    if name == "winch.speed":
        return Facts("m/s", "speed at which the winch pays cable out (needs winch.fitted)")
    if name == "lower_end.let_go":
        return Facts("", "whether the cable is cut at parting.place, from when it first turns true (needs parting.by_input)")
    if name.startswith("water."):
        return Facts("m/s", f"current that adds to the scene's, {name[-1]} (needs water.current_input)")
    end, _, key = name.partition(".")
    unit, text = _OF_INPUTS[key[:-1]]
    return Facts(unit, text.format(f"the top, {key[-1]}" if end == "top" else f"the lower end, {key[-1]} {_DRIVEN}"))


def _of_shape(name: str) -> Facts:
    of, _, number = name.removeprefix("shape.").rstrip("]").partition("[")
    where = f"point {number} of {SHAPE_POINTS}, evenly along the unstretched cable from the lower end to the top"
    return Facts("N", f"tension at {where}", 1e3, INPUTS) if of == "tension" else Facts("m", f"{of} of {where}", 100.0, _PLACES)
