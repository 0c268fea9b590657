"""Writes whatever the course writes into the folder in which it runs, and prints what is said as JSON: see
tests/test_full_disk.py. `python -m tests.programs.writes_all prepare` makes what is there before."""

from __future__ import annotations

import contextlib
import io
import json
import sys
import traceback
from collections.abc import Callable
from pathlib import Path
from unittest import mock

import numpy as np

from course_kit import save_csv
from course_kit.classroom import course_command
from course_kit.cli.ros2 import command
from course_kit.exercises.in_notebook import check, checker_client
from course_kit.exercises.protocol.verdict import Finding, Verdict
from course_kit.lab import bags
from course_kit.lab.bags.writer import BagWriter
from course_kit.lab.replays.replayed import Replayed
from course_kit.lab.series.value_series import Series, Values
from course_kit.setup.colcon import chapter_packages
from course_kit.setup.colcon.workspaces import Workspace

NOTEBOOK = Path(__file__).parents[2] / "notebooks/03_topics.ipynb"
DATA = b"\0\1\0\0\2\0\0\0a\0"  # a std_msgs/msg/String
VALUES = Values([Series("/a.x", np.arange(500), np.arange(500, dtype=np.float64), 0)])


def prepare() -> None:
    """What was written when there was room."""
    Path("drive.csv").write_text("earlier\n")
    for name in ("killed", "replayed"):
        writer = BagWriter(name)
        writer.add_topic("/a", "std_msgs/msg/String")
        writer.write("/a", 1, DATA)
        writer.flush()
        if name == "replayed":
            writer.close()
    Path("ws/src").mkdir(parents=True)
    Path("handed-in/ann").mkdir(parents=True)
    Path("handed-in/ann/03_topics.ipynb").symlink_to(NOTEBOOK)


def _check() -> None:
    found = Verdict("topics-1", "Count down", 2, findings=(Finding("all", True, max_points=2),))
    with mock.patch.object(checker_client, "ask", lambda *_: found):
        check.check("topics-1")


THINGS: dict[str, Callable[[], object]] = {
    "save_csv": lambda: save_csv(VALUES, "drive.csv"),
    "pkg create": lambda: command.run(["pkg", "create", "mine", "--license", "Apache-2.0"]),
    "bag record": lambda: command.run(["bag", "record", "--all", "-o", "bag", "--disable-keyboard-controls"]),
    "bags.record": lambda: bags.record("bag", "/a"),
    "bags.record sqlite3": lambda: bags.record("bag", "/a", storage="sqlite3"),
    "bags.reindex": lambda: bags.reindex("killed"),
    "replay": lambda: Replayed("Node", 0).save("replayed", overwrite=True),
    "check": _check,
    "workspace": lambda: Workspace("new_ws"),
    "chapter's package": lambda: chapter_packages.provide(Workspace("ws"), "my_interfaces"),
    "colcon build": lambda: Workspace("ws").build(),
    "release": lambda: course_command.main(["release", "course.zip"]),
    "grade": lambda: course_command.main(["grade", "handed-in", "--out", "grades", "--only", "topics-1"]),
}


def main() -> None:
    """Try each."""
    if sys.argv[1:] == ["prepare"]:
        prepare()
        return
    said = {}
    for name, write in THINGS.items():
        out = io.StringIO()
        with contextlib.redirect_stdout(out), contextlib.redirect_stderr(out):
            _try(write)
        said[name] = out.getvalue()
    json.dump(said, sys.stdout)


def _try(write: Callable[[], object]) -> None:
    """Print an error as a notebook does: its class may have it in one line."""
    try:
        write()
    except Exception as error:
        own = getattr(error, "_render_traceback_", None)
        print("\n".join(own() if own else traceback.format_exc().splitlines()))


if __name__ == "__main__":
    main()
