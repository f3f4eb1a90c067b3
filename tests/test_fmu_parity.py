"""The FMUs on a seabed that slopes, and with clamped ends: what the library gives, restored states, and what is told."""

from __future__ import annotations

import math

import numpy as np
import pytest
from fmu_support import sway
from native_support import FLAVOURS, gives_what_the_library_gives

from cable_model.signals import INPUTS

STEP = 0.1
MOORED = {
    "lower_end.anchored": True, "lower_end.x": 60.0, "lower_end.z": -60.0, "body.mass": 0.0, "body.volume": 0.0, "body.drag_area": 0.0,
    "body.added_mass": 0.0, "seabed.level": -48.0, "seabed.stiffness": 1e5, "seabed.friction_coefficient": 0.5, "seabed.slope": -0.2,
    "top.motion_order": 2,
}  # fmt: skip


CLAMPED = {
    "cable.bending_stiffness": 2e4, "top.clamped": True, "top.clamp_declination": 0.1, "lower_end.anchored": True, "lower_end.x": 40.0,
    "lower_end.z": -80.0, "lower_end.clamped": True, "lower_end.clamp_declination": 0.9, "lower_end.clamp_direction": math.pi,
    "body.mass": 0.0, "body.volume": 0.0, "body.drag_area": 0.0, "body.added_mass": 0.0, "top.motion_order": 2,
}  # fmt: skip
SLOPING = {"seabed.slope_direction": 0.2, "lower_end.z": -48.0 - 0.2 * 60.0 * math.cos(0.2)}
CASES = {
    "slope": (MOORED, SLOPING, ("seabed that slopes",)),
    "clamps": (CLAMPED, {"top.clamp_direction": 0.3}, ("clamped top", "clamped lower end")),
}


@pytest.mark.parametrize("flavour", FLAVOURS)
@pytest.mark.parametrize("space", [False, True])
@pytest.mark.parametrize("case", CASES)
def test_every_fmu_gives_what_the_library_gives_and_restores_it(request, flavour, space, case):
    fmu = request.getfixturevalue(flavour)["chain"]
    plane, in_space, words = CASES[case]
    values = {**plane, "solver.space": space, **(in_space if space else {})}
    inputs = np.array([[*sway(k * STEP), *[0.0] * (len(INPUTS) - 9)] for k in range(40)])
    instance = gives_what_the_library_gives(fmu, "chain", values, inputs, STEP)
    assert all(word in instance.get("effects.active") for word in words)
    assert not [text for _, text in instance.messages if "pushed into the bottom" in text]
    instance.close()


@pytest.mark.parametrize("flavour", FLAVOURS)
def test_an_anchor_below_a_slope_is_told(request, flavour):
    instance = request.getfixturevalue(flavour)["chain"].instance()
    instance.initialize({**MOORED, "lower_end.z": -65.0}, np.zeros(len(INPUTS)))
    assert [text for _, text in instance.messages if "an end of the cable at z = -65 m, the seabed at -60 m: it is pushed into" in text]
    instance.close()
