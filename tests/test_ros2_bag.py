"""`ros2 bag` in processes of its own: what it prints, records and plays, and how it ends."""

from __future__ import annotations

import contextlib
import os
import re
import resource
import signal
import statistics
import subprocess
import time
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from types import TracebackType
from typing import Any

import pytest

from course_kit.cli.ros2.bag import text
from course_kit.lab import bags
from course_kit.lab.bags import files as bag_files
from course_kit.lab.bags.files import BagInfo, BagTopic
from course_kit.lab.bags.writer import BagWriter
from course_kit.ros.spinning import context
from course_kit.ros.subscriptions import observer_node, topics
from tests.kernel import Kernel
from tests.ros2_command import COMMAND, ros2
from tests.ros2_running import Running
from tests.senders import DIGITS, PLACES, Sender
from tests.terminal import CTRL_C, Terminal
from tests.waiting import wait_until

pytestmark = pytest.mark.by_turns("many nodes and programs")

SECOND = 10**9
TIMEOUT = 30.0
STORAGES = ("mcap", "sqlite3")


def stop_ros() -> Iterator[None]:
    yield
    context.stop()


clean = pytest.fixture(autouse=True, scope="module")(stop_ros)


def bag_command(*words: str, prepare: Callable[[], None] | None = None) -> Running:
    """`ros2 bag …` while it runs; what it prints on stdout and stderr comes together."""
    return Running("bag", *words, stderr=subprocess.STDOUT, prepare=prepare)


def texts(lines: Sequence[str]) -> list[str]:
    """The lines without what the keyboard's absence adds, and without their stamps."""
    shown = [re.sub(r"^stdin is not a terminal device\. Keyboard handling disabled\.", "", line) for line in lines]
    return [re.sub(r" \[\d+\.\d{9}\]", "", line) for line in shown]


def made_bag(folder: Path, count: int = 100, period: float = 0.01, storage: str = "mcap") -> Path:
    """A bag of numbered strings on /played, one every `period` seconds."""
    from rclpy.serialization import serialize_message
    from std_msgs.msg import String

    writer = BagWriter(folder, storage)
    writer.add_topic("/played", "std_msgs/msg/String")
    for number in range(count):
        data = serialize_message(String(data=str(number)))
        writer.write("/played", 1000 * SECOND + int(number * period * SECOND), data)
    writer.close()
    return folder


class Received:
    """What comes on a topic: numbers and times of receipt."""

    def __init__(self, topic: str) -> None:
        from rclpy.serialization import deserialize_message
        from std_msgs.msg import String

        self.numbers: list[int] = []
        self.times: list[int] = []

        def receive(data: bytes, info: dict[str, Any]) -> None:
            self.times.append(info["received_timestamp"])
            self.numbers.append(int(deserialize_message(data, String).data))

        self._subscription = observer_node.subscribe(topic, receive, String)

    def __enter__(self) -> Received:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, traceback: TracebackType | None
    ) -> None:
        self._subscription.close()


def test_recording_prints_what_rosbag2_prints_and_ends_well_with_ctrl_c(tmp_path: Path) -> None:
    folder = tmp_path / "bag"
    with (
        Sender("/sent", "string", rate=500, count=100) as sender,
        bag_command("record", "-o", str(folder), "/sent") as run,
    ):
        run.until("Stopping discovery...")
        sender.go()
        sender.result()
        wait_until(lambda: _written(folder) == 100)
        run.interrupt()
        assert run.end().status == signal.SIGINT
    shown = texts(run.lines)
    before = [
        '[WARN] [ros2bag]: Positional "topics" argument deprecated. Please use optional "--topics" argument instead.',
        "[INFO] [rosbag2_recorder]: Press SPACE for pausing/resuming",
        "[INFO] [rosbag2_recorder]: Listening for topics...",
        "[INFO] [rosbag2_recorder]: Event publisher thread: Starting",
    ]
    after = [
        "[INFO] [rosbag2_recorder]: All requested topics are subscribed. Stopping discovery...",
        "[INFO] [rosbag2_recorder]: Pausing recording.",
        "[INFO] [rosbag2_cpp]: Writing remaining messages from cache to the bag. It may take a while",
        "[INFO] [rosbag2_recorder]: Event publisher thread: Exiting",
        "[INFO] [rosbag2_recorder]: Recording stopped",
    ]
    assert shown[: len(before)] == before
    assert set(shown[len(before) : -len(after)]) == {
        "[INFO] [rosbag2_recorder]: Recording...",
        "[INFO] [rosbag2_recorder]: Subscribed to topic '/sent'",
    }
    assert shown[-len(after) :] == after
    out = ros2("bag", "info", str(folder))
    assert out.status == 0
    assert out.err == ""
    assert "Topic: /sent | Type: std_msgs/msg/String | Count: 100 | Serialization Format: cdr\n" in out.out
    assert ros2("bag", "info", "-t", str(folder)).out == "/sent\n"
    assert "Size Contribution: 2.3 KiB" in ros2("bag", "info", "-v", str(folder)).out


def test_sigterm_ends_a_recording_well(tmp_path: Path) -> None:
    with bag_command("record", "-o", str(tmp_path / "bag"), "--topics", "/nothing", "-s", "sqlite3") as run:
        run.until("Recording...")
        run.process.terminate()
        assert run.end().status == 0
    assert bags.info(tmp_path / "bag").is_complete
    assert bags.info(tmp_path / "bag").files == ["bag_0.db3"]


def test_all_topics_are_recorded_also_later_ones_but_not_hidden_or_excluded_ones(tmp_path: Path) -> None:
    folder = tmp_path / "bag"
    with bag_command("record", "-a", "-x", "unwanted", "-o", str(folder)) as run:
        run.until("Recording...")
        with (
            Sender("/_hidden", "string"),
            Sender("/unwanted", "string"),
            Sender("/late", "pose", rate=500, count=20) as sender,
        ):
            run.until("Hidden topics are not recorded. Enable them with --include-hidden-topics")
            run.until("Subscribed to topic '/late'")
            sender.go()
            sender.result()
            run.interrupt()
            assert "Recording stopped" in run.end().out
    counts = {topic.name: topic.count for topic in bags.info(folder).topics}
    assert counts["/late"] == 20
    assert {"/late", "/parameter_events", "/rosout"} <= counts.keys()
    assert not {"/_hidden", "/unwanted"} & counts.keys()


@pytest.mark.parametrize("storage", STORAGES)
def test_a_killed_recording_can_be_read_played_and_completed(tmp_path: Path, storage: str) -> None:
    folder = tmp_path / "bag"
    count = 3000
    with (
        Sender("/scan", "scan", rate=1000, count=count) as sender,
        bag_command("record", "-o", str(folder), "-s", storage, "--topics", "/scan") as run,
    ):
        run.until("Subscribed")
        sender.go()
        wait_until(lambda: _written(folder) > 1000)
        run.process.kill()
        run.end()
        sender.result()
    assert not (folder / "metadata.yaml").exists()
    out = ros2("bag", "info", str(folder))
    assert out.status == 0
    found = int(re.findall(r"Messages: +(\d+)", out.out)[0])
    assert found > 1000
    assert out.err == (
        f"[WARN] [ros2bag]: '{folder}' was not closed by its recorder: {found} messages can be read. "
        f"'ros2 bag reindex {folder}' completes it.\n"
    )
    out = ros2("bag", "reindex", str(folder))
    ending = {"mcap": "mcap", "sqlite3": "db3"}[storage]
    assert out.status == 0
    assert texts(out.err.splitlines()) == [
        f'[INFO] [rosbag2_cpp]: Beginning reindexing bag in directory: "{folder}"',
        f"[INFO] [rosbag2_cpp]: 'bag_0.{ending}' was not closed by its recorder: {found} messages were found, "
        "and it is complete now.",
        "[INFO] [rosbag2_cpp]: Reindexing complete.",
    ]
    out = ros2("bag", "info", str(folder))
    assert out.err == ""
    assert f"Count: {found} " in out.out
    place = PLACES["scan"]
    with bag_files.opened(folder) as bag:
        numbers = [int(data[place : place + DIGITS]) for _, _, data in bag.messages(bag.connections)]
    assert numbers == list(range(found))


@pytest.mark.parametrize("storage", STORAGES)
def test_a_bag_that_was_cut_is_shown_played_and_completed(tmp_path: Path, storage: str) -> None:
    folder = made_bag(tmp_path / "bag", 1000, 0.002, storage)
    (file,) = bag_files.storage_files(folder)
    file.write_bytes(file.read_bytes()[: file.stat().st_size * 6 // 10])
    out = ros2("bag", "info", str(folder))
    assert out.status == 0
    found = int(re.findall(r"Messages: +(\d+)", out.out)[0])
    assert 200 < found < 1000
    said = (
        f"[WARN] [ros2bag]: '{folder}' is cut: {found} of its 1000 messages can be read. "
        f"'ros2 bag reindex {folder}' makes them a whole bag.\n"
    )
    assert out.err == said
    with Received("/played") as received:
        out = ros2("bag", "play", str(folder), "--disable-keyboard-controls")
        assert out.status == 0 and said in out.err
        wait_until(lambda: received.numbers == list(range(found)))
    out = ros2("bag", "reindex", str(folder))
    assert texts(out.err.splitlines())[1] == (
        f"[INFO] [rosbag2_cpp]: '{file.name}' was cut and is kept as '{file.name}.damaged-1': "
        f"{found} messages were found, and it is complete now."
    )
    assert ros2("bag", "info", str(folder)).err == ""


def _written(folder: Path) -> int:
    try:
        return bags.info(folder).message_count
    except bags.BagError:
        return 0


@pytest.mark.parametrize("storage", STORAGES)
def test_a_full_disk_ends_the_recording_with_one_line(tmp_path: Path, storage: str) -> None:
    def allow_little() -> None:
        resource.setrlimit(resource.RLIMIT_FSIZE, (2_500_000, 2_500_000))

    folder = tmp_path / "bag"
    with (
        Sender("/scan", "scan", rate=1000, count=3000) as sender,
        bag_command("record", "-o", str(folder), "-s", storage, "--topics", "/scan", prepare=allow_little) as run,
    ):
        run.until("Subscribed")
        sender.go()
        outcome = run.end()
    assert outcome.status == 1
    (line,) = [line for line in run.lines if "[ERROR]" in line]
    assert line.startswith("[ERROR] [ros2bag]: Cannot write to 'bag': ")
    assert "Traceback" not in outcome.out
    assert bags.info(folder).message_count > 0


def test_wrong_command_lines_are_refused_as_rosbag2_does(tmp_path: Path) -> None:
    out = ros2("bag", "record")
    assert (out.out, out.status) == ("", 1)
    assert out.err == (
        "[ERROR] [ros2bag]: Need to specify at least one option out of --all, --all-topics, --all-services, "
        "--services, --topics, --topic-types or --regex\n"
    )
    out = ros2("bag", "record", "-o", str(tmp_path), "-a")
    assert (out.err, out.status) == (f"[ERROR] [ros2bag]: Output folder '{tmp_path}' already exists.\n", 1)
    out = ros2("bag", "record", "-o", str(tmp_path / "x"), "-a", "--snapshot-mode")
    assert (
        out.err
        == "[ERROR] [ros2bag]: --snapshot-mode is not supported here: it needs the ros2 of an installed ROS 2.\n"
    )
    out = ros2("bag", "record", "-o", str(tmp_path / "x"), "-a", "-s", "sqlite3", "-b", "100")
    assert out.err == (
        "[ERROR] [ros2bag]: Invalid bag splitting size given. Please provide a value greater than 86016. "
        "Specified value of 100\n"
    )
    out = ros2("bag", "record", "-o", str(tmp_path / "x"), "-e", "[")
    assert out.err.startswith("[ERROR] [ros2bag]: '[' is no regular expression: ")
    assert not (tmp_path / "x").exists()
    for verb in ("info", "play", "reindex"):
        out = ros2("bag", verb, "nope")
        assert out.err.endswith(f"ros2 bag {verb}: error: argument bag_path: Bag path 'nope' does not exist!\n")
        assert out.status == 2
        out = ros2("bag", verb, str(tmp_path))
        assert out.status == 1
        assert out.err.splitlines()[-1].startswith("[ERROR] [ros2bag]: ")
    out = ros2("bag", "play", str(tmp_path), "-r", "0")
    assert out.err.endswith("error: argument -r/--rate: 0 is not in the valid range (> 0.0)\n")
    (tmp_path / "metadata.yaml").write_text("a: [")
    out = ros2("bag", "info", str(tmp_path))
    assert "is no metadata of a bag" in out.err
    assert "Traceback" not in out.err


def test_playing_keeps_the_recorded_spacing(tmp_path: Path) -> None:
    bag = made_bag(tmp_path / "bag", count=200)
    with Received("/played") as received:
        out = ros2("bag", "play", str(bag))
        wait_until(lambda: len(received.numbers) == 200)
    assert out.status == 0
    assert texts(out.err.splitlines()) == [
        "[INFO] [rosbag2_player]: Set rate to 1",
        "[INFO] [rosbag2_player]: Adding keyboard callbacks.",
        "[INFO] [rosbag2_player]: Press SPACE for Pause/Resume",
        "[INFO] [rosbag2_player]: Press CURSOR_RIGHT for Play Next Message",
        "[INFO] [rosbag2_player]: Press CURSOR_UP for Increase Rate 10%",
        "[INFO] [rosbag2_player]: Press CURSOR_DOWN for Decrease Rate 10%",
        "[INFO] [rosbag2_player]: Playback until timestamp: -1",
    ]
    assert received.numbers == list(range(200))
    times = [t * 1e-6 - 10.0 * number for number, t in enumerate(received.times)]
    late = [t - min(times) for t in times]  # a busy machine delays a few of them, and the first may be among them
    assert statistics.median(late) < 5, "drifts, or one of its messages came too early"
    begin, end = statistics.median(late[:100]), statistics.median(late[100:])
    assert abs(end - begin) < 5, f"drifts: {begin:.1f} ms late in the first half, {end:.1f} ms in the second"


def test_playing_at_another_rate_under_another_name_and_a_part_of_it(tmp_path: Path) -> None:
    bag = made_bag(tmp_path / "bag", count=100, period=0.02, storage="sqlite3")
    words = ("-r", "4", "--start-offset", "1.0", "--playback-duration", "0.5", "-m", "/played:=/renamed")
    with Received("/renamed") as received:
        assert ros2("bag", "play", str(bag), *words, "--disable-keyboard-controls").status == 0
        wait_until(lambda: len(received.numbers) == 26)
    assert received.numbers == list(range(50, 76))
    assert 0.05 < (received.times[-1] - received.times[0]) * 1e-9 < 0.3  # 0.5 s of the bag, four times as fast


def test_bags_are_played_together_as_they_were_recorded(tmp_path: Path) -> None:
    """Their messages come in the order of time, also of a topic that both have; where types differ, none comes."""
    from rclpy.serialization import serialize_message
    from std_msgs.msg import String

    def bag(name: str, topic: str, numbers: Sequence[int], type_name: str = "std_msgs/msg/String") -> str:
        writer = BagWriter(tmp_path / name, "sqlite3" if name == "odd" else "mcap")
        writer.add_topic(topic, type_name)
        for number in numbers:
            writer.write(topic, 1000 * SECOND + number * SECOND // 50, serialize_message(String(data=str(number))))
        writer.close()
        return str(tmp_path / name)

    even, odd, late = bag("even", "/played", range(0, 40, 2)), bag("odd", "/played", range(1, 40, 2)), tmp_path / "late"
    bag("late", "/also", [10])
    with Received("/played") as received, Received("/also") as also:
        out = ros2("bag", "play", "-i", even, "-i", odd, "sqlite3", "--input", str(late), "--start-offset", "0.1")
        wait_until(lambda: len(received.numbers) == 35 and also.numbers == [10])
    assert out.status == 0
    assert received.numbers == list(range(5, 40))
    assert received.times[4] <= also.times[0] <= received.times[7]
    assert 0.5 < (received.times[-1] - received.times[0]) * 1e-9 < 1.0
    out = ros2("bag", "play", "-i", even, "-i", bag("other", "/played", [], "std_msgs/msg/Int32"))
    assert out.err.splitlines()[-1].endswith("'/played' is of two types, std_msgs/msg/String and std_msgs/msg/Int32")
    assert (out.out, out.status) == ("", 1)


def test_playing_in_a_loop_until_ctrl_c(tmp_path: Path) -> None:
    bag = made_bag(tmp_path / "bag", count=10)
    with Received("/played") as received, bag_command("play", "-l", "-d", "0.05", str(bag)) as run:
        wait_until(lambda: len(received.numbers) >= 35)
        run.interrupt()
        assert run.end().status == signal.SIGINT
    assert "Stopping playback." in run.out
    assert received.numbers[:30] == list(range(10)) * 3
    assert sum("Sleep 50000000 ns" in line for line in run.lines) >= 3


def test_what_cannot_be_played_is_skipped_with_a_line(tmp_path: Path) -> None:
    writer = BagWriter(tmp_path / "bag")
    writer.add_topic("/unknown", "nope_msgs/msg/Nope")
    writer.add_topic("/played", "std_msgs/msg/String")
    writer.write("/unknown", SECOND, b"\0\1\0\0\0\0\0\0")
    writer.write("/played", SECOND, b"\0\1\0\0\2\0\0\0007\0")
    writer.close()
    with Received("/played") as received:
        out = ros2("bag", "play", str(tmp_path / "bag"))
        wait_until(lambda: received.numbers == [7])
    assert out.status == 0
    (line,) = [line for line in out.err.splitlines() if "[WARN]" in line]
    assert "Ignoring a topic '/unknown', reason: " in line


def test_playing_offers_the_recorded_profiles(tmp_path: Path) -> None:
    from rclpy.qos import DurabilityPolicy, ReliabilityPolicy

    folder = tmp_path / "bag"
    with (
        Sender("/kept", "string", count=3, qos="latched") as kept,
        Sender("/sensor", "string", count=3, qos="best_effort") as sensor,
        bags.record(folder, "/kept", "/sensor") as recording,
    ):
        wait_until(lambda: len(recording.topics) == 2)
        kept.go()
        sensor.go()
        kept.result()
        sensor.result()
        wait_until(lambda: recording.message_count >= 4)
    with bag_command("play", str(folder), "--start-paused") as run:
        run.until("Playback until")
        node = observer_node.node()

        def named(topic: str) -> list[str]:  # the graph learns a publisher first, then its node's name
            return [*map(topics.node_name, topics.publishers(node, topic))]

        wait_until(lambda: named("/kept") == named("/sensor") == ["/rosbag2_player"])
        (latched,), (best_effort,) = topics.publishers(node, "/kept"), topics.publishers(node, "/sensor")
        assert latched.qos_profile.durability == DurabilityPolicy.TRANSIENT_LOCAL
        assert best_effort.qos_profile.reliability == ReliabilityPolicy.BEST_EFFORT
        run.interrupt()
        run.end()


def test_playing_gives_the_time_of_the_bag(tmp_path: Path) -> None:
    from rclpy.serialization import deserialize_message
    from rosgraph_msgs.msg import Clock

    bag = made_bag(tmp_path / "bag", count=50, period=0.02)
    stamps: list[float] = []

    def receive(data: bytes, info: dict[str, Any]) -> None:
        clock = deserialize_message(data, Clock).clock
        stamps.append(clock.sec + clock.nanosec * 1e-9)

    with contextlib.closing(observer_node.subscribe("/clock", receive, Clock)):
        assert ros2("bag", "play", "--clock", "50", str(bag)).status == 0
        assert len(stamps) > 25
        assert 1000 <= stamps[0] < stamps[-1] < 1001.1
        assert stamps == sorted(stamps)
        for chosen in (("--clock-topics", "/played", "/other"), ("--clock-topics-all",)):
            stamps.clear()
            assert ros2("bag", "play", str(bag), "--playback-until-sec", "1000.19", *chosen).status == 0
            wait_until(lambda: len(stamps) > 5)  # of ten: it is best effort, as rosbag2's
            assert all(round((stamp - 1000) / 0.02, 3) in range(10) for stamp in stamps)
        stamps.clear()
        assert ros2("bag", "play", str(bag), "--clock-topics", "/other", "--playback-until-nsec", "1").status == 0
        assert stamps == []


def test_keys_pause_a_recording(tmp_path: Path) -> None:
    with Terminal([*COMMAND, "bag", "record", "-o", str(tmp_path / "bag"), "-a"]) as terminal:
        terminal.wait_for("Press SPACE for pausing/resuming")
        terminal.wait_for("Recording...")
        terminal.press(b" ")
        terminal.wait_for("Pausing recording.")
        terminal.press(b" ")
        terminal.wait_for("Resuming recording.")
        terminal.press(CTRL_C)
        terminal.wait_for("Recording stopped")
        assert terminal.end() == signal.SIGINT
    assert bags.info(tmp_path / "bag").is_complete


def test_keys_pause_a_bag_that_plays_and_step_through_it(tmp_path: Path) -> None:
    bag = made_bag(tmp_path / "bag", count=50, period=1.0)
    with Received("/played") as received, Terminal([*COMMAND, "bag", "play", str(bag), "--start-paused"]) as terminal:
        terminal.wait_for("Playback until timestamp: -1")
        assert received.numbers == []
        for number in range(3):
            terminal.press(b"\x1b[C")
            wait_until(lambda: len(received.numbers) > number)  # noqa: B023
        terminal.press(b"\x1b[A")
        terminal.wait_for("Set rate to 1.1")
        terminal.press(b" ")
        terminal.wait_for("Resuming play.")
        wait_until(lambda: len(received.numbers) > 4)
        terminal.press(CTRL_C)
        terminal.wait_for("Stopping playback.")
    assert received.numbers[:4] == [0, 1, 2, 3]


def test_recording_in_a_notebook_ends_with_its_duration_or_an_interrupt(tmp_path: Path) -> None:
    kernel = Kernel()
    try:
        with Sender("/sent", "string", rate=100, count=1000) as sender:
            sender.go()
            text = kernel.text(
                kernel.run(f"%ros2 bag record -o {tmp_path}/bag --topics /sent --duration 3", timeout=60)
            )
        assert "Press SPACE" not in text
        assert "[rosbag2_recorder]: Subscribed to topic '/sent'" in text
        assert text.splitlines()[-1].endswith("[rosbag2_recorder]: Recording stopped")
        assert "Count: " in kernel.text(kernel.run(f"%ros2 bag info {tmp_path}/bag", timeout=60))
        cell = kernel.send(f"%ros2 bag record -o {tmp_path}/second -a")
        kernel.until(lambda: "Recording..." in kernel.text(cell), TIMEOUT)
        kernel.manager.interrupt_kernel()
        kernel.finish(cell)
        assert not [m for m in kernel.of(cell) if m["msg_type"] == "error"]
        assert kernel.text(kernel.run("import rclpy; print(rclpy.ok())", timeout=60)).strip() == "True"
    finally:
        kernel.close()
    assert bags.info(tmp_path / "bag").message_count > 0  # how many depends on how busy the machine is
    assert bags.info(tmp_path / "second").is_complete


def test_info_is_printed_as_jazzy_prints_it(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("TZ", "Asia/Shanghai")
    time.tzset()
    found = BagInfo(
        path=Path("subset"),
        files=["subset_0.mcap"],
        size=106_496,
        storage="mcap",
        distro="jazzy",
        start=1764769520641051266,
        duration=22031464610,
        message_count=1386,
        topics=[
            BagTopic("/turtle1/pose", "turtlesim/msg/Pose", 1378),
            BagTopic("/turtle1/cmd_vel", "geometry_msgs/msg/Twist", 5),
            BagTopic("/add/_service_event", "example_interfaces/srv/AddTwoInts_Event", 3),
        ],
    )
    assert text.info_text(found).splitlines() == [
        "",
        "Files:             subset_0.mcap",
        "Bag size:          104.0 KiB",
        "Storage id:        mcap",
        "ROS Distro:        jazzy",
        "Duration:          22.031464610s",
        "Start:             Dec  3 2025 21:45:20.641051266 (1764769520.641051266)",
        "End:               Dec  3 2025 21:45:42.672515876 (1764769542.672515876)",
        "Messages:          1383",
        "Topic information: Topic: /turtle1/cmd_vel | Type: geometry_msgs/msg/Twist | Count: 5 | "
        "Serialization Format: cdr",
        "                   Topic: /turtle1/pose | Type: turtlesim/msg/Pose | Count: 1378 | Serialization Format: cdr",
        "Service:           1",
        "Service information: Service: /add | Type: example_interfaces/srv/AddTwoInts | Event Count: 3 | "
        "Serialization Format: cdr",
    ]
    assert text.size_text(999) == "999 B"
    monkeypatch.delenv("TZ")
    time.tzset()
    assert os.environ.get("TZ") is None
