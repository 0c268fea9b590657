"""`ros2 service call`: one request, or one after the other, and the responses."""

from __future__ import annotations

import time
from argparse import ArgumentParser, Namespace
from contextlib import ExitStack
from typing import Any

from course_kit.ros2.completion import names_of, type_of
from course_kit.ros2.servers import outcome, wait_for_server
from course_kit.ros2.session import Session
from course_kit.ros2.verbs import CommandError, Verb, add_flag, add_offered


def _arguments(parser: ArgumentParser) -> None:
    add_offered(
        parser, "service_name", names_of("service"), "Name of the ROS service to call to (e.g. '/add_two_ints')"
    )
    add_offered(parser, "service_type", type_of("service"), "Type of the ROS service (e.g. 'std_srvs/srv/Empty')")
    group = parser.add_mutually_exclusive_group()
    group.add_argument(
        "values",
        nargs="?",
        default="{}",
        help="Values to fill the service request with in YAML format (e.g. '{a: 1, b: 2}'), otherwise the service "
        "request will be published with default values",
    )
    add_flag(group, "--stdin", "Read values from standard input")
    parser.add_argument("-r", "--rate", metavar="N", type=float, help="Repeat the call at a specific rate in Hz")


def _run(args: Namespace, session: Session) -> None:
    from course_kit.ros2.messages.arguments import checked_name, filled, interface_class, parsed
    from course_kit.watching.instruments import client_of

    if args.rate is not None and args.rate <= 0:
        raise CommandError("rate must be greater than zero")
    kind = interface_class(args.service_type, "srv")
    request = kind.Request()
    times = filled(request, parsed(args, args.values))
    name = checked_name(args.service_name, "service")
    with ExitStack() as stack:
        try:
            client = stack.enter_context(client_of(session.node, kind, name))
        except Exception as error:  # rclpy has several for what the middleware refuses
            raise CommandError(" ".join(str(error).split())) from None
        if not client.service_is_ready():
            session.print("waiting for service to become available...")
            wait_for_server(session, client.service_is_ready, client.srv_name, args.service_type, _offered)
        _call(args, session, client, request, times)


def _offered(node: Any) -> dict[str, list[str]]:
    from course_kit.ros_graph import graph

    return {name: types for name, types in graph.services(node).items() if node.count_services(name)}


def _call(args: Namespace, session: Session, client: Any, request: Any, times: list[Any]) -> None:
    from course_kit.ros2.messages.values import stamp

    while True:
        stamp(times, *session.node.get_clock().now().seconds_nanoseconds())
        session.print(f"requester: making request: {request!r}\n")
        began = time.monotonic()
        session.print(f"response:\n{_response(session, client, request)!r}\n")
        if args.rate is None:
            return
        session.sleep(max(0.0, began + 1 / args.rate - time.monotonic()))


def _response(session: Session, client: Any, request: Any) -> Any:
    """The response, when it comes. CommandError if the server ends before it answers."""
    future = client.call_async(request)
    try:
        lost = f"the server of '{client.srv_name}' ended before it answered"
        return outcome(session, future, client.service_is_ready, "calling service", lost)
    finally:
        client.remove_pending_request(future)


CALL = Verb("Call a service", _run, _arguments)
