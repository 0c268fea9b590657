"""The arguments of plot_scene(), messages, topics and recordings, as messages; and /tf meanwhile."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Any

from course_kit.base.text import numbered
from course_kit.lab.recordings.recording import Recording, record
from course_kit.lab.recordings.topic_recording import TopicRecording
from course_kit.lab.scene.frames import ODOMETRY, TRANSFORMS
from course_kit.ros.graph.plots import observer
from course_kit.ros.subscriptions import topics


@dataclass
class Given:
    """Something that is to be drawn, or that says where frames are: messages of one type, the newest last."""

    label: str
    kind: str  # the type's name
    messages: Sequence[Any]
    topic: str = ""

    def last(self) -> tuple[Any, str]:
        """The one that is drawn, and its type's name."""
        return self.messages[-1], self.kind

    @property
    def telling(self) -> Sequence[Any]:
        """Those that may tell where a frame was."""
        return self.messages if self.kind in (*TRANSFORMS, ODOMETRY) else ()


@contextmanager
def listening(wanted: Sequence[str]) -> Iterator[Callable[[], list[Given]]]:
    """Hear what is said on /tf and /tf_static in the block, if it shows topics; gives what has come so far."""
    there: list[str] = []
    if wanted:
        node = observer()
        there = [topic for topic in ("/tf", "/tf_static") if topics.publishers(node, topic)]
    if not there:
        yield list
        return
    with record(*there) as recording:
        yield lambda: [Given(one.topic, one.type, one.messages, one.topic) for one in recording]


def messages(given: list[tuple[str | None, Any]], timeout: float) -> list[Given]:
    """Messages of the views given, each with its label; those that occur twice are numbered.

    Reads absolute topics and recordings too.
    """
    wanted = [one for _, one in given if isinstance(one, str)]
    came = record(*wanted, count=1, timeout=timeout) if wanted else None
    found: list[Given] = []
    for label, one in given:
        if isinstance(one, str) and came is not None:
            found.append(_of_topic(came[one], label))
        elif isinstance(one, Recording | TopicRecording):
            recorded = [one] if isinstance(one, TopicRecording) else list(one)
            filled = [of_topic for of_topic in recorded if len(of_topic)]
            if not filled:
                raise ValueError(f"the recording of {', '.join(r.topic for r in recorded)} is empty")
            found += [_of_topic(of_topic, label) for of_topic in filled]
        elif hasattr(one, "get_fields_and_field_types"):
            found.append(Given(label or type(one).__name__, topics.type_name(type(one)), [one]))
        else:
            raise TypeError(f"plot_scene() draws messages, topics and recordings, not {type(one).__name__}")
    for one, label in zip(found, numbered([one.label for one in found]), strict=True):
        one.label = label
    return found


def _of_topic(recorded: TopicRecording, label: str | None) -> Given:
    return Given(label or recorded.topic, recorded.type, recorded.messages, recorded.topic)
