"""The checker's side of a ROS domain: a node that knows the graph, and what a check needs for its length."""

from __future__ import annotations

import contextlib
import os
import threading
from collections import deque
from collections.abc import Callable
from typing import Any, TypeVar

from rclpy.node import Node
from rclpy.qos import DurabilityPolicy
from rclpy.serialization import deserialize_message

from course_kit.examining.node_log import NodeLog
from course_kit.ros_graph import discovery, graph
from course_kit.spinning import context as ros_context
from course_kit.spinning.executors import SpinThread
from course_kit.spinning.nodes import quiet_node
from course_kit.watching import topics
from course_kit.watching.raw_subscriptions import RawSubscription, Watcher

Made = TypeVar("Made")
LOG_PERIOD = 0.2  # seconds between two looks at what was logged
KEPT = 20_000  # messages of one subscription


class Heard:
    """The messages of one topic, in order, with the times (nanoseconds) at which the middleware received them."""

    def __init__(self, message_type: Any, topic: str = "") -> None:
        self.topic = topic
        self._type = message_type
        self._kept: deque[tuple[int, int, bytes]] = deque(maxlen=KEPT)
        self._lock = threading.Lock()
        self.received = 0  # messages in all, also those no longer kept
        self.subscription: RawSubscription  # once it is listened to

    def receive(self, serialised: bytes, info: dict[str, Any]) -> None:
        """Keep a message; called in the watching thread."""
        with self._lock:
            self.received += 1
            self._kept.append((info["received_timestamp"], info["publication_sequence_number"], serialised))

    def __len__(self) -> int:
        return len(self._kept)

    def _all(self) -> list[tuple[int, int, bytes]]:
        with self._lock:
            return list(self._kept)

    def _read(self, serialised: bytes) -> Any:
        return deserialize_message(serialised, self._type)

    @property
    def times(self) -> list[int]:
        """When each kept message came, in nanoseconds since the epoch, oldest first."""
        return [when for when, _, _ in self._all()]

    @property
    def arrivals(self) -> list[tuple[int, Any]]:
        """When each kept message came, and the message, oldest first."""
        return [(when, self._read(serialised)) for when, _, serialised in self._all()]

    @property
    def messages(self) -> list[Any]:
        """The kept messages, oldest first."""
        return [message for _, message in self.arrivals]

    @property
    def publisher_count(self) -> int:
        """How many publishers are matched."""
        return self.subscription.publisher_count

    def since_restart(self) -> list[Any]:
        """The messages of the last of its publishers: each counts its own from 1."""
        kept = self._all()
        starts = [0, *(place for place in range(1, len(kept)) if kept[place][1] <= kept[place - 1][1])]
        return [self._read(serialised) for _, _, serialised in kept[starts[-1] :]]

    @property
    def last(self) -> Any:
        """The newest message. IndexError if none has come."""
        return self._read(self._kept[-1][2])


class Station:
    """One ROS context of the checker. `mine` has the names of its nodes."""

    def __init__(self, domain: int | None, only_here: bool) -> None:
        """`domain` None: the student's, from the environment. `only_here`: speak with this machine only."""
        self.context = ros_context.separate(domain, "LOCALHOST" if only_here else None)
        self.domain: int = self.context.get_domain_id()
        self._made = 0
        self.node = self._hidden_node()
        self.discovery = discovery.of(self.node, keep=True)
        self.errors: list[Exception] = []
        self._watcher = Watcher(self.node, self.errors.append)
        self._check_node: Node | None = None
        self._check = contextlib.ExitStack()  # what ends with a check
        self._node_log: NodeLog | None = None
        self.mine: set[str] = set()
        self._graph_thread = SpinThread(self.node, self.errors.append).start()

    # The graph.

    def known(self, timeout: float) -> bool:
        """Wait until the whole graph is known."""
        return self.discovery.wait(timeout)

    def their_nodes(self) -> list[str]:
        """The nodes that are not the checker's, by their full names; hidden ones not."""
        return [n.full_name for n in graph.nodes(self.node) if n.full_name not in self.mine]

    def publishers(self, topic: str) -> list[Any]:
        """The publishers of a topic that are not the checker's."""
        return [e for e in topics.publishers(self.node, topic) if self._is_theirs(e)]

    def subscriptions(self, topic: str) -> list[Any]:
        """The subscriptions to a topic that are not the checker's."""
        return [e for e in topics.subscriptions(self.node, topic) if self._is_theirs(e)]

    def _is_theirs(self, endpoint: Any) -> bool:
        return topics.node_name(endpoint) not in self.mine and not endpoint.node_name.startswith("_")

    def offered(self) -> list[graph.Interfaces]:
        """What each of their nodes offers and uses."""
        offers = []
        for name in self.their_nodes():
            with contextlib.suppress(Exception):  # it has gone meanwhile
                offers.append(graph.interfaces(self.node, graph.NodeName.of(name)))
        return offers

    # What lasts as long as a check.

    def listen(self, topic: str, message_type: Any, keep: bool = False) -> Heard:
        """Subscribe to a topic; with the reliability of its publishers, and without what they kept for newcomers.

        With `keep` beyond the end of the check.
        """
        qos = topics.qos_for(topic, topics.publishers(self.node, topic))
        qos.durability = DurabilityPolicy.VOLATILE
        heard = Heard(message_type, topic)
        heard.subscription = self._watcher.subscribe(topic, message_type, qos, heard.receive)
        if not keep:
            self._check.callback(heard.subscription.close)
        return heard

    def node_log(self) -> NodeLog:
        """What the nodes log, from the first call on."""
        if self._node_log is None:
            self._node_log = NodeLog(self.node)
            self.node.create_timer(LOG_PERIOD, self._node_log.take)
        return self._node_log

    @property
    def check_node(self) -> Node:
        """A node for publishers and clients, which ends with the check."""
        if self._check_node is None:
            self._check_node = self.spin(self._hidden_node())
        return self._check_node

    def _hidden_node(self) -> Node:
        self._made += 1
        return quiet_node(f"_checker_{os.getpid()}_{self._made}", self.context)

    def on_own_node(self, prepare: Callable[[Node], Made]) -> Made:
        """What `prepare` makes of a node in a thread of its own, which ends with the check."""
        node = self._hidden_node()
        made = prepare(node)  # before it spins: which executor suits a node depends on what it has
        self.spin(node)
        return made

    def spin(self, node: Node) -> Node:
        """Spin a node until the check ends."""
        self.mine.add(node.get_fully_qualified_name())
        self._check.callback(SpinThread(node, self.errors.append).start().close)
        return node

    def tidy(self) -> None:
        """End what was opened for a check."""
        self._check.close()
        self._check_node = None
        self.mine.clear()
        self.errors.clear()

    def close(self) -> None:
        """End the context, in good order: a node that just dies stays in the graph for seconds."""
        self.tidy()
        self._watcher.stop()
        self._graph_thread.stop()
        if self._node_log is not None:
            self._node_log.close()
        discovery.forget(self.node)
        self._graph_thread.close()
        self.context.try_shutdown()
