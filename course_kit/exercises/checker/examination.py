"""The check that runs now: what it has found, what time is left, and the two domains it looks at."""

from __future__ import annotations

import os
import time
from collections.abc import Callable
from contextlib import ExitStack
from dataclasses import dataclass, field
from pathlib import Path
from random import Random
from typing import Any

from course_kit.base.polling import wait_until
from course_kit.exercises.checker.notebook import Notebook
from course_kit.exercises.checker.student_monitor import WatchedTopic
from course_kit.exercises.exercise import Exercise
from course_kit.exercises.notebook_folder import beside_the_notebook
from course_kit.exercises.protocol.verdict import Finding
from course_kit.ros.observing.domain_observer import DomainObserver
from course_kit.ros.subscriptions import topics

POLL = 0.005
ORDER_TIMEOUT = 3.0  # seconds for what the notebook's side does at once, even on a busy machine
LONGEST_HINT = 3_000  # characters: a student's value may be in it


class Ended(Exception):  # noqa: N818  (reads as what happened)
    """Nothing more can be seen: what must hold first does not."""


class OutOfTime(Exception):  # noqa: N818
    """The time of the exercise is over."""


@dataclass
class Examination:
    """One check of one exercise."""

    exercise: Exercise
    test_domain: DomainObserver  # in a domain of the checker's, where a student's class is made anew
    student: DomainObserver  # in the domain in which the student's nodes run
    watched: dict[str, WatchedTopic]  # what was heard in the student's domain since the chapter's first check, by topic
    notebook: Notebook
    folder: Path = Path("/")  # the kernel's; then the notebook's
    seed: int = 0  # of all that the check draws
    pid: int = field(default_factory=os.getpid)  # the process in which a student's class is made
    ending: ExitStack = field(default_factory=ExitStack)  # what ends with it, besides what the observers know
    programs: list[int] = field(default_factory=list)  # the ids of the processes that it has started
    findings: list[Finding] = field(default_factory=list)
    waiting_for: str = ""
    only_for_the_answer: set[str] = field(default_factory=set)  # names, as DDS has them, that no stranger may have

    def __post_init__(self) -> None:
        self.folder = beside_the_notebook(self.folder)
        self.random = Random(self.seed)
        self.begin_again()

    def begin_again(self) -> None:
        """Let the exercise's time begin now."""
        self._deadline = time.monotonic() + self.exercise.timeout

    # What was found.

    def judge(self, text: str, ok: Any, hint: str = "", points: int = 0, needed: bool = False) -> bool:
        """Note one finding. What has no points, or is `needed`, must hold: else the check ends here."""
        if strangers := self.test_domain.strangers(*self.only_for_the_answer):
            self._refuse(strangers)
        holds = bool(ok)
        finding = Finding(text, holds, "" if holds else self._with_errors(hint)[:LONGEST_HINT], points)
        if points or not holds or finding not in self.findings:  # what must hold for each of two nodes is said once
            self.findings.append(finding)
        if not holds and (needed or points == 0):
            raise Ended
        return holds

    def _refuse(self, strangers: list[str]) -> None:
        # An end is known a little before the node that it belongs to.
        wait_until(lambda: topics.UNNAMED not in self.test_domain.strangers(*self.only_for_the_answer), 1.0)
        strangers = self.test_domain.strangers(*self.only_for_the_answer) or strangers
        text = "only your node takes part"
        hint = (
            f"{', '.join(strangers)} of another process or context has an end of the exercise's topics, services or "
            "actions in the check's own domain: what the check sees would not be your node's. End it."
        )
        self.findings.append(Finding(text, False, hint))
        raise Ended

    def _with_errors(self, hint: str) -> str:
        """The hint, and before it what a callback of the student's raised: that is the cause more often than not."""
        errors = (self.order("errors").get("value") if self.exercise.node_class else None) or []
        return f"{errors[-1]}\n    {hint}".strip() if errors else hint

    # What time is left.

    @property
    def left(self) -> float:
        """Seconds until the exercise's time is over; negative after that."""
        return self._deadline - time.monotonic()

    def wait(self, condition: Callable[[], Any], timeout: float, what: str = "", poll: float = POLL) -> bool:
        """Wait until a condition holds; whether it did. Raises OutOfTime when the exercise's time is over."""
        self.waiting_for = what

        def holds() -> bool:
            if not (value := condition()) and self.left <= 0:
                raise OutOfTime
            return bool(value)

        return wait_until(holds, timeout, poll)

    # The notebook's side.

    def order(self, do: str, timeout: float = ORDER_TIMEOUT, **details: Any) -> dict[str, Any]:
        """Have the notebook do something; its answer has a `value` or an `error`."""
        return self.notebook.order(do, self.test_domain.domain, max(0.1, min(timeout, self.left)), **details)


_current: Examination | None = None


def begin(examination: Examination | None) -> None:
    """Make this examination the one that assertions are about; None after its end."""
    global _current
    _current = examination


def current() -> Examination:
    """The examination that runs."""
    if _current is None:
        raise RuntimeError("what a check expects can only be said while the checker runs it")
    return _current
