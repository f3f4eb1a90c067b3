"""The audit of a run: right runs leave what their steps are wrong by, which falls with the step; a wrong load, mass or force shows."""

from __future__ import annotations

import io

import numpy as np
import pytest
from chain_support import HANGING, SECOND_MODE, SHORT_BENDING, WEIGHT, WIRE, Motion, energy, every, make, still, swing, view
from test_communication_steps import random_steps

from cable_model import cli
from cable_model.audit import Audit
from cable_model.cable_chain import CableChain
from cable_model.cli_console import Console
from cable_model.errors import ParameterError
from cable_model.kernels import audit, build, seabed, staggered, staggered_water
from cable_model.motion import motion_of
from cable_model.scene import from_dict, load, with_values
from cable_model.signals import OUTPUTS
from cable_model.simulation import simulate

ENERGY, MOMENTUM = OUTPUTS.index("audit.energy"), OUTPUTS.index("audit.momentum")
SWAY = swing((0.02, 0.0, 0.01), SECOND_MODE, phase=(0.0, 0.0, 0.5))
CIRCLE = swing((0.02, 0.01, 0.01), SECOND_MODE, phase=(0.0, 1.0, 0.5))
HEAVE = swing((0.5, 0.0, 1.0), 2.0 * np.pi / 8.0, ramp_time=8.0, phase=(0.0, 0.0, np.pi / 2.0))
CURVE = [[0.0, 0.0], [0.01, WEIGHT], [0.1, 30.0 * WEIGHT]]
MOORED = {
    "cable": {"length": 10.0, "mass_per_length": 0.1, "axial_stiffness": 1e4, "diameter": 0.004, "normal_drag_coefficient": 1.2},
    "lower_end": {"anchored": True, "z": -3.0},
    "water": {"density": 1000.0},
    "seabed": {"level": -3.0, "stiffness": 1e7, "friction_coefficient": 0.5},
    "top": {"position": [8.6, 0.0, -0.5]},
    "solver": {"nodes": 11, "time_step": 0.02},
}

THROWN = {"cable": {"length": 200.0, "mass_per_length": 3.0, "axial_stiffness": 1e6}, "body": {"mass": 1000.0}}
THROW = swing((0.0, 0.0, 8.0), 1.5, ramp_time=2.0)


def largest(model: CableChain, motion: Motion, steps: np.ndarray) -> Audit:
    """The audit at the end, with the largest energy that has been missing."""
    model.initialize(motion(0.0))
    time, missing = 0.0, 0.0
    for step in steps:
        model.advance(time, step, motion(time), motion(time + step))
        time += step
        missing = max(missing, abs(model.outputs[ENERGY]))
    found = model.audit
    assert found is not None
    assert model.outputs[[ENERGY, MOMENTUM]].tolist() == [found.energy, found.momentum]
    return found._replace(energy=missing)


def at(base: dict, motion: Motion) -> Motion:
    """The motion about the place of the scene's top."""
    place = np.array([*base["top"]["position"], *[0.0] * 6])
    return lambda time: motion(time) + place


def audited(base: dict, motion: Motion, step: float, duration: float, **changes: object) -> Audit:
    model = make(base, solver__audit=True, **{"solver__time_step": step, "solver__nodes": 9, **changes})
    return largest(model, motion, np.diff(every(step, duration)))


# scene, motion, a step that resolves it, duration, changes; and the shares of energy and momentum that are missing with that step
RIGHT = {
    "free": (HANGING, SWAY, 0.01, 0.8, {}, 5e-4, 1e-5),
    "free, lambda -1": (HANGING, SWAY, 0.01, 0.8, {"solver__lambda_infinity": -1.0}, 5e-4, 1e-9),
    "bent, in space, damped": (
        HANGING, CIRCLE, 0.01, 0.8,
        {"solver__space": True, "cable__bending_stiffness": 1e3 * SHORT_BENDING, "cable__axial_stiffness": 100.0 * WEIGHT,
         "cable__axial_damping": 1.0, "cable__quadratic_damping": 30.0}, 5e-4, 1e-5,
    ),
    "table of the stiffness": (HANGING, SWAY, 0.01, 0.8, {"cable__stiffness_curve": CURVE}, 5e-4, 1e-5),
    "table, pressed": (HANGING, SWAY, 0.01, 0.8, {"cable__stiffness_curve": CURVE, "cable__compressible": True}, 5e-4, 1e-5),
    "anchored": (HANGING, SWAY, 0.01, 0.8, {"lower_end__anchored": True, "lower_end__x": 0.9, "lower_end__z": -1.2}, 5e-4, 1e-5),
    "in water": (WIRE, HEAVE, 0.1, 8.0, {"cable__axial_stiffness": 1e6, "cable__tangential_drag_coefficient": 0.1,
        "cable__added_mass_coefficient": 1.0, "current__speed": 0.5, "waves__amplitude": 1.0, "waves__period": 7.0}, 1e-3, 1e-4),
}  # fmt: skip


@pytest.mark.parametrize("kind", RIGHT)
def test_what_is_missing_falls_with_the_square_of_the_step(kind):
    base, motion, step, duration, changes, share, force = RIGHT[kind]
    changes = {"solver__slack_damping": 0.0, **changes}
    coarse, fine = (audited(base, motion, h, duration, **changes) for h in (2.0 * step, step))
    assert fine.energy_share < share
    assert fine.momentum_share < force
    assert np.log2(coarse.energy / fine.energy) > 1.8
    assert kind == "free, lambda -1" or np.log2(coarse.momentum / fine.momentum) > 1.8


def test_a_snap_without_damping_is_missing_less_with_shorter_steps():
    """A payload that is thrown up on its line and falls into it again; nothing damps it."""
    changes = {"solver__lambda_infinity": -1.0, "solver__slack_damping": 0.0, "solver__slack_smoothing": 0.3, "solver__nodes": 3}
    coarse, fine = (audited(THROWN, THROW, h, 5.0, **changes) for h in (0.02, 0.01))
    assert fine.energy_share < 1e-3
    assert np.log2(coarse.energy / fine.energy) > 1.8


def test_a_snap_with_the_usual_smoothing_closes():
    changes = {"solver__lambda_infinity": -1.0, "solver__slack_damping": 0.0, "solver__nodes": 5}
    coarse, fine = (audited(THROWN, THROW, h, 5.0, **changes) for h in (0.02, 0.01))
    assert fine.energy_share < 5e-3
    assert np.log2(coarse.energy / fine.energy) > 1.8


@pytest.mark.parametrize("stiffness", [1e6, 5e7])
@pytest.mark.parametrize(("lam", "damping"), [(-1.0, 0.0), (-0.9, 0.1), (-0.5, 0.1)])
def test_what_is_taut_pulls_as_its_law_says_in_every_step_of_a_snap(lam, damping, stiffness):
    """A step may weigh the strains at its ends as it likes: a cell that is taut at both pulls at least as the smaller one asks.

    Below a fifth of the weight that hangs in it, 3.1 kN at the top, the damping of what is nearly slack takes its part.
    """
    changes = {"solver__lambda_infinity": lam, "solver__slack_damping": damping, "cable__axial_stiffness": stiffness}
    model = make(THROWN, solver__time_step=0.01, solver__nodes=9, **changes)
    model.initialize(THROW(0.0))
    cells = view(model)
    snaps = 0
    for k in range(500):
        before = np.linalg.norm(cells.y[:8], axis=1)
        model.advance(0.01 * k, 0.01, THROW(0.01 * k), THROW(0.01 * k + 0.01))
        least = stiffness * (np.minimum(before, np.linalg.norm(cells.y[:8], axis=1)) - 1.0)
        snaps += least.max() > 30e3
        assert np.all((cells.force >= 0.99 * least) | (least < 3.1e3))
    assert snaps > 3


def dragged(step: float) -> Audit:
    """A chain dragged over the seabed; seabed and friction act at the end of a step, so what is missing falls with the step alone."""
    scene = with_values(load("hard/dragged"), {"solver.audit": True, "solver.nodes": 11, "solver.time_step": step})
    model, motion = CableChain(scene), motion_of(scene)
    found = largest(model, motion, np.full(round(10.0 / step), step))
    assert model.state[audit.BED_WORK] < -0.2 * found.exchanged
    return found


def test_what_is_dragged_over_a_seabed_closes():
    coarse, fine = dragged(0.2), dragged(0.1)
    assert fine.energy_share < 1e-3
    assert fine.momentum_share < 1e-3
    assert coarse.energy / fine.energy > 1.5


@pytest.mark.plain
def test_friction_of_half_its_size_shows(monkeypatch):
    own = seabed.sliders.friction_of

    def half(*given):
        return tuple(tuple(0.5 * x for x in part) for part in own(*given))

    monkeypatch.setattr(seabed.sliders, "friction_of", half)
    found = dragged(0.2)
    assert found.energy_share > 0.05
    assert found.momentum_share > 0.01


def test_what_goes_in_and_out_of_the_water_closes():
    """A body and a cable at the surface, with drag, added mass and current."""
    changes = {"cable__axial_stiffness": 1e5, "cable__added_mass_coefficient": 1.0, "current__speed": 0.5, "water__surface": True,
               "cable__length": 12.0, "body__mass": 500.0}  # fmt: skip
    bob = swing((0.5, 0.0, 1.0), 1.3, ramp_time=2.0)
    lifted = at({"top": {"position": (0.0, 0.0, 11.5)}}, bob)
    found = [audited(WIRE, lifted, h, 4.0, solver__nodes=7, solver__slack_damping=0.0, **changes) for h in (0.04, 0.02)]
    assert found[1].energy_share < 2e-3
    assert found[1].momentum_share < 2e-3
    assert found[0].energy / found[1].energy > 2.5


def scaled(name: str, factor: float):
    own = build.cable_part
    return lambda water, p: own(water, p)._replace(**{name: factor * getattr(own(water, p), name)})


def reversed_body_drag(own=staggered_water.body_drag):
    return lambda k, u: tuple(tuple(-x for x in part) for part in own(k, u))


def one_heavy_cell(own=staggered.upward):
    count = iter(range(10**9))
    return lambda size, like: own(2.0 * size if next(count) % 8 == 3 else size, like)  # of eight cells


# what is put in the place of a kernel's own; and the least shares of energy and momentum that are then missing, where right runs have 5e-4
WRONG = {
    "the body's drag drives it": (WIRE, HEAVE, 0.1, 8.0, staggered_water, "body_drag", reversed_body_drag, 0.2, 0.02),
    "a cell weighs twice": (HANGING, SWAY, 0.01, 0.8, staggered, "upward", one_heavy_cell, 0.02, 0.02),
    "a tenth of the mass": (HANGING, SWAY, 0.01, 0.8, build, "cable_part", lambda: scaled("mass", 0.1), 0.1, 0.015),
    "a tenth more weight": (HANGING, SWAY, 0.01, 0.8, build, "cable_part", lambda: scaled("weight", 1.1), 0.05, 0.02),
    "a tenth of the coupled mass": (HANGING, SWAY, 0.01, 0.8, staggered, "SHARE", lambda: staggered.SHARE / 10.0, 2e-3, 0.0),
}  # fmt: skip


@pytest.mark.plain
@pytest.mark.parametrize("kind", WRONG)
def test_a_broken_kernel_shows(kind, monkeypatch):
    base, motion, step, duration, module, name, broken, share, force = WRONG[kind]
    changes = {"solver__slack_damping": 0.0, "cable__axial_stiffness": 1e6} if base is WIRE else {"solver__slack_damping": 0.0}
    right = audited(base, motion, step, duration, **changes)
    monkeypatch.setattr(module, name, broken())
    wrong = audited(base, motion, step, duration, **changes)
    assert right.energy_share < 1e-3 and right.momentum_share < 1e-4
    assert wrong.energy_share > share
    assert wrong.momentum_share > force


@pytest.mark.plain
def test_a_wrong_force_at_the_top_shows(monkeypatch):
    own = audit.end_forces

    def reversed_at_the_top(*given):
        forces = own(*given)
        return forces._replace(top=tuple(-x for x in forces.top))

    monkeypatch.setattr(audit, "end_forces", reversed_at_the_top)
    assert audited(HANGING, SWAY, 0.01, 0.8).energy_share > 0.5


def test_the_energy_stored_is_that_of_the_equations():
    """Against the tests' own formula, with bending and a slack cell."""
    model = make(HANGING, solver__audit=True, solver__nodes=9, solver__space=True, cable__bending_stiffness=1e3 * SHORT_BENDING)
    drop = swing((0.1, 0.05, 0.3), 9.0, ramp_time=0.3)
    model.initialize(drop(0.0))
    for k in range(40):
        model.advance(0.01 * k, 0.01, drop(0.01 * k), drop(0.01 * (k + 1)))
        assert model.state[audit.STORED] == pytest.approx(energy(model), abs=1e-9 * WEIGHT * 1.75)
    assert model.outputs[OUTPUTS.index("cable.slack_fraction")] > 0.0


def test_communication_steps_and_slivers_change_no_balance():
    lengths = {
        "internal": np.full(80, 0.01),
        "four of them": np.full(20, 0.04),
        "at random": np.array([*random_steps(0.01, 0.6, 3.0), *[1e-9] * 3, *[0.003] * 20]),
    }
    found = {kind: largest(make(HANGING, solver__audit=True, solver__nodes=9), SWAY, steps) for kind, steps in lengths.items()}
    assert all(audit.energy_share < 2e-3 and audit.momentum_share < 1e-4 for audit in found.values()), found
    assert found["four of them"].energy == pytest.approx(found["internal"].energy, rel=0.2)


def test_what_rests_is_missing_nothing():
    found = audited(MOORED, still((8.6, 0.0, -0.5)), 0.02, 0.2, solver__nodes=11)
    assert found.energy_share < 1e-6
    assert found.momentum_share < 1e-6


def test_an_end_that_is_let_go_is_audited_from_there():
    found = audited(HANGING, SWAY, 0.005, 0.4, lower_end__anchored=True, lower_end__released=True, lower_end__x=0.9, lower_end__z=-1.2)
    assert found.energy_share < 1e-3


IN_MANY_WAVES = {
    "cable__diameter": 0.005, "water__density": 1000.0,
    "waves": {"spectrum": "jonswap", "significant_height": 0.05, "peak_period": 1.0, "components": 40},
}  # fmt: skip


@pytest.mark.parametrize("changes", [{}, IN_MANY_WAVES], ids=["still", "many waves"])
@pytest.mark.parametrize("base", [HANGING, MOORED], ids=["free", "moored"])
def test_the_audit_changes_no_bit(base, changes):
    motion = SWAY if base is HANGING else at(base, SWAY)
    base = {**base, "waves": changes["waves"]} if changes else base
    changes = {name: value for name, value in changes.items() if name != "waves"}
    rows = []
    for asked in (False, True):
        model = make(base, solver__audit=asked, solver__nodes=9, solver__tolerance=1e-3, **changes)
        model.initialize(motion(0.0))
        for k in range(10):
            model.advance(0.03 * k, 0.03, motion(0.03 * k), motion(0.03 * (k + 1)))
            rows.append(model.outputs.copy())
        assert (model.audit is not None) == asked
    without, with_it = np.split(np.array(rows), 2)
    others = [k for k in range(len(OUTPUTS)) if k not in (ENERGY, MOMENTUM)]
    assert np.array_equal(without[:, others], with_it[:, others])
    assert not without[:, [ENERGY, MOMENTUM]].any() and with_it[:, MOMENTUM].all()


def test_run_shows_the_audit():
    scene = with_values(load("hanging_chain"), {"solver.audit": True, "solver.nodes": 9, "run.duration": 0.2})
    audited_run, other = simulate(CableChain(scene)), simulate(CableChain(with_values(scene, {"solver.audit": False})))
    assert audited_run.audit is not None and other.audit is None
    screen = Console(width=200, record=True, file=io.StringIO())
    screen.print(cli.summary({"CableChain": audited_run, "without": other}))
    text = screen.export_text()
    (line,) = (line for line in text.splitlines() if "audit: largest energy missing (J)" in line)
    assert f"{np.abs(audited_run['audit.energy']).max():.2g}, " in line and line.rstrip("│ ").endswith("-")
    assert "audit: force missing, rms (N)" in text
    assert "audit" not in "".join(str(cell) for column in cli.summary({"x": other}).columns for cell in column.cells)


def test_a_winch_is_not_audited():
    with pytest.raises(ParameterError) as caught:
        from_dict({**HANGING, "solver": {"audit": True}, "winch": {"fitted": True}})
    assert str(caught.value) == "solver.audit = True: must be false with a winch. Leave the audit out, or set winch.fitted = false."
