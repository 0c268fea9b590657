"""A plugin of nbval for graders: a check cell passes by the checker's verdict, and findings are written down.

`python -I -m pytest --nbval -p course_kit.classroom.run.nbval_plugin …` with the job's folder in COURSE_KIT_JOB. A line
of JSON says what begins, and one what was found: should all of it be killed, it is known where. See job.py.
"""

from __future__ import annotations

import json
import os
import shutil
import time
from collections.abc import Callable, Generator
from dataclasses import asdict
from pathlib import Path
from queue import Empty
from typing import Any

import pytest

from course_kit.classroom.plain_text import plain
from course_kit.classroom.rebuild import HANDED_IN
from course_kit.classroom.run.examiner import Examiner
from course_kit.classroom.run.job import BEGUN, CHECK_TIMEOUT, FOUND, JOB, LINES, SRC, Job
from course_kit.classroom.run.machine_load import Stall
from course_kit.exercises.notebooks.reference import ANSWER, CHECK, PREREQUISITE, mark_of

LONGEST_SHOWN = 2_000  # characters of what an answer's cell printed, for the student
KEPT_OUTPUT = 200_000  # characters of what a cell prints; the rest is dropped as it comes
POLL = 0.5  # seconds after which one looks whether the kernel still lives
GRACE = 15.0  # seconds that a cell may take more than its time: to be interrupted, and to say that it has ended


class Grading:
    """The grading of one notebook."""

    def __init__(self, folder: Path, timeout: float) -> None:
        self._timeout = timeout  # seconds of an answer's cell
        self._job = Job.from_json(json.loads((folder / JOB).read_text()))
        self._lines = open(folder / LINES, "a", buffering=1)  # noqa: SIM115  (closed in pytest_unconfigure)
        self._examiner = Examiner(self._job.socket, Path(self._job.work), self._job.additions)
        if (folder / SRC).is_dir():
            shutil.copytree(folder / SRC, Path(self._job.work, HANDED_IN))
        self._answer: dict[str, Any] = {}  # what the answer's cell did
        self._deadline = 0.0  # of the cell
        self._is_checked = False  # whether the cell is that of a check

    def _write(self, **line: Any) -> None:
        self._lines.write(json.dumps(line) + "\n")

    @pytest.hookimpl(trylast=True)
    def pytest_runtest_setup(self, item: Any) -> None:
        """Look at the kernel's life while waiting for it, and keep no flood; nbval has started it by now."""
        if not hasattr(item.parent.kernel, "is_watched"):
            _watch(item.parent.kernel, self._is_over)
        item.parent.kernel.printed = 0

    @pytest.hookimpl(wrapper=True)
    def pytest_runtest_protocol(self, item: Any) -> Generator[None, Any, Any]:
        """Run a cell; have the exercise of a check cell examined meanwhile."""
        mark, began = mark_of(item.cell), time.monotonic()
        role, exercise = mark.get("role"), mark.get("exercise", "")
        timeout = item.config.option.nbval_cell_timeout = self._timeout if role == ANSWER else CHECK_TIMEOUT
        self._deadline, self._is_checked = began + timeout + GRACE, role == CHECK
        item.parent.timed_out = False  # a cell that was interrupted costs the others nothing
        if role == ANSWER:
            self._write(**{BEGUN: exercise})
            self._answer = {"began": began, "stall": Stall()}
        elif role == CHECK:
            self._examiner.begin(exercise)
        done = yield
        kernel = item.parent.kernel
        if role == ANSWER:
            self._answer |= {"shown": shown(item), "is_interrupted": bool(item.parent.timed_out)}
        elif role == CHECK:
            self._write(**{FOUND: exercise, **self._found(item)})
        elif getattr(item, "failure", "") and role in (PREREQUISITE, None):
            self._write(failed=item.cell.id, shown=shown(item))
        is_silent = role == CHECK and getattr(item, "verdict", None) is None  # what it runs may be no check any more
        if kernel is None or not kernel.is_alive() or self._examiner.is_stuck or is_silent:
            item.session.shouldstop = "the kernel has ended"
        return done

    @pytest.hookimpl(wrapper=True)
    def pytest_runtest_makereport(self, item: Any, call: Any) -> Generator[None, Any, Any]:
        """Let a check cell's result be the verdict's."""
        report = yield
        if call.when == "call":
            item.failure = report.longreprtext if report.failed else ""
            item.is_ended = not item.parent.kernel.is_alive()  # after its last cell nbval ends it itself
            if mark_of(item.cell).get("role") == CHECK:
                item.verdict = self._examiner.end()
                is_full = item.verdict is not None and item.verdict.is_full
                report.outcome = "passed" if is_full else "failed"
                report.longrepr = None if is_full else str(item.verdict or "The kernel did not ask for its check.")
        elif report.failed:
            item.failure = report.longreprtext
        return report

    def _is_over(self) -> bool:
        """Return True if a cell that does not say that it has ended is waited for no longer."""
        return time.monotonic() > self._deadline or (self._is_checked and self._examiner.is_over)

    def _found(self, item: Any) -> dict[str, Any]:
        verdict = getattr(item, "verdict", None)
        answer, self._answer = self._answer, {}
        return {
            "verdict": None if verdict is None else asdict(verdict),
            "printed": "" if verdict is not None else shown(item),
            "shown": answer.get("shown", ""),
            "is_ended": getattr(item, "is_ended", True),
            "is_interrupted": answer.get("is_interrupted", False),
            "seconds": time.monotonic() - answer.get("began", time.monotonic()),
            "stalled": answer["stall"].share() if "stall" in answer else 0.0,
        }

    def pytest_unconfigure(self) -> None:
        """End the checker."""
        self._examiner.close()
        self._lines.close()


def _watch(kernel: Any, is_over: Callable[[], bool]) -> None:
    """Have a wait for a kernel's message end when the kernel or the cell's time does, and floods of output dropped."""
    plain, kernel.is_watched = kernel.get_message, True

    def get_message(stream: str, timeout: float | None = None) -> Any:
        deadline = time.monotonic() + (1e9 if timeout is None else timeout)
        while True:
            if is_over():
                raise RuntimeError("the cell did not say that it has ended")
            try:
                message = plain(stream, timeout=max(0.0, min(POLL, deadline - time.monotonic())))
            except Empty:
                if not kernel.is_alive():
                    raise RuntimeError("the kernel has ended") from None
                if time.monotonic() >= deadline:
                    raise
                continue
            return _shortened(message, kernel) if stream == "iopub" else message

    kernel.get_message = get_message


def _shortened(message: Any, kernel: Any) -> Any:
    content = message["content"]
    texts = [content, *([content["data"]] if isinstance(content.get("data"), dict) else [])]
    for place in texts:
        for name, value in place.items():
            if name not in ("execution_state", "name", "ename") and isinstance(value, str):
                place[name] = value[: max(0, KEPT_OUTPUT - kernel.printed)]
                kernel.printed += len(place[name])
    return message


def shown(item: Any) -> str:
    """What a cell printed, as text: streams, values, the last lines of an error; and why nbval gave up, if it did."""
    texts = []
    for output in item.test_outputs or []:
        if output.output_type == "stream":
            texts.append(output.text)
        elif output.output_type == "error":
            texts.append("\n".join(output.traceback[-3:]))
        else:
            texts.append(str(output.get("data", {}).get("text/plain", "")))
    failure = getattr(item, "failure", "")
    if failure and not any(output.output_type == "error" for output in item.test_outputs or []):
        texts.append(failure.splitlines()[-1])
    text = plain("\n".join(text.rstrip("\n") for text in texts if text))
    return text if len(text) <= LONGEST_SHOWN else f"{text[: LONGEST_SHOWN // 2]}\n…\n{text[-LONGEST_SHOWN // 2 :]}"


def pytest_configure(config: pytest.Config) -> None:
    """Begin the job."""
    grading = Grading(Path(os.environ["COURSE_KIT_JOB"]), config.option.nbval_cell_timeout)
    config.pluginmanager.register(grading, "course-grading")
