"""The check of setup-1: which findings the report of the machine has."""

from __future__ import annotations

import os
from typing import Any

from course_kit.base.arguments import shown
from course_kit.exercises.checker.assertions import expect, expect_value, parts
from course_kit.exercises.checker.checks import check_of
from course_kit.exercises.checker.examination import current


@check_of("setup-1")
def read_the_report(value: Any) -> None:
    """The number of the domain in which the notebook's nodes are, and the word for the discovery range."""
    domain, reach = parts(value, 2)
    expect(
        "the domain",
        domain == current().student.domain and not isinstance(domain, bool),
        f"You gave {shown(domain)}. It is a number, without quotes: `os.environ['ROS_DOMAIN_ID']`, or the row "
        "`ROS_DOMAIN_ID` of the report, has it. What a cell writes there later moves no node.",
        points=0,
    )
    expect_value(
        "the discovery range",
        reach.strip() if isinstance(reach, str) else reach,
        _discovery_range(),
        "It is one word in capitals: `os.environ['ROS_AUTOMATIC_DISCOVERY_RANGE']` has it.",
    )


def _discovery_range() -> str:
    """As rcl takes it from the environment, which for the checker is the one that the notebook was started with."""
    only_here = os.environ.get("ROS_LOCALHOST_ONLY")
    if only_here == "1":
        return "LOCALHOST"
    return os.environ.get("ROS_AUTOMATIC_DISCOVERY_RANGE") or ("SUBNET" if only_here else "LOCALHOST")
