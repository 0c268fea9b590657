"""When topics-1's countdown has five messages a second, and what its hint says of one that has not."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import accumulate

import pytest

from course_kit.exercises.topics.topics_1_countdown import _why_not_five_a_second

EVEN = [0.2] * 10
DELAYED = [0.2, 0.01, 0.39, 0.2, 0.35, 0.05, 0.2, 0.38, 0.02, 0.2]  # by a busy machine: as many a second
BURSTS = [0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0]


@pytest.mark.parametrize(
    ("counts", "why"),
    [
        ((EVEN, EVEN), ""),
        ((EVEN,), ""),
        ((DELAYED, EVEN), ""),
        (([0.2005] * 10, DELAYED), ""),
        ((DELAYED, DELAYED), "It was 5.0 Hz in all, but the messages came unevenly."),
        ((BURSTS, BURSTS), "unevenly"),
        ((EVEN, [0.3] * 10), "It was 3.3 Hz in one of two counts"),
        (([0.5] * 10, [0.5] * 10), "It was 2.0 Hz."),
        (([],), "Too few messages"),
    ],
)
def test_one_even_count_of_two_that_are_in_time_is_enough(counts: Sequence[list[float]], why: str) -> None:
    said = _why_not_five_a_second([[int(at * 1e9) for at in accumulate(gaps, initial=5.0)] for gaps in counts])
    assert why in said and bool(why) == bool(said)
