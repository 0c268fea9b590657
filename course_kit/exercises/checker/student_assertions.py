"""Assertions about nodes that the student runs, in the student's own domain."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from course_kit.exercises.checker.assertions import expect, nearest, require, wait
from course_kit.exercises.checker.drives import Arrivals, Commands
from course_kit.exercises.checker.examination import current
from course_kit.ros.graph import graph
from course_kit.ros.observing.node_log import Line
from course_kit.ros.subscriptions import topics

ARRIVAL = 0.3  # seconds that a message may take which was sent just before the check
GRAPH_ARRIVAL = 1.5  # the same for what a node has in the graph
TURTLES_TOPICS = {"publishers": ("pose", "color_sensor"), "subscribers": ("cmd_vel",)}
TURTLES_SERVICES = ("set_pen", "teleport_absolute", "teleport_relative")


def expect_running_node(name: str, node_class: str, points: int = 0) -> None:
    """The student has a node of this full name running."""
    observer = current().student
    wait(lambda: name in observer.their_nodes(), 1.0)
    names = observer.their_nodes()
    running = f"Running: {', '.join(names)}. " if names else "No node runs. "
    hint = f"{nearest(name, names)}{running}Start it with `run({node_class}…)`; `%ros2 node list` shows it."
    expect(f"the node `{name}` runs", name in names, hint, points, needed=True)
    if not wait(lambda: observer.their_nodes().count(name) == 1, GRAPH_ARRIVAL):
        hint = (
            f"Several nodes of this domain are called {name}, and others take them for one: call stop() in the other "
            f"notebooks, or end the other program, then run this one again."
        )
        require(f"there is one `{name}`", False, hint)


def expect_simulator(name: str) -> None:
    """The node of this name is a turtlesim: it has all that one has for its turtle1, and is the only one."""
    observer, turtle = current().student, f"{name.removesuffix('turtlesim')}turtle1"

    def lacking() -> list[str]:
        has = graph.interfaces_of(observer.node, lambda end: topics.node_name(end) == name)
        ends = {side: [f"{turtle}/{one}" for one in ones] for side, ones in TURTLES_TOPICS.items()}
        ends["service_servers"] = [f"{turtle}/{one}" for one in TURTLES_SERVICES]
        ends["action_servers"] = [f"{turtle}/rotate_absolute"]
        return [one for side, ones in ends.items() for one in ones if one not in getattr(has, side)]

    wait(lambda: not lacking(), GRAPH_ARRIVAL)
    lacks = lacking()
    hint = f"It has no {', '.join(lacks)}. Start one with `run(TurtleSim)`; was its turtle killed?"
    require(f"`{name}` is a simulator with its turtle", not lacks, hint)
    wait(lambda: len(_publishers_of(name, f"{turtle}/pose")) == 1, GRAPH_ARRIVAL)
    count = len(_publishers_of(name, f"{turtle}/pose"))
    hint = (
        f"{count} of that name publish {turtle}/pose. Stop all of them, also those of other notebooks, and begin anew."
    )
    require(f"there is one `{name}`", count == 1, hint)


def heard_since_start(node: str, topic: str) -> Arrivals:
    """What a node has published on a watched topic since it was started, and when it came."""
    heard, before = current().watched[topic], current().watched[topic].received
    publishers = _publishers_of(node, topic)
    if publishers:  # which may have been started just now
        wait(lambda: heard.received > before, ARRIVAL)
    return heard.of(publishers)


def was_listed_before(node: str, topic: str) -> bool:
    """Return True if lists of topics may have had a watched topic before a node that publishes it was started.

    A panel of an earlier try may have subscribed to it, or still the checker.
    """
    return bool(_publishers_of(node, topic) & current().watched[topic].listed_before)


def commands_heard(topic: str) -> Commands:
    """What was said on a watched cmd_vel, by whomever."""
    heard = current().watched[topic]
    return Commands(heard.arrivals, heard.appeared.values())


def _publishers_of(node: str, topic: str) -> set[bytes]:
    ends = current().student.publishers(topic)
    return {bytes(end.endpoint_gid) for end in ends if topics.node_name(end) == node}


def logged_by(logger: str, until: Callable[[Any], bool], timeout: float) -> list[Any]:
    """What a node has logged since it was started, once there is a line that was waited for, or the time is over."""
    wait(lambda: any(until(line.message) for line in lines_of(logger)), timeout, f"a line of {logger}", 0.05)
    return [line.message for line in lines_of(logger)]


def lines_of(logger: str) -> list[Line]:
    """The lines of a node that runs, and when each came, as far as the checker heard them; of child loggers too."""
    student = current().student
    ends = [bytes(end.endpoint_gid) for end in student.publishers("/rosout") if end.node_name == logger]
    return student.node_log().lines_by(ends, logger)
