"""The FMUs on a seabed that slopes: what the library gives, restored states, and an anchor below the bottom that is told."""

from __future__ import annotations

import numpy as np
import pytest
from fmu_support import assert_same, sway
from native_support import FLAVOURS, library_run, native_run

from cable_model.signals import INPUTS
from fmu_src.interface import generic_scene, scene_from_values

pytestmark = pytest.mark.shipped

STEP = 0.1
MOORED = {
    "lower_end.anchored": True, "lower_end.x": 60.0, "lower_end.z": -60.0, "body.mass": 0.0, "body.volume": 0.0, "body.drag_area": 0.0,
    "body.added_mass": 0.0, "seabed.level": -48.0, "seabed.stiffness": 1e5, "seabed.friction_coefficient": 0.5, "seabed.slope": -0.2,
    "top.motion_order": 2,
}  # fmt: skip


@pytest.mark.parametrize("flavour", FLAVOURS)
@pytest.mark.parametrize("space", [False, True])
def test_every_fmu_gives_what_the_library_gives_over_a_slope_and_restores_it(request, flavour, space):
    fmu = request.getfixturevalue(flavour)["chain"]
    values = {**MOORED, "solver.space": space, "seabed.slope_direction": 0.2 if space else 0.0}
    if space:
        values["lower_end.z"] = -48.0 - 0.2 * 60.0 * np.cos(0.2)
    inputs = np.array([[*sway(k * STEP), *[0.0] * (len(INPUTS) - 9)] for k in range(40)])
    instance = fmu.instance()
    found = native_run(instance, values, inputs, STEP)
    assert_same(found, library_run("chain", scene_from_values(generic_scene(), values, "chain"), inputs, STEP))
    assert "seabed that slopes" in instance.get("effects.active")
    assert not [text for _, text in instance.messages if "pushed into the bottom" in text]
    saved = instance.slave.getFMUstate()
    ahead = [instance.step((40 + k) * STEP, STEP, inputs[k]) for k in range(5)]
    instance.slave.setFMUstate(saved)
    assert np.array_equal([instance.step((40 + k) * STEP, STEP, inputs[k]) for k in range(5)], ahead)
    instance.close()


@pytest.mark.parametrize("flavour", FLAVOURS)
def test_an_anchor_below_a_slope_is_told(request, flavour):
    instance = request.getfixturevalue(flavour)["chain"].instance()
    instance.initialize({**MOORED, "lower_end.z": -65.0}, np.zeros(len(INPUTS)))
    assert [text for _, text in instance.messages if "an end of the cable at z = -65 m, the seabed at -60 m: it is pushed into" in text]
    instance.close()
