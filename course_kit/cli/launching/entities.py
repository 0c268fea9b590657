"""The entities of a launch description; actions are those that do something."""

from __future__ import annotations

import asyncio
from collections.abc import Iterable, Sequence
from typing import Any

from course_kit.cli.launching import output
from course_kit.cli.launching.conditions import Condition
from course_kit.cli.launching.context import LaunchContext
from course_kit.cli.launching.events import ExecutionComplete
from course_kit.cli.launching.uncovered import REAL, NotCoveredError

Entities = Sequence["LaunchDescriptionEntity"] | None


class LaunchDescriptionEntity:
    """Something that can be visited; what it gives is visited next."""

    def visit(self, context: LaunchContext) -> Entities:
        """Do what it stands for; return what is to be visited next."""
        return None

    def describe_sub_entities(self) -> Entities:
        """What is always visited with it."""
        return []

    def describe_conditional_sub_entities(self) -> list[tuple[str, Iterable[LaunchDescriptionEntity]]]:
        """What is visited with it under a condition: (when, entities)."""
        return []

    def get_asyncio_future(self) -> asyncio.Future[None] | None:
        """Done when it is; None for what is done at once."""
        return None


class Action(LaunchDescriptionEntity):
    """Something to be done, if its condition holds."""

    def __init__(self, *, condition: Condition | None = None, **unknown: Any) -> None:
        if unknown:
            raise NotCoveredError(
                f"{type(self).__name__} does not know the argument {next(iter(unknown))!r} here: "
                f"if it is right, it needs {REAL}"
            )
        self.condition = condition

    def describe(self) -> str:
        """How it is named in messages."""
        return repr(self)

    def describe_sub_entities(self) -> Entities:
        """What is always visited with it: nothing if it has a condition."""
        return self.get_sub_entities() if self.condition is None else []

    def describe_conditional_sub_entities(self) -> list[tuple[str, Iterable[LaunchDescriptionEntity]]]:
        """What is visited with it if its condition holds."""
        return [("Conditionally included by condition", self.get_sub_entities() or [])] if self.condition else []

    def get_sub_entities(self) -> Entities:
        """What is visited with it if its condition holds."""
        return []

    def visit(self, context: LaunchContext) -> Entities:
        """Execute it if its condition holds, and tell that it is done."""
        if self.condition is not None and not self.condition.evaluate(context):
            return None
        try:
            return self.execute(context)
        finally:
            event = ExecutionComplete(action=self)
            if context.would_handle_event(event):
                if future := self.get_asyncio_future():
                    future.add_done_callback(lambda _: context.emit_event_sync(event))
                else:
                    context.emit_event_sync(event)

    def execute(self, context: LaunchContext) -> Entities:
        """Do it."""
        raise NotImplementedError(f"{type(self).__name__} has no execute()")


class LaunchDescription(LaunchDescriptionEntity):
    """What a launch file's generate_launch_description() returns: a list of entities."""

    def __init__(
        self, initial_entities: Iterable[LaunchDescriptionEntity] | None = None, *, deprecated_reason: str | None = None
    ) -> None:
        self.entities: list[LaunchDescriptionEntity] = list(initial_entities or ())
        self.deprecated_reason = deprecated_reason

    def visit(self, context: LaunchContext) -> Entities:
        """Warn if it is deprecated; visit its entities."""
        if self.deprecated_reason is not None:
            path = context.get_locals_as_dict().get("current_launch_file_path")
            what = f"{path or 'a launch description'} is out of date"
            output.get_logger().warning(f"{what}: {self.deprecated_reason}")
        return self.entities

    def describe_sub_entities(self) -> Entities:
        """Its entities."""
        return self.entities

    def add_entity(self, entity: LaunchDescriptionEntity) -> None:
        """Add an entity at the end."""
        self.entities.append(entity)

    add_action = add_entity


def visit_all(entity: LaunchDescriptionEntity, context: LaunchContext) -> list[asyncio.Future[None]]:
    """Visit an entity and what it leads to, depth first; return the futures of those that are not done yet."""
    if not isinstance(entity, LaunchDescriptionEntity):
        raise RuntimeError(f"expected an action or another launch description entity, got {entity!r}")
    futures = [future for one in entity.visit(context) or () for future in visit_all(one, context)]
    own = entity.get_asyncio_future()
    return futures if own is None else [*futures, own]
