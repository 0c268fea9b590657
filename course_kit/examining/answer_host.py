"""The notebook's side of a check: does what the checker orders, and judges nothing.

A student's class is made anew on the *stage*: a ROS context of this process in a domain of the checker's. There its
node meets only what the exercise is about, and the nodes that the student runs are left alone.
"""

from __future__ import annotations

import atexit
import contextlib
import ctypes
import threading
import traceback
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

from rclpy.context import Context
from rclpy.executors import MultiThreadedExecutor
from rclpy.node import Node

from course_kit.examining.lines import as_json
from course_kit.internals import going_on_without
from course_kit.internals.rclpy_parts import pending_requests
from course_kit.spinning import NodeStopped
from course_kit.spinning import context as ros_context
from course_kit.spinning.executors import SpinThread
from course_kit.spinning.nodes import WITHOUT_DESCRIPTIONS, construct, quiet_node, with_base

STOP_TIMEOUT = 0.5
KEPT_ERRORS = 20
PACKAGE = Path(__file__).parents[1]
THREADS = 4  # of a MultiThreadedExecutor, where an exercise asks for one


class _OnStage(Node):
    """Stands between a student's class and Node: puts the node on the stage.

    It has no /rosout: rcl keeps one publisher for each name in a process, and that is the one of the node of the
    same name that the student may have running.
    """

    _course_kit_context: Context

    def __init__(self, node_name: str, **kwargs: Any) -> None:
        options = {**kwargs, "context": self._course_kit_context, "enable_rosout": False}
        options["parameter_overrides"] = [*(kwargs.get("parameter_overrides") or []), *WITHOUT_DESCRIPTIONS]
        super().__init__(node_name, **options)


class AnswerHost:
    """A context in a domain of its own, with at most one student's node."""

    def __init__(self, domain: int) -> None:
        self.domain = domain
        ros_context.start()  # the first context of a process sets its logging up
        self._context = ros_context.separate(domain, "LOCALHOST")
        # Keeps the participant alive between checks, so that discovery need not begin again.
        self._keeper = quiet_node("_stage", self._context)
        self._spinning: SpinThread | None = None
        self._errors: list[str] = []

    def start(self, node_class: type[Node], arguments: list[Any], threads: bool) -> None:
        """Make a node of the class and spin it; whatever its constructor raises is raised."""
        self.stop()
        node = construct(with_base(node_class, _OnStage, _course_kit_context=self._context), arguments, {})
        if node.context is not self._context:
            node.destroy_node()
            raise TypeError(f'{node_class.__name__}.__init__ must begin with super().__init__("name of the node")')
        executor = MultiThreadedExecutor(num_threads=THREADS, context=self._context) if threads else None
        name = node.get_fully_qualified_name()
        self._errors.clear()
        self._spinning = SpinThread(node, lambda error: self._note(name, error), executor).start()

    def _note(self, name: str, error: Exception) -> None:
        text = f"A callback of {name} raised {described(error)}."
        if text not in self._errors[-1:] and len(self._errors) < KEPT_ERRORS:
            self._errors.append(text)

    def errors(self) -> list[str]:
        """What the callbacks of the node raised."""
        return list(self._errors)

    @property
    def node(self) -> Node:
        """The student's node. RuntimeError if none is on the stage."""
        if self._spinning is None:
            raise RuntimeError("there is no node on the stage")
        return self._spinning.node

    def stop(self) -> None:
        """Stop and destroy the node."""
        ending, self._spinning = self._spinning, None
        if ending is not None:
            ending.close(STOP_TIMEOUT)

    def close(self) -> None:
        """Leave the domain."""
        self.stop()
        with contextlib.suppress(Exception):
            self._keeper.destroy_node()
        with contextlib.suppress(Exception):
            self._context.try_shutdown()


_host: AnswerHost | None = None


def close() -> None:
    """Close the stage, if there is one."""
    global _host
    ending, _host = _host, None
    if ending is not None:
        ending.close()


def _on(domain: int) -> AnswerHost:
    global _host
    if _host is None or _host.domain != domain:
        close()
        _host = AnswerHost(domain)
        # Registered after those of the context, so called before them.
        atexit.unregister(close)
        atexit.register(close)
    return _host


def obey(order: Mapping[str, Any], names: Mapping[str, Any]) -> dict[str, Any]:
    """Do what an order says, with the notebook's variables `names`; return {"value": …} or {"error": …}."""
    try:
        return {"value": _ORDERS[order["do"]](order, names)}
    except NodeStopped:
        return {"error": "it did not return in time"}
    except BaseException as error:  # a student's class may raise anything, SystemExit too
        return {"error": f"{type(error).__name__}: {error}".splitlines()[0], "trace": described(error)}


def described(error: BaseException) -> str:
    """What was raised, and the lines of the student's that led there."""
    frames = [f for f in traceback.extract_tb(error.__traceback__) if not _is_plumbing(Path(f.filename))]
    where = "".join(f", in line {f.lineno} of {f.name}: `{f.line}`" for f in frames[-1:])
    return f"{type(error).__name__}: {error}{where}"


def _is_plumbing(path: Path) -> bool:
    return PACKAGE in path.parents or "rclpy" in path.parts or "site-packages" in path.parts


def _has(order: Mapping[str, Any], names: Mapping[str, Any]) -> bool:
    return isinstance(names.get(order["node_class"]), type)


def _start(order: Mapping[str, Any], names: Mapping[str, Any]) -> None:
    node_class = names[order["node_class"]]
    if not issubclass(node_class, Node):
        raise TypeError(
            f"{order['node_class']} is not derived from rclpy.node.Node. Write: class {order['node_class']}(Node)"
        )
    _on(order["domain"]).start(node_class, [], order["threads"])


def _call(order: Mapping[str, Any], _: Mapping[str, Any]) -> Any:
    return as_json(getattr(_on(order["domain"]).node, order["method"])(*order["arguments"]))


def _read(order: Mapping[str, Any], _: Mapping[str, Any]) -> Any:
    return as_json(getattr(_on(order["domain"]).node, order["attribute"]))


def _pending(order: Mapping[str, Any], _: Mapping[str, Any]) -> int:
    """How many calls of the node's clients still wait for an answer."""
    with going_on_without("a check does not see calls that still wait for an answer"):
        return sum(len(pending_requests(client)) for client in _on(order["domain"]).node.clients)
    return 0


def _ready(order: Mapping[str, Any], _: Mapping[str, Any]) -> bool:
    """Whether each of the node's clients has found a server."""
    return all(client.service_is_ready() for client in _on(order["domain"]).node.clients)


_ORDERS: dict[str, Callable[[Mapping[str, Any], Mapping[str, Any]], Any]] = {
    "has": _has,
    "start": _start,
    "stop": lambda order, _: _on(order["domain"]).stop(),
    "call": _call,
    "read": _read,
    "pending": _pending,
    "ready": _ready,
    "errors": lambda order, _: _on(order["domain"]).errors(),
}


class Obeying:
    """Obeys one order in a thread of its own, so that what a student wrote can neither block nor end the notebook."""

    def __init__(self, order: Mapping[str, Any], names: Mapping[str, Any]) -> None:
        self._answer: dict[str, Any] | None = None
        self._thread = threading.Thread(target=self._obey, args=(order, names), name="course_kit check", daemon=True)
        self._thread.start()

    def _obey(self, order: Mapping[str, Any], names: Mapping[str, Any]) -> None:
        self._answer = obey(order, names)

    def wait(self, timeout: float) -> dict[str, Any] | None:
        """The answer; None if it is not there after `timeout` seconds."""
        self._thread.join(timeout)
        return self._answer

    def interrupt(self) -> None:
        """Have it end, if it still runs: a Python loop at once, a sleep when it is over."""
        if self._thread.is_alive() and self._thread.ident is not None:
            ident = ctypes.c_ulong(self._thread.ident)
            ctypes.pythonapi.PyThreadState_SetAsyncExc(ident, ctypes.py_object(NodeStopped))
