"""Copying the modules that an FMU needs under names of their own, so that FMUs of several versions live in one process.

Kernels and the rest get two packages, each named by a hash of its content: kernels that did not change stay compiled.
"""

from __future__ import annotations

import ast
import hashlib
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path

KERNELS = "cable_model.kernels"
ROOTS = ("cable_model", "fmu_src")


@dataclass(frozen=True)
class Vendored:
    """Files by their path in the FMU's resources; `package` and `kernels` are the names to import."""

    package: str
    kernels: str
    files: Mapping[str, bytes]


def _file(root: Path, module: str) -> Path | None:
    path = root.joinpath(*module.split("."))
    for candidate in (path.with_suffix(".py"), path / "__init__.py"):
        if candidate.is_file():
            return candidate
    return None


def _ours(module: str | None) -> bool:
    return module is not None and module.split(".")[0] in ROOTS


def imported(source: str, name: str) -> set[str]:
    """Every module of ours that a source imports, or may import by `from package import name`."""
    found = set()
    for node in ast.walk(ast.parse(source, name)):
        if isinstance(node, ast.Import):
            found |= {alias.name for alias in node.names if _ours(alias.name)}
        elif isinstance(node, ast.ImportFrom):
            if node.level:
                raise ValueError(f"{name}, line {node.lineno}: a relative import. Write it in full.")
            if _ours(node.module):
                found |= {str(node.module)} | {f"{node.module}.{alias.name}" for alias in node.names}
    return found


def closure(root: Path, modules: Iterable[str]) -> dict[str, Path]:
    """The modules, all of ours that they import, and the packages that hold them, with their files."""
    wanted, found = list(modules), {}
    while wanted:
        module = wanted.pop()
        path = _file(root, module)
        if module in found or path is None:
            continue
        found[module] = path
        wanted += imported(path.read_text(encoding="utf-8"), str(path))
        if "." in module:
            wanted.append(module.rpartition(".")[0])
    return found


def renamed(source: str, name: str, names: Mapping[str, str]) -> str:
    """A source whose imports of `names`, and of what lies below them, go to their new names; lines keep their numbers."""

    def new(module: str) -> str:
        for old in sorted(names, key=len, reverse=True):
            if module == old or module.startswith(old + "."):
                return names[old] + module[len(old) :]
        return module

    lines = source.splitlines(keepends=True)
    edits: list[tuple[int, str, str]] = []
    for node in ast.walk(ast.parse(source, name)):
        if isinstance(node, ast.ImportFrom) and _ours(node.module):
            module = str(node.module)
            targets = {new(f"{module}.{alias.name}").rpartition(".")[0] for alias in node.names if f"{module}.{alias.name}" in names}
            if targets - {new(module)}:
                raise ValueError(f"{name}, line {node.lineno}: imports a renamed package from its parent. Import from the package itself.")
            edits.append((node.lineno, f"from {module} import", f"from {new(module)} import"))
        elif isinstance(node, ast.Import):
            for alias in node.names:
                if _ours(alias.name):
                    raise ValueError(f"{name}, line {node.lineno}: 'import {alias.name}'. Write 'from ... import ...'.")
        elif isinstance(node, ast.Constant) and isinstance(node.value, str) and node.value in names:
            edits.append((node.lineno, f'"{node.value}"', f'"{new(node.value)}"'))
    for line, old, fresh in edits:
        if lines[line - 1].count(old) != 1:
            raise ValueError(f"{name}, line {line}: {old!r} not found once. Write the import on one line, in full.")
        lines[line - 1] = lines[line - 1].replace(old, fresh)
    return "".join(lines)


def _digest(sources: Mapping[str, str]) -> str:
    digest = hashlib.sha256()
    for name, source in sorted(sources.items()):
        digest.update(name.encode() + b"\0" + source.encode() + b"\0")
    return digest.hexdigest()[:12]


def vendor(root: Path, modules: Iterable[str]) -> Vendored:
    """The modules and what they import, from the folder that holds `cable_model` and `fmu_src`."""
    sources = {module: path.read_text(encoding="utf-8") for module, path in closure(root, modules).items()}
    packages = {module for module in sources if _file(root, module) == root.joinpath(*module.split("."), "__init__.py")}
    kernels = f"cable_kernels_{_digest({m: s for m, s in sources.items() if m.startswith(KERNELS)})}"
    package = f"cable_fmu_{_digest(sources)}"
    names = {KERNELS: kernels, **{name: f"{package}.{name}" for name in ROOTS}}
    files = {f"{package}/__init__.py": b""}
    for module, source in sources.items():
        home = kernels + module[len(KERNELS) :] if module.startswith(KERNELS) else f"{package}.{module}"
        path = home.replace(".", "/") + ("/__init__.py" if module in packages else ".py")
        files[path] = renamed(source, str(module), names).encode()
    return Vendored(package, kernels, dict(sorted(files.items())))
