"""`ros2 service`: list, type, find, info here; call in a module of its own."""

from __future__ import annotations

from argparse import ArgumentParser, Namespace

from course_kit.ros2.named import Named
from course_kit.ros2.service.call import CALL
from course_kit.ros2.session import Session
from course_kit.ros2.verbs import CommandError, Verb, add_strategy_arguments, did_you_mean

SERVICES = Named("service", "/add_two_ints", "rcl_interfaces/srv/ListParameters")
add_arguments = SERVICES.add_hidden


def _info_arguments(parser: ArgumentParser) -> None:
    add_strategy_arguments(parser)
    SERVICES.add_name(parser, "get info")


def _info(args: Namespace, session: Session) -> None:
    services = SERVICES.found(args, session)
    service = args.service_name
    if service not in services:
        raise CommandError(f"Unknown service '{service}'", did_you_mean(service, services))
    types = services[service]
    session.print(f"Type: {types[0] if len(types) == 1 else types}")
    session.print(f"Clients count: {session.node.count_clients(service)}")
    session.print(f"Services count: {session.node.count_services(service)}")


VERBS = {
    "call": CALL,
    "find": Verb("Output a list of available services of a given type", SERVICES.find, SERVICES.find_arguments),
    "info": Verb("Print information about a service", _info, _info_arguments),
    "list": Verb("Output a list of available services", SERVICES.list, SERVICES.list_arguments),
    "type": Verb("Output a service's type", SERVICES.type, SERVICES.type_arguments),
}
