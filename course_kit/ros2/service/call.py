"""`ros2 service call`: one request, or one after the other, and the responses."""

from __future__ import annotations

import time
from argparse import ArgumentParser, Namespace
from typing import Any

from course_kit.ros2.completion import names_of, type_of
from course_kit.ros2.session import Session
from course_kit.ros2.verbs import CommandError, Verb, add_flag, add_offered, did_you_mean

GONE = 2.0  # seconds after which a server that is not there any more will not answer


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
    from course_kit.ros2.messages.arguments import filled, parsed
    from course_kit.ros2.messages.classes import checked_name, interface_class
    from course_kit.watching import instruments

    if args.rate is not None and args.rate <= 0:
        raise CommandError("rate must be greater than zero")
    kind = interface_class(args.service_type, "srv")
    request = kind.Request()
    times = filled(request, parsed(args, args.values))
    name = checked_name(args.service_name, "service")
    node = session.node
    try:
        client = node.create_client(kind, name)
    except Exception as error:  # rclpy has several for what the middleware refuses
        raise CommandError(" ".join(str(error).split())) from None
    try:
        if not client.service_is_ready():
            session.print("waiting for service to become available...")
            _wait_for_service(session, client, args.service_type)
        _call(args, session, client, request, times)
    finally:
        instruments.executor().create_task(node.destroy_client, client)


def _wait_for_service(session: Session, client: Any, service_type: str) -> None:
    from course_kit.ros_graph import graph

    if session.until(client.service_is_ready, GONE, poll=0.002):
        return
    node = session.graph()
    offered = {name: types for name, types in graph.services(node).items() if node.count_services(name)}
    types = [name for name in offered.get(client.srv_name, []) if name != service_type]
    suggestion = f"Did you mean {types[0]}?" if types else did_you_mean(client.srv_name, offered)
    if suggestion and not client.service_is_ready():
        session.warn(suggestion)
    session.until(client.service_is_ready)


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
    seen = time.monotonic()

    def is_over() -> bool:
        nonlocal seen
        if client.service_is_ready():
            seen = time.monotonic()
        return bool(future.done()) or time.monotonic() - seen > GONE

    session.until(is_over, poll=0.002)
    if not future.done():
        client.remove_pending_request(future)
        raise CommandError(
            f"Exception while calling service: the server of '{client.srv_name}' ended before it answered"
        )
    if future.exception() is not None:
        raise CommandError(f"Exception while calling service: {future.exception()!r}")
    return future.result()


CALL = Verb("Call a service", _run, _arguments)
