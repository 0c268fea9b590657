"""The checker's side of a ROS domain: a node that knows the graph, and what a check needs for its length."""

from __future__ import annotations

import contextlib
import os
from collections.abc import Callable, Iterable, Iterator
from typing import Any, TypeVar

import psutil  # type: ignore[import-untyped]
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy

from course_kit.base.polling import wait_until
from course_kit.base.programs.process_ids import own_ids
from course_kit.ros.graph import discovery, graph
from course_kit.ros.observing.node_log import NodeLog
from course_kit.ros.observing.received_messages import ReceivedMessages
from course_kit.ros.private_api.fastdds_parts import PARTICIPANT_SIZE, Origin
from course_kit.ros.spinning import context as ros_context
from course_kit.ros.spinning.executors import SpinThread
from course_kit.ros.spinning.nodes import quiet_node
from course_kit.ros.subscriptions import topics
from course_kit.ros.subscriptions.raw_subscriptions import Watcher

Made = TypeVar("Made")
LOG_PERIOD = 0.2  # seconds between two looks at what was logged
POLL = 0.005  # seconds
MOST_PROCESSES = 1 << 22  # of Linux


def hidden_name(number: int) -> str:
    """A node's name, as the `ros2` command calls its own with its process id: no answer can behave for a check only."""
    return f"_ros2cli_{number}"


class DomainObserver:
    """One ROS context of the checker. `mine` has the names of its nodes."""

    def __init__(self, domain: int | None, only_here: bool) -> None:
        """`domain` None: the student's, from the environment. `only_here`: speak with this machine only."""
        self.context = ros_context.separate(domain, "LOCALHOST" if only_here else None)
        self.domain: int = self.context.get_domain_id()
        self._made = 0
        self.node = self._hidden_node()
        self.discovery = discovery.of(self.node, keep=True)
        self.errors: list[Exception] = []
        self._watcher = Watcher(self.node, self.errors.append, with_senders=True)
        self._check_node: Node | None = None
        self._check = contextlib.ExitStack()  # what ends with a check
        self._node_log: NodeLog | None = None
        self.mine: set[str] = set()
        self._examined: set[bytes] = set()  # the participants that the answer has, or had
        self._processes: set[int] = set()  # the lower 16 bits of the ids of processes that are the answer's
        self._own: bytes | None = None  # the checker's participant
        self._graph_thread = SpinThread(self.node, self.errors.append).start()

    # Whose is what. Where the middleware does not tell, or nothing is examined, all that is not the checker's counts.

    def examine(self, node: str, timeout: float, pid: int) -> bool:
        """Let what the participant of a hidden node of this name does count; whether it was found in time.

        `pid`: of the process in which it must be.
        """
        if not self.discovery.reads:
            return True
        pid_bits = {own & 0xFFFF for own in own_ids([pid])}

        def find() -> bool:
            found = {one.participant for one in self.discovery.announced() if (node, "/") in one.nodes}
            origins = [Origin.of(participant) for participant in found]
            # Else another process says that it is the answer's.
            is_found = len(found) == 1 and all(one is None or one.pid_bits in pid_bits for one in origins)
            self._examined |= found if is_found else set()
            return is_found

        return wait_until(find, timeout, POLL)

    def examine_processes(self, pids: Iterable[int]) -> None:
        """Let what these processes do count."""
        self._processes |= {pid & 0xFFFF for pid in own_ids(pids)}

    def counts(self, endpoint: bytes) -> bool:
        """Return True if an endpoint, by its id, is one of the answer."""
        if not (self._examined or self._processes) or not endpoint:
            return True
        origin = Origin.of(endpoint)
        return endpoint[:PARTICIPANT_SIZE] in self._examined or origin is None or origin.pid_bits in self._processes

    def is_own(self, endpoint: bytes) -> bool:
        """Return True if an endpoint, by its id, is one of the checker's."""
        if self._own is None:
            name = self.node.get_name(), self.node.get_namespace()
            self._own = next((one.participant for one in self.discovery.announced() if name in one.nodes), None)
        return not endpoint or self._own is None or endpoint[:PARTICIPANT_SIZE] == self._own

    def strangers(self, *names: str) -> list[str]:
        """Who has an end of these topics, as the middleware spells them, and is neither the checker nor the answer."""
        ends = [
            end
            for name in names
            for look in (self.node.get_publishers_info_by_topic, self.node.get_subscriptions_info_by_topic)
            for end in look(name, no_mangle=True)
            if not (self.counts(bytes(end.endpoint_gid)) or self.is_own(bytes(end.endpoint_gid)))
        ]
        if ends:  # those of a killed process are listed for a while
            alive = {pid & 0xFFFF for pid in own_ids(psutil.pids())}
            origins = [Origin.of(bytes(end.endpoint_gid)) for end in ends]
            ends = [e for e, origin in zip(ends, origins, strict=True) if origin is None or origin.pid_bits in alive]
        return sorted({topics.node_name(end) for end in ends})

    # The graph.

    def known(self, timeout: float) -> bool:
        """Wait until the whole graph is known."""
        return self.discovery.wait(timeout)

    def their_nodes(self) -> list[str]:
        """The answer's nodes, or all that are not the checker's, by their full names; hidden ones not."""
        if self._examined or self._processes:
            announced = [one for one in self.discovery.announced() if self.counts(one.participant)]
            there = [graph.NodeName(*node) for one in announced for node in one.nodes]
        else:
            there = graph.nodes(self.node)
        return sorted(n.full_name for n in there if n.full_name not in self.mine and not graph.is_hidden(n.full_name))

    def publishers(self, topic: str) -> list[Any]:
        """The publishers of a topic that count."""
        return [e for e in topics.publishers(self.node, topic) if self._is_theirs(e)]

    def subscriptions(self, topic: str) -> list[Any]:
        """The subscriptions to a topic that count."""
        return [e for e in topics.subscriptions(self.node, topic) if self._is_theirs(e)]

    def is_published_by_the_answer(self, topic: str) -> bool:
        """Return True if the answer publishes a topic, be it under the name of a node of the checker's."""
        ids = [bytes(each.endpoint_gid) for each in topics.publishers(self.node, topic)]
        return any(self.counts(one) and not self.is_own(one) for one in ids)

    def _is_theirs(self, endpoint: Any) -> bool:
        is_named = topics.node_name(endpoint) not in self.mine and not endpoint.node_name.startswith("_")
        return is_named and self.counts(bytes(endpoint.endpoint_gid))

    def offered(self) -> list[graph.Interfaces]:
        """What each of the answer's nodes offers and uses."""

        def of(name: str) -> graph.Interfaces:
            return graph.interfaces_of(self.node, lambda e: self._is_theirs(e) and topics.node_name(e) == name)

        return [of(name) for name in self.their_nodes()]

    # What lasts as long as a check.

    def listen(self, topic: str, message_type: Any, own: bool = False) -> ReceivedMessages:
        """Hear a topic for the length of the check. The answer's messages count, or with `own` the checker's."""
        heard = ReceivedMessages(message_type, topic, self.is_own if own else self.counts)
        self.hear(heard)
        return heard

    def hear(self, heard: ReceivedMessages, kept: bool = False) -> None:
        """Have it hear its topic for the length of the check; with what was `kept` for newcomers, or without."""
        self.subscribe(heard, kept)
        self._check.callback(heard.subscription.close)

    def subscribe(self, heard: ReceivedMessages, kept: bool = False) -> None:
        """Have it hear its topic, with the reliability of its publishers; with what they `kept` for newcomers, or not.

        For what is kept they must offer it: others than transient local publishers are not heard then.
        """
        qos = topics.qos_for(heard.topic, topics.publishers(self.node, heard.topic))
        qos.durability = DurabilityPolicy.TRANSIENT_LOCAL if kept else DurabilityPolicy.VOLATILE
        heard.subscription = self._watcher.subscribe(heard.topic, heard.type, qos, heard.receive)

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
        return quiet_node(hidden_name(int(f"{os.getpid()}{self._made:03}")), self.context)

    def on_own_node(self, prepare: Callable[[Node], Made]) -> Made:
        """What `prepare` makes of a node in a thread of its own, which ends with the check."""
        return self._check.enter_context(self.with_own_node(prepare))

    @contextlib.contextmanager
    def with_own_node(self, prepare: Callable[[Node], Made]) -> Iterator[Made]:
        """What `prepare` makes of a node in a thread of its own; both are gone when the block has ended."""
        node = self._hidden_node()
        made = prepare(node)  # before it spins: which executor suits a node depends on what it has
        with contextlib.closing(self._spin(node)):
            yield made

    def spin(self, node: Node) -> Node:
        """Spin a node until the check ends."""
        self._check.callback(self._spin(node).close)
        return node

    def _spin(self, node: Node) -> SpinThread:
        self.mine.add(node.get_fully_qualified_name())
        return SpinThread(node, self.errors.append).start()

    def tidy(self) -> None:
        """End what was opened for a check."""
        self._check.close()
        self._check_node = None
        self.mine.clear()
        self._examined.clear()
        self._processes.clear()
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
