"""The students' edition of the course: a zip, the same to the byte wherever and whenever it is made. Pure: no ROS."""

from __future__ import annotations

import io
import json
import logging
import os
import re
import stat
import subprocess
import zipfile
from collections.abc import Iterator, Mapping
from hashlib import sha256
from pathlib import Path
from typing import Any

import nbformat

from course_kit.base.atomic_files import NotWritten, write_whole, writing
from course_kit.exercises.catalogue import CHAPTERS
from course_kit.exercises.notebooks.reference import ANSWER, CHECK, EXERCISE, is_untouched, mark_of, stripped

CLONE = Path(__file__).parents[2]
TOP, MANIFEST, FORMAT = "ros2-notebook-course", "manifest.json", 1
# Answers to every exercise, and what only those need who change the course. Students keep `course grade .`.
DOCS = tuple(f"docs/{page}.md" for page in ("exercises", "instructors", "middleware", "tests", "views"))
LEFT_OUT = (".ci/", "CONTRIBUTING.md", *DOCS, "tests/")
SOLUTIONS = tuple(
    f"course_kit/exercises/{chapter}/solutions/" for chapter in CHAPTERS
)  # what `solution()` shows; an edition may be made without
COPIES = "course_kit/exercises/notebooks/edition"  # of the marked cells, for catch_up() and `course grade .`
MODES = {"100644": 0o644, "100755": 0o755}  # as git keeps them: those of the disk depend on umask and file system
NOTEBOOK = re.compile(r"notebooks/\d\d_\w+\.ipynb")
KEPT_EMPTY = "kept-empty"  # the tag of cells about the reader's own machine and points
PROJECT = re.compile(rf'^name = "{TOP}"\nversion = "(.+)"$', re.MULTILINE)
# Parts of the README, and what students read in their place.
MARKED = re.compile(r"<!-- not in the students' edition -->\n.*?<!-- (?:end |instead\n(.*?))-->\n", re.DOTALL)
ON_SOLUTIONS = re.compile(r"<!-- with solutions -->\n(.*?)<!-- end of solutions -->\n", re.DOTALL)

_log = logging.getLogger(__name__)
_Files = dict[str, tuple[int, bytes]]  # by path below the top folder: mode and content


class Refused(ValueError):  # noqa: N818  (reads as what happened)
    """There is no students' edition; the message says why."""


def write(zip_path: Path, root: Path = CLONE, with_solutions: bool = True) -> Path:
    """Write the students' edition of the clone in `root`, uncommitted changes included, and log those. Raises Refused.

    Later calls with the same files give the same bytes. An earlier zip of that name is replaced as a whole.
    """
    root = root.resolve()
    if (root / MANIFEST).exists():
        raise Refused(f"{root} is a students' edition itself, and one is made from a clone of the course only")
    if not (root / ".git").exists():
        raise Refused(f"{root} is not a clone of the course")
    left_out = LEFT_OUT if with_solutions else (*LEFT_OUT, *SOLUTIONS)
    files = _tracked(root, left_out)
    project = PROJECT.search(files["pyproject.toml"][1].decode()) if "pyproject.toml" in files else None
    if project is None:
        raise Refused(f"{root} is not a clone of the course")
    mode, readme = files["README.md"]
    text = ON_SOLUTIONS.sub(lambda part: part[1] if with_solutions else "", readme.decode())
    files["README.md"] = mode, MARKED.sub(lambda part: part[1] or "", text).encode()
    for path in list(filter(NOTEBOOK.fullmatch, files)):
        marked = stripped(nbformat.reads(files[path][1].decode(), as_version=4))
        files[f"{COPIES}/{Path(path).name}"] = MODES["100644"], marked.encode()
    manifest = {
        "format": FORMAT,
        "course": project[1],
        "files": {path: sha256(content).hexdigest() for path, (_, content) in files.items()},
        "exercises": _exercises(files),
        "solutions": with_solutions,
    }
    files[MANIFEST] = MODES["100644"], (json.dumps(manifest, indent=1, sort_keys=True) + "\n").encode()
    _tell_uncommitted(root, left_out)
    try:
        with writing(zip_path):
            zip_path.parent.stat()  # a folder that is not there is a mistake, and not made
        write_whole(zip_path, _zipped(files))
    except NotWritten as error:
        raise Refused(str(error)) from None
    return zip_path


def _git(root: Path, *words: str) -> str:
    """What git prints about the clone."""
    # A hook that runs this has them name another one.
    environ = {k: v for k, v in os.environ.items() if k not in ("GIT_DIR", "GIT_WORK_TREE", "GIT_INDEX_FILE")}
    try:
        # Only reads: a git that others run in the clone finds no lock.
        done = subprocess.run(["git", "--no-optional-locks", *words], cwd=root, env=environ, capture_output=True)
    except FileNotFoundError:
        raise Refused("git is not installed, and it knows which files are the course's") from None
    if done.returncode:
        raise Refused(f"git {' '.join(words)}: {done.stderr.decode(errors='replace').strip()}")
    return done.stdout.decode()


def _listed(root: Path, *words: str) -> list[str]:
    """The paths, or lines about them, that git lists with -z."""
    return _git(root, *words, "-z").split("\0")[:-1]


def _tracked(root: Path, left_out: tuple[str, ...]) -> _Files:
    """What git tracks and students get, as it is on the disk."""
    modes = {path: about.split()[0] for about, path in (e.split("\t", 1) for e in _listed(root, "ls-files", "--stage"))}
    files: _Files = {}
    for path in modes:
        if path.startswith(left_out) or not os.path.lexists(root / path):
            continue
        # A link becomes a copy of its file: many programs that unpack a zip make no links.
        target = os.path.relpath((root / path).resolve(), root)
        mode = MODES.get(modes.get(target, ""))
        if mode is None or target.startswith(left_out):
            raise Refused(f"{path} is no file of the students' edition, nor a link to one")
        content = (root / path).read_bytes()
        files[path] = mode, _without_own_machine(content) if path.endswith(".ipynb") else content
    return files


def _without_own_machine(notebook: bytes) -> bytes:
    """A notebook without what the machine of whoever makes the release has shown in it."""
    whole = nbformat.reads(notebook.decode(), as_version=4)
    kept_empty = [cell for cell in whole.cells if KEPT_EMPTY in cell.metadata.get("tags", [])]
    if not any(cell.outputs or cell.execution_count for cell in kept_empty):
        return notebook
    for cell in kept_empty:
        cell.outputs, cell.execution_count = [], None
    return (nbformat.writes(whole) + "\n").encode()


def _exercises(files: Mapping[str, tuple[int, bytes]]) -> dict[str, dict[str, Any]]:
    """By name, each exercise's notebook, points, cells and check. Refused where an answer may be a solution."""
    found: dict[str, dict[str, Any]] = {}
    for path in filter(NOTEBOOK.fullmatch, files):
        for mark, cell in _cells(files[path][1].decode()):
            name, role = mark["exercise"], mark["role"]
            if role == ANSWER and not is_untouched(cell.source):
                raise Refused(f"the answer cell of {name} in {path} is not untouched: it may hold a solution")
            about = found.setdefault(name, {"notebook": path, "points": mark["points"], "cells": {}})
            about["cells"][role] = cell.id
            if role == CHECK:
                about["check_sha256"] = sha256(cell.source.encode()).hexdigest()
    return found


def _cells(notebook: str) -> Iterator[tuple[dict[str, Any], nbformat.NotebookNode]]:
    """The cells that belong to exercises, each with its mark."""
    for cell in nbformat.reads(notebook, as_version=4).cells:
        if (mark := mark_of(cell)).get("role") in (EXERCISE, ANSWER, CHECK):
            yield mark, cell


def _tell_uncommitted(root: Path, left_out: tuple[str, ...]) -> None:
    lines = _listed(root, "status", "--porcelain", "--no-renames", "--untracked-files=normal")  # such as " M README.md"
    for is_untracked, what in (
        (False, "released with changes that are not committed"),
        (True, "not released, as git does not track it"),
    ):
        paths = [line[3:] for line in lines if line.startswith("??") is is_untracked]
        if paths := [path for path in paths if not path.startswith(left_out)]:
            _log.warning("%s: %s", what, ", ".join(paths))


def _zipped(files: Mapping[str, tuple[int, bytes]]) -> bytes:
    whole = io.BytesIO()
    # Stored: what deflate makes of the same bytes differs from one zlib to another, and 6 MB are not worth it.
    with zipfile.ZipFile(whole, "w", zipfile.ZIP_STORED) as archive:
        for path, (mode, content) in sorted(files.items()):
            entry = zipfile.ZipInfo(f"{TOP}/{path}")  # its time is 1980-01-01
            entry.create_system = 3  # Unix, where the modes count
            entry.external_attr = (stat.S_IFREG | mode) << 16
            archive.writestr(entry, content)
    return whole.getvalue()
