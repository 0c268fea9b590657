"""Tab for the arguments of `ros2`: names from the graph, types from the installed packages.

The completers are argcomplete's: they take the word begun and what was parsed so far. The shell and `%ros2` use the
same ones.
"""

from __future__ import annotations

import contextlib
from argparse import Namespace
from collections.abc import Callable, Iterable, Sequence
from typing import Any

from course_kit.base.kernel import in_kernel
from course_kit.cli.ros2.session import Session
from course_kit.cli.ros2.verbs import BACKGROUND
from course_kit.ros import packages

KINDS = {"topic": "msg", "service": "srv", "action": "action"}  # what an interface of each is called in a package
OF_GRAPH = {*KINDS, "lifecycle", "node", "param"}  # commands whose verbs take names from the graph, first or second


class _Silent(Session):
    """Joins the graph, and says nothing beside the line that is typed."""

    def __init__(self, args: Namespace) -> None:
        super().__init__(args)
        self.join()

    def warn(self, text: str) -> None:
        """Say nothing."""


def join_ahead(line: str) -> None:
    """Join the graph if what may follow this line is probably there, before the line is parsed: only to be quicker."""
    *words, begun = line.split() if not line[-1:].isspace() else [*line.split(), ""]
    if words[1:2] and words[1] in OF_GRAPH and len(words) in (3, 4) and not begun.startswith("-"):
        Session(Namespace()).join()


def offering(names: Callable[[Namespace], Iterable[str]]) -> Callable[..., list[str]]:
    """A completer that offers these names."""

    def offer(prefix: str, parsed_args: Namespace, **_: Any) -> list[str]:
        return [name for name in names(parsed_args) if name.startswith(prefix)]

    return offer


def names_of(noun: str) -> Callable[..., list[str]]:
    """Offers the topics, services or actions of the graph."""
    return offering(lambda args: _Silent(args).named(noun))


def types_in_use(noun: str) -> Callable[..., list[str]]:
    """Offers the types that topics, services or actions of the graph have."""
    return offering(lambda args: sorted({t for types in _Silent(args).named(noun, True).values() for t in types}))


def type_of(noun: str) -> Callable[..., list[str]]:
    """Offers the type of what was named before; all types of its kind if nobody has it."""

    def types(args: Namespace) -> Sequence[str]:
        return _Silent(args).named(noun, True).get(getattr(args, f"{noun}_name", "")) or installed_types(noun)

    return offering(types)


def installed_types(noun: str) -> list[str]:
    """Every type that a topic, a service or an action can have with what is installed."""
    from course_kit.cli.ros2.interface.interface import types

    return types([KINDS[noun]])


@offering
def node_names(args: Namespace) -> list[str]:
    """Offers the nodes of the graph."""
    from course_kit.ros.graph import graph

    return [name.full_name for name in graph.nodes(_Silent(args).graph())]


@offering
def parameter_names(args: Namespace) -> list[str]:
    """Offers the parameters of the node that was named before."""
    from course_kit.cli.ros2.param.services import list_parameters

    session = _Silent(args)
    session.graph()
    return list_parameters(session, args.node_name)


def fields_of(kind: str, type_argument: str) -> Callable[..., list[str]]:
    """Offers what may follow the YAML that is begun for the type named before; all of its fields if none is."""

    def offer(prefix: str, parsed_args: Namespace, **_: Any) -> list[str]:
        from course_kit.cli.ros2.interface.field_completion import Fillable, continuations
        from course_kit.cli.ros2.interface.interface import definition

        type_name = getattr(parsed_args, type_argument) or ""
        with contextlib.suppress(Exception):  # rosidl_adapter has several for what it cannot read, such as IDL
            message = Fillable(
                type_name if type_name.count("/") > 1 else type_name.replace("/", f"/{kind}/"), definition
            )
            return continuations(message, prefix) if prefix else [message.prototype()]
        return []

    return offer


of_background = offering(lambda args: [BACKGROUND] if in_kernel() else [])  # where all words are a program's
package_names = offering(lambda args: packages.package_names())
