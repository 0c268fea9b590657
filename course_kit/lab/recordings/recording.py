"""record(): keeps the messages of topics, still serialised, and decodes them when they are read."""

from __future__ import annotations

import threading
import time
from collections.abc import Iterator
from typing import Any

import numpy.typing as npt

from course_kit.base.arguments import COUNT, SPAN, WAIT, takes
from course_kit.base.long_tasks import long_task
from course_kit.base.polling import wait_until
from course_kit.lab.recordings.buffers import MessageBuffer
from course_kit.lab.recordings.topic_recording import TopicRecording, table
from course_kit.ros.subscriptions import observer_node, topics
from course_kit.ros.subscriptions.listening import Listening
from course_kit.ros.subscriptions.raw_subscriptions import Callback

MAX_BYTES = 1 << 30
FIRST_MESSAGE = 1.0  # seconds given to publishers to find the recording before its seconds count


class RecordingTimeout(TimeoutError):  # noqa: N818  (reads as what happened)
    """The messages asked for did not come in time; `recording` has those that did."""

    def __init__(self, message: str, recording: Recording) -> None:
        super().__init__(message)
        self.recording = recording


def _of_one(name: str, described: str) -> property:
    """What a recording of one topic has, as the recording of that topic has it."""
    return property(lambda recording: getattr(recording._only(name), name), doc=described)


class Recording(Listening):
    """A recording of one or more topics: `recording['/topic']` is what one of them brought up to now.

    A recording of one topic can be read without naming it: len(), .times, .messages, .values('x') and so on. While it
    still runs, take `now = recording['/topic']` once where several of these have to fit together.
    """

    def __init__(self, wanted: dict[str, Any], max_bytes: int, keep: int | None, count: int | None) -> None:
        super().__init__()
        self._buffer = MessageBuffer(wanted, max_bytes, keep)
        self._complete = threading.Event()
        self._missing: dict[str, int | None] = dict.fromkeys(wanted, count)
        self.start_ns = time.time_ns()
        self._add_all(wanted)

    def _callback(self, topic: str, message_type: Any) -> Callback:
        append, missing, complete = self._buffer.appender(topic), self._missing, self._complete

        def receive(message: bytes, info: dict[str, Any]) -> None:
            append(message, info["received_timestamp"])

        def receive_until_complete(message: bytes, info: dict[str, Any]) -> None:
            if still := missing[topic]:
                append(message, info["received_timestamp"])
                missing[topic] = still - 1
                if not any(missing.values()):
                    complete.set()

        return receive if missing[topic] is None else receive_until_complete

    @property
    def dropped(self) -> int:
        """How many of the oldest messages went because the recording was full."""
        return sum(self._buffer.counts(topic)[1] for topic in self.topics)

    @property
    def lost(self) -> int:
        """How many messages never arrived, as far as the middleware noticed."""
        return sum(s.lost for s in self._subscriptions.values())

    @property
    def nbytes(self) -> int:
        """Bytes reserved for messages, max_bytes at most."""
        return self._buffer.nbytes

    @property
    def duration(self) -> float:
        """Seconds from the start to the end, or to now."""
        return (self._now() - self.start_ns) * 1e-9

    def _start_with_first_message(self) -> None:
        """Let the time count from now, when all publishers deliver, or have had their time to begin."""
        wait_until(lambda: all(map(any, map(self._buffer.counts, self.topics))), FIRST_MESSAGE)
        firsts = [one.receive_ns[0] for one in self if len(one)]
        self.start_ns = int(min(firsts, default=time.time_ns()))

    def _fewest(self) -> int:
        """How many messages came of the topic that has the fewest."""
        return min(sum(self._buffer.counts(topic)) for topic in self.topics)

    def stop(self) -> Recording:
        """End the recording; what it has stays. Returns itself; safe to call twice."""
        self._end()
        return self

    def __getitem__(self, topic: str) -> TopicRecording:
        name = topics.absolute(topic)
        if name not in self.topics:
            raise KeyError(f"{name} is not in this recording; it has {', '.join(self.topics)}")
        message_type = self._subscriptions[name].message_type
        return TopicRecording(name, message_type, self._buffer.snapshot(name), self.start_ns)

    def __iter__(self) -> Iterator[TopicRecording]:
        return (self[topic] for topic in self.topics)

    def __len__(self) -> int:
        return sum(self._buffer.counts(topic)[0] for topic in self.topics)

    def __bool__(self) -> bool:
        return True  # not its length: an empty recording is one too

    def __repr__(self) -> str:
        state = "running" if self.is_running else "stopped"
        lost = f", {self.lost:,} lost on the way" if self.lost else ""
        return f"Recording, {state}, {self.duration:.1f} s{lost}\n{table(list(self))}"

    def _only(self, what: str) -> TopicRecording:
        if len(self.topics) > 1:
            raise ValueError(
                f"the recording has {len(self.topics)} topics: say which, recording['{self.topics[0]}'].{what}"
            )
        return self[self.topics[0]]

    type = _of_one("type", "The name of the message type, such as 'turtlesim/msg/Pose'.")
    receive_ns = _of_one("receive_ns", "When each message came: nanoseconds since the epoch, shape (messages,).")
    times = _of_one("times", "When each message came: seconds since the recording began, shape (messages,).")
    stamps = _of_one("stamps", "The messages' own stamps in seconds, shape (messages,); None if the type has none.")
    messages = _of_one("messages", "The messages themselves, read when they are asked for.")

    def values(self, path: str) -> npt.NDArray[Any]:
        """A field of every message, such as 'linear.x', in the field's own unit, shape (messages, ...)."""
        return self._only(f"values({path!r})").values(path)


@takes(seconds=SPAN | None, count=COUNT | None, keep=COUNT | None, max_bytes=COUNT, timeout=WAIT)
def record(
    *wanted: Any,
    seconds: float | None = None,
    count: int | None = None,
    keep: int | None = None,
    max_bytes: int = MAX_BYTES,
    timeout: float = 10.0,
) -> Recording:
    """Record topics in the background until .stop(), or for some `seconds`, or until `count` messages of each came.

    A type after a topic, as in record('/x', String), records it before anybody publishes it; else its publisher is
    waited for, up to `timeout` seconds. `keep` keeps the last messages of each topic only, `max_bytes` bounds all
    together: the oldest go first and are counted in .dropped. With `seconds` (from the first message on) or `count`
    the call returns when they are there. Raises TimeoutError for a topic that nobody publishes and for a count that
    does not come within `timeout` seconds; that error's .recording has what came.
    """
    pairs = topics.with_types(wanted)
    # All types are looked up first, so that recording starts for all topics at once.
    recording = Recording(topics.look_up(observer_node.node(), pairs, timeout), max_bytes, keep, count)
    if count is None and seconds is None:
        return recording
    limit = timeout if seconds is None else seconds
    try:
        if seconds is not None:
            recording._start_with_first_message()
        what = f"recording {', '.join(recording.topics)}"
        total, unit = (seconds, "s") if count is None else (count, "messages")
        with long_task(what, total, unit) as task:
            if count is not None:
                task.done = recording._fewest
            complete = recording._complete.wait(limit)
    finally:
        recording.stop()
    if seconds is None and not complete:
        raise RecordingTimeout(_what_is_missing(recording, count or 0, limit), recording)
    return recording


def _what_is_missing(recording: Recording, count: int, limit: float) -> str:
    parts = []
    for topic in recording:
        if len(topic) < count:
            part = f"{len(topic)} of {count} messages of {topic.topic} came within {limit:g} s"
            span = topic.times[-1] - topic.times[0] if len(topic) > 1 else 0.0
            needed = count * span / (len(topic) - 1) if span else 0.0
            if needed > limit:
                part += f": at its rate {count} take about {needed:.1f} s, so pass timeout={2 * needed:.0f}."
            elif len(topic):
                silence = recording.duration - topic.times[-1]
                part += f", and none in its last {silence:.1f} s: has its publisher stopped?"
            else:
                part += ": is its publisher running? rates() shows what arrives on a topic."
            parts.append(part)
    return "; ".join(parts) + " The error's .recording has what came."
