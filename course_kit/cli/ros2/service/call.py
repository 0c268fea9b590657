"""`ros2 service call`: one request, or one after the other, and the responses."""

from __future__ import annotations

import time
from argparse import Namespace
from contextlib import ExitStack

from course_kit.cli.ros2.completion import fields_of
from course_kit.cli.ros2.named import SERVICES
from course_kit.cli.ros2.servers import ANSWER_TIMEOUT, outcome, wait_for_server
from course_kit.cli.ros2.session import Session
from course_kit.cli.ros2.verbs import LONGEST, CommandError, Verb, argument, failing, number, one_line, yaml_values


def _run(args: Namespace, session: Session) -> None:
    session.join()
    from course_kit.cli.ros2.messages.arguments import checked_name, filled, interface_class, parsed
    from course_kit.cli.ros2.messages.values import stamp
    from course_kit.ros.subscriptions.clients import client_of, meet_service

    if args.rate is not None and args.rate <= 0:
        raise CommandError("rate must be greater than zero")
    kind = interface_class(args.service_type, "srv")
    request = kind.Request()
    times = filled(request, parsed(args, args.values))
    name = checked_name(args.service_name, "service")
    node = session.node
    with ExitStack() as stack:
        with failing(Exception, say=one_line):  # rclpy has several for what the middleware refuses
            client = stack.enter_context(client_of(node, kind, name))
        is_ready, full_name = client.service_is_ready, client.srv_name
        if not is_ready():
            session.print("waiting for service to become available...")
            wait_for_server(session, "service", full_name, args.service_type, is_ready, node.count_services)
        meet_service(node, client, session.until)
        while True:
            stamp(times, *node.get_clock().now().seconds_nanoseconds())
            session.print(f"requester: making request: {request!r}\n")
            began = time.monotonic()
            future = client.call_async(request)
            try:
                lost = f"the server of '{full_name}' ended before it answered"
                response = outcome(session, future, is_ready, "calling service", lost, timeout=ANSWER_TIMEOUT)
            finally:
                client.remove_pending_request(future)
            session.print(f"response:\n{response!r}\n")
            if args.rate is None:
                return
            session.sleep(began + 1 / args.rate - time.monotonic())


# What is 0 or less, the real command refuses later, and in other words.
_rate = number(float, lambda value: True, "invalid float value: {!r}", LONGEST)

CALL = Verb(
    "call a service, and print its answer",
    _run,
    SERVICES.name,
    SERVICES.typed("service_type"),
    yaml_values("values", "{a: 1, b: 2}", fields_of("srv", "service_type")),
    argument("-r --rate", "call it again and again, N times a second", metavar="N", type=_rate),
)
