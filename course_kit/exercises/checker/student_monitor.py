"""Records the topics of the student's domain from a chapter's first check on.

A subscription alone makes its topic appear in every list of topics. So there is one only while a node of the
student's has an end of the topic: what a notebook lists is what its nodes have.
"""

from __future__ import annotations

import threading
import time
from typing import Any

from course_kit.ros.observing.domain_observer import DomainObserver
from course_kit.ros.observing.received_messages import ReceivedMessages
from course_kit.ros.subscriptions import topics

PERIOD = 0.02  # seconds: a cell that stops a simulator and then lists the topics must not find the checker's


class WatchedTopic(ReceivedMessages):
    """A topic that is listened to for hours, whoever publishes it."""

    def __init__(self, message_type: Any, topic: str) -> None:
        super().__init__(message_type, topic, changes=True)
        self.appeared: dict[bytes, int] = {}  # when each publisher was first seen, nanoseconds since the epoch
        self.present: set[bytes] = set()  # the publishers that were there at the last look
        self.listed_before: set[bytes] = set()  # those publishers without which the topic was listed, just before
        self.is_open = False
        self.is_listed = False  # though nobody publishes there: a subscription is left, a panel's or the checker's


class StudentDomainMonitor:
    """Listens to topics of a observer as long as others have them."""

    def __init__(self, observer: DomainObserver) -> None:
        self.watched: dict[str, WatchedTopic] = {}
        self._observer = observer
        self._lock = threading.Lock()
        self._ending = threading.Event()
        self._thread = threading.Thread(target=self._run, name="course_kit student monitor", daemon=True)

    def watch(self, topic: str, message_type: Any) -> None:
        """Listen to a topic from now on."""
        with self._lock:
            if topic not in self.watched:
                self.watched[topic] = WatchedTopic(message_type, topic)
                self._look_at(self.watched[topic])
        if not self._thread.is_alive():
            self._thread.start()

    def close(self) -> None:
        """Look no more; before the observer is closed."""
        self._ending.set()
        if self._thread.is_alive():
            self._thread.join(2.0)

    def _run(self) -> None:
        while not self._ending.wait(PERIOD):
            try:
                with self._lock:
                    for one in self.watched.values():
                        self._look_at(one)
            except Exception as error:  # a question to the graph that fails once may be answered the next time
                self._observer.errors.append(error)

    def _look_at(self, one: WatchedTopic) -> None:
        publishers, now = topics.publishers(self._observer.node, one.topic), time.time_ns()
        present = {bytes(publisher.endpoint_gid) for publisher in publishers}
        new = present - one.appeared.keys()
        one.appeared |= dict.fromkeys(new, now)
        # On a busy machine all publishers may have changed since the last look, with the checker's subscription there.
        if one.is_listed or (one.is_open and present.isdisjoint(one.present)):
            one.listed_before |= new
        one.present = present
        one.is_listed = not publishers and self._observer.node.count_subscribers(one.topic) > 0
        is_there = any(map(_is_visible, publishers)) or bool(self._observer.subscriptions(one.topic))
        if is_there and not one.is_open:
            self._observer.subscribe(one)
        elif one.is_open and not is_there:
            one.subscription.close(wait=False)
        one.is_open = is_there


def _is_visible(endpoint: Any) -> bool:
    """Return True if it is of a node that is listed; tools, and other notebooks' checkers, are hidden."""
    return not endpoint.node_name.startswith("_")
