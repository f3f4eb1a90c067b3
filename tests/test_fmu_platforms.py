"""Native FMUs for all platforms, built on one: what their libraries ask of a system, and their numbers where they can be run."""

from __future__ import annotations

import os
import re
import shutil
import struct
import subprocess
import sys
import zipfile
from pathlib import Path

import fmpy
import numpy as np
import pytest
import typer
from fmu_support import FIRST, HEAD, Fmu
from native_support import KEYS, lean, native_run, values_of
from typer.testing import CliRunner

from cable_model.errors import ParameterError
from cable_model.models import MODELS
from cable_model.motion import motion_of
from fmu_src.build import main as build_main
from fmu_src.interface import generic_scene, table
from fmu_src.native import build, link
from fmu_src.native.object_code import can_export
from fmu_src.native.targets import TARGETS

pytestmark = pytest.mark.xdist_group("native")
with_zig = pytest.mark.skipif(not (link.available() and link.has_zig()), reason="needs 64-bit x86 Linux and ziglang")
STEPS = 200
SHIPPED = [("chain", "hanging_chain"), ("chain", "towed_body"), ("chain", "basin_chain"), ("tow", "towed_body"), ("tow", "dale_sphere")]
PLACES = {"linux64": ".so", "win64": ".dll", "darwin64": ".dylib", "aarch64-linux": ".so"}
WINE = shutil.which("wine64", path=f"{os.environ['PATH']}:/usr/lib/wine") or shutil.which("wine") or ""
QEMU, ARM_LIBRARIES = shutil.which("qemu-aarch64-static") or shutil.which("qemu-aarch64") or "", Path("/usr/aarch64-linux-gnu")
RUNNERS = [
    pytest.param(("win64", [WINE]), marks=pytest.mark.skipif(not WINE, reason="needs wine64")),
    pytest.param(
        ("aarch64-linux", [QEMU, "-L", str(ARM_LIBRARIES)]),
        marks=pytest.mark.skipif(not (QEMU and ARM_LIBRARIES.is_dir()), reason="needs qemu-user-static and libc6-arm64-cross"),
    ),
]  # fmt: skip


@pytest.fixture(scope="module")
def fmus_of_all(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Fmu]:
    folder = tmp_path_factory.mktemp("platforms")
    return {KEYS[path.stem]: Fmu(path, folder / path.stem) for path in build.build_all(folder)}


def library_in(fmu: Fmu, folder: str) -> Path:
    return Path(fmu.folder) / "binaries" / folder / f"{fmu.path.stem}{PLACES[folder]}"


@with_zig
@pytest.mark.parametrize("key", sorted(MODELS))
def test_one_archive_has_every_platform(fmus_of_all: dict[str, Fmu], key: str):
    path = fmus_of_all[key].path
    with zipfile.ZipFile(path) as archive:
        names = {name for name in archive.namelist() if name.startswith("binaries/")}
    assert names == {f"binaries/{folder}/{path.stem}{suffix}" for folder, suffix in PLACES.items()}
    assert not fmpy.validation.validate_fmu(str(path))


@with_zig
@pytest.mark.parametrize("key", sorted(MODELS))
def test_the_same_archive_comes_out_again_byte_for_byte(fmus_of_all: dict[str, Fmu], key: str, tmp_path: Path):
    again = build.build_native(key, tmp_path / fmus_of_all[key].path.name)
    assert again.read_bytes() == fmus_of_all[key].path.read_bytes()


@with_zig
@pytest.mark.parametrize("folder", ["linux64", "aarch64-linux"])
@pytest.mark.parametrize("key", sorted(MODELS))
def test_a_linux_library_asks_for_an_old_glibc(fmus_of_all: dict[str, Fmu], key: str, folder: str):
    """By the versions of glibc that it asks for: 2.17, as RHEL 7 has it, is the oldest on the arm."""
    code = library_in(fmus_of_all[key], folder).read_bytes()
    assert code[:4] == b"\x7fELF"
    assert struct.unpack_from("<H", code, 18)[0] == {"linux64": 62, "aarch64-linux": 183}[folder]
    versions = {tuple(map(int, version.split(b"."))) for version in re.findall(rb"GLIBC_(\d+(?:\.\d+)+)\0", code)}
    assert versions
    assert max(versions) <= (2, 17)


@with_zig
@pytest.mark.parametrize("key", sorted(MODELS))
def test_a_windows_library_shows_what_fmi_asks_for_and_needs_windows_alone(fmus_of_all: dict[str, Fmu], key: str):
    exported, imported = windows_names(library_in(fmus_of_all[key], "win64").read_bytes())
    assert exported
    assert all(name.startswith("fmi2") for name in exported)
    assert all(re.fullmatch(r"kernel32\.dll|api-ms-win-crt-\w+-l1-1-0\.dll", name.lower()) for name in imported)


def windows_names(code: bytes) -> tuple[list[str], list[str]]:
    """Functions that a PE32+ library for x86-64 exports, and libraries that it imports from."""
    head = struct.unpack_from("<I", code, 0x3C)[0]
    assert code[head : head + 4] == b"PE\0\0"
    machine, sections = struct.unpack_from("<HH", code, head + 4)
    size = struct.unpack_from("<H", code, head + 20)[0]
    assert (machine, struct.unpack_from("<H", code, head + 24)[0]) == (0x8664, 0x20B)
    rows = [struct.unpack_from("<IIII", code, head + 24 + size + 40 * k + 8) for k in range(sections)]

    def at(address: int) -> int:
        return next(address - start + place for length, start, raw, place in rows if start <= address < start + max(length, raw))

    def text(address: int) -> str:
        place = at(address)
        return code[place : code.index(b"\0", place)].decode()

    exports, imports = (struct.unpack_from("<I", code, head + 24 + 112 + 8 * k)[0] for k in range(2))
    count, names = struct.unpack_from("<I", code, at(exports) + 24)[0], struct.unpack_from("<I", code, at(exports) + 32)[0]
    exported = [text(struct.unpack_from("<I", code, at(names) + 4 * k)[0]) for k in range(count)]
    imported, place = [], at(imports)
    while name := struct.unpack_from("<I", code, place + 12)[0]:
        imported.append(text(name))
        place += 20
    return exported, imported


@with_zig
@pytest.mark.parametrize("key", sorted(MODELS))
def test_a_mac_library_has_both_processors_needs_the_system_alone_and_is_signed_for_the_arm(fmus_of_all: dict[str, Fmu], key: str):
    code = library_in(fmus_of_all[key], "darwin64").read_bytes()
    magic, count = struct.unpack_from(">II", code)
    assert (magic, count) == (0xCAFEBABE, 2)
    seen = {}
    for k in range(count):
        processor, _, place, length, page = struct.unpack_from(">IIIII", code, 8 + 20 * k)
        assert place % 2**page == 0
        seen[processor] = mac_commands(code[place : place + length])
    assert set(seen) == {0x01000007, 0x0100000C}  # x86-64, arm64
    for commands in seen.values():
        assert [text for kind, text in commands if kind == 0xC] == ["/usr/lib/libSystem.B.dylib"]  # LC_LOAD_DYLIB
    assert any(kind == 0x1D for kind, _ in seen[0x0100000C])  # LC_CODE_SIGNATURE: Apple's arm runs nothing without


def mac_commands(code: bytes) -> list[tuple[int, str]]:
    """Load commands of a thin Mach-O library for macOS 11 or later, with the name that each may hold."""
    assert struct.unpack_from("<I", code)[0] == 0xFEEDFACF
    assert struct.unpack_from("<I", code, 12)[0] == 6  # MH_DYLIB
    place, found = 32, []
    for _ in range(struct.unpack_from("<I", code, 16)[0]):
        kind, size = struct.unpack_from("<II", code, place)
        text = ""
        if kind == 0xC:
            begin = place + struct.unpack_from("<I", code, place + 8)[0]
            text = code[begin : code.index(b"\0", begin)].decode()
        if kind == 0x32:  # LC_BUILD_VERSION: macOS, and the oldest one
            assert struct.unpack_from("<II", code, place + 8) == (1, 11 << 16)
        found.append((kind, text))
        place += size
    return found


@pytest.fixture(scope="module", params=RUNNERS)
def runner(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> tuple[str, list[str]]:
    """A platform's folder, and the command that runs the C host there."""
    folder, command = request.param
    target = next(target for target in TARGETS if target.folder == folder)
    host = tmp_path_factory.mktemp("host") / ("host.exe" if folder == "win64" else "host")
    zig = [sys.executable, "-m", "ziglang", "cc", "-target", target.zig, "-O1", f"-I{link.fmi_headers()}", "-o", str(host)]
    libraries = [] if folder == "win64" else ["-ldl", "-lpthread"]
    subprocess.run([*zig, str(Path(__file__).parent / "native_host.c"), *libraries], check=True, cwd=host.parent)
    return folder, [*command, str(host)]


@with_zig
@pytest.mark.parametrize(("key", "name"), SHIPPED)
def test_a_shipped_scene_gives_the_same_numbers_on_another_platform(
    runner: tuple[str, list[str]], fmus_of_all: dict[str, Fmu], key: str, name: str, tmp_path_factory: pytest.TempPathFactory
):
    """To 1e-9 of each signal's size: libm's last digits differ."""
    folder, command = runner
    fmu, scene = fmus_of_all[key], lean(name, key)
    values, motion, step = values_of(scene, key), motion_of(scene), scene.run.output_step
    inputs = np.array([motion(k * step) for k in range(STEPS)])
    rows = {row.name: (vr, row.kind[0].lower()) for vr, row in enumerate(table(generic_scene()))}
    given = [f"{rows[name][1]} {rows[name][0]} {float(value)!r}" for name, value in values.items() if not isinstance(value, str)]
    lines = [str(len(given)), *given, *(" ".join(map(repr, row[:HEAD])) for row in inputs.tolist())]
    guid = fmpy.read_model_description(str(fmu.path)).guid
    arguments = [str(library_in(fmu, folder)), guid, str(STEPS), repr(step), str(FIRST), str(HEAD)]
    home = tmp_path_factory.getbasetemp()
    environment = {"PATH": os.environ["PATH"], "HOME": str(home), "WINEPREFIX": str(home / "wine"), "WINEDEBUG": "-all"}
    done = subprocess.run([*command, *arguments], input="\n".join(lines), capture_output=True, text=True, env=environment, check=False)
    assert done.returncode == 0, done.stderr
    found = np.array([float.fromhex(line) for line in done.stdout.split()]).reshape(STEPS, FIRST)
    instance = fmu.instance()
    expected = native_run(instance, values, inputs, step)[1:, :FIRST]
    instance.close()
    assert np.abs(found - expected).max(axis=0) / (np.abs(expected).max(axis=0) + 1e-300) == pytest.approx(0.0, abs=1e-9)


def test_a_platform_that_nobody_knows_is_refused(tmp_path: Path):
    with pytest.raises(ParameterError, match=r"platform = 'win32': must be one of linux64, win64, darwin64, aarch64-linux\. "):
        build.build_native("tow", tmp_path / "x.fmu", platforms=["win32"])


@pytest.mark.skipif(link.compiler() is None or not can_export(), reason="needs a C compiler")
def test_without_zig_there_is_the_machines_own_platform(monkeypatch: pytest.MonkeyPatch, tmp_path: Path):
    monkeypatch.setattr(link, "has_zig", lambda: False)
    with zipfile.ZipFile(build.build_native("tow", tmp_path / "x.fmu")) as archive:
        assert [name for name in archive.namelist() if name.startswith("binaries/")] == ["binaries/linux64/x.so"]
    with pytest.raises(ParameterError, match=r"linker for win64 = none: .* Run `pip install ziglang`"):
        build.build_native("tow", tmp_path / "x.fmu", platforms=["win64"])


def test_a_platform_where_no_native_fmu_is_built_is_refused(tmp_path: Path):
    app = typer.Typer()
    app.command()(build_main)
    for command in (["dale_sphere", "-o", str(tmp_path / "x.fmu")], ["--no-native", "-o", str(tmp_path / "x")]):
        done = CliRunner().invoke(app, [*command, "--platform", "win64"])
        assert (done.exit_code, done.stderr) == (2, "--platform: must be left out where no native FMU is built. Add --native.\n")


def test_what_is_missing_for_other_platforms_is_one_line(monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr(link, "available", lambda: TARGETS[:1])
    monkeypatch.setattr(link, "has_zig", lambda: False)
    assert link.missing() == (
        "Native FMUs are for linux64 alone: linking for win64, darwin64, aarch64-linux needs zig. Run `pip install ziglang`."
    )
    monkeypatch.setattr(link, "has_zig", lambda: True)
    assert link.missing() == ""


@pytest.mark.parametrize(
    ("arguments", "text"),
    [
        (["dale_sphere", "-o", "scene.toml"], "--output = scene.toml: must end in .fmu. Give the FMU another name than the scene."),
        (["", "-o", "a.fmu"], "--output = a.fmu: must be a folder where no scene is baked in. Name the scene, or a folder."),
        (["--model", "tow"], "--model: must be left out where no scene is baked in: FMUs of both are built. Name a scene."),
        (["--simulate", "nosuch"], "nosuch: "),
    ],
)
def test_what_build_would_ignore_or_overwrite_is_refused_at_once(arguments, text):
    app = typer.Typer()
    app.command()(build_main)
    done = CliRunner().invoke(app, arguments)
    assert done.exit_code == 2
    assert done.stderr.startswith(text)
