"""The clock that a verb of `ros2 topic` goes by: this machine's, or with -s that of /clock."""

from __future__ import annotations

import time
from argparse import Namespace
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from operator import itemgetter
from typing import Any

from course_kit.cli.ros2.session import Session


@dataclass(frozen=True)
class Clock:
    """What time it is, and when a message came, by its info: both in nanoseconds."""

    now: Callable[[], int]
    received: Callable[[dict[str, Any]], int]
    is_simulated: bool = False

    def passes(self, session: Session, seconds: float) -> Iterator[None]:
        """Goes on each time that so many seconds have passed on it, or that it was set back."""
        while True:
            began = self.now()
            session.until(lambda: not 0 <= self.now() - began < seconds * 1e9)  # noqa: B023 - it is called here
            yield


WALL = Clock(time.time_ns, itemgetter("received_timestamp"))  # when it arrived, however late Python is


def of_node(node: Any) -> Clock:
    """The clock of a node on simulated time; it stands at 0 until /clock is heard."""
    clock = node.get_clock()

    def now() -> int:
        return int(clock.now().nanoseconds)

    return Clock(now, lambda info: now(), is_simulated=True)


@contextmanager
def chosen(session: Session, args: Namespace) -> Iterator[Clock]:
    """The clock that the command line asks for."""
    if not args.use_sim_time or getattr(args, "wall_time", False):
        yield WALL
        return
    with session.own_node(f"{session.node.get_name()}_clock", use_sim_time=True) as node:
        yield of_node(node)
