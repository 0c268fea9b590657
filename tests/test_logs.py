"""Logs: filters, how much each node logs, levels at run time, log files."""

from __future__ import annotations

import sys
import time
from collections.abc import Iterator
from pathlib import Path

import pytest
from rclpy.logging import LoggingSeverity, set_logger_level
from rclpy.node import Node

from course_kit.base.programs import processes
from course_kit.base.programs.child_process import Process
from course_kit.lab.background import running
from course_kit.lab.background.log_levels import log_level, set_log_level
from course_kit.lab.node_logs import rosout
from course_kit.lab.node_logs.log_directory import log_files, parse
from course_kit.ros.log_folder import log_folder
from course_kit.ros.spinning import context
from tests.waiting import wait_until

PROGRAM = [sys.executable, str(Path(__file__).with_name("plain_node.py"))]


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Path]:
    """Where the log files of this module's processes go."""
    place = tmp_path_factory.mktemp("logs")
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("ROS_LOG_DIR", str(place))
        yield place


@pytest.fixture(scope="module")
def robot(folder: Path) -> Iterator[tuple[Process, Process]]:
    """A node with logger services and one without, each in a process of its own."""
    rosout.collect()
    both = [processes.start([*PROGRAM, *words], name=words[0]) for words in (["open", "services"], ["closed"])]
    wait_until(lambda: rosout.logs("/robot/open") and rosout.logs("/robot/closed"))
    yield both[0], both[1]
    for process in both:
        process.stop()
    running.stop()
    context.stop()


def test_lines_are_chosen_by_node_namespace_level_and_text(robot: object) -> None:
    wait_until(lambda: rosout.logs("/robot/open", "WARN") and rosout.logs("/robot/closed", "WARN"))
    assert {line.node for line in rosout.logs("/robot", last=100)} >= {"/robot/open", "/robot/closed"}
    assert {line.level_name for line in rosout.logs("robot/open", "warning")} == {"WARN"}
    assert {line.text for line in rosout.logs("/robot/open", text="FACT")} == {"a fact"}
    assert rosout.logs("/robo") == [] and rosout.logs(text="nothing like it") == []
    with pytest.raises(ValueError, match="there is no log level 'LOUD'"):
        rosout.logs(level="LOUD")


def test_how_much_each_node_logs_is_counted(robot: object) -> None:
    def loud() -> object:
        return rosout.log_rates(2.0).get("/robot/closed", (0.0, {}))[0] > 20

    wait_until(loud)  # 20 lines of two levels each second, on a machine that is not too busy
    rate, counts = rosout.log_rates(2.0)["/robot/closed"]
    assert rate == pytest.approx(sum(counts.values()) / 2.0) and set(counts) == {"INFO", "WARN"}
    assert repr(rosout.log_rates(2.0)).split()[:3] == ["node", "lines/s", "DEBUG"]
    with pytest.raises(ValueError, match="seconds must be a span of time"):
        rosout.log_rates(0)


def test_the_level_of_a_node_in_another_process_is_read_and_changed(robot: object) -> None:
    set_log_level("/robot/open", "INFO")
    assert log_level("/robot/open") == "INFO"
    set_log_level("robot/open", "debug")
    assert log_level("/robot/open") == "DEBUG"
    wait_until(lambda: any(line.level_name == "DEBUG" for line in rosout.logs("/robot/open", "DEBUG", last=10)))
    set_log_level("/robot/open", "ERROR")
    now = time.time()
    wait_until(lambda: any(line.when > now + 0.5 for line in rosout.logs("/robot/closed")))
    assert [line for line in rosout.logs("/robot/open") if line.when > now + 0.3] == []
    set_log_level("/robot/open", "INFO")


def test_the_level_of_a_node_in_this_process_too(robot: object) -> None:
    node = running.run(Node, "mine")
    for level in ("DEBUG", "ERROR", "INFO"):
        set_log_level(node, level)
        assert log_level("mine") == log_level(node) == level
    set_log_level("/mine", "WARN")
    node.get_logger().info("not this")
    node.get_logger().warn("but this")
    wait_until(lambda: rosout.logs("/mine"))
    assert [line.text for line in rosout.logs("/mine")] == ["but this"]


def test_a_level_ends_with_the_node_that_it_was_set_for(robot: object) -> None:
    set_log_level(running.run(Node, "mine"), "ERROR")
    assert log_level(running.run(Node, "mine")) == "INFO"  # in the place of the other
    set_log_level("mine", "DEBUG")
    running.stop("mine")
    set_logger_level("mine", LoggingSeverity.WARN)  # of no node yet: as --log-level does for a program
    assert log_level(running.run(Node, "mine")) == "WARN"


def test_what_cannot_be_changed_is_said_in_one_line(robot: object) -> None:
    with pytest.raises(RuntimeError, match=r"/robot/closed has no service .* enable_logger_service=True") as error:
        set_log_level("/robot/closed", "DEBUG")
    assert "\n" not in str(error.value) and "--log-level robot.closed:=debug" in str(error.value)
    with pytest.raises(ValueError, match=r"there is no node /nobody \(waited 0.5 s\). Nodes: .*/robot/closed"):
        log_level("nobody", timeout=0.5)
    with pytest.raises(ValueError, match="there is no log level"):
        set_log_level("/robot/open", "LOUD")
    with pytest.raises(TypeError, match="give a node or the name of one, not int"):
        log_level(3)  # type: ignore[arg-type]


def test_every_process_has_a_log_file_of_its_own(robot: tuple[Process, Process]) -> None:
    closed = robot[1]
    found = wait_until(lambda: log_files(closed.pid))  # what is logged is written in blocks of 4 kB
    (file,) = found
    assert file.pid == closed.pid and file.is_running and file.program.startswith("python")
    assert abs(file.start - time.time()) < 120
    warnings = file.lines(level="WARN")
    assert warnings and {(line.node, line.text) for line in warnings[:-1]} == {("/robot/closed", "two\nlines")}
    assert {line.level_name for line in file.lines()} == {"INFO", "WARN"}
    assert file.lines(node="/other") == [] and len(file.lines(last=3)) == 3
    assert f"{closed.pid}, runs" in repr(found)


def test_a_file_is_complete_when_its_process_has_ended(folder: Path) -> None:
    process = processes.start([*PROGRAM, "short"], name="short")
    rosout.collect()
    wait_until(lambda: len(rosout.logs("/robot/short")) >= 4)
    process.stop()
    (file,) = log_files(process.pid)
    assert not file.is_running and f"{process.pid}, ended" in repr(log_files())
    seen = [line for line in rosout.logs("/robot/short", last=1000)]
    written = {(round(line.when, 6), line.text) for line in file.lines()}
    assert {(round(line.when, 6), line.text) for line in seen} <= written


def test_the_folder_is_ros_own_choice(tmp_path: Path) -> None:
    home = Path.home()
    assert log_folder({}) == home / ".ros/log"
    assert log_folder({"ROS_HOME": "/robot"}) == Path("/robot/log")
    assert log_folder({"ROS_HOME": "/robot", "ROS_LOG_DIR": "/here"}) == Path("/here")
    assert log_folder({"ROS_LOG_DIR": ""}) == home / ".ros/log"


def test_no_folder_and_launches(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("ROS_LOG_DIR", str(tmp_path / "none"))
    assert log_files() == [] and "no log files in" in repr(log_files())
    monkeypatch.setenv("ROS_LOG_DIR", str(tmp_path))
    launch = tmp_path / "2026-01-01-10-00-00-000000-robot-12"
    launch.mkdir()
    (launch / "launch.log").write_text("1795257602.5447 [INFO] [launch]: All log files can be found below\nmore\n")
    (tmp_path / "python3_12_1795257602000.log").touch()
    (file,) = log_files()
    assert file.pid is None and [line.text for line in file.lines()] == ["All log files can be found below\nmore"]
    assert len(log_files(with_empty=True)) == 2 and len(log_files("python3", with_empty=True)) == 1


def test_lines_of_files_are_understood() -> None:
    line = parse("[WARN] [1795257602.544754480] [robot.talker]: a text: with [brackets]")
    assert line is not None and (line.node, line.level, line.text) == ("/robot/talker", 30, "a text: with [brackets]")
    assert line.when == pytest.approx(1795257602.544754)
    assert parse("a traceback") is None and parse("[LOUD] [1.0] [x]: y") is None
