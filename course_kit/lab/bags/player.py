"""Plays a bag: publishes its messages, as they are, with the spacing with which they were recorded.

Each message has its time on a schedule that is computed from the start, so that delays do not add up. A thread reads
ahead, the calling thread waits and publishes.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any

from rclpy.duration import Duration
from rclpy.publisher import Publisher
from rclpy.qos import QoSProfile, ReliabilityPolicy
from rosgraph_msgs.msg import Clock

from course_kit.base.long_tasks import long_task
from course_kit.base.polling import wait_until
from course_kit.lab.bags import qos as bag_qos
from course_kit.lab.bags.files import OpenBag
from course_kit.lab.bags.read_ahead import END, SLICE, ReadAhead
from course_kit.lab.bags.recorder import BagLogLine
from course_kit.lab.bags.requests import Requests
from course_kit.lab.bags.selection import Selection, service_of
from course_kit.ros.spinning import context
from course_kit.ros.spinning.nodes import quiet_node
from course_kit.ros.subscriptions import topics

NODE = "rosbag2_player"
READ_AHEAD = 1000  # messages


@dataclass(frozen=True)
class PlayOptions:
    """What to play of a bag and how; times in seconds, `until` in nanoseconds as messages have them."""

    rate: float = 1.0
    loop: bool = False
    delay: float = 0.0
    start_offset: float = 0.0
    duration: float | None = None
    until: int | None = None
    selection: Selection = field(default_factory=lambda: Selection(every=True))
    remap: Mapping[str, str] = field(default_factory=dict)
    overrides: Mapping[str, QoSProfile] = field(default_factory=dict)
    clock_rate: float = 0.0
    clock_topics: Selection = field(default_factory=Selection)  # whose messages bring /clock up to date
    read_ahead: int = READ_AHEAD
    starts_paused: bool = False
    sends_requests: bool = False  # in place of the events that tell of them


class BagClock:
    """The time of a bag that plays: where it is now, at which rate it goes, whether it stands still."""

    def __init__(self, start: int, rate: float) -> None:
        self.rate = rate
        self.is_paused = False
        self.jump(start)

    def jump(self, nanoseconds: int) -> None:
        """Be at this time of the bag now."""
        self._bag, self._wall = nanoseconds, time.perf_counter_ns()

    def now(self) -> int:
        """The time of the bag, in nanoseconds."""
        if self.is_paused:
            return self._bag
        return self._bag + int((time.perf_counter_ns() - self._wall) * self.rate)

    def pause(self, is_paused: bool) -> None:
        """Stand still, or go on from there."""
        now = self.now()
        self.is_paused = is_paused
        self.jump(now)

    def set_rate(self, rate: float) -> None:
        """Go on at another rate."""
        self.jump(self.now())
        self.rate = rate

    def until(self, nanoseconds: int) -> float:
        """Seconds from now until the bag is at this time."""
        return (nanoseconds - self.now()) / self.rate * 1e-9


class Player:
    """Publishes the messages of an open bag. `say` gets what rosbag2 would log.

    Raises ValueError if a remapped name cannot be that of a topic. close() it.
    """

    def __init__(self, bag: OpenBag, options: PlayOptions, say: Callable[[BagLogLine], None]) -> None:
        self.bag, self.options = bag, options
        self.say = lambda text, level="INFO": say(BagLogLine(level, NODE, text, time.time_ns()))
        context.start()
        self.node = quiet_node(NODE, with_rosout=True)
        has_messages = any(connection.msgcount for connection in bag.connections)
        self._start = (bag.start if has_messages else 0) + int(options.start_offset * 1e9)
        self.clock = BagClock(self._start, options.rate)
        self.clock.is_paused = options.starts_paused
        self._ticked = 0.0
        self._steps = 0  # messages to publish while the clock is paused
        profile = QoSProfile(depth=1, reliability=ReliabilityPolicy.BEST_EFFORT)
        self._clock_topics = {c.topic for c in bag.connections if options.clock_topics.takes(c.topic, c.msgtype)}
        has_clock = options.clock_rate or self._clock_topics
        self._clock_publisher = self.node.create_publisher(Clock, "/clock", profile) if has_clock else None
        self.say(f"Set rate to {options.rate:g}")
        self.requests: dict[str, Requests] = {}
        try:
            self.publishers = {c.topic: p for c in bag.connections if (p := self._publisher(c)) is not None}
        except Exception:
            self.node.destroy_node()
            raise

    def _publisher(self, connection: Any) -> Publisher | None:
        topic = connection.topic
        if not self.options.selection.takes(topic, connection.msgtype):
            return None
        service = service_of(topic, connection.msgtype) if self.options.sends_requests else None
        try:
            if service is not None:
                self.requests[topic] = Requests(service, connection.msgtype, lambda text: self.say(text, "WARN"))
                return None
            message_type = topics.message_class(connection.msgtype)
        except (ImportError, ValueError) as error:
            self.say(f"Ignoring a topic '{topic}', reason: {str(error).rstrip('.')}.", "WARN")
            return None
        if topic in self.options.overrides:
            self.say(f"Overriding QoS profile for topic {topic}")
            profile = self.options.overrides[topic]
        else:
            profile = bag_qos.to_offer(connection.ext.offered_qos_profiles)
        return self.node.create_publisher(message_type, topics.absolute(self.options.remap.get(topic, topic)), profile)

    @property
    def is_matched(self) -> bool:
        """True if all subscriptions that are known are connected to the publishers."""
        clock = [self._clock_publisher] if self._clock_publisher is not None else []
        return all(
            publisher.get_subscription_count() >= self.node.count_subscribers(publisher.topic_name)
            for publisher in [*self.publishers.values(), *clock]
        ) and all(requests.is_matched for requests in self.requests.values())

    def toggle_pause(self) -> None:
        """Stand still, or go on."""
        self.clock.pause(not self.clock.is_paused)
        self.say("Pausing play." if self.clock.is_paused else "Resuming play.")

    def set_rate(self, rate: float) -> None:
        """Play faster or slower from now on."""
        if rate > 0:
            self.clock.set_rate(rate)
            self.say(f"Set rate to {rate:g}")
        else:
            self.say(f"Failed to set rate to invalid value {rate:g}", "WARN")

    def play_next(self) -> None:
        """Publish one message more while standing still."""
        if self.clock.is_paused:
            self._steps += 1
        else:
            self.say("Called play next, but not in paused state.", "WARN")

    def play(self, tick: Callable[[], None]) -> None:
        """Play to the end, or on and on if `loop`; `tick` is called every so often and may raise to end it."""
        ends = [] if self.options.duration is None else [self._start + int(self.options.duration * 1e9)]
        stop_at = min(ends + ([] if self.options.until is None else [self.options.until]), default=None)
        self.say(f"Playback until timestamp: {-1 if stop_at is None else stop_at}")
        while True:
            if self.options.delay > 0:
                self.say(f"Sleep {int(self.options.delay * 1e9)} ns")
                wait_until(tick, self.options.delay, SLICE)
            with long_task(f"playing {self.bag.path.name}", self._length(stop_at)) as task:
                task.done = lambda: (self.clock.now() - self._start) * 1e-9
                self._play_once(tick, stop_at)
            if not self.options.loop:
                break
            tick()
        for publisher in self.publishers.values():
            publisher.wait_for_all_acked(Duration(seconds=1))
        for requests in self.requests.values():
            requests.wait_for_answers()

    def _length(self, stop_at: int | None) -> float:
        """Seconds of the bag that are played."""
        end = self.bag.end if stop_at is None else min(stop_at, self.bag.end)
        return max(0.0, (end - self._start) * 1e-9)

    def _play_once(self, tick: Callable[[], None], stop_at: int | None) -> None:
        senders: dict[str, Publisher | Requests] = {**self.publishers, **self.requests}
        connections = [c for c in self.bag.connections if c.topic in senders]
        messages = ReadAhead(self.bag.messages(connections, self._start), self.options.read_ahead)
        publish = {topic: sender.publish for topic, sender in senders.items()}
        try:
            messages.wait_until_filled(tick)
            self.clock.jump(self._start)
            self._next_clock = self._start
            while (item := messages.next(tick)) is not END:
                connection, nanoseconds, data = item
                if stop_at is not None and nanoseconds > stop_at:
                    break
                self._wait_until(nanoseconds, tick)
                if connection.topic in self._clock_topics:
                    self._publish_clock(nanoseconds)
                publish[connection.topic](data)
            while self.clock.is_paused:  # at the end too
                tick()
                time.sleep(SLICE)
        finally:
            messages.close()

    def _wait_until(self, nanoseconds: int, tick: Callable[[], None]) -> None:
        clock = self.clock
        while True:
            if clock.is_paused:
                if self._steps:
                    self._steps -= 1
                    clock.jump(nanoseconds)
                    return
                left = SLICE
            else:
                left = clock.until(nanoseconds)
                if left <= 0:
                    break
            if self.options.clock_rate:
                left = min(left, self._tick_clock())
            time.sleep(min(left, SLICE))
            if clock.is_paused or clock.until(nanoseconds) > 0:
                self._tick(tick)
        if time.monotonic() - self._ticked > SLICE:  # also if the bag is so dense that there is nothing to wait for
            self._tick(tick)

    def _tick(self, tick: Callable[[], None]) -> None:
        self._ticked = time.monotonic()
        tick()

    def _publish_clock(self, nanoseconds: int) -> None:
        assert self._clock_publisher is not None
        message = Clock()
        message.clock.sec, message.clock.nanosec = divmod(nanoseconds, 10**9)
        self._clock_publisher.publish(message)

    def _tick_clock(self) -> float:
        """Publish /clock if it is time for that; return the seconds until it is again."""
        if self.clock.now() >= self._next_clock:
            self._publish_clock(self.clock.now())
            self._next_clock = self.clock.now() + int(1e9 / self.options.clock_rate * self.clock.rate)
        return max(1e-4, self.clock.until(self._next_clock))

    def close(self) -> None:
        """Destroy the publishers and their node, and end the clients."""
        for requests in self.requests.values():
            requests.close()
        self.node.destroy_node()
