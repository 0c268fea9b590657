"""Lifecycle nodes in a launch: their states become events, and events change their states."""

from __future__ import annotations

import asyncio
import contextlib
import logging
import os
from collections.abc import Callable
from typing import TYPE_CHECKING, Any

from course_kit.cli.launching import events, output
from course_kit.cli.launching.context import LaunchContext
from course_kit.cli.launching.entities import Action, LaunchDescriptionEntity
from course_kit.cli.launching.handlers import EventHandler, Response, on_event
from course_kit.cli.launching.node import Node
from course_kit.cli.launching.substitutions import SomeSubstitutions

if TYPE_CHECKING:
    from rclpy.node import Node as RosNode

POLL = 0.02  # seconds
HEARD = 2.0  # seconds that a first transition waits for the launch to hear the node
PATIENCE = 5.0  # seconds until it is told what is waited for


class ChangeState(events.Event):
    """Lifecycle nodes are to make a transition, given by its id of lifecycle_msgs/msg/Transition."""

    name = "launch_ros.events.lifecycle.ChangeState"

    def __init__(self, *, lifecycle_node_matcher: events.Matcher, transition_id: int) -> None:
        if type(transition_id) is not int or not 0 <= transition_id <= 255:
            raise ValueError(f"ChangeState: transition_id is {transition_id!r}, no id of lifecycle_msgs/msg/Transition")
        self.lifecycle_node_matcher = lifecycle_node_matcher
        self.transition_id = transition_id


class StateTransition(events.Event):
    """A lifecycle node went from one state to another one; the states have their names."""

    name = "launch_ros.events.lifecycle.StateTransition"

    def __init__(self, *, action: LifecycleNode, msg: Any) -> None:
        self.action = action
        self.msg = msg
        self.timestamp = msg.timestamp
        self.transition = msg.transition.label
        self.start_state = msg.start_state.label
        self.goal_state = msg.goal_state.label


class OnStateTransition(EventHandler):
    """When a lifecycle node, or any, makes that transition, or goes from or to those states."""

    def __init__(
        self,
        *,
        entities: Response,
        target_lifecycle_node: Any = None,
        transition: str | None = None,
        start_state: str | None = None,
        goal_state: str | None = None,
        matcher: events.Matcher | None = None,
        handle_once: bool = False,
    ) -> None:
        if target_lifecycle_node is not None and not isinstance(target_lifecycle_node, LifecycleNode):
            raise TypeError(f"OnStateTransition: target_lifecycle_node is {target_lifecycle_node!r}, no LifecycleNode")
        wanted = {"action": target_lifecycle_node, "transition": transition}
        wanted |= {"start_state": start_state, "goal_state": goal_state}
        given = {name: value for name, value in wanted.items() if value is not None}

        def matches(event: events.Event) -> bool:
            is_transition = isinstance(event, StateTransition)
            return is_transition and all(getattr(event, name) == value for name, value in given.items())

        super().__init__(matcher=matcher or matches, entities=entities, handle_once=handle_once)


class LifecycleNode(Node):
    """Runs a lifecycle node: it emits StateTransition, and does what a ChangeState says."""

    def __init__(self, *, name: SomeSubstitutions, namespace: SomeSubstitutions, **options: Any) -> None:
        super().__init__(name=name, namespace=namespace, **options)
        self.is_lifecycle_node = True

    def execute(self, context: LaunchContext) -> None:
        """Listen to the node, and start it."""
        super().execute(context)  # the process itself starts when the loop goes on
        if context.is_shutdown:
            return
        from lifecycle_msgs.msg import TransitionEvent
        from lifecycle_msgs.srv import ChangeState as Service

        node = _node_of(context)
        self._states = node.create_subscription(
            TransitionEvent, f"{self.node_name}/transition_event", lambda msg: self._heard(msg, context), 10
        )
        self._client = node.create_client(Service, f"{self.node_name}/change_state")
        context.register_event_handler(on_event(ChangeState, self._on_change_state))

    def _heard(self, msg: Any, context: LaunchContext) -> None:
        with contextlib.suppress(RuntimeError):  # the launch is over
            context.asyncio_loop.call_soon_threadsafe(context.emit_event_sync, StateTransition(action=self, msg=msg))

    def _on_change_state(self, event: ChangeState, context: LaunchContext) -> list[LaunchDescriptionEntity]:
        return [_Transition(self, event.transition_id)] if event.lifecycle_node_matcher(self) else []

    async def change_state(self, context: LaunchContext, transition_id: int) -> None:
        """Have the node make a transition, once it is there."""
        from lifecycle_msgs.msg import Transition
        from lifecycle_msgs.srv import ChangeState as Service

        time = context.asyncio_loop.time
        if not await self._until(self._client.service_is_ready, context):
            return
        deadline = time() + HEARD  # what it tells before it is heard would be lost
        if not await self._until(lambda: self._states.get_publisher_count() > 0 or time() > deadline, context):
            return
        request = Service.Request()
        request.transition.id = transition_id
        answer = self._client.call_async(request)
        if await self._until(answer.done, context) and not answer.result().success:
            names = (name for name in dir(Transition) if name.startswith("TRANSITION_"))
            name = next((name for name in names if getattr(Transition, name) == transition_id), transition_id)
            _logger().error(f"Failed to make transition '{name}' for LifecycleNode '{self.node_name}'")

    async def _until(self, is_so: Callable[[], bool], context: LaunchContext) -> bool:
        """Wait until it is so; False, with a warning, if the launch or the node ends before."""
        service = self._client.srv_name
        begin, is_told = context.asyncio_loop.time(), False
        while not is_so():
            if context.is_shutdown or self._task is None or self._task.done():
                why = "due to shutdown" if context.is_shutdown else "because the node has ended"
                _logger().warning(f"Abandoning wait for the '{service}' service, {why}.")
                return False
            if not is_told and context.asyncio_loop.time() > begin + PATIENCE:
                is_told = True
                _logger().warning(f"Still waiting for the '{service}' service: is '{self.node_name}' a lifecycle node?")
            await asyncio.sleep(POLL)
        return True


def _logger() -> logging.Logger:
    return output.get_logger("launch_ros.actions.lifecycle_node")


class _Transition(Action):
    """Has a lifecycle node make a transition; the launch does not end before."""

    def __init__(self, node: LifecycleNode, transition_id: int) -> None:
        super().__init__()
        self._node = node
        self._id = transition_id
        self._task: asyncio.Task[None] | None = None

    def execute(self, context: LaunchContext) -> None:
        self._task = context.asyncio_loop.create_task(self._node.change_state(context, self._id))

    def get_asyncio_future(self) -> asyncio.Future[None] | None:
        return self._task


def _node_of(context: LaunchContext) -> RosNode:
    """The node of this launch, made when the first lifecycle node needs it."""
    if context.ros_node is None:
        from functools import partial

        from rclpy.executors import SingleThreadedExecutor

        from course_kit.ros.spinning import context as ros
        from course_kit.ros.spinning import errors
        from course_kit.ros.spinning.executors import SpinThread
        from course_kit.ros.spinning.nodes import quiet_node

        ros.start()
        name = f"launch_ros_{os.getpid()}"
        context.ros_node = quiet_node(name)
        SpinThread(context.ros_node, partial(errors.report, name), SingleThreadedExecutor()).start()
    return context.ros_node
