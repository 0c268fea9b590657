"""`course release` and `course grade`: from the students' edition over what was handed in to the gradebook."""

from __future__ import annotations

import argparse
import contextlib
import os
import shlex
import signal
import sys
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

from course_kit.base.file_locks import LockTimeout, locked
from course_kit.base.shutdown.signals import leave_closed_terminal
from course_kit.classroom import release
from course_kit.classroom.collect import handins
from course_kit.classroom.report import feedback, gradebook
from course_kit.classroom.report import table as tables
from course_kit.classroom.results import StudentResult
from course_kit.classroom.run import class_run, notebook_run, sandbox, submission
from course_kit.classroom.run.class_run import ClassRun
from course_kit.classroom.run.notebook_run import Settings, Stopped
from course_kit.exercises.checker.own_types import Uncompiled
from course_kit.exercises.notebooks import reference
from course_kit.setup.environment import additions
from course_kit.setup.environment.levels import GRADING

FULL, NOT_FULL, WRONG, STOPPED = 0, 1, 2, 130  # exit statuses
EXAMPLE = """
  course grade .                              your own work, as a grader sees it; status 0 with all points, else 1
  course grade handed-in.zip --out grades     a class, as the learning system exports it
  course grade handed-in --out grades --chapter topics --jobs 4
"""


def add_verbs(verbs: Any) -> None:
    """Add the two verbs to the command `course`."""
    released = verbs.add_parser("release", help="for instructors: the students' edition of the course as a zip")
    released.add_argument("zip", type=Path, metavar="OUT.zip")
    released.add_argument(
        "--without-solutions",
        action="store_true",
        help="leave out the worked solutions, which solution() shows after full points or three tries",
    )
    released.set_defaults(run=_release)
    grade = verbs.add_parser(
        "grade",
        help="grade what was handed in, or your own work",
        epilog=f"examples:{EXAMPLE}",
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    grade.add_argument(
        "submissions", type=Path, metavar="SUBMISSIONS", help="a folder or a zip of hand-ins, or your clone"
    )
    grade.add_argument("--out", type=Path, metavar="GRADES", help="a folder for the gradebook and the feedback")
    grade.add_argument(
        "--jobs", type=_count, default=2 * (os.cpu_count() or 1), metavar="N", help="at once; unless given, %(default)s"
    )
    grade.add_argument(
        "--timeout", type=_seconds, default=Settings.timeout, metavar="S", help="seconds of an answer; %(default)g"
    )
    grade.add_argument("--only", nargs="+", default=[], metavar="EXERCISE", help="such as topics-2")
    grade.add_argument("--chapter", nargs="+", default=[], metavar="CHAPTER", help="such as topics")
    grade.add_argument("--title", default="ROS 2 in notebooks", help="what learning systems call the assignment")
    grade.add_argument("--require-sandbox", action="store_true", help="do not grade where code cannot be kept apart")
    grade.add_argument(
        "--scheduler", metavar="ADDRESS", help="of a Dask cluster that grades, such as tcp://10.0.0.1:8786"
    )
    grade.set_defaults(run=_grade)


def _count(text: str) -> int:
    if not text.isdigit() or int(text) < 1:
        raise argparse.ArgumentTypeError(f"{text} is no number of notebooks: 1 or more")
    return int(text)


def _seconds(text: str) -> float:
    try:
        seconds = float(text)
    except ValueError:
        seconds = 0.0
    if not 1.0 <= seconds <= 86_400.0:
        raise argparse.ArgumentTypeError(f"{text} is no time of a cell: from 1 to 86400 seconds")
    return seconds


def _release(chosen: argparse.Namespace) -> int:
    written = release.write(chosen.zip, with_solutions=not chosen.without_solutions)
    solutions = "without solutions" if chosen.without_solutions else "with solutions"
    size = written.stat().st_size / 1e6
    print(f"{written}: the students' edition, {size:.1f} MB, with manifest.json, {solutions}")
    return FULL


def _grade(chosen: argparse.Namespace) -> int:
    asked = [task.name for task in reference.tasks(chosen.only, chosen.chapter)]
    if not asked:
        raise ValueError("none of these exercises is in one of these chapters")
    is_apart = sandbox.is_available()
    if chosen.require_sandbox and not is_apart:
        raise ValueError(f"nothing was graded, because {sandbox.why_not()}")
    submissions = _read(chosen, asked)
    if not is_apart:
        print(f"course: protection: {sandbox.NOT_APART} ({sandbox.why_not()})", file=sys.stderr)
    additions.add(GRADING, again=shlex.join(sys.argv))
    class_run.prepare(asked)
    with _locked(chosen.out), _workers(chosen) as executor, _ended_by_signals():
        run = ClassRun(Settings(chosen.timeout, is_apart=is_apart), chosen.jobs, chosen.out, executor)
        results = _graded(run, submissions, is_class=chosen.out is not None)
        if chosen.out is None:
            print(tables.verdicts(results[0]))
        else:
            gradebook.write(results, chosen.out, chosen.title)
            feedback.write(results, chosen.out, chosen.title)
            print(
                f"\n{tables.table(results)}\n\nGradebook: {chosen.out}. Feedback: {chosen.out / 'feedback/class.html'}"
            )
    is_full = all(result.points == result.max_points for result in results)
    return FULL if is_full or chosen.out is not None else NOT_FULL


def _read(chosen: argparse.Namespace, asked: Sequence[str]) -> list[submission.Submission]:
    chapters = reference.chapters()
    names = [chapter.file for chapter in chapters]
    found = (
        [handins.find_own(chosen.submissions, names)] if chosen.out is None else handins.find(chosen.submissions, names)
    )
    return [submission.read(one, chapters, asked) for one in found]


def _graded(run: ClassRun, submissions: Sequence[submission.Submission], is_class: bool) -> list[StudentResult]:
    from tqdm import tqdm  # type: ignore[import-untyped]  # it may just have been installed

    with tqdm(total=len(submissions), unit="student", disable=None if is_class else True, dynamic_ncols=True) as bar:

        def report(result: StudentResult) -> None:
            if is_class:
                bar.write(tables.line(result))
            bar.update()

        return run.grade(submissions, report)


@contextlib.contextmanager
def _locked(folder: Path | None) -> Iterator[None]:
    """Let nobody else grade into this folder meanwhile."""
    if folder is None:
        yield
        return
    with contextlib.ExitStack() as stack:
        try:
            stack.enter_context(locked(folder / ".lock", timeout=0))
        except LockTimeout:
            raise ValueError(
                f"another `course grade` writes into {folder} now: wait for it, or name another folder"
            ) from None
        yield


@contextlib.contextmanager
def _workers(chosen: argparse.Namespace) -> Iterator[Any]:
    """The executor of a Dask cluster; None for this machine."""
    if chosen.scheduler is None:
        yield None
        return
    from course_kit.classroom.run import cluster

    with cluster.executor(chosen.scheduler) as executor:
        yield executor


@contextlib.contextmanager
def _ended_by_signals() -> Iterator[None]:
    """Let a closed terminal and SIGTERM end it as Ctrl-C does."""

    def end(*_: Any) -> None:
        leave_closed_terminal()
        raise KeyboardInterrupt

    earlier = {number: signal.signal(number, end) for number in (signal.SIGTERM, signal.SIGHUP)}
    try:
        yield
    finally:
        for number, handler in earlier.items():
            signal.signal(number, handler)


def run(chosen: argparse.Namespace) -> int:
    """Run one of the verbs; return its exit status."""
    try:
        return int(chosen.run(chosen))
    except (ValueError, OSError, Uncompiled) as error:
        if str(error):  # else somebody has said it
            print(f"course: {error}", file=sys.stderr)
        return WRONG
    except (KeyboardInterrupt, Stopped):
        notebook_run.stop.set()
        print("\ncourse: stopped. The same command goes on where this one was.", file=sys.stderr)
        return STOPPED
