"""The tow model against trajectories of [Wang 1971]'s equations that were integrated independently (data/wang/README.md)."""

import json
from pathlib import Path

import numpy as np
import pytest
from tow_reference import SLOW

from cable_model.effects import Parts
from cable_model.tow_cable import TowCable

FOLDER = Path(__file__).parent / "data" / "wang"
CASES = ("case1_large_swing", "case3_disk_current", "case5_ramp_stiff")


def read(case, mode):
    facts = json.loads((FOLDER / f"{case}.json").read_text())
    return facts, np.genfromtxt(FOLDER / f"{case}_{mode}.csv", delimiter=",", names=True)


def along(axis, t):
    """Position, velocity, acceleration of an axis: harmonics and smooth ramps of the velocity."""
    p, v, a = axis.get("offset", 0.0), 0.0, 0.0
    for part in axis.get("harmonics", []):
        angle, omega, size = part["omega"] * t + part["phase"], part["omega"], part["amp"]
        p, v, a = p + size * np.sin(angle), v + size * omega * np.cos(angle), a - size * omega**2 * np.sin(angle)
    for part in axis.get("ramps", []):
        span, dv = part["duration"], part["delta_v"]
        s = (t - part["t_start"]) / span
        if s >= 1.0:
            p, v = p + dv * span * (s - 0.5), v + dv
        elif s > 0.0:
            p += dv * span * (2.5 * s**4 - 3 * s**5 + s**6)
            v += dv * (10 * s**3 - 15 * s**4 + 6 * s**5)
            a += dv / span * (30 * s**2 - 60 * s**3 + 30 * s**4)
    return p, v, a


def top_motion(facts, t):
    (x, vx, ax), (y, vy, ay) = along(facts["top_motion"]["x"], t), along(facts["top_motion"]["y"], t)
    return np.array([x, 0.0, -y, vx, 0.0, -vy, ax, 0.0, -ay])


def model_of(facts, mode):
    cable, body, gravity = facts["cable"], facts["body"], facts["gravity"]
    dry_mass = body["weight_in_water_N"] / gravity
    numbers = {
        "cable.length": cable["length_ref_m"],
        "cable.diameter": cable["diameter_ref_m"],
        "cable.mass_per_length": cable["mass_ref_kg_per_m"],
        "cable.axial_stiffness": cable["AE_ref_N"],
        "cable.axial_damping": cable["C_I_N_s"],
        "cable.normal_drag_coefficient": cable["C_D_normal"],
        "cable.tangential_drag_coefficient": cable["C_t"],
        "cable.added_mass_coefficient": cable["added_mass_factor"],
        "body.mass": dry_mass,
        "body.added_mass": body["virtual_mass_x_kg"] - dry_mass,
        "tow.added_mass_vertical": body["virtual_mass_y_kg"] - dry_mass,
        "body.drag_area": body["CDA_n_m2"],
        "tow.drag_area_axial": body["CDA_t_m2"],
        "tow.body_angle": np.deg2rad(body["phi_b_deg"]),
        "tow.poisson_ratio": cable["poisson"],
        "tow.reference_tension": cable["tension_ref_N"],
        "tow.drag_segments": cable["n_drag_segments"],
        "environment.gravity": gravity,
        "water.density": facts["water"]["density"],
        "solver.tolerance": 1e-9,
    }
    current = facts["water"].get("current")
    if current is not None:
        current = np.array(sorted([-y, speed, 0.0] for y, speed in zip(current["y_m"], current["c_m_s"], strict=True)))
    parts = Parts(
        voigt=True if cable["C_I_N_s"] else None,
        body=True,
        water=True,
        current=current,
        cable_mass=True,
        as_printed=True if mode == "report" else None,
    )
    return TowCable.from_numbers(numbers, parts)


@pytest.mark.parametrize("mode", ["corrected", "report"])
@pytest.mark.parametrize("case", CASES)
def test_every_signal_follows_the_reference_to_1e_minus_6_of_its_range(case, mode):
    facts, rows = read(case, mode)
    model = model_of(facts, mode)
    model.initialize(top_motion(facts, 0.0))
    first = facts["initial"]
    model.set_state(first["phi"], first["phidot"], first["u"], first["udot"])
    finer = 10  # the series holds every tenth row
    seen, steps = [], 0
    names = ("phi", "phidot", "u", "udot", "x_b", "y_b", "F_bc", "T_top", "F_top_x", "F_top_y", "T_body", "x_s", "y_s")
    spring = facts["cable"]["AE_ref_N"] / facts["cable"]["length_ref_m"]
    damper = facts["cable"]["C_I_N_s"] / facts["cable"]["length_ref_m"]
    count = 6 if SLOW else len(rows)
    for row in rows[:count]:
        while steps * facts["dt"] < row["t"] - 1e-9:
            t, end = steps * facts["dt"], (steps + 1) * facts["dt"]
            model.advance(t, end - t, top_motion(facts, t), top_motion(facts, end))
            steps += 1
        _, _, u, ud = model.motion
        top = model.state[6:9]
        force = (model["top.tension"], -model["top.force_x"], model["top.force_z"], model["body.tension"])
        seen.append([*model.motion, model["body.x"], -model["body.z"], spring * u + damper * ud, *force, top[0], -top[2]])
    assert steps == finer * (count - 1)
    seen = np.array(seen)
    for k, name in enumerate(names):
        reach = max(np.ptp(rows[name]), 1e-3)  # a coordinate that does not move: 1 nm
        assert np.abs(seen[:, k] - rows[name][:count]).max() < 1e-6 * reach, name


def test_the_reports_errors_are_visible_in_the_reference():
    """So that following both series shows that `as_printed` switches."""
    _, corrected = read("case3_disk_current", "corrected")
    _, printed = read("case3_disk_current", "report")
    assert np.abs(corrected["T_top"] - printed["T_top"]).max() > 1e-3 * np.ptp(corrected["T_top"])
