"""`ros2 service info`: the type, how many use and offer it, and with -v who they are.

rclpy of Jazzy has no question for the ends of a service: they are those of its two topics below ROS's names, the
requests' and the responses'. What is printed of each is what later releases of ROS print.
"""

from __future__ import annotations

from argparse import Namespace
from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING

from course_kit.cli.ros2.named import SERVICES
from course_kit.cli.ros2.session import Session
from course_kit.cli.ros2.verbs import GRAPH, Verb, flag

if TYPE_CHECKING:
    from rclpy.node import Node
    from rclpy.qos import QoSProfile
    from rclpy.topic_endpoint_info import TopicEndpointInfo

# What an end is called, then its two endpoints in the order in which they are shown.
CLIENT, SERVER = ("CLIENT", "Request Writer", "Response Reader"), ("SERVER", "Request Reader", "Response Writer")


def _info(args: Namespace, session: Session) -> None:
    service, end = args.service_name, "\n\n" if args.verbose else "\n"
    session.print(SERVICES.type_line(service, session.named("service")))
    node = session.node
    for heading, count, kind in (("Clients", node.count_clients, CLIENT), ("Services", node.count_services, SERVER)):
        session.print(f"{heading} count: {count(service)}", end=end)
        for requests, responses in _ends(node, service, kind) if args.verbose else ():
            session.print(_described(requests, responses, kind), end=end)


def _ends(node: Node, service: str, kind: Sequence[str]) -> Iterator[tuple[TopicEndpointInfo, TopicEndpointInfo]]:
    """The endpoint for requests and that for responses of each client or server."""
    from course_kit.ros.private_api.rmw_parts import service_topics

    requests, responses = service_topics(service)
    writers, readers = node.get_publishers_info_by_topic, node.get_subscriptions_info_by_topic
    of_requests, of_responses = (writers, readers) if kind is CLIENT else (readers, writers)
    # A node makes both endpoints of a client together, and the middleware numbers them as they are made.
    left = sorted(of_responses(responses, True), key=lambda info: info.endpoint_gid)
    for one in sorted(of_requests(requests, True), key=lambda info: info.endpoint_gid):
        other = next((info for info in left if _owner(info) == _owner(one)), None)
        if other is not None:  # else it comes or goes this moment
            left.remove(other)
            yield one, other


def _owner(info: TopicEndpointInfo) -> tuple[str, str, tuple[int, ...]]:
    from course_kit.ros.private_api.fastdds_parts import PARTICIPANT_SIZE

    return info.node_name, info.node_namespace, tuple(info.endpoint_gid[:PARTICIPANT_SIZE])


def _described(requests: TopicEndpointInfo, responses: TopicEndpointInfo, kind: Sequence[str]) -> str:
    what, first, second = kind
    service_type = requests.topic_type.removesuffix("_Request_").replace("::dds_::", "/").replace("::", "/")
    lines = [
        f"Node name: {requests.node_name}",
        f"Node namespace: {requests.node_namespace}",
        f"Service type: {service_type}",
        f"Service type hash: {_type_hash(service_type, str(requests.topic_type_hash))}",
        f"Endpoint type: {what}",
        "Endpoint count: 2",
        "GIDs:",
    ]
    both = {first: requests, second: responses}
    lines += [f" - {name} : {'.'.join(f'{part:02x}' for part in info.endpoint_gid)}" for name, info in both.items()]
    lines.append("QoS profiles:")
    for name, info in both.items():
        lines += [f" - {name} :", *_qos(info.qos_profile)]
    return "\n".join(lines)


def _type_hash(service_type: str, of_requests: str) -> str:
    """The hash of the installed type. Nodes tell that of its requests: if theirs is another, so is the type."""
    from course_kit.lab.bags.types import type_hash

    return type_hash(service_type) if of_requests == type_hash(service_type, "_Request") else "INVALID"


def _qos(profile: QoSProfile) -> list[str]:
    values = {
        "Reliability": profile.reliability.name,
        "History (Depth)": f"{profile.history.name} ({profile.depth})",
        "Durability": profile.durability.name,
        "Lifespan": profile.lifespan,
        "Deadline": profile.deadline,
        "Liveliness": profile.liveliness.name,
        "Liveliness lease duration": profile.liveliness_lease_duration,
    }
    return [f"      {name}: {value}" for name, value in values.items()]


INFO = Verb(
    "show the type of a service, and the number of its servers and clients",
    _info,
    GRAPH,
    SERVICES.name,
    flag("--verbose -v", "show node, type and QoS of each"),
)
