"""The graph of real nodes in processes of their own: as data, as a picture, and live while they come and go."""

from __future__ import annotations

import base64
import re
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
import rclpy
from rclpy.node import Node
from std_msgs.msg import String

from course_kit.ros.graph.matching import explanations
from course_kit.ros.graph.plots import look, observer, plot_graph
from course_kit.ros.graph.snapshot import Channel, Endpoint, Qos, Snapshot
from course_kit.ros.spinning import context
from course_kit.ros.subscriptions import observer_node
from course_kit.views.live.graph import GraphView, show_graph
from tests.kernel import Kernel
from tests.waiting import wait_until

pytestmark = [
    pytest.mark.usefixtures("fresh_domain"),
    pytest.mark.by_turns("many nodes and programs"),
]

PROGRAM = Path(__file__).parent / "programs" / "graph_node.py"
STR, INT = "std_msgs/msg/String", "std_msgs/msg/Int32"


class Partner:
    """A node in a process of its own."""

    def __init__(self, name: str, namespace: str = "/") -> None:
        self.process = subprocess.Popen(
            [sys.executable, str(PROGRAM), name, namespace], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True
        )

    def wait(self) -> None:
        assert self.process.stdout is not None
        lines = iter(self.process.stdout.readline, "")  # Fast DDS writes its errors there, too
        assert any(line == "done\n" for line in lines)

    def do(self, line: str) -> None:
        """Have it run a line of Python in the thread that spins its node."""
        assert self.process.stdin is not None
        self.process.stdin.write(f"{line}\n")
        self.process.stdin.flush()
        self.wait()

    def __enter__(self) -> Partner:
        self.wait()
        return self

    def __exit__(self, *_: object) -> None:
        try:
            self.process.communicate(timeout=15)  # closes its input, which ends it
        except subprocess.TimeoutExpired:
            self.process.kill()
            self.process.communicate()


@pytest.fixture
def here() -> Iterator[Node]:
    """A node in this process; nothing is left of earlier tests."""
    context.start()
    wait_until(lambda: not seen().nodes, timeout=40)
    node = Node("here")
    yield node
    node.destroy_node()


def seen(**wanted: Any) -> Snapshot:
    return look(observer_node.node(), **wanted)


def topic(shown: Snapshot, name: str) -> Channel:
    return next((c for c in shown.channels if c.name == name), Channel("topic", name))


def until_ends(name: str, count: int, **wanted: Any) -> Channel:
    wait_until(lambda: len(topic(seen(**wanted), name).ends) == count, f"{count} ends of {name}")
    return topic(seen(**wanted), name)


def words(**wanted: Any) -> list[str]:
    return [text.get_text() for text in plot_graph(**wanted).axes[0].texts]


def test_both_sides_of_topics_in_two_processes_with_types_and_qos(here: Node) -> None:
    here.create_publisher(String, "/chatter", 10)
    with Partner("there", "/robot") as there:
        there.do("node.create_subscription(String, '/chatter', print, best_effort)")
        there.do("node.create_publisher(Int32, 'number', latched)")
        assert until_ends("/chatter", 2) == Channel(
            "topic", "/chatter", (Endpoint("/here", STR),), (Endpoint("/robot/there", STR, Qos("best_effort")),)
        )
        latched = Endpoint("/robot/there", INT, Qos(durability="transient_local"))
        assert until_ends("/robot/number", 1).sources == (latched,)
        shown = seen()
        assert [(n.name, n.namespace, n.count) for n in shown.nodes] == [
            ("/here", "/", 1),
            ("/robot/there", "/robot", 1),
        ]
        assert [c.name for c in shown.topics] == ["/chatter", "/robot/number"]
        drawn = words()
        assert {"2 nodes, 2 topics", "/here", "/robot", "there", "number", "offers reliable"} <= set(drawn)
        assert {"asks for best effort", "reliable, transient local", STR, INT} <= set(drawn)


def test_ends_that_cannot_match_are_drawn_apart_with_the_reason(here: Node) -> None:
    here.create_subscription(String, "/numbers", print, 10)
    here.create_subscription(String, "/scan", print, 10)
    with Partner("there") as there:
        there.do("node.create_publisher(Int32, '/numbers', 10)")
        there.do("node.create_publisher(String, '/scan', best_effort)")
        numbers, scan = until_ends("/numbers", 2), until_ends("/scan", 2)
        assert explanations(numbers) == [f"{INT} and {STR} on one topic: nothing arrives"]
        assert explanations(scan) == ["reliable subscription, best-effort publisher: nothing arrives"]
        drawn = words()
        assert drawn[0] == "2 nodes, 2 topics  ·  2 with ends that do not match"
        assert drawn.count("/numbers") == drawn.count("/scan") == 2 and "does not match" in drawn


def test_actions_are_there_services_and_hidden_things_on_request(here: Node) -> None:
    with Partner("there") as there:
        there.do("node.create_service(Trigger, '/reset', print)")
        there.do("server = ActionServer(node, RotateAbsolute, '/turn', print)")
        there.do("client = node.create_client(Trigger, '/reset')")
        rotate = Endpoint("/there", "turtlesim/action/RotateAbsolute")
        wait_until(lambda: topic(seen(services=True), "/reset").sources and seen().actions)
        assert seen().actions == [Channel("action", "/turn", (), (rotate,))] and not seen().services
        (reset,) = seen(services=True).services
        assert reset.sources == reset.sinks == (Endpoint("/there", "std_srvs/srv/Trigger"),)
        assert not seen(actions=False).channels
        hidden = seen(services=True, hidden=True)
        assert {"/there/get_parameters", "/turn/_action/send_goal"} <= {c.name for c in hidden.services}
        assert {"/rosout", "/parameter_events", "/turn/_action/status"} <= {c.name for c in hidden.topics}
        assert observer_node.node().get_fully_qualified_name() in {n.name for n in hidden.nodes}
        assert {"1 action", "/turn", "/reset", "no client"} <= set(
            ", ".join(words(services=True)).replace("2 nodes, ", "").split(", ")
        )


def test_parameters_are_those_of_every_node_that_answers(here: Node) -> None:
    here.declare_parameter("silent", 1)  # this node is not spun, so it does not answer
    with Partner("there") as there:
        there.do("node.declare_parameters('', [('gain', 2.5), ('names', ['a', 'b']), ('unset', '')])")
        silent, spoken = look(observer(), parameters=True).nodes
        assert silent.parameters is None and spoken.parameters is not None
        assert [(p.name, p.type, p.value) for p in spoken.parameters] == [
            ("gain", "double", "2.5"),
            ("names", "string array", "['a', 'b']"),
            ("unset", "string", ""),
        ]
        everything = next(n for n in seen(parameters=True, hidden=True).nodes if n.name == "/there")
        assert {"use_sim_time", "gain"} <= {p.name for p in everything.parameters or ()}
        view = show_graph("/there", parameters=True)
        there.do("node.set_parameters([rclpy.parameter.Parameter('gain', value=3.5)])")
        wait_until(lambda: "3.5" in str(view.seen))
        view.close()
        assert "gain: 3.5  double" in words(node="/there", parameters=True)


def test_one_node_or_namespace_and_one_line_for_what_is_not_there(here: Node) -> None:
    here.create_publisher(String, "/chatter", 10)
    until_ends("/chatter", 1)
    for node in (here, "here", "/here"):
        assert "/chatter" in words(node=node)
    for wrong, message in (
        ({"node": "ther"}, "there is no node /ther; the nodes are: /here"),
        ({"namespace": "robot"}, "there is no node in the namespace /robot; the nodes are: /here"),
    ):
        with pytest.raises(ValueError, match=f"^{re.escape(message)}$"):
            plot_graph(**wrong)  # type: ignore[arg-type]
    with pytest.raises(TypeError, match="node is a node or its name, not int"):
        plot_graph(3)
    with pytest.raises(TypeError, match="namespace must be a namespace, or None, not 3"):
        plot_graph(namespace=3)  # type: ignore[arg-type]


def test_the_first_picture_of_a_process_misses_nothing(here: Node) -> None:
    with Partner("one") as one, Partner("two", "/robot") as two:
        one.do("node.create_publisher(String, '/chatter', 10)")
        two.do("node.create_subscription(String, '/chatter', print, 10)")
        program = "from course_kit import plot_graph\nprint(*(t.get_text() for t in plot_graph().axes[0].texts))"
        done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, timeout=60)
        assert done.stderr == "" and done.stdout.startswith("3 nodes, 1 topic /robot /here /one two /chatter ")


def test_two_nodes_of_one_name_are_counted(here: Node) -> None:
    with Partner("here"):
        wait_until(lambda: [n.count for n in seen().nodes] == [2])
        assert "2 nodes of this name" in words()


def shows(view: GraphView, *names: str) -> None:
    """Wait until exactly these nodes are in a view."""
    wait_until(lambda: view.seen is not None and {n.name for n in view.seen.nodes} == set(names))


def test_a_live_view_follows_nodes_that_come_change_and_end_and_draws_only_then(here: Node) -> None:
    view = show_graph()
    assert view.is_running and base64.b64decode(view.still()["image/png"]).startswith(b"\x89PNG")
    shows(view, "/here")
    with Partner("there") as there:
        shows(view, "/here", "/there")
        there.do("publisher = node.create_publisher(String, '/chatter', best_effort)")
        wait_until(lambda: topic(view.seen or Snapshot(), "/chatter").sources)
        here.create_subscription(String, "/chatter", print, 10)
        wait_until(lambda: len(topic(view.seen or Snapshot(), "/chatter").ends) == 2)
        there.do("node.destroy_publisher(publisher)")
        wait_until(lambda: len(topic(view.seen or Snapshot(), "/chatter").ends) == 1)
        drawn, looked = view.drawn, threading.Event()
        before = view.seen
        timer = observer_node.node().create_timer(1.5, looked.set)  # several looks at a graph that stays as it is
        assert looked.wait(10) and view.drawn == drawn and view.seen is before
        timer.cancel()
    shows(view, "/here")
    view.close()
    assert not view.is_running


def test_a_killed_node_disappears_when_its_lease_ends(here: Node) -> None:
    view = show_graph()
    with Partner("there") as there:
        shows(view, "/here", "/there")
        there.process.send_signal(signal.SIGKILL)
        wait_until(lambda: [n.name for n in seen().nodes] == ["/here"], timeout=40)
        shows(view, "/here")
    view.close()


def test_a_new_node_is_shown_within_half_a_second_or_so(here: Node) -> None:
    view = show_graph()
    shows(view, "/here")
    delays = []
    for n in range(5):
        start = time.monotonic()
        node = Node(f"new_{n}")
        shows(view, "/here", f"/new_{n}")
        delays.append(time.monotonic() - start)
        node.destroy_node()
        shows(view, "/here")
    view.close()
    assert min(delays) < 0.6, delays


def test_the_same_view_again_and_the_end_of_ros_end_a_view_and_its_picture_stays(here: Node) -> None:
    first = show_graph()
    second = show_graph()
    assert not first.is_running and second.is_running
    third = show_graph(services=True)
    rclpy.shutdown()
    wait_until(lambda: not third.is_running)
    assert not rclpy.ok() and "image/png" in third.still() and "/here" in third.still()["text/plain"]
    context.start()
    fourth = show_graph()
    started = time.monotonic()
    context.stop()
    assert not fourth.is_running and time.monotonic() - started < 4
    assert not [t for t in threading.enumerate() if t.name == "live graph"]


def test_a_view_of_a_node_that_has_gone_says_so_and_waits_for_it(here: Node) -> None:
    robot = Node("robot")
    wait_until(lambda: len(seen().nodes) == 2)
    view = show_graph("robot")
    robot.destroy_node()
    wait_until(lambda: view.still()["text/plain"].startswith("there is no node /robot; the nodes are: /here."))
    assert "image/png" not in view.still()
    robot = Node("robot")
    wait_until(lambda: "image/png" in view.still())
    robot.destroy_node()
    view.close()


def test_in_a_kernel_a_cell_shows_the_picture_and_the_live_view_ends_with_the_kernel() -> None:
    kernel = Kernel()
    try:
        kernel.run("from course_kit import plot_graph, show_graph")
        kinds = [k for m in kernel.of(kernel.run("plot_graph()")) for k in m["content"].get("data", {})]
        assert "image/png" in kinds
        shown = kernel.run("view = show_graph()\nview")
        (data,) = [m["content"]["data"] for m in kernel.of(shown) if m["content"].get("data")]
        assert "image/png" in data and data["text/plain"].startswith("No node runs")
        assert kernel.text(kernel.run("print(view.is_running)")) == "True\n"
        kernel.client.shutdown()
        wait_until(lambda: not kernel.manager.is_alive())
    finally:
        kernel.close()
