"""How long ./environment-check.sh takes: the first set-up, one with a warm cache, going up, a later start."""

from __future__ import annotations

import os
import shutil
import tempfile
import time
from collections.abc import Iterator
from pathlib import Path

from course_kit.setup.environment.levels import GRADING, TEST
from tests.benchmark.table import Row
from tests.course_copy import BASE_PYTHON, CourseCopy, fresh_environ

TIMEOUT = 1800.0
NOTE = (
    "setup: `./environment-check.sh lab --version` in a copy of the course. First: empty caches, all is downloaded and "
    "compiled. Warm: a new copy, the same caches. Again: the same copy. Check: without an argument. Adding: "
    "what graders and the tests need besides, to that copy, with the same caches."
)


def rows(quick: bool) -> Iterator[Row]:
    """All rows of this section; `quick` leaves out the set-up without a cache."""
    os.environ.setdefault("ROS_DOMAIN_ID", "1")
    with tempfile.TemporaryDirectory(prefix="course-kit-benchmark-") as name:
        folder = Path(name)
        caches = {"UV_CACHE_DIR": str(folder / "uv"), "PIP_CACHE_DIR": str(folder / "pip")}
        environ = fresh_environ(PYTHON=BASE_PYTHON) | ({} if quick else caches)
        if not quick:
            yield Row("set-up, first", "s", None, _seconds(CourseCopy(folder / "first"), environ, "lab", "--version"))
            shutil.rmtree(folder / "first")
        course = CourseCopy(folder / "second")
        yield Row("set-up, warm cache", "s", None, _seconds(course, environ, "lab", "--version"))
        yield Row("start, again", "s", None, _seconds(course, environ, "lab", "--version"))
        yield Row("check", "s", None, _seconds(course, environ))
        yield Row("set-up, a student's .venv", "MB", None, _megabytes(course))
        for level in (GRADING, TEST):
            yield Row(f"set-up, adding for {level}", "s", None, _seconds(course, environ, "--add", level))
            yield Row(f"set-up, .venv for {level}", "MB", None, _megabytes(course))


def _seconds(course: CourseCopy, environ: dict[str, str], *arguments: str) -> float:
    began = time.monotonic()
    done = course.run(*arguments, environ=environ, timeout=TIMEOUT)
    if done.returncode:
        said = done.stdout[-2000:] + done.stderr[-2000:]
        raise RuntimeError(f"environment-check.sh {' '.join(arguments)} failed:\n{said}")
    return time.monotonic() - began


def _megabytes(course: CourseCopy) -> float:
    """What .venv takes on the disk."""
    return sum(path.lstat().st_blocks for path in (course.root / ".venv").rglob("*")) * 512 / 1e6
