"""`ros2 service`: list, type, find, info here; call and echo in modules of their own."""

from __future__ import annotations

from argparse import Namespace

from course_kit.ros2.named import SERVICES
from course_kit.ros2.service.call import CALL
from course_kit.ros2.service.echo import ECHO
from course_kit.ros2.session import Session
from course_kit.ros2.verbs import GRAPH, Verb

add_arguments = SERVICES.hidden


def _info(args: Namespace, session: Session) -> None:
    service = args.service_name
    session.print(SERVICES.type_line(service, session.named("service")))
    session.print(f"Clients count: {session.node.count_clients(service)}")
    session.print(f"Services count: {session.node.count_services(service)}")


VERBS = {
    **SERVICES.verbs(),
    "call": CALL,
    "echo": ECHO,
    "info": Verb("show the type of a service, and how many offer and use it", _info, GRAPH, SERVICES.name),
}
