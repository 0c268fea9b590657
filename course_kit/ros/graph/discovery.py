"""Waits until this process knows the whole graph of this machine, so that a list of it misses nothing.

Three sources, each complete in its own way, are compared: the UDP ports on which participants of this domain listen
(how many there are), the `ros_discovery_info` message that every participant keeps for newcomers (its nodes, and the
ids of all their publishers, subscriptions, services and clients), and the endpoints that discovery has brought.
"""

from __future__ import annotations

import contextlib
import threading
import time
import weakref
from collections import Counter
from collections.abc import Callable, Iterable, Sequence

from rclpy.node import Node

from course_kit.ros.graph import latecomers
from course_kit.ros.private_api import going_on_without
from course_kit.ros.private_api.fastdds_parts import PARTICIPANT_SIZE, Entities, entities, participants_listening
from course_kit.ros.private_api.rmw_parts import SerializedSubscription, is_fast_dds
from course_kit.ros.private_api.rtps_parts import ask_all_to_announce
from course_kit.ros.subscriptions import observer_node
from course_kit.ros.subscriptions.topics import UNKNOWN_NODE

POLL = 0.01  # seconds
REST = 2.5  # seconds without news after which no more is expected: lost messages are repeated each second
ASK_AGAIN = 0.3  # seconds after which those that are not known yet are asked again
LATE, QUIET = 1.0, 0.5  # seconds that a wait takes, and that nothing new has come, before it is said on whom it waits
WHOLE_TIMEOUT = 6.0  # seconds given to the graph to become known; a graph at rest takes a tenth of one
TAKE_PERIOD = 1.0  # seconds between two looks at the messages of a process that stays
TOPIC = "ros_discovery_info"
DEPTH = 1000
# Where the announcements cannot be read, lists wait until nothing new comes, as beside another middleware.
UNREAD = "lists of nodes and topics take some seconds, and may miss what is slow to appear"

_lock = threading.Lock()
_discoveries: weakref.WeakKeyDictionary[Node, Discovery] = weakref.WeakKeyDictionary()


def of(node: Node, keep: bool = False) -> Discovery:
    """The discovery of a node, made at the first use and kept with it; `keep` for a process that stays."""
    observer_node.before_end(forget)
    with _lock:
        if node not in _discoveries:
            _discoveries[node] = Discovery(node)
        if keep:
            _discoveries[node].keep(node)
        return _discoveries[node]


class Discovery:
    """What one node has learned of the graph so far, and what it must still learn."""

    def __init__(self, node: Node) -> None:
        self._node = weakref.ref(node)
        self._domain = node.context.get_domain_id()
        self._announced: dict[bytes, Entities] = {}  # by participant
        self._known: set[bytes] = set()  # participants, at the last look
        self._listening: dict[int, str] = {}  # where they hear of others, at the last look
        self._found: set[bytes] = set()  # endpoints that the graph has shown with their node
        self._lock = threading.RLock()
        self._is_kept = False
        self._subscription: SerializedSubscription | None = None
        if is_fast_dds():
            with going_on_without(UNREAD):
                self._subscription = SerializedSubscription(
                    node, TOPIC, "rmw_dds_common", "ParticipantEntitiesInfo", DEPTH
                )

    def keep(self, node: Node) -> None:
        """Take messages regularly from now on: for a process that stays, so that none is overwritten."""
        if not self._is_kept:
            self._is_kept = True
            node.create_timer(TAKE_PERIOD, self._take)

    def close(self) -> None:
        """End the subscription; before the node is destroyed."""
        with self._lock:  # another thread may be taking a message
            if self._subscription is not None:
                self._subscription.close()
                self._subscription = None

    def wait(self, timeout: float = WHOLE_TIMEOUT, say_late: Callable[[str], None] | None = None) -> bool:
        """Wait until the node knows every participant, node and endpoint that is there; whether it does.

        Returns False after `timeout` seconds, or when nothing new has come for REST seconds: then something listens
        on the domain's ports that is no ROS node, or a process hangs. `say_late` is told once, in a sentence, on whom
        a long wait waits.
        """
        began = asked = time.monotonic()
        state, changed = None, began
        while not self.is_whole():
            now = time.monotonic()
            if self._node() is None:
                return False
            if (new := (len(self._known), len(self._announced), len(self._found))) != state:
                state, changed = new, now
            if now >= min(began + timeout, changed + REST):
                return False
            if len(self._known) < len(self._listening) and now >= asked:
                ask_all_to_announce(self._listening)
                asked = now + ASK_AGAIN
            if say_late is not None and now >= max(began + LATE, changed + QUIET):
                say_late(latecomers.waited_for(self._domain, self._known, self._announced))
                say_late = None
            time.sleep(POLL)
        return True

    def is_whole(self) -> bool:
        """Return True if every participant is known and has named its nodes, and all their endpoints are known."""
        node = self._node()
        if node is None:
            return False
        self._known = known = self._participants(node)
        if self._subscription is None:
            return False
        listening = participants_listening(self._domain)
        if listening is None:
            return False
        self._listening = listening
        if len(known) < len(listening):
            return False
        announced = self._announced_by(known)
        if len(announced) < len(known):
            return False
        # The middleware reads these messages for itself, earlier or later than they are read here.
        if _nodes(announced) - Counter(node.get_node_names_and_namespaces()):
            return False
        missing = set().union(*(a.endpoints for a in announced)) - self._found
        return not missing or self._look_for(node, missing)

    def alive(self, listed: Sequence[tuple[str, str]]) -> list[tuple[str, str]]:
        """Of listed nodes, as (name, namespace), those whose participant is there and has announced them.

        The middleware keeps a node for ever if its last message is read after the end of its participant.
        """
        announced = self.announced()
        if self._node() is None or self._subscription is None:
            return list(listed)
        return list((Counter(listed) & _nodes(announced)).elements())

    @property
    def reads(self) -> bool:
        """True if the announcements of participants can be read with this middleware."""
        return self._subscription is not None

    def announced(self) -> list[Entities]:
        """What each participant that is there has announced, those that have done so."""
        node = self._node()
        return self._announced_by(self._participants(node)) if node is not None else []

    def _participants(self, node: Node) -> set[bytes]:
        writers = node.get_publishers_info_by_topic(TOPIC, no_mangle=True)
        return {bytes(writer.endpoint_gid)[:PARTICIPANT_SIZE] for writer in writers}

    def _announced_by(self, participants: set[bytes]) -> list[Entities]:
        """What these participants have announced, those that have done so."""
        self._take()
        return [self._announced[participant] for participant in participants if participant in self._announced]

    def _take(self) -> None:
        with self._lock, going_on_without(UNREAD):
            while self._subscription is not None and (sample := self._subscription.take()) is not None:
                announced = entities(sample.data)
                self._announced[announced.participant] = announced
            return
        self.close()

    def _look_for(self, node: Node, missing: set[bytes]) -> bool:
        for topic, _ in node.get_topic_names_and_types(no_demangle=True):
            for look in (node.get_publishers_info_by_topic, node.get_subscriptions_info_by_topic):
                found = {bytes(e.endpoint_gid) for e in look(topic, no_mangle=True) if e.node_name != UNKNOWN_NODE}
                self._found |= found
                missing -= found
            if not missing:
                return True
        return False


def _nodes(announced: Iterable[Entities]) -> Counter[tuple[str, str]]:
    return Counter(node for one in announced for node in one.nodes)


def forget(node: Node) -> None:
    """Close what was kept for a node that is about to be destroyed."""
    with _lock, contextlib.suppress(KeyError):
        _discoveries.pop(node).close()
