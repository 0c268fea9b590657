"""The stage in the notebook's process: the student's class made anew, in a domain of the checker's."""

from __future__ import annotations

import contextlib
import gc
import os
import subprocess
import sys
import threading
from collections.abc import Iterator
from pathlib import Path

import pytest
from rclpy.node import Node
from std_msgs.msg import String

from course_kit.exercises.checker.examination import Examination
from course_kit.exercises.checker.vocabulary import ARRIVAL_TIMEOUT, expect_node
from course_kit.exercises.in_notebook.answer_host import AnswerHost
from course_kit.ros.observing.heard import KEPT, Heard
from course_kit.ros.observing.station import Station
from tests.waiting import wait_until


class Whole(Node):
    def __init__(self) -> None:
        super().__init__("sayer")
        self.words = self.create_publisher(String, "words", 10)


class Other(Node):
    def __init__(self) -> None:
        super().__init__("other")


class HalfMade(Whole):
    def __init__(self) -> None:
        super().__init__()
        raise NameError("ten")

    def destroy_node(self) -> None:
        raise AttributeError("what the constructor was to make")


@pytest.fixture
def station(stage_domain: int) -> Iterator[Station]:
    station = Station(stage_domain, only_here=True)
    yield station
    station.close()


def test_a_half_made_node_is_not_mixed_up_with_the_next_of_its_name(stage_domain: int, station: Station) -> None:
    with contextlib.closing(AnswerHost(stage_domain)) as host:
        with pytest.raises(NameError, match="ten") as raised:  # and not what its destroy_node() raises
            host.start(HalfMade)
        host.start(Whole)
        del raised
        gc.collect()  # a half-made node that is still there goes now, and takes what is announced under its name along
        assert [end.node_name for end in wait_until(lambda: station.publishers("/words"))] == ["sayer"]
        assert station.their_nodes() == ["/sayer"]


def test_a_node_of_an_earlier_check_is_not_taken_for_the_answer_s(examination: Examination) -> None:
    with contextlib.closing(AnswerHost(examination.stage.domain)) as host:
        host.start(Whole)
        before = wait_until(examination.stage.their_nodes)
        with contextlib.closing(AnswerHost(examination.stage.domain)) as later:
            coming = threading.Timer(2 * ARRIVAL_TIMEOUT, later.start, [Other])
            coming.start()
            expect_node("/other", before)
            coming.join()
    assert [(found.ok, found.text) for found in examination.findings] == [(True, "its node is called `/other`")]


def test_two_checkers_never_share_a_stage(stage_domain: int, tmp_path: Path) -> None:
    other = subprocess.run(
        [sys.executable, "-c", "from course_kit.exercises.domains import reserve_stage; print(reserve_stage())"],
        env={**os.environ, "TMPDIR": str(tmp_path)},  # as of a user with a folder for temporary files of their own
        capture_output=True,
        text=True,
        timeout=60,
    )
    assert int(other.stdout) != stage_domain


def test_what_was_heard_is_counted_also_when_it_is_no_longer_kept() -> None:
    heard = Heard(String)
    for number in range(KEPT + 5):
        heard.receive(b"", {"received_timestamp": number, "publication_sequence_number": number})
    assert heard.received == KEPT + 5
    assert len(heard) <= KEPT
