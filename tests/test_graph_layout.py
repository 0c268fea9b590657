"""The drawn graph, from data alone: what matches, what stands where, that no line and no text covers another."""

from __future__ import annotations

import itertools
from collections.abc import Iterator

import pytest
from rclpy.duration import Duration
from rclpy.qos import (
    DurabilityPolicy,
    LivelinessPolicy,
    QoSCompatibility,
    QoSProfile,
    ReliabilityPolicy,
    qos_check_compatible,
)

from course_kit.base.figures import PAPER, contrast
from course_kit.ros.graph.cards import Card, cards
from course_kit.ros.graph.drawing import INKS, LOOKS, TROUBLE, WIRE, text_width
from course_kit.ros.graph.graph import qos_data
from course_kit.ros.graph.layers import Box, Line
from course_kit.ros.graph.layout import Layout, lay_out
from course_kit.ros.graph.matching import explanations, mismatch, parts, qos_reasons
from course_kit.ros.graph.plots import WIRES, draw_graph
from course_kit.ros.graph.snapshot import Channel, Endpoint, GraphNode, Parameter, Qos, Snapshot
from tests import graphs
from tests.graphs import BEST_EFFORT, LATCHED, TEXT, channel, snapshot

ALL = {
    "turtle": graphs.turtle(),
    "unmatched": graphs.unmatched(),
    "fleet": graphs.fleet(),
    "random 1": graphs.at_random(1),
    "random 2": graphs.at_random(2),
    "small random": graphs.at_random(3, 8, 8),
    "hub": snapshot([channel("/rosout", "rcl_interfaces/msg/Log", [f"/node_{n}" for n in range(60)], [])]),
    "idle": snapshot([], [f"/idle_{n}" for n in range(60)]),
    "itself": snapshot([channel("/loop", TEXT, ["/node"], ["/node"])]),
    "nothing": snapshot([]),
}
every_graph = pytest.mark.parametrize("shown", ALL.values(), ids=ALL)

# One profile for each combination of the policies that decide.
PROFILES = [
    QoSProfile(
        depth=1,
        reliability=reliability,
        durability=durability,
        liveliness=liveliness,
        deadline=Duration(seconds=deadline),
        liveliness_lease_duration=Duration(seconds=lease),
    )
    for reliability, durability, liveliness, deadline, lease in itertools.product(
        (ReliabilityPolicy.RELIABLE, ReliabilityPolicy.BEST_EFFORT),
        (DurabilityPolicy.VOLATILE, DurabilityPolicy.TRANSIENT_LOCAL),
        (LivelinessPolicy.AUTOMATIC, LivelinessPolicy.MANUAL_BY_TOPIC),
        (0, 1, 2),
        (0, 1, 2),
    )
]


def test_ends_match_exactly_where_rclpy_says_so() -> None:
    for offered, asked in itertools.product(PROFILES, PROFILES):
        expected = qos_check_compatible(offered, asked)[0] == QoSCompatibility.OK
        assert (not qos_reasons(qos_data(offered), qos_data(asked))) == expected, (offered, asked)


def test_a_reason_is_in_the_words_of_ros() -> None:
    assert mismatch(Endpoint("/a", TEXT, BEST_EFFORT), Endpoint("/b", TEXT)) == (
        "reliable subscription, best-effort publisher: nothing arrives"
    )
    assert mismatch(Endpoint("/a", TEXT, BEST_EFFORT), Endpoint("/b", "std_msgs/msg/Int32")) == (
        "std_msgs/msg/String and std_msgs/msg/Int32 on one topic: nothing arrives"
    )
    slow, quick = Endpoint("/a", TEXT, Qos(deadline=0.5)), Endpoint("/b", TEXT, Qos(deadline=0.1))
    assert mismatch(slow, quick) == (
        "subscription asks for a deadline of 0.1 s, publisher promises 0.5 s: nothing arrives"
    )
    assert mismatch(quick, slow) is None
    assert mismatch(Endpoint("/a", TEXT), Endpoint("/b", TEXT, LATCHED)) == (
        "transient-local subscription, volatile publisher: nothing arrives"
    )


def nodes_of(one: Channel) -> list[tuple[str, str]]:
    """The nodes of both sides of each part."""
    return [("".join(e.node[1:] for e in part.sources), "".join(e.node[1:] for e in part.sinks)) for part in parts(one)]


def test_a_topic_is_taken_apart_into_those_that_reach_each_other() -> None:
    assert nodes_of(channel("/t", TEXT, ["/a", "/b"], ["/x", "/y"])) == [("ab", "xy")]
    assert nodes_of(channel("/t", TEXT, ["/a", "/b"], ["/x", "/y"], BEST_EFFORT)) == [("ab", ""), ("", "xy")]
    assert nodes_of(channel("/t", TEXT, [], ["/x", "/y"])) == [("", "xy")]
    scan = next(c for c in graphs.unmatched().channels if c.name == "/scan")
    assert nodes_of(scan) == [("lidar", "viewer"), ("", "mapper")]


def test_where_some_reach_each_other_all_the_same_the_reason_names_the_pair() -> None:
    mixed = Channel(
        "topic",
        "/t",
        (Endpoint("/weak", TEXT, BEST_EFFORT), Endpoint("/strong", TEXT)),
        (Endpoint("/all", TEXT, BEST_EFFORT), Endpoint("/strict", TEXT)),
    )
    assert len(parts(mixed)) == 1
    expected = "/weak to /strict: reliable subscription, best-effort publisher: nothing arrives"
    assert explanations(mixed) == [expected]
    two = Channel("topic", "/t", (Endpoint("/a", TEXT), Endpoint("/b", "std_msgs/msg/Int32")))
    assert explanations(two) == ["std_msgs/msg/Int32 and std_msgs/msg/String on one topic"]


def test_around_a_node_or_namespace_stays_what_it_has_to_do_with() -> None:
    fleet = graphs.fleet()
    battery = fleet.around(node="/robot2/battery")
    assert [n.name for n in battery.nodes] == ["/fleet_manager", "/robot2/battery"]
    assert [c.name for c in battery.channels] == ["/robot2/battery"]
    second = fleet.around(namespace="/robot2")
    assert {c.name for c in second.channels if c.name.startswith("/robot")} == {
        c.name for c in fleet.channels if c.name.startswith("/robot2/")
    }
    assert "/robot2/health" in {n.name for n in second.nodes}
    with pytest.raises(ValueError, match=r"there is no node /turtle; the nodes are: /follower, .*/turtlesim$"):
        graphs.turtle().around(node="/turtle")
    with pytest.raises(ValueError, match=r"there is no node in the namespace /robot; "):
        fleet.around(namespace="/robot")


def laid_out(shown: Snapshot) -> tuple[list[Card], Layout]:
    made, wires, titles = cards(shown, text_width)
    return made, lay_out([card.box for card in made], [wire.line for wire in wires], titles)


def overlap(a: Box, b: Box) -> bool:
    return a.x < b.x + b.width and b.x < a.x + a.width and a.y < b.y + b.height and b.y < a.y + a.height


def curve(line: Line) -> Iterator[tuple[float, float]]:
    """Points along a line as it is drawn: straight along rows, an S across gaps."""
    for n, ((x0, y0), (x1, y1)) in enumerate(itertools.pairwise(line.points)):
        for step in range(41):
            t = step / 40
            bend = t * t * (3 - 2 * t) if n % 2 else t
            across = (1 - t) ** 3 * x0 + 3 * t * (1 - t) * (x0 + x1) / 2 + t**3 * x1
            yield (across if n % 2 else x0 + t * (x1 - x0), y0 + bend * (y1 - y0))


@every_graph
def test_no_box_covers_another_and_no_line_crosses_a_box(shown: Snapshot) -> None:
    _, layout = laid_out(shown)
    boxes = list(layout.boxes.values())
    assert not [(a.key, b.key) for a, b in itertools.combinations(boxes, 2) if overlap(a, b)]
    for line in layout.lines:
        crossed = {
            box.key
            for x, y in curve(line)
            for box in boxes
            if box.x + 0.001 < x < box.x + box.width - 0.001 and box.y < y < box.y + box.height
        }
        assert not crossed, (line.node, line.box)


@every_graph
def test_every_text_is_inside_its_box_and_below_the_one_before(shown: Snapshot) -> None:
    made, layout = laid_out(shown)
    for card in made:
        right = max(text.x + text_width(text.text, text.size, text.role == "name") for text in card.texts)
        assert right <= card.box.width and card.box.x + card.box.width <= layout.width + 0.001
        heights = sorted({round(text.y, 2): text for text in card.texts}.items())
        for (above, one), (below, other) in itertools.pairwise(heights):
            assert below - above >= (one.size + other.size) / 2 / 72 or below - above < 0.02, card.box.key
        assert card.box.y >= 0 and card.box.y + card.box.height <= layout.height + 0.001


@every_graph
def test_a_band_holds_its_namespace_and_nothing_else(shown: Snapshot) -> None:
    _, layout = laid_out(shown)
    assert {band.group for band in layout.bands} == {n.namespace for n in shown.nodes} - {"/"}
    for one, other in itertools.pairwise(layout.bands):
        assert one.y + one.height <= other.y
    for band, box in itertools.product(layout.bands, layout.boxes.values()):
        inside = band.y < box.y and box.y + box.height < band.y + band.height
        assert inside == (box.group == band.group), box.key


@every_graph
def test_the_same_graph_is_drawn_the_same(shown: Snapshot) -> None:
    shuffled = Snapshot(shown.nodes[::-1], shown.channels[::-1])
    places = [[(b.key, b.x, b.y) for b in sorted(laid_out(s)[1].boxes.values(), key=str)] for s in (shown, shuffled)]
    assert places[0] == places[1]


def test_a_chain_runs_from_left_to_right() -> None:
    chain = [channel(f"/to_{b}", TEXT, [f"/{a}"], [f"/{b}"]) for a, b in itertools.pairwise("dabc")]
    boxes = laid_out(snapshot(chain))[1].boxes
    order = ["node /d", "topic /to_a", "node /a", "topic /to_b", "node /b", "topic /to_c", "node /c"]
    assert sorted(boxes, key=lambda key: boxes[key].x) == order
    assert len({round(box.y + box.ports[0], 6) for box in boxes.values()}) == 1  # in one straight line


@pytest.mark.parametrize("name", ["turtle", "unmatched", "fleet", "small random"])
def test_the_picture_is_not_wider_than_a_notebook_can_show(name: str) -> None:
    width, height = draw_graph(ALL[name]).get_size_inches()
    assert width <= 16 and height <= 20


def words(shown: Snapshot) -> list[str]:
    return [text.get_text() for text in draw_graph(shown).axes[0].texts]


def test_what_does_not_match_is_drawn_apart_with_its_reason() -> None:
    drawn = words(graphs.unmatched())
    assert drawn[0] == "9 nodes, 6 topics, 1 service, 1 action  ·  3 with ends that do not match"
    assert drawn.count("/numbers") == drawn.count("/scan") == drawn.count("/map") == 2 and drawn.count("/chatter") == 1
    text = " ".join(" ".join(drawn).split())
    assert "✗ std_msgs/msg/Int32 and std_msgs/msg/String on one topic: nothing arrives" in text
    assert "✗ reliable subscription, best-effort publisher: nothing arrives" in text
    assert {"no publisher", "no subscription", "no server", "2 nodes of this name", "does not match"} <= set(drawn)
    assert "does not match" not in words(graphs.turtle())


def test_types_and_qos_are_in_the_boxes_and_parameters_in_those_of_nodes() -> None:
    mixed = snapshot([channel("/scan", graphs.SCAN, ["/lidar"], ["/viewer"], LATCHED, BEST_EFFORT)], ["/other"])
    assert {graphs.SCAN, "offers reliable, transient local", "asks for best effort"} <= set(words(mixed))
    node = GraphNode("/sim", 1, (Parameter("background_b", "integer", "255"), Parameter("name", "string", "x" * 90)))
    drawn = words(Snapshot((node,)))
    assert "background_b: 255  integer" in drawn and all(len(text) < 60 for text in drawn)


def test_names_in_a_namespace_are_short_and_long_ones_are_cut() -> None:
    drawn = words(graphs.fleet(2))
    assert {"/robot1", "/robot2", "cmd_vel", "/fleet/goal", "/map"} <= set(drawn) and "/robot1/cmd_vel" not in drawn
    long = "/" + "a" * 40 + "b" * 40
    assert f"/{'a' * 15}…{'b' * 17}" in words(snapshot([channel(long, TEXT, ["/n"], [])]))


def test_every_text_has_contrast_on_every_ground() -> None:
    for ground in (PAPER, *(face for face, _ in LOOKS.values())):
        assert all(contrast(ink, ground) > 4.5 for ink in INKS.values())


def test_every_edge_and_line_has_contrast_on_the_ground() -> None:
    edges = [edge for _, edge in LOOKS.values()]
    assert all(contrast(colour, PAPER) > 3.0 for colour in (*edges, WIRE, *WIRES, TROUBLE))


def test_an_empty_graph_says_so() -> None:
    assert "no node runs in this domain" in words(snapshot([]))


def test_lines_tell_what_is_best_effort_and_what_does_not_match() -> None:
    _, wires, _ = cards(ALL["fleet"], text_width)
    scans = [wire for wire in wires if wire.line.box == "topic /robot1/scan"]
    assert not any(wire.reliable for wire in scans) and all(wire.reliable for wire in wires if "plan" in wire.line.box)
    assert [wire.line.node for wire in wires if wire.is_broken] == [
        "node /robot5/planner",
        "node /robot3/lidar",
        "node /robot3/localisation",
        "node /robot3/obstacle_detector",
    ]
