"""The tree of frames as a picture: what view_frames and rqt_tf_tree are used for."""

from __future__ import annotations

import threading
import time
from collections.abc import Sequence
from functools import partial
from typing import Any

from rclpy.serialization import deserialize_message
from tf2_msgs.msg import TFMessage

from course_kit.base.arguments import NAMESPACE, SPAN, takes
from course_kit.base.figures import COLOURS, Plot
from course_kit.base.long_tasks import long_task
from course_kit.lab.recordings.recording import Recording
from course_kit.lab.recordings.topic_recording import TopicRecording
from course_kit.lab.tf_tools.frame_cards import cards, heading, in_words
from course_kit.lab.tf_tools.frames import Frame, HeardFrames, from_yaml
from course_kit.ros.graph.cards import Wire
from course_kit.ros.graph.drawing import WIRE, Legend, draw_card, draw_legend, draw_wire, sheet, text_width, wire_look
from course_kit.ros.graph.plots import observer
from course_kit.ros.subscriptions import topics
from course_kit.ros.subscriptions.raw_subscriptions import Watcher

MOVING = COLOURS[0]
STATIC_TOPIC = "tf_static"


@takes(seconds=SPAN, namespace=NAMESPACE | None)
def plot_frames(source: Any = None, *, seconds: float = 2.0, namespace: str | None = None) -> Plot:
    """Draw the tree of frames: which is in which, static or how often, who says so, and what is wrong with it.

    Without `source` it listens to /tf and /tf_static, below a `namespace` where robots have their own, for some
    `seconds`. Else it draws what a tf2_ros.Buffer knows, or what a recording of /tf and /tf_static has.
    Stands for `ros2 run tf2_tools view_frames` and rqt_tf_tree.
    """
    if source is None:
        return draw_frames(_listen(f"/{namespace.strip('/')}" if namespace else "", seconds))
    if hasattr(source, "all_frames_as_yaml"):
        clock = getattr(source, "clock", None)
        return draw_frames(from_yaml(source.all_frames_as_yaml(), _seconds(clock)))
    if isinstance(source, Recording | TopicRecording):
        return draw_frames(_recorded([source] if isinstance(source, TopicRecording) else list(source)))
    raise TypeError(
        f"plot_frames() draws what a tf2_ros.Buffer knows or a recording of /tf has, not {type(source).__name__}. "
        f"Write it like plot_frames(), which listens itself"
    )


def _seconds(clock: Any) -> float:
    return time.time() if clock is None else float(clock.now().nanoseconds) * 1e-9


def _listen(namespace: str, seconds: float) -> list[Frame]:
    """What comes on /tf and /tf_static from now on, and what was kept for late listeners."""
    node = observer()
    errors: list[Exception] = []
    watcher = Watcher(node, errors.append, with_senders=True)
    wanted = [f"{namespace}/{name}" for name in ("tf", STATIC_TOPIC)]
    heard, lock = HeardFrames(), threading.Lock()

    def take(is_static: bool, message: bytes, info: dict[str, Any]) -> None:
        with lock:
            transforms = deserialize_message(message, TFMessage).transforms
            heard.take(transforms, info.get("publisher"), is_static, info["received_timestamp"] * 1e-9)

    try:
        for topic in wanted:
            qos = topics.qos_for(topic, topics.publishers(node, topic))
            watcher.subscribe(topic, TFMessage, qos, partial(take, topic.endswith(STATIC_TOPIC)))
        with long_task(f"listening to {' and '.join(wanted)}", seconds, "s"):
            threading.Event().wait(seconds)
    finally:
        watcher.stop()
    if errors:
        raise errors[0]
    ends = [end for topic in wanted for end in topics.publishers(node, topic)]
    names = {bytes(end.endpoint_gid): topics.node_name(end) for end in ends}
    with lock:
        return heard.frames(time.time(), names.get)


def _recorded(recordings: Sequence[TopicRecording]) -> list[Frame]:
    """What recordings of TFMessages have; their time ends with the last message."""
    heard = HeardFrames()
    last = 0.0
    for one in recordings:
        if one.type != "tf2_msgs/msg/TFMessage":
            raise ValueError(f"{one.topic} carries {one.type}, and frames come as tf2_msgs/msg/TFMessage, on /tf")
        for message, received in zip(one.messages, one.receive_ns, strict=True):
            last = max(last, float(received) * 1e-9)
            heard.take(message.transforms, None, one.topic.endswith(STATIC_TOPIC), float(received) * 1e-9)
    return heard.frames(last, lambda _: None)


def draw_frames(frames: Sequence[Frame]) -> Plot:
    """The picture of frames that are given as data."""
    made, wires, width, height = cards(frames, text_width)
    legend = _legend(wires)
    plot, axes = sheet(heading(frames), legend, width, height)
    for wire, frame in wires:
        draw_wire(axes, wire, WIRE if frame.is_static else MOVING)
    for card in made:
        draw_card(axes, card)
    draw_legend(axes, legend, height)
    plot.description = in_words(frames)
    return plot


def _legend(wires: Sequence[tuple[Wire, Frame]]) -> Legend:
    looks: Legend = [
        ("static", wire_look(True)),
        ("moving", wire_look(True, tint=MOVING)),
        ("something is wrong", wire_look(True, is_broken=True)),
    ]
    there = {2 if wire.is_broken else 0 if frame.is_static else 1 for wire, frame in wires}
    return [look for number, look in enumerate(looks) if number in there]
