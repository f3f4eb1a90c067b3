"""The FMUs in water that changes: what the library gives, restored states, and refusals; the program of the guide."""

import math
import re
from pathlib import Path

import numpy as np
import pytest
from fmu_support import refuses_an_input, sway
from native_support import FLAVOURS, gives_what_the_library_gives

from cable_model.models import MODELS
from cable_model.signals import INPUTS

GUIDE = Path(__file__).parent.parent / "docs" / "how_to" / "water.md"
STEP = 0.1
VALUES = {
    "water.current_input": True, "current.speed": 0.6, "current.ramp_time": 2.0, "wave.amplitude": 0.8, "wave.period": 6.0,
    "wave.ramp_time": 3.0, "top.motion_order": 2,
}  # fmt: skip


def flowing(t: float, aside: float) -> np.ndarray:
    """All inputs: a top that sways, and a current that turns."""
    return np.array([*sway(t), *[0.0] * 10, 0.4 * math.sin(0.7 * t) + 0.1, aside * math.cos(0.9 * t)])


@pytest.mark.parametrize("flavour", FLAVOURS)
@pytest.mark.parametrize("model", sorted(MODELS))
@pytest.mark.parametrize("space", [False, True])
def test_every_fmu_gives_what_the_library_gives_and_restores_it(request, flavour, model, space):
    fmu = request.getfixturevalue(flavour)[model]
    values = {**VALUES, "solver.space": space}
    inputs = np.array([flowing(k * STEP, 0.3 if space else 0.0) for k in range(40)])
    instance = gives_what_the_library_gives(fmu, model, values, inputs, STEP)
    for words in ("current that inputs give", "current that grows from the start", "waves that grow from the start"):
        assert words in instance.get("effects.active")
    instance.close()


@pytest.mark.parametrize("flavour", FLAVOURS)
@pytest.mark.parametrize("model", sorted(MODELS))
def test_a_current_that_an_fmu_does_not_ask_for_is_refused(request, flavour, model):
    fmu = request.getfixturevalue(flavour)[model]
    refuses_an_input(fmu, "water.current_y", "the inputs water.current_x and y give a current, but are not asked for")


def test_the_guides_program_runs():
    (program,) = re.findall(r"```python\n(.*?)```", GUIDE.read_text(encoding="utf-8"), re.DOTALL)
    names: dict = {}
    exec(program, names)
    assert names["cable"].outputs[INPUTS.index("top.x")] != 0.0
