"""Actions about events: wait for them, cause them, wait for a time, shut down."""

from __future__ import annotations

import asyncio
from collections.abc import Iterable
from typing import Any

from course_kit.cli.launching import events, output
from course_kit.cli.launching.context import LaunchContext
from course_kit.cli.launching.entities import Action, LaunchDescriptionEntity
from course_kit.cli.launching.handlers import EventHandler, OnShutdown
from course_kit.cli.launching.substitutions import SomeSubstitutions, as_bool, as_text, is_substitution, perform


class EmitEvent(Action):
    """Causes an event."""

    def __init__(self, *, event: events.Event, **options: Any) -> None:
        super().__init__(**options)
        if not isinstance(event, events.Event):
            raise RuntimeError(f"EmitEvent emits an event, which {event!r} is not")
        self.event = event

    def execute(self, context: LaunchContext) -> None:
        """Have the event handled."""
        context.emit_event_sync(self.event)


class Shutdown(EmitEvent):
    """Ends the launch."""

    def __init__(self, *, reason: str = "no reason is known", **options: Any) -> None:
        super().__init__(event=events.Shutdown(reason=reason, due_to_sigint=False), **options)

    def execute(self, context: LaunchContext) -> None:
        """Have the launch end, and tell whose exit was the reason."""
        event = context.get_locals_as_dict().get("event")
        if isinstance(event, events.ProcessExited):
            output.get_logger("launch").info(
                f"process[{event.process_name}] was required: shutting down launched system"
            )
        super().execute(context)


class RegisterEventHandler(Action):
    """Adds an event handler."""

    def __init__(self, event_handler: EventHandler, **options: Any) -> None:
        super().__init__(**options)
        if not isinstance(event_handler, EventHandler):
            raise TypeError(f"RegisterEventHandler expected an event handler, got {event_handler!r}")
        self.event_handler = event_handler

    def execute(self, context: LaunchContext) -> None:
        """Add it."""
        context.register_event_handler(self.event_handler)

    def describe_conditional_sub_entities(self) -> list[tuple[str, Iterable[LaunchDescriptionEntity]]]:
        """What the handler leads to."""
        return [self.event_handler.describe()]


class UnregisterEventHandler(Action):
    """Takes an event handler away."""

    def __init__(self, event_handler: EventHandler, **options: Any) -> None:
        super().__init__(**options)
        self.event_handler = event_handler

    def execute(self, context: LaunchContext) -> None:
        """Take it away."""
        context.unregister_event_handler(self.event_handler)


class TimerAction(Action):
    """Visits other actions after `period` seconds."""

    def __init__(
        self,
        *,
        period: float | SomeSubstitutions,
        actions: Iterable[LaunchDescriptionEntity],
        cancel_on_shutdown: bool | SomeSubstitutions = True,
        **options: Any,
    ) -> None:
        super().__init__(**options)
        if isinstance(period, (bool, bytes)) or not (isinstance(period, (int, float, str)) or is_substitution(period)):
            raise TypeError(f"TimerAction expected 'period' to be a number or a substitution, got {period!r}")
        self.period = period
        self.actions = list(actions)
        self._cancel_on_shutdown = cancel_on_shutdown
        self._locals: dict[str, Any] = {}
        self._task: asyncio.Task[None] | None = None
        self._is_cancelled = False

    def describe(self) -> str:
        """How it is named in messages."""
        return f"TimerAction(period={self.period}, actions=<actions>)"

    def describe_conditional_sub_entities(self) -> list[tuple[str, Iterable[LaunchDescriptionEntity]]]:
        """The actions, when the time is over."""
        return [(f"{self.period} seconds pass without being canceled", self.actions)]

    def get_asyncio_future(self) -> asyncio.Future[None] | None:
        """Done when the time is over or the timer cancelled."""
        return self._task

    def execute(self, context: LaunchContext) -> None:
        """Start the timer."""
        if self._is_cancelled:
            return
        period = float(perform(context, as_text(self.period)))
        self._locals = context.get_locals_as_dict()
        handler = EventHandler(
            matcher=lambda event: isinstance(event, events.TimerEvent) and event.timer_action is self,
            entities=self._fired,
            handle_once=True,
        )
        context.register_event_handler(handler)
        self._task = context.asyncio_loop.create_task(self._wait(context, period))
        if as_bool(perform(context, as_text(self._cancel_on_shutdown))):
            context.register_event_handler(OnShutdown(on_shutdown=lambda event, context: self.cancel()))

    async def _wait(self, context: LaunchContext, period: float) -> None:
        await asyncio.sleep(period)
        context.emit_event_sync(events.TimerEvent(timer_action=self))

    def _fired(self, event: events.Event, context: LaunchContext) -> list[LaunchDescriptionEntity]:
        context.extend_locals(self._locals)
        return [] if self._is_cancelled else self.actions

    def cancel(self) -> None:
        """Let nothing happen when the time is over."""
        self._is_cancelled = True
        if self._task is not None:
            self._task.cancel()
