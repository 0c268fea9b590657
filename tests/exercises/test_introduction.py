"""The checker's clients: a server has found them before anything is asked that it must not miss."""

from __future__ import annotations

import contextlib
from collections.abc import Iterator

import pytest
from rclpy.node import Node
from std_srvs.srv import SetBool, Trigger

from course_kit.checking import introduction
from course_kit.checking.examination import Examination
from course_kit.checking.introduction import introduce
from course_kit.checking.stage import Stage
from course_kit.checking.station import Station
from course_kit.checking.vocabulary_services import Client
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
    def __init__(self, parameters: bool) -> None:
        super().__init__("lamp", start_parameter_services=parameters)
        self.create_service(SetBool, "lamp", lambda _, response: response)


@pytest.fixture
def stage(examination: Examination) -> Iterator[Stage]:
    with contextlib.closing(Stage(examination.stage.domain)) as stage:
        yield stage


def served(station: Station, name: str) -> bool:
    return any(name in one.service_servers for one in station.offered())


def test_a_server_is_asked_until_it_answers(stage: Stage, examination: Examination) -> None:
    DropsTheFirst.requests = 0
    stage.start(DropsTheFirst, [], threads=False)
    introduce(examination.stage, "/known", Trigger)
    assert DropsTheFirst.requests == 2


def test_a_server_that_never_answers_is_given_up(examination: Examination, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(introduction, "MEET_TIMEOUT", 1.0)
    introduce(examination.stage, "/nobody", Trigger)


@pytest.mark.parametrize("parameters", [True, False])
def test_a_node_with_or_without_parameter_services_answers_the_first_request(
    stage: Stage, examination: Examination, parameters: bool
) -> None:
    stage.start(Lamp, [parameters], threads=False)
    wait_until(lambda: served(examination.stage, "/lamp"))
    assert Client("/lamp", SetBool).ask(data=True).response is not None
