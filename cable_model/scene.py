"""A scene: everything a run needs, read from TOML and validated once; and the numbers and parts that kernels get from it."""

from __future__ import annotations

import dataclasses
import itertools
import math
import tomllib
from collections.abc import Mapping
from dataclasses import dataclass, field
from importlib import resources
from pathlib import Path
from typing import Any

import numpy as np

from cable_model.errors import ParameterError, refuse, unknown
from cable_model.kernels.parts import INTEGRATORS, PARAMETERS, Parts, record
from cable_model.parameters import Body, Cable, Current, Environment, LowerEnd, Run, Seabed, Solver, Top, Tow, Water, Waves, Winch
from cable_model.quantity import build, quantity
from cable_model.sea import check_waves, components


@dataclass(frozen=True)
class Scene:
    """A validated scene; a part that is None or has a zero coefficient is absent."""

    cable: Cable
    title: str = quantity("", "title", default="")
    source: str = quantity("", "where the numbers come from", default="")
    lower_end: LowerEnd = field(default_factory=LowerEnd)
    body: Body = field(default_factory=Body)
    environment: Environment = field(default_factory=Environment)
    water: Water | None = None
    seabed: Seabed = field(default_factory=Seabed)
    current: Current = field(default_factory=Current)
    waves: Waves = field(default_factory=Waves)
    top: Top = field(default_factory=Top)
    winch: Winch = field(default_factory=Winch)
    tow: Tow = field(default_factory=Tow)
    solver: Solver = field(default_factory=Solver)
    run: Run = field(default_factory=Run)

    def __post_init__(self) -> None:
        check_consistency(self)


def check_consistency(scene: Scene) -> None:
    """Rules that join several values; each error says what to change."""
    wet = scene.water is not None and scene.water.density > 0.0
    if not wet and (scene.current.speed != 0.0 or scene.current.levels):
        raise refuse("current.speed", scene.current.speed, "m/s", "0 without water", "Add [water] or remove [current].")
    if not wet and scene.waves.amplitude > 0.0:
        raise refuse("waves.amplitude", scene.waves.amplitude, "m", "0 without water", "Add [water] or remove [waves].")
    check_waves(scene.waves, wet)
    if wet and scene.cable.diameter == 0.0:
        raise refuse("cable.diameter", 0.0, "m", "> 0 in water", "Give the diameter, or remove [water].")
    if scene.lower_end.anchored and not scene.lower_end.released and scene.body.mass > 0.0:
        raise refuse("body.mass", scene.body.mass, "kg", "0 at an anchored end", "Remove [body] or lower_end.anchored.")
    if scene.seabed.stiffness > 0.0:
        _check_seabed(scene)
    if scene.lower_end.released and not scene.lower_end.anchored:
        raise refuse("lower_end.released", True, "", "false without an anchor", "Set lower_end.anchored = true and its x, y, z.")
    if scene.lower_end.released and scene.solver.grid == "box":
        raise refuse("lower_end.released", True, "", "false on the box grid", 'Set solver.grid = "staggered".')
    if scene.winch.fitted and scene.solver.grid == "box":
        raise refuse("winch.fitted", True, "", "false on the box grid", 'Set solver.grid = "staggered".')
    if scene.winch.speeds:
        _check_speeds(scene.winch)
    if scene.cable.stiffness_curve:
        _check_curve(scene)
    levels = [row[0] for row in scene.current.levels]
    if levels != sorted(set(levels)) and levels != sorted(set(levels), reverse=True):
        raise refuse("current.levels", len(levels), "rows", "sorted by z without repeats", "Sort the table by z.")
    if scene.cable.inextensible and scene.solver.grid != "box":
        raise refuse("cable.inextensible", True, "", "false on the staggered grid", 'Set solver.grid = "box", or raise axial_stiffness.')
    if scene.solver.grid == "box" and scene.solver.space:
        raise refuse("solver.space", True, "", "false on the box grid", 'Set solver.grid = "staggered" for motion in space.')
    if scene.solver.integrator == "wbz" and scene.solver.lambda_infinity > 0.999:
        raise refuse("solver.lambda_infinity", scene.solver.lambda_infinity, "", "< 1", "Take 0 or below.")
    if scene.tow.as_printed and scene.solver.space:
        raise refuse("tow.as_printed", True, "", "false in space", "The report moves in one plane: set solver.space = false.")
    if not scene.solver.space:
        tilted = [("current.direction", scene.current.direction), ("waves.direction", scene.waves.direction)]
        tilted += [(f"waves.table[{i}]", row[2]) for i, row in enumerate(scene.waves.table)]
        tilted += [(f"current.levels[{i}]", row[2]) for i, row in enumerate(scene.current.levels)]
        for name, angle in tilted:
            if abs(math.sin(angle)) > 1e-9:
                raise refuse(name, angle, "rad", "0 or pi in the plane", "Set solver.space = true, or turn the axes so that x is along it.")


def _check_seabed(scene: Scene) -> None:
    if scene.cable.diameter == 0.0:
        raise refuse("cable.diameter", 0.0, "m", "> 0 on a seabed", "Give the diameter, or remove [seabed].")
    if scene.solver.grid == "box":
        raise refuse("seabed.stiffness", scene.seabed.stiffness, "Pa/m", "0 on the box grid", 'Set solver.grid = "staggered".')


def _check_speeds(winch: Winch) -> None:
    times = [row[0] for row in winch.speeds]
    if not winch.fitted:
        raise refuse("winch.speeds", len(times), "rows", "empty without a winch", "Set winch.fitted = true.")
    if times != sorted(set(times)):
        raise refuse("winch.speeds", len(times), "rows", "sorted by time without repeats", "Sort the rows by time.")


def _check_curve(scene: Scene) -> None:
    rows = scene.cable.stiffness_curve
    rising = all(a[0] < b[0] and a[1] < b[1] for a, b in itertools.pairwise(rows))
    if len(rows) < 2 or tuple(rows[0]) != (0.0, 0.0) or not rising:
        raise refuse("cable.stiffness_curve", len(rows), "rows", "[0, 0] and rows of rising strain and tension", "Sort the rows by strain.")
    if scene.solver.grid == "box":
        raise refuse("cable.stiffness_curve", len(rows), "rows", "empty on the box grid", 'Set solver.grid = "staggered".')


def from_dict(values: Mapping[str, Any]) -> Scene:
    """Build a scene from nested tables such as a parsed TOML file."""
    scene: Scene = build(Scene, dict(values))
    return scene


def shipped() -> dict[str, Path]:
    """Names and files of the scenes that come with the package; the hard cases' begin with "hard/"."""
    folder = Path(str(resources.files("cable_model"))) / "scenes"
    return {path.relative_to(folder).with_suffix("").as_posix(): path for path in sorted(folder.rglob("*.toml"))}


def load(scene: str | Path) -> Scene:
    """Read a scene from a TOML file, or a shipped one by its name.  Raises ParameterError with one clear text."""
    path = Path(scene)
    if not path.is_file():
        known = shipped()
        if str(scene) in known:
            path = known[str(scene)]
        elif path.suffix == ".toml":
            raise ParameterError(
                f"{scene}: no such file. Give the path of a scene, or one of: {', '.join(name for name in known if '/' not in name)}."
            )
        else:
            raise unknown(str(scene), known, "scene")
    try:
        values = tomllib.loads(path.read_text(encoding="utf-8"))
    except (tomllib.TOMLDecodeError, UnicodeDecodeError) as error:
        raise ParameterError(f"{path}: not a valid TOML file ({error}). Mend the line that is named.") from error
    if not values:
        raise ParameterError(f"{path}: an empty scene. Give at least [cable] with length, mass_per_length and axial_stiffness.")
    return from_dict(values)


def to_toml(scene: Scene) -> str:
    """The scene as TOML: what differs from the defaults; reading it gives an equal scene."""
    import tomli_w

    tables: dict[str, Any] = {}
    for part in dataclasses.fields(scene):
        value = getattr(scene, part.name)
        if not dataclasses.is_dataclass(value):
            if value:
                tables[part.name] = value
            continue
        given = _beyond_defaults(value)
        if given or (part.name == "water"):
            tables[part.name] = given
    return tomli_w.dumps(tables, multiline_strings=True)


def _beyond_defaults(part: Any) -> dict[str, Any]:
    given = {}
    for entry in dataclasses.fields(part):
        value = getattr(part, entry.name)
        if value != entry.default:
            rows = isinstance(value, tuple) and value and dataclasses.is_dataclass(value[0])
            given[entry.name] = [_beyond_defaults(row) for row in value] if rows else value
    return given


def with_values(scene: Scene, values: Mapping[str, Any]) -> Scene:
    """A copy of the scene with values replaced by dotted name, such as {"cable.length": 20.0}; checked like a file."""
    tables = dataclasses.asdict(scene)
    for name, value in values.items():
        part, _, key = name.partition(".")
        if part not in tables or not key:
            raise unknown(name, [f"{k}.{f}" for k, t in tables.items() if isinstance(t, dict) for f in t])
        if tables[part] is None:
            tables[part] = {}
        tables[part][key] = value
    return from_dict({k: v for k, v in tables.items() if v is not None})


def _current_table(current: Current) -> np.ndarray | None:
    rows = current.levels or (((0.0, current.speed, current.direction),) if current.speed != 0.0 else ())
    if not any(row[1] for row in rows):
        return None
    table = np.array([[z, s * math.cos(d), s * math.sin(d)] for z, s, d in sorted(rows)])
    return np.ascontiguousarray(table)


def _curve_table(cable: Cable) -> np.ndarray | None:
    """Rows of strain, tension and slope of a monotone cubic interpolation."""
    if not cable.stiffness_curve:
        return None
    from scipy.interpolate import PchipInterpolator  # here only: FMUs do without scipy

    rows = np.array(cable.stiffness_curve)
    slopes = PchipInterpolator(rows[:, 0], rows[:, 1]).derivative()(rows[:, 0])
    secants = np.diff(rows[:, 1]) / np.diff(rows[:, 0])
    slopes[0] = max(slopes[0], 0.1 * secants[0])
    slopes[-1] = max(slopes[-1], 0.1 * secants[-1])
    return np.ascontiguousarray(np.column_stack((rows, slopes)))


def parts_of(scene: Scene, model: str) -> Parts:
    """Which parts the kernels of a model ("chain" or "tow") get; absent parts are None and cost nothing."""
    wet = scene.water is not None and scene.water.density > 0.0
    depth = scene.water.depth if scene.water is not None else 0.0
    waves = components(scene.waves, scene.environment.gravity, depth) if wet else None
    grounded = scene.seabed.stiffness > 0.0

    def when(condition: bool) -> Any:
        return True if condition else None

    chain = model == "chain"
    if not chain and scene.cable.stiffness_curve:
        raise refuse("cable.stiffness_curve", len(scene.cable.stiffness_curve), "rows", "empty for TowCable", "Use CableChain.")
    box = chain and scene.solver.grid == "box"
    return Parts(
        box=when(box),
        space=when(scene.solver.space),
        inextensible=when(box and scene.cable.inextensible),
        slack=when(chain and not box and not scene.cable.compressible),
        bending=when(chain and scene.cable.bending_stiffness > 0.0),
        voigt=when(scene.cable.axial_damping > 0.0),
        body=when(scene.body.mass > 0.0),
        anchor=when(scene.lower_end.anchored and not (chain and scene.lower_end.released)),
        water=when(wet),
        current=_current_table(scene.current) if wet else None,
        waves=waves,
        finite_depth=when(waves is not None and depth > 0.0),
        stretched=when(waves is not None and scene.waves.surface == "wheeler"),
        cut=when(waves is not None and scene.waves.surface == "cut"),
        seabed=when(chain and grounded),
        friction=when(chain and grounded and scene.seabed.friction_coefficient > 0.0),
        winch=when(chain and scene.winch.fitted),
        curve=_curve_table(scene.cable),
        cable_mass=when(not chain and scene.tow.cable_mass),
        tension_floor=when(not chain),
        as_printed=when(not chain and scene.tow.as_printed),
    )


def numbers_of(scene: Scene) -> np.recarray:
    """The numbers of the kernels, an array of one record."""
    return record({name: _number(scene, name) for name in PARAMETERS})


def _number(scene: Scene, name: str) -> float:
    part, _, key = name.partition(".")
    if name == "solver.integrator":
        return float(INTEGRATORS[scene.solver.integrator])
    if name == "tow.added_mass_vertical" and scene.tow.added_mass_vertical < 0.0:
        return scene.body.added_mass
    holder = getattr(scene, part)
    return 0.0 if holder is None else float(getattr(holder, key))
