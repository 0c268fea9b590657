"""Runs nodes in the background of a notebook: run, stop, wait_for.

What `rclpy.init(); rclpy.spin(node)` is in a program of its own, `run(Talker)` is in a cell. Each node has an
executor and a thread of its own, as it would have a process of its own on a robot: a callback that blocks stalls
its own node and no other.
"""

from __future__ import annotations

import contextlib
import difflib
import functools
import sys
import threading
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Any, TypeVar

from rclpy.executors import Executor
from rclpy.node import Node

from course_kit.base.arguments import NODE, shown
from course_kit.base.long_tasks import long_task
from course_kit.base.programs import processes
from course_kit.base.programs.child_process import Process
from course_kit.lab.background import duplicate_names, guards
from course_kit.lab.node_logs import rosout
from course_kit.ros.private_api import going_on_without
from course_kit.ros.private_api.rclpy_parts import end_child_loggers
from course_kit.ros.spinning import context, errors
from course_kit.ros.spinning.executors import SpinThread
from course_kit.ros.spinning.nodes import construct, made_by

NodeType = TypeVar("NodeType", bound=Node)
# Python lets a busy cell keep the interpreter for 5 ms before a callback gets its turn; a tenth of that halves the
# delay of timers beside a busy cell.
SWITCH_INTERVAL = 0.0005


@dataclass(frozen=True)
class _Running:
    """A node in the background."""

    node: Node
    name: str  # fully qualified
    made_from: tuple[str, ...]  # the class and arguments that run() was given
    spinning: SpinThread
    start: int  # which start of the ROS context it belongs to


_lock = threading.RLock()
_running: dict[str, _Running] = {}
_stuck: dict[str, _Running] = {}  # those whose callback does not return, though they were stopped
# What is called with an event and the name of a node: "starting", "running", "failed", "stopped", "stuck".
listeners: set[Callable[[str, str], None]] = set()
_constructing = threading.local()  # its `name` is that of the node whose constructor runs in this thread


def _tell(event: str, name: str) -> None:
    for listener in list(listeners):
        listener(event, name)


def run(node: Callable[..., NodeType], *args: Any, executor: Executor | None = None, **kwargs: Any) -> NodeType:
    """Run a node in the background and return it.

    Hand over the class, with the constructor's arguments if it has any: `run(Talker)`. An earlier node of the same
    name or from the same class and arguments is destroyed first, so a cell can be run again. A node that exists
    already can be handed over too. `executor` is an rclpy executor for this node alone, such as a
    MultiThreadedExecutor; without one the node has a single thread. Raises TypeError for what is neither a Node class
    nor a node.
    """
    if executor is not None and not isinstance(executor, Executor):
        raise TypeError(f"executor is one of rclpy's, such as MultiThreadedExecutor(), not {shown(executor)}")
    guards.install()
    start = context.start()
    rosout.collect()
    sys.setswitchinterval(SWITCH_INTERVAL)
    _forget_ended(start)
    made_from: tuple[str, ...] = ()
    _constructing.name = ""
    if isinstance(node, Node):
        if args or kwargs:
            raise TypeError("arguments are for the constructor: run(NodeClass, ...), not for a node that exists")
        made: Node = node
        _replace(made.get_fully_qualified_name(), unless=made)
        if made in nodes():
            return node  # type: ignore[return-value]
    else:
        made_from = _recipe(node, args, kwargs)
        for earlier in [r for r in list(_running.values()) if r.made_from == made_from]:
            _end(earlier)
        made = _construct(node, args, kwargs)
    name = made.get_fully_qualified_name()
    _replace(name, unless=made)
    if name != _constructing.name:
        _announce(name)
    spinning = SpinThread(made, lambda error: errors.report(name, error), executor)
    with _lock:
        _running[name] = _Running(made, name, made_from, spinning, start)
    spinning.start()
    _tell("running", name)
    return made  # type: ignore[return-value]


def _announce(name: str) -> None:
    """A node of this name is about to run: before its constructor, so that what that logs finds its place."""
    errors.clear(name)
    errors.reporting.add(name)
    _tell("starting", name)


def _recipe(node: Any, args: tuple[Any, ...], kwargs: dict[str, Any]) -> tuple[str, ...]:
    """What identifies a node made by the same call again, also after its class was redefined."""
    if isinstance(node, type) and not issubclass(node, Node):
        raise TypeError(
            f"run() takes a class derived from rclpy.node.Node, and {node.__name__} is not one. "
            f"Write: class {node.__name__}(Node)"
        )
    if not callable(node):
        raise TypeError(f"run() takes a Node class or a node, not {type(node).__name__}. Write: run(Talker)")
    name = f"{getattr(node, '__module__', '')}.{getattr(node, '__qualname__', repr(node))}"
    return (name, repr(args), repr(sorted(kwargs.items())))


def _make(of: type[Node], node: Node, plain: Callable[..., None], node_name: str, options: dict[str, Any]) -> None:
    """Make a node once an earlier one of its name is destroyed: else rcl would refuse it a /rosout publisher.

    What a class makes beside its own node is made as it says.
    """
    if type(node) is of:
        namespace = (options.get("namespace") or "").strip("/")
        name = "/" + "/".join(part for part in (namespace, node_name) if part)
        _replace(name)
        _constructing.name = name
        _announce(name)
    plain(node, node_name, **options)


def _construct(node: Callable[..., Node], args: tuple[Any, ...], kwargs: dict[str, Any]) -> Node:
    if not isinstance(node, type):
        made = node(*args, **kwargs)
        if not isinstance(made, Node):
            raise TypeError(f"run() got a callable that returned {type(made).__name__}, not a node")
        return made
    try:
        with made_by(functools.partial(_make, node)):
            return construct(node, args, kwargs)
    except BaseException:
        if _constructing.name:  # it was announced
            _tell("failed", _constructing.name)
        raise


def _replace(name: str, unless: Node | None = None) -> None:
    earlier = _running.get(name)
    if earlier is not None and earlier.node is not unless:
        _end(earlier)
    if said := still_stuck(name):
        raise RuntimeError(f"{said} Or run a node of another name.")


def still_stuck(name: str) -> str:
    """That a node cannot be stopped, where its callback is, and the cure; '' once it has returned."""
    entry = _stuck.get(name)
    if entry is None:
        return ""
    stall = entry.spinning.stall()
    if stall is None:
        if _stuck.pop(name, None) is not None:
            entry.spinning.close()  # what it held until now
        return ""
    return (
        f"{name} is not stopped: a callback of it has been in {stall.place} since {stall.clock}, which Python cannot "
        f"interrupt, so it ends by itself or when the kernel is restarted (menu Kernel, Restart)."
    )


def remarks(name: str) -> list[str]:
    """What is to be said of a node, though nothing was raised: each a sentence with cause and cure."""
    if said := still_stuck(name):
        return [said]
    entry = _running.get(name)
    if entry is None:
        return []
    stall = entry.spinning.stall()
    blocked = (
        f"A callback has not returned since {stall.clock} ({stall.place}), and until it does this node does nothing "
        f"else: return from a callback soon, and let a timer do what comes later."
        if stall is not None and stall.is_long
        else ""
    )
    return [said for said in (blocked, duplicate_names.told(name), context.elsewhere()) if said]


def _forget_ended(start: int) -> None:
    """Drop the nodes of a context that has ended since: rclpy.shutdown() took them with it."""
    for entry in list(_running.values()):
        if entry.start != start or not entry.spinning.is_alive:
            _end(entry)


def stop(*which: Node | str | type[Node] | Process) -> None:
    """Stop and destroy nodes: given by themselves, by name or by class. Stop processes, as start() returned them.

    Without argument, all of both. A callback that still runs is interrupted. Stopping what is stopped does nothing.
    Raises ValueError for a name that does not run, RuntimeError if a callback cannot be interrupted.
    """
    with long_task("stopping nodes and processes"):
        for process in [one for one in which if isinstance(one, Process)]:
            process.stop()
        if not which:
            processes.stop_all()
        selected = [r for one in which if not isinstance(one, Process) for r in _select(one)]
        ending = selected if which else [*_running.values(), *_stuck.values()]
        for entry in ending:
            _end(entry)
    if stuck := [said for name in {entry.name for entry in ending} if (said := still_stuck(name))]:
        raise RuntimeError("\n".join(stuck))


def _select(which: Node | str | type[Node]) -> list[_Running]:
    running = [*_running.values(), *_stuck.values()]
    if isinstance(which, Node):
        return [r for r in running if r.node is which]
    if isinstance(which, type) and issubclass(which, Node):
        return [r for r in running if which.__qualname__ in {c.__qualname__ for c in type(r.node).__mro__[:-1]}]
    NODE.check("stop() takes nodes, their classes or their names: the name", which)
    name = "/" + which.strip("/")
    found = [r for r in running if r.name == name]
    if not found:
        names = [r.name for r in running]
        near = difflib.get_close_matches(name, names, n=1)
        hint = f" Did you mean {near[0]}?" if near else f" Running: {', '.join(names) or 'none'}."
        raise ValueError(f"no node {name} runs in the background of this notebook.{hint}")
    return found


def _end(entry: _Running) -> None:
    """Destroy a node, unless another thread does so."""
    with _lock:
        if _running.get(entry.name) is not entry:
            return
        del _running[entry.name]
    logger = entry.node.get_logger().name
    entry.spinning.stall()  # where it is, if it cannot be stopped
    entry.spinning.close()
    with going_on_without("action servers of a node that is run again may log to the terminal alone"):
        end_child_loggers(logger)
    if entry.spinning.is_alive and entry.spinning.stall() is not None:
        _stuck[entry.name] = entry
        _tell("stuck in a callback", entry.name)
        return
    _tell("stopped", entry.name)


def nodes() -> list[Node]:
    """The nodes that run in the background, in the order in which they were started."""
    return [r.node for r in list(_running.values()) if r.spinning.is_alive]


@contextlib.contextmanager
def running(*classes: Callable[..., Node], **kwargs: Any) -> Iterator[Any]:
    """Run nodes for the length of a `with` block; gives the node, or a tuple of them if there are several."""
    started: list[Node] = []
    try:
        started.extend(run(one, **kwargs) for one in classes)
        yield started[0] if len(started) == 1 else tuple(started)
    finally:
        for node in reversed(started):
            stop(node)


context.before_stop(stop)
