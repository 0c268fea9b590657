"""Private parts of the message classes that rosidl generates."""

from __future__ import annotations

from typing import Any

from course_kit.ros.private_api import expect, going_on_without


def check_fields(message: Any, are_checked: bool) -> None:
    """Have a message's setters check types, ranges and lengths or not, whatever ROS_PYTHON_CHECK_FIELDS says."""
    with going_on_without("a value that does not fit its field is not refused"):
        expect("rosidl", message, "_check_fields")
        message._check_fields = are_checked
