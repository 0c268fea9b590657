"""The check of setup-4: two turtles, one in a namespace, of which one drives."""

from __future__ import annotations

from typing import Any

from geometry_msgs.msg import Twist
from turtlesim.msg import Pose

from course_kit.exercises.checker import drives
from course_kit.exercises.checker.assertions import expect, expect_value, wait
from course_kit.exercises.checker.checks import check_of
from course_kit.exercises.checker.student_assertions import (
    commands_heard,
    expect_running_node,
    expect_simulator,
    heard_since_start,
    was_listed_before,
)
from course_kit.exercises.setup.turtles import FIRST, FIRST_COMMANDS, FIRST_POSE, SECOND, SECOND_POSE, SINCE, STANDS

DRIVEN = 0.3  # metres
ON_ITS_WAY = 1.0  # seconds that a turtle which drives has to come as far; a command lasts as long


@check_of("setup-4", watches={FIRST_POSE: Pose, FIRST_COMMANDS: Twist, SECOND_POSE: Pose})
def two_robots(value: Any) -> None:
    """The topics of a second simulator, which runs, and whose turtle was driven without the first one's moving."""
    wanted = [f"/robot2/turtle1/{name}" for name in ("cmd_vel", "color_sensor", "pose")]
    given = value
    if isinstance(value, list):  # whoever asks rclpy gets hidden topics too, as those of actions
        given = sorted({name for topic in value if "/_" not in (name := str(topic).removesuffix("/"))})
    others = [topic for topic in wanted if topic != SECOND_POSE]
    if given == others and was_listed_before(SECOND, SECOND_POSE):
        given = wanted  # a subscription was there before it: what is new by a list lacks the topic
    expect_value(
        "the topics that came with the second simulator",
        given,
        wanted,
        "They are those of `/turtle1` with the namespace before them, with full names: "
        "`%ros2 topic list` before and after shows what is new.",
        points=2,
    )
    expect_running_node(SECOND, "TurtleSim", points=1)
    expect_simulator(SECOND)
    wait(_second_has_driven_or_stands, ON_ITS_WAY)
    second, first = heard_since_start(SECOND, SECOND_POSE), heard_since_start(FIRST, FIRST_POSE)
    steps, started = drives.steps_of(second), second[0][0] if second else 0
    # What the first one drove before, as in setup-3, does not count, whichever simulator was started first.
    moves = next((step.when for step in steps if step.length), started)
    driven = drives.driven(steps)
    moved = drives.moved_since(drives.steps_of(first), commands_heard(FIRST_COMMANDS).first_effect(moves))
    hint = (
        f"The second drove {driven:.1f} m since it was started, and from then on the first moved {moved:.1f} m. "
        f"`%ros2 topic info /robot2/turtle1/cmd_vel` shows who drives whom. {SINCE}; if the first has moved, run the "
        f"second one again and drive it."
    )
    if not first:
        hint = f"No turtle of a node `{FIRST}` was heard: both are to run. Start the first one with `run(TurtleSim)`."
    expect("the second turtle was driven, and the first was not", first and driven >= DRIVEN and moved < STANDS, hint)


def _second_has_driven_or_stands() -> bool:
    """True where no more is to be heard of the second turtle's drive: the check may begin in the midst of it."""
    poses = heard_since_start(SECOND, SECOND_POSE)
    drives_on = poses and poses[-1][1].linear_velocity
    return not drives_on or drives.driven(drives.steps_of(poses)) >= DRIVEN
