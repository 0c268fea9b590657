"""`ros2 daemon`: the words that scripts read from the real one, and why there is none."""

from __future__ import annotations

import pytest

from tests.ros2_command import ros2

WHY = "No daemon is needed here"


@pytest.mark.parametrize(
    ("words", "out", "says_why"),
    [
        (("status",), "The daemon is not running\n", True),
        (("start",), "The daemon has been started\n", True),
        (("start", "--debug"), "The daemon has been started\n", True),
        (("stop",), "The daemon is not running\n", False),
    ],
)
def test_it_answers_in_the_real_one_s_words(words, out, says_why):
    answer = ros2("daemon", *words)
    assert (answer.out, WHY in answer.err, answer.err.count("\n"), answer.status) == (out, says_why, says_why, 0)
