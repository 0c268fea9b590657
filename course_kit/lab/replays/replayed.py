"""The messages that a node published while a bag went through it, and two versions of it compared."""

from __future__ import annotations

import math
import os
import tempfile
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from course_kit.base.arguments import DISTANCE, PATH, takes
from course_kit.base.atomic_files import writing
from course_kit.base.text import numbered, table
from course_kit.lab import bags
from course_kit.lab.node_logs.rosout import LogLines
from course_kit.lab.recordings.buffers import MessageBuffer
from course_kit.lab.recordings.topic_recording import TopicRecording
from course_kit.lab.recordings.topic_recording import table as topic_table
from course_kit.ros.subscriptions import topics

TOLERANCE = 1e-6


class Replayed(Mapping[str, TopicRecording]):
    """What a node published, by topic: `replayed['/turtle1/cmd_vel'].values('linear.x')`. Times are the bag's."""

    def __init__(self, name: str, start_ns: int) -> None:
        self.name = name
        self.start_ns = start_ns
        self.seconds = 0.0  # that the replay took
        self.bag_seconds = 0.0  # that the bag is long
        self.sent: dict[str, int] = {}  # how many messages of each topic went into the node
        self.logs = LogLines()  # what the node logged
        self._buffers: dict[str, tuple[Any, MessageBuffer, Any]] = {}

    def keep(self, topic: str, message_type: Any, nanoseconds: int, data: bytes) -> None:
        """Add a message."""
        if topic not in self._buffers:
            buffer = MessageBuffer([topic])
            self._buffers[topic] = message_type, buffer, buffer.appender(topic)
        self._buffers[topic][2](data, nanoseconds)

    def __getitem__(self, topic: str) -> TopicRecording:
        name = topics.absolute(topic)
        if name not in self._buffers:
            raise KeyError(f"{self.name} published nothing on {name}; it did on {', '.join(self) or 'no topic'}")
        message_type, buffer, _ = self._buffers[name]
        return TopicRecording(name, message_type, buffer.snapshot(name), self.start_ns)

    def __iter__(self) -> Iterator[str]:
        return iter(self._buffers)

    def __len__(self) -> int:
        return len(self._buffers)

    def __repr__(self) -> str:
        sent = ", ".join(f"{count:,} of {topic}" for topic, count in self.sent.items())
        took = f" in {self.seconds:.2f} s: {sent}" if sent else ""
        return f"{self.name}, {self.bag_seconds:.1f} s of a bag{took}\n{topic_table(list(self.values()))}"

    @takes(path=PATH)
    def save(self, path: str | os.PathLike[str], overwrite: bool = False) -> Path:
        """Write it into a bag, such as the reference of a regression test; return the bag's path.

        Raises FileExistsError if the folder is there, unless `overwrite` and it is a bag, which then stays until the
        new one is whole. Raises NotWritten if nothing can be written there.
        """
        folder = bags.refuse_what_is_there(path, overwrite)
        with writing(folder):
            folder.parent.mkdir(parents=True, exist_ok=True)
            with tempfile.TemporaryDirectory(prefix=f".{folder.name[:40]}-", dir=folder.parent) as work:
                new = Path(work, folder.name)
                self._write(new)
                if folder.exists():
                    folder.rename(Path(work, "earlier"))
                new.rename(folder)
        return Path(path)

    def _write(self, folder: Path) -> None:
        from course_kit.lab.bags.writer import BagWriter

        writer = BagWriter(folder)
        for topic in self.values():
            writer.add_topic(topic.topic, topic.type)
        messages = [
            (int(when), topic.topic, data)
            for topic in self.values()
            for when, data in zip(topic.receive_ns, topic.serialised, strict=True)
        ]
        try:
            for when, name, data in sorted(messages, key=lambda one: one[0]):
                writer.write(name, when, data)
            writer.close()
        except BaseException:
            writer.abort()
            raise


@takes(path=PATH)
def load(path: str | os.PathLike[str]) -> Replayed:
    """What was saved in a bag."""
    from course_kit.lab.bags.files import opened

    with opened(path) as bag:
        kept = Replayed(Path(path).name, bag.start)
        classes = {one.topic: topics.message_class(one.msgtype) for one in bag.connections}
        for connection, nanoseconds, data in bag.messages(bag.connections):
            kept.keep(connection.topic, classes[connection.topic], nanoseconds, bytes(data))
    return kept


@dataclass(frozen=True)
class Difference:
    """How one field of a topic differs between two replays, message by message."""

    topic: str
    field: str
    largest: float  # in the field's unit; infinite for what is no number, or of different lengths
    message: int  # where it is largest, from 0
    seconds: float  # the same, in seconds from the bag's start
    first: Any  # the two values there
    second: Any


class Comparison:
    """The comparison of two replays within a tolerance: true or false as a condition, a table when shown."""

    def __init__(self, first: Replayed, second: Replayed, tolerance: float) -> None:
        self.first, self.second, self.tolerance = first, second, tolerance
        self.counts = {
            topic: tuple(len(one[topic]) if topic in one else 0 for one in (first, second))
            for topic in dict.fromkeys([*first, *second])
        }
        self.both = [topic for topic, counts in self.counts.items() if all(counts)]
        self.differences = [one for topic in self.both for one in _differences(first[topic], second[topic])]

    def __bool__(self) -> bool:
        same = all(a == b for a, b in self.counts.values())
        return same and all(one.largest <= self.tolerance for one in self.differences)

    @property
    def beyond(self) -> list[Difference]:
        """The fields that differ by more than the tolerance, the largest first."""
        return sorted((d for d in self.differences if d.largest > self.tolerance), key=lambda d: -d.largest)

    def __repr__(self) -> str:
        names = " and ".join(numbered([self.first.name, self.second.name]))
        if not self.counts:
            return f"{names} published nothing"
        lines = [f"{names}: {'equal' if self else 'different'}, tolerance {self.tolerance:g}"]
        lines += [
            f"{topic}: {a:,} messages and {b:,}" + ("" if a == b else "   <- not as many")
            for topic, (a, b) in self.counts.items()
        ]
        rows: list[tuple[str, ...]] = [("field", "largest difference", "at", "message", "first", "second")]
        for one in self.beyond[:12]:
            where = (f"{one.seconds:.2f} s", f"{one.message:,}", _short(one.first), _short(one.second))
            rows.append((f"{one.topic}.{one.field}", f"{one.largest:.4g}", *where))
        if len(rows) > 1:
            lines += ["", table(rows, left=1)]
        if len(self.beyond) > 12:
            lines.append(f"and {len(self.beyond) - 12} fields more")
        return "\n".join(lines)


def _short(value: Any) -> str:
    text = f"{value:.6g}" if isinstance(value, float | int) and not isinstance(value, bool) else str(value)
    return text if len(text) <= 24 else f"{text[:21]}..."


@takes(tolerance=DISTANCE)
def compare(
    first: Replayed | str | os.PathLike[str], second: Replayed | str | os.PathLike[str], tolerance: float = TOLERANCE
) -> Comparison:
    """Compare what two versions of a node published on the same bag: message by message, field by field.

    Each is what replay() returned, or the bag in which that was saved. Numbers may differ by `tolerance`, in the unit
    of the field; texts must be equal; nan is equal to nan. `assert compare(a, b)` is a regression test.
    """
    return Comparison(_replayed(first), _replayed(second), tolerance)


def _replayed(given: Replayed | str | os.PathLike[str]) -> Replayed:
    if isinstance(given, Replayed):
        return given
    if isinstance(given, str | os.PathLike):
        return load(given)
    raise TypeError(f"compare() takes what replay() returned, or the path of a bag, not {type(given).__name__}")


def _differences(first: TopicRecording, second: TopicRecording) -> Iterable[Difference]:
    """The largest difference of each field that differs at all."""
    if first.type != second.type:
        return [Difference(first.topic, "(type)", math.inf, 0, 0.0, first.type, second.type)]
    worst: dict[str, Difference] = {}
    for number, (a, b) in enumerate(zip(first.messages, second.messages, strict=False)):
        if first.serialised[number] == second.serialised[number]:
            continue
        for field, left, right in _pairs(a, b):
            size = _distance(left, right)
            if size > 0 and (field not in worst or size > worst[field].largest):
                when = float(first.times[number])
                worst[field] = Difference(first.topic, field, size, number, when, left, right)
    return worst.values()


def _pairs(left: Any, right: Any, path: str = "") -> Iterator[tuple[str, Any, Any]]:
    """Every field of two values, with both of its values; of messages inside them theirs."""
    if hasattr(left, "get_fields_and_field_types"):
        for name in left.get_fields_and_field_types():
            yield from _pairs(getattr(left, name), getattr(right, name), f"{path}.{name}" if path else name)
    elif isinstance(left, list) and left and hasattr(left[0], "get_fields_and_field_types") and len(left) == len(right):
        for number, (one, other) in enumerate(zip(left, right, strict=True)):
            yield from _pairs(one, other, f"{path}[{number}]")
    else:
        yield path, left, right


def _distance(left: Any, right: Any) -> float:
    """How far two values are apart: 0 if equal, infinite if they are no numbers or of different lengths."""
    a, b = np.asarray(left), np.asarray(right)
    if not {a.dtype.kind, b.dtype.kind} <= set("biuf"):
        return 0.0 if left == right else math.inf
    if a.shape != b.shape:
        return math.inf
    same = (a == b) | (np.isnan(a) & np.isnan(b))
    with np.errstate(invalid="ignore"):
        apart = np.where(same, 0.0, np.abs(a - b.astype(np.float64)))
    return float(np.where(np.isnan(apart), math.inf, apart).max(initial=0.0))
