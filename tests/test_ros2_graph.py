"""Lists of the graph are whole: against 20 nodes in 5 processes, and when nodes come, end or are killed."""

from __future__ import annotations

import os
import signal
from collections.abc import Iterator
from contextlib import ExitStack

import pytest
from rclpy.serialization import serialize_message
from rmw_dds_common.msg import Gid, NodeEntitiesInfo, ParticipantEntitiesInfo

from course_kit.ros.private_api.fastdds_parts import entities, participants_listening
from tests.benchmark.child import Program
from tests.domains import own_domain
from tests.ros2_command import ros2
from tests.waiting import wait_until

pytestmark = pytest.mark.by_turns("many nodes and programs")

PROCESSES, NODES = 5, 4
NAMES = [f"/robot_{process}_{node}" for process in range(PROCESSES) for node in range(NODES)]
PARAMETER_SERVICES = (
    "describe_parameters",
    "get_parameter_types",
    "get_parameters",
    "get_type_description",
    "list_parameters",
    "set_parameters",
    "set_parameters_atomically",
)
RUNS = 5


@pytest.fixture(scope="module", autouse=True)
def domain() -> Iterator[int]:
    """A domain of its own, with twenty nodes in five processes."""
    with own_domain() as domain, ExitStack() as stack:
        programs = [
            stack.enter_context(Program("full_graph", process, NODES, len(NAMES), domain=domain))
            for process in range(PROCESSES)
        ]
        for program in programs:
            program.report()
        yield domain


@pytest.mark.parametrize("run", range(RUNS))
@pytest.mark.parametrize(
    ("words", "expected"),
    [
        (("node", "list"), NAMES),
        (("topic", "list"), ["/parameter_events", *(f"{name}/state" for name in NAMES), "/rosout"]),
        (("action", "list"), [f"{name}/count" for name in NAMES]),
        (("service", "list"), sorted(f"{n}/{s}" for n in NAMES for s in (*PARAMETER_SERVICES, "reset"))),
    ],
    ids=lambda value: value[0] if isinstance(value, tuple) else "",
)
def test_a_list_is_whole(words, expected, run):
    found = ros2(*words)
    assert found.out.splitlines() == expected, f"after {found.seconds:.1f} s {found.late}"


@pytest.mark.parametrize("run", range(RUNS))
def test_the_information_about_a_node_is_whole(run):
    out = ros2("node", "info", NAMES[-1]).out
    assert f"    {NAMES[-1]}/state: std_msgs/msg/String\n" in out
    assert f"    {NAMES[-1]}/reset: std_srvs/srv/Trigger\n" in out
    assert f"    {NAMES[-1]}/count: example_interfaces/action/Fibonacci\n" in out
    assert sum(f"{service}: " in out for service in PARAMETER_SERVICES) == len(PARAMETER_SERVICES)


def test_every_endpoint_of_a_topic_that_all_nodes_share_is_counted():
    assert f"Publisher count: {len(NAMES) + 1}\n" in ros2("topic", "info", "/rosout").out  # and the command's own


def test_a_node_that_came_or_ended_is_in_the_next_list_or_gone(domain):
    for _ in range(3):
        with Program("idle_node", domain=domain) as program:
            program.report()
            assert ros2("node", "list").out.splitlines() == ["/idle", *NAMES]
        assert ros2("node", "list").out.splitlines() == NAMES


def test_a_killed_node_is_gone_from_the_next_list(domain):
    with Program("idle_node", domain=domain) as program:
        program.report()
        os.kill(program.pid, signal.SIGKILL)
        wait_until(lambda: not os.path.exists(f"/proc/{program.pid}/fd/0"))
        assert ros2("node", "list").out.splitlines() == NAMES


FIRST = 7400 + 250 * 3  # of the ports of domain 3


def udp_table(*ports: int) -> str:
    """What /proc/net/udp tells of sockets that listen on these ports."""
    row = "  0: 00000000:{0:04X} 00000000:0000 07 00000000:00000000 00:00000000 00000000  0  0 {0} 2 0 0"
    return "\n".join(["header", *(row.format(port) for port in ports)])


def test_participants_are_counted_by_their_pairs_of_ports():
    ports = (10, 11, 14, 15, 16, 260, 261)
    assert participants_listening(3, lambda: udp_table(*(FIRST + port for port in ports))) == {
        FIRST + 10: str(FIRST + 10),
        FIRST + 14: str(FIRST + 14),
    }


def test_a_socket_that_closes_while_the_kernel_tells_hides_no_participant():
    whole = udp_table(FIRST + 10, FIRST + 11)
    tables = [udp_table(5353, FIRST + 10), whole, whole]
    assert participants_listening(3, iter(tables).__next__) == {FIRST + 10: str(FIRST + 10)}


def test_the_endpoints_that_a_participant_announces_are_read_from_its_message():
    def gid(number: int) -> Gid:
        return Gid(data=[number] * 16)

    nodes = [
        NodeEntitiesInfo(node_namespace="/", node_name="a", reader_gid_seq=[gid(1)], writer_gid_seq=[gid(2), gid(3)]),
        NodeEntitiesInfo(node_namespace="/robot", node_name="lidar", writer_gid_seq=[gid(4)]),
    ]
    message = ParticipantEntitiesInfo(gid=gid(9), node_entities_info_seq=nodes)
    announced = entities(serialize_message(message))
    assert announced.participant == bytes([9] * 12)
    assert announced.nodes == (("a", "/"), ("lidar", "/robot"))
    assert announced.endpoints == {bytes([number] * 16) for number in (1, 2, 3, 4)}
