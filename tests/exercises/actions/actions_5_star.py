"""Answers to actions-5: right ones in several styles, and wrong ones that students give."""

from __future__ import annotations

from tests.exercises.actions.star_styles import STAR_STYLES
from tests.exercises.chapter import Answers, Wrong, changed, worked

STAR = worked("actions-5")

IN_SERIES = changed(  # it has asked before the earlier goal could end
    STAR, ("        side, pose =", "        is_first = not (earlier and earlier.is_active)\n        side, pose =")
)
KEEPS_START = """
        if is_first:
            self.start = (pose.x, pose.y)
"""

TELEPORTS = changed(
    STAR,
    (
        """        pose = await self.next_pose()
        while (distance := math.dist((pose.x, pose.y), (x, y))) >= 0.05:
            if self.goal is not goal_handle or (goal_handle.is_cancel_requested and not home):
                return False
            goal_handle.publish_feedback(Polygon.Feedback(distance_left=distance + side * lines))
            self.publisher.publish(steer(pose, x, y))
            pose = await self.next_pose()
""",
        """        self.jump.call_async(TeleportAbsolute.Request(x=x, y=y))
        pose = await self.next_pose()
        while math.dist((pose.x, pose.y), (x, y)) > 0.05:
            pose = await self.next_pose()
""",
    ),
    (
        "        self.waiting,",
        '        self.jump = self.create_client(TeleportAbsolute, "turtle1/teleport_absolute")\n        self.waiting,',
    ),
    ("class Star", "from turtlesim.srv import TeleportAbsolute\n\nclass Star"),
)

ANSWERS = Answers(
    "actions-5",
    5,
    STAR,
    [
        Wrong(
            "pentagon",
            changed(STAR, ("number * 2 * math.tau", "number * math.tau")),
            4,
            "twice the angle of a pentagon",
        ),
        Wrong(
            "not_home",
            changed(STAR, ("        await self.to(goal_handle, *start, 0, side, home=True)\n", "")),
            4,
            "only after the way back",
        ),
        Wrong(
            "no_cancel",
            changed(STAR, ("CancelResponse.ACCEPT", "CancelResponse.REJECT")),
            4,
            "a cancel_callback that accepts",
        ),
        Wrong(
            "both_drive",
            changed(STAR, ("self.goal is not goal_handle or (goal_handle", "(goal_handle")),
            4,
            "abort the first",
        ),
        Wrong(
            "type",
            changed(STAR, ('Polygon, "drive_star"', 'Fibonacci, "drive_star"')),
            0,
            "Its type is example_interfaces/action/Fibonacci",
        ),
        Wrong("no_result", changed(STAR, ("(distance=5 * side)", "()")), 4, "with a distance of 0.0 m"),
        Wrong(
            "driven_not_left",
            changed(STAR, ("distance + side * lines", "side * (5 - lines) - distance")),
            4,
            "of the lines after it",
        ),
        Wrong(
            "side_by_heart",
            changed(STAR, ("side, pose = goal_handle.request.side_length", "side, pose = 2.0")),
            3,
            "With lines of 1.",
        ),
        Wrong(
            "home_is_the_middle",
            changed(STAR, ("start, x, y = (pose.x, pose.y)", "start, x, y = (5.54, 5.54)")),
            4,
            "m from where this star began",
        ),
        Wrong(
            "home_of_the_first",
            changed(
                STAR,
                (
                    "        start, x, y = (pose.x, pose.y)",
                    "        self.start = self.start or (pose.x, pose.y)\n        start, x, y = self.start",
                ),
                ("    on_pose,", "    start = None\n    on_pose,"),
            ),
            4,
            "m from where this star began",
        ),
        Wrong(
            "home_of_the_first_of_a_series",
            changed(
                IN_SERIES, ("        start, x, y = (pose.x, pose.y)", f"{KEEPS_START}        start, x, y = self.start")
            ),
            4,
            "m from where this star began",
        ),
        Wrong(
            "begins_where_the_first_began",
            changed(
                IN_SERIES,
                (
                    "        start, x, y = (pose.x, pose.y), pose.x, pose.y\n",
                    f"{KEEPS_START}        start, x, y = self.start, *self.start\n"
                    "        await self.to(goal_handle, x, y, 5, side)\n",
                ),
            ),
            3,
            "from where it began",
        ),
        Wrong(
            "canceled_before_the_way_back",
            changed(
                STAR,
                (
                    "        await self.to(goal_handle, *start",
                    "        goal_handle.canceled()\n        await self.to(goal_handle, *start",
                ),
                ("        goal_handle.canceled()\n        return", "        return"),
            ),
            4,
            "only after the way back",
        ),
        Wrong("four_lines", changed(STAR, ("range(5)", "range(4)")), 3, "twice the angle of a pentagon"),
        Wrong(
            "rejects_the_second",
            changed(
                STAR,
                ("earlier, self.goal = self.goal, goal_handle", "self.goal = goal_handle"),
                ("self.execute,", "self.execute,\ngoal_callback=self.on_goal,\n"),
                ("    on_pose,", "    on_goal = lambda self, _: list(GoalResponse)[not self.is_busy()]\n    on_pose,"),
                ("    async def to", "    is_busy = lambda self: self.goal and self.goal.is_active\n    async def to"),
            ),
            4,
            "and the second rejected",
        ),
        Wrong(
            "first_is_succeeded",
            changed(STAR, ("            goal_handle.abort()", "            goal_handle.succeed()")),
            4,
            "the first is succeeded",
        ),
        Wrong("line_not_lines", changed(STAR, ("distance + side * lines", "distance")), 4, "of the lines after it"),
        Wrong("teleports", TELEPORTS, 1, "by teleports"),
    ],
    STAR_STYLES,
    together=7,
)
