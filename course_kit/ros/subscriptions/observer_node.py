"""The node and the threads that everything which only watches shares: recorder, rates, graph, views, commands.

They are apart from the student's nodes: a student's callback that blocks stalls its own node, not the instruments.
"""

from __future__ import annotations

import functools
import os
import threading
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from rclpy.executors import Executor
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile

from course_kit.base.polling import wait_until
from course_kit.ros.private_api.rclpy_parts import fast_executor
from course_kit.ros.spinning import context, errors, presence
from course_kit.ros.spinning.executors import SpinThread
from course_kit.ros.spinning.nodes import quiet_node
from course_kit.ros.subscriptions import topics
from course_kit.ros.subscriptions.raw_subscriptions import Callback, RawSubscription, Refused, Watcher


@dataclass
class _Instruments:
    """What runs for one start of the ROS context."""

    start: int
    watcher: Watcher
    spinning: SpinThread


_lock = threading.RLock()
_instruments: _Instruments | None = None
_closers: list[Callable[[Node], None]] = []
_name_prefix, _with_rosout = "_course_kit", False


def appear_as(name_prefix: str, with_rosout: bool) -> None:
    """Name the node after this prefix and the process, from its next start on: in a terminal `ros2` looks like ROS's.

    `with_rosout` says whether it has a /rosout publisher, as every plain node.
    """
    global _name_prefix, _with_rosout
    _name_prefix, _with_rosout = name_prefix, with_rosout


def node() -> Node:
    """The node of the instruments, spun in a thread of its own: for clients, timers, publishers and the graph.

    Its name is hidden. Start and restart (after rclpy.shutdown()) are automatic, so ask for it anew at each use.
    """
    return _running().spinning.node


def present() -> Node | None:
    """node() if it is there: asked for so, it does not start ROS where that was shut down."""
    with _lock:
        running = _instruments
    there = running is not None and running.watcher.is_alive and running.spinning.node.context.ok()
    return running.spinning.node if running is not None and there else None


def executor() -> Executor:
    """The executor of node(); what must run in its thread, such as destroying entities, goes to create_task()."""
    return _running().spinning.executor


def before_end(closer: Callable[[Node], None]) -> None:
    """Have `closer(node)` called for each node of the instruments when it is spun no more, before it is destroyed."""
    if closer not in _closers:
        _closers.append(closer)


def subscribe(
    topic: str, callback: Callback, msg_type: Any | None = None, timeout: float = 10.0, with_kept: bool = True
) -> RawSubscription:
    """Have `callback(serialised message, message info)` called, in the watching thread, for every message of a topic.

    Without `msg_type` (class or name) the type is looked up, which waits up to `timeout` seconds for the topic. The
    QoS follows the publishers; without `with_kept` nothing comes that was published before. Raises TimeoutError if
    nobody publishes the topic, TypeError if its type is another or two, ValueError for a bad name. End it with
    .close().
    """
    name = topics.absolute(topic)
    watcher = _running().watcher
    if msg_type is None:
        msg_type = topics.wait_for_type(watcher.node, name, timeout)
    message_type = topics.message_class(msg_type) if isinstance(msg_type, str) else msg_type
    topics.check_type(watcher.node, name, topics.type_name(message_type))
    published = topics.publishers(watcher.node, name)
    qos = topics.qos_for(name, published)
    if not with_kept:
        qos.durability = DurabilityPolicy.VOLATILE
    subscription = watcher.subscribe(name, message_type, qos, callback)
    try:
        wait_until(lambda: subscription.publisher_count >= len(published), topics.MATCH_TIMEOUT)
    except BaseException:  # Ctrl-C: the caller has nothing to close
        subscription.close()
        raise
    return subscription


def subscribe_exactly(
    topic: str, callback: Callback, message_type: Any, qos: QoSProfile, on_refused: Refused | None = None
) -> RawSubscription:
    """As subscribe(), with this QoS at first; if a publisher offers less, `on_refused(policy)` is called.

    Without it less is asked for then.
    """
    return _running().watcher.subscribe(topic, message_type, qos, callback, on_refused)


def _running() -> _Instruments:
    """The instruments of the current ROS context; made if there are none yet."""
    global _instruments
    start = context.start()
    context.before_stop(stop)
    with _lock:
        if _instruments is not None:
            if _instruments.start == start and _instruments.watcher.is_alive:
                return _instruments
            stop()  # those of a context that was shut down
        made = quiet_node(f"{_name_prefix}_{os.getpid()}", with_rosout=_with_rosout)
        presence.end()
        report = functools.partial(errors.report, made.get_fully_qualified_name())
        spinning = SpinThread(made, report, fast_executor(made.context)).start()
        _instruments = _Instruments(start, Watcher(made, report), spinning)
        return _instruments


def stop() -> None:
    """End the threads, then the node; the next use starts them again."""
    global _instruments
    with _lock:
        ending, _instruments = _instruments, None
    if ending is None:
        return
    ending.watcher.stop()
    ending.spinning.stop(2.0)
    for closer in _closers:
        closer(ending.spinning.node)
    ending.spinning.close()
