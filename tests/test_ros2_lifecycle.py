"""`ros2 lifecycle`: the states of nodes in another process, seen and changed."""

from __future__ import annotations

from collections.abc import Iterator

import pytest

from tests.domains import own_domain
from tests.ros2_command import program, ros2
from tests.test_ros2_completion import completions

pytestmark = pytest.mark.by_turns("many nodes and programs")

NODES = "tests.ros2_lifecycle_nodes"
CONFIGURE = "- configure [1]\n\tStart: unconfigured\n\tGoal: configuring\n"
SHUTDOWN = "- shutdown [5]\n\tStart: unconfigured\n\tGoal: shuttingdown\n"


@pytest.fixture(scope="module", autouse=True)
def nodes() -> Iterator[None]:
    """Lifecycle nodes that these tests share, each of which only one of them changes."""
    with own_domain(), program(NODES, "lamp", "door", "_hidden", "stubborn", "plain"):
        yield


@pytest.mark.parametrize(
    ("words", "out"),
    [
        (("nodes",), "/door\n/lamp\n/stubborn\n"),
        (("nodes", "-a"), "/_hidden\n/door\n/lamp\n/stubborn\n"),
        (("nodes", "--count-nodes"), "3\n"),
        (("nodes", "-c", "--all"), "4\n"),
        (("get", "lamp"), "unconfigured [1]\n"),
        (("get", "/lamp", "--no-daemon", "--spin-time", "5"), "unconfigured [1]\n"),
        (("get", "/_hidden", "--include-hidden-nodes"), "unconfigured [1]\n"),
        (("list", "lamp"), CONFIGURE + SHUTDOWN),
        (("list", "--include-hidden-nodes", "/_hidden"), CONFIGURE + SHUTDOWN),
    ],
)
def test_what_there_is_is_shown(words, out):
    shown = ros2("lifecycle", *words)
    assert (shown.out, shown.err, shown.status) == (out, "", 0)


def test_without_a_name_get_goes_through_all_nodes():
    assert ros2("lifecycle", "get").out.splitlines()[1:] == ["/lamp: unconfigured [1]", "/stubborn: unconfigured [1]"]
    with_hidden = ros2("lifecycle", "get", "--include-hidden-nodes").out.splitlines()
    assert (len(with_hidden), with_hidden[0]) == (4, "/_hidden: unconfigured [1]")


def test_the_whole_graph_of_transitions_is_shown_whatever_the_state():
    lines = ros2("lifecycle", "list", "-a", "lamp").out.splitlines()
    heads = [line for line in lines if line.startswith("- ")]
    assert len(lines) == 3 * len(heads) == 3 * 25
    assert heads[:3] == ["- configure [1]", "- transition_success [10]", "- transition_failure [11]"]
    assert lines[-3:] == ["- transition_error [62]", "\tStart: errorprocessing", "\tGoal: finalized"]


def test_a_node_goes_through_its_life():
    for transition, state in (
        ("configure", "inactive [2]"),
        ("3", "active [3]"),
        ("deactivate", "inactive [2]"),
        ("cleanup", "unconfigured [1]"),
        ("shutdown", "finalized [4]"),
    ):
        changed = ros2("lifecycle", "set", "door", transition)
        assert (changed.out, changed.err, changed.status) == ("Transitioning successful\n", "", 0)
        assert ros2("lifecycle", "get", "/door").out == f"{state}\n"
    assert ros2("lifecycle", "list", "/door").out == ""


def test_a_transition_that_the_node_refuses_has_failed():
    refused = ros2("lifecycle", "set", "/stubborn", "configure")
    assert (refused.out, refused.err, refused.status) == ("", "Transitioning failed\n", 0)
    assert ros2("lifecycle", "get", "stubborn").out == "unconfigured [1]\n"


@pytest.mark.parametrize("transition", ["fly", "activate", "3", "0", ""])
def test_a_transition_that_there_is_not_is_answered_with_those_that_there_are(transition):
    unknown = ros2("lifecycle", "set", "/lamp", transition)
    lines = ["Unknown transition requested, available ones are:", "- configure [1]", "- shutdown [5]"]
    assert (unknown.out, unknown.err.splitlines(), unknown.status) == ("", lines, 1)


@pytest.mark.parametrize("words", [("get", "NODE"), ("list", "NODE"), ("list", "-a", "NODE"), ("set", "NODE", "1")])
@pytest.mark.parametrize("node", ["/lamps", "_hidden", ""])
def test_a_node_that_is_not_there_or_hidden_is_not_found(words, node):
    unknown = ros2("lifecycle", *(node if word == "NODE" else word for word in words))
    assert (unknown.out, unknown.err, unknown.status) == ("", "Node not found\n", 1)


def test_of_a_plain_node_it_is_said_that_it_has_no_lifecycle():
    plain = ros2("lifecycle", "get", "plain")
    assert (plain.err, plain.status) == ("Node not found\n/plain is a node without a lifecycle\n", 1)


def test_a_node_that_nobody_spins_does_not_hide_the_others():
    silent = "Exception while calling service of node '/asleep': no answer within 1 s"
    with own_domain(), program(NODES, "asleep", "lamp"):
        alone = ros2("lifecycle", "get", "asleep", "--timeout", "1")
        both = ros2("lifecycle", "get", "--timeout", "1")
        others = [
            ros2("lifecycle", *words, "--timeout", "1") for words in (("list", "/asleep"), ("set", "/asleep", "1"))
        ]
    assert (alone.out, alone.err[: len(silent)], alone.status) == ("", silent, 1)
    assert (both.out, both.err[: len(silent)], both.status) == ("/lamp: unconfigured [1]\n", silent, 0)
    assert [(one.err[: len(silent)], one.status) for one in others] == [(silent, 1)] * 2


def test_a_node_that_ends_in_the_midst_is_not_waited_for():
    with own_domain(), program(NODES, "mortal"):
        lost = ros2("lifecycle", "set", "/mortal", "configure")
    assert lost.err == "Exception while calling service of node '/mortal': it ended before it answered\n"
    assert (lost.out, lost.status) == ("", 1)


@pytest.mark.parametrize(
    ("line", "expected"),
    [
        ("ros2 lifecycle get /", ["/lamp", "/stubborn"]),
        ("ros2 lifecycle list --include-hidden-nodes /_", ["/_hidden"]),
        ("ros2 lifecycle set /lamp ", ["configure", "shutdown"]),
    ],
)
def test_tab_offers_lifecycle_nodes_and_what_they_can_do_now(line, expected, tmp_path):
    assert [word for word in completions(line, tmp_path) if word != "/door" and not word.startswith("-")] == expected
