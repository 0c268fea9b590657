"""`ros2 daemon`: start, status, stop, for scripts that call them. No daemon is started: none is needed here."""

from __future__ import annotations

from argparse import Namespace

from course_kit.cli.ros2.session import Session
from course_kit.cli.ros2.verbs import Verb, flag

WHY = "No daemon is needed here: each ros2 command waits until it knows the whole graph by itself."


def _start(args: Namespace, session: Session) -> None:
    session.print("The daemon has been started")
    session.warn(f"That is said for scripts only. {WHY}")


def _status(args: Namespace, session: Session) -> None:
    session.print("The daemon is not running")
    session.warn(WHY)


def _stop(args: Namespace, session: Session) -> None:
    session.print("The daemon is not running")


VERBS = {
    "start": Verb("do nothing, for scripts that start one", _start, flag("--debug -d", "accepted, without effect")),
    "status": Verb("say that there is none, and why", _status),
    "stop": Verb("do nothing, for scripts that stop one", _stop),
}
