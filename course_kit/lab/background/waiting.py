"""wait_for: waits in a cell for what happens in the background, with a timeout that says what did not come."""

from __future__ import annotations

import contextlib
import inspect
import textwrap
import threading
from collections.abc import Callable, Iterator
from typing import Any, NamedTuple

from rclpy.action import ActionClient
from rclpy.task import Future

from course_kit.base.arguments import TEXT, WAIT, takes
from course_kit.base.long_tasks import LongTask, long_task
from course_kit.base.polling import wait_until
from course_kit.base.programs import processes
from course_kit.base.programs.child_process import Process
from course_kit.lab.background import running
from course_kit.ros.interface_types import type_name
from course_kit.ros.private_api import going_on_without
from course_kit.ros.private_api.rclpy_action_parts import awaited_of
from course_kit.ros.private_api.rclpy_parts import pending_requests
from course_kit.ros.spinning import action_answers, executors

POLL = 0.01  # seconds between two looks at a condition
LONGEST_FEEDBACK = 80  # characters


@takes(timeout=WAIT, what=TEXT | None)
def wait_for(awaited: Future | Process | Callable[[], Any], timeout: float = 5.0, what: str | None = None) -> Any:
    """Wait for a future's result, or until a condition is true; return the result or the condition's value.

    Of a process that start() returned, wait for the end; return its exit status.

    `timeout` in seconds; `what` names the awaited thing in the error. Raises TimeoutError with what did not come
    and what to look at, and BlockingWait if called from a callback. Stands for rclpy.spin_until_future_complete().
    """
    executors.refuse_in_callback("wait_for()")
    if hasattr(awaited, "add_done_callback"):
        return _wait_for_future(awaited, timeout, what)  # type: ignore[arg-type]
    if not callable(awaited):
        raise TypeError(
            f"wait_for() takes a future, as call_async() returns, or a function without arguments that says whether "
            f"it is time to go on, not {type(awaited).__name__}. Write: wait_for(lambda: ...)"
        )
    return _wait_for_condition(awaited, timeout, what)


def _wait_for_future(future: Future | Process, timeout: float, what: str | None) -> Any:
    explain = getattr(future, "explain_wait", lambda: _explain(future))  # a process has it
    done = threading.Event()
    future.add_done_callback(lambda _: done.set())
    with (
        long_task(lambda: f"waiting for {what or explain()[0]}", timeout, at_most=True) as task,
        _feedback(future, task),
    ):
        is_done = done.wait(timeout)
    if not is_done:
        described, hint = explain()
        raise TimeoutError(f"{what or described} did not come within {timeout:g} s. {_remarked() or hint}")
    return future.result()


def _wait_for_condition(condition: Callable[[], Any], timeout: float, what: str | None) -> Any:
    with long_task(lambda: f"waiting for {what or _describe_condition(condition)}", timeout, at_most=True):
        value = wait_until(condition, timeout, POLL)
    if value:
        return value
    hint = "Is the node that should bring it running? nodes() lists those of this notebook, logs() what they say."
    raise TimeoutError(
        f"{what or _describe_condition(condition)} did not come true within {timeout:g} s. {_remarked() or hint}"
        f"{_failed_processes()}"
    )


def _remarked() -> str:
    """What is to be said of the nodes that run in the background, if anything: that is nearer than a guess."""
    names = [node.get_fully_qualified_name() for node in running.nodes()]
    return " ".join(dict.fromkeys(said for name in names for said in running.remarks(name)))


def _failed_processes() -> str:
    failed = [f"`{process.name}` {process.state}" for process in processes.failed()]
    return f" Among the processes, {' and '.join(failed)}." if failed else ""


def _describe_condition(condition: Callable[[], Any]) -> str:
    if condition.__name__ != "<lambda>":
        return f"{condition.__name__}()"
    try:
        source = " ".join(inspect.getsource(condition).split())
    except (OSError, TypeError):
        return "the condition"
    return f"the condition in `{textwrap.shorten(source, 100)}`"


def _client_of(future: Any) -> Any:
    """The client whose request a future belongs to, or None."""
    with going_on_without("wait_for() does not say what is waited for"):
        for node in running.nodes():
            for client in node.clients:
                if future in pending_requests(client):
                    return client
    return None


@contextlib.contextmanager
def _feedback(future: Any, task: LongTask) -> Iterator[None]:
    """Have a task tell the feedback of the goal whose result the future is, if it is one."""
    awaited = _awaited_of_action(future)
    if awaited is None or not awaited.goal:
        yield
        return

    def listen(goal: bytes, feedback: Any) -> None:
        if goal == awaited.goal:
            task.doing = feedback_text(feedback)

    action_answers.feedback_listeners.add(listen)
    try:
        yield
    finally:
        action_answers.feedback_listeners.discard(listen)


def feedback_text(feedback: Any) -> str:
    """The fields of a feedback message in a few words: numbers and texts, and how long arrays are."""
    parts = []
    for name in feedback.get_fields_and_field_types():
        value = getattr(feedback, name)
        if isinstance(value, float):
            parts.append(f"{name} {value:.3g}")
        elif isinstance(value, int | str):
            parts.append(f"{name} {value}")
        elif hasattr(value, "__len__"):
            parts.append(f"{len(value)} in {name}")
    return textwrap.shorten(", ".join(parts), LONGEST_FEEDBACK, placeholder=" …")


class _AwaitedOfAction(NamedTuple):
    client: ActionClient
    what: str
    goal: bytes  # the id of the goal, if its result is awaited


def _awaited_of_action(future: Any) -> _AwaitedOfAction | None:
    with going_on_without("wait_for() does not say what of an action is waited for"):
        for node in running.nodes():
            for client in [one for one in node.waitables if isinstance(one, ActionClient)]:
                for pending, what, goal in awaited_of(client):
                    if pending is future:
                        return _AwaitedOfAction(client, what, goal)
    return None


def _explain_action(awaited: _AwaitedOfAction) -> tuple[str, str]:
    name = awaited.client._action_name
    if not awaited.client.server_is_ready():
        return f"{awaited.what} of the action {name}", f"No node offers {name}: is the server running, under that name?"
    hint = "The server is there: logs() shows whether its callback has failed; a longer timeout lets it go on."
    return f"{awaited.what} of the action {name}", hint


def _explain(future: Any) -> tuple[str, str]:
    """What a future brings, and what to look at."""
    if (awaited := _awaited_of_action(future)) is not None:
        return _explain_action(awaited)
    client = _client_of(future)
    if client is None:
        hint = "A future completes only while the node it belongs to runs: nodes() lists those that do."
        return "the result of the future", hint
    name, kind = client.srv_name, type_name(client.srv_type)
    hint = f"No node offers {name} with the type {kind}: is the server running, under the same name?"
    if client.service_is_ready():
        hint = "The service is there, but its callback has not returned: logs() shows its errors."
    return f"the response of the service {name}", hint
