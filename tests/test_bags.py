"""Bags in notebooks: what is recorded, and what can be read of it, also after a crash."""

from __future__ import annotations

import re
import shutil
from collections.abc import Iterator
from pathlib import Path
from random import Random
from typing import Any

import pytest
import yaml

from course_kit.lab import bags
from course_kit.lab.bags import files as bag_files
from course_kit.lab.bags import qos as bag_qos
from course_kit.lab.bags import types as bag_types
from course_kit.lab.bags.read_ahead import ReadAhead
from course_kit.lab.bags.writer import BagWriter
from course_kit.ros.spinning import context
from tests.senders import DIGITS, PLACES, Sender
from tests.waiting import wait_until

pytestmark = pytest.mark.by_turns("many nodes and programs")

STORAGES = ("mcap", "sqlite3")
SECOND = 10**9


def stop_ros() -> Iterator[None]:
    yield
    context.stop()


clean = pytest.fixture(autouse=True, scope="module")(stop_ros)


def made_bag(folder: Path, storage: str = "mcap", count: int = 500, topic_count: int = 2, size: int = 0) -> Path:
    """A bag of numbered strings of `size` characters at least, one every 10 ms, on topics that take turns."""
    from rclpy.serialization import serialize_message
    from std_msgs.msg import String

    writer = BagWriter(folder, storage)
    names = [f"/topic_{number}" for number in range(topic_count)]
    for name in names:
        writer.add_topic(name, "std_msgs/msg/String")
    for number in range(count):
        data = serialize_message(String(data=text(number, size)))
        writer.write(names[number % topic_count], SECOND + number * 10_000_000, data)
        if number % 100 == 99:
            writer.flush()
    writer.close()
    return folder


def text(number: int, size: int) -> str:
    return str(number).zfill(size)


def numbers(folder: Path, *names: str) -> list[int]:
    return [int(message.data[-9:]) for _, _, message in bags.read(folder, *names)]


@pytest.mark.parametrize("storage", STORAGES)
@pytest.mark.parametrize("kind", ["string", "scan", "pose"])
def test_every_message_is_recorded_as_it_came(tmp_path: Path, storage: str, kind: str) -> None:
    count = 300
    with Sender("/sent", kind, rate=1000, count=count) as sender:
        with bags.record(tmp_path / "bag", "/sent", storage=storage) as recording:
            wait_until(lambda: recording.topics == ["/sent"])
            sender.go()
            sender.result()
            wait_until(lambda: recording.message_count == count)
        assert recording.lost == 0
    messages = list(bags.read(tmp_path / "bag"))
    assert len(messages) == count
    assert {topic for topic, _, _ in messages} == {"/sent"}
    times = [nanoseconds for _, nanoseconds, _ in messages]
    assert times == sorted(times)
    if kind == "string":
        assert [int(message.data) for _, _, message in messages] == list(range(count))
    if kind == "pose":
        assert all(message.x == 1.0 for _, _, message in messages)


@pytest.mark.parametrize("storage", STORAGES)
def test_a_bag_tells_its_types_profiles_and_times(tmp_path: Path, storage: str) -> None:
    """What Jazzy's `ros2 bag info` reads from metadata.yaml, and what readers without our types need."""
    from rosbags.highlevel import AnyReader

    with (
        Sender("/pose", "pose", rate=500, count=20, qos="best_effort") as sender,
        bags.record(tmp_path / "bag", "/pose", storage=storage) as recording,
    ):
        wait_until(lambda: recording.topics)
        sender.go()
        sender.result()
        wait_until(lambda: recording.message_count > 0)
    told = yaml.safe_load((tmp_path / "bag/metadata.yaml").read_text())["rosbag2_bagfile_information"]
    ending = {"mcap": "mcap", "sqlite3": "db3"}[storage]
    assert told["version"] == 9
    assert told["storage_identifier"] == storage
    assert told["relative_file_paths"] == [f"bag_0.{ending}"] == [file["path"] for file in told["files"]]
    assert told["ros_distro"] == "jazzy"
    (topic,) = told["topics_with_message_count"]
    assert topic["message_count"] == told["message_count"] > 0
    described = topic["topic_metadata"]
    assert described["type"] == "turtlesim/msg/Pose"
    assert described["type_description_hash"] == bag_types.type_hash("turtlesim/msg/Pose")
    assert described["type_description_hash"].startswith("RIHS01_")
    (profile,) = described["offered_qos_profiles"]
    assert profile["reliability"] == "best_effort"
    assert profile["deadline"] == {"sec": 9223372036, "nsec": 854775807}
    with AnyReader([tmp_path / "bag"]) as reader:  # takes the types from the bag alone
        _, _, data = next(iter(reader.messages()))
        assert reader.deserialize(data, "turtlesim/msg/Pose").x == 1.0  # type: ignore[attr-defined]
    found = bags.info(tmp_path / "bag")
    assert found.is_complete
    assert found.message_count == topic["message_count"]
    assert 0 < found.seconds < 60


def test_a_definition_holds_all_types_that_a_type_is_made_of() -> None:
    from rosbags.typesys import Stores, get_types_from_msg, get_typestore

    text = bag_types.definition("geometry_msgs/msg/TwistStamped")
    assert text.count(f"\n{'=' * 80}\nMSG: ") == 4
    assert "MSG: builtin_interfaces/Time\n" in text
    assert "geometry_msgs/msg/TwistStamped" in get_types_from_msg(
        text.split(f"\n{'=' * 80}")[0], "geometry_msgs/msg/TwistStamped"
    )
    store = get_typestore(Stores.ROS2_JAZZY)
    for name in ("std_msgs/msg/String", "sensor_msgs/msg/LaserScan", "geometry_msgs/msg/TwistStamped"):
        assert bag_types.type_hash(name) == store.hash_rihs01(name)
    assert bag_types.definition("nope/msg/Nope") == bag_types.type_hash("nope/msg/Nope") == ""


def test_a_thousand_scans_a_second_are_recorded_without_loss(tmp_path: Path) -> None:
    count = 2000
    with Sender("/scan", "scan", rate=1000, count=count) as sender:
        with bags.record(tmp_path / "bag", "/scan") as recording:
            wait_until(lambda: recording.topics)
            sender.go()
            sender.result()
            wait_until(lambda: recording.message_count == count, timeout=10)
        assert recording.lost == 0
    place = PLACES["scan"]
    with bag_files.opened(tmp_path / "bag") as bag:
        found = [int(data[place : place + DIGITS]) for _, _, data in bag.messages(bag.connections)]
    assert found == list(range(count))


def test_a_topic_that_appears_later_is_recorded(tmp_path: Path) -> None:
    with bags.record(tmp_path / "bag") as recording:
        assert "/late" not in recording.topics
        with Sender("/late", "string", rate=500, count=50) as sender:
            wait_until(lambda: "/late" in recording.topics)
            sender.go()
            sender.result()
            wait_until(lambda: recording.message_count >= 50)
    assert numbers(tmp_path / "bag", "/late") == list(range(50))


def test_a_folder_that_is_there_is_not_overwritten_unless_told(tmp_path: Path) -> None:
    made_bag(tmp_path / "bag")
    with pytest.raises(FileExistsError, match=r"Output folder '.*bag' already exists\."):
        bags.record(tmp_path / "bag")
    bags.record(tmp_path / "bag", "/nothing", overwrite=True).stop()
    assert bags.info(tmp_path / "bag").message_count == 0
    (tmp_path / "work").mkdir()
    with pytest.raises(FileExistsError):
        bags.record(tmp_path / "work", overwrite=True)  # no bag: it might be anything


def test_two_recordings_at_once_and_a_second_stop(tmp_path: Path) -> None:
    with Sender("/both", "string", rate=200, count=200) as sender:
        first, second = bags.record(tmp_path / "one", "/both"), bags.record(tmp_path / "two", "/both")
        wait_until(lambda: first.topics and second.topics)
        sender.go(subscriptions=2)
        sender.result()
        wait_until(lambda: numbers(tmp_path / "one")[-1:] == numbers(tmp_path / "two")[-1:] == [199])
        first.stop()
        first.stop()
        assert second.is_running
        second.stop()
    for name in ("one", "two"):
        assert numbers(tmp_path / name) == list(range(200))


def test_reading_gives_the_topics_asked_for_and_names_those_that_are_not_there(tmp_path: Path) -> None:
    bag = made_bag(tmp_path / "bag", count=10)
    assert numbers(bag) == list(range(10))
    assert numbers(bag, "/topic_1") == [1, 3, 5, 7, 9]
    with pytest.raises(bags.BagError, match=r"has no topic /nope\. It has: /topic_0, /topic_1\."):
        numbers(bag, "/nope")
    with pytest.raises(bags.BagError, match="does not exist"):
        numbers(tmp_path / "nope")
    (tmp_path / "empty").mkdir()
    with pytest.raises(bags.BagError, match="holds no bag"):
        bags.info(tmp_path / "empty")


@pytest.mark.parametrize("storage", STORAGES)
def test_large_bags_are_split(tmp_path: Path, storage: str) -> None:
    writer = BagWriter(tmp_path / "bag", storage, max_seconds=1)
    writer.add_topic("/a", "std_msgs/msg/String")
    from rclpy.serialization import serialize_message
    from std_msgs.msg import String

    for number in range(35):
        writer.write("/a", SECOND + number * SECOND // 10, serialize_message(String(data=str(number))))
    writer.close()
    found = bags.info(tmp_path / "bag")
    assert [Path(name).stem for name in found.files] == ["bag_0", "bag_1", "bag_2", "bag_3"]
    assert numbers(tmp_path / "bag") == list(range(35))
    (tmp_path / "bag/metadata.yaml").unlink()
    assert bags.reindex(tmp_path / "bag") == {}
    assert bags.info(tmp_path / "bag") == found


def test_a_file_cut_anywhere_is_read_up_to_there(tmp_path: Path) -> None:
    whole = made_bag(tmp_path / "whole", count=500)
    data = (whole / "whole_0.mcap").read_bytes()
    counts = []
    for length in range(0, len(data), max(1, len(data) // 60)):
        shutil.rmtree(tmp_path / "cut", ignore_errors=True)
        (tmp_path / "cut").mkdir()
        (tmp_path / "cut/cut_0.mcap").write_bytes(data[:length])
        try:
            found = numbers(tmp_path / "cut")
        except bags.BagError:
            assert length < 100, "only a file without a header is no bag"
            continue
        assert found == list(range(len(found)))
        counts.append(len(found))
        assert bags.info(tmp_path / "cut").message_count == len(found)
        bags.reindex(tmp_path / "cut")
        completed = bags.info(tmp_path / "cut")
        assert completed.is_complete
        assert completed.message_count == len(found)
        assert numbers(tmp_path / "cut") == found
    assert counts == sorted(counts)
    assert counts[-1] == 500


@pytest.mark.parametrize("storage", STORAGES)
@pytest.mark.parametrize("size", [5, 3000, 10_000])
def test_a_closed_bag_that_was_cut_gives_what_is_left(
    tmp_path: Path, storage: str, size: int, capsys: pytest.CaptureFixture[str]
) -> None:
    count = 2000 if size == 5 else 300
    whole = made_bag(tmp_path / "bag", storage, count, size=size)
    (file,) = bag_files.storage_files(whole)
    data = file.read_bytes()
    for part in (0.3, 0.6, 0.61, 0.95):
        file.write_bytes(data[: int(len(data) * part)])
        shutil.copytree(whole, tmp_path / "cut")
        found = numbers(tmp_path / "cut")
        assert found == list(range(len(found)))
        lost = 1 if storage == "mcap" else 4096 // size + 1  # messages of a page are lost with its end
        left = file.read_bytes()
        held = max((n for n in range(count) if text(n, min(size, 9)).encode() + b"\0" in left), default=0)
        assert len(found) >= held - lost, (part, len(found), held)
        (said,) = capsys.readouterr().err.splitlines()
        assert said == (
            f"bags: '{tmp_path}/cut' is cut: {len(found)} of its {count} messages can be read. "
            f"'ros2 bag reindex {tmp_path}/cut' makes them a whole bag."
        )
        told = bags.info(tmp_path / "cut")
        assert (told.message_count, f"bags: {told.notice}", told.is_complete) == (len(found), said, False)
        ((name, made),) = bags.reindex(tmp_path / "cut").items()
        assert (name, made.message_count) == (file.name, len(found))
        assert (tmp_path / "cut" / made.kept).read_bytes() == file.read_bytes()
        told = bags.info(tmp_path / "cut")
        assert (told.message_count, told.notice, told.is_complete) == (len(found), "", True)
        assert numbers(tmp_path / "cut") == found and not capsys.readouterr().err
        assert {topic.type_hash for topic in told.topics} == {bag_types.type_hash("std_msgs/msg/String")}
        shutil.rmtree(tmp_path / "cut")


def test_an_sqlite3_file_cut_anywhere_is_read_up_to_there(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    whole = made_bag(tmp_path / "whole", "sqlite3", count=500)
    data = (whole / "whole_0.db3").read_bytes()
    counts: list[int] = []
    for length in range(0, len(data), max(1, len(data) // 60)):
        file = tmp_path / "cut.db3"
        file.write_bytes(data[:length])
        try:
            found = numbers(file)
        except bags.BagError as error:
            assert "cannot be read" in str(error) and not counts
            continue
        assert found == list(range(len(found)))
        counts.append(len(found))
        assert f"'{file}' is cut: {len(found)} messages can be read." in capsys.readouterr().err
        assert file.read_bytes() == data[:length], "a bag that is read stays as it is"
    assert counts == sorted(counts)
    assert len(counts) > 40 and counts[-1] > 400


def test_metadata_that_cannot_be_written_leaves_the_earlier_one(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    bag = made_bag(tmp_path / "bag")
    before = (bag / "metadata.yaml").read_bytes()

    def fail(*paths: object) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr("os.replace", fail)
    with pytest.raises(bags.BagError, match=r"metadata\.yaml' cannot be written: No space left on device\. Make room"):
        bags.reindex(bag)
    assert (bag / "metadata.yaml").read_bytes() == before
    assert sorted(file.name for file in bag.iterdir()) == ["bag_0.mcap", "metadata.yaml"]


def test_reindexing_keeps_what_the_bag_told_of_its_topics(tmp_path: Path) -> None:
    bag = made_bag(tmp_path / "bag")
    before = yaml.safe_load((bag / "metadata.yaml").read_text())
    (bag / "metadata.yaml").unlink()
    data = (bag / "bag_0.mcap").read_bytes()
    (bag / "bag_0.mcap").write_bytes(data[: -len(data) // 10])
    assert list(bags.reindex(bag)) == ["bag_0.mcap"]
    after = yaml.safe_load((bag / "metadata.yaml").read_text())
    for told in (before, after):
        for topic in told["rosbag2_bagfile_information"]["topics_with_message_count"]:
            del topic["message_count"]
    key = "topics_with_message_count"
    assert after["rosbag2_bagfile_information"][key] == before["rosbag2_bagfile_information"][key]


def test_a_bag_that_is_being_recorded_can_be_looked_into_but_not_reindexed(tmp_path: Path) -> None:
    with Sender("/now", "string", rate=500, count=50) as sender, bags.record(tmp_path / "bag", "/now") as recording:
        wait_until(lambda: recording.topics)
        sender.go()
        sender.result()
        wait_until(lambda: (tmp_path / "bag/bag_0.mcap").stat().st_size > 500)
        wait_until(lambda: bags.info(tmp_path / "bag").message_count == 50)
        with pytest.raises(bags.BagError, match="is still being recorded"):
            bags.reindex(tmp_path / "bag")
    assert numbers(tmp_path / "bag") == list(range(50))


def test_playing_publishes_what_was_recorded(tmp_path: Path) -> None:
    bag = made_bag(tmp_path / "bag", count=40, topic_count=1)
    with bags.record(tmp_path / "copy", "/topic_0") as recording:
        played: list[None] = []
        bags.play(bag, rate=1.0, tick=lambda: played.append(None))  # the recorder finds the topic while it plays
        wait_until(lambda: recording.topics == ["/topic_0"])
        assert played
    with pytest.raises(ValueError, match="rate must be how many times as fast, more than 0"):
        bags.play(bag, rate=0)


def test_profiles_come_back_as_they_were_recorded() -> None:
    from rclpy.duration import Duration
    from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy

    latched = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL, deadline=Duration(seconds=2))
    offered = bag_qos.to_offer([bag_qos.recorded(latched)] * 2)
    assert offered.durability == DurabilityPolicy.TRANSIENT_LOCAL
    assert offered.deadline == Duration(seconds=2)
    sensor = QoSProfile(depth=1, reliability=ReliabilityPolicy.BEST_EFFORT)
    assert bag_qos.to_offer([bag_qos.recorded(sensor)]).reliability == ReliabilityPolicy.BEST_EFFORT
    mixed = bag_qos.to_offer([bag_qos.recorded(sensor), bag_qos.recorded(latched)])
    assert mixed.reliability == ReliabilityPolicy.RELIABLE
    assert mixed.durability == DurabilityPolicy.VOLATILE


@pytest.mark.parametrize(
    ("described", "message"),
    [
        ("a", "must map each topic"),
        ({"/a": {"depth": -1}}, "`depth` may not be a negative value."),
        ({"/a": {"nope": 1}}, "Unexpected key `nope` for QoS profile."),
        ({"/a": {"history": "keep_last"}}, "depth"),
        ({"/a": {"depth": 1, "deadline": {"sec": 1}}}, "both seconds"),
        ({"/a": {"depth": 1, "reliability": "sometimes"}}, "`sometimes` is no value of `reliability`"),
    ],
)
def test_overrides_that_are_no_profiles_are_named(described: Any, message: str) -> None:
    with pytest.raises(ValueError, match=message):
        bag_qos.overrides(described)


def test_overrides_are_profiles() -> None:
    found = bag_qos.overrides({"/a": {"depth": 5, "reliability": "best_effort", "deadline": {"sec": 1, "nsec": 5}}})
    assert found["/a"].depth == 5
    assert found["/a"].deadline.nanoseconds == 1_000_000_005


def test_what_reading_ahead_raises_comes_out_where_it_is_read() -> None:
    def items() -> Iterator[Any]:
        yield 1
        raise RuntimeError("broken file")

    ahead = ReadAhead(items(), 10)
    assert ahead.next(lambda: None) == 1
    with pytest.raises(RuntimeError, match="broken file"):
        ahead.next(lambda: None)
    ahead.close()


@pytest.mark.parametrize("storage", STORAGES)
@pytest.mark.parametrize(("was_closed", "part"), [(True, 1.0), (False, 1.0), (True, 0.6)])
def test_of_a_damaged_bag_one_line_says_that_it_cannot_be_read(
    tmp_path: Path, storage: str, was_closed: bool, part: float
) -> None:
    whole = made_bag(tmp_path / "whole", storage, count=60)
    (file,) = bag_files.storage_files(whole)
    data = file.read_bytes()
    if storage == "mcap" and not was_closed:
        data = data[: data.index(b"serialized_metadata")]
    refused, data = 0, data[: int(len(data) * part)]
    for seed in range(60):
        changed, random = bytearray(data), Random(seed)
        for _ in range(20):
            changed[random.randrange(20, len(data))] = random.randrange(256)
        shutil.rmtree(tmp_path / "bag", ignore_errors=True)
        (tmp_path / "bag").mkdir()
        (tmp_path / "bag" / file.name).write_bytes(changed)
        if was_closed:
            shutil.copy(whole / "metadata.yaml", tmp_path / "bag")
        try:
            with bag_files.opened(tmp_path / "bag") as bag:
                list(bag.messages(bag.connections))
        except bags.BagError as error:
            assert "cannot be read" in str(error)
            refused += 1
        try:
            bags.reindex(tmp_path / "bag")
        except bags.BagError as error:
            assert re.search("cannot be (read|completed)", str(error))
    assert refused > 5
