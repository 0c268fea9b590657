"""`ros2 service info -v`: who offers a service, and who uses it."""

from __future__ import annotations

import re
from collections.abc import Iterator

import pytest
from rclpy.node import Node
from rclpy.qos import QoSProfile, ReliabilityPolicy
from std_srvs.srv import SetBool

from course_kit.lab.background.running import running
from course_kit.lab.bags.types import type_hash
from tests.ros2_command import program, ros2

KIND = "std_srvs/srv/SetBool"
QOS = """      Reliability: {}
      History (Depth): UNKNOWN (0)
      Durability: VOLATILE
      Lifespan: Infinite
      Deadline: Infinite
      Liveliness: AUTOMATIC
      Liveliness lease duration: Infinite"""
END = """Node name: {name}
Node namespace: {namespace}
Service type: {kind}
Service type hash: {hash}
Endpoint type: {end}
Endpoint count: 2
GIDs:
 - Request {first} : GID
 - Response {second} : GID
QoS profiles:
 - Request {first} :
{qos}
 - Response {second} :
{qos}"""


class Lamp(Node):
    """A client of the world's service that takes what comes, and two of the usual kind, in one node."""

    def __init__(self) -> None:
        super().__init__("lamp", namespace="/hall")
        hasty = QoSProfile(depth=10, reliability=ReliabilityPolicy.BEST_EFFORT)
        profiles = (hasty, QoSProfile(depth=10), QoSProfile(depth=10))
        self.clients_of_it = [self.create_client(SetBool, "/robot1/enable", qos_profile=qos) for qos in profiles]


@pytest.fixture(scope="module", autouse=True)
def world(fresh_domain: None) -> Iterator[None]:
    with program("tests.ros2_transcripts.world"), running(Lamp):
        yield


def end(name: str, namespace: str, kind: str, reliability: str = "RELIABLE") -> str:
    first, second = ("Writer", "Reader") if kind == "CLIENT" else ("Reader", "Writer")
    words = {"name": name, "namespace": namespace, "end": kind, "first": first, "second": second}
    return END.format(**words, kind=KIND, hash=type_hash(KIND), qos=QOS.format(reliability))


def test_each_end_is_described():
    told = ros2("service", "info", "/robot1/enable", "--verbose")
    gids = re.findall(r"(?:[0-9a-f]{2}\.){15}[0-9a-f]{2}", told.out)
    blocks = re.sub(r"(?:[0-9a-f]{2}\.){15}[0-9a-f]{2}", "GID", told.out).split("\n\n")
    clients = [end("lamp", "/hall", "CLIENT", reliability) for reliability in ("BEST_EFFORT", "RELIABLE", "RELIABLE")]
    servers = [end("lidar", "/robot1", "SERVER")]
    assert blocks[0] == f"Type: {KIND}\nClients count: 3"
    assert sorted(blocks[1:4]) == sorted(clients)
    assert blocks[4:] == ["Services count: 1", *servers, ""]
    assert (len(set(gids)), told.err, told.status) == (8, "", 0)


def test_without_the_option_they_are_counted():
    told = ros2("service", "info", "/robot1/enable")
    assert (told.out, told.status) == (f"Type: {KIND}\nClients count: 3\nServices count: 1\n", 0)


def test_nobody_offers_what_is_not_there():
    told = ros2("service", "info", "/robot1/enabled", "-v")
    assert (told.out, told.status) == ("", 1)
    assert told.err.startswith("Unknown service '/robot1/enabled'\n")
