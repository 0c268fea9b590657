"""A class graded by `course grade`, as its instructor does it: the points, the files, what is used again, a cluster."""

from __future__ import annotations

import contextlib
import csv
import json
import os
import shutil
import signal
import subprocess
import sys
import tempfile
from collections.abc import Iterator, Sequence
from pathlib import Path

import psutil  # type: ignore[import-untyped]
import pytest

from course_kit.classroom.collect import handins
from course_kit.classroom.run import class_run, sandbox, submission
from course_kit.classroom.run.notebook_run import Settings
from tests.grading.classes import ASKED, CHAPTER, FORMATS, NAME, Student, exported, students
from tests.grading.handed_in import CHAPTERS, hand_in, references
from tests.waiting import wait_until

COURSE = [sys.executable, "-m", "course_kit.classroom.course_command"]
RIGHT, CHEAT, BROKEN, LATE = 0, 4, 7, 8  # of each ten students
GRADED = dict(zip(FORMATS, (RIGHT, LATE, CHEAT, CHEAT, CHEAT, CHEAT), strict=True))  # beside one that is broken
pytestmark = [
    pytest.mark.cpu_bound,
    pytest.mark.timeout(900),
    pytest.mark.by_turns("gradings in kernels"),
]
SLOW = pytest.mark.slow("grades a student after the other")


def grade(*arguments: str, folder: Path | None = None, **environ: str) -> subprocess.CompletedProcess[str]:
    command = [*COURSE, "grade", *arguments]
    whole = {**os.environ, **environ}
    return subprocess.run(command, cwd=folder, env=whole, capture_output=True, text=True, timeout=850)


def rows(out: Path) -> dict[str, dict[str, str]]:
    with open(out / "grades.csv", newline="", encoding="utf-8-sig") as file:
        return {row["student"]: row for row in csv.DictReader(file)}


def of_each_format() -> Iterator[object]:
    for form in FORMATS:
        yield pytest.param(form, marks=pytest.mark.xdist_group(f"class in {form}"))


@SLOW
@pytest.mark.parametrize("form", list(of_each_format()))
def test_a_class_gets_the_expected_points(form: str, tmp_path: Path):
    """One who is all right, a cheat or late, and one whose file is broken: other ones in each format."""
    sixty = list(students(10 * len(FORMATS)))
    part = [sixty[FORMATS.index(form) * 10 + number] for number in (GRADED[form], BROKEN)]
    handed_in, out = exported(tmp_path / "handed in", form, part), tmp_path / "grades"
    done = grade(str(handed_in), "--out", str(out), "--only", *ASKED, "--jobs", "2", "--timeout", "60")
    assert done.returncode == 0, done.stderr
    got = rows(out)
    assert len(got) == len(part)

    def of(student: Student) -> dict[str, str]:
        return next(row for name, row in got.items() if student.name in name)

    wrong = {s.name: (s.points, of(s)) for s in part if tuple(int(of(s)[name]) for name in ASKED) != s.points}
    assert wrong == {}
    late = {s.name for s in part if "late" in of(s)["late"].lower()}
    assert late == ({s.name for s in part if s.is_late} if form == "canvas" else set())
    assert {path.suffix for path in (out / "feedback").iterdir()} == {".html"}
    assert len(list((out / "feedback").iterdir())) == len(part) + 1


@pytest.fixture
def small(tmp_path: Path) -> Path:
    """Two students: one all right, one not begun."""
    hand_in(tmp_path / "small/ada", CHAPTER, {"services-1": references(CHAPTER)["services-1"]})
    hand_in(tmp_path / "small/bob", CHAPTER, {})
    return tmp_path / "small"


def test_what_was_graded_is_used_again_as_long_as_nothing_changes(small: Path, tmp_path: Path):
    out = tmp_path / "grades"
    arguments = [str(small), "--out", str(out), "--only", "services-1"]
    first = grade(*arguments)
    assert first.returncode == 0, first.stderr
    assert {name: row["total"] for name, row in rows(out).items()} == {"ada": "2", "bob": "0"}
    kept = {path: path.stat().st_mtime_ns for path in (out / class_run.KEPT).iterdir()}
    pages = {path: path.read_bytes() for path in out.rglob("*") if path.suffix in (".html", ".csv", ".json")}
    assert grade(*arguments).returncode == 0
    assert {path: path.stat().st_mtime_ns for path in (out / class_run.KEPT).iterdir()} == kept
    assert {path: path.read_bytes() for path in pages} == pages
    hand_in(small / "bob", CHAPTER, {"services-1": "class Lamp:\n    pass"})
    assert grade(*arguments).returncode == 0
    assert len(list((out / class_run.KEPT).iterdir())) == len(kept) + 1


def test_ones_own_work_is_shown_and_the_status_tells_the_points(small: Path):
    done = grade(".", "--only", "services-1", folder=small / "ada")
    assert done.returncode == 0, done.stderr
    assert done.stdout.startswith("services-1 · A lamp: 2 of 2 points\n✔")
    done = grade(".", "--only", "services-1", folder=small / "bob")
    assert done.returncode == 1
    assert done.stdout.startswith("services-1 · A lamp: not begun")


@pytest.mark.parametrize(
    ("arguments", "says"),
    [
        (["nowhere", "--out", "grades"], "nowhere"),
        ([".", "--only", "services-9"], "there is no services-9 in the course"),
        ([".", "--only", "services-1", "--chapter", "topics"], "none of these exercises"),
        ([".", "--jobs", "0"], "1 or more"),
        ([".", "--timeout", "nan"], "from 1 to 86400"),
        ([".", "--only", "services-1", "--scheduler", "tcp://127.0.0.1:9"], "no scheduler of Dask answers"),
    ],
)
def test_what_cannot_be_graded_is_said_in_a_line(arguments: Sequence[str], says: str, small: Path):
    done = grade(*arguments, folder=small)
    assert done.returncode == 2
    assert says in done.stderr
    assert "Traceback" not in done.stderr


def test_without_bubblewrap_it_says_so_and_grades_all_the_same_unless_forbidden(small: Path, tmp_path: Path):
    (only := tmp_path / "bin").mkdir()
    for name in ("env", "prlimit", "sh"):
        (only / name).symlink_to(str(shutil.which(name)))
    arguments = [".", "--only", "services-1"]
    done = grade(*arguments, folder=small / "ada", PATH=str(only))
    assert done.returncode == 0, done.stdout + done.stderr
    assert f"protection: {sandbox.NOT_APART}" in done.stderr
    done = grade(*arguments, "--require-sandbox", folder=small / "ada", PATH=str(only))
    assert done.returncode == 2
    assert "nothing was graded, because there is no bubblewrap here" in done.stderr


def test_ctrl_c_ends_it_cleanly_and_the_next_run_goes_on(small: Path, tmp_path: Path):
    out = tmp_path / "grades"
    hand_in(small / "eve", CHAPTER, {"services-1": "import time\ntime.sleep(3600)"})
    command = [*COURSE, "grade", str(small), "--out", str(out), "--only", "services-1", "--jobs", "1"]
    with subprocess.Popen(command, stderr=subprocess.PIPE, stdout=subprocess.PIPE, text=True) as running:
        wait_until(lambda: len(list(out.glob("graded/*"))) >= 2, timeout=120)  # eve's is the last
        started = psutil.Process(running.pid).children(recursive=True)
        running.send_signal(signal.SIGINT)
        _, said = running.communicate(timeout=30)
    assert running.returncode == 130, said
    assert "goes on where this one was" in said
    assert "Traceback" not in said
    _, alive = psutil.wait_procs(started, timeout=10)
    assert alive == []
    assert not (out / "grades.csv").exists()


@pytest.mark.skipif(not sandbox.is_available(), reason="bubblewrap is not here, or may not make namespaces")
def test_two_that_are_graded_beside_each_other_do_not_meet(tmp_path: Path):
    look = """
import time
from rclpy.node import Node
from course_kit import run
seen = run(Node, "{name}")
time.sleep(8)
print(sorted(name for name in seen.get_node_names() if not name.startswith("_")))
"""
    for name in ("ada", "bob"):
        hand_in(tmp_path / name, CHAPTER, {"services-1": look.format(name=name)})
    found = handins.find(tmp_path, [NAME])
    works = [submission.read(one, [CHAPTERS[CHAPTER]], ["services-1"]) for one in found]
    results = class_run.ClassRun(Settings(60.0), 2).grade(works, lambda result: None)
    shown = {result.student: result.exercises[0].shown for result in results}
    assert "['ada']" in shown["ada"]
    assert "['bob']" in shown["bob"]


@pytest.fixture
def workers() -> Iterator[str]:
    """The address of a Dask cluster of two worker processes."""
    distributed = pytest.importorskip("distributed")
    cluster = distributed.LocalCluster(n_workers=2, threads_per_worker=1, processes=True, dashboard_address=None)
    yield cluster.scheduler_address
    with contextlib.suppress(TimeoutError):  # Dask gives the workers seconds to end, too few on a busy machine
        cluster.close()


def _grading_process() -> psutil.Process | None:
    """A child that runs a notebook now: between two notebooks a worker runs none."""
    for child in psutil.Process().children(recursive=True):
        with contextlib.suppress(psutil.Error):  # it has ended
            if any("run_nbval" in " ".join(below.cmdline()) for below in child.children()):
                return child
    return None


@SLOW
def test_a_cluster_grades_the_same_also_when_a_worker_is_killed(workers: str, tmp_path: Path):
    part = list(students(4))
    handed_in, out = exported(tmp_path / "handed in", "folders", part), tmp_path / "grades"
    command = [*COURSE, "grade", str(handed_in), "--out", str(out), "--only", *ASKED, "--scheduler", workers]
    with subprocess.Popen(command, stderr=subprocess.PIPE, stdout=subprocess.PIPE, text=True) as running:
        wait_until(lambda: len(list(out.glob("graded/*"))) >= 2, timeout=120)
        os.kill(wait_until(_grading_process, timeout=60).pid, signal.SIGKILL)
        _, said = running.communicate(timeout=600)
    assert running.returncode == 0, said
    got = rows(out)
    assert {s.name: tuple(int(got[s.name][name]) for name in ASKED) for s in part} == {s.name: s.points for s in part}


@pytest.mark.skipif(not sandbox.is_available(), reason="bubblewrap is not here, or may not make namespaces")
@SLOW
def test_nothing_of_it_is_left(small: Path, tmp_path: Path):
    with tempfile.TemporaryDirectory(dir="/tmp", prefix="left-") as own:  # others are graded beside it; a short name
        out = str(tmp_path / "grades")
        assert grade(str(small), "--out", out, "--only", "services-1", TMPDIR=own).returncode == 0
        assert os.listdir(own) == []
        running = psutil.process_iter(
            ["cmdline"]
        )  # what is in a sandbox ends with its bubblewrap, which names its folder
        assert [p for p in running if own in " ".join(p.info["cmdline"] or [])] == []
    assert json.loads((tmp_path / "grades/grades.json").read_text())["protection"] == sandbox.APART


@SLOW
def test_a_package_that_was_written_in_an_editor_is_built_and_counts(tmp_path: Path):
    """The answer cell is untouched; ros2_ws/src is handed in beside the notebook."""
    hand_in(tmp_path / "in/ada", "workspace", {})
    (src := tmp_path / "in/ada/ros2_ws/src").mkdir(parents=True)
    ros2 = Path(sys.executable).with_name("ros2")
    create = [str(ros2), "pkg", "create", "greeter", "--build-type", "ament_python", "--node-name", "greet"]
    subprocess.run([*create, "--license", "Apache-2.0"], cwd=src, check=True, capture_output=True, timeout=60)
    done = grade(str(tmp_path / "in"), "--out", str(tmp_path / "out"), "--only", "workspace-1", "workspace-2")
    assert done.returncode == 0, done.stderr
    got = rows(tmp_path / "out")["ada"]
    assert (got["workspace-1"], got["workspace-2"]) == ("2", "0")
