"""The notebook's side of a check: does what the checker orders, and judges nothing.

A student's class is made anew in the *test domain*: a ROS context of this process in a domain of the checker's. There
its node meets only what the exercise is about, and the nodes that the student runs are left alone.
"""

from __future__ import annotations

import atexit
import contextlib
import contextvars
import threading
import traceback
from collections.abc import Callable, Mapping, Sequence
from contextvars import ContextVar
from pathlib import Path
from typing import Any

import numpy as np
from rclpy.context import Context
from rclpy.executors import MultiThreadedExecutor
from rclpy.node import Node
from rclpy.parameter import Parameter
from rclpy.utilities import get_default_context

from course_kit.exercises.in_notebook import answer_cell
from course_kit.exercises.protocol.channel import as_json
from course_kit.ros.causes import with_cause
from course_kit.ros.causes.frames import is_plumbing
from course_kit.ros.private_api import going_on_without
from course_kit.ros.private_api.rclpy_action_parts import blocks
from course_kit.ros.private_api.rclpy_parts import choose_default_context, pending_requests
from course_kit.ros.spinning import NodeStopped
from course_kit.ros.spinning import context as ros_context
from course_kit.ros.spinning.executors import SpinThread, interrupt, spinning_now
from course_kit.ros.spinning.nodes import WITHOUT_DESCRIPTIONS, actions_of, construct, destroy, made_by, quiet_node

STOP_TIMEOUT = 0.5
INTERRUPT_TIMEOUT = 0.5
NOT_IN_TIME = {"error": "it did not return in time"}
KEPT_ERRORS = 20
THREADS = 4  # of a MultiThreadedExecutor, where an exercise asks for one


# What rclpy takes for the default context in threads of the test domain: an answer may make executors and nodes.
_default: ContextVar[Context | None] = ContextVar("test domain", default=None)


class AnswerHost:
    """A context in a domain of its own, with at most one answer: a student's node, and what that makes beside it."""

    def __init__(self, domain: int) -> None:
        self.domain = domain
        ros_context.start()  # the first context of a process sets its logging up
        self._context = ros_context.separate(domain, "LOCALHOST")
        # For an answer it is the domain in which it runs elsewhere.
        self._context.get_domain_id = get_default_context().get_domain_id  # type: ignore[method-assign]
        with going_on_without("what an answer makes beside its node is in the notebook's domain"):
            choose_default_context(_default.get)
        # Keeps the participant alive between checks, so that discovery need not begin again. Its name is what the
        # checker knows the participant by.
        self._keeper: Node | None = None
        self._spinning: SpinThread | None = None
        self._made: list[Node] = []
        self._as_made = contextvars.copy_context()
        self._given: list[Parameter] = WITHOUT_DESCRIPTIONS  # to each node of the answer
        self.errors: list[str] = []  # what the callbacks of the node raised

    def start(
        self,
        node_class: type[Node],
        keeper: str = "_ros2cli",
        threads: bool | None = False,
        use_sim_time: bool = False,
    ) -> None:
        """Make a node of the class and spin it; whatever its constructor raises is raised.

        `keeper`: the name of a hidden node beside it. `threads`: whether with a MultiThreadedExecutor; None: if an
        action of the node blocks a thread. `use_sim_time`: whether its nodes follow /clock, as `run(…)` of the chapter
        has them do.
        """
        self.stop()
        earlier, self._keeper = self._keeper, quiet_node(keeper, self._context)
        if earlier is not None:
            earlier.destroy_node()
        self.errors.clear()
        entered = _default.set(self._context)
        try:
            self._given = [*WITHOUT_DESCRIPTIONS, *([Parameter("use_sim_time", value=True)] if use_sim_time else [])]
            with made_by(self._make):
                node = construct(node_class, [], {})
                if threads is None:
                    threads = any(map(blocks, actions_of(node)))
                executor = MultiThreadedExecutor(num_threads=THREADS, context=self._context) if threads else None
                name = node.get_fully_qualified_name()
                self._as_made = contextvars.copy_context()
                self._spinning = SpinThread(node, lambda error: self._note(name, error), executor).start()
        finally:
            _default.reset(entered)

    def _make(self, node: Node, plain: Callable[..., None], name: str, options: dict[str, Any]) -> None:
        """Make a node of the answer in the test domain.

        It has no /rosout: rcl keeps one publisher for each name in a process, and that is the one of the node of the
        same name that the student may have running.
        """
        if options.get("context") not in (None, self._context):
            raise TypeError(f"the node {name} is made in a context of its own: leave `context=` out")
        overrides = [*(options.get("parameter_overrides") or []), *self._given]
        options |= {"context": self._context, "enable_rosout": False, "parameter_overrides": overrides}
        self._made.append(node)
        plain(node, name, **options)

    def _note(self, name: str, error: Exception) -> None:
        text = f"A callback of {name} raised {described(error)}"
        if text not in self.errors[-1:] and len(self.errors) < KEPT_ERRORS:
            self.errors.append(text)

    @property
    def node(self) -> Node:
        """The student's node. RuntimeError if none is in the test domain."""
        if self._spinning is None:
            raise RuntimeError("there is no node in the test domain")
        return self._spinning.node

    def call(self, method: str, arguments: Sequence[Any]) -> Any:
        """Call a method of the student's node; what that makes is in the test domain, too."""
        return self._as_made.copy().run(getattr(self.node, method), *arguments)

    @property
    def clients(self) -> list[Any]:
        """The clients of the student's node, and of those that it made beside it."""
        return [client for node in self._made for client in node.clients]

    def stop(self) -> None:
        """Stop and destroy the node."""
        ending, self._spinning = self._spinning, None
        if ending is not None:
            ending.close(STOP_TIMEOUT)
        beside, self._made = self._made[1:], []
        for node in beside:
            destroy(node)

    def close(self) -> None:
        """Leave the domain."""
        self.stop()
        with contextlib.suppress(Exception):
            if self._keeper is not None:
                self._keeper.destroy_node()
        with contextlib.suppress(Exception):
            self._context.try_shutdown()


_host: AnswerHost | None = None


def close() -> None:
    """Leave the test domain, if it was entered."""
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
    match order["do"]:
        case "has":
            return isinstance(names.get(order["node_class"]), type)
        case "has function":
            return callable(names.get(order["function"]))
        case "missing":  # why there is no class or function of that name
            return answer_cell.why_missing(order["name"])
        case "compute":  # what a function of the notebook returns; lists come to it as arrays
            arguments = [np.array(one) if isinstance(one, list) else one for one in order["arguments"]]
            return as_json(names[order["function"]](*arguments))
    host = _on(order["domain"])
    match order["do"]:
        case "start":
            node_class, name = names[order["node_class"]], order["node_class"]
            if not issubclass(node_class, Node):
                raise TypeError(f"{name} is not derived from rclpy.node.Node. Write: class {name}(Node)")
            threads = order["threads"]
            with_threads = threads or _has_threads(name, names) if threads is not False else False
            host.start(node_class, order["keeper"], with_threads, order.get("use_sim_time", False))
        case "stop":
            host.stop()
        case "call":
            return as_json(host.call(order["method"], order["arguments"]))
        case "read":
            return as_json(getattr(host.node, order["attribute"]))
        case "pending":  # how many calls of its clients still wait for an answer
            with going_on_without("a check does not see calls that still wait for an answer"):
                # One that is done goes when its executor spins again.
                return sum(not future.done() for client in host.clients for future in pending_requests(client))
        case "ready":  # whether each of its clients has found a server
            return all(client.service_is_ready() for client in host.clients)
        case "group":  # the kind of callback group that a service of the node is in
            services = [each for each in host.node.services if each.service_name == order["service"]]
            return type(services[0].callback_group).__name__ if services else None
        case "errors":  # what the callbacks of the node raised
            return list(host.errors)
    return None


def _has_threads(name: str, names: Mapping[str, Any]) -> bool | None:
    """True if the notebook runs a node of the class of this name with a MultiThreadedExecutor, else None."""
    there = [spinning.node for spinning in spinning_now()] + [one for one in names.values() if isinstance(one, Node)]
    # A node knows its executor also after it was taken from it.
    executors = [(one, one.executor) for one in there if type(one).__name__ == name]
    return any(isinstance(each, MultiThreadedExecutor) and one in each.get_nodes() for one, each in executors) or None


def described(error: BaseException) -> str:
    """What was raised, and the lines of the student's that led there."""
    frames = [f for f in traceback.extract_tb(error.__traceback__) if not _is_library(Path(f.filename))]
    where = "".join(f", in line {f.lineno} of {f.name}: `{f.line}`" for f in frames[-1:])
    return with_cause(f"{type(error).__name__}: {error}{where}", error)


def _is_library(path: Path) -> bool:
    return is_plumbing(path) or "site-packages" in path.parts
