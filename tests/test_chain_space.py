"""Motion in space against motion in the plane, and the turn of a whole scene about the vertical."""

import numpy as np
import pytest
from chain_support import HANGING, SHORT_BENDING, WIRE, drive, every, make, swing


@pytest.mark.parametrize("bending", [0.0, SHORT_BENDING])
def test_a_plane_scene_in_space_is_the_plane_scene(bending):
    base = {**HANGING, "solver": {**HANGING["solver"], "nodes": 51}}
    motion = swing((0.02, 0.0, 0.0), 6.535)
    plane = drive(make(base, cable__bending_stiffness=bending), every(0.01, 5.0), motion)
    space = drive(make(base, cable__bending_stiffness=bending, solver__space=True), every(0.01, 5.0), motion)
    for name in ("body.x", "body.z", "top.tension", "top.force_x", "top.force_z"):
        assert space[name] == pytest.approx(plane[name], abs=1e-10)
    assert np.abs(space["body.y"]).max() < 1e-14


@pytest.mark.parametrize("angle", [0.7, np.pi / 2.0, -2.5])
def test_a_scene_turned_about_the_vertical_turns_its_answer(angle):
    c, s = np.cos(angle), np.sin(angle)
    solver = {"nodes": 31, "time_step": 0.05, "lambda_infinity": -0.5, "space": True}

    def sea(turn: float) -> dict:
        levels = [[-200.0, 0.2, 0.3 + turn], [0.0, 0.8, 1.0 + turn]]
        waves = {"amplitude": 1.0, "period": 8.0, "direction": 0.4 + turn}
        return {**WIRE, "solver": solver, "current": {"levels": levels}, "waves": waves}

    motion = swing((1.0, 0.5, 0.5), 0.8, ramp_time=4.0, phase=(0.0, 1.0, 0.5))

    def turned(t: float) -> np.ndarray:
        state = motion(t)
        for k in (0, 3, 6):
            state[k], state[k + 1] = c * state[k] - s * state[k + 1], s * state[k] + c * state[k + 1]
        return state

    first = drive(make(sea(0.0)), every(0.05, 20.0), motion)
    second = drive(make(sea(angle)), every(0.05, 20.0), turned)
    for name in ("body.{}", "body.v{}", "top.force_{}"):
        x, y, z = (first[name.format(axis)] for axis in "xyz")
        scale = max(1.0, np.abs(first[name.format("z")]).max())
        expected = (c * x - s * y, s * x + c * y, z)
        for axis, values in zip("xyz", expected, strict=True):
            assert second[name.format(axis)] == pytest.approx(values, abs=1e-9 * scale)
    assert np.ptp(first["body.y"]) > 0.05  # it does leave the plane
