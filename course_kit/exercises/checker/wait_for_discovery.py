"""Waits until discovery is complete in both directions, so that no message, request or answer is lost.

A publisher drops what it sends before it has found a subscription, a server drops an answer if it has not found the
client yet; and whoever waits for it cannot see that it has not been found. What a process makes is announced in order,
so a node whose answer comes to a new client knows all that was made before it.
"""

from __future__ import annotations

from dataclasses import fields
from typing import Any

from rcl_interfaces.srv import GetParameterTypes

from course_kit.exercises.checker.examination import current
from course_kit.ros.observing.domain_observer import DomainObserver

MEET_TIMEOUT = 5.0
PERIOD = 0.5  # seconds from one request to the next while no answer comes
EVERY_NODES = "/get_parameter_types"


def meet(observer: DomainObserver, *names: str) -> None:
    """Wait until their nodes that have one of these topics, services or actions have found all the checker made."""
    for node in observer.offered():
        if any(has.keys() & names for has in (getattr(node, each.name) for each in fields(node))):
            for service in [each for each in node.service_servers if each.endswith(EVERY_NODES)]:
                introduce(observer, service, GetParameterTypes)


def introduce(observer: DomainObserver, service: str, service_type: Any) -> bool:
    """Ask a harmless service until it answers, or MEET_TIMEOUT is over; whether it answered."""
    client = observer.check_node.create_client(service_type, service)
    answers: list[Any] = []
    for _ in range(round(MEET_TIMEOUT / PERIOD)):
        client.call_async(service_type.Request()).add_done_callback(answers.append)
        if current().wait(lambda: answers, PERIOD, f"an answer of {service}"):
            return True
    return False
