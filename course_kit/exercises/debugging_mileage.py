"""Chapter 6's exercise on an algorithm that a jump must not fool: a mileage, and how it is checked."""

from __future__ import annotations

from typing import Any

from std_msgs.msg import Float32
from turtlesim.msg import Pose

from course_kit.examining.exercise import exercise
from course_kit.examining.station import Heard
from course_kit.examining.vocabulary import answer, expect, wait
from course_kit.examining.vocabulary_topics import (
    expect_compatible_subscription,
    expect_subscription,
    expect_topic,
    listen,
    publisher,
    values,
)

POSES = "/turtle1/pose"
FEW = 5  # poses, fewer than any queue holds


@exercise(
    "debugging-5",
    "A distance that survives a teleport",
    points=3,
    minutes=15,
    level="harder",
    timeout=20,
    node_class="Mileage",
)
def mileage() -> None:
    """It adds up what was driven, without what was jumped."""
    answer()
    expect_subscription(POSES, Pose)
    expect_topic("/mileage", Float32)
    turtle = publisher(POSES, Pose)
    expect_compatible_subscription(POSES, turtle)
    heard = listen("/mileage", Float32)
    wait(lambda: heard.publisher_count > 0, 3.0)
    driven = [Pose(x=1.0 + 0.03 * step, y=1.0 + 0.04 * step) for step in range(61)]  # 3 m
    _send(turtle, driven, heard)
    said = values(heard, "data")
    expect(
        "it publishes once for each pose, beginning with 0",
        len(said) == len(driven) and said[0] == 0.0,
        f"For {len(driven)} poses there were {len(said)} messages{f', the first {said[0]:.2f}' if said else ''}: "
        f"publish in the callback of the pose, also for the first one.",
        needed=not said,
    )
    expect(
        "60 steps of 0.05 m are 3 m",
        abs(said[-1] - 3.0) < 0.01,
        f"It said {said[-1]:.2f} m: add `math.dist` of one pose and the one before.",
    )
    after = [Pose(x=9.0, y=9.0 - 0.05 * step) for step in range(21)]  # a jump, then 1 m
    _send(turtle, after, heard)
    last = values(heard, "data")[-1]
    expect(
        "a teleport does not count, and what comes after it does",
        abs(last - 4.0) < 0.01,
        f"3 m, a jump, and 1 m more: it said {last:.2f} m. Leave out a step of more than 0.2 m, and go on from where "
        f"the turtle is then.",
    )


def _send(turtle: Any, poses: list[Pose], heard: Heard) -> None:
    """Publish poses a few at a time, the next when these were answered: so that a short queue loses none."""
    for first in range(0, len(poses), FEW):
        _send_few(turtle, poses[first : first + FEW], heard)


def _send_few(turtle: Any, poses: list[Pose], heard: Heard) -> None:
    count = len(heard) + len(poses)
    for pose in poses:
        turtle.publish(pose)
    wait(lambda: len(heard) >= count, 1.0)
