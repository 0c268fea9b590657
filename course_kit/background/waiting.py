"""wait_for: waits in a cell for what happens in the background, with a timeout that says what did not come."""

from __future__ import annotations

import inspect
import textwrap
import threading
from collections.abc import Callable
from typing import Any

from rclpy.task import Future

from course_kit.background import running
from course_kit.interface_types import type_name
from course_kit.internals import going_on_without
from course_kit.internals.rclpy_parts import pending_requests
from course_kit.polling import wait_until
from course_kit.programs import processes
from course_kit.programs.child_process import Process
from course_kit.spinning import executors

POLL = 0.01  # seconds between two looks at a condition


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
    done = threading.Event()
    future.add_done_callback(lambda _: done.set())
    if not done.wait(timeout):
        explain = getattr(future, "explain_wait", lambda: _explain(future))  # a process has it
        described, hint = explain()
        raise TimeoutError(f"{what or described} did not come within {timeout:g} s. {hint}")
    return future.result()


def _wait_for_condition(condition: Callable[[], Any], timeout: float, what: str | None) -> Any:
    if value := wait_until(condition, timeout, POLL):
        return value
    raise TimeoutError(
        f"{what or _describe_condition(condition)} did not come true within {timeout:g} s. "
        f"Is the node that should bring it running? nodes() lists those of this notebook, logs() what they say."
        f"{_failed_processes()}"
    )


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


def _explain(future: Any) -> tuple[str, str]:
    """What a future brings, and what to look at."""
    client = _client_of(future)
    if client is None:
        hint = "A future completes only while the node it belongs to runs: nodes() lists those that do."
        return "the result of the future", hint
    name, kind = client.srv_name, type_name(client.srv_type)
    hint = f"No node offers {name} with the type {kind}: is the server running, under the same name?"
    if client.service_is_ready():
        hint = "The service is there, but its callback has not returned: logs() shows its errors."
    return f"the response of the service {name}", hint
