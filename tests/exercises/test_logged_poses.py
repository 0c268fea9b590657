"""Which lines of debugging-2 tell of poses that came."""

from __future__ import annotations

import pytest

from course_kit.exercises.debugging.debugging_2_logs import _tells_of


@pytest.mark.parametrize(
    ("text", "xs", "tells"),
    [
        ("7.18", [7.10, 7.18], True),
        ("7.18", [7.10, 7.26], True),  # the pose itself was lost on its way to the checker
        ("7.18", [2.0, 9.0], False),  # a teleport has nothing between its ends
        ("7.18", [7.10, 7.14], False),
        ("7.18", [7.10, 7.10], False),
        ("7.18", [], False),
        ("nothing", [7.18], False),
    ],
)
def test_a_line_tells_of_a_pose_that_came_or_of_one_that_was_lost_in_a_drive(text, xs, tells):
    assert _tells_of(xs, text) == tells
