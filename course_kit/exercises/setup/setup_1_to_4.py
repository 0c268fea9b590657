"""Chapter 1's exercises: what each asks of the machine, a first node and the turtle, and how it is checked."""

from __future__ import annotations

import os
import re
from collections.abc import Sequence
from typing import Any

from geometry_msgs.msg import Twist
from rcl_interfaces.msg import Log
from turtlesim.msg import Pose

from course_kit.base.arguments import shown
from course_kit.exercises.checker import drives
from course_kit.exercises.checker.checks import check_of
from course_kit.exercises.checker.drives import Step
from course_kit.exercises.checker.examination import current
from course_kit.exercises.checker.vocabulary import expect, expect_value, parts, require, wait
from course_kit.exercises.checker.vocabulary_student import (
    commands_heard,
    expect_running_node,
    expect_simulator,
    heard_since_start,
    logged_by,
    was_listed_before,
)
from course_kit.robots.turtlesim import paths
from course_kit.robots.turtlesim.field import EXTENT

INFO = 20
GREETING = "Nice to meet you, "
NEARLY = "nice.{0,3}to.{0,3}meet"
GREETING_TIMEOUT = 3.0  # seconds; the text says 2
# What stands in place of a name: the text's own words, a variable that was not filled in, nothing.
NO_NAMES = {"", "yourname", "yournamehere", "myname", "name", "none"}
CORNERS = {
    "the lower corners": ((0.0, 0.0), (EXTENT, 0.0)),
    "the upper corners": ((0.0, EXTENT), (EXTENT, EXTENT)),
}
NEAR = 2.0  # metres
BY_COMMANDS = 0.5  # of what was driven; the first command of a new publisher is seldom heard
SOME = 0.2  # of it, by chance: a command of another drive, or of a new publisher that was not heard
FIRST, SECOND = "/turtlesim", "/robot2/turtlesim"
FIRST_POSE, FIRST_COMMANDS, SECOND_POSE = "/turtle1/pose", "/turtle1/cmd_vel", "/robot2/turtle1/pose"
DRIVEN = 0.3  # metres
STANDS = 0.05
ON_ITS_WAY = 1.0  # seconds that a turtle which drives has to come as far; a command lasts as long
SINCE = "It looks on from the first check in this notebook on"


@check_of("setup-1")
def read_the_report(value: Any) -> None:
    """The number of the domain in which the notebook's nodes are, and the word for the discovery range."""
    domain, reach = parts(value, 2)
    expect(
        "the domain",
        domain == current().student.domain and not isinstance(domain, bool),
        f"You gave {shown(domain)}. It is a number, without quotes: `os.environ['ROS_DOMAIN_ID']`, or the row "
        "`ROS_DOMAIN_ID` of the report, has it. What a cell writes there later moves no node.",
        points=0,
    )
    expect_value(
        "the discovery range",
        reach.strip() if isinstance(reach, str) else reach,
        _discovery_range(),
        "It is one word in capitals: `os.environ['ROS_AUTOMATIC_DISCOVERY_RANGE']` has it.",
    )


def _discovery_range() -> str:
    """As rcl takes it from the environment, which for the checker is the one that the notebook was started with."""
    only_here = os.environ.get("ROS_LOCALHOST_ONLY")
    if only_here == "1":
        return "LOCALHOST"
    return os.environ.get("ROS_AUTOMATIC_DISCOVERY_RANGE") or ("SUBNET" if only_here else "LOCALHOST")


@check_of("setup-2", watches={"/rosout": Log})
def greeter() -> None:
    """A node /greeter runs and has logged a greeting with a name in it, at the level INFO."""
    expect_running_node("/greeter", "Greeter", points=1)
    lines = logged_by("greeter", lambda line: line.level == INFO and _greets(line.msg), GREETING_TIMEOUT)
    greetings = [line for line in lines if _greets(line.msg)]
    nearest = next((line for line in reversed(lines) if re.search(NEARLY, line.msg, re.IGNORECASE)), None)
    line = nearest or (lines[-1] if lines else None)
    heard = f"It logged {line.msg!r}." if line else "It logged nothing that the checker heard."
    hint = f"{heard} Log with `self.get_logger().info(…)` in __init__ (print() goes to nobody else), then run it again."
    if line and (nearest or any(one.level == INFO for one in lines)):
        hint = f"{heard} The line is exactly `{GREETING}` and then a name: {_what_is_wrong(line.msg)}"
    if greetings:
        hint = "The text is right, the level is not INFO: INFO is `self.get_logger().info(…)`."
    expect(f"it logged `{GREETING}…` with the level INFO", any(line.level == INFO for line in greetings), hint)


def _what_is_wrong(text: str) -> str:
    """What keeps a line from being a greeting, as far as that is seen."""
    if re.search(r"\byou\s+[^\W_]", text):
        return "the comma behind `you` is missing."
    if found := re.search(r"\{.*?\}|%s", text):
        return f"yours, not a placeholder for it. Put an f before the quotes, so that Python fills in `{found[0]}`."
    if found := re.search(r"<[^<>]*>|your name", text, re.IGNORECASE):
        return f"yours, not a placeholder for it. Write your own name where `{found[0]}` stands, without < and >."
    return "yours, not a placeholder for it; it comes within two seconds."


def _greets(text: str) -> bool:
    """Whether a line greets with a name."""
    words = text.strip()
    if not words.startswith(GREETING) or re.search(r"[{}]|<[^<>]*>|%s|your name", words, re.IGNORECASE):
        return False
    return re.sub(r"[\W_]", "", words[len(GREETING) :]).casefold() not in NO_NAMES


@check_of("setup-3", watches={FIRST_POSE: Pose, FIRST_COMMANDS: Twist})
def corners() -> None:
    """Since it was started, the turtle has been near each of the four corners, and drove there by commands."""
    expect_simulator(FIRST)
    steps, commands = drives.steps_of(heard_since_start(FIRST, FIRST_POSE)), commands_heard(FIRST_COMMANDS)
    by_commands = drives.driven(steps, commands)
    drove = by_commands > max(1.0, SOME * drives.driven(steps))
    require("the checker saw the turtle drive", drove, _why_it_did_not_drive(steps))
    poses = [step.pose for step in steps]
    for which, points in CORNERS.items():
        distances = [paths.nearest_approach(poses, point) for point in points]
        expect(
            f"it was near {which}",
            max(distances) <= NEAR,
            f"It came within {distances[0]:.1f} m of the left one and {distances[1]:.1f} m of the right one; "
            f"{NEAR:g} m is near. `plot_pose(corners)` shows the path.",
        )
    every = [point for points in CORNERS.values() for point in points]
    _expect_driven_all_the_way(steps, [one for one in every if paths.nearest_approach(poses, one) <= NEAR], by_commands)


def _why_it_did_not_drive(steps: Sequence[Step]) -> str:
    put, moved = drives.carried(steps), drives.moved_since(steps, 0)
    if put > 0.5 * moved > 0.5:
        return (
            f"It was put elsewhere, {put:.1f} m in all, without a velocity: drive it with commands, do not teleport it."
        )
    if moved > 1.0:
        return (
            f"It moved {moved:.1f} m, and no command on `{FIRST_COMMANDS}` was heard for most of them. "
            f"{SINCE}: drive with `drive()`, or publish there."
        )
    saw = f"only {moved:.1f} m of movement" if moved > STANDS else "no movement"
    return (
        f"It saw {saw} on `{FIRST_POSE}` since `{FIRST}` was started. {SINCE}: "
        f"run the cell above again, with the driving in it, and then this one."
    )


def _expect_driven_all_the_way(steps: Sequence[Step], corners: Sequence[paths.Point], by_commands: float) -> None:
    """To these corners, all that it was near, it came in one drive, and commands were heard for it (metres)."""
    jump = max(step.carried for step in steps)
    put, moved = drives.carried(steps), drives.driven(steps)
    in_one = any(all(drives.came_to(drive, point, NEAR) for point in corners) for drive in drives.drives(steps))
    hint = (
        f"It jumped {jump:.1f} m from one pose to the next, {put:.1f} m in all: drive it with commands, do not "
        "teleport it. After a teleport or a reset the four corners begin anew."
    )
    if in_one:
        hint = f"It drove {moved:.1f} m, and commands on `{FIRST_COMMANDS}` were heard for {by_commands:.1f} m of them."
    elif put <= drives.CARRIED:
        hint = f"It did not drive there from elsewhere, as far as the checker saw. {SINCE}: drive there again."
    expect("it drove all the way", in_one and by_commands >= BY_COMMANDS * moved, hint)


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
