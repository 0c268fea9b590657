"""The environment of a sourced colcon workspace, read as data: no script of the workspace is run.

colcon and ament write each entry into a .dsv file beside the shell script that does the same. Only what lies in the
workspace is taken, and it comes behind what is there already: it takes the place of nothing.
"""

from __future__ import annotations

import os
from collections.abc import Iterator, Mapping
from pathlib import Path

from course_kit.setup.colcon import regular_files
from course_kit.setup.environment.activation import PATH_VARIABLES, split_paths

PACKAGES = "share/colcon-core/packages"  # where colcon notes what it has installed
MAX_FILES = 100  # .dsv files of one package
LISTS = ("prepend-non-duplicate", "prepend-non-duplicate-if-exists", "append-non-duplicate")


def prefix_of(workspace: Path, package: str) -> Path:
    """Where a package is installed, or would be: in a folder of its own, unless all were merged into one."""
    own = workspace / "install" / package
    return own if own.is_dir() else workspace / "install"


def packages(workspace: Path) -> dict[str, Path]:
    """The prefix of each package that colcon has installed, by its name."""
    install = workspace / "install"
    merged = {path.name: install for path in regular_files.entries(install / PACKAGES)}
    apart = {path.name: path for path in regular_files.entries(install) if (path / PACKAGES / path.name).is_file()}
    return merged | apart


def added(workspace: Path, *only: str) -> dict[str, list[str]]:
    """What sourcing adds to each variable, as a terminal has it; of some packages, or of all."""
    found: dict[str, list[str]] = {}
    for package, prefix in packages(workspace).items():
        if not only or package in only:
            for kind, variable, value in _hooks(prefix, f"share/{package}/package.dsv", set()):
                entries = found.setdefault(variable, [])
                if value not in entries and _is_below(value, workspace):
                    entries.insert(len(entries) if kind.startswith("append") else 0, value)
    return {variable: entries for variable, entries in found.items() if entries}


def over(environ: Mapping[str, str], workspace: Path) -> dict[str, str]:
    """An environment with what the workspace adds to it."""
    result = dict(environ)
    for variable, entries in added(workspace).items():
        result[variable] = os.pathsep.join([*split_paths(environ.get(variable, "")), *entries])
    return result


def _hooks(prefix: Path, file: str, seen: set[Path]) -> Iterator[tuple[str, str, str]]:
    """The lines of a .dsv file, and of those that it names: what is done, with which variable, by which entry."""
    path = Path(f"{os.path.splitext(prefix / file)[0]}.dsv")
    if path in seen or len(seen) > MAX_FILES:
        return
    seen.add(path)
    sources = []
    for line in (regular_files.text_of(path) or "").splitlines():
        kind, _, rest = line.strip().partition(";")
        if kind == "source":
            sources.append(rest)
        variable, *values = rest.split(";")
        if kind in LISTS and variable in PATH_VARIABLES:
            for value in values:
                entry = str(prefix / value)
                if not kind.endswith("if-exists") or os.path.exists(entry):
                    yield kind, variable, entry
    for source in sources:
        yield from _hooks(prefix, source, seen)


def _is_below(entry: str, workspace: Path) -> bool:
    path = Path(os.path.normpath(entry))
    return os.pathsep not in entry and any(path.is_relative_to(one) for one in (workspace, workspace.resolve()))
