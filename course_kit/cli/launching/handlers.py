"""Event handlers: what is to be done when something happens."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from typing import Any

from course_kit.cli.launching import events
from course_kit.cli.launching.context import LaunchContext
from course_kit.cli.launching.entities import Action, LaunchDescriptionEntity

# Entities, or a function that is called with the event and the context and returns some.
SomeEntities = LaunchDescriptionEntity | Iterable[LaunchDescriptionEntity] | None
Response = SomeEntities | Callable[..., SomeEntities]


def as_list(entities: SomeEntities) -> list[LaunchDescriptionEntity]:
    """Entities as a list, whatever form they were given in."""
    if entities is None:
        return []
    return [entities] if isinstance(entities, LaunchDescriptionEntity) else [e for e in entities if e is not None]


class EventHandler:
    """Gives entities to be visited when an event matches."""

    def __init__(self, *, matcher: events.Matcher, entities: Response = None, handle_once: bool = False) -> None:
        self._matcher = matcher
        self.entities = entities
        self._handle_once = handle_once

    def matches(self, event: events.Event) -> bool:
        """Return True if it takes the event."""
        return bool(self._matcher(event))

    def handle(self, event: events.Event, context: LaunchContext) -> list[LaunchDescriptionEntity]:
        """What is to be visited now."""
        context.extend_locals({"event": event})
        if self._handle_once:
            context.unregister_event_handler(self)
        return as_list(self.entities(event, context) if callable(self.entities) else self.entities)

    def describe(self) -> tuple[str, list[LaunchDescriptionEntity]]:
        """How --print shows it, and what it leads to."""
        response, entities = (self.entities, []) if callable(self.entities) else ("<actions>", as_list(self.entities))
        return f"{type(self).__name__}({self._arguments(response)})", entities

    def _arguments(self, response: object) -> str:
        return f"matcher='{self._matcher}', handler='<actions>'"


class _OnAction(EventHandler):
    """Matches events of one type that are about one action, about those a function takes, or about all."""

    def __init__(
        self, event_type: type[Any], target_action: Any, entities: Response, handle_once: bool, word: str
    ) -> None:
        if target_action is not None and not isinstance(target_action, Action) and not callable(target_action):
            raise TypeError(f"{type(self).__name__}: target_action must be an action, not {target_action!r}")
        self._target = target_action
        self._word = word
        is_meant = events.matches_action(target_action) if isinstance(target_action, Action) else target_action
        super().__init__(
            matcher=lambda event: isinstance(event, event_type) and (is_meant is None or is_meant(event.action)),
            entities=entities,
            handle_once=handle_once,
        )

    def _arguments(self, response: object) -> str:
        return f"target_action={self._target}, {self._word}={response}"


class OnProcessStart(_OnAction):
    """When a process has started."""

    def __init__(self, *, target_action: Any = None, on_start: Response, handle_once: bool = False) -> None:
        super().__init__(events.ProcessStarted, target_action, on_start, handle_once, "on_start")


class OnProcessExit(_OnAction):
    """When a process has ended."""

    def __init__(self, *, target_action: Any = None, on_exit: Response, handle_once: bool = False) -> None:
        super().__init__(events.ProcessExited, target_action, on_exit, handle_once, "on_exit")


class OnExecutionComplete(_OnAction):
    """When an action has been executed."""

    def __init__(self, *, target_action: Any = None, on_completion: Response, handle_once: bool = False) -> None:
        super().__init__(events.ExecutionComplete, target_action, on_completion, handle_once, "on_completion")


class OnProcessIO(_OnAction):
    """When a process writes; the functions are called with the event, which has the bytes as `text`."""

    def __init__(
        self,
        *,
        target_action: Any = None,
        on_stdin: Callable[[events.RunningProcessEvent], SomeEntities] | None = None,
        on_stdout: Callable[[events.ProcessIO], SomeEntities] | None = None,
        on_stderr: Callable[[events.ProcessIO], SomeEntities] | None = None,
    ) -> None:
        self._by_source = {"stdin": on_stdin, "stdout": on_stdout, "stderr": on_stderr}
        super().__init__(events.ProcessIO, target_action, self._respond_to, False, "on_io")

    def _respond_to(self, event: events.ProcessIO, context: LaunchContext) -> SomeEntities:
        response = self._by_source[event.source]
        return None if response is None else response(event)


def on_event(event_type: type[events.Event], entities: Response) -> EventHandler:
    """Matches all events of a type."""
    return EventHandler(matcher=lambda event: isinstance(event, event_type), entities=entities)


class OnShutdown(EventHandler):
    """When the launch shuts down."""

    def __init__(self, *, on_shutdown: Response, **options: Any) -> None:
        super().__init__(matcher=lambda event: isinstance(event, events.Shutdown), entities=on_shutdown, **options)

    def _arguments(self, response: object) -> str:
        return f"on_shutdown={response}"
