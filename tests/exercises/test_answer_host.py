"""The test domain in the notebook's process: the student's class made anew, in a domain of the checker's."""

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

from course_kit.exercises.checker.assertions import ARRIVAL_TIMEOUT, expect_node
from course_kit.exercises.checker.examination import Examination
from course_kit.exercises.in_notebook.answer_host import AnswerHost
from course_kit.ros.observing.domain_observer import DomainObserver
from course_kit.ros.observing.received_messages import KEPT, ReceivedMessages
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
def observer(test_domain: int) -> Iterator[DomainObserver]:
    observer = DomainObserver(test_domain, only_here=True)
    yield observer
    observer.close()


def test_a_half_made_node_is_not_mixed_up_with_the_next_of_its_name(test_domain: int, observer: DomainObserver) -> None:
    with contextlib.closing(AnswerHost(test_domain)) as host:
        with pytest.raises(NameError, match="ten") as raised:  # and not what its destroy_node() raises
            host.start(HalfMade)
        host.start(Whole)
        del raised
        gc.collect()  # a half-made node that is still there goes now, and takes what is announced under its name along
        assert [end.node_name for end in wait_until(lambda: observer.publishers("/words"))] == ["sayer"]
        assert observer.their_nodes() == ["/sayer"]


def test_a_node_of_an_earlier_check_is_not_taken_for_the_answer_s(examination: Examination) -> None:
    with contextlib.closing(AnswerHost(examination.test_domain.domain)) as host:
        host.start(Whole)
        before = wait_until(examination.test_domain.their_nodes)
        with contextlib.closing(AnswerHost(examination.test_domain.domain)) as later:
            coming = threading.Timer(2 * ARRIVAL_TIMEOUT, later.start, [Other])
            coming.start()
            expect_node("/other", before)
            coming.join()
    assert [(found.ok, found.text) for found in examination.findings] == [(True, "its node is called `/other`")]


def test_two_checkers_never_share_a_stage(test_domain: int, tmp_path: Path) -> None:
    other = subprocess.run(
        [sys.executable, "-c", "from course_kit.exercises.domains import reserve_domain; print(reserve_domain())"],
        env={**os.environ, "TMPDIR": str(tmp_path)},  # as of a user with a folder for temporary files of their own
        capture_output=True,
        text=True,
        timeout=60,
    )
    assert int(other.stdout) != test_domain


def test_what_was_heard_is_counted_also_when_it_is_no_longer_kept() -> None:
    heard = ReceivedMessages(String)
    for number in range(KEPT + 5):
        heard.receive(b"", {"received_timestamp": number, "publication_sequence_number": number})
    assert heard.received == KEPT + 5
    assert len(heard) <= KEPT
