"""record(): what a student records, reads, and is told when something is wrong; with real ROS traffic."""

from __future__ import annotations

import gc
import subprocess
import sys
import time
from collections.abc import Iterator
from typing import Any

import numpy as np
import pytest
from geometry_msgs.msg import PoseStamped
from rclpy.node import Node
from sensor_msgs.msg import Image, LaserScan
from std_msgs.msg import String
from turtlesim.msg import Pose

from course_kit.lab.background import running
from course_kit.lab.recordings import fields
from course_kit.lab.recordings.buffers import MessageBuffer
from course_kit.lab.recordings.recording import Recording, RecordingTimeout, record
from course_kit.lab.recordings.topic_recording import TopicRecording
from course_kit.ros.spinning import context
from course_kit.ros.subscriptions import observer_node
from tests.senders import DIGITS, PLACES, Sender
from tests.waiting import interrupted_when, wait_until


@pytest.fixture
def robot() -> Iterator[Node]:
    context.start()
    node = Node("robot")
    yield node
    node.destroy_node()


def numbers(recorded: TopicRecording, kind: str) -> list[int]:
    """The numbers that a Sender wrote into its messages."""
    digits = recorded.serialised.columns(PLACES[kind], DIGITS).astype(np.int64) - ord("0")
    read: list[int] = (digits @ 10 ** np.arange(DIGITS - 1, -1, -1)).tolist()
    return read


def poses(robot: Node, count: int = 20) -> Recording:
    publisher = robot.create_publisher(Pose, "/turtle1/pose", count)
    with record("/turtle1/pose") as recording:
        for number in range(count):
            publisher.publish(Pose(x=float(number), y=2.0, theta=0.5 * number))
        wait_until(lambda: len(recording) == count)
    return recording


@pytest.mark.parametrize("kind", ["string", "scan"])
def test_every_message_of_another_process_is_held_in_order_while_a_students_callback_sleeps(kind: str) -> None:
    class Sleeper(Node):
        def __init__(self) -> None:
            super().__init__("sleeper")
            self.create_timer(0.01, lambda: time.sleep(0.3))

    sleeper = running.run(Sleeper)
    count = 6000
    with Sender("/fast", kind, rate=3000, count=count) as sender, record("/fast") as recording:
        sender.go()
        sent = sender.result()
        wait_until(lambda: len(recording) == sent["sent"])
    assert numbers(recording["/fast"], kind) == list(range(count))
    assert (recording.dropped, recording.lost) == (0, 0)
    running.stop(sleeper)


def test_receive_times_are_those_of_arrival_also_when_python_was_busy() -> None:
    with Sender("/steady", "string", rate=200, count=400) as sender, record("/steady") as recording:
        sender.go()
        wait_until(lambda: len(recording) > 10)
        begin = time.time_ns()
        sum(range(20_000_000))  # holds the interpreter to its end: nothing can be taken meanwhile
        end = time.time_ns()
        sender.result()
        wait_until(lambda: len(recording) == 400)
    arrived_meanwhile = np.count_nonzero((recording.receive_ns > begin) & (recording.receive_ns < end))
    assert arrived_meanwhile > 200 * (end - begin) * 1e-9 / 3


def test_what_was_recorded_is_read_as_arrays_and_as_messages(robot: Node) -> None:
    recording = poses(robot)
    turtle = recording["turtle1/pose"]
    assert len(turtle) == len(recording) == 20 and turtle.type == "turtlesim/msg/Pose"
    assert turtle.values("x").tolist() == list(range(20)) and turtle.values("x").dtype == np.float64
    assert recording.values("theta")[3] == pytest.approx(1.5)
    assert turtle.times.shape == (20,) and 0 <= turtle.times[0] <= turtle.times[-1] <= recording.duration
    assert turtle.receive_ns.dtype == np.int64 and turtle.stamps is None
    assert turtle.messages[4] == Pose(x=4.0, y=2.0, theta=2.0) and turtle.messages[-1].x == 19
    assert [m.x for m in turtle.messages[5:8]] == [5, 6, 7] and len(turtle.messages[::2]) == 10
    with pytest.raises(IndexError, match="the recording has 20"):
        turtle.messages[20]


def test_stamps_and_nested_and_array_fields(robot: Node) -> None:
    scans = robot.create_publisher(LaserScan, "/scan", 10)
    stamped = robot.create_publisher(PoseStamped, "/goal", 10)
    with record("/scan", "/goal") as recording:
        for number in range(5):
            scan, goal = LaserScan(ranges=[float(number), 1.0]), PoseStamped()
            scan.header.stamp.sec, scan.header.stamp.nanosec = 1_700_000_000 + number, 250_000_000
            scan.header.frame_id = "frame" * number  # of another length each time
            goal.header.stamp.sec, goal.pose.position.x = -1, 0.5 * number
            scans.publish(scan)
            stamped.publish(goal)
        wait_until(lambda: len(recording) == 10)
    stamps = recording["/scan"].stamps
    assert stamps is not None and stamps.tolist() == [1_700_000_000.25 + n for n in range(5)]
    assert recording["/scan"].values("ranges").tolist() == [[float(n), 1.0] for n in range(5)]
    assert recording["/goal"].values("pose.position.x").tolist() == [0, 0.5, 1, 1.5, 2]
    assert recording["/goal"].values("header.stamp.sec").tolist() == [-1] * 5
    assert recording["/goal"].stamps is not None and recording["/goal"].stamps[0] == -1


def test_stamps_of_a_big_endian_sender_are_read() -> None:
    buffer = MessageBuffer(["/a"])
    message = bytes([0, 0, 0, 0]) + (7).to_bytes(4, "big") + (500_000_000).to_bytes(4, "big") + bytes(50)
    buffer.appender("/a")(message, 1)
    read = fields.stamps(buffer.snapshot("/a"), Image)
    assert read is not None and read.tolist() == [7.5]


@pytest.mark.parametrize(
    ("path", "says"),
    [
        ("z", "turtlesim/msg/Pose has no field 'z'; it has x, y, theta, linear_velocity, angular_velocity."),
        ("thet", "Did you mean 'theta'?"),
        ("x.y", "x (float) has no fields, so there is no 'y' in it"),
    ],
)
def test_an_unknown_field_is_answered_with_those_there_are(robot: Node, path: str, says: str) -> None:
    with pytest.raises(ValueError) as error:
        poses(robot, 1).values(path)
    assert says in str(error.value)


def test_a_field_that_is_no_number_is_answered_with_what_to_write(robot: Node) -> None:
    with record("/goal", PoseStamped) as goals, record("/chatter", String) as chatter:
        pass
    with pytest.raises(ValueError, match=r"it has the fields position, orientation: write 'pose.position'"):
        goals.values("pose")
    with pytest.raises(ValueError, match=r"read it with \[m.data for m in recording.messages\]"):
        chatter.values("data")


def test_count_blocks_until_that_many_came_and_holds_exactly_these() -> None:
    with Sender("/fast", "string", rate=1000, count=5000) as sender:
        sender.go()
        recording = record("/fast", count=100)
        assert len(recording) == 100 and not recording.is_running


def test_a_count_that_does_not_come_says_how_many_came_and_keeps_them() -> None:
    with Sender("/slow", "string", rate=1000, count=7) as sender:
        sender.go()
        with pytest.raises(
            RecordingTimeout, match=r"7 of 10 messages of /slow came within 1.5 s, .* has its publisher stopped"
        ) as error:
            record("/slow", count=10, timeout=1.5)
    assert numbers(error.value.recording["/slow"], "string") == list(range(7))
    assert isinstance(error.value, TimeoutError)


def test_a_count_that_takes_longer_than_the_timeout_says_how_long() -> None:
    with Sender("/slow", "string", rate=100, count=1000) as sender:
        sender.go()
        with pytest.raises(TimeoutError, match=r"at its rate 1000 take about \d+\.\d s, so pass timeout="):
            record("/slow", count=1000, timeout=1.5)


def test_a_topic_that_is_silent_is_said_to_be_so(robot: Node) -> None:
    robot.create_publisher(String, "/silent", 10)
    with pytest.raises(TimeoutError, match=r"0 of 1 messages of /silent came within 0.2 s: is its publisher running"):
        record("/silent", count=1, timeout=0.2)


def test_seconds_blocks_for_that_long() -> None:
    with Sender("/fast", "string", rate=500, count=100_000) as sender:
        sender.go()
        recording = record("/fast", seconds=0.5)
        assert 0 <= recording.times[0] < 0.3 and recording.duration == pytest.approx(0.5, abs=0.3)
        assert not recording.is_running
    assert len(recording) == pytest.approx(500 * recording.duration, rel=0.3)


def test_a_topic_can_be_recorded_before_anybody_publishes_it(robot: Node) -> None:
    recording = record("/later", String, "/other", "std_msgs/msg/String")
    robot.create_publisher(String, "/later", 10).publish(String(data="first"))
    wait_until(lambda: len(recording) == 1)
    assert recording.stop()["/later"].messages[0].data == "first"


def test_a_recording_goes_on_in_the_background_until_it_is_stopped(robot: Node) -> None:
    publisher = robot.create_publisher(String, "/chatter", 10)
    recording = record("/chatter")
    publisher.publish(String(data="one"))
    wait_until(lambda: len(recording) == 1)
    assert recording.is_running and "running" in repr(recording)
    recording.stop()
    publisher.publish(String(data="two"))
    assert len(recording.stop()) == 1 and "stopped" in repr(recording)


def test_a_cell_that_is_run_again_does_not_leave_the_first_recording_behind(robot: Node) -> None:
    publisher = robot.create_publisher(String, "/chatter", 10)
    for _ in range(3):
        recording = record("/chatter")
    gc.collect()
    wait_until(lambda: publisher.get_subscription_count() == 1)
    recording.stop()
    wait_until(lambda: publisher.get_subscription_count() == 0)


def test_what_is_read_from_a_running_recording_fits_together() -> None:
    with Sender("/fast", "scan", rate=2000, count=100_000) as sender, record("/fast") as recording:
        sender.go()
        wait_until(lambda: len(recording) > 100)
        now = recording["/fast"]
        while len(now) < 2000:
            now = recording["/fast"]
            assert len(now) == len(now.times) == len(now.stamps) == len(now.messages)  # type: ignore[arg-type]
            assert numbers(now, "scan") == list(range(len(now)))


def test_a_full_recording_keeps_the_newest_messages_and_counts_the_others() -> None:
    count = 3000
    with (
        Sender("/fast", "scan", rate=1000, count=count) as sender,
        record("/fast", max_bytes=500_000) as recording,
        record("/fast", keep=10) as last,
    ):
        sender.go(subscriptions=2)
        sender.result()
        wait_until(lambda: recording.dropped + len(recording) == last.dropped + len(last) == count)
    assert recording.nbytes <= 500_000 and 0 < recording.dropped < count
    assert numbers(recording["/fast"], "scan") == list(range(recording.dropped, count))
    assert numbers(last["/fast"], "scan") == list(range(count - 10, count))


def test_several_topics_are_told_apart(robot: Node) -> None:
    robot.create_publisher(String, "/a", 10)
    robot.create_publisher(String, "/b", 10)
    with record("/a", "b") as recording:
        pass
    assert recording.topics == ["/a", "/b"] and [one.topic for one in recording] == ["/a", "/b"]
    assert "/a     std_msgs/msg/String         0" in repr(recording)
    with pytest.raises(ValueError, match=r"has 2 topics: say which, recording\['/a'\].times"):
        recording.times  # noqa: B018
    with pytest.raises(KeyError, match="/c is not in this recording; it has /a, /b"):
        recording["/c"]


@pytest.mark.parametrize(
    ("wanted", "options", "says"),
    [
        ((), {}, "give the names of topics"),
        ((String,), {}, "give topic names first"),
        (("/a", 3), {}, "is not a message type"),
        (("/a", String), {"count": 0}, "count must be a whole number, 1 or more, or None, not 0"),
        (("/a", String), {"seconds": 0}, "seconds must be a span of time in seconds, more than 0, or None, not 0"),
        (("/a", String), {"keep": 0}, "keep must be a whole number, 1 or more, or None, not 0"),
        (("/a", String), {"max_bytes": 10}, "max_bytes=10 is too little"),
        (("/nobody",), {"timeout": 0.1}, "no node publishes /nobody"),
    ],
)
def test_bad_input_is_answered_in_one_line(wanted: tuple[Any, ...], options: dict[str, Any], says: str) -> None:
    with pytest.raises((TypeError, ValueError, TimeoutError)) as error:
        record(*wanted, **options)
    assert says in str(error.value) and "\n" not in str(error.value)


def test_an_interrupted_cell_ends_its_recording(robot: Node) -> None:
    publisher = robot.create_publisher(String, "/chatter", 10)

    with interrupted_when(lambda: publisher.get_subscription_count() == 1):
        record("/chatter", seconds=60)
    wait_until(lambda: publisher.get_subscription_count() == 0)


def test_a_recording_survives_rclpy_shutdown_with_what_it_has() -> None:
    program = """
import rclpy
from rclpy.node import Node
from std_msgs.msg import String
from course_kit import record
from course_kit.base.polling import wait_until
recording = record('/program', String)
publisher = Node('talker').create_publisher(String, '/program', 10)
publisher.publish(String(data='x'))
assert wait_until(lambda: len(recording) == 1, 10)
rclpy.shutdown()
assert wait_until(lambda: not recording.is_running, 10)
assert recording.stop().messages[0].data == 'x'
again = record('/program', String)
assert again.is_running
"""
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, timeout=60)
    assert (done.returncode, done.stderr) == (0, "")


def test_the_recorder_leaves_no_subscription_behind() -> None:
    assert observer_node.node().count_subscribers("/nothing") == 0
    record("/nothing", String, seconds=0.05)
    wait_until(lambda: observer_node.node().count_subscribers("/nothing") == 0)
