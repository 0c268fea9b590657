"""Describes a launch file without running it: its arguments, its entities as a tree."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

from course_kit.cli.launching.actions import DeclareLaunchArgument, LogInfo
from course_kit.cli.launching.context import LaunchContext
from course_kit.cli.launching.entities import Action, LaunchDescription
from course_kit.cli.launching.event_actions import EmitEvent, RegisterEventHandler
from course_kit.cli.launching.process import ExecuteProcess
from course_kit.cli.launching.substitutions import described, perform


def arguments_of(description: LaunchDescription) -> list[DeclareLaunchArgument]:
    """The arguments that a launch description declares, itself or in what it includes; each name once."""
    found: dict[str, DeclareLaunchArgument] = {}

    def look(entities: Iterable[Any], is_conditional: bool, given: frozenset[str]) -> None:
        for entity in entities:
            if isinstance(entity, DeclareLaunchArgument):
                if entity.name not in found:
                    entity._conditionally_included = is_conditional or entity.condition is not None
                    entity._is_given_by_an_include = entity.name in given
                    found[entity.name] = entity
                continue
            names = given | {_name_of(argument) for argument in getattr(entity, "launch_arguments", ())}
            look(entity.describe_sub_entities() or (), is_conditional, names)
            for _, others in entity.describe_conditional_sub_entities():
                look(others, True, names)

    look(description.entities, False, frozenset())
    return list(found.values())


def _name_of(argument: tuple[Any, Any]) -> str:
    """The name of an argument that an include gives; empty if only the running launch knows it."""
    try:
        return perform(LaunchContext(), argument[0])
    except Exception:
        return ""


def arguments_text(description: LaunchDescription) -> str:
    """What --show-args prints."""
    lines = ["Arguments (pass arguments as '<name>:=<value>'):"]
    arguments = arguments_of(description)
    for argument in arguments:
        lines += ["", f"    '{argument.name}':{'*' if argument._conditionally_included else ''}"]
        lines.append(f"        {argument.description}")
        if argument.default_value is not None:
            lines.append(f"        (default: {described(argument.default_value)})")
    if not arguments:
        lines += ["", "  No arguments."]
    elif any(argument._conditionally_included for argument in arguments):
        lines += ["", "* argument(s) which are only used if specific conditions occur"]
    return "\n".join(lines)


def description_text(description: LaunchDescription) -> str:
    """What --print prints."""
    lines = [f"    {line}" for line in _entities(description.entities)]
    return "\n".join([str(description), *_as_tree(lines)])


def _entities(entities: Iterable[Any]) -> list[str]:
    return [line for entity in entities for line in _entity(entity)]


def _entity(action: Any) -> list[str]:
    if isinstance(action, LogInfo):
        return [f"LogInfo({described(action.msg)})"]
    if isinstance(action, EmitEvent):
        return [f"EmitEvent(event='{action.event.name}')"]
    if isinstance(action, ExecuteProcess):
        cmd = ", ".join(described(part) for part in action.cmd)
        cwd = None if action.cwd is None else f"'{described(action.cwd)}'"
        pairs = None if action.env is None else ", ".join(f"{described(k)}: {described(v)}" for k, v in action.env)
        env = None if pairs is None else f"{{{pairs}}}"
        return [f"ExecuteProcess(cmd=[{cmd}], cwd={cwd}, env={env}, shell={action.shell})"]
    if isinstance(action, RegisterEventHandler):
        description, entities = action.event_handler.describe()
        led_to = (f"        {line}" for line in _entities(entities))
        return [f"RegisterEventHandler('{action.event_handler}'):", f"    {description}", *led_to]
    return [f"{'Action' if isinstance(action, Action) else 'Unknown entity'}('{action}')"]


def _as_tree(lines: list[str]) -> list[str]:
    """Draw branches before lines that are indented by steps of four, as the real one draws them."""
    drawn: list[str] = []
    before = 0
    for line in lines:
        depth = len(line) - len(line.lstrip())
        if drawn and "└" in drawn[-1] and before <= depth:
            drawn[-1] = drawn[-1].replace("└", "├", 1)
        before = depth
        # A branch in the first column goes on to the end; those further in are drawn for their own line only.
        drawn.append(("│" + line[1:])[: depth - 4] + "└── " + line[depth:])
    if drawn and drawn[-1].startswith("│"):
        drawn[-1] = " " + drawn[-1][1:]
    return drawn
