"""The rotate_absolute action of one turtle: goals go to the world, how they ended goes to their clients."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from rclpy.action import ActionServer, CancelResponse, GoalResponse
from rclpy.action.server import ServerGoalHandle
from rclpy.node import Node
from turtlesim.action import RotateAbsolute

from course_kit.robots.turtlesim.turtle import Outcome, Rotation


class RotateServer(ActionServer):
    """Runs goals without a callback that waits, so that it works and idles on every executor.

    begin(goal in radians) starts a rotation, the simulator's ticks go on with it. When `retired`, new goals
    are rejected. `used` says whether there was ever a goal.
    """

    def __init__(self, node: Node, name: str, begin: Callable[[float], Rotation]) -> None:
        self.retired = self.used = False
        self._destroyed = False
        self._server_node = node
        self._begin = begin
        # Goals that their clients wait for, and the rotation that stands for each in the world.
        self._goals: list[tuple[ServerGoalHandle, Rotation]] = []
        super().__init__(
            node,
            RotateAbsolute,
            name,
            execute_callback=lambda _: None,  # never called: goals are driven by the ticks
            goal_callback=lambda _: GoalResponse.REJECT if self.retired else GoalResponse.ACCEPT,
            cancel_callback=lambda _: CancelResponse.ACCEPT,
        )

    def notify_execute(self, goal_handle: ServerGoalHandle, execute_callback: Any) -> None:
        """Called by rclpy for a goal that is now executing: begin its rotation instead of a callback."""
        if execute_callback is not None:
            super().notify_execute(goal_handle, execute_callback)
            return
        self.used = True
        self._goals.append((goal_handle, self._begin(goal_handle.request.theta)))
        self.settle()

    def pass_cancels(self) -> None:
        """Tell the world which rotations are to be cancelled."""
        for handle, rotation in self._goals:
            rotation.canceling = handle.is_cancel_requested

    def publish_feedback(self, remaining: float) -> None:
        """Tell the running goal's client how many radians are left."""
        feedback = RotateAbsolute.Feedback(remaining=remaining)
        for handle, _ in self._goals:
            handle.publish_feedback(feedback)

    def settle(self) -> None:
        """Send the results of the goals whose rotation has ended."""
        ended = [goal for goal in self._goals if goal[1].outcome is not None]
        self._goals = [goal for goal in self._goals if goal[1].outcome is None]
        for handle, rotation in ended:
            if rotation.outcome is Outcome.SUCCEEDED:
                handle.succeed()
            elif rotation.outcome is Outcome.CANCELED:
                handle.canceled()
            else:
                handle.abort()
            result = RotateAbsolute.Result(delta=rotation.delta)
            if self._server_node.executor is not None:  # else nobody is left to send it
                super().notify_execute(handle, lambda _, result=result: result)

    def destroy(self) -> None:
        """Leave the graph; goals that still run are aborted."""
        if not self._destroyed:
            self._destroyed = True
            for handle, _ in self._goals:
                handle.abort()
            self._goals.clear()
            super().destroy()

    # An executor in several threads may still hold on to a server that another thread destroys.

    def is_ready(self, wait_set: Any) -> bool:
        """Return True if something came; never once it is destroyed."""
        return not self._destroyed and super().is_ready(wait_set)

    def take_data(self) -> dict[str, Any]:
        """What came; nothing once it is destroyed."""
        return {} if self._destroyed else super().take_data()

    def add_to_wait_set(self, wait_set: Any) -> None:
        """Be waited for, unless it is destroyed."""
        if not self._destroyed:
            super().add_to_wait_set(wait_set)
