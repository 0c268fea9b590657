"""Grading by an ordinary user: the sandboxes need no rights of root's."""

from __future__ import annotations

import os
import shutil
import subprocess
import tempfile
from collections.abc import Iterator
from pathlib import Path

import pytest

from course_kit.classroom.run import sandbox
from tests.cheats.cheats_machine import CHEATS
from tests.grading.handed_in import hand_in, references
from tests.other_users import command_of

NOBODY = 65534
HARMFUL = ("files", "hidden_memory", "kernel_settings")
pytestmark = [
    pytest.mark.cpu_bound,
    pytest.mark.skipif(os.getuid() != 0, reason="who is no root grades as an ordinary user in every other test"),
    pytest.mark.skipif(not sandbox.is_available(), reason="there is no bubblewrap that can make sandboxes"),
    pytest.mark.slow("four gradings"),
    pytest.mark.timeout(400),
]


@pytest.fixture
def folder() -> Iterator[Path]:
    """A folder that the user may reach: those of pytest are root's."""
    with tempfile.TemporaryDirectory(prefix="course-user-", dir="/tmp") as made:
        os.chmod(made, 0o755)
        yield Path(made)


def test_an_ordinary_user_grades_in_sandboxes(folder: Path) -> None:
    hand_in(folder / "in" / "ann", "services", {"services-1": references("services")["services-1"]})
    for cheat in (each for each in CHEATS if each.name in HARMFUL):
        hand_in(folder / "in" / cheat.name, "services", {cheat.exercise: cheat.source})
    for name in ("home", "in"):
        (folder / name).mkdir(exist_ok=True)
    for path in (folder, *folder.rglob("*")):
        shutil.chown(path, NOBODY, NOBODY)
    asked = ("--only", "services-1", "--require-sandbox", "--jobs", "2")
    grade = command_of(NOBODY, folder, "course", "grade", f"{folder}/in", "--out", f"{folder}/out", *asked)
    done = subprocess.run(grade, capture_output=True, text=True, timeout=350)
    assert done.returncode == 0, done.stdout + done.stderr
    rows = dict(line.split(",")[:2] for line in (folder / "out/grades.csv").read_text().splitlines()[1:])
    assert rows == {"ann": "2", **dict.fromkeys(HARMFUL, "0")}, done.stdout
    told = (folder / "out/grades.json").read_text()
    assert "ESCAPED" not in told
    assert sandbox.APART in told
