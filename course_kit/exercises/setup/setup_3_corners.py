"""The check of setup-3: a turtle that visits corners."""

from __future__ import annotations

from collections.abc import Sequence

from geometry_msgs.msg import Twist
from turtlesim.msg import Pose

from course_kit.exercises.checker import drives
from course_kit.exercises.checker.assertions import expect, require
from course_kit.exercises.checker.checks import check_of
from course_kit.exercises.checker.drives import Step
from course_kit.exercises.checker.student_assertions import commands_heard, expect_simulator, heard_since_start
from course_kit.exercises.setup.turtles import FIRST, FIRST_COMMANDS, FIRST_POSE, SINCE, STANDS
from course_kit.robots.turtlesim import paths
from course_kit.robots.turtlesim.field import EXTENT

CORNERS = {
    "the lower corners": ((0.0, 0.0), (EXTENT, 0.0)),
    "the upper corners": ((0.0, EXTENT), (EXTENT, EXTENT)),
}
NEAR = 2.0  # metres
BY_COMMANDS = 0.5  # of what was driven; the first command of a new publisher is seldom heard
SOME = 0.2  # of it, by chance: a command of another drive, or of a new publisher that was not heard


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
