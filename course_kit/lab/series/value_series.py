"""Numbers of topics over time, named by their path: '/turtle1/pose.x'. Live, from a recording or from a bag; as CSV.

What PlotJuggler is used for: `values('/turtle1/pose.x')`, then plot_values() or save_csv().
"""

from __future__ import annotations

import csv
import difflib
import io
import itertools
import math
import os
from collections import Counter
from collections.abc import Collection, Iterable, Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
from rclpy.node import Node

from course_kit.base.arguments import PATH, SPAN, WAIT, shown, takes
from course_kit.base.atomic_files import write_whole
from course_kit.base.polling import wait_until
from course_kit.base.text import table
from course_kit.lab import bags
from course_kit.lab.recordings.buffers import Int64s
from course_kit.lab.recordings.recording import Recording, record
from course_kit.lab.recordings.topic_recording import TopicRecording
from course_kit.lab.series import field_paths
from course_kit.lab.series.field_paths import FieldPath, Reader
from course_kit.ros.subscriptions import observer_node, topics

Source = Recording | TopicRecording | str | os.PathLike[str]


@dataclass(frozen=True)
class Series:
    """One number over time; both arrays have the shape (messages,)."""

    path: str
    receive_ns: Int64s  # when each message came, nanoseconds since the epoch
    values: npt.NDArray[np.float64]
    start_ns: int  # of the recording or the bag

    @property
    def times(self) -> npt.NDArray[np.float64]:
        """When each message came: seconds since the start."""
        return np.asarray((self.receive_ns - self.start_ns) * 1e-9, np.float64)

    def __len__(self) -> int:
        return len(self.values)


class Values(Mapping[str, Series]):
    """Series by path, shown as a table: `values('/turtle1/pose.x')['/turtle1/pose.x'].values` is a numpy array."""

    def __init__(self, series: list[Series]) -> None:
        self._series = {one.path: one for one in series}

    def __getitem__(self, path: str) -> Series:
        name = str(field_paths.parse(path))
        if name not in self._series:
            raise KeyError(f"{shown(name)} was not read; there are {', '.join(self._series)}")
        return self._series[name]

    def __iter__(self) -> Iterator[str]:
        return iter(self._series)

    def __len__(self) -> int:
        return len(self._series)

    def __repr__(self) -> str:
        rows: list[tuple[str, ...]] = [("path", "messages", "from", "to", "min", "max", "mean", "last")]
        for path, one in self._series.items():
            there = one.values[np.isfinite(one.values)]
            span = [f"{time:.2f} s" for time in one.times[[0, -1]]] if len(one) else ["-", "-"]
            numbers = [there.min(), there.max(), there.mean(), one.values[-1]] if len(there) else []
            rows.append((path, f"{len(one):,}", *span, *([f"{n:.4g}" for n in numbers] or ["-"] * 4)))
        return table(rows, left=1)


@takes(seconds=SPAN, timeout=WAIT)
def values(*paths: str, source: Source | None = None, seconds: float = 2.0, timeout: float = 10.0) -> Values:
    """Numbers over time by their paths, such as '/turtle1/pose.x', '/scan.ranges[0]', '/imu.orientation.w'.

    Without `source` they are recorded for `seconds`, from the first message on; a topic that nobody publishes yet is
    waited for, up to `timeout` seconds. Else `source` is what record() returned, or the path of a bag. Raises
    ValueError for a field that is not there or no number, and says what was probably meant.
    """
    wanted = [field_paths.parse(path) for path in paths]
    if not wanted:
        raise TypeError("give paths of numbers, such as '/turtle1/pose.x'")
    if isinstance(source, Recording | TopicRecording):
        return from_recording(wanted, source)
    if source is not None:
        return from_bag(wanted, source)
    return from_recording(wanted, record_live(wanted, timeout, seconds=seconds))


def record_live(wanted: list[FieldPath], timeout: float, **how: Any) -> Recording:
    """Record the topics in paths, as nodes publish them now; `how` is that of record().

    TimeoutError for a topic that no node publishes; a bad path is refused before it takes time to record.
    """
    node = observer_node.node()
    for path in wanted:
        topics.absolute(path.topic)
        if not path.field:  # '/turtle1/pose/x', as PlotJuggler writes it
            _refuse_slashes(path, _names_with(node, path.topic, timeout))
    types = topics.look_up(node, topics.with_types([path.topic for path in wanted]), timeout)
    readers(wanted, types)
    return record(*itertools.chain(*types.items()), timeout=timeout, **how)


def _names_with(node: Node, topic: str, timeout: float) -> list[str]:
    """The topics that are known; waits until the topic is among them, or one that its name begins with."""

    def names() -> list[str]:
        return [name for name, _ in node.get_topic_names_and_types()]

    wait_until(lambda: any(f"{topic}/".startswith(f"{name}/") for name in names()), timeout)
    return names()


def _refuse_slashes(path: FieldPath, there: Collection[str]) -> None:
    parts = path.topic.split("/")
    for end in range(len(parts) - 1, 1, -1):
        topic, field = "/".join(parts[:end]), ".".join(parts[end:])
        if topic in there and path.topic not in there:
            raise ValueError(f"{path.topic} is no topic, but {topic} is one: write '{topic}.{field}'")


def readers(wanted: list[FieldPath], types: Mapping[str, Any]) -> dict[FieldPath, Reader]:
    """What reads the number of each path; ValueError for a path that is none."""
    return {path: field_paths.reader(types[path.topic], path) for path in wanted}


def from_recording(
    wanted: list[FieldPath], recorded: Recording | TopicRecording, since: float = -math.inf, most: int | None = None
) -> Values:
    """The numbers in what was recorded up to now.

    Only those from `since` on (seconds since its start), and of each topic no more than `most`, evenly chosen.
    """
    by_topic = {one.topic: one for one in ([recorded] if isinstance(recorded, TopicRecording) else recorded)}

    def messages() -> Iterator[tuple[str, int, Any]]:
        for topic in dict.fromkeys(path.topic for path in wanted):
            one = by_topic[topic]
            first = int(np.searchsorted(one.times, since))
            part = slice(first, None, 1 if most is None else max(1, -(-(len(one) - first) // most)))
            for nanoseconds, message in zip(one.receive_ns[part].tolist(), one.messages[part], strict=True):
                yield topic, nanoseconds, message

    _check_topics(wanted, by_topic, "the recording")
    types = {topic: one.message_type for topic, one in by_topic.items()}
    return _read(wanted, types, messages(), recorded.start_ns)


def from_bag(wanted: list[FieldPath], bag: str | os.PathLike[str]) -> Values:
    """The numbers in a bag. Raises BagError if there is none."""
    told = bags.info(bag)
    names = {topic.name: topic.type for topic in told.topics}
    _check_topics(wanted, names, f"the bag '{bag}'")
    types = {path.topic: topics.message_class(names[path.topic]) for path in wanted}
    return _read(wanted, types, bags.read(bag, *types), told.start)


def _read(
    wanted: list[FieldPath], types: Mapping[str, Any], messages: Iterable[tuple[str, int, Any]], start_ns: int
) -> Values:
    """The numbers in messages, each with its topic and the time at which it came."""
    of = readers(wanted, types)
    read: dict[FieldPath, list[float]] = {path: [] for path in of}
    came: dict[str, list[int]] = {path.topic: [] for path in of}
    into = {
        topic: (times.append, [(read[path].append, one) for path, one in of.items() if path.topic == topic])
        for topic, times in came.items()
    }
    for topic, nanoseconds, message in messages:
        add_time, numbers = into[topic]
        add_time(nanoseconds)
        for add, number in numbers:
            add(number(message))
    times = {topic: np.array(nanoseconds, np.int64) for topic, nanoseconds in came.items()}
    return Values([Series(str(path), times[path.topic], np.array(found), start_ns) for path, found in read.items()])


def _check_topics(wanted: list[FieldPath], there: Mapping[str, Any], where: str) -> None:
    for path in wanted:
        if path.topic in there:
            continue
        _refuse_slashes(path, there)
        last = path.topic.rsplit("/", 1)[-1]
        near = difflib.get_close_matches(path.topic, there, n=1) or [t for t in there if t.endswith(f"/{last}")]
        hint = f" Did you mean '{near[0]}.{path.field}'?" if near and path.field else ""
        raise ValueError(f"{where} has no topic {path.topic}; it has {', '.join(sorted(there)) or 'none'}.{hint}")


@takes(file=PATH)
def save_csv(read: Values, file: str | os.PathLike[str]) -> Path:
    """Write values into a CSV file, one column a path, one line for each moment at which a message came.

    The first column is `time`, seconds since the start. A cell is empty where its topic had no message at that moment.
    Returns the file's path. An earlier file stays until the new one is whole. Raises NotWritten.
    """
    if not isinstance(read, Values):
        raise TypeError(f"save_csv() writes what values() returned, not {type(read).__name__}")
    columns = [dict(zip(_moments(one.receive_ns), one.values.tolist(), strict=True)) for one in read.values()]
    moments = sorted({moment for column in columns for moment in column})
    start_ns = min((one.start_ns for one in read.values()), default=0)
    place = Path(file)
    out = io.StringIO()
    writer = csv.writer(out, lineterminator="\n")
    writer.writerow(["time", *read])
    for moment in moments:
        row = [column.get(moment) for column in columns]
        writer.writerow([f"{(moment[0] - start_ns) * 1e-9:.9f}", *("" if v is None else repr(v) for v in row)])
    return write_whole(place, out.getvalue().encode())


def _moments(receive_ns: Int64s) -> Iterator[tuple[int, int]]:
    """Each time of receipt, and how many messages of the topic came at the same nanosecond before."""
    before: Counter[int] = Counter()
    for now in receive_ns.tolist():
        yield now, before[now]
        before[now] += 1
