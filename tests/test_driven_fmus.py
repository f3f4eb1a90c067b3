"""The FMUs whose lower end is driven: what the library gives, their states and errors, and the tug of the guide."""

import re
from pathlib import Path

import numpy as np
import pytest
from driven_support import SWAYING
from fmu_support import NO_BODY, FMICallException, Fmu, assert_same, refuses_an_input
from native_support import FLAVOURS

from cable_model import CableChain
from cable_model.signals import INPUTS
from fmu_src.interface import generic_scene, scene_from_values

GUIDE = Path(__file__).parent.parent / "docs" / "how_to" / "both_ends.md"
VALUES = {
    "lower_end.anchored": True, "lower_end.driven": True, "water.surface": False, "cable.length": 120.0, "solver.time_step": 0.02,
    **NO_BODY,
}  # fmt: skip


@pytest.fixture(params=FLAVOURS)
def chain_fmu(request: pytest.FixtureRequest) -> Fmu:
    return request.getfixturevalue(request.param)["chain"]


def test_every_fmu_gives_what_the_library_gives_and_restores_it(chain_fmu):
    model = CableChain(scene_from_values(generic_scene(), VALUES, "chain"))
    model.initialize(SWAYING(0.0))
    instance = chain_fmu.instance()
    instance.initialize(VALUES, SWAYING(0.0))
    assert "lower end moved by inputs" in instance.get("effects.active")
    found, expected = [instance.outputs()], [model.outputs.copy()]
    for k in range(60):
        if k == 30:
            saved = instance.slave.getFMUstate()
        found.append(instance.step(0.05 * k, 0.05, SWAYING(0.05 * k)))
        model.step(0.05 * k, 0.05, SWAYING(0.05 * k))
        expected.append(model.outputs.copy())
    assert_same(np.array(found), np.array(expected))
    instance.slave.setFMUstate(saved)
    again = [instance.step(0.05 * k, 0.05, SWAYING(0.05 * k)) for k in range(30, 60)]
    assert np.array_equal(np.array(again), np.array(found)[31:])
    instance.close()


def test_an_fmu_that_drives_none_refuses_its_inputs_and_one_that_does_its_place(chain_fmu):
    refuses_an_input(chain_fmu, "lower.vx", "the inputs lower.* say where the lower end is, but they do not drive it")
    instance = chain_fmu.instance()
    with pytest.raises(FMICallException):
        instance.initialize({**VALUES, "lower_end.x": 5.0}, SWAYING(0.0))
    assert "Give the place by lower.position, in an FMU by lower.x, y and z." in instance.errors[-1]
    instance.close()


def test_the_native_fmu_takes_derivatives_of_the_lower_ends_inputs(native):
    """Positions are set by fmi2SetReal, velocities as their derivatives: the same run."""
    rows = []
    for by_derivatives in (False, True):
        instance = native["chain"].instance()
        instance.initialize(VALUES, SWAYING(0.0))
        ends = [f"{end}.{{}}{axis}" for end in ("top", "lower") for axis in "xyz"]
        places, velocities = ([instance.fmu.references[name.format(kind)] for name in ends] for kind in ("", "v"))
        for k in range(20):
            given = dict(zip(INPUTS, SWAYING(0.05 * k).tolist(), strict=False))  # but for the current
            speeds = [given[name.format("v")] for name in ends]
            instance.slave.setReal(places, [given[name.format("")] for name in ends])
            if by_derivatives:
                instance.slave.setRealInputDerivatives(places, [1] * 6, speeds)
            else:
                instance.slave.setReal(velocities, speeds)
            instance.slave.doStep(0.05 * k, 0.05)
        rows.append(instance.outputs())
        instance.close()
    assert np.array_equal(*rows)


def test_the_guides_tug_pulls_its_barge(native, monkeypatch, tmp_path):
    """The block of docs/how_to/both_ends.md: in the end the thrust is the drag of ships and line, and the barge feels its own."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "CableChain.fmu").write_bytes(native["chain"].path.read_bytes())
    (block,) = re.findall(r"```python\n(.*?)```", GUIDE.read_text(encoding="utf-8"), re.DOTALL)
    names: dict[str, object] = {}
    exec(compile(block, str(GUIDE), "exec"), names)
    tug, barge = names["speeds"]
    drag = names["drag"]
    assert tug == pytest.approx(barge, rel=1e-3)
    assert names["pull"] == pytest.approx(drag[names["barge"]] * barge**2, rel=5e-3)
    line = names["thrust"] - drag[names["tug"]] * tug**2 - drag[names["barge"]] * barge**2
    along_it = 0.5 * 1025.0 * 0.02 * 0.056 * 300.0 * tug**2  # tangential drag
    assert 0.5 * along_it < line < 0.02 * names["thrust"]
