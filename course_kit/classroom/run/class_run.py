"""A class graded: so many notebooks at once as the machine can do; what is graded is kept and used again."""

from __future__ import annotations

import contextlib
import json
from collections.abc import Callable, Iterator, Mapping, Sequence
from concurrent.futures import Executor, Future, ThreadPoolExecutor, as_completed
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import Any

from course_kit.base.atomic_files import write_whole
from course_kit.classroom.results import ExerciseResult, StudentResult
from course_kit.classroom.run import notebook_run, sandbox
from course_kit.classroom.run.course_digest import course_digest
from course_kit.classroom.run.notebook_run import Found, Settings
from course_kit.classroom.run.submission import Submission, Work
from course_kit.exercises import catalogue
from course_kit.exercises.checker import own_types
from course_kit.exercises.notebooks import reference
from course_kit.exercises.protocol.verdict import NOT_BEGUN, NOT_LOOKED_AT

KEPT = "graded"  # the folder of results that are used again
FORMAT = 1  # of what is kept
# The share of a check's time in which something waited for a processor, from which on that may be why points are lost.
BUSY = 0.25
Report = Callable[[StudentResult], None]


@dataclass(frozen=True)
class ClassRun:
    """How a class is graded."""

    settings: Settings
    jobs: int
    folder: Path | None = None  # where results are kept from one run to the next
    executor: Executor | None = None  # of other machines; else this one's

    def grade(self, submissions: Sequence[Submission], report: Report) -> list[StudentResult]:
        """Grade them; `report` is told of each student when all of hers is graded. Raises notebook_run.Stopped."""
        chapters, course = {chapter.name: chapter for chapter in reference.chapters()}, course_digest()
        by_key: dict[str, Work] = {}
        keys_of: dict[str, list[str]] = {}
        for one in submissions:
            keys_of[one.handin.student] = []
            for work in one.works:
                key = work.digest(chapters[work.chapter], f"{course} {self.settings.timeout} {self.settings.is_apart}")
                keys_of[one.handin.student].append(key)
                by_key[key] = work
        graded = {key: kept for key in by_key if (kept := self._kept(key)) is not None}
        results: dict[str, StudentResult] = {}

        def tell() -> None:
            for one in submissions:
                student = one.handin.student
                if student not in results and all(key in graded for key in keys_of[student]):
                    results[student] = self._result(
                        one, {n: f for key in keys_of[student] for n, f in graded[key].items()}
                    )
                    report(results[student])

        tell()
        todo = {key: work for key, work in by_key.items() if key not in graded}
        doubtful: dict[str, dict[str, Found]] = {}
        for key, found in self._run(todo, course):
            if any(map(_is_in_doubt, found.values())):
                doubtful[key] = found
            else:
                self._keep(key, graded, found)
                tell()
        for key, found in doubtful.items():
            again = tuple(name for name, one in found.items() if _is_in_doubt(one))
            alone = dict(self._run({key: replace(by_key[key], only=again)}, course))[key]
            self._keep(key, graded, {name: _better(one, alone.get(name)) for name, one in found.items()})
            tell()
        return [results[one.handin.student] for one in submissions]

    def _run(self, works: Mapping[str, Work], course: str) -> Iterator[tuple[str, dict[str, Found]]]:
        """Grade these beside each other; what each came to, as it comes."""
        own = ThreadPoolExecutor(self.jobs) if self.executor is None else contextlib.nullcontext(self.executor)
        with own as executor:
            futures: dict[Future[dict[str, Found]], str] = {
                executor.submit(grade_work, work, self.settings, course): key for key, work in works.items()
            }
            try:
                for future in as_completed(futures):
                    yield futures[future], future.result()
            except BaseException:
                notebook_run.stop.set()
                for future in futures:
                    future.cancel()
                raise

    def _kept(self, key: str) -> dict[str, Found] | None:
        if self.folder is None:
            return None
        try:
            data = json.loads((self.folder / KEPT / f"{key}.json").read_text())
            return {name: _found(one) for name, one in data["found"].items()} if data["format"] == FORMAT else None
        except (OSError, ValueError, KeyError, TypeError, AttributeError):  # none yet, or damaged: it is graded again
            return None

    def _keep(self, key: str, graded: dict[str, dict[str, Found]], found: dict[str, Found]) -> None:
        graded[key] = found
        if self.folder is not None and not any(one.result.verdict.state == NOT_LOOKED_AT for one in found.values()):
            data = {"format": FORMAT, "found": {name: asdict(one) for name, one in found.items()}}
            write_whole(self.folder / KEPT / f"{key}.json", json.dumps(data).encode())

    def _result(self, one: Submission, found: Mapping[str, Found]) -> StudentResult:
        return StudentResult(
            one.handin.student,
            tuple(found[name].result for work in one.works for name in work.only),
            one.notes,
            one.handin.ids,
            one.handin.late,
            sandbox.APART if self.settings.is_apart else sandbox.NOT_APART,
        )


def grade_work(work: Work, settings: Settings, course: str) -> dict[str, Found]:
    """Grade one chapter of one student, on this machine. RuntimeError where it has another course."""
    if course_digest() != course:
        raise RuntimeError("this machine has another version of the course than the one that sends the jobs")
    if settings.is_apart and not sandbox.is_available():
        raise RuntimeError(
            "this machine has no bubblewrap that can make sandboxes, and the one that sends the jobs has"
        )
    chapter = next(chapter for chapter in reference.chapters() if chapter.name == work.chapter)
    return notebook_run.grade(chapter, work.sources, work.only, settings, work.workspace)


def prepare(names: Sequence[str]) -> None:
    """Have what the checks of these exercises need compiled once, before the sandboxes in which nothing can be kept."""
    for package in {package for name in names for package in catalogue.find(name).types}:
        own_types.provide(package)


def _found(data: Mapping[str, Any]) -> Found:
    return Found(ExerciseResult.from_json(data["result"]), float(data["stalled"]))


def _is_in_doubt(found: Found) -> bool:
    """Return True if an exercise may have lost its points for want of time only."""
    verdict = found.result.verdict
    return verdict.state != NOT_BEGUN and not verdict.is_full and (found.stalled > BUSY or found.is_late)


def _better(first: Found, alone: Found | None) -> Found:
    """What counts of an exercise that was checked again: that it got more points beside others is no mistake."""
    if alone is None:
        return first
    better = first if first.result.verdict.points > alone.result.verdict.points else alone
    return Found(replace(better.result, tries=first.result.tries + 1))
