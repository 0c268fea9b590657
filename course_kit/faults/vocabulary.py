"""What a check says about the lab's robot in the student's domain; for exercises, in the checker's process."""

from __future__ import annotations

from functools import partial

from course_kit.examining.examination import current
from course_kit.examining.vocabulary import expect, wait
from course_kit.faults import health

POLL = 0.1


def expect_well(points: int, timeout: float = 12.0) -> bool:
    """The robot of the student's domain is well for two seconds; each thing that is not is a finding of its own."""
    findings = health.examine(current().student, timeout, partial(wait, what="the robot to be well", poll=POLL))
    wrong = [finding for finding in findings if not finding.ok]
    hint = " ".join(f"Not so: {finding.text}. {finding.hint}" for finding in wrong)
    return expect("the robot is well, seen from outside", not wrong, hint, points, needed=True)
