"""replay: a bag goes through a node, message by message, and what the node publishes is kept.

The node runs in a ROS context of its own that no other process hears, on the bag's clock (use_sim_time, /clock). The
next message is sent when all callbacks of the one before have returned, and timers fire when the bag's clock is at
their time. So nothing is lost, the order is always the same, and the result does not depend on the machine's speed:
the same bag gives the same output, as fast as the node computes. What a node takes from elsewhere, such as
time.time() or random numbers without a seed, is not under control; nor is a callback seen to be too slow for its
topic here: bags.play() keeps the time and shows that.
"""

from __future__ import annotations

import os
import time
from collections import Counter
from collections.abc import Iterable
from contextlib import closing
from pathlib import Path
from typing import Any

from rclpy.node import Node

from course_kit.base.arguments import PATH, SPAN, takes
from course_kit.base.long_tasks import long_task
from course_kit.lab import bags
from course_kit.lab.bags.files import OpenBag
from course_kit.lab.node_logs import rosout
from course_kit.lab.replays.lockstep import OF_EVERY_NODE, LockStep
from course_kit.lab.replays.replayed import Replayed
from course_kit.ros.spinning.executors import refuse_in_callback
from course_kit.ros.subscriptions import topics


@takes(bag=PATH, timeout=SPAN)
def replay(
    bag: str | os.PathLike[str],
    node: type[Node],
    *args: Any,
    outputs: Iterable[str] | None = None,
    timeout: float = 10.0,
    **kwargs: Any,
) -> Replayed:
    """Send the messages of a bag through a node and return what it published, at the bag's times.

    `node` is a class derived from Node, `args` and `kwargs` those of its constructor. It gets the topics to which it
    subscribes. `outputs` are the topics to keep: all that it publishes, unless given. Raises what a callback raises,
    ValueError if the bag has no topic for the node or an output is not published, TimeoutError for a callback that
    does not return within `timeout` seconds.
    """
    refuse_in_callback("replay()")
    if not (isinstance(node, type) and issubclass(node, Node)):
        given = node.__name__ if isinstance(node, type) else type(node).__name__
        raise TypeError(f"replay() takes a class derived from rclpy.node.Node, not {given}")
    several = [outputs] if isinstance(outputs, str) else outputs
    wanted = None if several is None else [topics.absolute(name) for name in several]
    started = time.perf_counter()
    published: set[str] = set()

    def keep(topic: str, message_type: Any, nanoseconds: int, data: bytes) -> None:
        published.add(topic)
        if wanted is None or topic in wanted:
            replayed.keep(topic, message_type, nanoseconds, data)

    with bags.told(bag) as messages, closing(LockStep(messages.start, keep, timeout)) as steps:
        replayed = Replayed(node.__name__, messages.start)
        steps.make(node, args, kwargs)
        replayed.sent = _send_all(steps, messages, node.__name__, Path(bag).name)
        replayed.logs.extend(rosout.line_of(one) for one in steps.take_logs())
    replayed.bag_seconds, replayed.seconds = bags.info(bag).seconds, time.perf_counter() - started
    if missing := [topic for topic in wanted or () if topic not in published]:
        there = ", ".join(sorted(published)) or "nothing"
        raise ValueError(f"{node.__name__} published nothing on {', '.join(missing)}; it published {there}")
    return replayed


def _send_all(steps: LockStep, bag: OpenBag, name: str, bag_name: str) -> dict[str, int]:
    """Send every message that the node subscribes to; how many of each topic that were."""
    _check_inputs(steps.subscribes_to(), bag, name, bag_name)
    connections = [one for one in bag.connections if one.topic not in OF_EVERY_NODE]
    sent: Counter[str] = Counter()
    with long_task(f"sending {bag_name} through {name}", (bag.end - bag.start) * 1e-9, "s of the bag") as task:
        for connection, nanoseconds, data in bag.messages(connections):
            task.done = (nanoseconds - bag.start) * 1e-9
            if connection.topic in steps.subscribes_to():
                steps.send(connection, nanoseconds, data)
                sent[connection.topic] += 1
            else:
                steps.advance(nanoseconds)
    return dict(sent)


def _check_inputs(inputs: dict[str, str], bag: OpenBag, name: str, bag_name: str) -> None:
    """Raise ValueError if nothing in the bag is for the node, or is of another type."""
    there = {one.topic: one.msgtype for one in bag.connections}
    if not inputs.keys() & there.keys():
        asks = f"subscribes to {', '.join(sorted(inputs))}" if inputs else "subscribes to nothing"
        raise ValueError(f"{name} {asks}, and '{bag_name}' has {', '.join(sorted(there)) or 'no topic'}")
    for topic, kind in inputs.items():
        if topic in there and there[topic] != kind:
            raise ValueError(f"{name} subscribes to {topic} as {kind}, and '{bag_name}' has it as {there[topic]}")
