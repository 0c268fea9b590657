"""Every answer of a chapter checked many times beside busy processes; counts the wrong verdicts.

.venv/bin/python -m tests.exercises.repeat services --times 20 --busy 2 [--only services-4 actions-1-forgets_cancel]
"""

from __future__ import annotations

import argparse
import contextlib
import subprocess
import sys
import time
from collections import Counter
from collections.abc import Iterator

from course_kit.exercises import CHAPTERS
from tests.domains import use_own_domain
from tests.exercises.chapter import Chapter, answers_to, chapter, judge

# Until this process ends, however it does.
BUSY = "import os\nparent = os.getppid()\nwhile os.getppid() == parent: pass"


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("chapter", choices=CHAPTERS)
    parser.add_argument("--times", type=int, default=20)
    parser.add_argument("--busy", type=int, default=2, help="processes that keep a core busy each")
    parser.add_argument("--only", nargs="+", default=[""], help="EXERCISE or EXERCISE-ANSWER, as they begin")
    parser.add_argument("--reference", action="store_true", help="the right answers only")
    chosen = parser.parse_args()
    use_own_domain()
    with chapter(chosen.chapter) as notebook, _busy(chosen.busy):
        wrong, count = _repeat(notebook, list(_chosen(chosen)), chosen.times)
    print(f"{count} checks, {sum(wrong.values())} wrong verdicts {dict(wrong)}")
    return bool(wrong)


@contextlib.contextmanager
def _busy(count: int):
    processes = [subprocess.Popen([sys.executable, "-S", "-c", BUSY]) for _ in range(count)]
    try:
        yield
    finally:
        for process in processes:
            process.kill()
            process.wait()


def _chosen(chosen: argparse.Namespace) -> Iterator[tuple[str, str, str, int, int, str]]:
    """An answer's name, its exercise, its source, its points, all points, and a part of its hint."""
    for one in answers_to(chosen.chapter).ANSWERS:
        wrong = [] if chosen.reference else [(w.name, w.source, w.points, w.hint) for w in one.wrong]
        rights = {"reference": one.reference, **({} if chosen.reference else one.right)}
        for name, source, points, hint in [*wrong, *((name, right, one.points, "") for name, right in rights.items())]:
            if f"{one.exercise}-{name}".startswith(tuple(chosen.only)):
                yield f"{one.exercise}-{name}", one.exercise, source, points, one.points, hint


def _repeat(notebook: Chapter, answers: list[tuple], times: int) -> tuple[Counter[str], int]:
    wrong: Counter[str] = Counter()
    for turn in range(times):
        began = time.monotonic()
        took: dict[str, float] = {}
        for name, exercise, source, points, all_points, hint in answers:
            start = time.monotonic()
            try:
                judge(notebook.answer(exercise, source), points, all_points, hint)
            except AssertionError as error:
                wrong[name] += 1
                print(f"{name}: {error}", flush=True)
            took[name] = time.monotonic() - start
        slowest = sorted(took, key=lambda name: took[name])[-3:]
        shown = ", ".join(f"{name} {took[name]:.0f} s" for name in slowest)
        print(f"turn {turn + 1}: {time.monotonic() - began:.0f} s; the slowest: {shown}", flush=True)
    return wrong, times * len(answers)


if __name__ == "__main__":
    sys.exit(main())
