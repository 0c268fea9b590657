"""Verdicts, values and paths: the parts of the checks that need no ROS."""

from __future__ import annotations

import contextlib
import math
import os
import resource
import signal
import subprocess
import sys
import threading
from dataclasses import asdict, replace
from multiprocessing import Pipe
from pathlib import Path

import numpy as np
import pytest

from course_kit.base import file_locks
from course_kit.classroom import course_command
from course_kit.exercises import catalogue
from course_kit.exercises.exercise import LEVELS
from course_kit.exercises.in_notebook import check, checker_client, progress
from course_kit.exercises.notebook_folder import beside_the_notebook
from course_kit.exercises.protocol.channel import LONGEST, Channel, Closed, TooLong, as_json
from course_kit.exercises.protocol.verdict import NOT_BEGUN, Finding, Verdict, in_code
from course_kit.robots.turtlesim import paths

HALF = Verdict(
    "topics-1",
    "Count down",
    2,
    findings=(
        Finding("its node is `/countdown`", True),
        Finding("counts", True, max_points=1),
        Finding("rate", False, "1 Hz", 1),
    ),
)


def test_a_verdict_says_points_marks_and_hints():
    assert str(HALF).splitlines() == [
        "topics-1 · Count down: 1 of 2 points",
        "✔ its node is `/countdown`",
        "✔ counts (1 of 1 point)",
        "✘ rate (0 of 1 point)",
        "    1 Hz",
    ]
    assert not HALF.is_full


def test_a_verdict_survives_json():
    assert Verdict.from_json(asdict(HALF)) == HALF


def test_html_escapes_what_a_student_wrote():
    assert in_code("`<b>` is") == "<code>&lt;b&gt;</code> is"
    assert in_code("a ` alone <i>") == "a ` alone &lt;i&gt;"
    assert "<script>" not in Verdict("a-1", "A", 1, findings=(Finding("<script>", False, "<script>"),))._repr_html_()


@pytest.mark.parametrize(
    ("value", "wanted"),
    [
        ({"b", "a"}, ["a", "b"]),
        ((1, None), [1, None]),
        (np.float32(0.5), 0.5),
        (np.arange(3), [0, 1, 2]),
        (math.nan, "nan"),
        ({1: [True]}, {"1": [True]}),
    ],
)
def test_values_become_json(value, wanted):
    assert as_json(value) == wanted


def test_a_value_that_is_none_of_these_is_refused():
    with pytest.raises(TypeError, match="object is no plain value"):
        as_json([object()])


def test_a_channel_carries_messages_and_notice_the_end():
    ours, theirs = Pipe()
    one, other = Channel(ours), Channel(theirs)
    one.send({"a": 1})
    one.send({"b": "ü\n"})
    assert other.receive(1) == {"a": 1} and other.receive(1) == {"b": "ü\n"}
    assert other.receive(0.01) is None
    theirs.send_bytes(b"no json")
    with pytest.raises(Closed):
        one.receive(1)
    ours.close()
    with pytest.raises(Closed):
        other.receive(1)


def test_messages_come_also_where_a_thousand_files_are_open():
    soft, hard = resource.getrlimit(resource.RLIMIT_NOFILE)
    resource.setrlimit(resource.RLIMIT_NOFILE, (min(2048, hard), hard))
    with contextlib.ExitStack() as opened:
        opened.callback(resource.setrlimit, resource.RLIMIT_NOFILE, (soft, hard))
        while opened.enter_context(open(os.devnull)).fileno() <= 1024:
            pass
        ours, theirs = map(opened.enter_context, Pipe())
        assert theirs.fileno() > 1023
        Channel(ours).send({"a": 1})
        other = Channel(theirs)
        assert other.receive(10) == {"a": 1} and other.receive(0.01) is None


def test_what_is_too_long_is_not_sent_and_what_may_be_sent_is_received():
    ours, theirs = Pipe()
    with ours, theirs:
        one, other = Channel(ours), Channel(theirs)
        with pytest.raises(TooLong, match=r"it is 10 MB long as text, and a check takes 10 MB at most"):
            one.send({"value": "x" * LONGEST})
        longest = {"value": "x" * (LONGEST - len('{"value": ""}\n'))}
        thread = threading.Thread(target=one.send, args=[longest])
        thread.start()
        assert other.receive(60) == longest
        thread.join()


def test_a_star_is_closed_and_its_corners_are_72_degrees_apart():
    corners = paths.star((5.0, 5.0), 4.0)
    assert corners[0] == pytest.approx((5.0, 9.0)) and corners[-1] == pytest.approx(corners[0])
    angles = sorted(math.degrees(math.atan2(y - 5.0, x - 5.0)) % 360 for x, y in corners[:5])
    assert angles == pytest.approx([18, 90, 162, 234, 306])


@pytest.fixture
def state(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setenv("XDG_STATE_HOME", str(tmp_path))
    return tmp_path


def test_progress_keeps_the_best_and_nothing_of_what_is_not_begun(state: Path):
    progress.record(Verdict("topics-1", "", 2, NOT_BEGUN))
    assert progress.load() == {}
    full = Verdict("topics-1", "", 2, findings=(Finding("all", True, max_points=2),))
    for verdict in (HALF, full, HALF):
        progress.record(verdict)
    assert progress.load() == {"topics-1": 2}
    assert sorted(p.name for p in progress.path().parent.iterdir()) == ["lock", "progress.json"]


DAMAGED = ["", "[]", '{"points": 3}', '{"points": {"a": "x"}}', "\x00"]
DAMAGED += ['{"points": {"a": Infinity}}', '{"points": {"a": NaN}}', "[" * 100_000]


@pytest.mark.parametrize("text", DAMAGED, ids=range(len(DAMAGED)))
def test_a_damaged_progress_file_is_kept_aside_and_said_to_be(
    state: Path, text: str, capsys: pytest.CaptureFixture[str]
):
    file = progress.path()
    file.parent.mkdir(parents=True)
    for number in (1, 2):
        file.write_text(text)
        assert repr(progress.Progress()).startswith(f"Your earlier points cannot be read from {file}")
        assert course_command.main(["progress", "--json"]) == 1
        assert capsys.readouterr().err.startswith(f"course: your earlier points cannot be read from {file}")
        aside = file.with_name(f"progress.json.damaged-{number}")
        assert f"It is now {aside.name}" in progress.record(HALF)
        assert aside.read_text() == text
        assert progress.load() == {"topics-1": 1}
        assert progress.record(HALF) == ""


def test_a_progress_file_that_cannot_be_read_is_not_written_over(state: Path):
    progress.path().mkdir(parents=True)
    assert "progress.json.damaged-1" in progress.record(HALF)
    assert progress.load() == {"topics-1": 1} and progress.path().with_name("progress.json.damaged-1").is_dir()


def test_who_keeps_the_lock_of_progress_is_not_waited_for_without_end(
    state: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
):
    monkeypatch.setattr(progress, "LOCK_TIMEOUT", 0.1)
    progress.record(HALF)
    monkeypatch.setattr(checker_client, "ask", lambda *_: replace(HALF, exercise="topics-2"))
    lock = progress.path().with_name("lock")
    with file_locks.locked(lock, 1.0):
        check.check("topics-2")
    (said,) = [line for line in capsys.readouterr().out.splitlines() if line.startswith("check: ")]
    assert said.startswith(
        f"check: your points could not be kept: another process has kept the lock '{lock}' for 0.1 s"
    )
    assert progress.load() == {"topics-1": 1}


def test_a_killed_save_leaves_the_earlier_points_and_what_it_left_goes_with_the_next(state: Path):
    progress.record(HALF)
    code = (
        "import os, signal\n"
        "from course_kit.exercises.in_notebook import progress\n"
        "from course_kit.exercises.protocol.verdict import Finding, Verdict\n"
        "os.replace = lambda *_: os.kill(os.getpid(), signal.SIGKILL)\n"
        "progress.record(Verdict('topics-2', '', 2, findings=(Finding('all', True, max_points=2),)))\n"
    )
    assert subprocess.run([sys.executable, "-c", code], timeout=60).returncode == -signal.SIGKILL
    folder = progress.path().parent
    assert progress.load() == {"topics-1": 1} and len(list(folder.iterdir())) == 3
    progress.record(Verdict("topics-1", "", 2, findings=(Finding("all", True, max_points=2),)))
    assert progress.load() == {"topics-1": 2}
    assert sorted(p.name for p in folder.iterdir()) == ["lock", "progress.json"]


def test_the_command_shows_progress_by_chapter(state: Path, capsys: pytest.CaptureFixture[str]):
    progress.record(HALF)
    assert course_command.main(["progress"]) == 0
    shown = capsys.readouterr().out
    assert "3 · Topics" in shown and "◐ topics-1" in shown and "○ topics-2" in shown
    assert course_command.main(["progress", "--json"]) == 0
    assert capsys.readouterr().out == '{"topics-1": 1}\n'


@pytest.mark.parametrize("chapter", catalogue.CHAPTERS)
def test_every_chapter_has_four_exercises_from_warm_up_on(chapter: str):
    asked = catalogue.of_chapter(chapter)
    assert len(asked) >= 4
    assert [one.name for one in asked] == [f"{chapter}-{number}" for number in range(1, len(asked) + 1)]
    assert asked[0].level == "warm-up"
    levels = [LEVELS.index(one.level) for one in asked]
    assert levels == sorted(levels)


@pytest.mark.parametrize("gone_to", ["", "ros2_ws", "ros2_ws/src/my_robot"])
def test_a_cell_that_has_gone_into_the_workspace_leaves_the_notebooks_folder_the_same(gone_to):
    assert beside_the_notebook(Path("/home/ada/course") / gone_to) == Path("/home/ada/course")


def test_an_exercise_that_is_not_there_is_named_with_what_may_be_meant():
    with pytest.raises(ValueError, match="Did you mean 'topics-1'"):
        catalogue.find("topic-1")
