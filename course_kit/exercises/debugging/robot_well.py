"""The words of a check about the lab's robot in the student's domain."""

from __future__ import annotations

from functools import partial

from course_kit.exercises.checker.assertions import chance, expect, wait
from course_kit.exercises.checker.examination import current
from course_kit.exercises.debugging import robot_reactions
from course_kit.exercises.faults import health

POLL = 0.1


def expect_well(points: int, timeout: float = 12.0) -> bool:
    """The robot of the student's domain is well for two seconds, and does what its manual says when it is disturbed."""
    observer = current().student
    findings = health.examine(observer, timeout, partial(wait, what="the robot to be well", poll=POLL))
    if all(finding.ok for finding in findings):
        findings = robot_reactions.examine(observer, partial(wait, what="the robot to follow", poll=POLL / 2), chance())
    wrong = [finding for finding in findings if not finding.ok]
    hint = " ".join(f"Not so: {finding.text}. {finding.hint}" for finding in wrong)
    return expect("the robot is well, seen from outside", not wrong, hint, points, needed=True)
