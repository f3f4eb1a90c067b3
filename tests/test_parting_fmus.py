"""The FMUs whose cable parts: what the library gives, their states, a Boolean input, and what the log says."""

import re
from pathlib import Path

import numpy as np
import pytest
from fmu_support import NO_BODY, FMICallException, assert_same, refuses_an_input, sway
from native_support import FLAVOURS, library_run, native_run

from cable_model.signals import INPUTS, OUTPUTS
from fmu_src.interface import generic_scene, scene_from_values

GUIDE = Path(__file__).parent.parent / "docs" / "how_to" / "parting.md"
STEP = 0.05
MOORED = {"lower_end.anchored": True, "lower_end.x": 60.0, "lower_end.z": -75.0, "solver.time_step": 0.02, **NO_BODY}
CASES = {
    "cut between its ends": {**MOORED, "parting.time": 1.03, "parting.place": 40.0},
    "cut at its top": {"parting.time": 0.8, "parting.place": 100.0},
    "its body let go": {"parting.by_input": True, "solver.space": True},
    "an end that is driven let go": {
        "lower_end.anchored": True, "lower_end.driven": True, "water.surface": False, "parting.by_input": True, "cable.length": 120.0,
        **NO_BODY,
    },
    "broken": {"cable.breaking_tension": 7000.0},
}  # fmt: skip
FROM = 30  # the step in which the input turns true


def inputs(case, steps=60):
    """A top that sways, strongly where that is to break the cable; an end that jumps after its cable has gone, which nobody follows."""
    rows = np.zeros((steps, len(INPUTS)))
    for k in range(steps):
        rows[k, :9] = sway(STEP * k, amplitude=3.0 if case == "broken" else 0.3, omega=1.4)
        if "driven" in case:
            rows[k, 10:13] = (60.0, 0.0, -80.0) if k < steps - 5 else (1e4, 0.0, 0.0)
        rows[k, -1] = float(CASES[case].get("parting.by_input", False) and k >= FROM)
    return rows


@pytest.mark.parametrize("flavour", FLAVOURS)
@pytest.mark.parametrize("name", CASES)
def test_every_fmu_gives_what_the_library_gives_and_restores_it(request, flavour, name):
    fmu = request.getfixturevalue(flavour)["chain"]
    values = CASES[name]
    given = inputs(name)
    instance = fmu.instance()
    found = native_run(instance, values, given, STEP)
    assert_same(found, library_run("chain", scene_from_values(generic_scene(), values, "chain"), given, STEP))
    parted = found[:, OUTPUTS.index("cable.parted")]
    assert parted[0] == 0.0 and parted[-1] > 0.0
    assert any(text.startswith("cable parted at ") for _, text in instance.messages)
    if "driven" in name:
        assert not found[-1, [OUTPUTS.index("lower.force_x"), OUTPUTS.index("lower.force_mean_x")]].any()
        assert found[FROM, OUTPUTS.index("lower.force_x")]
    instance.close()
    again = fmu.instance()
    again.initialize(values, given[0])
    for k in range(10):
        again.step(STEP * k, STEP, given[k])
    early = again.slave.getFMUstate()
    for k in range(10, 45):
        again.step(STEP * k, STEP, given[k])
    late = again.slave.getFMUstate()
    for first, state in ((45, late), (10, early)):
        again.slave.setFMUstate(state)
        rows = [again.step(STEP * k, STEP, given[k]) for k in range(first, 60)]
        assert np.array_equal(rows, found[first + 1 :])
    again.close()


@pytest.mark.parametrize("flavour", FLAVOURS)
@pytest.mark.parametrize("model", ["chain", "tow"])
def test_an_input_that_is_not_asked_for_is_refused(request, flavour, model):
    fmu = request.getfixturevalue(flavour)[model]
    refuses_an_input(fmu, "lower_end.let_go", "the input lower_end.let_go is true, but is not asked for")
    instance = fmu.instance()
    instance.initialize()
    with pytest.raises(FMICallException):
        instance.slave.setReal([fmu.references["lower_end.let_go"]], [1.0])
    assert instance.errors[-1] == "lower_end.let_go as Real: must be got and set as Boolean. Use the types of modelDescription.xml."
    assert instance.get("lower_end.let_go") is False or not instance.get("lower_end.let_go")
    instance.close()


@pytest.mark.parametrize("flavour", FLAVOURS)
def test_tow_cable_refuses_to_part(request, flavour):
    instance = request.getfixturevalue(flavour)["tow"].instance()
    with pytest.raises(FMICallException):
        instance.initialize({"cable.breaking_tension": 1e4})
    assert instance.errors[-1].startswith("cable.breaking_tension = 10000 N: must be 0 for TowCable")
    instance.close()


def test_the_guides_program_lets_its_body_go(native, monkeypatch, tmp_path):
    """What hangs then is the wire alone, which still swings."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "CableChain.fmu").write_bytes(native["chain"].path.read_bytes())
    (program,) = re.findall(r"```python\n(.*?)```", GUIDE.read_text(encoding="utf-8"), re.DOTALL)
    names: dict = {}
    exec(compile(program, str(GUIDE), "exec"), names)
    area = np.pi / 4.0 * 0.013**2
    wire = (0.68 - 1025.0 * area) * 9.80665 * 100.0
    assert names["before"] == pytest.approx(-wire - (500.0 - 102.5) * 9.80665, rel=1e-3)
    assert names["left"] == 100.0
    assert abs(names["after"]) < 3.0 * wire


def test_inputs_beyond_the_ends_have_no_derivatives(native):
    """Those of the winch, of currents and of what lets go: said once, and nothing is written elsewhere."""
    instance = native["chain"].instance()
    instance.initialize({"water.current_input": True, "top.motion_order": 2})
    before = [instance.get(name) for name in INPUTS]
    for name in ("winch.speed", "water.current_x", "water.current_y"):
        instance.slave.setRealInputDerivatives([instance.fmu.references[name]], [1], [0.1])
    assert [instance.get(name) for name in INPUTS] == before
    assert sum("not followed" in text for _, text in instance.messages) == 1
    instance.close()
