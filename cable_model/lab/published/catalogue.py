"""All studies by the names that the command line takes, and how they are run and written."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from types import ModuleType

from cable_model.errors import unknown
from cable_model.lab.published import forced_chain, free_release, penetration, spectral_radius, sphere, tolerance
from cable_model.lab.published.page import write

STUDIES: Mapping[str, ModuleType] = {  # each has NAME of its files, measure(quick, told) -> data, page(data)
    "radii": spectral_radius,
    "free": free_release,
    "forced": forced_chain,
    "sphere": sphere,
    "straight": penetration,
    "tolerance": tolerance,
}


def write_all(
    folder: Path, names: Sequence[str] = (), quick: bool = False, progress: Callable[[str, float], None] | None = None
) -> list[Path]:
    """Run the named studies (default: all) and write their files; `progress` is told what runs and the share of studies done."""
    for name in names:
        if name not in STUDIES:
            raise unknown(name, STUDIES, "study")
    chosen = list(names or STUDIES)
    written = []
    for k, name in enumerate(chosen):
        study, share = STUDIES[name], k / len(chosen)
        told = (lambda text, name=name, share=share: progress(f"{name}: {text}", share)) if progress is not None else None
        write(folder, study.page(study.measure(quick, told)), [each.NAME for each in STUDIES.values()])
        written.append(folder / f"{study.NAME}.png")
    return written
