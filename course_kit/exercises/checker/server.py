"""The checker's loop: is asked, examines, answers; one request after the other, until the notebook has gone."""

from __future__ import annotations

import contextlib
import queue
import secrets
import signal
import threading
import traceback
from dataclasses import asdict
from pathlib import Path
from typing import Any

from course_kit.base.shutdown import watchdog
from course_kit.exercises import catalogue
from course_kit.exercises.checker import checks, examination, own_types
from course_kit.exercises.checker.examination import Ended, Examination, OutOfTime
from course_kit.exercises.checker.notebook import Notebook
from course_kit.exercises.checker.student_monitor import StudentDomainMonitor
from course_kit.exercises.domains import reserve_domain
from course_kit.exercises.exercise import Exercise
from course_kit.exercises.notebook_folder import WORKSPACE
from course_kit.exercises.protocol.channel import Channel, Closed, Message
from course_kit.exercises.protocol.verdict import IN_TIME, LOOKED_AT, NOT_BEGUN, NOT_LOOKED_AT, Finding, Verdict
from course_kit.ros.observing.domain_observer import DomainObserver

DISCOVERY_TIMEOUT = 3.0
LOG_TOPIC = "/rosout"
END_TIMEOUT = 3.0  # seconds for leaving both domains in good order
WATCHDOG = 1.0  # seconds after an exercise's time at which even a read that blocks is ended
SEEDS = 1_000_000


class Checker:
    """The checker of one notebook."""

    def __init__(self, channel: Channel) -> None:
        self._channel = channel
        self._requests: queue.Queue[Message | None] = queue.Queue()
        self._notebook = Notebook(channel)
        threading.Thread(target=self._read, name="requests", daemon=True).start()
        self.student = DomainObserver(None, only_here=False)
        self.test_domain = DomainObserver(reserve_domain(), only_here=True)
        self._monitor = StudentDomainMonitor(self.student)

    def _read(self) -> None:
        """Receive in a thread of its own, so that the notebook's end is seen whatever a check does."""
        with contextlib.suppress(Closed):
            while True:
                message = self._channel.receive()
                if message is not None:
                    (self._notebook.take if "answer" in message else self._requests.put)(message)
        watchdog.end_in(END_TIMEOUT, status=1)  # in case something hangs
        self._requests.put(None)

    def serve(self) -> None:
        """Answer requests until there are no more."""
        while (request := self._requests.get()) is not None:
            try:
                self._channel.send(self._answer_to(request))
            except Closed:
                break
        self.test_domain.close()
        self._monitor.close()
        self.student.close()

    def _answer_to(self, request: Message) -> Message:
        try:
            exercise = catalogue.find(str(request["check"]))
        except ValueError as error:
            return {"refused": str(error)}
        if request.get("value") is not None and not exercise.value:
            return {"refused": f'{exercise.name} takes no value: check("{exercise.name}")'}
        self._channel.send({"begun": exercise.timeout})
        seed = request.get("seed")
        seed = secrets.randbelow(SEEDS) if seed is None else int(seed)
        folder, pid = Path(request["folder"]), int(request["pid"])
        running = Examination(
            exercise, self.test_domain, self.student, self._monitor.watched, self._notebook, folder, seed, pid
        )
        return {"verdict": asdict(self.examine(running, request.get("value")))}

    def examine(self, running: Examination, value: Any) -> Verdict:
        """Check one exercise."""
        exercise = running.exercise
        state, note, drawn = LOOKED_AT, "", running.random.getstate()
        examination.begin(running)
        _watch_over(exercise.timeout + WATCHDOG)
        try:
            self._watch(exercise.chapter)
            if self._is_begun(running, value):
                self._provide_types(running)
                checks.find(exercise).judge(*([value] if exercise.value else []))
            else:
                state, note = NOT_BEGUN, _what_to_do(exercise)
        except Ended:
            pass
        except OutOfTime:
            what = f" Waited last for {running.waiting_for}." if running.waiting_for else ""
            hint = f"The check ends after {exercise.timeout:g} s.{what} Does a callback block, or loop without end?"
            running.findings.append(Finding(IN_TIME, False, hint))
        except own_types.Uncompiled as error:
            state, note = NOT_LOOKED_AT, f"The checker has no types of its own: {error}"
        except Closed:
            raise
        except Exception as error:
            state = NOT_LOOKED_AT
            note = f"The check itself failed, which is a mistake of the course: {error!r}"
            traceback.print_exc()
        finally:
            _watch_over(0.0)
            own_errors = [*self.test_domain.errors, *self.student.errors]
            examination.begin(None)
            self._tidy(running)
        findings = tuple(running.findings) if state == LOOKED_AT else ()
        if own_errors and not all(found.ok for found in findings):
            note = f"A part of the check itself failed, which may be why: {own_errors[0]!r}"
        has_drawn = state == LOOKED_AT and running.random.getstate() != drawn
        shown = running.seed if has_drawn else None
        return Verdict(exercise.name, exercise.title, exercise.points, state, findings, note, shown)

    def _tidy(self, running: Examination) -> None:
        with contextlib.suppress(Exception):
            running.ending.close()
        if running.exercise.node_class:
            self._notebook.order("stop", self.test_domain.domain, END_TIMEOUT)
        self.test_domain.tidy()
        self.student.tidy()

    def _is_begun(self, running: Examination, value: Any) -> bool:
        exercise = running.exercise
        if exercise.value and _says_something(value):
            return True
        if exercise.node_class and running.order("has", node_class=exercise.node_class).get("value"):
            return True
        if exercise.function and running.order("has function", function=exercise.function).get("value"):
            return True
        wanted, what = exercise.node_class or exercise.function, "class" if exercise.node_class else "function"
        if wanted and (why := running.order("missing", name=wanted).get("value")):
            running.judge(f"there is a {what} `{wanted}`", False, why)
        if exercise.file and (running.folder / WORKSPACE / "src" / exercise.file).is_file():
            return True
        if not exercise.node:
            return False
        self.student.known(DISCOVERY_TIMEOUT)
        if exercise.node not in self.student.their_nodes():
            return False
        if exercise.node_class:
            hint = f"A node {exercise.node} runs, but this notebook has no class `{exercise.node_class}`. "
            running.judge(f"there is a class `{exercise.node_class}`", False, f"{hint}The exercise asks for that name.")
        return True

    def _provide_types(self, running: Examination) -> None:
        """Have the types that the check speaks; its time begins after that."""
        for package in running.exercise.types:
            texts = own_types.own_texts(package, running.folder / WORKSPACE)
            is_ready = own_types.is_ready(package, texts)
            if not is_ready:
                says = f"The checker compiles {package} for itself. It does so once, in about ten seconds."
                self._channel.send({"begun": own_types.COMPILE_TIMEOUT, "says": says})
                _watch_over(own_types.COMPILE_TIMEOUT)
            own_types.provide(package, texts)
            if not is_ready:
                self._channel.send({"begun": running.exercise.timeout})
                running.begin_again()
                _watch_over(running.exercise.timeout + WATCHDOG)

    def _watch(self, chapter: str) -> None:
        """Listen to what the chapter's exercises watch, from now on."""
        for check in checks.of_chapter(chapter):
            for topic, message_type in check.watches.items():
                if topic == LOG_TOPIC:
                    self.student.node_log()
                else:
                    self._monitor.watch(topic, message_type)


def _watch_over(seconds: float) -> None:
    """Raise OutOfTime in this thread, the main one, after so long, whatever it waits for; 0: no longer."""

    def end(*_: Any) -> None:
        raise OutOfTime

    signal.signal(signal.SIGALRM, end)
    signal.setitimer(signal.ITIMER_REAL, seconds, 1.0)


def _says_something(value: Any) -> bool:
    """Return True if a value is more than the None, or the tuple of them, of an untouched answer cell."""
    return any(part is not None for part in value) if isinstance(value, list) and value else value is not None


def _what_to_do(exercise: Exercise) -> str:
    if exercise.node_class:
        return f"Write the class `{exercise.node_class}` into the cell above and run it, then run this one."
    if exercise.function:
        return f"Write the function `{exercise.function}` into the cell above and run it, then run this one."
    if exercise.value:
        return "Fill in the cell above and run it, then run this one."
    if exercise.file:
        return f"There is no {WORKSPACE}/src/{exercise.file}. Write the cell above and run it, then run this one."
    return f"No node {exercise.node} runs. Write the cell above and run it, then run this one."
