"""Where odom lies in the map, as an answer to robot-5 tells it: which stamps are no good."""

from __future__ import annotations

import pytest
from geometry_msgs.msg import TransformStamped

from course_kit.exercises.robot.robot_5_map_to_odom import Told, _stamp, _stamps
from course_kit.robots.navigation.messages import transform_of
from course_kit.robots.navigation.places import Place

HERE, THERE = (2.0, -3.0, 0.8), (-2.0, 1.5, -1.2)
START = 1000.0  # s


def told(odom: Place, begin: float, stamps: list[float]) -> Told:
    """One part of a drive: poses from `begin` on, five times a second for 2 s, and transforms with these stamps."""
    poses = [begin + 0.2 * index for index in range(10)]
    return Told([odom_at(odom, stamp) for stamp in stamps], odom, [], poses, begin + 2.5)


def odom_at(place: Place, stamp: float) -> TransformStamped:
    return transform_of(place, "map", "odom", _stamp(stamp))


def steadily(begin: float, end: float) -> list[float]:
    """Stamps 0.05 s apart."""
    return [begin + 0.05 * index for index in range(round((end - begin) / 0.05))]


def test_what_is_told_steadily_between_two_parts_is_of_the_first_ones_poses():
    rest = told(HERE, START, steadily(START + 0.25, START + 2.4))
    moving = told(HERE, START + 2.6, steadily(START + 2.4, START + 5.0))  # four of them are before its first pose
    corrected = told(THERE, START + 5.2, [START + 5.2 + 0.2 * index for index in range(10)])
    assert _stamps((rest, moving, corrected)) == ("", True)


@pytest.mark.parametrize("part", [0, 1, 2])
@pytest.mark.parametrize(
    ("off", "words"), [(-START, "0"), (-0.5, "0.5 s before its pose"), (3.7, "3.7 s after its pose")]
)
def test_a_stamp_before_all_poses_of_its_place_or_too_far_ahead_is_told(part: int, off: float, words: str):
    places = HERE, (1.0, 2.0, 0.3), THERE
    parts = tuple(told(place, START, [START, START]) for place in places)
    parts[part].transforms[1] = odom_at(places[part], START + off)
    assert _stamps(parts) == (words, False)
