"""Programs that a check starts: one that still loads on a busy machine is waited for, one that does nothing is not."""

from __future__ import annotations

import os
import sys
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest

from course_kit.examining import vocabulary_workspace
from course_kit.examining.examination import Ended, Examination
from course_kit.examining.vocabulary_workspace import expect_nodes
from course_kit.programs.child_process import Process

NODE = """
import rclpy
from rclpy.node import Node
rclpy.init()
rclpy.spin(Node("late"))
"""
LOADS = "import time\nwhile time.process_time() < 3.0: pass\n"
SLEEPS = "import time\ntime.sleep(20.0)\n"


@pytest.fixture
def started(
    examination: Examination, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> Iterator[Callable[[str], Process]]:
    monkeypatch.setattr(vocabulary_workspace, "START_TIMEOUT", 1.0)
    made: list[Process] = []

    def start(source: str) -> Process:
        environment = {**os.environ, "ROS_DOMAIN_ID": str(examination.stage.domain)}
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
