"""Tells if the installed files of a package are those that its source makes now. Everything is read as data."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

from course_kit.setup.colcon import overlay, regular_files

METADATA = (".egg-info", ".dist-info")  # endings of the folders in which setuptools describes what it has installed
UNREAD = ("package.xml", "setup.py", "setup.cfg", "pyproject.toml")  # files that no program of the package reads


def module_paths(workspace: Path, *package: str) -> list[Path]:
    """Where Python looks for the modules of the workspace, or of a package of it, in this order."""
    return [Path(entry) for entry in overlay.added(workspace, *package).get("PYTHONPATH", [])]


def metadata(paths: list[Path]) -> list[Path]:
    """The folders there in which setuptools has described what it installed."""
    return [path for folder in paths for path in regular_files.entries(folder) if path.name.endswith(METADATA)]


def is_made_by_hand(workspace: Path, package: str) -> bool:
    """Return True if an installed Python package lacks what every build of one leaves."""
    return not metadata(module_paths(workspace, package))


def changed(workspace: Path, package: str) -> list[Path]:
    """The files of a package's source whose installed copy says something else."""
    source, share = workspace / "src" / package, overlay.prefix_of(workspace, package) / "share" / package
    paths = module_paths(workspace)
    tops = {package, *_top_level(module_paths(workspace, package))}
    files = sorted(regular_files.below(source), key=lambda path: len(path.parts))
    seen: set[Path] = set()  # of two files with one copy, that nearer to the top is its origin
    found = []
    for file in files:
        place = file.relative_to(source)
        copies = [share / place] if place.name not in UNREAD else []
        for module in _modules(place, tops):
            copies += [copy for copy in (path / module for path in paths) if copy.is_file()][:1]
        copies = [copy for copy in copies if copy.is_file() and copy not in seen]
        seen.update(copies)
        if not all(regular_files.are_same(file, copy) for copy in copies):
            found.append(file)
    return sorted(found)


def _top_level(paths: list[Path]) -> set[str]:
    """The names of the top-level modules that setuptools says it has installed."""
    texts = [regular_files.text_of(path / "top_level.txt") or "" for path in metadata(paths)]
    return {line.strip() for text in texts for line in text.splitlines() if line.strip()}


def _modules(place: Path, tops: set[str]) -> Iterator[Path]:
    """What a file of the source may be called as one of an installed Python package, or as a module."""
    for number, part in enumerate(place.parts):
        if part in tops or (part == place.name and place.suffix == ".py" and place.stem in tops):
            yield Path(*place.parts[number:])


def comes_from_source(workspace: Path, package: str, installed: Path) -> bool:
    """Return True if a file of this name in the package's source says the same as an installed one."""
    source = workspace / "src" / package
    named = [path for path in regular_files.below(source) if path.name == installed.name]
    return any(regular_files.are_same(path, installed) for path in named)
