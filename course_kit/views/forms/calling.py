"""Sends what is answered, in the background: a service's request, an action's goal."""

from __future__ import annotations

import contextlib
import textwrap
import threading
import time
from collections.abc import Callable
from dataclasses import replace
from functools import partial
from itertools import count
from typing import Any

from rclpy.action import ActionClient
from rclpy.executors import SingleThreadedExecutor

from course_kit.base.polling import wait_until
from course_kit.cli.ros2.messages.yaml_text import to_yaml
from course_kit.lab.calls.goals import STATES
from course_kit.ros.spinning import action_answers, errors
from course_kit.ros.spinning.executors import SpinThread
from course_kit.ros.spinning.nodes import quiet_node
from course_kit.ros.subscriptions import clients, observer_node
from course_kit.views.forms.interface import Interface
from course_kit.views.forms.sender import Sender, State

FOUND = 5.0  # seconds given to a server to be there
ANSWER = 10.0  # seconds given to it to answer a request, or to take or cancel a goal
GONE = 2.0  # seconds after which a server that is not there any more will send no result
POLL = 0.01
SENDING = "sending …"
_numbers = count(1)  # of nodes that send goals: each has a name of its own


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
        """Return True if a condition comes true before the time is over, or the form ends."""
        wait_until(lambda: condition() or self._ending.is_set(), timeout, poll)
        return condition()


class ServiceCaller(_Background):
    """Calls a service."""

    def _talk(self, value: Any) -> None:
        began = time.monotonic()
        name, request = self.interface.name, self._stamped(value)
        response = clients.call(self.interface.type, name, request, FOUND, ANSWER, self._wait)
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
        watching = observer_node.node()
        node = quiet_node(f"{watching.get_name()}_goal_{next(_numbers)}", watching.context)
        executor = SingleThreadedExecutor(context=node.context)
        with contextlib.closing(SpinThread(node, partial(errors.report, node.get_name()), executor).start()):
            client = ActionClient(node, self.interface.type, self.interface.name)
            if not self._wait(client.server_is_ready, FOUND):
                raise LookupError(f"nobody offers {self.interface.name} (waited {FOUND:g} s)")
            clients.meet_server(client, self._wait)
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
