"""Chapter 1's exercises: what each asks of the machine, a first node and the turtle, and how it is checked."""

from __future__ import annotations

import os
from typing import Any

from rcl_interfaces.msg import Log
from turtlesim.msg import Pose

from course_kit.examining import paths
from course_kit.examining.exercise import exercise
from course_kit.examining.vocabulary import expect, expect_value, parts, require
from course_kit.examining.vocabulary_student import expect_running_node, heard_since_start, logged_by
from course_kit.turtlesim.field import EXTENT

CORNERS = {
    "the lower corners": ((0.0, 0.0), (EXTENT, 0.0)),
    "the upper corners": ((0.0, EXTENT), (EXTENT, EXTENT)),
}
NEAR = 2.0  # metres
FASTEST = 0.5  # metres between two poses, 16 ms apart: more is a jump
SECOND = "/robot2/turtle1"
GREETING = "Nice to meet you, "


@exercise("setup-1", "Read the report", points=1, level="warm-up", timeout=5, value=True)
def read_the_report(value: Any) -> None:
    """The number of the domain, and the word for the discovery range."""
    domain, reach = parts(value, 2)
    expect_value(
        "the domain",
        domain,
        int(os.environ["ROS_DOMAIN_ID"]),
        "It is a number, without quotes: `os.environ['ROS_DOMAIN_ID']`, or the row *domain* of the report, has it.",
        points=0,
    )
    expect_value(
        "the discovery range",
        reach,
        os.environ.get("ROS_AUTOMATIC_DISCOVERY_RANGE", "LOCALHOST"),
        "It is one word in capitals: `os.environ['ROS_AUTOMATIC_DISCOVERY_RANGE']` has it.",
    )


@exercise(
    "setup-2",
    "A node of your own",
    points=2,
    level="warm-up",
    timeout=8,
    node_class="Greeter",
    watches={"/rosout": Log},
)
def greeter() -> None:
    """A node /greeter runs and has logged a greeting with a name in it, at the level INFO."""
    expect_running_node("/greeter", "Greeter", points=1)
    lines = logged_by("greeter")
    said = [line for line in lines if line.msg.startswith(GREETING) and line.msg[len(GREETING) :].strip(" <>.!")]
    heard = f"It logged {lines[-1].msg!r}." if lines else "It logged nothing that the checker heard."
    hint = f"{heard} Log with `self.get_logger().info(…)` in __init__ (print() goes to nobody else), then run it again."
    if said and all(line.level != 20 for line in said):
        hint = "The text is right, the level is not INFO: INFO is `self.get_logger().info(…)`."
    has_name = any("your name" not in line.msg and line.level == 20 for line in said)
    expect(f"it logged `{GREETING}…` with the level INFO", has_name, hint)


@exercise(
    "setup-3",
    "Visit the corners",
    points=3,
    level="medium",
    timeout=8,
    node="/turtlesim",
    watches={"/turtle1/pose": Pose},
)
def corners() -> None:
    """Since it was started, the turtle has been near each of the four corners, and drove there."""
    poses = heard_since_start("/turtle1/pose")
    require(
        "the checker saw the turtle drive",
        poses and paths.length(poses) > 1.0,
        "It saw no movement on `/turtle1/pose`. It looks on from the first check of this chapter on: "
        "run the cell above again, with the driving in it, and then this one.",
    )
    for which, points in CORNERS.items():
        distances = [paths.nearest_approach(poses, point) for point in points]
        expect(
            f"it was near {which}",
            max(distances) <= NEAR,
            f"It came within {distances[0]:.1f} m of the left one and {distances[1]:.1f} m of the right one; "
            f"{NEAR:g} m is near. `plot_pose(corners)` shows the path.",
        )
    jump = paths.longest_jump(poses)
    expect(
        "it drove all the way",
        jump < FASTEST,
        f"It jumped {jump:.1f} m from one pose to the next: drive it with commands, do not teleport it.",
    )


@exercise(
    "setup-4",
    "Two robots",
    points=4,
    level="harder",
    timeout=8,
    node="/robot2/turtlesim",
    watches={"/turtle1/pose": Pose, f"{SECOND}/pose": Pose},
    value=True,
)
def two_robots(value: Any) -> None:
    """The topics of a second simulator, which runs, and whose turtle was driven without the first one's moving."""
    wanted = [f"{SECOND}/{name}" for name in ("cmd_vel", "color_sensor", "pose")]
    given = sorted(str(topic).removesuffix("/") for topic in value) if isinstance(value, list) else value
    expect_value(
        "the topics that came with the second simulator",
        given,
        wanted,
        "They are those of `/turtle1` with the namespace before them, with full names: "
        "`%ros2 topic list` before and after shows what is new.",
        points=2,
    )
    expect_running_node("/robot2/turtlesim", "TurtleSim", points=1)
    second, first = heard_since_start(f"{SECOND}/pose"), heard_since_start("/turtle1/pose")
    expect(
        "the second turtle was driven, and the first was not",
        paths.length(second) > 0.3 and (not first or paths.length(first) < 0.05),
        f"The second drove {paths.length(second):.1f} m, the first {paths.length(first):.1f} m since it was started. "
        f"`%ros2 topic info {SECOND}/cmd_vel` shows who drives whom; the checker looks on from the chapter's first "
        f"check on.",
    )
