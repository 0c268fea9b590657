"""tf2's programs as processes with real traffic, and the tree of frames as a picture: what each prints and draws."""

from __future__ import annotations

import re
import subprocess
import sys
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest
from geometry_msgs.msg import TransformStamped
from rclpy.node import Node
from tf2_msgs.msg import TFMessage
from tf2_ros import Buffer, StaticTransformBroadcaster, TransformBroadcaster

from course_kit import plot_frames, record
from course_kit.base.figures import Plot
from course_kit.cli.ros2.line_completion import complete
from course_kit.ros import packages
from course_kit.ros.spinning import context
from tests.ros2_launches import Prefix, RunningGroup
from tests.waiting import wait_until

pytestmark = pytest.mark.usefixtures("fresh_domain")
PLACE = ["--x", "-2", "--y", "2", "--yaw", "1.2"]  # as a tutorial has it, with what the real programs print for it
ECHOED = """\
At time 0.0
- Translation: [-2.000, 2.000, 0.000]
- Rotation: in Quaternion (xyzw) [0.000, 0.000, 0.565, 0.825]
- Rotation: in RPY (radian) [0.000, -0.000, 1.200]
- Rotation: in RPY (degree) [0.000, -0.000, 68.755]
- Matrix:
  0.362 -0.932  0.000 -2.000
  0.932  0.362  0.000  2.000
  0.000  0.000  1.000  0.000
  0.000  0.000  0.000  1.000""".splitlines()


def run(executable: str, *words: str, package: str = "tf2_ros") -> RunningGroup:
    return RunningGroup("run", package, executable, *words, environment={})


def publisher(parent: str, child: str, *words: str) -> RunningGroup:
    return run("static_transform_publisher", *words, "--frame-id", parent, "--child-frame-id", child)


def ended_well(running: RunningGroup) -> bool:
    """Tell whether Ctrl-C ends it with status 0 and without a word of its end, be it in the midst of an echo."""
    said = len(running.lines)
    running.interrupt()
    return running.end().status == 0 and set(running.lines[said:]) <= set(running.lines[:said])


def transform(parent: str, child: str, x: float = 0.0, stamp: float = 0.0) -> TransformStamped:
    message = TransformStamped(child_frame_id=child)
    message.header.frame_id = parent
    message.header.stamp.sec, message.header.stamp.nanosec = int(stamp), round(stamp % 1 * 1e9)
    message.transform.translation.x = x
    return message


@contextmanager
def a_node(name: str) -> Iterator[Node]:
    context.start()
    node = Node(name)
    try:
        yield node
    finally:
        node.destroy_node()


@contextmanager
def moving(node: Node, *pairs: tuple[str, str]) -> Iterator[None]:
    """Have a node say where frames are, fifty times a second, while the block runs."""
    broadcaster, ended = TransformBroadcaster(node), threading.Event()

    def go_on() -> None:
        while not ended.wait(0.02):
            now = node.get_clock().now().nanoseconds * 1e-9
            broadcaster.sendTransform([transform(*pair, stamp=now) for pair in pairs])

    thread = threading.Thread(target=go_on)
    thread.start()
    try:
        yield
    finally:
        ended.set()
        thread.join()


def test_a_static_transform_is_published_and_echoed_with_the_lines_of_the_real_programs() -> None:
    with run("tf2_echo", "map", "robot", "20") as echo:
        waiting = (
            r'Waiting for transform map ->  robot: Invalid frame ID "map" passed to canTransform argument '
            r"target_frame - frame does not exist$"
        )
        echo.wait_for(r"^\[INFO\] \[\d+\.\d{9}\] \[tf2_echo\]: " + waiting)
        with publisher("map", "robot", *PLACE) as static:
            static.wait_for("from 'map' to 'robot'")
            heading = r"\[INFO\] \[\d+\.\d{9}\] \[static_transform_publisher_\w{16}\]: "
            assert re.fullmatch(heading + "Spinning until stopped - publishing transform", static.lines[0])
            assert static.lines[1:] == [
                "translation: ('-2.000000', '2.000000', '0.000000')",
                "rotation: ('0.000000', '0.000000', '0.564642', '0.825336')",
                "from 'map' to 'robot'",
            ]
            echo.wait_for("^At time", 3)
            begin = echo.lines.index(ECHOED[0])
            assert echo.lines[begin : begin + len(ECHOED)] == ECHOED
            assert ended_well(static)
        assert ended_well(echo)


def test_the_old_row_of_arguments_is_published_with_a_warning() -> None:
    with run("static_transform_publisher", "1", "2", "3", "1.57", "0", "-3.14", "foo", "bar") as static:
        static.wait_for("from 'foo' to 'bar'")
        warning = "Old-style arguments are deprecated; see --help for new-style arguments"
        assert re.fullmatch(r"\[WARN\] \[\d+\.\d{9}\] \[\]: " + warning, static.lines[0])
        assert static.lines[2:4] == [
            "translation: ('1.000000', '2.000000', '3.000000')",
            "rotation: ('-0.707388', '-0.706825', '0.000563', '0.000563')",
        ]
        assert ended_well(static)


def test_a_launch_file_starts_it_under_a_name_of_its_own(tmp_path: Path) -> None:
    prefix = Prefix(tmp_path / "install")
    words = ["--x", "0.1", "--frame-id", "base_link", "--child-frame-id", "laser"]
    entity = 'Node(package="tf2_ros", executable="static_transform_publisher", name="laser_tf", arguments=[%s]),'
    prefix.launch_file("demo", "tf.launch.py", entity % ", ".join(map(repr, words)))
    with RunningGroup("launch", "demo", "tf.launch.py", environment=prefix.environment) as launch:
        launch.wait_for(r"\[laser_tf\]: Spinning until stopped")
        kept = record("/tf_static", TFMessage, count=1, timeout=20.0)
        (one,) = kept.messages[0].transforms
        assert (one.header.frame_id, one.child_frame_id, one.transform.translation.x) == ("base_link", "laser", 0.1)
        launch.interrupt()
        assert launch.end().status == 0


@pytest.mark.parametrize(
    ("words", "said", "status"),
    [
        (["tf2_ros", "tf2_echo", "map"], "Usage: tf2_echo source_frame target_frame", 1),
        (["tf2_ros", "tf2_echo", "a", "b", "-x"], "Unknown argument: -x", 5),
        (["tf2_ros", "tf2_monitor", "map"], "TF_Monitor: usage: tf2_monitor framea frameb", 255),
        (["tf2_ros", "static_transform_publisher", "--x", "1"], "Frame id must not be empty", 1),
        (["tf2_ros", "static_transform_publisher", "--frame-id", "a", "--child-frame-id", "a"], "cannot equal", 1),
        (["tf2_ros", "static_transform_publisher", "--help"], "required arguments:", 0),
        (["tf2_tools", "view_frames", "--no"], "unrecognized arguments: --no", 2),
    ],
)
def test_wrong_arguments_are_told(words: list[str], said: str, status: int) -> None:
    with RunningGroup("run", *words, environment={}) as running:
        assert running.end().status == status
        assert said in running.text and "Traceback" not in running.text


def test_a_monitor_tells_delays_and_the_chain() -> None:
    quick = "from course_kit.lab.tf_tools import monitor; monitor.LOOK = 0.05; monitor.main()"
    with a_node("broadcaster") as node, moving(node, ("map", "odom"), ("odom", "base_link")):
        command = [sys.executable, "-u", "-c", quick, "map", "base_link"]
        monitor = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
        try:
            assert monitor.stdout is not None
            lines = []
            for line in monitor.stdout:
                lines.append(line.rstrip("\n"))
                if line.startswith("Node: "):
                    break
        finally:
            monitor.terminate()
            assert monitor.wait(20) == 0
    lines = [line for line in lines if "Waiting for transform" not in line]
    assert lines[0] == "Gathering data on map -> base_link for 10 seconds..."
    assert lines[1:6] == ["", "", "", "RESULTS: for map to base_link", "Chain is: map -> odom -> base_link"]
    number = r"-?[\d.]+(?:e-?\d+)?"
    of_frame = rf"Frame: {{}}, published by <no authority available>, Average Delay: {number}, Max Delay: {number}"
    patterns = [
        rf"Net delay     avg = {number}: max = {number}", "", "Frames:", of_frame.format("base_link"),
        of_frame.format("odom"), "", "All Broadcasters:",
        rf"Node: <no authority available> {number} Hz, Average Delay: {number} Max Delay: {number}",
    ]  # fmt: skip
    assert len(lines) == 6 + len(patterns)
    assert [p for p, line in zip(patterns, lines[6:], strict=True) if not re.fullmatch(p, line)] == []


def test_the_frames_are_written_as_the_real_program_writes_them(tmp_path: Path) -> None:
    file = tmp_path / "tree"
    with a_node("broadcaster") as node, moving(node, ("odom", "base_link")):
        StaticTransformBroadcaster(node).sendTransform(transform("base_link", "laser"))
        with run("view_frames", "-t", "3", "-o", str(file), package="tf2_tools") as view:
            assert view.end().status == 0
    said = [re.sub(r"\[\d+\.\d+\]", "[T]", line) for line in view.lines]
    assert said[:2] == [
        "[INFO] [T] [view_frames]: Listening to tf data for 3.0 seconds...",
        "[INFO] [T] [view_frames]: Generating graph...",
    ]
    assert said[2].startswith("[INFO] [T] [view_frames]: Result:tf2_msgs.srv.FrameGraph_Response(frame_yaml=")
    assert said[3] == f"[INFO] [T] [view_frames]: Exporting graph in {file}.pdf file..."
    graph = file.with_suffix(".gv").read_text()
    assert graph.startswith("digraph G {\n") and graph.endswith('}->"odom";\n}')
    label = r"Broadcaster: default_authority\\nAverage rate: {}\\nBuffer length: {}\\nMost recent transform: "
    assert re.search(
        r'^"odom" -> "base_link"\[label=" ' + label.format(r"\d+\.\d+", r"[0-3]\.\d+"), graph, re.MULTILINE
    )
    static = label.format(r"10000\.0", r"0\.0") + r'0\.0\\nOldest transform: 0\.0\\n"\];$'
    assert re.search(r'^"base_link" -> "laser"\[label=" ' + static, graph, re.MULTILINE)
    assert file.with_suffix(".pdf").read_bytes().startswith(b"%PDF")


def test_the_programs_are_listed_and_completed() -> None:
    assert [path.name for path in packages.executables("tf2_ros")] == [
        "static_transform_publisher", "tf2_echo", "tf2_monitor",
    ]  # fmt: skip
    assert "view_frames" in [word.strip() for word in complete("run tf2_tools ")]


def drawn(*patterns: str) -> Plot:
    """The frames that come, once what is told of them has these patterns: discovery takes its time."""

    def look() -> Plot | None:
        plot = plot_frames(seconds=0.5)
        return plot if all(re.search(pattern, repr(plot)) for pattern in patterns) else None

    found: Plot = wait_until(look, f"frames as {patterns}")
    return found


def test_the_tree_of_what_is_said_now_is_drawn_with_who_says_it() -> None:
    with a_node("robot") as robot, a_node("mount") as mount, moving(robot, ("odom", "base_link")):
        StaticTransformBroadcaster(mount).sendTransform([transform("base_link", "laser"), transform("hall", "door")])
        plot = drawn(
            r"^5 frames  ·  2 trees, and nothing says where one is in the other. At the root: hall, odom\.",
            r" base_link in odom \([\d.]+ Hz, from /robot\)\.",
            r" laser in base_link \(static, from /mount\)\.",
            r" door in hall \(static, from /mount\)\.",
        )
    assert plot._repr_png_()[0].startswith(b"\x89PNG")


def test_two_nodes_that_disagree_about_a_frame_are_named() -> None:
    with (
        a_node("one") as one,
        a_node("two") as two,
        moving(one, ("map", "base_link")),
        moving(two, ("odom", "base_link")),
    ):
        drawn(
            "from /one, from /two",
            r"Wrong: in (map and in odom|odom and in map): a frame has one parent\.",
            r"Wrong: 2 nodes say where it is\.",
        )


def test_a_buffer_and_a_recording_are_drawn() -> None:
    buffer = Buffer()
    now = buffer.clock.now().nanoseconds * 1e-9
    for step in range(5):
        buffer.set_transform(transform("odom", "base_link", stamp=now - 0.4 + 0.1 * step), "test")
    buffer.set_transform_static(transform("base_link", "laser"), "test")
    told = repr(plot_frames(buffer))
    assert re.search(r"base_link in odom \(12\.5 Hz\)\. laser in base_link \(static\)\.", told)
    with a_node("robot") as node:
        recording = record("/tf", TFMessage)
        with moving(node, ("odom", "base_link")):
            wait_until(lambda: len(recording) > 5)
        recording.stop()
    assert re.search(r"base_link in odom \([\d.]+ Hz\)\.$", repr(plot_frames(recording)))


def test_nothing_to_draw_is_told() -> None:
    assert repr(plot_frames(namespace="/nobody", seconds=0.1)) == "No node says where a frame is in this domain."
