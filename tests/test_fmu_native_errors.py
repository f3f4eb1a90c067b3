"""The native FMUs: clear errors, the same as the Python FMU's, after which they go on."""

from __future__ import annotations

import numpy as np
import pytest
from fmu_support import (
    ERROR,
    FMICallException,
    Fmu,
    a_mooring_follows_the_top_during_initialization,
    outputs_follow_what_is_set_during_initialization,
    recovers,
    refused,
    started,
    sway,
    undisturbed_runs,
)
from native_support import only_where_they_run
from test_fmu_input import BAD_PARAMETERS_OF, BAD_STEPS, STEP, bad_parameters

from cable_model.models import MODELS
from cable_model.signals import INPUTS
from fmu_src.interface import generic_scene

pytestmark = only_where_they_run


@pytest.fixture(params=sorted(MODELS))
def fmu(request: pytest.FixtureRequest, native: dict[str, Fmu]) -> Fmu:
    return native[request.param]


@pytest.fixture(scope="module")
def undisturbed(native: dict[str, Fmu]) -> dict[str, np.ndarray]:
    return undisturbed_runs(native)


@pytest.mark.parametrize("case", BAD_STEPS)
def test_a_bad_step_is_the_same_one_error_as_in_the_python_fmu(fmu: Fmu, undisturbed: dict[str, np.ndarray], case: str):
    time, step, inputs, text = BAD_STEPS[case]
    instance = started(fmu)
    before = instance.outputs()
    with pytest.raises(FMICallException) as error:
        instance.step(time, step, inputs)
    assert error.value.status == ERROR
    assert instance.errors == [text]
    assert np.array_equal(instance.outputs(), before)
    assert np.array_equal(instance.run(5, first=5), undisturbed[fmu.path.stem][5:])
    recovers(instance, undisturbed[fmu.path.stem])


@pytest.mark.parametrize(("model", "case"), BAD_PARAMETERS_OF)
def test_a_bad_parameter_is_the_same_one_error_as_in_the_python_fmu(
    native: dict[str, Fmu], undisturbed: dict[str, np.ndarray], model: str, case: str
):
    recovers(refused(native[model], *bad_parameters(model, case)), undisturbed[native[model].path.stem])


def test_a_grid_that_was_not_compiled_is_refused_at_the_end_of_initialization(native: dict[str, Fmu], undisturbed: dict[str, np.ndarray]):
    instance = native["chain"].instance()
    with pytest.raises(FMICallException, match="fmi2ExitInitializationMode"):
        instance.initialize({"solver.grid": 1})
    assert instance.errors == [
        "solver.grid = 1: must be 0: this native FMU was compiled without the part 'box'. Use the FMU that runs Python, or bake the scene."
    ]
    recovers(instance, undisturbed["CableChain"])


def test_a_top_of_a_million_metres_a_second_is_refused(fmu: Fmu, undisturbed: dict[str, np.ndarray]):
    instance = started(fmu)
    inputs = sway(5 * STEP)
    inputs[INPUTS.index("top.x")] = 1e6
    with pytest.raises(FMICallException):
        instance.step(5 * STEP, STEP, inputs)
    (error,) = instance.errors
    assert error.startswith("speed of the top or lower end = ")
    assert error.endswith(" m/s: must be <= 10000. Check the units of its motion, and for jumps.")
    recovers(instance, undisturbed[fmu.path.stem])


def test_a_failed_step_says_what_the_library_says_and_lasts_until_restored(native: dict[str, Fmu], undisturbed: dict[str, np.ndarray]):
    """TowCable keeps to its plane."""
    inputs = sway(5 * STEP)
    inputs[INPUTS.index("top.vy")] = 0.5
    model = MODELS["tow"](generic_scene())
    model.initialize(sway(0.0))
    for k in range(5):
        model.step(k * STEP, STEP, sway(k * STEP))
    with pytest.raises(RuntimeError) as expected:
        model.step(5 * STEP, STEP, inputs)
    instance = started(native["tow"])
    state = instance.slave.getFMUstate()
    with pytest.raises(FMICallException):
        instance.step(5 * STEP, STEP, inputs)
    with pytest.raises(FMICallException):
        instance.step(6 * STEP, STEP, sway(6 * STEP))
    assert instance.errors == [
        str(expected.value),
        "instance = 'failed': must be initialized and running. Initialize, reset or restore it first.",
    ]
    instance.slave.setFMUstate(state)
    assert np.array_equal(instance.run(5, first=5), undisturbed["TowCable"][5:])
    recovers(instance, undisturbed["TowCable"])


def test_calls_out_of_turn_are_errors(fmu: Fmu, undisturbed: dict[str, np.ndarray]):
    instance = fmu.instance()
    for call in (
        lambda: instance.slave.doStep(0.0, STEP),
        instance.slave.exitInitializationMode,
        lambda: instance.slave.setupExperiment(startTime=float("nan")),
    ):
        with pytest.raises(FMICallException):
            call()
    instance.initialize()
    for call in (
        lambda: instance.set({"cable.length": 3.0}),
        lambda: instance.set({"top.tension": 3.0}),
        lambda: instance.set({"effects.active": "all"}),
        instance.slave.enterInitializationMode,
        lambda: instance.slave.getReal([12345]),
        lambda: instance.slave.getReal([fmu.references["solver.nodes"]]),
    ):
        with pytest.raises(FMICallException):
            call()
    assert instance.errors == [
        "instance = 'instantiated': must be initialized and running. Initialize, reset or restore it first.",
        "instance = 'instantiated': must be initializing. Enter the initialization mode first.",
        "start time = nan s: must be finite. Give the time at which the simulation starts.",
        "cable.length = 3 m: must be set before the end of initialization. Reset the FMU first.",
        "top.tension = 3 N: must be left alone: it is calculated. Set inputs and parameters only.",
        "effects.active = 'all': must be left alone: it is calculated. Set inputs and parameters only.",
        "instance = 'running': must be new. Reset it first.",
        f"value reference = 12345: must be below {len(fmu.references)}. Use the references of modelDescription.xml.",
        "solver.nodes as Real: must be got and set as Integer. Use the types of modelDescription.xml.",
    ]
    recovers(instance, undisturbed[fmu.path.stem])


def test_outputs_read_during_initialization_follow_what_is_set_then(fmu: Fmu):
    outputs_follow_what_is_set_during_initialization(fmu)


def test_a_mooring_follows_the_top_that_is_set_during_initialization(native: dict[str, Fmu]):
    a_mooring_follows_the_top_during_initialization(native["chain"])


def test_a_library_of_another_build_is_not_instantiated(fmu: Fmu):
    instance = fmu.instance()
    arguments = (b"x", 1, b"{00000000-0000-0000-0000-000000000000}", None, instance._callbacks, 0, 0)
    assert not instance.slave.fmi2Instantiate(*arguments)
    assert instance.errors == [f"GUID: must be {fmu.description.guid}. The library and modelDescription.xml do not belong together."]
    instance.close()
