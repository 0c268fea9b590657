"""Programs that a check starts: one that still loads on a busy machine is waited for, one that does nothing is not."""

from __future__ import annotations

import os
import sys
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest
from std_msgs.msg import String

from course_kit.base.programs.child_process import Process
from course_kit.exercises.catalogue import find
from course_kit.exercises.checker import workspace_assertions
from course_kit.exercises.checker.examination import Ended, Examination
from course_kit.exercises.checker.topic_assertions import expect_compatible_subscription, publisher
from course_kit.exercises.checker.workspace_assertions import expect_nodes
from course_kit.ros.subscriptions import topics

NODE = """
import rclpy
from rclpy.node import Node
rclpy.init()
rclpy.spin(Node("late"))
"""
LATE_SUBSCRIPTION = """
import rclpy, time
from rclpy.node import Node
from std_msgs.msg import String
rclpy.init()
node = Node("late")
time.sleep(3.0)
node.create_subscription(String, "chatter", print, 10)
rclpy.spin(node)
"""
LOADS = "import time\nwhile time.process_time() < 3.0: pass\n"
SLEEPS = "import time\ntime.sleep(20.0)\n"


@pytest.fixture
def started(
    examination: Examination, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> Iterator[Callable[[str], Process]]:
    monkeypatch.setattr(workspace_assertions, "START_TIMEOUT", 1.0)
    made: list[Process] = []

    def start(source: str) -> Process:
        environment = {**os.environ, "ROS_DOMAIN_ID": str(examination.test_domain.domain)}
        made.append(Process((sys.executable, "-c", source), "late", environment, tmp_path))
        made[-1].begin()
        return made[-1]

    yield start
    for process in made:
        process.stop(1.0)


def test_a_program_that_still_loads_is_waited_for(started: Callable[[str], Process]) -> None:
    assert expect_nodes(started(LOADS + NODE), "/late")


def test_a_program_that_does_nothing_is_given_up(started: Callable[[str], Process], examination: Examination) -> None:
    with pytest.raises(Ended):
        expect_nodes(started(SLEEPS + NODE), "/late")
    assert "There is no /late" in examination.findings[-1].hint


def test_a_program_whose_subscription_comes_after_its_node_is_waited_for(
    started: Callable[[str], Process], examination: Examination, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(topics, "MISMATCH_TIMEOUT", 1.0)
    examination.exercise = find("workspace-2")
    expect_nodes(started(LATE_SUBSCRIPTION), "/late")
    assert expect_compatible_subscription("/chatter", publisher("/chatter", String))
