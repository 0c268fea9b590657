"""Records topics into a bag: serialised messages as they come, with the time at which the middleware received them.

Three threads: one looks for topics, the watcher of the raw subscriptions puts messages into a queue, one writes them.
So neither a slow disk nor a busy cell loses messages, as long as the queue has room.
"""

from __future__ import annotations

import contextlib
import os
import sqlite3
import threading
import time
from collections import deque
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from queue import SimpleQueue
from typing import TYPE_CHECKING, Any, NamedTuple

from rclpy.qos import QoSProfile
from rclpy.topic_endpoint_info import TopicEndpointInfo

from course_kit.lab.bags import qos as bag_qos
from course_kit.lab.bags import types as bag_types
from course_kit.lab.bags.selection import Selection, service_of
from course_kit.ros.graph import graph
from course_kit.ros.spinning import context, errors
from course_kit.ros.spinning.nodes import quiet_node
from course_kit.ros.subscriptions import topics
from course_kit.ros.subscriptions.listening import close_all
from course_kit.ros.subscriptions.raw_subscriptions import RawSubscription, Watcher

if TYPE_CHECKING:
    from course_kit.lab.bags.writer import BagWriter

LOOK_PERIOD = 0.1  # seconds between two looks at the graph
WRITE_PERIOD = 0.02
FLUSH_PERIOD = 0.5  # what a killed recorder loses at most, in seconds
BACKLOG = 512 * 1024 * 1024  # bytes that wait to be written; what comes beyond that is lost
NODE = "rosbag2_recorder"
RECORDER, TRANSPORT, CPP = NODE, "rosbag2_transport", "rosbag2_cpp"


class BagLogLine(NamedTuple):
    """What rosbag2 would log, and when (nanoseconds since the epoch)."""

    level: str
    logger: str
    text: str
    stamp: int


@dataclass(eq=False)
class Recorder:
    """One recording, from start() to stop(); what it has to say comes out of `log`, a queue of BagLogLine."""

    writer: BagWriter
    selection: Selection
    overrides: Mapping[str, QoSProfile] = field(default_factory=dict)
    node_name: str = NODE
    look_period: float = LOOK_PERIOD
    looks_on: bool = True
    is_paused: bool = False
    log: SimpleQueue[BagLogLine] = field(default_factory=SimpleQueue)
    error: str | None = None
    _subscriptions: dict[str, RawSubscription] = field(default_factory=dict)
    _queue: deque[tuple[str, int, bytes]] = field(default_factory=deque)
    _said: set[str] = field(default_factory=set)
    _received: int = 0  # bytes, by the watching thread
    _written: int = 0  # bytes, by the writing thread
    dropped: int = 0  # messages that came while too much was waiting to be written
    _ending: threading.Event = field(default_factory=threading.Event)
    _last: threading.Event = field(default_factory=threading.Event)
    _threads: list[threading.Thread] = field(default_factory=list)

    def start(self) -> None:
        """Subscribe to what is there, and go on in the background."""
        context.start()
        self.node = quiet_node(self.node_name, with_rosout=True)
        name = self.node.get_fully_qualified_name()
        self._watcher = Watcher(self.node, lambda error: errors.report(name, error))
        context.before_stop(self.stop)  # the bag is closed before the ROS context ends
        self.say("Listening for topics...")
        self.say("Event publisher thread: Starting")
        self._run(self._write, "writer")
        self._look()
        self.say("Recording...")
        if self.looks_on:
            self._run(self._look_on, "looks for topics")

    def _run(self, target: Callable[[], None], name: str) -> None:
        thread = threading.Thread(target=target, name=f"course_kit bag {name}", daemon=True)
        thread.start()
        self._threads.append(thread)

    @property
    def is_running(self) -> bool:
        """True if messages are still recorded: until stop(), or until writing fails."""
        return bool(self._threads) and not self._ending.is_set() and self.error is None

    @property
    def topics(self) -> list[str]:
        """The topics that are subscribed to, as they were found."""
        return list(self._subscriptions)

    @property
    def is_matched(self) -> bool:
        """True if every topic that is subscribed to has at least one publisher connected."""
        return all(subscription.publisher_count for subscription in self._subscriptions.values())

    @property
    def lost(self) -> int:
        """Messages that the middleware could not deliver."""
        return sum(subscription.lost for subscription in self._subscriptions.values())

    def pause(self, is_paused: bool) -> None:
        """Ignore what comes from now on, or record again."""
        if self.is_paused != is_paused:
            self.is_paused = is_paused
            self.say("Pausing recording." if is_paused else "Resuming recording.")

    def stop(self) -> None:
        """End the recording, with everything that has come until now, and close the bag. Safe to call twice."""
        if self._ending.is_set() or not self._threads:
            return
        self._ending.set()
        context.ended(self.stop)
        writing, *looking = self._threads
        for thread in looking:
            thread.join(5.0)
        close_all(self._subscriptions)  # delivers what has arrived
        self.pause(True)
        self.say("Writing remaining messages from cache to the bag. It may take a while", logger=CPP)
        self._last.set()
        writing.join()
        self._watcher.stop()
        with contextlib.suppress(Exception):  # a student may have shut ROS down
            self.node.destroy_node()
        self.say("Event publisher thread: Exiting")
        self.say("Recording stopped")
        if self.lost:
            self.say(f"Number of messages lost on the transport layer: {self.lost}", "WARN")
        if self.dropped:
            self.say(f"Number of messages lost because they came faster than written: {self.dropped}", "WARN", CPP)

    def say(self, text: str, level: str = "INFO", logger: str = RECORDER) -> None:
        """Log a line."""
        name = self.node_name if logger == RECORDER else logger
        self.log.put(BagLogLine(level, name, text, time.time_ns()))

    def _warn_once(self, text: str, logger: str = TRANSPORT) -> None:
        if text not in self._said:
            self._said.add(text)
            self.say(text, "WARN", logger)

    # Looking for topics, in a thread of its own.

    def _look_on(self) -> None:
        while not self._ending.is_set():
            if self.selection.is_finite and self.selection.wanted <= self._subscriptions.keys():
                self.say("All requested topics are subscribed. Stopping discovery...")
                return
            if self._ending.wait(self.look_period):
                return
            try:
                self._look()
            except Exception as error:
                if self._ending.is_set() or not self.node.context.ok():
                    return
                self._warn_once(f"Failure in topics discovery. Error: {error}", RECORDER)

    def _look(self) -> None:
        """Subscribe to all wanted topics that are there by now."""
        for topic, types in graph.topics(self.node, with_hidden=True).items():
            if topic in self._subscriptions or not any(self.selection.takes(topic, name) for name in types):
                continue
            published = topics.publishers(self.node, topic)
            if self._is_ready(topic, types, published):
                self._subscribe(topic, types[0], published)

    def _is_ready(self, topic: str, types: Sequence[str], published: Sequence[TopicEndpointInfo]) -> bool:
        if len(types) > 1:
            self._warn_once(
                f"Topic '{topic}' has more than one type associated. Only topics with one type are supported"
            )
            return False
        service = service_of(topic, types[0])
        is_service = service is not None and self.selection.takes_service(service)
        if not (self.selection.with_hidden or is_service) and graph.is_hidden(topic):
            self._warn_once("Hidden topics are not recorded. Enable them with --include-hidden-topics")
            return False
        is_wanted = published or self.selection.with_unpublished
        return bool(is_wanted and (not self.selection.without_leaves or self.node.count_subscribers(topic)))

    def _subscribe(self, topic: str, type_name: str, published: Sequence[TopicEndpointInfo]) -> None:
        try:
            message_type = topics.message_class(type_name)
        except (ImportError, ValueError) as error:
            self._warn_once(
                f"Topic '{topic}' has unknown type '{type_name}' associated. "
                f"Only topics with known type are supported. Reason: '{error}'"
            )
            return
        told = (str(endpoint.topic_type_hash) for endpoint in published)
        digest = bag_types.type_hash(type_name) or next((one for one in told if one.startswith("RIHS")), "")
        self.writer.add_topic(topic, type_name, [bag_qos.recorded(p.qos_profile) for p in published], digest=digest)
        if topic in self.overrides:
            self.say(f"Overriding subscription profile for {topic}")
            qos = self.overrides[topic]
        else:
            qos = topics.qos_for(topic, published)
        self._subscriptions[topic] = self._watcher.subscribe(topic, message_type, qos, self._receiver(topic))
        self.say(f"Subscribed to topic '{topic}'")

    def _receiver(self, topic: str) -> Callable[[bytes, dict[str, Any]], None]:
        put = self._queue.append

        def receive(data: bytes, info: dict[str, Any]) -> None:
            if self.is_paused:
                return
            if self._received - self._written > BACKLOG:
                self.dropped += 1
                return
            self._received += len(data)
            put((topic, info["received_timestamp"] or time.time_ns(), data))

        return receive

    # Writing, in a thread of its own.

    def _write(self) -> None:
        from rosbags.rosbag2 import WriterError

        flushed = time.monotonic()
        try:
            while True:
                is_last = self._last.wait(WRITE_PERIOD)
                self._drain()
                if is_last:
                    break
                if time.monotonic() - flushed >= FLUSH_PERIOD:
                    self.writer.flush()
                    flushed = time.monotonic()
            self.writer.close()
        except (OSError, sqlite3.Error, WriterError) as error:
            reason = os.strerror(error.errno) if isinstance(error, OSError) and error.errno else str(error)
            self.error = f"Cannot write to '{self.writer.folder.name}': {reason}. The recording has ended."
            self.is_paused = True
            self.writer.abort()
            self._queue.clear()

    def _drain(self) -> None:
        queue, write = self._queue, self.writer.write
        while queue:
            topic, nanoseconds, data = queue.popleft()
            write(topic, nanoseconds, data)
            self._written += len(data)
