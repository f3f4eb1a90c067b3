"""Builds FMUs: the generic ones of both models, or one with a scene baked in.  The same input gives the same bytes.

This is the command `cable-fmu build`, and build_fmu.py in the repository.
"""

from __future__ import annotations

import contextlib
import dataclasses
import hashlib
import io
import os
import pprint
import re
import sys
import tempfile
import uuid
import zipfile
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Annotated
from xml.etree.ElementTree import Element, indent, tostring

import pythonfmu
import typer
from pythonfmu import FmuBuilder

from cable_model import __version__
from cable_model.cli import summary
from cable_model.cli_console import check_output, console, load_scene, words_of
from cable_model.entries import Variant
from cable_model.errors import ParameterError, SolverError, writing
from cable_model.models import MODELS
from cable_model.scene import Scene
from fmu_src import trial
from fmu_src.documentation import build as documentation
from fmu_src.documentation import licences
from fmu_src.interface import generic_scene, table
from fmu_src.launcher import build as launcher
from fmu_src.model_description import epoch_of, osp_description
from fmu_src.native import build as native_build
from fmu_src.native import link
from fmu_src.native.build import IDENTIFIERS
from fmu_src.native.export import ExportError
from fmu_src.native.object_code import can_export, object_code, prepare, variants_of
from fmu_src.vendoring import Vendored, vendor

HERE = Path(__file__).resolve().parents[1]  # where both packages lie
REQUIREMENTS = b"numpy>=2.0\nnumba>=0.61\nplatformdirs>=4\n"
FOR_A_CURVE = b"scipy>=1.14\n"  # it joins the rows of a table of the stiffness
EPOCH = (1980, 1, 1, 0, 0, 0)
_MODULES = ("fmu_src.slave",)

_SCRIPT = '''"""The slave of this FMU, written by fmu_src.build."""

import sys

if sys.version_info < (3, 11):
    what = "must be 3.11 or newer. Run the host with such a Python, or use the native FMU."
    raise ImportError("Python = %d.%d: %s" % (*sys.version_info[:2], what))
if locals() is globals():
    import importlib
    from pathlib import Path

    try:
        import {staging} as staging
        from pythonfmu import Fmi2Slave  # pythonfmu looks for it here

        staging.load("{kernels}", Path(__file__).parent)
        staging.load("{package}", Path(__file__).parent)
        wrapper = importlib.import_module("{package}.fmu_src.wrapper")
        CableSlave = importlib.import_module("{package}.fmu_src.slave").CableSlave
        precompiled = importlib.import_module("{package}.cable_model.precompiled")
    except ModuleNotFoundError as error:
        what = "Install what resources/requirements.txt lists, or use the native FMU."
        raise ImportError("%s: must be installed where this FMU runs. %s" % (error.name, what)) from error

    class {identifier}(CableSlave):
        object_code = {object_code}
        model_key = "{model}"
        build_guid = "{guid}"
        tool = "{tool}"
        scene_values = {values}

    seen = wrapper.stand_in()
else:  # pythonfmu runs the text of the imported file again at every instantiation, and looks at the classes that this makes
    wrapper.keep(globals())  # which are given back once too often then
    {identifier} = seen
'''


def scene_values(scene: Scene) -> dict[str, object]:
    """The scene as nested tables that from_dict takes back unchanged."""
    return {name: value for name, value in dataclasses.asdict(scene).items() if value is not None}


def identifier_of(path: Path) -> str:
    """A C identifier from a file's name."""
    name = re.sub(r"\W", "_", path.stem, flags=re.ASCII)
    return name if name[:1].isalpha() else f"Cable_{name}"


def _guid(*facts: object) -> str:
    digest = hashlib.sha256("\0".join(map(str, facts)).encode()).digest()
    return "{" + str(uuid.UUID(bytes=digest[:16])) + "}"


@contextlib.contextmanager
def _imports_undone() -> Iterator[None]:
    """Forget what pythonfmu's builder imports: it puts its folder first on the path and leaves it there."""
    path, modules = list(sys.path), set(sys.modules)
    try:
        yield
    finally:
        sys.path[:] = path
        for name in set(sys.modules) - modules:
            if name.startswith(("cable_fmu_", "cable_kernels_", "staging_", "slave_")):
                del sys.modules[name]


def _xml(root: Element) -> bytes:
    indent(root)
    return b'<?xml version="1.0" encoding="UTF-8"?>\n' + tostring(root, encoding="utf-8") + b"\n"


def _unpacked(source: Path) -> dict[str, bytes]:
    with zipfile.ZipFile(source) as archive:
        return {info.filename: archive.read(info) for info in archive.infolist() if not info.is_dir()}


def _pack(entries: dict[str, bytes], to: Path) -> None:
    """Write an archive: sorted, one date, no machine's traces; the folder appears with the file."""
    buffer = io.BytesIO()
    with zipfile.ZipFile(buffer, "w", zipfile.ZIP_DEFLATED) as archive:
        for name in sorted(entries, key=lambda name: (name != "modelDescription.xml", name)):
            info = zipfile.ZipInfo(name, EPOCH)
            info.compress_type, info.create_system, info.external_attr = zipfile.ZIP_DEFLATED, 3, 0o100644 << 16
            archive.writestr(info, entries[name])
    to.parent.mkdir(parents=True, exist_ok=True)
    with writing(to):
        to.write_bytes(buffer.getvalue())


def _object_code(model: str, scene: Scene) -> tuple[bytes, Sequence[Variant]]:
    """The kernels compiled for the scene's effects, or for those of the generic scene; none, with a line on stderr, where that fails."""
    if not can_export():
        sys.stderr.write("No object code in the FMU: this machine is no 64-bit x86 Linux. Numba compiles the kernels where it runs.\n")
        return b"", ()
    variants = variants_of(model, None if scene == generic_scene() else scene)
    try:
        return object_code(model, variants), variants
    except ExportError as error:
        sys.stderr.write(f"{error}\nNo object code in the FMU: numba compiles the kernels where it runs.\n")
        return b"", ()


def _write_resources(
    folder: Path, vendored: Vendored, identifier: str, model: str, scene: Scene, root: Path, code: bytes, variants: Sequence[Variant]
) -> tuple[Path, str]:
    """Everything that lies beside the slave's script, and the script and the FMU's GUID."""
    for name, content in vendored.files.items():
        path = folder / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(content)
    staging = (root / "fmu_src" / "staging.py").read_bytes()
    staging_name = f"staging_{hashlib.sha256(staging).hexdigest()[:12]}"
    (folder / f"{staging_name}.py").write_bytes(staging)
    (folder / "requirements.txt").write_bytes(REQUIREMENTS + (FOR_A_CURVE if scene.cable.stiffness_curve else b""))
    values = pprint.pformat(scene_values(scene), sort_dicts=False, width=120)
    shipped = "precompiled.ObjectCode()"
    if code:
        (folder / "kernels.o").write_bytes(code)
        listed = pprint.pformat([dict(variant) for variant in variants], sort_dicts=False, width=120)
        digest = hashlib.sha256(code).hexdigest()
        shipped = f'precompiled.shared("{digest}", Path(__file__).parent / "kernels.o", {listed})'
    guid = _guid(identifier, model, values, vendored.package, staging_name, pythonfmu.__version__, shipped, launcher.sources())
    text = _SCRIPT.format(
        staging=staging_name, kernels=vendored.kernels, package=vendored.package, identifier=identifier, model=model,
        guid=guid, tool=f"cable_fmu {__version__} with PythonFMU {pythonfmu.__version__}", values=values, object_code=shipped,
    )  # fmt: skip
    script = folder / f"slave_{guid[1:14].replace('-', '')}.py"
    script.write_text(text, encoding="utf-8")
    return script, guid


def build(model: str, scene: Scene, to: Path, root: Path = HERE, precompile: bool = True) -> Path:
    """Write the pythonfmu FMU of a model ("chain" or "tow") with a scene baked in; `root` holds the packages' sources.

    precompile: ship the kernels as object code too, which takes a few minutes when it is done for the first time.
    """
    identifier = identifier_of(to)
    with tempfile.TemporaryDirectory() as name, _imports_undone():
        folder = Path(name) / "files"
        folder.mkdir()
        vendored = vendor(root, _MODULES)
        ours = precompile and vendored.kernels == vendor(HERE, _MODULES).kernels  # else the object code would be of other kernels
        script, guid = _write_resources(
            folder, vendored, identifier, model, scene, root, *(_object_code(model, scene) if ours else (b"", ()))
        )
        others = [path for path in folder.iterdir() if path != script]
        made = FmuBuilder.build_FMU(
            script, dest=Path(name) / f"{identifier}.fmu", project_files=others,
            needsExecutionTool=False, canGetAndSetFMUstate=True, canSerializeFMUstate=True,
        )  # fmt: skip
        entries = launcher.before_pythonfmu(_unpacked(made), identifier, guid)
        entries |= documentation.files(
            model, identifier, table(scene), scene, documentation.PYTHON, licences.of_python(launcher.can_compile())
        )
        _pack(entries | {"resources/OspModelDescription.xml": _xml(osp_description())}, to)
    to.with_name(f"{to.stem}_OspModelDescription.xml").write_bytes(_xml(osp_description()))
    return to


def _check_arguments(scene: str, output: Path | None, model: str, native: bool | None, platform: Sequence[str], fmi3: bool | None) -> None:
    """Refuse what would be ignored, and an output that would take the place of something else."""
    if not scene and model:
        raise ParameterError("--model: must be left out where no scene is baked in: FMUs of both are built. Name a scene.")
    if output is not None and scene and output.suffix != ".fmu":
        raise ParameterError(f"--output = {output}: must end in .fmu. Give the FMU another name than the scene.")
    if output is not None and not scene and output.suffix == ".fmu":
        raise ParameterError(f"--output = {output}: must be a folder where no scene is baked in. Name the scene, or a folder.")
    for option, given in (("--platform", platform), ("--fmi3", fmi3)):
        if given and (native is False or (scene and not native)):
            raise ParameterError(f"{option}: must be left out where no native FMU is built. Add --native.")


def main(
    scene: Annotated[str, typer.Argument(help="a scene file or the name of a shipped scene to bake in; none: build all into dist/")] = "",
    output: Annotated[Path | None, typer.Option("--output", "-o", help="the FMU to write")] = None,
    model: Annotated[str, typer.Option(help="chain or tow; as the scene says if left out")] = "",
    native: Annotated[
        bool | None, typer.Option(help="also build FMUs that need no Python, of a scene into native/ beside; default: only without a scene")
    ] = None,
    platform: Annotated[
        list[str] | None, typer.Option(help="of native FMUs: linux64, win64, darwin64, aarch64-linux; may be repeated; default: all it can")
    ] = None,
    fmi3: Annotated[
        bool | None, typer.Option(help="also build the native FMUs as FMI 3.0, into fmi3/ beside; default: only without a scene")
    ] = None,
    precompile: Annotated[bool, typer.Option(help="ship compiled kernels, so that the FMUs start at once (64-bit x86 Linux)")] = True,
    date: Annotated[str, typer.Option(help="date and time that the FMUs carry, as 2026-05-31T12:00:00Z, or now; default: 1980")] = "",
    simulate: Annotated[str, typer.Option(help="a scene to simulate the built FMUs on, through fmpy; results go to results/")] = "",
) -> None:
    """Build the FMUs, and try them on a scene if one is named."""
    try:
        check_output(output, folder=not scene)
        _check_arguments(scene, output, model, native, platform or (), fmi3)
        if date:
            os.environ["SOURCE_DATE_EPOCH"] = str(epoch_of(date))
        if simulate:
            load_scene(simulate)  # it is read again: what is wrong in it is told before minutes are spent
        made: list[Path] = []
        tried: dict[str, Path] = {}  # those that run Python, by model
        if scene:
            baked = load_scene(scene)
            key = model or baked.run.model
            if key not in MODELS:
                raise ParameterError(f"--model = {key!r}: must be one of {', '.join(MODELS)}. Choose one of them.")
            target = output or Path("dist") / f"{Path(scene).stem}.fmu"
            if native:
                folders = {"native": "2.0"} | ({"fmi3": "3.0"} if fmi3 else {})
                made = [
                    native_build.build_native(key, target.parent / folder / target.name, baked, platform or (), fmi)
                    for folder, fmi in folders.items()
                ]
            tried = {key: build(key, baked, target, precompile=precompile)}
            made = [*tried.values(), *made]
        else:
            dist = output or Path("dist")
            if can_export() and (precompile or native is not False):
                with contextlib.suppress(ExportError):  # it fails again, and is told, where it is asked for
                    prepare()
            asked = bool(native or platform or fmi3)  # then what cannot be linked is an error
            made = native_build.build_all(dist, platform or (), asked) if native is not False else []
            if made and fmi3 is not False:
                made += native_build.build_all(dist / "fmi3", platform or (), asked, "3.0")
            python = dist / "python"
            tried = {key: build(key, generic_scene(), python / f"{IDENTIFIERS[key]}.fmu", precompile=precompile) for key in MODELS}
            made += tried.values()
        if native is not False and not platform and (native or not scene) and (words := link.missing()):
            typer.echo(words, err=True)
        for path in made:
            typer.echo(f"{path}  {path.stat().st_size} bytes")
        if simulate:
            results = trial.simulate(tried, simulate, Path("results"))
            console.print(summary(results))
            typer.echo("CSV files and a picture are in results/")
    except (ParameterError, SolverError, ExportError) as error:
        typer.echo(str(error), err=True)
        raise typer.Exit(2) from None
    except OSError as error:
        typer.echo(words_of(error), err=True)
        raise typer.Exit(2) from None
