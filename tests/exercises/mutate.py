"""How good the verdicts are: each reference solution changed in every small way must lose points. Run by hand.

.venv/bin/python -m tests.exercises.mutate topics-1 services --jobs 4

For each exercise it says how many changes there were, how many were caught, how many of the others are as good as the
solution by the exercise's text (equivalent_mutants.yaml says why), and which are left. The status is 1 if one is left.
"""

from __future__ import annotations

import argparse
import re
import sys
import time
from pathlib import Path

import yaml

from course_kit.exercises import catalogue
from course_kit.exercises.catalogue import CHAPTERS
from course_kit.exercises.checker import checks
from tests import leftovers
from tests.exercises.chapter import answers_to
from tests.exercises.kernels import Put, check_all
from tests.exercises.mutants import mutants

# {exercise, or any: {pattern of changes: why those that are not caught are as good as the solution}}
EQUIVALENT = Path(__file__).with_name("equivalent_mutants.yaml")


def _is_full(shown: str) -> bool:
    """Return True if it got all points."""
    points = re.search(r": (\d+) of (\d+) points?$", shown.partition("\n")[0])
    return points is not None and points[1] == points[2] and "✘" not in shown


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("only", nargs="*", help="exercises, or chapters; all unless given")
    parser.add_argument("--jobs", type=int, default=4, help="kernels beside each other")
    parser.add_argument("--list", action="store_true", help="list the changes and check none")
    chosen = parser.parse_args()
    leftovers.begin()
    equivalent: dict[str, dict[str, str]] = yaml.safe_load(EQUIVALENT.read_text())
    is_left = False
    for name in CHAPTERS:
        for answers in answers_to(name):
            if chosen.only and not {name, answers.exercise} & set(chosen.only):
                continue
            exercise = catalogue.find(answers.exercise)
            made = mutants(
                answers.reference, only_classes=bool(exercise.node_class and not checks.find(exercise).watches)
            )
            known = [*equivalent["any"], *equivalent.get(answers.exercise, {})]
            if chosen.list:
                print("\n".join(f"{answers.exercise} {one.change}" for one in made))
                continue
            began = time.monotonic()
            changes = [Put(one.change, answers.exercise, one.source) for one in made]
            found = list(check_all(name, changes, chosen.jobs))
            full = [one.answer.name for one in found if _is_full(one.text)]
            left = [change for change in full if not any(re.search(pattern, change) for pattern in known)]
            print(
                f"{answers.exercise}: {len(made)} mutants, {len(found) - len(full)} caught, "
                f"{len(full) - len(left)} equivalent, {len(left)} left, {len(made) - len(found)} without a result; "
                f"{time.monotonic() - began:.0f} s",
                flush=True,
            )
            for change in left:
                print(f"    {change}", flush=True)
            for one in found:
                if one.text.startswith("no verdict"):
                    print(f"    ({one.answer.name}: {one.text})", flush=True)
            is_left = is_left or bool(left)
    return is_left


if __name__ == "__main__":
    sys.exit(main())
