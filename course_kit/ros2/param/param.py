"""`ros2 param`: list, get, set, describe, dump, load, delete."""

from __future__ import annotations

import re
from argparse import ArgumentParser, Namespace
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

from course_kit.ros2.completion import node_names, parameter_names
from course_kit.ros2.param import services
from course_kit.ros2.session import Session
from course_kit.ros2.verbs import CommandError, Verb, add_flag, add_offered, add_strategy_arguments, did_you_mean

if TYPE_CHECKING:
    from course_kit.ros_graph.graph import NodeName


def _node_arguments(parser: ArgumentParser, nargs: str | None = None) -> None:
    add_strategy_arguments(parser)
    add_offered(parser, "node_name", node_names, "Name of the ROS node", nargs=nargs)
    add_flag(parser, "--include-hidden-nodes", "Consider hidden nodes as well")


def _parameter_argument(parser: ArgumentParser, name: str = "parameter_name", nargs: str | None = None) -> None:
    plural = "Names of the parameters" if nargs else "Name of the parameter"
    add_offered(parser, name, parameter_names, plural, nargs=nargs)


def _nodes(args: Namespace, session: Session) -> list[NodeName]:
    from course_kit.ros_graph import graph

    return sorted(graph.nodes(session.graph(), args.include_hidden_nodes))


def _found_node(args: Namespace, session: Session) -> str:
    """The full name of the node that was named."""
    from course_kit.ros_graph.graph import NodeName

    known = [name.full_name for name in _nodes(args, session)]
    wanted = NodeName.of(args.node_name).full_name
    if wanted not in known:
        raise CommandError("Node not found", did_you_mean(wanted, known))
    return wanted


def value_of(value: Any) -> Any:
    """The Python value in an rcl_interfaces ParameterValue; None if it is not set."""
    from rclpy.parameter import parameter_value_to_python

    python = parameter_value_to_python(value)
    return list(python) if value.type >= 5 else python


def _list_arguments(parser: ArgumentParser) -> None:
    _node_arguments(parser, nargs="?")
    parser.add_argument(
        "--param-prefixes", nargs="+", default=[], help="Only list parameters with the provided prefixes"
    )
    add_flag(parser, "--param-type", "Print parameter types with parameter names")
    parser.add_argument("--filter", help="Only list parameters matching the provided regex")


def _list(args: Namespace, session: Session) -> None:
    from course_kit.ros_graph import graph

    chosen = [graph.NodeName.of(_found_node(args, session))] if args.node_name else _nodes(args, session)
    try:
        pattern = re.compile(args.filter) if args.filter else None
    except re.error as error:
        raise CommandError(f"Invalid regular expression '{args.filter}': {error}") from None
    offered = graph.services(session.node, with_hidden=True)
    for node in chosen:
        if f"{node.full_name}/list_parameters" not in offered:
            continue
        try:
            names = services.list_parameters(session, node.full_name, args.param_prefixes)
            names = [name for name in names if pattern is None or pattern.search(name)]
            types = _types(session, node.full_name, names) if args.param_type else {}
        except CommandError as error:  # one node that does not answer must not hide the others
            session.warn(str(error))
            continue
        if not args.node_name:
            session.print(f"{node.full_name}:")
        for name in names:
            session.print(f"  {name} (type: {types[name]})" if args.param_type else f"  {name}")


def _types(session: Session, node_name: str, names: list[str]) -> dict[str, str]:
    described = services.describe_parameters(session, node_name, names)
    return {d.name: services.TYPE_NAMES[d.type] for d in described}


def _get_arguments(parser: ArgumentParser) -> None:
    _node_arguments(parser)
    _parameter_argument(parser)
    add_flag(parser, "--hide-type", "Hide the type information")


def _get(args: Namespace, session: Session) -> None:
    node = _found_node(args, session)
    values = services.get_parameters(session, node, [args.parameter_name])
    if not values or values[0].type == 0:
        known = services.list_parameters(session, node)
        raise CommandError("Parameter not set", did_you_mean(args.parameter_name, known))
    kind, _, is_array = services.TYPE_NAMES[values[0].type].capitalize().partition(" ")
    label = "" if args.hide_type else f"{kind} {'values are' if is_array else 'value is'}: "
    session.print(f"{label}{value_of(values[0])}")


def _set_arguments(parser: ArgumentParser) -> None:
    _node_arguments(parser)
    _parameter_argument(parser)
    parser.add_argument("value", help="Value of the parameter")


def _set(args: Namespace, session: Session) -> None:
    from rcl_interfaces.msg import Parameter
    from rclpy.parameter import get_parameter_value

    node = _found_node(args, session)
    parameter = Parameter(name=args.parameter_name, value=get_parameter_value(args.value))
    _report(session, services.set_parameters(session, node, [parameter])[0], "Set parameter", "Setting parameter")


def _report(session: Session, result: Any, done: str, tried: str, adverb: str = "successful") -> None:
    reason = f": {result.reason}" if result.reason else ""
    if result.successful:
        session.print(f"{done} {adverb}{reason}")
    else:
        session.warn(f"{tried} failed{reason}")


def _delete_arguments(parser: ArgumentParser) -> None:
    _node_arguments(parser)
    _parameter_argument(parser)


def _delete(args: Namespace, session: Session) -> None:
    from rcl_interfaces.msg import Parameter

    node = _found_node(args, session)
    result = services.set_parameters(session, node, [Parameter(name=args.parameter_name)])[0]
    _report(session, result, "Deleted parameter", "Deleting parameter", adverb="successfully")


def _describe_arguments(parser: ArgumentParser) -> None:
    _node_arguments(parser)
    _parameter_argument(parser, "parameter_names", nargs="+")


def _describe(args: Namespace, session: Session) -> None:
    node = _found_node(args, session)
    for descriptor in services.describe_parameters(session, node, args.parameter_names):
        session.print("\n".join(description(descriptor)))


def description(descriptor: Any) -> list[str]:
    """The lines of `describe` for one rcl_interfaces ParameterDescriptor."""
    lines = [f"Parameter name: {descriptor.name}", f"  Type: {services.TYPE_NAMES[descriptor.type]}"]
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
    names = services.list_parameters(session, node)
    values = services.get_parameters(session, node, names)
    parameters = dict(zip(names, map(value_of, values), strict=False))
    session.print(yaml.dump({node: {"ros__parameters": nested(parameters)}}, default_flow_style=False))


def nested(parameters: Mapping[str, Any]) -> dict[str, Any]:
    """{'a.b': 1} as {'a': {'b': 1}}: how a parameter file writes names with dots."""
    tree: dict[str, Any] = {}
    for name, value in parameters.items():
        *groups, last = name.split(".")
        branch = tree
        for group in groups:
            branch = branch.setdefault(group, {})
        branch[last] = value
    return tree


def _load_arguments(parser: ArgumentParser) -> None:
    _node_arguments(parser)
    parser.add_argument("parameter_file", help="Parameter file")
    add_flag(parser, "--no-use-wildcard", "Do not load parameters in the '/**' namespace into the node")


def _load(args: Namespace, session: Session) -> None:
    import yaml
    from rclpy.parameter import parameter_dict_from_yaml_file

    node = _found_node(args, session)
    try:
        found = parameter_dict_from_yaml_file(args.parameter_file, not args.no_use_wildcard, target_nodes=[node])
    except OSError as error:
        raise CommandError(f"{error.strerror}: '{args.parameter_file}'") from None
    except yaml.YAMLError as error:
        raise CommandError(f"{args.parameter_file} is no YAML: {' '.join(str(error).split())}") from None
    except (RuntimeError, AttributeError, TypeError) as error:
        raise CommandError(str(error)) from None
    results = services.set_parameters(session, node, list(found.values()))
    for name, result in zip(found, results, strict=True):
        _report(session, result, f"Set parameter {name}", f"Set parameter {name}")


VERBS = {
    "delete": Verb("Delete parameter", _delete, _delete_arguments),
    "describe": Verb("Show descriptive information about declared parameters", _describe, _describe_arguments),
    "dump": Verb("Show all of the parameters of a node in a YAML file format", _dump, _node_arguments),
    "get": Verb("Get parameter", _get, _get_arguments),
    "list": Verb("Output a list of available parameters", _list, _list_arguments),
    "load": Verb("Load parameter file for a node", _load, _load_arguments),
    "set": Verb("Set parameter", _set, _set_arguments),
}
