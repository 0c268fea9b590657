"""`ros2 service`: list, type, find, info here; call in a module of its own."""

from __future__ import annotations

from argparse import ArgumentParser, Namespace

from course_kit.ros2.completion import service_names, service_types, service_types_in_use
from course_kit.ros2.named import print_found, print_list, print_types
from course_kit.ros2.service.call import CALL
from course_kit.ros2.session import Session
from course_kit.ros2.verbs import CommandError, Verb, add_strategy_arguments, did_you_mean


def add_arguments(parser: ArgumentParser) -> None:
    parser.add_argument("--include-hidden-services", action="store_true", help="Consider hidden services as well")


def _list_arguments(parser: ArgumentParser) -> None:
    add_strategy_arguments(parser)
    parser.add_argument("-t", "--show-types", action="store_true", help="Additionally show the service type")
    parser.add_argument(
        "-c", "--count-services", action="store_true", help="Only display the number of services discovered"
    )
    parser.add_argument("--include-hidden-services", action="store_true", help="Consider hidden services as well")


def _list(args: Namespace, session: Session) -> None:
    from course_kit.ros_graph import graph

    services = graph.services(session.graph(), args.include_hidden_services)
    print_list(session, services, args.count_services, args.show_types)


def _name_argument(parser: ArgumentParser, purpose: str) -> None:
    argument = parser.add_argument("service_name", help=f"Name of the ROS service to {purpose} (e.g. '/add_two_ints')")
    argument.completer = service_names  # type: ignore[attr-defined]


def _info_arguments(parser: ArgumentParser) -> None:
    add_strategy_arguments(parser)
    _name_argument(parser, "get info")


def _info(args: Namespace, session: Session) -> None:
    from course_kit.ros_graph import graph

    node = session.graph()
    services = graph.services(node, args.include_hidden_services)
    service = args.service_name
    if service not in services:
        raise CommandError(f"Unknown service '{service}'", did_you_mean(service, services))
    types = services[service]
    session.print(f"Type: {types[0] if len(types) == 1 else types}")
    session.print(f"Clients count: {node.count_clients(service)}")
    session.print(f"Services count: {node.count_services(service)}")


def _type_arguments(parser: ArgumentParser) -> None:
    add_strategy_arguments(parser)
    _name_argument(parser, "get type")


def _type(args: Namespace, session: Session) -> int:
    from course_kit.ros_graph import graph

    return print_types(session, graph.services(session.graph(), with_hidden=True).get(args.service_name, []))


def _find_arguments(parser: ArgumentParser) -> None:
    add_strategy_arguments(parser)
    argument = parser.add_argument(
        "service_type", help="Name of the ROS service type to filter for (e.g. 'rcl_interfaces/srv/ListParameters')"
    )
    argument.completer = service_types_in_use  # type: ignore[attr-defined]
    parser.add_argument(
        "-c", "--count-services", action="store_true", help="Only display the number of services discovered"
    )
    parser.add_argument("--include-hidden-services", action="store_true", help="Consider hidden services as well")


def _find(args: Namespace, session: Session) -> None:
    from course_kit.ros_graph import graph

    services = graph.services(session.graph(), args.include_hidden_services)
    print_found(session, services, args.service_type, args.count_services, service_types())


VERBS = {
    "call": CALL,
    "find": Verb("Output a list of available services of a given type", _find, _find_arguments),
    "info": Verb("Print information about a service", _info, _info_arguments),
    "list": Verb("Output a list of available services", _list, _list_arguments),
    "type": Verb("Output a service's type", _type, _type_arguments),
}
