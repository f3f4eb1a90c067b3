"""A scene: everything a run needs, read from TOML and validated once."""

from __future__ import annotations

import dataclasses
import tomllib
from collections.abc import Mapping
from dataclasses import dataclass, field
from importlib import resources
from pathlib import Path
from typing import Any

from cable_model import rules
from cable_model.errors import ParameterError, unknown
from cable_model.parameters import (
    Body,
    Cable,
    Current,
    Environment,
    Host,
    Lower,
    LowerEnd,
    Parting,
    Run,
    Seabed,
    Solver,
    Top,
    Tow,
    Water,
    Waves,
    Winch,
)
from cable_model.quantity import build, quantity
from cable_model.sections import SHARED, joined
from cable_model.table_files import with_tables


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
    lower: Lower = field(default_factory=Lower)
    parting: Parting = field(default_factory=Parting)
    winch: Winch = field(default_factory=Winch)
    host: Host = field(default_factory=Host)
    tow: Tow = field(default_factory=Tow)
    solver: Solver = field(default_factory=Solver)
    run: Run = field(default_factory=Run)

    def __post_init__(self) -> None:
        rules.check(self)


def from_dict(values: Mapping[str, Any]) -> Scene:
    """Build a scene from nested tables such as a parsed TOML file."""
    values = dict(values)
    cable = values.get("cable")
    if isinstance(cable, dict) and cable.get("section"):
        values["cable"] = joined(cable)
    scene: Scene = build(Scene, values)
    return scene


def shipped() -> dict[str, Path]:
    """Names and files of the scenes that come with the package; the hard cases' begin with "hard/", the examples' with "examples/"."""
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
    return from_dict(with_tables(values, path.parent))


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
        if isinstance(value, Cable) and value.section:
            given = {name: one for name, one in given.items() if name not in (*SHARED, "length")}
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
    if scene.cable.section:
        tables["cable"] = {name: value for name, value in tables["cable"].items() if name not in (*SHARED, "length")}  # its sections'
    for name, value in values.items():
        part, _, key = name.partition(".")
        if part == "cable" and scene.cable.section and key in (*SHARED, "length"):
            raise ParameterError(f"{name}: is of the cable's sections in this scene. Give cable.section, or a scene without sections.")
        if part not in tables or not key:
            raise unknown(name, [f"{k}.{f}" for k, t in tables.items() if isinstance(t, dict) for f in t])
        if tables[part] is None:
            tables[part] = {}
        tables[part][key] = value
    return from_dict({k: v for k, v in tables.items() if v is not None})
