"""Answers checked many times, in several kernels beside each other and beside busy processes; counts wrong verdicts.

.venv/bin/python -m tests.exercises.repeat services actions-5 actions-1-forgets --times 20 --jobs 4 --busy 2
"""

from __future__ import annotations

import argparse
import contextlib
import subprocess
import sys
import time
from collections import Counter
from collections.abc import Iterator

from course_kit.exercises.catalogue import CHAPTERS
from tests import leftovers
from tests.exercises.chapter import answers_to, judge
from tests.exercises.kernels import Put, check_all

# Until this process ends, however it does.
BUSY = "import os\nparent = os.getppid()\nwhile os.getppid() == parent: pass"
Expected = tuple[int, int, str]  # points, of so many, and a part of the hint


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("only", nargs="*", help="CHAPTER, EXERCISE or EXERCISE-ANSWER, as they begin; all unless given")
    parser.add_argument("--times", type=int, default=20)
    parser.add_argument("--jobs", type=int, default=1, help="kernels beside each other")
    parser.add_argument("--busy", type=int, default=2, help="processes that keep a core busy each")
    parser.add_argument("--right", action="store_true", help="the right answers only")
    chosen = parser.parse_args()
    leftovers.begin()
    checks, wrong = 0, Counter[str]()
    with _busy(chosen.busy):
        for name in CHAPTERS:
            answers = _answers(name, tuple(chosen.only), chosen.right)
            began = time.monotonic()
            for shown in check_all(name, [*answers] * chosen.times, chosen.jobs):
                checks += 1
                try:
                    judge(shown.text, *answers[shown.answer])
                except AssertionError as error:
                    wrong[shown.answer.name] += 1
                    raised = f"; its cell raised {shown.raised}" if shown.raised else ""
                    print(f"{shown.answer.name}{raised}: {error}", flush=True)
            if answers:
                seconds = time.monotonic() - began
                print(f"{name}: {len(answers)} answers, {chosen.times} times, in {seconds:.0f} s", flush=True)
    print(f"{checks} checks, {wrong.total()} wrong verdicts {dict(wrong)}")
    return bool(wrong)


@contextlib.contextmanager
def _busy(count: int) -> Iterator[None]:
    processes = [subprocess.Popen([sys.executable, "-S", "-c", BUSY]) for _ in range(count)]
    try:
        yield
    finally:
        for process in processes:
            process.kill()
            process.wait()


def _answers(chapter: str, only: tuple[str, ...], only_right: bool) -> dict[Put, Expected]:
    """The answers of a chapter, and what each must get."""
    found: dict[Put, Expected] = {}
    for one in answers_to(chapter):
        expected = {} if only_right else {w.name: (w.source, (w.points, one.points, w.hint)) for w in one.wrong}
        rights = {"reference": one.reference, **one.right}
        expected |= {style: (source, (one.points, one.points, "")) for style, source in rights.items()}
        for name, (source, points) in expected.items():
            if (answer := f"{one.exercise}-{name}").startswith(only or ("",)):
                found[Put(answer, one.exercise, source)] = points
    return found


if __name__ == "__main__":
    sys.exit(main())
