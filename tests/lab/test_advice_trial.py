"""The adviser's trial: its scenes are new and legal, its rows are judged independently, its prices follow the second order."""

import math

import pytest

from cable_model.lab import advice_scenes, advice_trial
from cable_model.scene import load, shipped
from cable_model.studies import settings
from cable_model.studies.cost import expected
from cable_model.studies.price import finer
from cable_model.studies.reference import chain_setting
from cable_model.studies.timed import SIGNALS, worst

CHAIN = "free chain above its second mode"

pytestmark = pytest.mark.xdist_group("advice")  # one worker makes the trial


@pytest.fixture(scope="module")
def row():
    return advice_trial.trial(CHAIN, advice_scenes.scene(CHAIN), lambda text: None, quick=True)


def test_ten_scenes_are_all_different_and_none_is_shipped():
    scenes = [advice_scenes.scene(name) for name in advice_scenes.SCENES]
    physics = [(s.cable, s.body, s.top, s.waves, s.current, s.lower_end, s.water, s.seabed) for s in scenes]
    known = [load(name) for name in shipped()]
    known_physics = [(s.cable, s.body, s.top, s.waves, s.current, s.lower_end, s.water, s.seabed) for s in known]
    assert len(scenes) >= 10
    assert all(p not in physics[:k] and p not in known_physics for k, p in enumerate(physics))


def test_the_choice_is_accurate_against_a_reference_finer_than_the_advisers(row):
    assert row.accurate
    assert worst(row.errors) == pytest.approx(worst(row.advice.choice.errors), rel=0.3)  # so the adviser said the truth


def test_the_straight_cable_is_ruled_out_by_its_scales_and_by_its_error(row):
    assert worst(row.straight) > 0.1
    assert not all(check.holds for check in row.advice.checks)
    assert row.advice.choice.setting.model == "chain"


def test_the_price_of_accuracy_buys_it(row):
    assert row.price.factor == pytest.approx(row.gain, rel=0.7)


def test_the_table_says_what_was_chosen_and_what_was_found(row):
    text = advice_trial.markdown([row])
    line = next(line for line in text.splitlines() if line.startswith(f"| {CHAIN} |"))
    assert line.count(" | ") == len(advice_trial.HEAD) - 1
    assert row.advice.choice.setting.label in line and row.cheapest.setting.label in line
    assert "against it: " in line


def test_ladders_of_steps_divide_the_output_step_and_go_down_to_a_quarter_of_the_scenes_step():
    scene = advice_scenes.scene("irregular sea on a wire")
    steps = settings.steps_ladder(scene)
    assert all(math.isclose(scene.run.output_step / step, round(scene.run.output_step / step)) for step in steps)
    assert steps[0] == scene.run.output_step
    assert 0.25 <= steps[-1] / scene.solver.time_step < 0.5


def test_a_price_of_second_order_takes_the_root_of_the_factor_in_nodes_and_steps():
    scene = advice_scenes.scene(CHAIN)
    coarse = chain_setting(scene, 20, 0.01)
    fine = finer(coarse, 4.0)
    assert fine.changes["solver.nodes"] == 41 and fine.changes["solver.time_step"] == 0.005
    assert 1.0 < expected(scene, fine) / expected(scene, coarse) < 4.0  # the calls from Python cost the same


@pytest.mark.long  # compiles the kernels of several sets of effects
@pytest.mark.parametrize("name", [name for name in advice_scenes.SCENES if name != CHAIN])
def test_the_adviser_meets_the_accuracy_on_every_scene_of_the_trial(name):
    found = advice_trial.trial(name, advice_scenes.scene(name), lambda text: None, quick=True)
    assert found.accurate, {signal: found.errors[signal] for signal in SIGNALS}
