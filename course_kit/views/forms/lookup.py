"""Looks a name up in the graph: a topic, a service or an action, and its type."""

from __future__ import annotations

import inspect
from typing import Any

from course_kit.base.arguments import shown
from course_kit.base.polling import wait_until
from course_kit.cli.ros2.messages.arguments import interface_class
from course_kit.cli.ros2.verbs import CommandError, did_you_mean
from course_kit.ros.graph import graph
from course_kit.ros.interface_types import type_name
from course_kit.ros.subscriptions import observer_node
from course_kit.ros.subscriptions.topics import absolute
from course_kit.views.forms.interface import ACTION, SERVICE, TOPIC, Interface

_NOUNS = {"msg": TOPIC, "srv": SERVICE, "action": ACTION}


def find(name: str, given: Any, timeout: float) -> Interface:
    """What a name stands for; without a given type (class or name) the graph must know it within `timeout` seconds.

    Raises LookupError if it does not, ValueError if the name or the type can be none, or if there are several.
    """
    full_name = absolute(name)
    if given is not None:
        interface_type, kind = _class_of(given)
        _refuse_others(full_name, _NOUNS[kind], type_name(interface_type))
        return Interface(_NOUNS[kind], full_name, interface_type)
    found = wait_until(lambda: _types_of(full_name), timeout)
    if not found:
        hint = did_you_mean(full_name, [*_there(TOPIC), *_there(SERVICE), *_there(ACTION)]) or "Does its node run?"
        raise LookupError(
            f"no node has a topic, service or action {full_name} (waited {timeout:g} s). {hint} "
            f"To be the first on a topic, give its type: show_form('{full_name}', 'std_msgs/msg/String')."
        )
    if len(found) > 1:
        kinds = " and ".join(f"{noun} with {kind}" for noun, kind in found)
        raise ValueError(f"{full_name} is a {kinds}: say which you mean by its type, such as '{found[0][1]}'.")
    ((noun, kind),) = found
    return Interface(noun, full_name, _named(kind))


def _there(noun: str) -> graph.NamesAndTypes:
    node = observer_node.node()
    if noun == ACTION:
        return graph.actions(node)
    return graph.topics(node, True) if noun == TOPIC else graph.services(node, True)


def _types_of(name: str) -> list[tuple[str, str]]:
    return [(noun, kind) for noun in _NOUNS.values() for kind in _there(noun).get(name, ())]


def _refuse_others(name: str, noun: str, wanted: str) -> None:
    """ValueError if the name is known, but not with the wanted type: what is sent would reach nobody."""
    known = _there(noun).get(name, ())
    if known and wanted not in known:
        raise ValueError(
            f"the {noun} {name} has the type {known[0]}, so what is sent as {wanted} would reach nobody. "
            f"Leave the type out, and it is looked up."
        )


def _class_of(given: Any) -> tuple[Any, str]:
    """The class of a type, and whether it is a msg, srv or action."""
    if isinstance(given, str):
        found = _named(given)
    elif inspect.isclass(given) and hasattr(given, "_TYPE_SUPPORT"):
        found = given
    else:
        raise TypeError(
            f"{shown(given)} is no interface type: give a class such as Twist, or 'geometry_msgs/msg/Twist'"
        )
    kind = type_name(found).split("/")[1]
    if type_name(found).count("/") != 2 or kind not in _NOUNS or "_" in found.__name__:
        raise TypeError(f"{shown(given)} is a part of an interface: give the whole of it, such as Spawn")
    return found, kind


def _named(name: str) -> Any:
    kind = (name.split("/")[1:2] or [""])[0] if name.count("/") == 2 else "msg"
    if kind not in _NOUNS:
        raise ValueError(f"{shown(name)} is no name of a type. Write it like 'geometry_msgs/msg/Twist'.")
    try:
        return interface_class(name, kind)
    except CommandError as error:
        hint = error.suggestion or "Is its package built, and sourced?"
        raise ValueError(f"no type {shown(name)} is installed here. {hint}") from None
