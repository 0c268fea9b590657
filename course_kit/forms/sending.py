"""Sends what a form holds, in the background: a topic's message, a service's request, an action's goal."""

from __future__ import annotations

import contextlib
import textwrap
import threading
import time
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import partial
from itertools import count
from typing import Any

from rclpy.action import ActionClient
from rclpy.event_handler import PublisherEventCallbacks
from rclpy.executors import SingleThreadedExecutor
from rclpy.qos import qos_policy_name_from_kind

from course_kit.calls.goals import STATES
from course_kit.forms.interface import ACTION, SERVICE, Interface
from course_kit.polling import wait_until
from course_kit.ros2.messages.values import populate, stamp
from course_kit.ros2.messages.yaml_text import to_yaml
from course_kit.spinning import action_answers, errors
from course_kit.spinning.executors import SpinThread
from course_kit.spinning.nodes import quiet_node
from course_kit.watching import instruments

FOUND = 5.0  # seconds given to a server to be there
ANSWER = 10.0  # seconds given to it to answer a request, or to take or cancel a goal
GONE = 2.0  # seconds after which a server that is not there any more will send no result
POLL = 0.01
SENDING = "sending …"
_numbers = count(1)  # of nodes that send goals: each has a name of its own


@dataclass(frozen=True)
class State:
    """How sending goes: one line, the last answer, whether it goes on, and whether the line tells of a failure."""

    line: str = ""
    answer: str = ""
    is_busy: bool = False
    is_problem: bool = False


class Sender:
    """Sends values of an interface, as `read()` gives them, without waiting; `state` says how that goes."""

    def __init__(self, interface: Interface) -> None:
        self.interface = interface
        self._state = State()

    @property
    def state(self) -> State:
        """How it goes."""
        return self._state

    def send(self, value: Any) -> None:
        """Begin to send a value."""
        raise NotImplementedError

    def close(self) -> None:
        """End what goes on."""
        raise NotImplementedError

    def fail(self, error: Exception) -> None:
        """Say what went wrong."""
        is_ours = isinstance(error, LookupError | TimeoutError)  # which is a sentence by itself
        said = error.args[0] if is_ours and error.args else f"{type(error).__name__}: {error}"
        self._state = replace(self._state, line=str(said), is_problem=True)

    def _filled(self, value: Any) -> tuple[Any, list[Any]]:
        """The message of a value, and the times in it that stand for the time of sending."""
        message = self.interface.message_type()
        return message, populate(message, value)

    def _stamped(self, value: Any) -> Any:
        message, times = self._filled(value)
        stamp(times, *instruments.node().get_clock().now().seconds_nanoseconds())
        return message


def sender(interface: Interface) -> Sender:
    """What sends to a topic, a service or an action."""
    return {SERVICE: ServiceCaller, ACTION: GoalSender}.get(interface.noun, Publishing)(interface)


class Publishing(Sender):
    """Publishes messages once, or at a rate."""

    def __init__(self, interface: Interface) -> None:
        super().__init__(interface)
        self._node, self._executor = instruments.node(), instruments.executor()
        self._timer: Any = None
        self._rate = 0.0
        self._sent = 0
        self._refused = ""
        self._is_closed = False
        self._message, self._times = self._filled({})
        self._publisher = self._node.create_publisher(
            interface.type,
            interface.name,
            10,
            event_callbacks=PublisherEventCallbacks(incompatible_qos=self._on_incompatible),
        )

    @property
    def state(self) -> State:
        """How many were sent to how many."""
        if self._is_closed or self._state.is_problem or not (self._sent or self._timer):
            return self._state
        listening = self._publisher.get_subscription_count()
        rate = f"publishing at {self._rate:g} Hz, " if self._timer else ""
        to = f"{listening} subscription{'' if listening == 1 else 's'}"
        if not listening:
            to = f"nobody: no node subscribes to {self.interface.name}"
        return replace(
            self._state, line=f"{rate}{self._sent:,} sent, to {to}{self._refused}", is_busy=bool(self._timer)
        )

    def send(self, value: Any) -> None:
        """Publish it once."""
        self.update(value)
        self._publish()

    def start(self, value: Any, rate: float) -> None:
        """Publish it so many times a second, until stop()."""
        self.stop()
        self.update(value)
        self._rate = rate
        self._publish()
        self._timer = self._node.create_timer(1 / rate, self._publish)

    def update(self, value: Any) -> None:
        """What is published from now on."""
        self._message, self._times = self._filled(value)
        self._state = State()

    def stop(self) -> None:
        """Publish no more."""
        timer, self._timer = self._timer, None
        if timer is not None:
            timer.cancel()
            self._executor.create_task(self._node.destroy_timer, timer)

    def close(self) -> None:
        """Leave the topic; how it went is kept."""
        self.stop()
        with contextlib.suppress(Exception):  # ROS may have been shut down
            self._state = self.state
        self._is_closed = True
        self._executor.create_task(self._node.destroy_publisher, self._publisher)

    def _publish(self) -> None:
        message, times = self._message, self._times
        stamp(times, *self._node.get_clock().now().seconds_nanoseconds())
        try:
            self._publisher.publish(message)
            self._sent += 1
        except Exception as error:  # in the timer nobody else would say it
            self.fail(error)

    def _on_incompatible(self, event: Any) -> None:
        policy = qos_policy_name_from_kind(event.last_policy_kind).replace("_QOS_POLICY", "").lower()
        self._refused = f"; a subscription gets nothing, for it asks for another {policy}"


class _Background(Sender):
    """Sends in a thread of its own, one after the other."""

    def __init__(self, interface: Interface) -> None:
        super().__init__(interface)
        self._ending = threading.Event()
        self._thread: threading.Thread | None = None

    def send(self, value: Any) -> None:
        """Send it, unless one is under way."""
        if self._state.is_busy or self._ending.is_set():
            return
        self._state = State(SENDING, is_busy=True)
        self._thread = threading.Thread(
            target=self._run, args=(value,), name=f"form of {self.interface.name}", daemon=True
        )
        self._thread.start()

    def close(self) -> None:
        """End the wait for an answer."""
        self._ending.set()
        if self._thread is not None:
            self._thread.join(GONE)

    def _run(self, value: Any) -> None:
        try:
            self._talk(value)
        except Exception as error:  # there is no other place where it could be seen
            self.fail(error)
        self._state = replace(self._state, is_busy=False)

    def _talk(self, value: Any) -> None:
        """Send, wait, and say what comes. Raises an error with what is to be said."""
        raise NotImplementedError

    def _wait(self, condition: Callable[[], Any], timeout: float | None, poll: float = POLL) -> Any:
        """Whether a condition comes true before the time is over, or the form ends."""
        wait_until(lambda: condition() or self._ending.is_set(), timeout, poll)
        return condition()


class ServiceCaller(_Background):
    """Calls a service."""

    def _talk(self, value: Any) -> None:
        began = time.monotonic()
        name, request = self.interface.name, self._stamped(value)
        response = instruments.call(self.interface.type, name, request, FOUND, ANSWER, self._wait)
        took = time.monotonic() - began
        self._state = State(f"answered after {took:.2g} s", to_yaml(response).strip(), is_busy=True)


class GoalSender(_Background):
    """Sends goals, and follows each to its end."""

    def __init__(self, interface: Interface) -> None:
        super().__init__(interface)
        self._cancelling = threading.Event()
        action_answers.keep()  # sent from this thread, answered in another

    def cancel(self) -> None:
        """Ask the server to cancel the goal that goes on."""
        self._cancelling.set()

    def _talk(self, value: Any) -> None:
        self._cancelling.clear()
        goal = self._stamped(value)
        watching = instruments.node()
        node = quiet_node(f"{watching.get_name()}_goal_{next(_numbers)}", watching.context)
        executor = SingleThreadedExecutor(context=node.context)
        with contextlib.closing(SpinThread(node, partial(errors.report, node.get_name()), executor).start()):
            client = ActionClient(node, self.interface.type, self.interface.name)
            if not self._wait(client.server_is_ready, FOUND):
                raise LookupError(f"nobody offers {self.interface.name} (waited {FOUND:g} s)")
            self._follow(client, goal)

    def _follow(self, client: Any, goal: Any) -> None:
        began, numbers = time.monotonic(), count(1)

        def note(message: Any) -> None:
            line = f"EXECUTING for {time.monotonic() - began:.1f} s, feedback {next(numbers)}"
            self._state = State(line, f"feedback:\n{_indented(message.feedback)}", is_busy=True)

        handle = self._answer(client.send_goal_async(goal, note), "to take the goal")
        if handle is None:
            return
        if not handle.accepted:
            raise LookupError(f"{self.interface.name} has rejected the goal")
        if self._state.line == SENDING:
            self._state = State("ACCEPTED", is_busy=True)
        result = self._result(client, handle)
        if result is not None:
            line = f"{STATES[result.status]} after {time.monotonic() - began:.1f} s"
            self._state = State(line, f"result:\n{_indented(result.result)}", is_busy=True)

    def _result(self, client: Any, handle: Any) -> Any:
        """What a goal brings, which may take long; None if the form ends before."""
        coming, seen = handle.get_result_async(), time.monotonic()

        def is_lost() -> bool:
            nonlocal seen
            seen = time.monotonic() if client.server_is_ready() else seen
            return time.monotonic() - seen > GONE

        while not coming.done():
            self._wait(lambda: coming.done() or self._cancelling.is_set() or is_lost(), None)
            if is_lost():
                raise TimeoutError(f"the server of {self.interface.name} ended before it sent a result")
            if self._ending.is_set():
                wait_until(handle.cancel_goal_async().done, 1.0, POLL)  # nobody could cancel it later
                self._state = replace(self._state, line="cancelled by the end of the form")
                return None
            if self._cancelling.is_set() and not coming.done():
                self._cancelling.clear()
                self._cancel(handle)
        return coming.result()

    def _cancel(self, handle: Any) -> None:
        answer = self._answer(handle.cancel_goal_async(), "to cancel the goal")
        if answer is not None and not answer.goals_canceling:
            self._state = replace(self._state, line="the server does not cancel this goal: it goes on")

    def _answer(self, future: Any, what: str) -> Any:
        """What a server answers; None if the form ends before."""
        if self._wait(future.done, ANSWER):
            return future.result()
        if not self._ending.is_set():
            raise TimeoutError(f"{self.interface.name} was asked {what}, and gave no answer within {ANSWER:g} s")
        return None


def _indented(message: Any) -> str:
    return textwrap.indent(to_yaml(message).strip(), "  ")
