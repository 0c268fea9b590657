"""The contract with rosidl's generated messages: what the course uses of them, and what it does without it."""

from __future__ import annotations

import pytest
from std_msgs.msg import UInt8

from course_kit.ros.private_api.rosidl_parts import check_fields


def test_a_message_checks_its_fields_as_it_is_told():
    message = UInt8()
    check_fields(message, True)
    with pytest.raises(AssertionError):
        message.data = 256
    check_fields(message, False)
    message.data = 256
    assert message.data == 256


def test_of_a_message_that_cannot_be_told_one_line_says_so(capsys):
    class Other:
        data = 0

    for _ in range(2):
        check_fields(Other(), True)
    said = "rosidl has no Other._check_fields here: a value that does not fit its field is not refused"
    assert capsys.readouterr().err.count(said) == 1
