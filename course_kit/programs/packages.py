"""Packages by name, as the ament index of AMENT_PREFIX_PATH has them: where they are, what can be run of them."""

from __future__ import annotations

import os
from pathlib import Path

INDEX = Path("share/ament_index/resource_index/packages")


class PackageNotFoundError(KeyError):
    """No prefix has the package; prints as the one of ament_index_python does, in quotes."""

    def __init__(self, name: str) -> None:
        super().__init__(f"package '{name}' not found, searching: {[str(p) for p in prefixes()]}")


def prefixes() -> list[Path]:
    """The folders of AMENT_PREFIX_PATH that exist; of two with the same package the first one counts."""
    entries = os.environ.get("AMENT_PREFIX_PATH", "").split(os.pathsep)
    return [Path(entry) for entry in entries if entry and os.path.isdir(entry)]


def package_names() -> list[str]:
    """The names of all packages, sorted."""
    names: set[str] = set()
    for prefix in prefixes():
        index = prefix / INDEX
        if index.is_dir():
            names.update(p.name for p in index.iterdir() if not p.name.startswith(".") and not p.is_dir())
    return sorted(names)


def package_prefix(name: str) -> str:
    """The prefix that a package is installed to. PackageNotFoundError if no prefix has it."""
    if name and name == os.path.basename(name):
        for prefix in prefixes():
            if (prefix / INDEX / name).is_file():
                return str(prefix)
    raise PackageNotFoundError(name)


def share_directory(name: str) -> str:
    """The folder share/<package> of a package. PackageNotFoundError if there is no such package."""
    return os.path.join(package_prefix(name), "share", name)


def executables(name: str) -> list[Path]:
    """What `ros2 run` can start of a package: executable files below lib/<package>. PackageNotFoundError as above."""
    found: list[Path] = []
    for folder, subfolders, files in os.walk(os.path.join(package_prefix(name), "lib", name)):
        subfolders[:] = sorted(f for f in subfolders if not f.startswith("."))
        paths = (os.path.join(folder, file) for file in sorted(files))
        found += [Path(path) for path in paths if os.access(path, os.X_OK)]
    return found
