"""Names that are hidden or shared by two nodes, in `ros2 node` and `ros2 topic`: as the real command treats them."""

from __future__ import annotations

from collections.abc import Iterator

import pytest

from tests.domains import own_domain
from tests.ros2_command import program, ros2

TWINS = (
    'There are 2 nodes in the graph with the exact name "/twin". You are seeing information about only one of them.\n'
)
SHARED = (
    "WARNING: Be aware that there are nodes in the graph that share an exact name, "
    "which can have unintended side effects.\n"
)


@pytest.fixture(scope="module", autouse=True)
def nodes() -> Iterator[None]:
    with own_domain(), program("tests.ros2_simulation"):
        yield


def test_a_hidden_node_is_known_with_the_flag_alone():
    refused = ros2("node", "info", "/_backstage")
    assert (refused.out, refused.err, refused.status) == ("", "Unable to find node '/_backstage'\n", 1)
    told = ros2("node", "info", "/_backstage", "--include-hidden")
    assert told.status == 0
    assert told.out.startswith("/_backstage\n  Subscribers:\n")
    assert "    /rosout: rcl_interfaces/msg/Log\n" in told.out


def test_a_hidden_topic_has_a_type_with_the_flag_alone():
    refused = ros2("topic", "type", "/_secret")
    assert (refused.out, refused.err, refused.status) == ("", "", 1)
    told = ros2("topic", "--include-hidden-topics", "type", "/_secret")
    assert (told.out, told.status) == ("std_msgs/msg/String\n", 0)
    assert ros2("topic", "type", "/ticks").out == "std_msgs/msg/Int32\n"


def test_nodes_that_share_a_name_are_warned_of():
    told = ros2("node", "info", "/twin")
    assert (told.err, told.status) == (TWINS, 0)
    assert told.out.startswith("/twin\n")
    listed = ros2("node", "list")
    assert (listed.out, listed.err) == ("/simulation\n/twin\n/twin\n", SHARED)
    assert ros2("node", "list", "-c").out == "3\n"
    assert "/_backstage" in ros2("node", "list", "-a").out.splitlines()


@pytest.mark.parametrize("noun", ["topic", "service"])
def test_of_what_is_no_type_nothing_is_found(noun):
    found = ros2(noun, "find", "std_msgs/msg/Strin")
    assert (found.out, found.err, found.status) == ("", "", 0)
