"""`ros2 param`: list, get, set, describe, dump, load, delete."""

from __future__ import annotations

from argparse import Namespace
from collections.abc import Sequence
from functools import partial
from typing import TYPE_CHECKING, Any

from course_kit.cli.ros2.completion import node_names, parameter_names
from course_kit.cli.ros2.param.files import PARAMETERS, VALUES, nested, read
from course_kit.cli.ros2.param.services import call, list_parameters
from course_kit.cli.ros2.session import Session
from course_kit.cli.ros2.verbs import (
    GRAPH,
    CommandError,
    Verb,
    all_of,
    argument,
    compiled,
    did_you_mean,
    failing,
    flag,
    whole,
)

if TYPE_CHECKING:
    from course_kit.ros.graph.graph import NodeName

SCALARS = ("boolean", "integer", "double", "string")
NODE_POLL = 0.05  # seconds between two looks for a node
TYPE_NAMES = ("not set", *SCALARS, "byte array", *(f"{name} array" for name in SCALARS))


def _nodes(args: Namespace, session: Session) -> list[NodeName]:
    from course_kit.ros.graph import graph

    return sorted(graph.nodes(session.graph(), args.include_hidden_nodes))


def _found_node(args: Namespace, session: Session) -> str:
    """The full name of the node that was named, once it is there; --timeout is for one that only starts."""
    from course_kit.ros.graph import graph

    node, wanted = session.graph(), graph.NodeName.of(args.node_name).full_name

    def known() -> list[str]:
        return [name.full_name for name in graph.nodes(node, args.include_hidden_nodes)]

    if not session.until(lambda: wanted in known(), args.timeout, NODE_POLL):
        raise CommandError("Node not found", did_you_mean(wanted, known()))
    return wanted


def value_of(value: Any) -> Any:
    """The Python value in an rcl_interfaces ParameterValue; None if it is not set."""
    from rclpy.parameter import parameter_value_to_python

    python = parameter_value_to_python(value)
    return list(python) if value.type >= 5 else python


def _list(args: Namespace, session: Session) -> None:
    from course_kit.ros.graph import graph

    chosen = [graph.NodeName.of(_found_node(args, session))] if args.node_name else _nodes(args, session)
    is_wanted = compiled(args.filter or "", "Invalid regular expression '{}': {}").search

    def answers(node: NodeName) -> bool:
        return f"{node.full_name}/list_parameters" in graph.services(session.node, with_hidden=True)

    for node in chosen:
        if not session.until(partial(answers, node), args.timeout if args.node_name else 0.0, NODE_POLL):
            continue  # it has no parameters; one that has just come offers its services a little later
        try:
            names = list_parameters(session, node.full_name, *args.param_prefixes)
            names = list(filter(is_wanted, names))
            described = _described(session, node.full_name, names) if args.param_type else ()
        except CommandError as error:  # one node that does not answer must not hide the others
            session.warn(str(error))
            continue
        if not args.node_name:
            session.print(f"{node.full_name}:")
        types = {descriptor.name: f" (type: {TYPE_NAMES[descriptor.type]})" for descriptor in described}
        for name in names:
            session.print(f"  {name}{types[name] if args.param_type else ''}")


def _described(session: Session, node_name: str, names: Sequence[str]) -> Sequence[Any]:
    """rcl_interfaces ParameterDescriptors, one for each name that is declared."""
    return call(session, node_name, "describe_parameters", names=names).descriptors


def _get(args: Namespace, session: Session) -> None:
    node = _found_node(args, session)
    values = call(session, node, "get_parameters", names=[args.parameter_name]).values
    if not values or values[0].type == 0:
        known = list_parameters(session, node)
        raise CommandError("Parameter not set", did_you_mean(args.parameter_name, known))
    kind, _, is_array = TYPE_NAMES[values[0].type].capitalize().partition(" ")
    label = "" if args.hide_type else f"{kind} {'values are' if is_array else 'value is'}: "
    session.print(f"{label}{value_of(values[0])}")


def _set(args: Namespace, session: Session) -> None:
    node = _found_node(args, session)
    parameter = with_value(args.parameter_name, args.value)
    (result,) = call(session, node, "set_parameters", parameters=[parameter]).results
    _report(session, result, "Set parameter", "Setting parameter")


def with_value(name: str, text: str) -> Any:
    """An rcl_interfaces Parameter with the value that a YAML text stands for. CommandError for what cannot be one."""
    from rcl_interfaces.msg import Parameter
    from rclpy.parameter import get_parameter_value

    with failing(Exception, say=lambda _: f"'{text}' is no value of a parameter: {VALUES}"):  # rclpy's are many
        return _sendable(Parameter(name=name, value=get_parameter_value(text)))


def _sendable(message: Any) -> Any:
    """The message, if it can be sent: what its fields do not check, such as text that is no UTF-8, raises here."""
    from rclpy.serialization import serialize_message

    serialize_message(message)
    return message


def _report(session: Session, result: Any, done: str, tried: str, adverb: str = "successful") -> None:
    reason = f": {result.reason}" if result.reason else ""
    if result.successful:
        session.print(f"{done} {adverb}{reason}")
    else:
        session.warn(f"{tried} failed{reason}")


def _delete(args: Namespace, session: Session) -> None:
    from rcl_interfaces.msg import Parameter

    node = _found_node(args, session)
    nothing = Parameter(name=args.parameter_name)
    (result,) = call(session, node, "set_parameters", parameters=[nothing]).results
    _report(session, result, "Deleted parameter", "Deleting parameter", adverb="successfully")


def _describe(args: Namespace, session: Session) -> None:
    for descriptor in _described(session, _found_node(args, session), args.parameter_names):
        session.print("\n".join(description(descriptor)))


def description(descriptor: Any) -> list[str]:
    """The lines of `describe` for one rcl_interfaces ParameterDescriptor."""
    lines = [f"Parameter name: {descriptor.name}", f"  Type: {TYPE_NAMES[descriptor.type]}"]
    if descriptor.description:
        lines.append(f"  Description: {descriptor.description}")
    lines.append("  Constraints:")
    if descriptor.read_only:
        lines.append("    Read only: true")
    for limits in [*descriptor.floating_point_range, *descriptor.integer_range][:1]:
        lines += [f"    Min value: {limits.from_value}", f"    Max value: {limits.to_value}"]
        if limits.step:
            lines.append(f"    Step: {limits.step}")
    if descriptor.additional_constraints:
        lines.append(f"    Additional constraints: {descriptor.additional_constraints}")
    return lines


def _dump(args: Namespace, session: Session) -> None:
    import yaml

    node = _found_node(args, session)
    names = list_parameters(session, node)
    values = call(session, node, "get_parameters", names=names).values
    parameters = dict(zip(names, map(value_of, values), strict=False))
    session.print(yaml.dump({node: {PARAMETERS: nested(parameters)}}, default_flow_style=False))


def _load(args: Namespace, session: Session) -> None:
    node = _found_node(args, session)
    values = read(args.parameter_file, node, not args.no_use_wildcard)
    parameters = {name: with_value(name, str(value)) for name, value in values.items()}
    results = call(session, node, "set_parameters", parameters=list(parameters.values())).results
    for name, result in zip(parameters, results, strict=True):
        _report(session, result, f"Set parameter {name}", f"Set parameter {name}")


_HIDDEN = flag("--include-hidden-nodes", "include hidden nodes, with an underscore in the name")
_TIMEOUT = argument(
    "--timeout", "wait at most N seconds for the node to appear (default: 1)", type=whole, default=1, metavar="N"
)
_NODE = all_of(GRAPH, argument("node_name", "the node, such as /turtlesim", node_names), _HIDDEN, _TIMEOUT)
_PARAMETER = argument("parameter_name", "the parameter, such as background_r", parameter_names)
VERBS = {
    "delete": Verb("delete a parameter of a node", _delete, _NODE, _PARAMETER),
    "describe": Verb(
        "show type, description and limits of parameters",
        _describe,
        _NODE,
        argument("parameter_names", "the parameters", parameter_names, nargs="+"),
    ),
    "dump": Verb("print the parameters of a node as a parameter file", _dump, _NODE),
    "get": Verb("print a parameter", _get, _NODE, _PARAMETER, flag("--hide-type", "print only the value")),
    "list": Verb(
        "list the parameters of a node, or of all",
        _list,
        GRAPH,
        argument("node_name", "the node (default: all)", node_names, nargs="?"),
        _HIDDEN,
        _TIMEOUT,
        argument("--param-prefixes", "list only parameters below these prefixes", nargs="+", default=[]),
        flag("--param-type", "show their types"),
        argument("--filter", "list only parameters that match this regular expression"),
    ),
    "load": Verb(
        "set parameters of a node from a parameter file",
        _load,
        _NODE,
        argument("parameter_file", "the file, in YAML"),
        flag("--no-use-wildcard", "leave out the values that the file gives to all nodes, below /**"),
    ),
    "set": Verb("set a parameter", _set, _NODE, _PARAMETER, argument("value", "its new value, as YAML")),
}
