"""The state that the actions of a launch share: arguments, environment, event handlers and waiting events."""

from __future__ import annotations

import asyncio
import os
from collections import Counter, deque
from collections.abc import Iterable
from types import SimpleNamespace
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from rclpy.node import Node as RosNode

    from course_kit.cli.launching.events import Event
    from course_kit.cli.launching.handlers import EventHandler
    from course_kit.cli.launching.substitutions import Substitution


class Locals(SimpleNamespace):
    """What is known only while an event is handled, as attributes: `context.locals.event`."""

    def __getattr__(self, name: str) -> Any:
        raise AttributeError(f"context.locals has no '{name}' here")


class LaunchContext:
    """The state of one launch."""

    asyncio_loop: asyncio.AbstractEventLoop  # of the running launch

    def __init__(self, *, argv: Iterable[str] | None = None, noninteractive: bool = False) -> None:
        self.argv = list(argv or ())
        self.noninteractive = noninteractive
        self.launch_configurations: dict[str, Any] = {}
        self.is_shutdown = False
        self.events: deque[Event] = deque()
        self._arrival: asyncio.Future[None] | None = None
        self.handlers: deque[EventHandler] = deque()
        self.node_names: Counter[str] = Counter()
        self.temporary_files: list[str] = []
        self.ros_node: RosNode | None = None  # of this launch, if something needs it
        self.token = ""  # marks the processes of this launch
        self.group_interrupted = False  # a Ctrl-C reached every process by itself
        self.environment = os.environ  # of processes; a launch file may change it
        self._first_environment = dict(os.environ)
        self.local_values: dict[str, Any] = {}  # as long as an event is handled
        self._scopes: list[tuple[dict[str, Any], dict[str, str]]] = []

    @property
    def locals(self) -> Locals:
        """Values of the event that is being handled and of the launch file."""
        return Locals(**self.local_values)

    def get_locals_as_dict(self) -> dict[str, Any]:
        """The same, as a dictionary."""
        return self.local_values

    def extend_locals(self, values: dict[str, Any]) -> None:
        """Add local values; they last as long as the event is handled."""
        self.local_values = {**self.local_values, **values}

    def push_scope(self) -> None:
        """Have what is set from now on, launch configurations and environment, last until pop_scope()."""
        self._scopes.append((dict(self.launch_configurations), dict(os.environ)))

    def pop_scope(self) -> None:
        """Set launch configurations and environment back to what they were."""
        self.launch_configurations, environment = self._scopes.pop()
        _set_environment(environment)

    def forget_values(self) -> None:
        """Set launch configurations and environment back to what they were when the launch began."""
        self.launch_configurations.clear()
        _set_environment(self._first_environment)

    def perform_substitution(self, substitution: Substitution) -> str:
        """The text of a substitution."""
        return substitution.perform(self)

    def register_event_handler(self, handler: EventHandler, append: bool = False) -> None:
        """Add a handler: before the others, so that the newest comes first, or behind them."""
        if append:
            self.handlers.append(handler)
        else:
            self.handlers.appendleft(handler)

    def unregister_event_handler(self, handler: EventHandler) -> None:
        """Remove a handler."""
        if handler in self.handlers:
            self.handlers.remove(handler)

    def would_handle_event(self, event: Event) -> bool:
        """Return True if some handler takes the event."""
        return any(handler.matches(event) for handler in self.handlers)

    def emit_event_sync(self, event: Event) -> None:
        """Have an event handled after those that wait already."""
        self.events.append(event)
        if self._arrival is not None and not self._arrival.done():
            self._arrival.set_result(None)

    def next_arrival(self) -> asyncio.Future[None]:
        """Done when an event comes that has to be handled."""
        self._arrival = self.asyncio_loop.create_future()
        return self._arrival

    async def emit_event(self, event: Event) -> None:
        """The same, for coroutines."""
        self.emit_event_sync(event)


def _set_environment(environment: dict[str, str]) -> None:
    if environment != dict(os.environ):
        os.environ.clear()
        os.environ.update(environment)
