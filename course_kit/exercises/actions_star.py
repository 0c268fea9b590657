"""Chapter 5's project: a star that is driven by an action of the student's own type, and how it is checked."""

from __future__ import annotations

import math
from itertools import pairwise

from turtlesim.msg import Pose

from course_kit.examining import own_types, paths
from course_kit.examining.exercise import exercise
from course_kit.examining.station import Heard
from course_kit.examining.vocabulary import a_turtle, answer, expect, pause, require, wait
from course_kit.examining.vocabulary_actions import Client, expect_action
from course_kit.examining.vocabulary_topics import listen

SIDE = 2.0  # metres of a line of the star
STAR_TURN = 2 * math.tau / 5


@exercise(
    "actions-5",
    "A star, and back home",
    points=5,
    minutes=40,
    level="project",
    timeout=120,
    node_class="StarServer",
    types=("my_interfaces",),
)
def star_server() -> None:
    """It drives a star, goes back to its beginning when it is cancelled, and lets a second goal win."""
    polygon = own_types.load("my_interfaces/action/Polygon")
    a_turtle()
    driven = listen("/turtle1/pose", Pose)
    answer()
    client = expect_action("/drive_star", polygon)
    wait(lambda: len(driven), 3.0, "the turtle's pose")
    pause(0.3)
    start, before = driven.last, len(driven)
    goal = client.send(side_length=SIDE)
    require("it accepts a goal", goal.accepted, "It rejected a line of 2 m, or said nothing.")
    goal.wait(45.0)
    distance = goal.result.distance if goal.result is not None else math.nan
    expect(
        "the goal succeeds, and the result is the metres driven",
        goal.word == "succeeded" and abs(distance - 5 * SIDE) < 1.0,
        f"It is {goal.word}, with a distance of {distance:.1f} m: drive all five lines, then `goal_handle.succeed()`, "
        f"and return a result in which `distance` is {5 * SIDE:g}.",
    )
    poses = driven.messages[before:]
    apart = max(min(paths.nearest_approach(poses, p) for p in pair) for pair in _corners(start))
    turned = abs(paths.length(poses) - 5 * SIDE)
    expect(
        "the path is a star with five points",
        apart < 0.25 and turned < 1.0,
        f"It missed a corner by {apart:.2f} m, and drove {paths.length(poses):.1f} m in place of {5 * SIDE:g}: at each "
        "point of a star the turtle turns by 144°, twice the angle of a pentagon.",
    )
    left = [one.distance_left for one in goal.feedback]
    expect(
        "the feedback is the metres left",
        len(left) > 10 and 4 * SIDE < left[0] <= 5.2 * SIDE and left[-1] < 0.3 and all(_falls(left)),
        f"It began with {left[0] if left else 'nothing'} and ended with {left[-1] if left else 'nothing'}: what is "
        f"left of this line and of the lines after it, {5 * SIDE:g} at the beginning.",
    )
    _check_cancel(client, driven)
    _check_preempt(client)


def _check_cancel(client: Client, driven: Heard) -> None:
    home = driven.last
    goal = client.send(side_length=SIDE)
    wait(lambda: goal.feedback and goal.feedback[-1].distance_left < 3.7 * SIDE, 20.0)
    goal.cancel(20.0)
    away = math.dist((home.x, home.y), (driven.last.x, driven.last.y))
    expect(
        "cancelled, the turtle is back where the star began before the goal is canceled",
        goal.word == "canceled" and away < 0.3,
        f"The goal is {goal.word}, and the turtle {away:.1f} m from there: a cancel_callback that accepts, and "
        f"`goal_handle.canceled()` only after the way back.",
    )


def _check_preempt(client: Client) -> None:
    first = client.send(side_length=SIDE)
    pause(1.0)
    second = client.send(side_length=SIDE)
    first.wait(4.0)
    pause(0.5)
    count = len(second.feedback)
    pause(0.5)
    expect(
        "a second goal takes the place of the first",
        first.word in ("aborted", "canceled") and second.accepted and len(second.feedback) > count,
        f"With a second goal on its way the first is {first.word}, and the second "
        f"{'runs' if len(second.feedback) > count else 'has no feedback'}: abort the first, and let its loop end.",
    )


def _corners(start: Pose) -> list[tuple[paths.Point, paths.Point]]:
    """The corners of a star from a pose, each for both ways round."""
    ways = []
    for sign in (1, -1):
        x, y, corners = start.x, start.y, []
        for number in range(5):
            heading = start.theta + sign * number * STAR_TURN
            x, y = x + SIDE * math.cos(heading), y + SIDE * math.sin(heading)
            corners.append((x, y))
        ways.append(corners)
    return list(zip(*ways, strict=True))


def _falls(left: list[float]) -> list[bool]:
    """For each feedback whether it is not more than the one before, but for the noise of steering."""
    return [after <= before + 0.3 for before, after in pairwise(left)]
