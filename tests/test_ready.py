"""Object code that lies ready: it serves every scene, gives what numba compiles for it, and is never that of other sources."""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from fmu_support import assert_same
from native_support import BAKED

from cable_model import CableChain, Scene, TowCable, from_dict, load, ready, simulate, with_values
from cable_model.just_in_time import JustInTime
from cable_model.kernels.watch import WAVES_SEEN
from cable_model.model import Model, compiled
from cable_model.models import MODELS
from cable_model.motion import motion_of
from cable_model.precompiled import ObjectCode, Precompiled
from cable_model.scene import shipped
from cable_model.signals import OUTPUTS
from cable_model.simulation import read_csv
from fmu_src.native import object_code
from fmu_src.native.targets import LIBRARY, LINUX, Target

ROOT = Path(__file__).resolve().parent.parent
pytestmark = pytest.mark.skipif(
    not (object_code.can_export() and ready.is_recent()), reason="object code for every scene is for 64-bit x86 Linux with AVX2"
)
NEVER: Any = object()  # calls of a model that is not to run
PARTS: dict[str, Any] = {
    "cable": {
        "length": 30.0, "mass_per_length": 2.0, "diameter": 0.03, "axial_stiffness": 1e5, "normal_drag_coefficient": 1.2,
        "bending_stiffness": 20.0, "axial_damping": 1e3, "quadratic_damping": 10.0,
    },
    "water": {}, "body": {"mass": 10.0}, "winch": {"fitted": True, "speeds": [[0.0, 0.5], [10.0, 0.5]]},
    "seabed": {"level": -26.0, "slope": 0.1, "stiffness": 1e5, "friction_coefficient": 0.3},
    "top": {
        "position": [0.0, 0.0, 0.0], "clamped": True, "clamp_declination": 0.3,
        "motion": [{"kind": "sinusoid", "axis": "z", "amplitude": 1.0, "period": 3.0, "phase": -1.5707963267948966}],
    },
    "parting": {"time": 2.0, "place": 12.0}, "solver": {"nodes": 31, "time_step": 0.01}, "run": {"duration": 4.0, "output_step": 0.1},
}  # fmt: skip
CASES: dict[str, tuple[str, Scene]] = {
    **{name: (key, from_dict(values)) for name, (key, values) in BAKED.items()},
    "chain that parts, clamped, with bending, a winch and a bottom that slopes": ("chain", from_dict(PARTS)),
    "dale_sphere": ("tow", load("dale_sphere")),
}


@pytest.fixture(scope="module")
def code() -> dict[str, ObjectCode]:
    """Object code for every scene, by model."""
    return {model: ObjectCode(object_code.object_code(model, variants, LIBRARY), variants) for model, variants in ready.EVERY.items()}


@pytest.fixture
def unread() -> Iterator[None]:
    """Nothing is known of what lies ready, before and after."""
    ready._code.cache_clear()
    yield
    ready._code.cache_clear()


def run_of(model: Model, steps: int) -> np.ndarray:
    """Outputs on the way that a model's scene moves its top, those at the start first."""
    motion, step = motion_of(model.scene), model.scene.run.output_step
    model.initialize(motion(0.0))
    rows = [model.outputs.copy()]
    for k in range(steps):
        model.advance(k * step, step, motion(k * step), motion((k + 1) * step, -1))
        rows.append(model.outputs.copy())
    return np.array(rows)


def as_compiled(key: str, scene: Scene, code: dict[str, ObjectCode], steps: int) -> np.ndarray:
    """Outputs of a scene by object code, which are those by what numba compiles for it; to the bit where no waves are summed."""
    quick, own = MODELS[key](scene, code[key].calls), MODELS[key](scene, compiled)
    assert isinstance(own._calls, JustInTime)
    assert isinstance(quick._calls, Precompiled), code[key].refusal(quick)
    found, expected = run_of(quick, steps), run_of(own, steps)
    assert_same(found, expected)
    assert quick.warnings() == own.warnings()
    assert quick.state.shape == own.state.shape
    if own.parts.waves is None:
        assert np.array_equal(found, expected)
        for model in (quick, own):
            model.state[WAVES_SEEN] = 0.0  # no waves are looked at, or those of an empty table
        assert np.array_equal(quick.state, own.state)
        assert np.array_equal(quick.nodes(), own.nodes()) and np.array_equal(quick.shape(), own.shape())
    return found


# the rest are baked into FMUs, with exactly their parts, and held against this object code there
EVERY_DAY = ("chain of sections", "chain that parts", "dale_sphere")


@pytest.mark.parametrize("case", [pytest.param(case, marks=() if case.startswith(EVERY_DAY) else pytest.mark.long) for case in CASES])
def test_object_code_for_every_scene_gives_what_numba_compiles_for_one(case: str, code: dict[str, ObjectCode]):
    found = as_compiled(*CASES[case], code, 40 if "parts" in case else 20)
    parted = found[:, OUTPUTS.index("cable.parted")]
    assert (parted[0], parted[-1] > 0.0) == (0.0, "parts" in case)


@pytest.mark.long
@pytest.mark.parametrize("name", sorted(shipped()))
def test_object_code_gives_any_shipped_scene_as_numba_does(name: str, code: dict[str, ObjectCode]):
    scene = load(name)
    as_compiled(scene.run.model, scene, code, 20)


@pytest.mark.parametrize("name", sorted(shipped()))
def test_it_serves_every_shipped_scene(name: str, code: dict[str, ObjectCode]):
    scene = load(name)
    assert code["chain"].refusal(CableChain(scene, lambda model: NEVER)) == ""


@pytest.mark.xdist_group("native")  # whose worker has the object code of FMUs
@pytest.mark.parametrize(("variants", "target"), [(ready.EVERY, LIBRARY), (ready.GENERIC, LINUX)], ids=["prepared", "of FMUs"])
def test_a_run_starts_on_what_lies_in_the_cache(variants: Any, target: Target, tmp_path: Path):
    """And compiles nothing."""
    object_code.object_code("chain", variants["chain"], target)
    lying = ready.kept("chain", variants["chain"], target.processor)
    kept = tmp_path / "cable_fmu" / "native" / lying.name
    kept.parent.mkdir(parents=True)
    shutil.copy(lying, kept)
    text = (ROOT / "cable_model" / "scenes" / "hanging_chain.toml").read_text()
    (tmp_path / "short.toml").write_text(re.sub(r"(?m)^duration = .*", "duration = 0.5", text))
    command = [Path(sys.executable).parent / "cable-fmu", "run", "short.toml", "-o", "short.csv"]
    subprocess.run(command, cwd=tmp_path, env={**os.environ, "XDG_CACHE_HOME": str(tmp_path)}, check=True, capture_output=True)
    assert [path.name for path in (tmp_path / "cable_fmu").iterdir()] == ["native"]
    columns, rows = read_csv(tmp_path / "short.csv")
    own = simulate(CableChain(load(str(tmp_path / "short.toml"))))
    assert_same(rows, np.column_stack([own[name] for name in columns]))


@pytest.mark.xdist_group("native")
def test_numba_compiles_what_no_object_code_serves(code: dict[str, ObjectCode], monkeypatch: pytest.MonkeyPatch, unread: None):
    sphere = TowCable(load("dale_sphere"))
    assert isinstance(ready.calls(sphere), Precompiled)
    of_fmus = ObjectCode(object_code.object_code("tow", ready.GENERIC["tow"]), ready.GENERIC["tow"])
    assert of_fmus.calls(sphere) is not None
    cut = with_values(load("dale_sphere"), {"waves.amplitude": 0.1, "waves.surface": "cut"})
    assert of_fmus.calls(TowCable(cut, lambda model: NEVER)) is None
    monkeypatch.setenv("NUMBA_DISABLE_JIT", "1")  # kernels are to be plain Python
    assert ready.calls(sphere) is None
    monkeypatch.setenv("NUMBA_DISABLE_JIT", "0")
    assert ready.calls(sphere) is not None
    monkeypatch.setattr(ready, "found", lambda *of: b"")
    ready._code.cache_clear()
    assert ready.calls(sphere) is None


def test_an_older_processor_gets_the_code_of_fmus(monkeypatch: pytest.MonkeyPatch, unread: None):
    asked = []
    monkeypatch.setattr(ready, "found", lambda model, variants, processor: asked.append(processor) or b"")
    for recent, expected in ((True, [ready.OLDEST, ready.RECENT]), (False, [ready.OLDEST])):
        monkeypatch.setattr(ready, "is_recent", lambda recent=recent: recent)
        ready._code.cache_clear()
        asked.clear()
        ready.calls(TowCable(load("dale_sphere"), lambda model: NEVER))
        assert asked == expected


def test_object_code_of_other_sources_is_not_found(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    """Whatever of what it is made of has changed by a letter."""
    copy = tmp_path / "copy"
    for folder in ("cable_model", "fmu_src"):
        shutil.copytree(ROOT / folder, copy / folder, ignore=shutil.ignore_patterns("__pycache__", "scenes"))
    monkeypatch.setattr(ready, "ROOT", copy)
    monkeypatch.setattr(ready, "KERNELS", copy / "cable_model" / "kernels")

    def key() -> str:
        return ready.key("tow", ready.EVERY["tow"], ready.RECENT) if not ready._sources.cache_clear() else ""

    first = key()
    made_by = [ready.KERNELS / "slack.py", ready.KERNELS / "vector.py", *(copy / path for path in ready._MADE_BY)]
    for path in made_by:
        before = path.read_bytes()
        path.write_bytes(before + b"\n")
        assert key() != first, path
        path.write_bytes(before)
        assert key() == first
    ready._sources.cache_clear()
