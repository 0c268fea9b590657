"""A chapter's notebook in a real kernel, with answers put into its exercises one after another."""

from __future__ import annotations

import importlib
import os
import re
import shutil
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path

import pytest

from course_kit.base.file_locks import locked
from course_kit.classroom.rebuild import START
from course_kit.exercises.catalogue import CHAPTERS
from course_kit.exercises.notebooks import reference
from course_kit.exercises.notebooks.reference import mark_of, prerequisites
from course_kit.exercises.solutions.worked import Worked, find
from course_kit.setup.colcon import chapter_packages
from course_kit.setup.colcon.workspaces import Workspace
from tests import leftovers
from tests.domains import reserved_domain
from tests.kernel import Kernel

FOLDER = Path(__file__).parents[2] / "notebooks"
# {"setup": "01_setup_checks", …}
NOTEBOOKS = dict(zip(CHAPTERS, sorted(path.stem for path in FOLDER.glob("[0-9][0-9]_*.ipynb")), strict=True))
PROVIDED = {"actions": "my_interfaces"}  # what the prerequisites of a chapter build unless it is there
LINE_END = "\n"
MAGIC = re.compile(r"%%(\w+) ?(.*)\n((?:.|\n)*)")
CELL_TIMEOUT = 240.0  # some build a package
CHECK_TIMEOUT = 300.0


def group_of(exercise: str, part: int = 1) -> str:
    """The tests that run one after another, in one kernel: a part of the answers to an exercise."""
    return f"exercise {exercise}" + (f", part {part}" if part > 1 else "")


@dataclass(frozen=True)
class Wrong:
    """An answer that a student would give, the points it must get and words of the hint that it must get."""

    name: str
    source: str
    points: int
    hint: str


@dataclass(frozen=True)
class Answers:
    """The answers to one exercise: the reference, wrong ones, and further right ones in other styles, by name."""

    exercise: str
    points: int
    reference: str
    wrong: list[Wrong] = field(default_factory=list)
    right: dict[str, str] = field(default_factory=dict)
    together: int = 30  # in one kernel, one after another: as many as take three minutes

    def group(self, number: int) -> str:
        """The group of the answer of this number, counting the wrong ones and then the right ones."""
        return group_of(self.exercise, 1 + number // self.together)


def solved(exercise: str) -> Worked:
    """The worked solution of an exercise, which is its reference."""
    found = find(exercise)
    assert found is not None, exercise
    return found


def worked(exercise: str) -> str:
    """The cells of the worked solution as one cell, which does the same."""
    return "\n" + "\n".join(map(_without_magic, solved(exercise).cells)) + "\n"


def _without_magic(cell: str) -> str:
    found = MAGIC.fullmatch(cell)
    return f"get_ipython().run_cell_magic({found[1]!r}, {found[2]!r}, {found[3] + LINE_END!r})" if found else cell


def changed(source: str, *changes: tuple[str, str]) -> str:
    """The source with parts of it replaced; each part must be there."""
    for old, new in changes:
        assert old in source, old
        source = source.replace(old, new)
    return source


# A check runs an answer with threads if a node of its class has them in the notebook: no earlier answer's may stay.
KEEP_NODES = """
from course_kit import stop as _stop
from course_kit.ros.spinning.executors import spinning_now as _spinning_now
from rclpy.executors import MultiThreadedExecutor as _Threads
_kept = _spinning_now()
"""
END_THREADS = """
for _each in [each for each in _spinning_now() if isinstance(each.executor, _Threads) and each not in _kept]:
    _stop(_each.node)
"""


class Chapter:
    """A chapter's notebook, run up to its exercises.

    `untouched` is what the check of an exercise showed of the answer cell as it is committed, by exercise.
    """

    def __init__(self, kernel: Kernel, path: Path) -> None:
        self.kernel = kernel
        self.untouched: dict[str, str] = {}
        self.reference = reference.Chapter(path.name, path.read_text())
        self.cells = {cell.id: cell for cell in self.reference.notebook.cells}
        self._by_role = {
            (mark["role"], mark["exercise"]): cell
            for cell in self.cells.values()
            if "exercise" in (mark := mark_of(cell))
        }

    def run_prerequisites(self) -> None:
        """Run what the exercises stand on, and nothing else: it is all that a grader runs."""
        for source in [*(cell.source for cell in prerequisites(self.reference)), START]:
            self.kernel.run(source, CELL_TIMEOUT)

    def source(self, role: str, exercise: str) -> str:
        return str(self._by_role[role, exercise].source)

    def committed(self, exercise: str) -> str:
        """The output of the check cell as it is committed."""
        outputs = self._by_role["check", exercise].outputs
        return "\n".join(output["data"]["text/plain"] for output in outputs)

    def answer(self, exercise: str, source: str) -> str:
        """Put an answer into the answer cell, run it and the check cell; return what the check showed."""
        self.kernel.run(END_THREADS, CELL_TIMEOUT)
        self.kernel.finish(self.kernel.send(source), CELL_TIMEOUT)  # it may raise, as a student's does
        return self.check(exercise)

    def begin(self, exercise: str) -> None:
        """Check the exercise untouched: the checks see what they look at from the first one on."""
        self.untouched[exercise] = self.answer(exercise, self.source("answer", exercise))

    def check(self, exercise: str) -> str:
        """Run the check cell; return what it showed."""
        cell = self.kernel.run(self.source("check", exercise), CHECK_TIMEOUT)
        displayed = [m["content"]["data"] for m in self.kernel.of(cell) if m["msg_type"] == "display_data"]
        assert len(displayed) == 1, self.kernel.text(cell)
        return str(displayed[0]["text/plain"]).strip()


def answers_to(name: str) -> list[Answers]:
    """Return the answers to a chapter's exercises, in order: the ANSWERS of the modules in the chapter's folder."""
    modules = sorted(path.stem for path in Path(__file__).with_name(name).glob(f"{name}_[0-9]*.py"))
    return [importlib.import_module(f"tests.exercises.{name}.{module}").ANSWERS for module in modules]


def preparation(name: str) -> str:
    """Return the code that a chapter's answers are made with, where they need something besides."""
    return getattr(importlib.import_module(f"tests.exercises.{name}"), "PREPARE", "")


def _workspace_with(package: str) -> Path:
    """A workspace in which a package of an earlier chapter is built, once for all tests of a run."""
    made = Path(os.environ[leftovers.MARK], f"with_{package}")
    with locked(made.with_suffix(".lock"), CELL_TIMEOUT):
        if not made.is_dir():
            with tempfile.TemporaryDirectory() as folder:
                workspace = Workspace(Path(folder, "ros2_ws"))
                shutil.copytree(chapter_packages.FOLDER / package, workspace.src / package)
                workspace.build("--packages-select", package)
                workspace.folder.rename(made)
    return made


@contextmanager
def chapter(name: str) -> Iterator[Chapter]:
    """The kernel of a chapter, such as "topics", run up to the exercises; its folder, state and domain are its own."""
    path = FOLDER / f"{NOTEBOOKS[name]}.ipynb"
    with reserved_domain() as domain, tempfile.TemporaryDirectory() as state, tempfile.TemporaryDirectory() as folder:
        with pytest.MonkeyPatch.context() as patch:
            patch.setenv("ROS_DOMAIN_ID", str(domain))
            patch.setenv("XDG_STATE_HOME", state)
            kernel = Kernel(Path(folder))
        try:
            if name in PROVIDED:  # CMake builds only where it has built before: what is built is copied without that
                built = shutil.ignore_patterns("build", "log")
                shutil.copytree(_workspace_with(PROVIDED[name]), Path(folder, "ros2_ws"), ignore=built)
            made = Chapter(kernel, path)
            made.run_prerequisites()
            kernel.run(preparation(name) + KEEP_NODES, CELL_TIMEOUT)
            yield made
        finally:
            kernel.close()


def judge(shown: str, points: int, max_points: int, hint: str) -> None:
    """What a check showed has these points, and the hint if there is one."""
    word = "point" if max_points == 1 else "points"
    heading = shown.splitlines()[0]
    assert heading.endswith(f": {points} of {max_points} {word}"), shown
    if hint:
        assert "✘" in shown, shown
        assert hint in shown, shown
    else:
        assert "✘" not in shown, shown
