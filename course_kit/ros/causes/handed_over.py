"""Looks if the arguments of create_timer() and its like can be used: executors find out where no line is known."""

from __future__ import annotations

import enum
from collections.abc import Mapping
from typing import Any

from course_kit.ros.causes.callbacks import misfit
from course_kit.ros.causes.raised import fields


def wrong(taker: str, given: Mapping[str, Any]) -> str:
    """What is wrong with the arguments of `create_timer` or its like, and the cure; '' if nothing is."""
    for name in ("callback", "execute_callback"):
        if name in given and (told := misfit(given[name], taker)):
            return told
    message, qos = given.get("msg_type"), given.get("qos_profile")
    if fields(message) and not isinstance(message, type):
        kind = type(message).__name__
        return f"{taker}() takes the class {kind}, and this is one message: write {kind} without parentheses behind it"
    if isinstance(qos, enum.Enum):
        policy = f"{type(qos).__name__}.{qos.name}"
        name = type(qos).__name__.removesuffix("Policy").removeprefix("QoS").lower()
        return f"{policy} is one policy, and the QoS is all of them: write QoSProfile(depth=10, {name}={policy})"
    return ""
