"""The table of effects: every row is in everything that derives from it, whatever rows are added."""

from __future__ import annotations

import json
import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from cable_model import effects as table
from cable_model.condition import Both, Given, On, cases, holds, names
from cable_model.effects import CHAIN, EFFECTS, TOW, Effect, Parts
from cable_model.errors import ParameterError
from cable_model.lab.bench import CASES, scene_of
from cable_model.lab.peers.deck import NotTranslated, refuse_untranslated
from cable_model.models import MODELS
from cable_model.parameters import field_of, value_of
from cable_model.scene import Scene, from_dict, load, with_values
from cable_model.simulated import asked, effects, is_on, parts_of
from cable_model.studies.settings import leave_out
from fmu_src.interface import table as interface
from fmu_src.native.object_code import GENERIC
from fmu_src.native.rules import Rules

ROOT = Path(__file__).resolve().parents[2]
KERNELS = {path.name: path.read_text(encoding="utf-8") for path in sorted((ROOT / "cable_model" / "kernels").glob("*.py"))}
COSTED = {effect.name: next(iter(effect.costs.values())) for effect in EFFECTS if effect.costs}
# rows whose absence is what costs: the case takes them out
TAKEN_OUT = ("slack", "surface")


def with_effect(effect: Effect) -> Scene:
    """The scene of the row's cost case, with the effect on and a body that TowCable can tow."""
    values = {name: value for name, value in COSTED[effect.name].items() if effect.name not in TAKEN_OUT or name not in effect.because}
    return scene_of(values if "lower_end.anchored" in values else {**values, "body.mass": 0.1})


def ids(effect: Effect) -> str:
    return effect.name


@pytest.mark.parametrize("effect", [e for e in EFFECTS if e.part], ids=ids)
def test_kernels_ask_for_every_part(effect: Effect):
    """A row whose kernel nobody calls would change no output."""
    users = [name for name, text in KERNELS.items() if re.search(rf"\bparts\.{effect.name}\b", text)]
    assert users, f"no kernel asks for parts.{effect.name}"


@pytest.mark.parametrize("name", table.PARAMETERS)
def test_kernels_read_every_number(name: str):
    assert any(re.search(rf"\.{name.partition('.')[2]}\b", text) for text in KERNELS.values()), f"no kernel reads {name}"


def test_kernels_ask_for_no_part_and_no_number_by_its_place():
    for name, text in KERNELS.items():
        assert not re.search(r"\b(p|numbers|parts)\[[^0\]]", text), name
        assert "cable_model.effects" not in text, f"{name} imports the table"


@pytest.mark.parametrize("effect", EFFECTS, ids=ids)
def test_a_row_is_complete(effect: Effect):
    """It has values that decide, with units and rules, and what may leave it out is what a scene would say without it."""
    assert effect.because
    for name in (*effect.because, *table.in_fmus(effect), *effect.left_out):
        assert field_of(name).metadata["description"], name
    assert set(effect.needs) <= set(table.BY_NAME)
    assert effect.costs or not effect.part or effect.models == (TOW,) or effect.name == "anchor", "a chain's part without a cost case"
    assert set(effect.costs) <= set(CASES)


@pytest.mark.parametrize("name", COSTED)
def test_a_cost_case_switches_its_effect_on_and_lists_name_it(name: str):
    effect, scene = table.BY_NAME[name], scene_of(COSTED[name])
    on = name not in TAKEN_OUT
    assert is_on(effect, scene, CHAIN) == on
    assert (getattr(parts_of(scene, CHAIN), name) is not None) == on
    if effect.words:
        (told,) = (told for told in effects(scene, CHAIN) if told.name == effect.words)
        assert told.active == (on != effect.inverse)
        assert any(value in told.why for value in (*effect.because, *(e.instead for e in EFFECTS if e.instead)))


@pytest.mark.parametrize("name", COSTED)
def test_a_model_and_a_grid_refuse_what_they_do_not_have(name: str):
    effect = table.BY_NAME[name]
    scene = with_effect(effect)
    if asked(effect) is not effect.on:
        return  # it is refused for another reason than being on
    if TOW not in effect.models and effect.words:
        with pytest.raises(ParameterError, match=r"must be .* for TowCable\. Use CableChain\."):
            MODELS[TOW](scene)
    if table.BOX not in effect.grids and not effect.instead:
        with pytest.raises(ParameterError, match=r"must be .* on the box grid\."):
            with_values(scene, {"solver.grid": "box"})


@pytest.mark.parametrize("effect", [e for e in EFFECTS if TOW in e.models and CHAIN not in e.models], ids=ids)
def test_the_chain_refuses_what_only_the_straight_cable_has(effect: Effect):
    name = next(n for n in names(asked(effect)) if n in table.in_fmus(effect))
    default = field_of(name).default
    scene = scene_of({name: not default if isinstance(default, bool) else default + 0.3})
    with pytest.raises(ParameterError, match=r"must be .* for CableChain\. Use TowCable\."):
        MODELS[CHAIN](scene)


@pytest.mark.parametrize("effect", [e for e in EFFECTS if e.left_out and e.costs], ids=ids)
def test_advise_may_leave_it_out(effect: Effect):
    scene = with_effect(effect)
    changes = leave_out(scene)[effect.called or effect.words]
    assert not is_on(effect, with_values(scene, dict(changes)), CHAIN)


@pytest.mark.parametrize("effect", [e for e in EFFECTS if e.costs and not e.told_to_peers and CHAIN in e.models], ids=ids)
def test_peers_refuse_what_they_are_not_told(effect: Effect):
    with pytest.raises(NotTranslated, match=rf"\b{effect.name}\b.*: must be absent for a peer"):
        refuse_untranslated(scene_of(COSTED[effect.name]), "a peer")
    refuse_untranslated(scene_of({}), "a peer")


@pytest.mark.parametrize("effect", EFFECTS, ids=ids)
def test_fmus_have_its_parameters_and_native_ones_its_variant(effect: Effect):
    rows = {row.scene_name: row for row in interface()}
    for name in table.in_fmus(effect):
        assert rows[name].unit in (field_of(name).metadata["unit"], "")
    if effect.part:
        for model in MODELS:
            kinds = {variant[effect.name] for variant in GENERIC[model]}
            assert (kinds == {0}) == (model not in effect.models or effect.native == "absent") or effect.name in ("space", "as_printed")


def test_what_one_effect_shares_with_another_is_said_by_the_rows():
    """Numbers and parts belong to one row each, so that nothing is compiled in or handed over twice."""
    numbers = [name for effect in EFFECTS for name in table.in_fmus(effect)] + list(table.SETTINGS)
    assert len(set(numbers)) == len(numbers)
    assert len(set(table.BY_NAME)) == len(EFFECTS)
    assert Parts._fields == tuple(effect.name for effect in EFFECTS if effect.part)


# -- a row that is added

ROW = """    Effect(
        "ageing", "ageing of the cable", Given("cable.ageing"), ("cable.ageing",), models=(CHAIN,), grids=(STAGGERED,),
        numbers=("cable.ageing",), left_out={"cable.ageing": 0.0}, costs={"ageing": {"cable.ageing": 2.0}},
    ),
    Effect(
        "winch","""
FIELD = """    ageing: float = quantity("N.s2", "ageing (0 = none)", default=0.0, least=0.0)
    compressible:"""
ASKS = """
import json, sys
from cable_model.lab.bench import CASES, scene_of
from cable_model.models import MODELS
from cable_model.simulated import one_line, parts_of
from cable_model.studies.settings import leave_out
from cable_model.lab.peers.deck import refuse_untranslated
from fmu_src.interface import scene_from_values, table, generic_scene
from fmu_src.native.object_code import GENERIC
from fmu_src.native.rules import Rules
scene = scene_of(CASES["ageing"])
def error(call):
    try:
        call()
    except Exception as refused:
        return str(refused)
    return ""
rows = table()
row = next(row for row in rows if row.name == "cable.ageing")
rules = Rules(rows, generic_scene(), "chain")
print(json.dumps({
    "told": one_line(scene, "chain"), "part": parts_of(scene, "chain").ageing, "leave out": sorted(leave_out(scene)),
    "tow": error(lambda: parts_of(scene, "tow")), "box": error(lambda: scene_of({**CASES["ageing"], "solver.grid": "box"})),
    "peer": error(lambda: refuse_untranslated(scene, "a peer")), "fmu": [row.name, row.unit, row.description],
    "tow fmu": error(lambda: scene_from_values(generic_scene(), {"cable.ageing": 1.0}, "tow")),
    "native": [GENERIC["chain"][0]["ageing"], GENERIC["tow"][0]["ageing"]], "c": rules.parts()["ageing"],
    "c tow": Rules(rows, generic_scene(), "tow").kept["cable.ageing"], "reason": [r.words for r in rules.reasons() if "ageing" in r.words],
    "number": rules.numbers()[-1] is not None and "cable.ageing" in __import__("cable_model.effects").effects.PARAMETERS,
    "where": rows.index(row),
}))
"""


def test_a_row_and_its_value_are_all_that_the_rest_needs_to_know_of_a_new_effect(tmp_path: Path):
    for package in ("cable_model", "fmu_src"):
        shutil.copytree(ROOT / package, tmp_path / package, ignore=shutil.ignore_patterns("__pycache__"))
    for name, old, new in (("effects", '    Effect(\n        "winch",', ROW), ("parameters", "    compressible:", FIELD)):
        path = tmp_path / "cable_model" / f"{name}.py"
        text = path.read_text(encoding="utf-8")
        assert text.count(old) == 1
        path.write_text(text.replace(old, new), encoding="utf-8")
    done = subprocess.run([sys.executable, "-c", ASKS], cwd=tmp_path, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    said = json.loads(done.stdout)
    assert "ageing of the cable (cable.ageing = 2 N.s2)" in said["told"]
    assert said["part"] is True
    assert "ageing of the cable" in said["leave out"]
    assert said["tow"] == "cable.ageing = 2 N.s2: must be 0 for TowCable. Use CableChain."
    assert said["box"] == 'cable.ageing = 2 N.s2: must be 0 on the box grid. Set solver.grid = "staggered".'
    assert said["peer"] == "ageing: must be absent for a peer. Leave it out of the scene."
    assert said["fmu"] == ["cable.ageing", "N.s2", "ageing (0 = none) (CableChain only)"]
    refused = "0 for TowCable, which has no use for it. Leave it, or use CableChain."
    assert said["tow fmu"] == f"cable.ageing = 1 N.s2: must be {refused}"
    assert said["native"] == [2, 0]
    assert said["c"] == [[[said["where"], True]]]  # with the box grid it is refused
    assert said["c tow"] == refused
    assert said["reason"] == ["ageing of the cable (cable.ageing = "]
    assert said["number"]


# -- conditions


def test_conditions_are_written_out_as_the_fewest_alternatives():
    place = {"a": 0, "b": 1, "c": 2}
    a, b, c = (Given(name) for name in place)

    def leaf(condition):
        return place[condition.name]

    assert cases(a & ~b, leaf) == [((0, True), (1, False))]
    assert sorted(cases(a | (a & b), leaf)) == [((0, True),)]
    assert sorted(cases(~(a & (b | ~c)), leaf)) == [((0, False),), ((1, False), (2, True))]
    assert cases(a & ~a, leaf) == []
    for condition in (a & b | c, ~(a | b) & c, (a | b) & (b | c), ~(a & b & c)):
        for bits in range(8):
            given = [bool(bits >> k & 1) for k in range(3)]
            value = holds(condition, lambda asked, given=given: given[place[asked.name]])
            assert value == any(all(given[k] == on for k, on in case) for case in cases(condition, leaf))


def test_effects_that_need_one_another_are_off_together():
    cable = {"length": 1.0, "mass_per_length": 1.0, "axial_stiffness": 1.0, "diameter": 0.1}
    with pytest.raises(ParameterError, match=r"^water\.depth = 20 m: must be 0 without waves, which alone feel it\. "):
        from_dict({"cable": cable, "water": {"depth": 20.0}})
    wavy = from_dict({"cable": cable, "water": {"depth": 20.0}, "waves": {"amplitude": 1.0}})
    assert is_on(table.BY_NAME["finite_depth"], wavy, CHAIN)
    assert not is_on(table.BY_NAME["finite_depth"], with_values(wavy, {"water.depth": 0.0}), CHAIN)
    assert value_of(from_dict({"cable": cable}), "water.density") == 0.0
    assert isinstance(On("water") & Given("water.depth"), Both)
    assert Rules(interface(), from_dict(
        {"cable": {"length": 1.0, "mass_per_length": 1.0, "axial_stiffness": 1.0}}), CHAIN).parts()["finite_depth"] == []  # fmt: skip


def test_waves_are_left_out_with_all_that_is_said_of_them():
    sea = {"waves.amplitude": 0.3, "waves.ramp_time": 20.0, "waves.surface": "wheeler", "water.depth": 400.0}
    assert "waves" in leave_out(with_values(load("towed_body"), sea))
