"""What checks say about nodes that the student runs, in the student's own domain."""

from __future__ import annotations

from typing import Any

from course_kit.examining.examination import current
from course_kit.examining.vocabulary import expect, nearest, wait

ARRIVAL = 0.3  # seconds that a message may take which was sent just before the check
LOG_ARRIVAL = 1.5  # the same for a log line: the publisher of a node just started must be found first


def expect_running_node(name: str, node_class: str, points: int = 0) -> None:
    """The student has a node of this full name running."""
    station = current().student
    wait(lambda: name in station.their_nodes(), 1.0)
    names = station.their_nodes()
    running = f"Running: {', '.join(names)}. " if names else "No node runs. "
    hint = f"{nearest(name, names)}{running}Start it with `run({node_class}…)`; `%ros2 node list` shows it."
    expect(f"the node `{name}` runs", name in names, hint, points, needed=True)


def heard_since_start(topic: str) -> list[Any]:
    """What came on a watched topic from the publishers that it has now."""
    heard, before = current().watched[topic], current().watched[topic].received
    publishers = {bytes(one.endpoint_gid) for one in current().student.publishers(topic)}
    if publishers:  # which may have been started just now
        wait(lambda: heard.received > before, ARRIVAL)
    return [message for _, message in heard.of(publishers)]


def logged_by(logger: str) -> list[Any]:
    """What a node logged since it was started, as far as the checker heard it."""
    student = current().student

    def lines() -> list[Any]:
        ends = [bytes(end.endpoint_gid) for end in student.publishers("/rosout") if end.node_name == logger]
        return student.node_log().said_by(ends, logger)

    wait(lines, LOG_ARRIVAL)
    return lines()
