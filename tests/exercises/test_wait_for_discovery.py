"""The checker's clients: a server has found them before anything is asked that it must not miss."""

from __future__ import annotations

import contextlib
from collections.abc import Iterator
from typing import Any

import pytest
from rcl_interfaces.srv import GetParameterTypes
from rclpy.node import Node
from std_msgs.msg import String
from std_srvs.srv import SetBool, Trigger

from course_kit.exercises.checker import wait_for_discovery
from course_kit.exercises.checker.examination import Examination
from course_kit.exercises.checker.service_assertions import Client
from course_kit.exercises.checker.topic_assertions import hear_no_longer, heard_once_more, listen
from course_kit.exercises.checker.wait_for_discovery import introduce, meet
from course_kit.exercises.in_notebook.answer_host import AnswerHost
from course_kit.ros.observing.domain_observer import DomainObserver
from tests.waiting import wait_until


class DropsTheFirst(Node):
    """Its answer to the first request gets nowhere."""

    requests = 0

    def __init__(self) -> None:
        super().__init__("server")
        self.create_service(Trigger, "known", self.on_request)

    def on_request(self, _: Trigger.Request, response: Trigger.Response) -> Trigger.Response:
        DropsTheFirst.requests += 1
        if DropsTheFirst.requests == 1:
            raise RuntimeError("dropped")
        return response


class Lamp(Node):
    parameters = True

    def __init__(self) -> None:
        super().__init__("lamp", start_parameter_services=self.parameters)
        self.create_service(SetBool, "lamp", lambda _, response: response)


class WithoutParameters(Lamp):
    parameters = False


class CountsItsMeetings(Node):
    """It answers itself what every node is asked by those who want to be known to it."""

    meetings = 0

    def __init__(self) -> None:
        super().__init__("lamp", start_parameter_services=False)
        self.create_service(SetBool, "lamp", lambda _, response: response)
        self.create_publisher(String, "words", 10)
        self.create_service(GetParameterTypes, "lamp/get_parameter_types", self.on_meeting)

    def on_meeting(self, _: GetParameterTypes.Request, response: GetParameterTypes.Response) -> Any:
        CountsItsMeetings.meetings += 1
        return response


@pytest.fixture
def host(examination: Examination) -> Iterator[AnswerHost]:
    with contextlib.closing(AnswerHost(examination.test_domain.domain)) as host:
        yield host


def served(observer: DomainObserver, name: str) -> bool:
    return any(name in one.service_servers for one in observer.offered())


def test_a_server_is_asked_until_it_answers(host: AnswerHost, examination: Examination) -> None:
    DropsTheFirst.requests = 0
    host.start(DropsTheFirst)
    assert introduce(examination.test_domain, "/known", Trigger)
    assert DropsTheFirst.requests == 2


def test_a_server_that_never_answers_is_given_up(examination: Examination, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(wait_for_discovery, "MEET_TIMEOUT", 1.0)
    assert not introduce(examination.test_domain, "/nobody", Trigger)


@pytest.mark.parametrize("node_class", [Lamp, WithoutParameters])
def test_a_node_with_or_without_parameter_services_answers_the_first_request(
    host: AnswerHost, examination: Examination, node_class: type[Node]
) -> None:
    host.start(node_class)
    wait_until(lambda: served(examination.test_domain, "/lamp"))
    assert Client("/lamp", SetBool).ask(data=True).response is not None


def test_a_node_has_met_the_checker_before_it_is_asked_or_heard(host: AnswerHost, examination: Examination) -> None:
    CountsItsMeetings.meetings = 0
    host.start(CountsItsMeetings)
    wait_until(lambda: served(examination.test_domain, "/lamp/get_parameter_types"))
    meet(examination.test_domain, "/another")
    assert CountsItsMeetings.meetings == 0
    Client("/lamp", SetBool)
    before = CountsItsMeetings.meetings  # once, or more often where it was slow to answer
    assert before >= 1
    listen("/words", String)
    assert CountsItsMeetings.meetings > before


def test_a_subscription_is_gone_when_it_has_ended(examination: Examination) -> None:
    """A node that is made then would count it, and publish for it."""
    heard = listen("/words", String)
    with heard_once_more("/words", String):
        assert examination.test_domain.node.count_subscribers("/words") == 2
    assert examination.test_domain.node.count_subscribers("/words") == 1
    hear_no_longer(heard)
    assert examination.test_domain.node.count_subscribers("/words") == 0
