"""Lets this Python import what a workspace has built, interface packages with their libraries included."""

from __future__ import annotations

import ctypes
import importlib
import re
import sys
from collections.abc import Iterable, Sequence
from importlib.abc import MetaPathFinder
from pathlib import Path
from types import ModuleType

# Not those for C++, which Python does not use: with the compiler that is a wheel they lack what g++ names otherwise.
_LIBRARY = re.compile(r"lib(\w+?)__rosidl_\w+(?<!_cpp)\.so")
_libraries: dict[str, list[Path]] = {}  # interface package -> its libraries
_loaded: dict[Path, tuple[int, int]] = {}  # library -> its version when it was loaded


class _Loading(MetaPathFinder):
    """Finds nothing itself: loads the libraries of an interface package when that is about to be imported.

    Linux reads LD_LIBRARY_PATH only when a process starts, but takes a library that is loaded already.
    """

    def find_spec(self, name: str, path: Sequence[str] | None = None, target: ModuleType | None = None) -> None:
        if path is None and name in _libraries:
            try:
                _load(_libraries[name])
            except OSError:  # it needs those of other packages
                _load(library for libraries in _libraries.values() for library in libraries)


_finder = _Loading()


def make_importable(folder: Path, python_paths: Sequence[str]) -> list[str]:
    """Make importable what a workspace has built: `python_paths` are what sourcing it adds to PYTHONPATH.

    Python packages are imported afresh from now on. Returns the interface packages for which that cannot be: their
    libraries were loaded before and have been built again since, so only a new process sees the new ones.
    """
    sys.path[:] = [*python_paths, *(e for e in sys.path if not Path(e).is_relative_to(folder))]
    for package in [p for p, libraries in _libraries.items() if libraries[0].is_relative_to(folder)]:
        del _libraries[package]
    for library in sorted(folder.glob("install/**/lib/lib*.so")):
        if found := _LIBRARY.fullmatch(library.name):
            _libraries.setdefault(found[1], []).append(library)
    if _finder not in sys.meta_path:
        sys.meta_path.insert(0, _finder)
    _forget_modules(folder)
    importlib.invalidate_caches()
    return sorted(
        p for p, libraries in _libraries.items() if any(_loaded.get(x, _version(x)) != _version(x) for x in libraries)
    )


def _forget_modules(folder: Path) -> None:
    """Have Python packages of the workspace read again; those with loaded libraries cannot be."""
    fixed = {found[1] for library in _loaded if (found := _LIBRARY.fullmatch(library.name))}
    for name, module in list(sys.modules.items()):
        file = getattr(module, "__file__", None)
        if file and Path(file).is_relative_to(folder) and name.partition(".")[0] not in fixed:
            del sys.modules[name]


def _load(libraries: Iterable[Path]) -> None:
    """Load libraries that need each other, in whichever order works. OSError if one needs what is not there."""
    pending = [library for library in libraries if library not in _loaded]
    while pending:
        failed: dict[Path, OSError] = {}
        for library in pending:
            try:
                ctypes.CDLL(str(library))
                _loaded[library] = _version(library)
            except OSError as error:
                failed[library] = error
        if len(failed) == len(pending):
            raise failed[pending[-1]]
        pending = list(failed)


def _version(library: Path) -> tuple[int, int]:
    status = library.stat()
    return status.st_ino, status.st_mtime_ns
