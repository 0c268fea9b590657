"""A node that offers and uses an action, for tests of what is recorded and drawn of actions."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager

from example_interfaces.action import Fibonacci
from rclpy.action import ActionClient, ActionServer, CancelResponse
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node
from rclpy.task import Future

from course_kit.lab.background.running import run, stop
from course_kit.ros.spinning import context

STATUS, FEEDBACK = "/counting/_action/status", "/counting/_action/feedback"


class Counting(Node):
    """Offers and uses the action `counting`."""

    def __init__(self) -> None:
        super().__init__("counting")
        accept = {"cancel_callback": lambda _: CancelResponse.ACCEPT}
        self.server = ActionServer(self, Fibonacci, "counting", self.execute, **accept)
        self.client = ActionClient(self, Fibonacci, "counting")
        self.lingers = False  # whether a goal that is to be cancelled stays so

    async def pause(self) -> None:
        done: Future = Future()
        timer = self.create_timer(0.02, lambda: done.set_result(None))
        await done
        self.destroy_timer(timer)

    async def execute(self, goal_handle):
        for number in range(goal_handle.request.order):
            await self.pause()
            if goal_handle.is_cancel_requested:
                while self.lingers:
                    await self.pause()
                goal_handle.canceled()
                return Fibonacci.Result()
            goal_handle.publish_feedback(Fibonacci.Feedback(sequence=[number]))
        goal_handle.succeed()
        return Fibonacci.Result()

    def destroy_node(self) -> None:
        self.client.destroy()
        self.server.destroy()
        super().destroy_node()


@contextmanager
def counting_node() -> Iterator[Counting]:
    """The node, in the background until the block ends, with its client and its server acquainted."""
    context.start()
    node = run(Counting, executor=SingleThreadedExecutor())
    assert node.client.wait_for_server(timeout_sec=10.0)
    yield node
    stop(node)
