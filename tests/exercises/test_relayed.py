"""Which relays are every tenth pose, also where a queue lost some."""

from __future__ import annotations

import pytest
from turtlesim.msg import Pose

from course_kit.exercises.topics.topics_3_relay import EQUAL, Relayed, may_have_lost

PERIOD, SOON, LATE = 16_000_000, 1_000_000, 50_000_000  # nanoseconds
EACH_TENTH = list(range(9, 100, 10))
TWO_LATER = [9, 19, 30, 40, 51, 61, 71, 81, 91]


def relayed(numbers: list[int], late: set[int]) -> Relayed:
    """What came of 100 poses that differ and EQUAL that do not; three of these, and those with these numbers."""
    sent = [(n * PERIOD, Pose(x=n / 8, y=n / 16, theta=n / 32)) for n in range(100)]
    standing = [(n * PERIOD, Pose(x=50.0)) for n in range(100, 100 + EQUAL)]
    came = [(sent[n][0] + (LATE if n in late else SOON), sent[n][1]) for n in numbers]
    return Relayed(sent, 100, standing, [*came, *((when + SOON, pose) for when, pose in standing[::10])])


def test_each_tenth_is_right():
    right = relayed(EACH_TENTH, set())
    assert right.is_every_tenth() and right.is_at_once and not right.may_be_disturbed


@pytest.mark.parametrize(("late", "unexplained"), [(set(), 2), ({30}, 1), ({19, 30, 51}, 0)])
def test_a_step_beside_a_pose_that_waited_is_explained(late, unexplained):
    lossy = relayed(TWO_LATER, late)
    assert lossy.unexplained == unexplained
    assert lossy.may_be_disturbed and not lossy.is_every_tenth()
    assert lossy.is_every_tenth(lost=1) == (unexplained <= 1)


def test_the_places_of_uneven_steps_stay_where_a_queue_has_lost_some_before():
    one_of_four_later = [9, 19, 29, 39, 50, 60, 70, 80, 91]
    assert relayed(one_of_four_later, set()).uneven == {4, 8}
    assert relayed([n + (n > 20) for n in one_of_four_later], set()).uneven == {2, 4, 8}
    assert relayed(EACH_TENTH, set()).uneven == set()


def test_poses_may_be_lost_once_and_not_at_the_same_place_in_each_of_three_rounds():
    three, four, five = (relayed([n + (n > later) for n in EACH_TENTH[:-1]], set()) for later in (29, 39, 49))
    assert may_have_lost([three, four, five]) == may_have_lost([three, three, five]) == 1
    assert may_have_lost([three, three, three]) == 0
    assert may_have_lost([three, four]) == may_have_lost([]) == 0


def test_one_of_the_first_ten_may_be_lost_too():
    late = [n + 1 for n in EACH_TENTH[:-1]]
    assert not relayed(late, set()).is_every_tenth()
    assert relayed(late, set()).is_every_tenth(lost=1)
    assert relayed(late, set()).uneven == {0}
    twice = [n + (n > 40) for n in late]
    assert [relayed(twice, waited).is_every_tenth(lost=1) for waited in (set(), {10}, {51})] == [False, True, True]
    assert may_have_lost([relayed(late, set())] * 3) == 0


def test_what_comes_too_early_is_not_lost():
    early = relayed([9, 18, 28, 38, 48, 58, 68, 78, 88, 98], {9, 18})
    assert not early.may_be_disturbed and not early.is_every_tenth(lost=1)
