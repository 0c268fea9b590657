"""Bags as regression tests: a bag goes through a node, in step and always the same; two versions are compared."""

from __future__ import annotations

import math
import os
import threading
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from geometry_msgs.msg import Twist
from rclpy.node import Node
from rclpy.qos import QoSProfile, ReliabilityPolicy
from rclpy.serialization import serialize_message
from sensor_msgs.msg import JointState
from std_msgs.msg import String
from turtlesim.msg import Pose

from course_kit.lab import bags
from course_kit.lab.background import running
from course_kit.lab.bags.writer import BagWriter
from course_kit.lab.recordings.recording import record
from course_kit.lab.replays.replay_plots import plot_comparison
from course_kit.lab.replays.replayed import Replayed, compare
from course_kit.lab.replays.replaying import replay
from course_kit.lab.series.value_series import values
from course_kit.ros.spinning import context
from tests.waiting import wait_until

SECOND = 10**9
START = 1_800_000_000 * SECOND
COUNT, STEP = 200, 16_000_000  # messages of a turtle, nanoseconds between them


@pytest.fixture(autouse=True, scope="module")
def stop_ros() -> Iterator[None]:
    yield
    context.stop()


@pytest.fixture(scope="module")
def drive(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A turtle on a circle of 2 m, and a text each second."""
    folder = tmp_path_factory.mktemp("bags") / "drive"
    writer = BagWriter(folder)
    writer.add_topic("/turtle1/pose", "turtlesim/msg/Pose")
    writer.add_topic("/said", "std_msgs/msg/String")
    for number in range(COUNT):
        turn = 0.02 * number
        pose = Pose(x=5 + 2 * math.cos(turn), y=5 + 2 * math.sin(turn), theta=turn, linear_velocity=2.5)
        writer.write("/turtle1/pose", START + number * STEP, serialize_message(pose))
        if number % 60 == 30:
            writer.write("/said", START + number * STEP + 1, serialize_message(String(data=str(number))))
    writer.close()
    return folder


class Smooth(Node):
    """Follows the turtle with some lag, and publishes the speed that it has at 20 Hz."""

    def __init__(self, gain: float = 0.2) -> None:
        super().__init__("smooth")
        self.gain = gain
        self.seen: Pose | None = None
        self.smoothed = self.create_publisher(Pose, "/smooth/pose", 10)
        self.speed = self.create_publisher(Twist, "/smooth/speed", 10)
        self.create_subscription(Pose, "/turtle1/pose", self.on_pose, 10)
        self.create_timer(0.05, self.tick)

    def on_pose(self, pose: Pose) -> None:
        if self.seen is None:
            self.seen = pose
        self.seen.x += self.gain * (pose.x - self.seen.x)
        self.seen.y += self.gain * (pose.y - self.seen.y)
        self.smoothed.publish(self.seen)

    def tick(self) -> None:
        speed = Twist()
        speed.linear.x = self.seen.x if self.seen else -1.0
        speed.linear.y = (self.get_clock().now().nanoseconds - START) * 1e-9
        self.speed.publish(speed)


def everything(replayed: Replayed) -> list[tuple[str, list[int], list[bytes]]]:
    return [(one.topic, one.receive_ns.tolist(), list(one.serialised)) for one in replayed.values()]


def test_the_same_bag_gives_the_same_output_to_the_byte_and_faster_than_it_was_recorded(drive: Path) -> None:
    replays = [replay(drive, Smooth) for _ in range(5)]
    assert all(everything(one) == everything(replays[0]) for one in replays)
    assert (
        min(one.seconds for one in replays) < replays[0].bag_seconds == pytest.approx(COUNT * STEP / SECOND, abs=0.02)
    )
    assert replays[0].sent == {"/turtle1/pose": COUNT}
    assert len(replays[0]["/smooth/pose"]) == COUNT


def test_timers_and_the_clock_are_on_the_bags_time(drive: Path) -> None:
    replayed = replay(drive, Smooth)
    speed = replayed["/smooth/speed"]
    expected = np.arange(1, len(speed) + 1) * 0.05
    assert len(speed) == int((COUNT - 1) * STEP / SECOND / 0.05)
    assert speed.times == pytest.approx(expected) and speed.values("linear.y") == pytest.approx(expected)
    # What a timer sees is what came before its time, and no more.
    poses = replayed["/smooth/pose"]
    before = np.searchsorted(poses.times, speed.times, side="left") - 1
    assert speed.values("linear.x") == pytest.approx(poses.values("x")[before])


class Several(Node):
    """Two timers that are due together, a topic that it hears itself, a callback that publishes twice."""

    def __init__(self) -> None:
        super().__init__("several")
        self.out = self.create_publisher(String, "/out", 100)
        self.create_subscription(Pose, "/turtle1/pose", lambda pose: self.twice("pose"), 10)
        self.create_subscription(String, "/said", self.said, 10)
        self.create_subscription(String, "/out", self.heard, 100)
        self.create_timer(0.1, lambda: self.twice("first timer"))
        self.create_timer(0.1, lambda: self.twice("second timer"))
        self.create_timer(0.05, lambda: self.twice("third timer"))
        self.answers = 0

    def twice(self, text: str) -> None:
        for number in (1, 2):
            self.out.publish(String(data=f"{text} {number}"))

    def said(self, text: String) -> None:
        self.twice(f"said {text.data}")

    def heard(self, text: String) -> None:
        if not text.data.startswith("heard"):
            self.out.publish(String(data=f"heard {text.data}"))


def test_simultaneous_timers_and_chains_of_callbacks_keep_their_order(drive: Path) -> None:
    first, *others = [replay(drive, Several) for _ in range(5)]
    assert all(everything(one) == everything(first) for one in others)
    texts = [message.data for message in first["/out"].messages]
    assert sum(text.startswith("heard pose") for text in texts) == 2 * COUNT
    assert first.sent == {"/turtle1/pose": COUNT, "/said": 3}


class Waiting(Node):
    def __init__(self) -> None:
        super().__init__("waiting")
        self.out = self.create_publisher(Pose, "/out", 10)
        self.create_subscription(Pose, "/turtle1/pose", self.on_pose, 10)  # type: ignore[arg-type]

    async def on_pose(self, pose: Pose) -> None:
        self.out.publish(pose)


def test_callbacks_that_are_async_or_take_info_and_best_effort_subscriptions_work(drive: Path) -> None:
    class BestEffort(Node):
        def __init__(self, name: str) -> None:
            super().__init__(name, namespace="/robot")
            out = self.create_publisher(Pose, "out", 10)
            profile = QoSProfile(depth=1, reliability=ReliabilityPolicy.BEST_EFFORT)
            self.create_subscription(Pose, "/turtle1/pose", out.publish, profile)

    class Informed(Node):
        def __init__(self) -> None:
            super().__init__("informed")
            self.out = self.create_publisher(Pose, "/out", 10)
            hear: Any = self.hear
            self.create_subscription(Pose, "/turtle1/pose", hear, 10)

        def hear(self, pose: Pose, info: dict[str, Any]) -> None:
            assert info["source_timestamp"] > 0
            self.out.publish(pose)

    assert len(replay(drive, Informed)["/out"]) == COUNT
    assert len(replay(drive, Waiting)["/out"]) == COUNT
    assert len(replay(drive, BestEffort, name="best")["/robot/out"]) == COUNT


def test_nobody_else_hears_a_replay_and_nobody_disturbs_it(drive: Path) -> None:
    """The notebook's own nodes on the same topics, and what they publish, stay out of it."""
    running.run(Smooth)
    publisher = running.run(Node, "disturbing").create_publisher(Pose, "/turtle1/pose", 10)
    with record("/smooth/pose", Pose) as recording:
        publisher.publish(Pose())
        wait_until(lambda: len(recording) == 1)
        replayed = replay(drive, Smooth)
        publisher.publish(Pose())
        wait_until(lambda: len(recording) == 2)
    running.stop()
    assert len(replayed["/smooth/pose"]) == COUNT and everything(replayed) == everything(replay(drive, Smooth))
    assert len(recording) == 2


def test_a_replay_leaves_nothing_behind(drive: Path) -> None:
    replay(drive, Smooth)
    threads = threading.active_count()
    before = dict(os.environ)
    replay(drive, Smooth)
    assert threading.active_count() == threads and dict(os.environ) == before


def test_only_the_outputs_that_were_asked_for_are_kept(drive: Path) -> None:
    assert list(replay(drive, Smooth, outputs=["smooth/pose"])) == ["/smooth/pose"]
    with pytest.raises(ValueError, match=r"published nothing on /nix; it published /smooth/pose, /smooth/speed"):
        replay(drive, Smooth, outputs=["/nix"])
    with pytest.raises(KeyError, match="Smooth published nothing on /nix"):
        replay(drive, Smooth)["/nix"]


def test_what_the_node_logs_is_kept(drive: Path) -> None:
    class Talking(Smooth):
        def on_pose(self, pose: Pose) -> None:
            if self.seen is None:
                self.get_logger().warn("the first")
            super().on_pose(pose)

    assert [line.text for line in replay(drive, Talking).logs] == ["the first"]


def test_what_goes_wrong_is_said_in_one_line(drive: Path) -> None:
    class Failing(Smooth):
        def on_pose(self, pose: Pose) -> None:
            raise RuntimeError("a mistake of mine")

    class Elsewhere(Node):
        def __init__(self) -> None:
            super().__init__("elsewhere")
            self.create_subscription(Pose, "/pose", print, 10)

    class OtherType(Node):
        def __init__(self) -> None:
            super().__init__("other")
            self.create_subscription(Twist, "/turtle1/pose", print, 10)

    class Endless(Smooth):
        async def on_pose(self, pose: Pose) -> None:  # type: ignore[override]
            await self.executor.create_task(self.never)  # type: ignore[union-attr]

        async def never(self) -> None:
            from rclpy.task import Future

            await Future()

    with pytest.raises(RuntimeError, match="a mistake of mine"):
        replay(drive, Failing)
    with pytest.raises(ValueError, match="Elsewhere subscribes to /pose, and 'drive' has /said, /turtle1/pose"):
        replay(drive, Elsewhere)
    with pytest.raises(ValueError, match=r"as geometry_msgs/msg/Twist, and 'drive' has it as turtlesim/msg/Pose"):
        replay(drive, OtherType)
    with pytest.raises(TimeoutError, match=r"the callback of /turtle1/pose did not return within 0.5 s"):
        replay(drive, Endless, timeout=0.5)
    with pytest.raises(bags.BagError, match="does not exist"):
        replay("no bag", Smooth)
    for wrong in (int, "Smooth"):
        with pytest.raises(TypeError, match=r"replay\(\) takes a class derived from rclpy\.node\.Node"):
            replay(drive, wrong)  # type: ignore[arg-type]


def test_versions_that_publish_the_same_are_equal_and_others_are_not(drive: Path) -> None:
    old, same, new = replay(drive, Smooth, 0.2), replay(drive, Smooth, 0.2), replay(drive, Smooth, gain=0.3)
    assert compare(old, same, tolerance=0.0)
    assert "equal" in repr(compare(old, same))
    compared = compare(old, new, tolerance=0.01)
    assert not compared
    fields = {f"{one.topic}.{one.field}": one for one in compared.beyond}
    assert set(fields) == {"/smooth/pose.x", "/smooth/pose.y", "/smooth/speed.linear.x"}
    x = fields["/smooth/pose.x"]
    apart = np.abs(old["/smooth/pose"].values("x") - new["/smooth/pose"].values("x"))
    assert x.largest == pytest.approx(apart.max()) and x.message == apart.argmax()
    assert compare(old, new, tolerance=x.largest + 0.2)
    assert "/smooth/pose.x" in repr(compared)


def test_texts_are_equal_only_if_they_are_the_same_also_where_they_look_like_numbers() -> None:
    first, second = Replayed("first", 0), Replayed("second", 0)
    for replayed, names in ((first, ["1", "2.0"]), (second, ["1.0", "2"])):
        replayed.keep("/joints", JointState, 0, serialize_message(JointState(name=names, position=[1.0, math.nan])))
    (name,) = compare(first, second).differences
    assert (name.field, name.largest) == ("name", math.inf)


def test_a_missing_message_and_a_missing_topic_make_a_difference(drive: Path) -> None:
    class Skipping(Smooth):
        def on_pose(self, pose: Pose) -> None:
            if pose.theta < 3.9:
                super().on_pose(pose)

    compared = compare(replay(drive, Smooth), replay(drive, Skipping))
    assert not compared and "200 messages and 195   <- not as many" in repr(compared)
    assert not compare(replay(drive, Smooth), replay(drive, Smooth, outputs=["/smooth/pose"]))
    with pytest.raises(TypeError, match=r"compare\(\) takes what replay\(\) returned"):
        compare(3, 4)  # type: ignore[arg-type]


def test_a_reference_is_kept_as_a_bag(drive: Path, tmp_path: Path) -> None:
    replayed = replay(drive, Smooth)
    reference = replayed.save(tmp_path / "reference")
    assert compare(reference, replay(drive, Smooth), tolerance=0.0)
    with pytest.raises(FileExistsError):
        replayed.save(reference)
    replayed.save(reference, overwrite=True)
    assert bags.info(reference).message_count == sum(len(one) for one in replayed.values())
    x = values("/smooth/pose.x", source=reference)["/smooth/pose.x"]
    assert x.values.tolist() == pytest.approx(replayed["/smooth/pose"].values("x").tolist())


def test_both_paths_and_their_distance_are_drawn(drive: Path) -> None:
    compared = compare(replay(drive, Smooth, 0.2), replay(drive, Smooth, 0.3), tolerance=0.02)
    figure = plot_comparison(compared)
    path, distance, left, _ = figure.axes
    labels = [line.get_label() for line in path.get_lines()][:2]
    assert labels == ["Smooth (1)", "Smooth (2)"] and path.get_aspect() == 1.0
    drawn = np.asarray(distance.get_lines()[0].get_xydata())
    one, two = compared.first["/smooth/pose"], compared.second["/smooth/pose"]
    apart = np.hypot(one.values("x") - two.values("x"), one.values("y") - two.values("y"))
    assert drawn[:, 1] == pytest.approx(apart, abs=1e-6)
    assert left.get_title(loc="right") == "/smooth/speed.linear.x"
    told = f"Smooth (1) and Smooth (2), tolerance 0.02. The paths of /smooth/pose: apart by {apart.max():.3g} at most, "
    assert repr(figure).startswith(told) and " /smooth/speed.linear.x: apart by " in repr(figure)
    assert figure._repr_png_()[0].startswith(b"\x89PNG")
    with pytest.raises(TypeError, match=r"plot_comparison\(\) draws what compare\(\) returns"):
        plot_comparison(compared.first)  # type: ignore[arg-type]


def test_a_recorded_bag_goes_through_too(tmp_path: Path) -> None:
    """As a student has it: recorded from a node that runs, at the machine's own pace."""

    class Turtle(Node):
        def __init__(self) -> None:
            super().__init__("turtle")
            self.poses: Any = self.create_publisher(Pose, "/turtle1/pose", 10)
            self.start = time.monotonic()
            self.create_timer(0.01, lambda: self.poses.publish(Pose(x=time.monotonic() - self.start)))

    with running.running(Turtle), bags.record(tmp_path / "bag", "/turtle1/pose") as bag:
        wait_until(lambda: bag.message_count > 30)
    first, second = replay(tmp_path / "bag", Smooth), replay(tmp_path / "bag", Smooth)
    assert everything(first) == everything(second)
    assert len(first["/smooth/pose"]) == bags.info(tmp_path / "bag").message_count
