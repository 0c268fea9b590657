"""The notebook's end of the checker: starts it once, asks, obeys meanwhile, and replaces one that is stuck."""

from __future__ import annotations

import atexit
import contextlib
import os
import sys
import threading
import time
from collections.abc import Mapping
from multiprocessing import Pipe
from multiprocessing.connection import Client
from pathlib import Path
from typing import Any

import rclpy

from course_kit.base.long_tasks import LongTask, long_task
from course_kit.base.programs.child_process import Process
from course_kit.exercises.in_notebook import answer_host, checker_environment
from course_kit.exercises.protocol.channel import Channel, Closed, Message, TooLong
from course_kit.exercises.protocol.verdict import GRADED, NOT_LOOKED_AT, Verdict

START_TIMEOUT = 20.0  # seconds until the checker answers at all
GRADER = "COURSE_KIT_GRADER"  # names the socket of a grader's checker, in the environment that a kernel starts with
GRACE = 6.0  # seconds that a check may take more than its exercise says: discovery before, tidying after


class Refused(ValueError):  # noqa: N818  (reads as what happened)
    """The question makes no sense: no such exercise, or a value where none is asked for."""


class Stuck(RuntimeError):  # noqa: N818
    """The checker did not answer in time, or ended."""


class CheckerProcess:
    """The checker's process."""

    def __init__(self, domain: int | None, additions: Mapping[str, str] | None = None) -> None:
        """`domain`: the one in which the notebook's nodes are; `additions` to the checker's environment."""
        ours, theirs = Pipe()
        with theirs:
            # Isolated, with an environment of its own and in the root folder: nothing of a student's is loaded there.
            environment, paths = checker_environment.of_checker(checker_environment.at_start(), domain)
            environment |= additions or {}
            self.domain = environment[checker_environment.DOMAIN]
            command = [sys.executable, "-I", "-m", "course_kit.exercises.checker", str(theirs.fileno()), *paths]
            self.process = Process(
                command, "checker", environment, Path("/"), in_terminal=False, hand_over=[theirs.fileno()]
            )
        self.process.begin()
        self.channel = Channel(ours)

    @property
    def pid(self) -> int | None:
        """The process, if it runs."""
        return self.process.pid if self.process.is_running else None

    def close(self, patience: float) -> None:
        """End it: it leaves ROS in good order when the connection closes, and is killed if it does not."""
        self.channel.close()
        with contextlib.suppress(TimeoutError):
            self.process.wait(patience)
            return
        self.process.stop(0.1)


class GradersChecker:
    """The checker of a grader, which listens at a socket and keeps the verdicts to itself."""

    domain = ""  # it is where the grader has started it
    pid = None

    def __init__(self, address: str) -> None:
        try:
            self.channel = Channel(Client(address, "AF_UNIX"))
        except OSError as error:
            raise Refused(f"the grader cannot be reached at {address}: {error.strerror}") from None

    def close(self, patience: float) -> None:
        """Leave it."""
        self.channel.close()


class _Conversation:
    """A question to a checker, and what it orders meanwhile."""

    def __init__(self, channel: Channel, task: LongTask) -> None:
        self._channel, self._task = channel, task

    def ask(self, exercise: str, value: Any, names: Mapping[str, Any], seed: int | None) -> Verdict:
        """Have an exercise checked. Raises Refused, or Stuck."""
        try:
            place = {"folder": os.getcwd(), "pid": os.getpid()}
            self._channel.send({"check": exercise, "value": value, "seed": seed, **place})
            return self._converse(names)
        except TooLong as error:
            raise Refused(f"the value cannot be checked: {error}") from None
        except Closed:
            raise Stuck("the checker has ended") from None

    def _converse(self, names: Mapping[str, Any]) -> Verdict:
        deadline = time.monotonic() + START_TIMEOUT
        while (left := deadline - time.monotonic()) > 0:
            message = self._channel.receive(left)
            if message is None:
                break
            if "order" in message:
                self._obey(message, names)
            elif "begun" in message:
                deadline = time.monotonic() + float(message["begun"]) + GRACE
                self._task.begin_again(float(message["begun"]))
                if "says" in message:  # of what has to be done once, and takes a while
                    print(message["says"], flush=True)
            elif "refused" in message:
                raise Refused(str(message["refused"]))
            elif "verdict" in message:
                return Verdict.from_json(message["verdict"])
            elif "graded" in message:
                return Verdict(str(message["graded"]), str(message["title"]), 0, GRADED)
        raise Stuck("the checker did not answer in time")

    def _obey(self, order: Message, names: Mapping[str, Any]) -> None:
        answer = answer_host.obey(order, names, float(order["timeout"]))
        try:
            self._channel.send({"answer": order["order"], **answer})
        except TooLong as error:
            self._channel.send({"answer": order["order"], "error": f"what it gave cannot be looked at: {error}"})


_checker: CheckerProcess | GradersChecker | None = None
_lock = threading.Lock()


def ask(exercise: str, value: Any, names: Mapping[str, Any], seed: int | None = None) -> Verdict:
    """Have an exercise checked by the checker of this process, which is started if there is none that answers.

    `names` are the notebook's variables, `seed` is that of a verdict to be repeated.
    Raises Refused for a question that makes no sense.
    """
    with _lock, long_task(f"checking {exercise}", at_most=True) as task:
        reason = ""
        for _ in range(2):
            try:
                return _Conversation(_running().channel, task).ask(exercise, value, names, seed)
            except Stuck as stuck:
                reason = str(stuck)
                _replace()
            except Refused:
                raise
            except BaseException:  # interrupted: what it is doing now is unknown
                _replace()
                raise
        return Verdict(exercise, "", 0, NOT_LOOKED_AT, note=f"Twice {reason}. Restart the kernel and try again.")


def pid() -> int | None:
    """The process of the checker, if it runs."""
    return _checker.pid if _checker is not None else None


def _running() -> CheckerProcess | GradersChecker:
    global _checker
    if grader := checker_environment.at_start().get(GRADER):
        if _checker is None:
            _checker = GradersChecker(grader)
        return _checker
    domain = rclpy.get_default_context().get_domain_id() if rclpy.ok() else None
    is_elsewhere = _checker is not None and domain is not None and str(domain) != _checker.domain
    if _checker is not None and (is_elsewhere or _checker.pid is None):
        _replace()
    if _checker is None:
        _checker = CheckerProcess(domain)
        atexit.unregister(close)
        atexit.register(close)
    return _checker


def _replace() -> None:
    """End the checker at once; the next question starts another."""
    close(patience=0.0)
    with contextlib.suppress(Exception):
        answer_host.close()


def close(patience: float = 4.0) -> None:
    """End the checker, if it runs."""
    global _checker
    ending, _checker = _checker, None
    if ending is not None:
        ending.close(patience)
