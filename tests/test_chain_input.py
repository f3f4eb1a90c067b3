"""Bad input to the chain through the library: every rule one error, with its whole text."""

import dataclasses

import numpy as np
import pytest
from chain_support import HANGING, make

from cable_model import parameters
from cable_model.errors import ParameterError, SolverError
from cable_model.scene import from_dict

WET = {"cable": {"length": 1.0, "mass_per_length": 1.0, "axial_stiffness": 1e4, "diameter": 0.01}, "water": {}}
PARTS = {
    "cable": parameters.Cable,
    "body": parameters.Body,
    "environment": parameters.Environment,
    "water": parameters.Water,
    "waves": parameters.Waves,
    "top": parameters.Top,
    "tow": parameters.Tow,
    "solver": parameters.Solver,
    "run": parameters.Run,
}
FIELDS = [(part, field) for part, kind in PARTS.items() for field in dataclasses.fields(kind)]
LOWER = [(p, f) for p, f in FIELDS if f.metadata["above"] is not None or f.metadata["least"] is not None]
UPPER = [(p, f) for p, f in FIELDS if f.metadata["most"] is not None]


def top(**values: float) -> np.ndarray:
    """Inputs at rest but for the named ones: x, y, z, vx, vy, vz, ax, ay, az."""
    names = ("x", "y", "z", "vx", "vy", "vz", "ax", "ay", "az")
    return np.array([float(values.get(name, 0.0)) for name in names])


def text_of(part: str, field: dataclasses.Field, shown: str) -> str:
    """`<name> = <value> <unit>: must be <rule>. <what to do>`."""
    facts = field.metadata
    bounds = (("> ", facts["above"]), (">= ", facts["least"]), ("<= ", facts["most"]))
    rule = " and ".join(f"{sign}{bound:g}" for sign, bound in bounds if bound is not None)
    if facts["gap"] is not None:  # what lies between is refused too
        rule = rule.replace(f">= {facts['gap'][0]:g}", "{:g} or >= {:g}".format(*facts["gap"]))
    unit = " " + facts["unit"] if facts["unit"] not in ("", "1") else ""
    verb = "Say" if facts["description"].startswith(("where ", "whether ")) else "Give the"
    remedy = facts["remedy"] or f"{verb} {facts['description']}."
    return f"{part}.{field.name} = {shown}{unit}: must be {rule}. {remedy}"


def with_value(part: str, name: str, value: object) -> dict:
    tables = {p: dict(values) for p, values in WET.items()}
    tables.setdefault(part, {})[name] = value
    return tables


@pytest.mark.parametrize(("part", "field"), LOWER, ids=[f"{p}.{f.name}" for p, f in LOWER])
def test_a_value_below_its_bound_is_refused_with_name_value_unit_rule_and_remedy(part, field):
    facts = field.metadata
    value = facts["above"] if facts["above"] is not None else facts["least"] - 1
    value = int(value) if "int" in str(field.type) else float(value)
    with pytest.raises(ParameterError) as caught:
        from_dict(with_value(part, field.name, value))
    assert str(caught.value) == text_of(part, field, f"{value:.10g}")


@pytest.mark.parametrize(("part", "field"), UPPER, ids=[f"{p}.{f.name}" for p, f in UPPER])
def test_a_value_above_its_bound_is_refused_with_name_value_unit_rule_and_remedy(part, field):
    value = field.metadata["most"] + 1
    value = int(value) if "int" in str(field.type) else float(value)
    with pytest.raises(ParameterError) as caught:
        from_dict(with_value(part, field.name, value))
    assert str(caught.value) == text_of(part, field, f"{value:.10g}")


@pytest.mark.parametrize(
    ("changes", "text"),
    [
        (
            {"current": {"levels": [[0.0, 1.0, 0.0], [-2.0, 1.0, 0.0], [-1.0, 1.0, 0.0]]}},
            "current.levels = 3 rows: must be sorted by z without repeats. Sort the table by z.",
        ),
        (
            {"current": {"levels": [[0.0, 1.0, 0.0], [0.0, 1.0, 0.0]]}},
            "current.levels = 2 rows: must be sorted by z without repeats. Sort the table by z.",
        ),
        (
            {"current": {"levels": [[0.0, 1.0, 0.3]]}},
            "current.levels[0] = 0.3 rad: must be 0 or pi in the plane. Set solver.space = true, or turn the axes so that x is along it.",
        ),
        (
            {"waves": {"amplitude": 1.0, "direction": 0.3}},
            "waves.direction = 0.3 rad: must be 0 or pi in the plane. Set solver.space = true, or turn the axes so that x is along it.",
        ),
        (
            {"solver": {"grid": "box", "space": True}},
            'solver.space = True: must be false on the box grid. Set solver.grid = "staggered" for motion in space.',
        ),
        (
            {"top": {"motion": [{"kind": "spiral", "axis": "x"}]}},
            "top.motion[0].kind = 'spiral': must be one of sinusoid, ramp, step. Give the kind of motion.",
        ),
        (
            {"top": {"position": [0.0, 0.0]}},
            "top.position = [0.0, 0.0] m: must be a list of 3. Give the position about which the top moves.",
        ),
    ],
    ids=lambda value: value.split(":")[0] if isinstance(value, str) else "",
)
def test_values_that_do_not_go_together_are_refused(changes, text):
    with pytest.raises(ParameterError) as caught:
        from_dict({**WET, **changes})
    assert str(caught.value) == text


@pytest.mark.parametrize(
    ("inputs", "text"),
    [
        (top(x=np.nan), "top.x = nan m: must be finite. Check what is connected to this input."),
        (top(vz=np.inf), "top.vz = inf m/s: must be finite. Check what is connected to this input."),
        (top(ay=-np.inf), "top.ay = -inf m/s2: must be finite. Check what is connected to this input."),
        (
            np.zeros(8),
            "inputs = (8,): must be (9,), (10,), (19,), (21,) or (22,). "
            "Give position, velocity and acceleration of the top; with a winch its speed, a driven lower end 19, a current 21, or all.",
        ),
    ],
    ids=["nan", "inf", "-inf", "shape"],
)
def test_inputs_that_are_no_motion_are_refused_at_the_door(inputs, text):
    model = make(HANGING)
    model.initialize(top())
    before = model.state.copy()
    for call in (lambda: model.initialize(inputs), lambda: model.step(0.0, 0.01, inputs), lambda: model.advance(0.0, 0.01, top(), inputs)):
        with pytest.raises(ParameterError) as caught:
            call()
        assert str(caught.value) == text
    assert np.array_equal(model.state, before)


@pytest.mark.parametrize(("step", "shown"), [(0.0, "0"), (-0.1, "-0.1"), (np.nan, "nan"), (np.inf, "inf")])
def test_a_communication_step_that_is_not_positive_is_refused(step, shown):
    model = make(HANGING)
    model.initialize(top())
    with pytest.raises(ParameterError) as caught:
        model.step(0.0, step, top())
    assert str(caught.value) == f"communication step = {shown} s: must be finite and > 0. Give a positive step."


@pytest.mark.parametrize(("step", "shown"), [(0.0, "0"), (-0.1, "-0.1"), (np.nan, "nan")])
def test_a_step_with_known_motion_that_is_not_positive_is_refused(step, shown):
    model = make(HANGING)
    model.initialize(top())
    with pytest.raises(ParameterError) as caught:
        model.advance(0.0, step, top(), top())
    assert str(caught.value) == f"communication step = {shown} s: must be finite and > 0. Give a positive step."


def test_a_top_at_a_million_metres_a_second_ends_in_one_error_and_the_chain_runs_again():
    model = make(HANGING)
    model.initialize(top())
    with pytest.raises((ParameterError, SolverError), match=r"top"):
        model.step(0.0, 0.01, top(vx=1e6))
    model.initialize(top())
    model.step(0.0, 0.01, top())
    assert model.outputs[5] == pytest.approx(0.0, abs=1e-12)


def test_a_plane_chain_refuses_a_top_that_leaves_its_plane():
    model = make(HANGING)
    model.initialize(top())
    with pytest.raises(SolverError) as caught:
        model.step(0.0, 0.01, top(y=0.1, vy=10.0))
    assert str(caught.value) == (
        "CableChain at t = 0 s: the top, the lower end or a current that inputs give left the vertical plane y = const in which the model "
        "moves. Keep top.y and lower.y constant and water.current_y at 0, or set solver.space = true. Results before this time are valid."
    )
