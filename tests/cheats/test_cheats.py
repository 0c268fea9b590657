"""Each cheat is graded by the real grader in its sandbox: it gets what it has earned, and nothing is left of it."""

from __future__ import annotations

import contextlib
import csv
import socket
import tempfile
import threading
from collections.abc import Iterator, Sequence
from pathlib import Path

import psutil  # type: ignore[import-untyped]
import pytest

from course_kit.base.polling import wait_until
from course_kit.classroom.collect import handins
from course_kit.classroom.report import feedback, gradebook
from course_kit.classroom.report import table as tables
from course_kit.classroom.report.gradebook import plain
from course_kit.classroom.results import StudentResult
from course_kit.classroom.run import notebook_run, sandbox, submission
from course_kit.classroom.run.class_run import ClassRun
from course_kit.classroom.run.notebook_run import Settings
from course_kit.exercises.notebooks.reference import chapters
from tests.cheats import cheats_kernel, cheats_machine, cheats_messages, cheats_notebook, cheats_ros
from tests.cheats.cheat import CANARY, ESCAPED, LEFT_BEHIND, PORT, Cheat, reference
from tests.cheats.cheats_notebook import HandedIn

pytestmark = [
    pytest.mark.skipif(not sandbox.is_available(), reason="there is no bubblewrap that can make sandboxes"),
    pytest.mark.by_turns("a grading for each", of="cases"),
]
CHAPTERS = {chapter.name: chapter for chapter in chapters()}
ALL = [*cheats_kernel.CHEATS, *cheats_messages.CHEATS, *cheats_ros.CHEATS, *cheats_machine.CHEATS]
SLOW = pytest.mark.slow("each cheat is one grading, of 7 s and more")
MOST_MEMORY = 300 << 20
CHOSEN = {"chooses_the_seed": 4711}  # by a cheat, of which another one must have counted


def _params(cheats: Sequence[Cheat | HandedIn]) -> list[object]:
    """Each cheat, with its time; it is a group of its own."""

    def marks(each: Cheat | HandedIn) -> list[pytest.MarkDecorator]:
        made = [pytest.mark.timeout(each.seconds), pytest.mark.xdist_group(f"cheat {each.name}")]
        if isinstance(each, HandedIn) or not each.mostly_waits:
            made.append(pytest.mark.cpu_bound)
        return made if each.by_default else [*made, SLOW]

    return [pytest.param(each, id=each.name, marks=marks(each)) for each in cheats]


@pytest.fixture(autouse=True)
def own_temporary_folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    """Other gradings run beside this one; the name is short, for sockets lie in it. `tmp_path` lies elsewhere."""
    with tempfile.TemporaryDirectory(dir="/tmp", prefix="cheat-") as made:
        monkeypatch.setattr(tempfile, "tempdir", made)
        yield


@pytest.fixture
def host(tmp_path: Path) -> Iterator[dict[str, str]]:
    """What is on this machine and no answer may get at: a file, and ports at which nobody may call."""
    (canary := tmp_path / "canary").write_text("not for students")
    called: list[object] = []
    with contextlib.ExitStack() as stack:
        ends = [stack.enter_context(socket.socket(family)) for family in (socket.AF_INET, socket.AF_UNIX)]
        ends[0].bind(("0.0.0.0", 0))
        port = ends[0].getsockname()[1]
        ends[1].bind(f"\0course-cheat-{port}")
        for end in ends:
            end.listen()
            threading.Thread(target=_note_calls, args=(end, called), daemon=True).start()
        yield {CANARY: str(canary), PORT: str(port)}
        for end in ends:
            end.shutdown(socket.SHUT_RDWR)
    assert not called
    assert canary.read_text() == "not for students"


def _note_calls(end: socket.socket, called: list[object]) -> None:
    with contextlib.suppress(OSError):
        while True:
            called.append(end.accept())


@contextlib.contextmanager
def _nothing_left() -> Iterator[None]:
    """After it, no process and no folder of a grading is there."""
    before, memory = _processes(), psutil.Process().memory_info().rss
    yield
    assert psutil.Process().memory_info().rss - memory < MOST_MEMORY  # the grader's own, outside of the sandbox
    assert wait_until(lambda: not _processes() - before, 5.0), [_command(pid) for pid in _processes() - before]
    assert not list(Path(tempfile.gettempdir()).glob("course-grading-*"))


def _processes() -> set[int]:
    """Those that this one has started, and those of cheats, whosever children they are."""
    ours = {each.pid for each in psutil.Process().children(recursive=True) if "orphans.py" not in _command(each.pid)}
    return ours | {pid for pid in psutil.pids() if LEFT_BEHIND in _command(pid)}


def _command(pid: int) -> str:
    with contextlib.suppress(psutil.Error):
        return " ".join(psutil.Process(pid).cmdline())
    return ""


def _publish(results: Sequence[StudentResult], folder: Path) -> None:
    """Write gradebook and feedback: whatever a student has brought in, both can be written and do no harm."""
    for result in results:
        assert (tables.verdicts(result) + tables.line(result)).encode()
    gradebook.write(results, folder, "Cheats")
    feedback.write(results, folder, "Cheats")
    for path in folder.rglob("*.csv"):
        with open(path, newline="", encoding="utf-8-sig") as file:
            cells = [cell for row in csv.reader(file) for cell in row]
        assert not [cell for cell in cells if cell.startswith(("=", "+", "@", "\t", "\r"))], path
        assert not [cell for cell in cells if cell.startswith("-") and not cell[1:].replace(".", "").isdigit()], path
    for path in folder.rglob("*.html"):
        assert "<script>alert" not in path.read_text(), path


@pytest.mark.parametrize("cheat", _params(ALL))
def test_a_cheat_gets_what_it_has_earned(cheat: Cheat, host: dict[str, str], tmp_path: Path) -> None:
    source = cheat.source
    for placeholder, text in host.items():
        source = source.replace(placeholder, text)
    chapter = CHAPTERS[cheat.exercise.rpartition("-")[0]]
    sources = {cheat.exercise: source} if source else {}
    if cheat.honest:
        sources[cheat.honest] = reference(cheat.honest)
    workspace = {path: text.encode() for path, text in cheat.workspace.items()}
    asked = (cheat.exercise, *([cheat.honest] if cheat.honest else []))
    with _nothing_left():
        found = notebook_run.grade(chapter, sources, asked, Settings(timeout=cheat.timeout), workspace)
    results = {name: one.result for name, one in found.items()}
    told = f"{results[cheat.exercise].verdict}\n{results[cheat.exercise].shown}"
    print(
        f"{cheat.name}: {results[cheat.exercise].verdict.points} points\n{plain(told[:3000])}"
    )  # for who reads the table
    _publish([StudentResult("cheat", tuple(results[name] for name in asked))], tmp_path / "grades")
    assert results[cheat.exercise].verdict.points == cheat.points, told
    if cheat.honest:
        assert results[cheat.honest].verdict.is_full, f"{results[cheat.honest].verdict}\n{results[cheat.honest].shown}"
    assert ESCAPED not in told
    assert cheat.says in told
    assert results[cheat.exercise].verdict.seed != CHOSEN.get(cheat.name, -1)


@pytest.mark.parametrize("handed_in", _params(cheats_notebook.CHEATS))
def test_what_is_done_to_a_hand_in_scores_nothing(handed_in: HandedIn, tmp_path: Path) -> None:
    folder, grades = tmp_path / "handed-in", tmp_path / "grades"
    folder.mkdir()
    handed_in.write(folder)
    before = {path for path in tmp_path.rglob("*") if not path.is_relative_to(folder)}
    chapters = list(CHAPTERS.values())
    with _nothing_left():
        found = handins.find(folder, [chapter.file for chapter in chapters])
        submissions = [submission.read(one, chapters, handed_in.asked) for one in found]
        results = ClassRun(Settings(timeout=20.0), 1, grades).grade(submissions, lambda result: None)
    points = {result.student: result.points for result in results}
    print(points, *(note for result in results for note in result.notes), sep="\n")
    assert before == {p for p in tmp_path.rglob("*") if not (p.is_relative_to(folder) or p.is_relative_to(grades))}
    _publish(results, grades)
    assert points == handed_in.points
    notes = "\n".join(note for result in results for note in result.notes)
    assert handed_in.told in notes
