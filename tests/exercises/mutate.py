"""How good the verdicts are: each reference solution changed in every small way must lose points. Run by hand.

.venv/bin/python -m tests.exercises.mutate topics-1 services --jobs 4

For each exercise it says how many changes there were, how many were caught, how many of the others are as good as the
solution by the exercise's text (equivalent_mutants.yaml says why), and which are left. The status is 1 if one is left.
"""

from __future__ import annotations

import argparse
import multiprocessing
import re
import sys
import time
from collections.abc import Iterator
from contextlib import ExitStack
from dataclasses import dataclass
from pathlib import Path
from queue import Empty
from typing import Any

import yaml

from course_kit import exercises
from course_kit.exercises import CHAPTERS
from tests.domains import use_own_domain
from tests.exercises.chapter import Chapter, answers_to, chapter
from tests.exercises.mutants import Mutant, mutants

# {exercise, or any: {pattern of changes: why those that are not caught are as good as the solution}}
EQUIVALENT = Path(__file__).with_name("equivalent_mutants.yaml")
CELL_TIMEOUT = 60.0  # seconds for an answer that may wait for what never comes
WORKER_TIMEOUT = 600.0


@dataclass(frozen=True)
class Result:
    """What became of one mutant: the verdict's text, or that there was none."""

    exercise: str
    mutant: Mutant
    shown: str
    seconds: float

    @property
    def is_full(self) -> bool:
        """Whether it got all points."""
        points = re.search(r": (\d+) of (\d+) points?$", self.shown.partition("\n")[0])
        return points is not None and points[1] == points[2] and "✘" not in self.shown


class _Notebook:
    """A chapter's notebook, opened anew when an answer has blocked it."""

    def __init__(self, name: str) -> None:
        self._name = name
        self._stack = ExitStack()
        self._open: Chapter | None = None

    def verdict(self, exercise: str, source: str) -> str:
        """What the check says of an answer."""
        try:
            if self._open is None:
                self._open = self._stack.enter_context(chapter(self._name))
            self._open.kernel.finish(self._open.kernel.send(source), CELL_TIMEOUT)
            return self._open.check(exercise)
        except Exception as error:  # it hangs, or has ended its kernel
            self.close()
            return f"no verdict: {str(error)[:200]}"

    def close(self) -> None:
        self._stack.close()
        self._open = None


def _work(name: str, jobs: Any, results: Any) -> None:
    use_own_domain()
    notebook = _Notebook(name)
    while (job := jobs.get()) is not None:
        exercise, mutant = job
        began = time.monotonic()
        results.put(Result(exercise, mutant, notebook.verdict(exercise, mutant.source), time.monotonic() - began))
    notebook.close()


def _results(name: str, chosen: list[tuple[str, Mutant]], jobs: int) -> Iterator[Result]:
    """The results of a chapter's mutants, from several kernels beside each other."""
    context = multiprocessing.get_context("spawn")
    todo, results = context.Queue(), context.Queue()
    for job in [*chosen, *[None] * jobs]:
        todo.put(job)
    workers = [context.Process(target=_work, args=(name, todo, results)) for _ in range(min(jobs, len(chosen)))]
    for worker in workers:
        worker.start()
    try:
        for _ in chosen:
            yield results.get(timeout=WORKER_TIMEOUT)
    except Empty:
        print(f"no result in {WORKER_TIMEOUT:g} s", flush=True)
    finally:
        for worker in workers:
            worker.join(60)
            worker.terminate()


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("only", nargs="*", help="exercises, or chapters; all unless given")
    parser.add_argument("--jobs", type=int, default=4, help="kernels beside each other")
    parser.add_argument("--list", action="store_true", help="list the changes and check none")
    chosen = parser.parse_args()
    equivalent: dict[str, dict[str, str]] = yaml.safe_load(EQUIVALENT.read_text())
    is_left = False
    for name in CHAPTERS:
        for answers in answers_to(name).ANSWERS:
            if chosen.only and not {name, answers.exercise} & set(chosen.only):
                continue
            exercise = exercises.find(answers.exercise)
            made = mutants(answers.reference, only_classes=bool(exercise.node_class and not exercise.watches))
            known = [*equivalent["any"], *equivalent.get(answers.exercise, {})]
            if chosen.list:
                print("\n".join(f"{answers.exercise} {one.change}" for one in made))
                continue
            began = time.monotonic()
            found = list(_results(name, [(answers.exercise, one) for one in made], chosen.jobs))
            full = [one for one in found if one.is_full]
            left = [one for one in full if not any(re.search(pattern, one.mutant.change) for pattern in known)]
            print(
                f"{answers.exercise}: {len(made)} mutants, {len(found) - len(full)} caught, "
                f"{len(full) - len(left)} equivalent, {len(left)} left, {len(made) - len(found)} without a result; "
                f"{time.monotonic() - began:.0f} s",
                flush=True,
            )
            for one in left:
                print(f"    {one.mutant.change}", flush=True)
            for one in found:
                if one.shown.startswith("no verdict"):
                    print(f"    ({one.mutant.change}: {one.shown})", flush=True)
            is_left = is_left or bool(left)
    return is_left


if __name__ == "__main__":
    sys.exit(main())
