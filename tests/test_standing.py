"""The report of a failure: how the process stands in the graph."""

from __future__ import annotations

import pytest

from course_kit.base.shutdown.shared_memory import FOLDER
from course_kit.ros.subscriptions import observer_node
from tests.standing import port_of, standing

PORT = "7f0e8c000000-7f0e8c100000 rw-s 00000000 00:19 52"


@pytest.mark.parametrize(
    ("path", "said"),
    [
        ("fastrtps_port7411", "fastrtps_port7411 52"),
        ("fastrtps_port7411 (deleted)", "fastrtps_port7411 52, removed"),
    ],
)
def test_a_port_that_nobody_finds_any_more_is_told(path: str, said: str) -> None:
    assert port_of(f"{PORT}                 {FOLDER}/of_no_process/{path}") == said


def test_the_ports_and_the_known_nodes_are_told() -> None:
    node = observer_node.node()
    *ports, nodes = standing().splitlines()
    assert ports
    assert all((FOLDER / port.split()[0]).exists() for port in ports)
    assert nodes.startswith(f"Nodes known in domain {node.context.get_domain_id()}: [")
    assert repr(node.get_name()) in nodes
