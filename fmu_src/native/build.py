"""Builds native FMUs: kernels as object code and the C layer, linked into a library a platform that needs no Python."""

from __future__ import annotations

import hashlib
import io
import re
import sys
import uuid
import zipfile
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import NamedTuple
from xml.etree.ElementTree import Element, indent, tostring

from cable_model import __version__
from cable_model.entries import Variant
from cable_model.models import MODELS
from cable_model.scene import Scene
from fmu_src import fmi3
from fmu_src.documentation import build as documentation
from fmu_src.documentation import licences
from fmu_src.interface import Variable, generic_scene, table
from fmu_src.model_description import model_description, osp_description
from fmu_src.native import link
from fmu_src.native.header import c_header
from fmu_src.native.object_code import bitcode, object_code, variants_of
from fmu_src.native.targets import Target

HERE = Path(__file__).resolve().parent
IDENTIFIERS = {"chain": "CableChain", "tow": "TowCable"}
SOURCES = ("fmu.c", "component.h", "values.h", "state.h", "absent.h", "log.h")
EPOCH = (1980, 1, 1, 0, 0, 0)


class Layer(NamedTuple):
    """What a version of FMI has of its own in an FMU."""

    sources: tuple[str, ...]  # in C; the first is compiled, and includes the others
    folder: str  # the field of Target that names a platform's folder
    token: str  # what the GUID is called
    description: Callable[[str, str, Sequence[Variable], Scene, str, str], Element]  # as model_description
    variables: Callable[[Sequence[Variable]], Sequence[Variable]]  # from the interface table
    ends: tuple[str, Callable[[], Element]]  # the file that tells which variables belong to an end of the cable
    picture: str  # the file that shows the model


def _fmi2_description(identifier: str, guid: str, rows: Sequence[Variable], scene: Scene, description: str, tool: str) -> Element:
    root = model_description(identifier, guid, rows, scene, description, tool, interpolates=True)
    for capabilities in root.iter("CoSimulation"):
        capabilities.set("canNotUseMemoryManagementFunctions", "false")
    return root


LAYERS = {
    "2.0": Layer(
        SOURCES, "folder", "GUID",
        _fmi2_description, tuple, ("resources/OspModelDescription.xml", osp_description), "model.png",
    ),
    "3.0": Layer(
        ("fmi3.c", "absent3.h", *SOURCES), "folder3", "instantiation token",
        fmi3.model_description, fmi3.variables, ("terminalsAndIcons/terminalsAndIcons.xml", fmi3.terminals), "terminalsAndIcons/icon.png",
    ),
}  # fmt: skip


def _libraries(
    header: str, model: str, variants: Sequence[Variant], targets: Sequence[Target], layer: Layer
) -> dict[tuple[str, str], bytes]:
    """Libraries of an FMU by their folders in binaries/ and their suffixes."""
    slices: dict[tuple[str, str], list[bytes]] = {}
    for target in targets:
        files = {"model.h": header.encode(), "kernels.o": object_code(model, variants, target)}
        made = link.library(target, files, [HERE / name for name in layer.sources], [layer.sources[0], "kernels.o"], ["-lm"])
        slices.setdefault((getattr(target, layer.folder), target.suffix), []).append(made)
    return {place: made[0] if len(made) == 1 else link.universal(made) for place, made in slices.items()}


def _guid(*facts: str | bytes) -> str:
    digest = hashlib.sha256(b"\0".join(fact if isinstance(fact, bytes) else fact.encode() for fact in facts)).digest()
    return "{" + str(uuid.UUID(bytes=digest[:16])) + "}"


def _description(layer: Layer, identifier: str, guid: str, rows: Sequence[Variable], scene: Scene, model: str) -> bytes:
    text = f"{MODELS[model].__name__}: cable under a moving top end. {scene.title}".strip()
    return _xml(layer.description(identifier, guid, rows, scene, text, f"cable_fmu {__version__}, native"))


def _xml(root: Element) -> bytes:
    indent(root)
    return b'<?xml version="1.0" encoding="UTF-8"?>\n' + tostring(root, encoding="utf-8") + b"\n"


def _zip(files: dict[str, bytes]) -> bytes:
    buffer = io.BytesIO()
    with zipfile.ZipFile(buffer, "w", zipfile.ZIP_DEFLATED, compresslevel=9) as archive:
        for name, content in files.items():
            info = zipfile.ZipInfo(name, EPOCH)
            info.compress_type, info.create_system, info.external_attr = zipfile.ZIP_DEFLATED, 3, 0o100644 << 16
            archive.writestr(info, content, compresslevel=9)
    return buffer.getvalue()


def build_native(model_name: str, destination: Path, scene: Scene | None = None, platforms: Sequence[str] = (), fmi: str = "2.0") -> Path:
    """Write the native FMU of a model ("chain" or "tow") for some platforms, by their folders in an FMU of FMI 2.0; none: for all it can.

    scene None: the parameters decide on the effects when the FMU initializes; otherwise the scene is baked in and only its effects are
    compiled.  fmi: "2.0" or "3.0".  The same input gives the same bytes.  Raises ParameterError where nothing can be linked.
    """
    targets, layer = link.chosen(platforms), LAYERS[fmi]
    identifier = re.sub(r"\W", "_", destination.stem, flags=re.ASCII)
    identifier = identifier if identifier[:1].isalpha() else f"Cable_{identifier}"
    base = generic_scene() if scene is None else scene
    rows, variants = table(base), variants_of(model_name, scene)
    header = c_header(identifier, rows, base, model_name, variants)
    sources = [(HERE / name).read_text(encoding="utf-8") for name in layer.sources]
    draft = _description(layer, identifier, "", rows, base, model_name)
    guid = _guid(header, bitcode(model_name, variants), *sources, draft)
    libraries = _libraries(f'#define MODEL_GUID "{guid}"\n{header}', model_name, variants, targets, layer)
    folders = [folder for folder, _ in libraries]
    runs, texts = documentation.NATIVE.format(", ".join(folders), layer.token), licences.of_native(folders, fmi)
    place, ends = layer.ends
    files = {
        "modelDescription.xml": _description(layer, identifier, guid, rows, base, model_name),
        **{f"binaries/{folder}/{identifier}{suffix}": made for (folder, suffix), made in libraries.items()},
        place: _xml(ends()),
        **documentation.files(model_name, identifier, layer.variables(rows), base, runs, texts, fmi, layer.picture),
    }
    destination.parent.mkdir(parents=True, exist_ok=True)
    destination.write_bytes(_zip(files))
    return destination


def build_all(folder: Path, platforms: Sequence[str] = (), must: bool = False, fmi: str = "2.0") -> list[Path]:
    """The generic native FMUs of both models; where nothing can be linked, none and a line on stderr, or ParameterError if they `must`."""
    if not must and not link.available():
        sys.stderr.write("No native FMUs: they need zig (pip install ziglang) or, on 64-bit Linux, a C compiler (cc, gcc or clang).\n")
        return []
    return [build_native(model, folder / f"{name}.fmu", platforms=platforms, fmi=fmi) for model, name in IDENTIFIERS.items()]
