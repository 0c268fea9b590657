"""A rebuilt notebook run with nbval in a sandbox, as often as it takes until each of its exercises has its verdict.

An answer that ends its kernel, or all of the sandbox, costs its own points; the others are run again without it.
"""

from __future__ import annotations

import contextlib
import json
import os
import shutil
import sys
import tempfile
import threading
import time
from collections.abc import Collection, Iterator, Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import nbformat
import psutil  # type: ignore[import-untyped]

from course_kit.base.programs.child_process import Process
from course_kit.classroom.rebuild import rebuilt
from course_kit.classroom.results import ExerciseResult
from course_kit.classroom.run import memory_use, sandbox
from course_kit.classroom.run.domains import a_domain
from course_kit.classroom.run.job import BEGUN, CHECK_TIMEOUT, FOUND, JOB, LINES, SRC, Job
from course_kit.classroom.run.sandbox import IN_SANDBOX, Limits, Places
from course_kit.exercises.checker.workspace_terminal import CONFINED
from course_kit.exercises.in_notebook import checker_client, checker_environment
from course_kit.exercises.notebooks.reference import Chapter, Task
from course_kit.exercises.protocol.verdict import IN_TIME, NOT_BEGUN, NOT_LOOKED_AT, Finding, Verdict

KERNEL = "graded"
# What a kernel writes past its cells is nobody's.
QUIET = ("sh", "-c", 'exec "$@" > /dev/null 2>&1', "sh")
SHARED_OVER = "All was ended because too much memory was in files of no disk, here or beside it"
TIME_OVER = "All was ended because the time was over"
LONGEST_BASE = 60  # characters: the address of a socket has 107 at most
POLL = 0.1  # seconds from one look at what the sandbox uses to the next
START = 90.0  # seconds that a kernel, the checker and the prerequisites have besides the cells
stop = threading.Event()  # set: whatever runs here ends, and nothing else begins
TRIES = 2  # of a notebook whose first cells fail, which is none of the student's doing


class Stopped(Exception):  # noqa: N818  (reads as what happened)
    """Grading was ended before its end."""


@dataclass(frozen=True)
class Settings:
    """How notebooks are run."""

    timeout: float = 120.0  # seconds of an answer's cell
    limits: Limits = field(default_factory=Limits)
    is_apart: bool = True  # in sandboxes


@dataclass(frozen=True)
class Found:
    """What one exercise came to, and whether the machine was too busy for it to count yet."""

    result: ExerciseResult
    stalled: float = 0.0  # the share of its time in which processes waited for a processor
    is_late: bool = False  # whether it did not come to an end in time


def grade(
    chapter: Chapter,
    sources: Mapping[str, str],
    only: Collection[str],
    settings: Settings,
    workspace: Mapping[str, bytes] | None = None,
) -> dict[str, Found]:
    """Grade these exercises of a chapter; the answers to others are run, too, for one may build on another."""
    tasks = {task.name: task for task in chapter.tasks}
    # Who has handed a workspace in may have solved an exercise with an editor and a terminal.
    begun_ones = set(tasks if workspace else sources)
    found = {name: Found(ExerciseResult(_verdict(tasks[name], NOT_BEGUN))) for name in only if name not in begun_ones}
    kept, left = dict(sources), [name for name in tasks if name in only and name in begun_ones]
    # One whose kernel ended, or checked no more, is tried alone: it may have been an earlier answer's doing.
    failures, alone, tried = 0, "", set[str]()
    while left:
        answers, asked = ({alone: kept[alone]}, [alone]) if alone in kept else (kept, left)
        with _Run(chapter, answers, asked, settings, workspace or {}) as run:
            run.wait()
            lines, why = run.lines(), run.why
        done = {line[FOUND]: line for line in lines if FOUND in line}
        begun = [line[BEGUN] for line in lines if BEGUN in line]
        silent = [name for name, line in done.items() if line["verdict"] is None or line["is_ended"]]
        lost = next(iter([*(name for name in begun[-1:] if name not in done), *silent]), "")
        if lost in left and lost in kept and len(answers) > 1 and lost not in tried:
            done.pop(lost, None)
            tried.add(alone := lost)
        else:
            alone = ""
            kept.pop(lost, None)
            if lost and lost not in done and lost not in found:
                found[lost] = Found(ExerciseResult(_ended(tasks[lost], why)), is_late=why in (TIME_OVER, SHARED_OVER))
        found |= {name: _found(tasks[name], line, settings.timeout) for name, line in done.items()}
        failures += not begun
        left = [name for name in left if name not in found]
        if failures == TRIES:
            shown = "; ".join(str(line.get("shown", "")) for line in lines if "failed" in line) or why
            note = f"The cells that the exercises stand on did not run: {shown}"
            not_run = {name: ExerciseResult(_verdict(tasks[name], NOT_LOOKED_AT, note)) for name in left}
            found |= {name: Found(result, is_late=True) for name, result in not_run.items()}
            break
    return found


def _verdict(task: Task, state: str, note: str = "") -> Verdict:
    return Verdict(task.name, task.title, task.points, state, note=note)


def _ended(task: Task, why: str) -> Verdict:
    finding = Finding("its cells run to their end", False, f"{why or 'The kernel ended'} while they ran.")
    return Verdict(task.name, task.title, task.points, findings=(finding,))


def _found(task: Task, line: Mapping[str, Any], timeout: float) -> Found:
    if line["verdict"] is not None:
        verdict = Verdict.from_json(line["verdict"])
    else:
        hint = f"It said: {line['printed']}" if line["printed"] else "The kernel did not ask for it."
        verdict = Verdict(task.name, task.title, task.points, findings=(Finding("its check runs", False, hint),))
    if line["is_interrupted"]:
        note = f"The cell of the answer did not end within {timeout:g} s, and was interrupted. {verdict.note}"
        verdict = replace(verdict, note=note.strip())
    is_late = verdict.state == NOT_LOOKED_AT or any(f.text == IN_TIME and not f.ok for f in verdict.findings)
    return Found(ExerciseResult(verdict, line["shown"], line["seconds"]), line["stalled"], is_late)


class _Run:
    """One run of a notebook."""

    def __init__(
        self,
        chapter: Chapter,
        sources: Mapping[str, str],
        only: Collection[str],
        settings: Settings,
        workspace: Mapping[str, bytes],
    ) -> None:
        self._settings = settings
        self._stack = contextlib.ExitStack()
        self._in_files = memory_use.in_files()
        self.why = ""  # what ended it, if it did not end by itself
        outside = Path(self._stack.enter_context(_folder()))
        self._job = outside / "job"
        for name in ("job", "work/notebooks", "work/home", "work/tmp", "run"):
            (outside / name).mkdir(parents=True)
        places = IN_SANDBOX if settings.is_apart else Places(self._job, outside / "work", outside / "run")
        domain = 1 if settings.is_apart else self._stack.enter_context(a_domain())
        environment, paths = checker_environment.of_checker(checker_environment.at_start(), domain)
        self._write(chapter, sources, only, places, environment, paths, workspace)
        self._deadline = time.monotonic() + START + settings.timeout * len(sources) + CHECK_TIMEOUT * len(only)
        command = [
            sys.executable,
            "-I",
            "-m",
            "course_kit.classroom.run.run_nbval",
            *paths,
            "--",
            *self._pytest(places, chapter),
        ]
        if settings.is_apart:
            command = [*sandbox.outer(self._job, settings.limits), *command]
        # In TMPDIR lies the connection file, which the kernel must be able to read.
        trusted = {"HOME": "/tmp", "TMPDIR": str(places.run)} if settings.is_apart else {}
        trusted |= {"JUPYTER_PATH": str(places.job / "jupyter"), "COURSE_KIT_JOB": str(places.job)}
        trusted["PYTEST_DISABLE_PLUGIN_AUTOLOAD"] = "1"  # others that are installed take half a second to load
        self._process = Process(command, "grading", {**environment, **trusted}, self._job, in_terminal=False)
        self._process.begin()

    def _pytest(self, places: Places, chapter: Chapter) -> list[str]:
        notebook = str(places.job / chapter.file)
        return [
            *("-p", "nbval.plugin", "-p", "course_kit.classroom.run.nbval_plugin", "-p", "no:cacheprovider", "-q"),
            *("--nbval", notebook, "--rootdir", str(places.job), "-c", "/dev/null", "--tb=line", "--color=no"),
            *("--nbval-kernel-name", KERNEL, "--nbval-cell-timeout", str(self._settings.timeout)),
        ]

    def _write(
        self,
        chapter: Chapter,
        sources: Mapping[str, str],
        only: Collection[str],
        places: Places,
        environment: Mapping[str, str],
        paths: list[str],
        workspace: Mapping[str, bytes],
    ) -> None:
        """Put into the job's folder what the processes need."""
        nbformat.write(rebuilt(chapter, sources, only, bool(workspace)), self._job / chapter.file)
        home, limits = {"HOME": str(places.work / "home"), "TMPDIR": str(places.work / "tmp")}, self._settings.limits
        ours = {name: value for name, value in environment.items() if name not in ("HOME", "TMPDIR")}
        ours |= {**home, "USER": "student", checker_client.GRADER: str(places.socket)}
        if paths:
            ours["PYTHONPATH"] = os.pathsep.join(paths)
        kernel = [sys.executable, "-m", "ipykernel_launcher", "-f", "{connection_file}"]
        confined = sandbox.limited(limits)
        if self._settings.is_apart:
            kernel = [*sandbox.inner(places, ours, limits), *QUIET, *kernel]
            confined = sandbox.inner(places, home, limits, only=False)
        else:
            settings = [f"{name}={value}" for name, value in ours.items()]
            into = ["sh", "-c", 'cd "$1" && shift && exec "$@"', "sh", str(places.work / "notebooks")]
            kernel = ["env", "-i", *settings, *confined, *into, *QUIET, *kernel]
        spec = {"argv": kernel, "display_name": KERNEL, "language": "python", "interrupt_mode": "message"}
        folder = self._job / "jupyter/kernels" / KERNEL
        folder.mkdir(parents=True)
        (folder / "kernel.json").write_text(json.dumps(spec))
        additions = {CONFINED: json.dumps(confined), **({"TMPDIR": "/tmp"} if self._settings.is_apart else {})}
        job = Job(str(places.socket), str(places.work / "notebooks"), additions)
        (self._job / JOB).write_text(json.dumps(job.to_json()))
        for path, data in workspace.items():
            (file := self._job / SRC / path).parent.mkdir(parents=True, exist_ok=True)
            file.write_bytes(data)

    def wait(self) -> None:
        """Wait for its end; end it where it uses more than it may."""
        while self._process.is_running and not self.why:
            if stop.is_set():
                raise Stopped
            self.why = self._excess()
            if not self.why:
                with contextlib.suppress(TimeoutError):
                    self._process.wait(POLL)

    def _excess(self) -> str:
        """What it uses more of than it may, in words; nothing if it does not."""
        limits, processes = self._settings.limits, list[psutil.Process]()
        with contextlib.suppress(psutil.Error):
            processes = psutil.Process(self._process.pid).children(recursive=True)
        if len(processes) > limits.processes:
            return f"All was ended because there were more than {limits.processes} processes"
        more_in_files = memory_use.in_files() - self._in_files  # of the whole machine
        memory = memory_use.of(processes) + (memory_use.of_files(processes) if more_in_files > limits.memory / 2 else 0)
        if memory > limits.memory:
            return f"All was ended because more than {limits.memory / sandbox.MB:.0f} MB of memory were used"
        # Whose it is cannot be told: what is ended wrongly is tried again.
        if more_in_files > 2 * limits.memory:
            return SHARED_OVER
        if time.monotonic() > self._deadline:
            return TIME_OVER
        return ""

    def lines(self) -> list[dict[str, Any]]:
        """What was written down."""
        lines = []
        with contextlib.suppress(FileNotFoundError, ValueError):  # killed before the first, or within the last
            for line in (self._job / LINES).read_text().splitlines():
                lines.append(json.loads(line))
        if not lines and not self.why:
            self.why = " / ".join(self._process.lines[-5:])
        return lines

    def __enter__(self) -> _Run:
        return self

    def __exit__(self, *_: Any) -> None:
        self._process.stop(0.1)
        self._stack.close()


@contextlib.contextmanager
def _folder() -> Iterator[str]:
    """A private folder that goes, whatever a student has done to the rights of what lies in it."""
    base = tempfile.gettempdir()
    made = tempfile.mkdtemp(prefix="course-grading-", dir=base if len(base) < LONGEST_BASE else "/tmp")
    try:
        yield made
    finally:
        for place, folders, _ in os.walk(made):
            for name in folders:
                if not os.path.islink(folder := os.path.join(place, name)):
                    with contextlib.suppress(OSError):
                        os.chmod(folder, 0o700)
        shutil.rmtree(made, ignore_errors=True)
