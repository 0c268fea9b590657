"""The notebook's side of a check: does what the checker orders, and judges nothing.

A student's class is made anew on the *stage*: a ROS context of this process in a domain of the checker's. There its
node meets only what the exercise is about, and the nodes that the student runs are left alone.
"""

from __future__ import annotations

import atexit
import contextlib
import threading
import traceback
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from rclpy.context import Context
from rclpy.executors import MultiThreadedExecutor
from rclpy.node import Node

from course_kit.examining.channel import as_json
from course_kit.internals import going_on_without
from course_kit.internals.rclpy_parts import pending_requests
from course_kit.spinning import NodeStopped
from course_kit.spinning import context as ros_context
from course_kit.spinning.executors import SpinThread, interrupt
from course_kit.spinning.nodes import WITHOUT_DESCRIPTIONS, construct, quiet_node, with_base

STOP_TIMEOUT = 0.5
INTERRUPT_TIMEOUT = 0.5
NOT_IN_TIME = {"error": "it did not return in time"}
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
        self.errors: list[str] = []  # what the callbacks of the node raised

    def start(self, node_class: type[Node], arguments: list[Any], threads: bool) -> None:
        """Make a node of the class and spin it; whatever its constructor raises is raised."""
        self.stop()
        node = construct(with_base(node_class, _OnStage, _course_kit_context=self._context), arguments, {})
        if node.context is not self._context:
            node.destroy_node()
            raise TypeError(f'{node_class.__name__}.__init__ must begin with super().__init__("name of the node")')
        executor = MultiThreadedExecutor(num_threads=THREADS, context=self._context) if threads else None
        name = node.get_fully_qualified_name()
        self.errors.clear()
        self._spinning = SpinThread(node, lambda error: self._note(name, error), executor).start()

    def _note(self, name: str, error: Exception) -> None:
        text = f"A callback of {name} raised {described(error)}."
        if text not in self.errors[-1:] and len(self.errors) < KEPT_ERRORS:
            self.errors.append(text)

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


def obey(order: Mapping[str, Any], names: Mapping[str, Any], timeout: float) -> dict[str, Any]:
    """Do what an order says, with the notebook's variables `names`; return {"value": …} or {"error": …}.

    In a thread of its own, so that what a student wrote can neither block nor end the notebook; what has not returned
    after `timeout` seconds is interrupted.
    """
    answers: list[dict[str, Any]] = []
    work = threading.Thread(target=lambda: answers.append(_answer(order, names)), name="course_kit check", daemon=True)
    work.start()
    work.join(timeout)
    if answers:
        return answers[0]
    interrupt(work)
    work.join(INTERRUPT_TIMEOUT)
    return NOT_IN_TIME


def _answer(order: Mapping[str, Any], names: Mapping[str, Any]) -> dict[str, Any]:
    try:
        return {"value": _do(order, names)}
    except NodeStopped:
        return NOT_IN_TIME
    except BaseException as error:  # a student's class may raise anything, SystemExit too
        return {"error": f"{type(error).__name__}: {error}".splitlines()[0], "trace": described(error)}


def _do(order: Mapping[str, Any], names: Mapping[str, Any]) -> Any:
    if order["do"] == "has":
        return isinstance(names.get(order["node_class"]), type)
    host = _on(order["domain"])
    match order["do"]:
        case "start":
            node_class, name = names[order["node_class"]], order["node_class"]
            if not issubclass(node_class, Node):
                raise TypeError(f"{name} is not derived from rclpy.node.Node. Write: class {name}(Node)")
            host.start(node_class, [], order["threads"])
        case "stop":
            host.stop()
        case "call":
            return as_json(getattr(host.node, order["method"])(*order["arguments"]))
        case "read":
            return as_json(getattr(host.node, order["attribute"]))
        case "pending":  # how many calls of the node's clients still wait for an answer
            with going_on_without("a check does not see calls that still wait for an answer"):
                return sum(len(pending_requests(client)) for client in host.node.clients)
        case "ready":  # whether each of the node's clients has found a server
            return all(client.service_is_ready() for client in host.node.clients)
        case "errors":  # what the callbacks of the node raised
            return list(host.errors)
    return None


def described(error: BaseException) -> str:
    """What was raised, and the lines of the student's that led there."""
    frames = [f for f in traceback.extract_tb(error.__traceback__) if not _is_plumbing(Path(f.filename))]
    where = "".join(f", in line {f.lineno} of {f.name}: `{f.line}`" for f in frames[-1:])
    return f"{type(error).__name__}: {error}{where}"


def _is_plumbing(path: Path) -> bool:
    return PACKAGE in path.parents or "rclpy" in path.parts or "site-packages" in path.parts
