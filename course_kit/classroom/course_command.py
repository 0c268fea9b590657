"""The command `course`: `progress` shows what is solved, `grade` grades it or a class, `release` is for instructors."""

from __future__ import annotations

import argparse
import json
import sys
from collections.abc import Sequence


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command; return its exit status."""
    parser = argparse.ArgumentParser(prog="course", description="The course on ROS 2 in notebooks.")
    verbs = parser.add_subparsers(dest="verb", required=True, metavar="VERB")
    shown = verbs.add_parser("progress", help="what you have solved, by chapter")
    shown.add_argument("--json", action="store_true", help="the points as JSON: {exercise: points}")
    if "progress" not in (sys.argv[1:2] if arguments is None else arguments[:1]):  # which needs nothing of grading
        from course_kit.classroom import command

        command.add_verbs(verbs)
    chosen = parser.parse_args(arguments)
    return _progress(chosen.json) if chosen.verb == "progress" else command.run(chosen)


def _progress(is_json: bool) -> int:
    from course_kit.exercises.in_notebook import progress

    try:
        print(json.dumps(progress.load()) if is_json else progress.Progress())
    except progress.Damaged as damaged:
        print(f"course: {damaged}", file=sys.stderr)
        return 1
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
