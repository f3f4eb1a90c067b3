"""How kernels are compiled: numba's private options change no bit, and a version of numba that nobody tried gets none of them."""

import gc
import subprocess
import sys
import warnings

import numba
import numpy as np
import pytest
from numba.core.codegen import JITCodeLibrary

from cable_model.kernels import jit

RUN = """
from cable_model.kernels import jit
private = {private}
if not private:
    jit.TESTED = ()
import warnings
with warnings.catch_warnings(record=True):
    warnings.simplefilter("always")
    assert ("_nrt" in jit.options()) == ("pipeline_class" in jit.inner_options()) == private
from cable_model import TowCable, load
from cable_model.motion import motion_of
scene = load("dale_sphere")
model, motion = TowCable(scene), motion_of(scene)
model.initialize(motion(0.0))
for k in range(50):
    model.advance(0.1 * k, 0.1, motion(0.1 * k), motion(0.1 * (k + 1), -1))
print(model.state.tobytes().hex())
"""


@pytest.mark.skipif(bool(numba.config.DISABLE_JIT), reason="nothing is compiled")
def test_private_options_change_no_bit(tmp_path_factory: pytest.TempPathFactory) -> None:
    states = []
    for private in (True, False):
        folder = tmp_path_factory.mktemp("cache")  # numba's cache does not know the options
        environment = {"XDG_CACHE_HOME": str(folder), "PATH": "", "PYTHONPATH": ":".join(sys.path)}
        done = subprocess.run(
            [sys.executable, "-c", RUN.format(private=private)], env=environment, capture_output=True, text=True, check=False
        )
        assert done.returncode == 0, done.stderr
        states.append(done.stdout)
    assert len(states[0]) > 100
    assert states[0] == states[1]


def test_an_untried_numba_gets_ordinary_options_and_a_warning(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(jit, "TESTED", ("0.1.", "0.2."))
    monkeypatch.setattr(numba.config, "DISABLE_JIT", 0)
    with pytest.warns(UserWarning, match=r"numba .*, while 0\.1, 0\.2 are those that were tested: .* Install one of these"):
        assert jit.options.__wrapped__() == jit.ORDINARY


@pytest.mark.skipif(bool(numba.config.DISABLE_JIT), reason="nothing is compiled")
def test_the_numba_at_hand_is_a_tried_one() -> None:
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        assert jit.options.__wrapped__()["_nrt"] is False


@pytest.mark.skipif(bool(numba.config.DISABLE_JIT), reason="nothing is compiled")
def test_a_kernel_that_gives_arrays_to_python_is_an_error_and_never_their_whole() -> None:
    def half(x: np.ndarray) -> tuple[np.ndarray, float]:
        return x[:2], x[3]

    with pytest.raises(TypeError, match=r"half gives arrays to Python\. Decorate it with jit\.views\."):
        jit.kernel(half)(np.arange(4.0))
    assert jit.views(half)(np.arange(4.0))[0].tolist() == [0.0, 1.0]


def test_kernels_call_what_cuts_arrays() -> None:
    def half(x: np.ndarray) -> tuple[np.ndarray, float]:
        return x[:2], x[2]

    cut = jit.views(half)

    def last(x: np.ndarray) -> float:
        return cut(x)[0][1]

    assert jit.kernel(last)(np.array([3.0, 5.0, 7.0])) == 5.0


@jit.kernel
def _twice(x):
    return 2.0 * x


@jit.kernel
def _four_times(x):
    return _twice(_twice(x))


@pytest.mark.skipif(bool(numba.config.DISABLE_JIT) or "pipeline_class" not in jit.inner_options(), reason="no inner kernels")
def test_inner_kernels_keep_no_modules() -> None:
    """In memory they take eight times what their bitcode does, and a process that compiles for many scenes runs out of it."""
    assert _four_times(3.0) == 12.0
    _four_times.recompile()  # whatever numba had kept of a run before
    assert _four_times(3.0) == 12.0
    gc.collect()
    kept = [each for each in gc.get_objects() if type(each) is JITCodeLibrary and each.name in ("_twice", "_four_times")]
    inner = [each for each in kept if "_get_module_for_linking" in vars(each)]
    assert inner and all(each._shared_module is None and each._final_module.closed for each in inner)
    assert all("_twice" in str(each._get_module_for_linking()) for each in inner)
