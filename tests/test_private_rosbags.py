"""The contract with rosbags: what the course uses of it below its public classes, and what it does without."""

from __future__ import annotations

import shutil
import subprocess
import sys
from pathlib import Path

import pytest
from rosbags.interfaces import Connection
from rosbags.rosbag2 import Reader, storage_mcap, storage_sqlite3
from rosbags.rosbag2.metadata import dump_qos_v9

from course_kit.lab import bags
from course_kit.lab.bags.files import opened
from course_kit.lab.bags.metadata import profiles_of
from course_kit.lab.bags.qos import recorded
from course_kit.lab.bags.writer import BagWriter

STORAGES = ("mcap", "sqlite3")
ENDINGS = {"mcap": "mcap", "sqlite3": "db3"}
DATA = b"\0\1\0\0\2\0\0\0a\0"  # a std_msgs/msg/String
WRITERS = {"mcap": storage_mcap.McapWriter, "sqlite3": storage_sqlite3.Sqlite3Writer}


def begun_bag(folder: Path, storage: str = "mcap") -> BagWriter:
    """A bag of 20 messages, half of them behind the others in time, that is flushed and not closed."""
    from rclpy.qos import QoSProfile

    writer = BagWriter(folder, storage)
    for topic in ("/early", "/late"):
        writer.add_topic(topic, "std_msgs/msg/String", [recorded(QoSProfile(depth=3))], digest="RIHS01_00")
    for number in range(10):
        writer.write("/late", 100 + number, DATA)
    writer.flush()
    for number in range(10):
        writer.write("/early", number, DATA)
    writer.flush()
    return writer


def contents(folder: Path) -> tuple[list[int], set[tuple[str, str, int]]]:
    """The times of the messages, in the order in which they are read; topic, hash and number of messages of each."""
    with opened(folder) as bag:
        times = [nanoseconds for _, nanoseconds, _ in bag.messages(bag.connections)]
        return times, {(c.topic, c.digest, c.msgcount) for c in bag.connections}


@pytest.mark.parametrize("storage", STORAGES)
def test_a_bag_is_whole_after_each_flush_and_after_its_end(tmp_path: Path, storage: str) -> None:
    writer = begun_bag(tmp_path / "bag", storage)
    whole = [*range(10), *range(100, 110)], {("/early", "RIHS01_00", 10), ("/late", "RIHS01_00", 10)}
    killed = Path(shutil.copytree(tmp_path / "bag", tmp_path / "killed"))
    assert contents(killed) == whole
    bags.reindex(killed)
    assert contents(killed) == whole
    writer.close()
    assert contents(tmp_path / "bag") == whole
    assert contents(tmp_path / f"bag/bag_0.{ENDINGS[storage]}") == whole
    with Reader(tmp_path / "bag") as reader:
        assert [nanoseconds for _, nanoseconds, _ in reader.messages()] == whole[0]


def test_profiles_are_written_as_rosbags_writes_them(tmp_path: Path) -> None:
    begun_bag(tmp_path / "bag").close()
    with opened(tmp_path / "bag") as bag:
        (connection, *_) = bag.connections
        assert isinstance(connection, Connection)
        profiles = profiles_of(connection)
        assert profiles == dump_qos_v9(connection.ext.offered_qos_profiles)  # type: ignore[union-attr]
        assert list(profiles[0]) == list(dump_qos_v9(connection.ext.offered_qos_profiles)[0])  # type: ignore[union-attr]


@pytest.mark.parametrize("storage", STORAGES)
def test_where_files_are_written_in_another_way_no_bag_is_begun(
    tmp_path: Path, storage: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    def other(self: object, path: Path, compression: object) -> None:
        """A writer of another form."""

    monkeypatch.setattr(WRITERS[storage], "__init__", other)
    with pytest.raises(bags.BagError, match=rf"No bag of {storage} can be written: rosbags [\d.]+ writes {storage}"):
        bags.record(tmp_path / "bag", "/a", storage=storage)
    assert not (tmp_path / "bag").exists()
    (rest,) = {*STORAGES} - {storage}
    begun_bag(tmp_path / "rest", rest).close()


@pytest.mark.parametrize("part", ["close_chunk", "Channel", "McapWriter"])
def test_the_command_says_in_one_line_what_does_not_work(tmp_path: Path, part: str) -> None:
    owner = "storage_mcap.McapWriter" if part == "close_chunk" else "storage_mcap"
    words = ["bag", "record", "-o", "x", "--all", "--disable-keyboard-controls"]
    code = (
        f"from rosbags.rosbag2 import storage_mcap\ndel {owner}.{part}\n"
        f"from course_kit.cli.ros2 import command\nraise SystemExit(command.run({words}))"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, timeout=60, cwd=tmp_path)
    assert done.returncode == 1
    (said,) = done.stderr.splitlines()
    assert said.startswith("[ERROR] [ros2bag]: No bag of mcap can be written: rosbags ") and part in said


def test_where_mcap_files_are_read_in_another_way_closed_bags_are_read_all_the_same(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    writer = begun_bag(tmp_path / "bag")
    shutil.copytree(tmp_path / "bag", tmp_path / "killed")
    writer.close()
    monkeypatch.delattr(storage_mcap.McapReader, "meta_scan")
    with pytest.raises(bags.BagError, match=r"cannot be read as a bag: rosbags [\d.]+ reads mcap files in another way"):
        bags.info(tmp_path / "killed")
    with pytest.raises(bags.BagError, match="cannot be completed: rosbags"):
        bags.reindex(tmp_path / "killed")
    assert len(contents(tmp_path / "bag")[0]) == 20


def test_without_what_channels_say_a_bag_is_read_without_hashes(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]
) -> None:
    begun_bag(tmp_path / "bag").close()
    plain = storage_mcap.McapReader._open

    def other(self: storage_mcap.McapReader) -> None:
        plain(self)
        self.channels = {}

    monkeypatch.setattr(storage_mcap.McapReader, "_open", other)
    for _ in range(2):
        assert contents(tmp_path / "bag/bag_0.mcap")[1] == {("/early", "", 10), ("/late", "", 10)}
    (said,) = capfd.readouterr().err.splitlines()
    assert said.startswith("course_kit: rosbags ") and said.endswith("without the hashes of their types")
