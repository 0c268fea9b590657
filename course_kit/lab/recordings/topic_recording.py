"""The recording of one topic, as arrays and as messages."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any

import numpy as np
import numpy.typing as npt
from rclpy.serialization import deserialize_message

from course_kit.base import text
from course_kit.base.arguments import TEXT, takes
from course_kit.lab.recordings import fields
from course_kit.lab.recordings.buffers import Int64s, Serialised
from course_kit.ros.subscriptions import topics


class Messages(Sequence[Any]):
    """The messages of one topic as rclpy messages, each decoded when it is asked for."""

    def __init__(self, serialised: Serialised, message_type: Any, indices: range | None = None) -> None:
        self._serialised = serialised
        self._message_type = message_type
        self._indices = range(len(serialised)) if indices is None else indices

    def __len__(self) -> int:
        return len(self._indices)

    def __getitem__(self, index: int | slice) -> Any:
        if isinstance(index, slice):
            return Messages(self._serialised, self._message_type, self._indices[index])
        try:
            place = self._indices[index]
        except IndexError:
            raise IndexError(f"there is no message {index}: the recording has {len(self)}") from None
        return deserialize_message(self._serialised[place], self._message_type)

    def __iter__(self) -> Iterator[Any]:
        return (deserialize_message(self._serialised[place], self._message_type) for place in self._indices)

    def __repr__(self) -> str:
        return f"<{len(self)} messages of {topics.type_name(self._message_type)}>"


class TopicRecording:
    """What was recorded of one topic up to one moment; messages that come later do not change it."""

    def __init__(self, topic: str, message_type: Any, serialised: Serialised, start_ns: int) -> None:
        self.topic = topic
        self.message_type = message_type
        self.type = topics.type_name(message_type)
        self.serialised = serialised
        self.start_ns = start_ns
        self.messages = Messages(serialised, message_type)

    def __len__(self) -> int:
        return len(self.serialised)

    def __repr__(self) -> str:
        return table([self])

    @property
    def dropped(self) -> int:
        """How many of the oldest messages went because the recording was full."""
        return self.serialised.dropped

    @property
    def receive_ns(self) -> Int64s:
        """When each message arrived: int64, nanoseconds since the epoch, shape (messages,)."""
        return self.serialised.receive_ns

    @property
    def times(self) -> npt.NDArray[np.float64]:
        """When each message arrived: float64, seconds since the recording started, shape (messages,)."""
        return np.asarray((self.receive_ns - self.start_ns) * 1e-9, np.float64)

    @property
    def stamps(self) -> npt.NDArray[np.float64] | None:
        """The time stamp in each message: float64, seconds, shape (messages,); None if the type has none."""
        return fields.stamps(self.serialised, self.message_type)

    @takes(path=TEXT)
    def values(self, path: str) -> npt.NDArray[Any]:
        """One numeric field of every message, such as 'x' or 'pose.position.x'.

        Shape (messages,), or (messages, length) for an array field. Raises ValueError for a field that is not there
        or not numeric.
        """
        return fields.values(self.messages, self.message_type, path)


def table(recorded: list[TopicRecording]) -> str:
    """One line for each topic, under a heading."""
    rows: list[tuple[str, ...]] = [("topic", "type", "messages", "from", "to", "bytes", "dropped")]
    for one in recorded:
        span = [f"{t:.2f} s" for t in one.times[[0, -1]]] if len(one) else ["-", "-"]
        size = f"{int(one.serialised.sizes.sum()):,}"
        rows.append((one.topic, one.type, f"{len(one):,}", *span, size, f"{one.dropped:,}"))
    return text.table(rows, left=2)
