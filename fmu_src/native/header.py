"""The generated C header of a native FMU: interface table, rules, texts of errors and the compiled variants.  No formulas."""

from __future__ import annotations

import dataclasses
import json
import math
from collections.abc import Iterable, Sequence
from types import SimpleNamespace
from typing import Any, cast

import numpy as np

from cable_model import entries
from cable_model.calls import TOO_FAST, Calls
from cable_model.condition import CHANGED, Literal
from cable_model.doubts import SEEN
from cable_model.effects import PARAMETERS, Parts
from cable_model.entries import TABLES, Variant
from cable_model.errors import ParameterError, SolverError
from cable_model.kernels import header
from cable_model.model import Model
from cable_model.models import MODELS
from cable_model.parameters import field_of
from cable_model.scene import Scene
from cable_model.signals import INPUTS, OUTPUTS, SHAPE
from cable_model.simulated import parts_of
from fmu_src.interface import CPU_TIME, EFFECTS, Variable, in_variables
from fmu_src.model_description import LOG_CATEGORIES
from fmu_src.native.export import ENTRY
from fmu_src.native.rules import AtStart, Rules, has_sea
from fmu_src.order import STEP_SLACK, TIME_SLACK

TYPES = """
typedef struct {
    const char *name, *unit;
    char kind, causality; /* R I B S; i(nput) o(utput) p(arameter) l(ocal) */
    double start, least, most, hole, gap, usual; /* nothing between hole and gap; usual: the scene's default */
    int above, angle; /* whether `least` itself is refused; whether only a direction across the x axis counts as nonzero */
    const char *finite, *range, *kept; /* what the value must be, and what to do; "": it need not be `start` */
} Variable;
typedef struct { int variable, nonzero; } Literal;
typedef struct { int count; Literal literals[4]; } Condition; /* all of them; count < 0: never */
typedef struct { Condition when; int variable; const char *text; } Refusal;
typedef struct { Condition when; int variable, other, slack; double times; int equal; const char *before, *after; } StartRule;
typedef struct { Condition when; const char *words; int variable; const char *unit; int again; } Effect; /* again: the last one's */
typedef struct { int part; Condition when; } Presence; /* one of the cases in which a part is there */
typedef struct { int variable, below_zero; } Number; /* the second takes the place of a negative first one */
"""


def _text(value: str) -> str:
    return json.dumps(in_variables(value))


def _number(value: float | None, missing: float) -> str:
    value = missing if value is None else float(value)
    return ("-" if value < 0 else "") + "HUGE_VAL" if math.isinf(value) else repr(value)


def _usual(row: Variable) -> float:
    """The default of the scene's value behind a parameter, as a number."""
    if not row.scene_name:
        return 0.0
    default, choices = field_of(row.scene_name).default, field_of(row.scene_name).metadata["choices"]
    return float(choices.index(default) if choices else 0.0 if default is dataclasses.MISSING else default)


def _condition(literals: Sequence[Literal] | None) -> str:
    if literals is None:
        return "{-1, {{0, 0}}}"
    if len(literals) > LITERALS:
        raise ValueError(f"{len(literals)} literals in a condition: must be <= {LITERALS}. Make room for more in Condition.")
    return f"{{{len(literals)}, {{{', '.join(f'{{{vr}, {int(on)}}}' for vr, on in literals) or '{0, 0}'}}}}}"


def _array(kind: str, name: str, lines: Iterable[str], size: str = "") -> str:
    return f"static const {kind} {name}[{size}] = {{\n" + "".join(f"    {line},\n" for line in lines) + "};\n"


def _rows(table: Any) -> list[str]:
    """Rows of a baked table in C; no table, no rows."""
    return [] if table is None else [f"{{{', '.join(repr(float(x)) for x in row)}}}" for row in table]


def _variable(row: Variable, rules: Rules, vr: int) -> str:
    limit = rules.limits.get(vr)
    unit = limit.unit if limit else row.unit.removeprefix("1")
    facts = [_text(row.name), _text(unit), f"'{row.kind[0]}'", f"'{row.causality[0]}'"]
    facts += [
        _number(row.start, 0.0),
        _number(row.minimum, -math.inf),
        _number(row.maximum, math.inf),
        *(_number(x, 0.0) for x in row.gap or (0.0, 0.0)),
    ]
    facts += [repr(_usual(row))]
    facts += [str(int(row.minimum_excluded)), str(int(row.unit == "rad"))]
    facts += [_text(limit.finite if limit else rules.finite_input), _text(limit.range if limit else "")]
    facts += [_text(rules.kept.get(row.name, ""))]
    return f"{{{', '.join(facts)}}}"


LITERALS = 5  # of a Condition
NO_START_RULE = '{{-1, {{0, 0}}}, 0, 0, -1, 0.0, 0, "", ""}'  # C wants one at least


def _start_rule(rule: AtStart) -> str:
    before, after = (_text(words) for words in rule.words)
    numbers = f"{rule.variable}, {rule.other}, {rule.slack}, {rule.times!r}, {int(rule.equal)}"
    return f"{{{_condition(rule.literals)}, {numbers}, {before}, {after}}}"


def _bare(kind: type[Model]) -> Model:
    """A model without a scene, to ask it for the texts of its errors."""
    model = kind.__new__(kind)
    model._calls = cast(Calls, SimpleNamespace(state=np.zeros(header.HEADER), end_speed=math.inf))
    return model


def _failures(model: Model) -> tuple[list[str], str]:
    """printf formats of the errors of a failed step by status, and the C names of their arguments."""
    marks = {"77.25": ("%.6g", "time"), "8181": ("%.0f", "node"), "0.625": ("%.3g", "size")}
    model.state[[header.ERROR_TIME, header.ERROR_NODE, header.ERROR_SIZE]] = [float(mark) for mark in marks]
    formats, orders = ['""'], set()
    for status in range(1, header.LAST_STATUS + 1):
        try:
            model._must(status, 0.0)
        except SolverError as error:
            text = str(error).replace("%", "%%")
            orders.add(", ".join(marks[mark][1] for mark in sorted(marks, key=text.find) if mark in text))
            for mark, (form, _) in marks.items():
                text = text.replace(mark, form)
            formats.append(_text(text))
    arguments = max(orders, key=len)  # a format may use fewer of them: printf ignores the rest
    assert all(arguments.startswith(order) for order in orders)
    return formats, arguments


def _too_fast(model: Model) -> str:
    try:
        model._must(TOO_FAST, 0.0)
    except ParameterError as error:
        return Rules.tail(str(error))
    raise ValueError("a top of any speed is accepted. Leave its text out of header.py.")


def c_header(identifier: str, rows: Sequence[Variable], scene: Scene, model: str, variants: Sequence[Variant]) -> str:
    """The header of an FMU with these compiled variants; the GUID is defined by the build."""
    rules = Rules(rows, scene, model)
    place = {row.name: vr for vr, row in enumerate(rows)}
    bare = _bare(MODELS[model])
    formats, arguments = _failures(bare)
    parts = rules.parts()
    baked = parts_of(scene, model)
    levels = _rows(baked.current if scene.current.levels else None)
    sea = _rows(baked.waves if has_sea(scene, model) else None)  # a row a quantity
    tables = {part: _rows(getattr(baked, part)) for part in TABLES if part not in ("current", "waves")}
    never: list[Sequence[Literal] | None] = [None]
    presences = [f"{{{k}, {_condition(case)}}}" for k, cases in enumerate(parts.values()) for case in cases or never]
    reasons = [f"{{{_condition(r.literals)}, {_text(r.words)}, {r.variable}, {_text(r.unit)}, {int(r.again)}}}" for r in rules.reasons()]
    names = {
        "N_VARIABLES": len(rows), "N_INPUTS": len(INPUTS), "N_ENDS": INPUTS.index("lower.az") + 1, "N_OUTPUTS": len(OUTPUTS),
        "N_SHAPE": len(SHAPE), "N_NUMBERS": len(PARAMETERS),
        "N_PARTS": len(Parts._fields), "N_VARIANTS": len(variants), "CPU_TIME": place[CPU_TIME], "EFFECTS": place[EFFECTS],
        "MOTION_ORDER": place["top.motion_order"], "GRAVITY": place["environment.gravity"],
        "CURRENT_SPEED": place["current.speed"], "CURRENT_DIRECTION": place["current.direction"],
        "WAVE_AMPLITUDE": place["wave.amplitude"], "WAVE_PERIOD": place["wave.period"],
        "WAVE_DIRECTION": place["wave.direction"], "WAVE_PHASE": place["wave.phase"],
        "CURRENT": Parts._fields.index("current"), "WAVES": Parts._fields.index("waves"),
        "N_BAKED_LEVELS": len(levels), "OF_A_WAVE": TABLES["waves"],
        "N_BAKED_WAVES": len(baked.waves[0]) if sea else 0, **{f"N_BAKED_{part.upper()}": len(rows) for part, rows in tables.items()},
        "ABSENT": entries.ABSENT, "PRESENT": entries.PRESENT, "EITHER": entries.EITHER, "ALWAYS": entries.ALWAYS,
        "SIZES": entries.SIZES, "START": entries.START, "STEP": entries.STEP, "SHAPE": entries.SHAPE, "SHAPE_AT": f"{place[SHAPE[0]]}u",
        "CHANGED": CHANGED,
        "OK": header.OK, "NOT_FINITE": header.NOT_FINITE, "LAST_STATUS": header.LAST_STATUS, "TOO_FAST": f"({TOO_FAST})",
        "ERROR_TIME": header.ERROR_TIME, "ERROR_NODE": header.ERROR_NODE, "ERROR_SIZE": header.ERROR_SIZE,
        "DOUBTS": header.DOUBTS, "DOUBT": header.DOUBT,
        "FAILURE_ARGUMENTS": arguments, "STEP_SLACK": repr(STEP_SLACK), "TIME_SLACK": repr(TIME_SLACK),
        "LOG_CATEGORIES": ", ".join(map(_text, LOG_CATEGORIES)),
        "TOO_FAST_TEXT": _text(_too_fast(bare)), "STEP_TEXT": _text(rules.step_text),
        "MODEL_NAME": _text(MODELS[model].__name__), "MODEL_IDENTIFIER": _text(identifier),
    }  # fmt: skip
    symbols = [f"kernel_{k}" for k in range(len(variants))]
    blocks = [
        "/* Written by fmu_src/native/header.py. */\n#include <math.h>\n#include <stdint.h>\n",
        TYPES,
        "".join(f"#define {name} {value}\n" for name, value in names.items()),
        *(ENTRY.format(name=name) for name in symbols),
        f"typedef __typeof__({symbols[0]}) Kernel;\n",
        f"static Kernel *const kernels[] = {{{', '.join(symbols)}}};\n",
        _array("Variable", "variables", (_variable(row, rules, vr) for vr, row in enumerate(rows))),
        _array("int", "inputs_at", (str(place[name]) for name in INPUTS)),
        _array("int", "outputs_at", (str(place[name]) for name in OUTPUTS)),
        _array("Number", "numbers_from", (f"{{{vr}, {instead}}}" for vr, instead in rules.numbers())),
        _array("Refusal", "refusals", (f"{{{_condition(r.literals)}, {r.variable}, {_text(r.text)}}}" for r in rules.refusals())),
        _array("StartRule", "start_rules", [_start_rule(r) for r in rules.start_rules()] or [NO_START_RULE]),
        _array("Presence", "presences", presences),
        _array("char", "part_names", (_text(name) for name in parts), "][20"),
        _array("char", "variants", (f"{{{', '.join(str(v[name]) for name in Parts._fields)}}}" for v in variants), "][N_PARTS"),
        _array("Effect", "effects", reasons),
        _array("char *const", "failures", formats),
        _array("char *const", "doubts", (_text(text) for text in SEEN)),
        _array("double", "baked_levels", levels or ["{0.0, 0.0, 0.0}"], "][3"),
        _array("double", "baked_waves", sea or ["{0.0}"] * TABLES["waves"], f"][{len(baked.waves[0]) if sea else 1}"),
        *(
            _array("double", f"baked_{part}", rows or [f"{{{', '.join(['0.0'] * TABLES[part])}}}"], f"][{TABLES[part]}")
            for part, rows in tables.items()
        ),
    ]
    return "\n".join(blocks)
