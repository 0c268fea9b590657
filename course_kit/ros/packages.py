"""Packages by name, as the ament index of AMENT_PREFIX_PATH has them: where they are, what can be run of them."""

from __future__ import annotations

import os
from pathlib import Path

from ament_index_python import PackageNotFoundError, get_package_prefix, get_packages_with_prefixes, get_search_paths


def package_names() -> list[str]:
    """The names of all packages, sorted."""
    return sorted(get_packages_with_prefixes())


def package_prefix(name: str) -> str:
    """The prefix that a package is installed to. PackageNotFoundError if no prefix has it."""
    try:
        return get_package_prefix(name)
    except ValueError:  # what cannot be the name of a package
        raise PackageNotFoundError(f"package '{name}' not found, searching: {get_search_paths()}") from None


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
