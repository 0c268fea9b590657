"""Frames and who says where they are, as plain data: from what tf2 tells, or from the messages. Pure, no ROS."""

from __future__ import annotations

import math
from collections import defaultdict, deque
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, field
from typing import Any

import yaml

LATE, PERIODS = 1.0, 3.0  # since the last transform of a moving frame, in seconds and in periods: then it is late
KEPT = 1000  # arrivals of each frame


@dataclass(frozen=True)
class Frame:
    """A frame that is somewhere in another one."""

    name: str
    parent: str
    broadcasters: tuple[str, ...] = ()  # nodes; empty where they are not known
    is_static: bool = False
    rate: float | None = None  # Hz; None if it came once only
    age: float | None = None  # s since the last one; None of a static frame
    other_parents: tuple[str, ...] = ()  # what else was said to be its parent: a mistake

    @property
    def is_late(self) -> bool:
        """True if it moves and nothing new is known of it."""
        return self.age is not None and self.age > max(LATE, PERIODS / (self.rate or math.inf))


def from_yaml(told: str, now: float) -> list[Frame]:
    """The frames in what a buffer's all_frames_as_yaml() tells; `now` in seconds of the same clock.

    tf2 does not keep who has sent a transform, and its static transforms are those with no time.
    """
    found: dict[str, dict[str, Any]] = yaml.safe_load(told) or {}
    frames = []
    for name, one in found.items():
        is_static = not one["most_recent_transform"] and not one["oldest_transform"]
        has_rate = not is_static and one["buffer_length"] > 0
        age = None if is_static else now - float(one["most_recent_transform"])
        rate = float(one["rate"]) if has_rate else None
        frames.append(Frame(str(name), str(one["parent"]), is_static=is_static, rate=rate, age=age))
    return frames


def dot(told: str, now: float) -> str:
    """The same as a graph for Graphviz, as view_frames writes it."""
    found: dict[str, dict[str, Any]] = yaml.safe_load(told) or {}
    if not found:
        return 'digraph G { "No tf data received" }'
    names = {
        "Broadcaster": "broadcaster",
        "Average rate": "rate",
        "Buffer length": "buffer_length",
        "Most recent transform": "most_recent_transform",
        "Oldest transform": "oldest_transform",
    }
    lines = ["digraph G {"]
    for name, one in found.items():
        label = "".join(f"{title}: {one[key]}\\n" for title, key in names.items())
        lines.append(f'"{one["parent"]}" -> "{name}"[label=" {label}"];')
    root = next(one["parent"] for one in found.values() if one["parent"] not in found)
    lines += [
        "edge [style=invis];",
        ' subgraph cluster_legend { style=bold; color=black; label ="view_frames Result";',
        f'"Recorded at time: {now}"[ shape=plaintext ] ;',
        f'}}->"{root}";',
    ]
    return "\n".join(lines) + "\n}"


@dataclass
class _Heard:
    """What has come of one frame."""

    parents: dict[str, None] = field(default_factory=dict)  # in the order in which they came, the newest last
    senders: dict[Any, None] = field(default_factory=dict)
    arrivals: deque[float] = field(default_factory=lambda: deque(maxlen=KEPT))
    is_static: bool = False


class HeardFrames:
    """Gathers frames from messages of transforms, with who has sent them; all times in seconds."""

    def __init__(self) -> None:
        self._frames: dict[str, _Heard] = defaultdict(_Heard)

    def take(self, transforms: Iterable[Any], sender: Any, is_static: bool, now: float) -> None:
        """One message of TransformStamped ones: who sent it, whether it is of /tf_static, when it came."""
        for one in transforms:
            heard = self._frames[one.child_frame_id.lstrip("/")]
            parent = one.header.frame_id.lstrip("/")
            heard.parents.pop(parent, None)
            heard.parents[parent] = None
            heard.senders[sender] = None
            heard.arrivals.append(now)
            heard.is_static = is_static

    def frames(self, now: float, name_of: Callable[[Any], str | None] = str) -> list[Frame]:
        """What is known now; `name_of(sender)` gives the name of a node, or None."""
        return [self._frame(name, heard, now, name_of) for name, heard in sorted(self._frames.items())]

    @staticmethod
    def _frame(name: str, heard: _Heard, now: float, name_of: Callable[[Any], str | None]) -> Frame:
        *others, parent = heard.parents
        known = dict.fromkeys(filter(None, map(name_of, heard.senders)))
        age = None if heard.is_static else now - heard.arrivals[-1]
        return Frame(name, parent, tuple(sorted(known)), heard.is_static, _rate(heard), age, tuple(others))


def _rate(heard: _Heard) -> float | None:
    if heard.is_static or len(heard.arrivals) < 2:
        return None
    return (len(heard.arrivals) - 1) / max(heard.arrivals[-1] - heard.arrivals[0], 1e-9)


def roots(frames: Sequence[Frame]) -> list[str]:
    """The frames that are in no other one, each the root of a tree; a loop has none."""
    children = {frame.name for frame in frames}
    return sorted({frame.parent for frame in frames} - children)


def loops(frames: Sequence[Frame]) -> list[list[str]]:
    """The frames that are in each other in a circle, which is in no tree."""
    parents = {frame.name: frame.parent for frame in frames}
    found: list[list[str]] = []
    done: set[str] = set()
    for name in sorted(parents):
        way: list[str] = []
        while name in parents and name not in done:
            done.add(name)
            way.append(name)
            name = parents[name]
        if name in way:
            found.append(way[way.index(name) :])
    return found
