"""`ros2 doctor`, alias `ros2 wtf`: checks of this machine, the packages and the graph, and a report of what is there.

Nothing of these uses the network, as `hello` does: the newest versions of packages, which the real command looks up,
are left out.
"""

from __future__ import annotations

import os
from argparse import Namespace
from collections import defaultdict
from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

from course_kit.cli.ros2.doctor import checks, report
from course_kit.cli.ros2.doctor.checks import Pair, System, Topic
from course_kit.cli.ros2.session import Session
from course_kit.cli.ros2.verbs import Verb, flag, one_of
from course_kit.ros import packages
from course_kit.ros.private_api import package_version

if TYPE_CHECKING:
    from rclpy.node import Node


def _doctor(args: Namespace, session: Session) -> None:
    system = _look(session)
    modules = [name for name in checks.CHECKS if name != "package" or not args.exclude_packages]
    if not args.report:
        findings = {name: list(checks.CHECKS[name](system)) for name in modules}
        for finding in dict.fromkeys(finding for found in findings.values() for finding in found):
            session.warn(f"UserWarning: {finding}")
        modules = checks.failed(findings, args.include_warnings)
        session.print(checks.summary(len(findings), modules))
    if args.report or args.report_failed:
        for section in report.sections(system, modules):
            session.print(section)


def _look(session: Session) -> System:
    """Everything that the checks and the report are about."""
    from rclpy.utilities import get_rmw_implementation_identifier

    node = session.graph()
    versions = {name: package_version(name) for name in packages.package_names()}
    topics = list(_topics(node))
    return System(
        interfaces=list(interfaces()),
        packages=versions,
        distro=_distro(versions),
        middleware=get_rmw_implementation_identifier(),
        topics=topics,
        pairs=[pair for topic in topics for pair in _pairs(node, topic.name)],
    )


def interfaces() -> Iterator[dict[str, Any]]:
    """What is reported of each network interface, by the name of the property."""
    import socket

    import psutil  # type: ignore[import-untyped]

    stats = psutil.net_if_stats()
    for name, addresses in psutil.net_if_addrs().items():
        of: dict[int, list[Any]] = defaultdict(list)
        for address in addresses:
            of[address.family].append(address)
        inet, stat = of[socket.AF_INET], stats.get(name)
        ether = [a.address for a in of[psutil.AF_LINK] if a.address != "00:00:00:00:00:00"]
        properties = {
            "inet": inet[-1].address if inet else None,
            "inet4": [a.address for a in inet],
            "ether": ether[-1] if ether else None,
            "inet6": [a.address for a in of[socket.AF_INET6]],
            "netmask": inet[-1].netmask if inet else None,
            "device": name,
            "flags": stat.flags.upper() if stat else None,
            "mtu": stat.mtu if stat else None,
            "broadcast": inet[-1].broadcast if inet else None,
        }
        yield {key: value for key, value in properties.items() if value}


def _distro(versions: dict[str, str]) -> str:
    """The name of the ROS 2 distribution; empty if nothing tells."""
    named = os.environ.get("ROS_DISTRO", "").lower()
    series = ".".join(versions.get("rclpy", "").split(".")[:2])
    return named or checks.RCLPY_VERSIONS.get(series, "")


def _topics(node: Node) -> Iterator[Topic]:
    from course_kit.ros.graph import graph

    for name in graph.topics(node, with_hidden=True):
        if name not in checks.PARTNERLESS:
            yield Topic(name, node.count_publishers(name), node.count_subscribers(name))


def _pairs(node: Node, topic: str) -> Iterator[Pair]:
    from rclpy.qos import qos_check_compatible

    subscriptions = node.get_subscriptions_info_by_topic(topic)
    for publisher in node.get_publishers_info_by_topic(topic):
        for subscription in subscriptions:
            _, reason = qos_check_compatible(publisher.qos_profile, subscription.qos_profile)
            yield Pair(topic, publisher.topic_type, publisher.node_name, subscription.node_name, reason)


COMMAND = Verb(
    "check this machine, the packages and the graph",
    _doctor,
    one_of(
        flag("--report -r", "print everything that the checks look at, in place of the checks"),
        flag("--report-failed -rf", "print everything that the failed checks look at"),
    ),
    flag("--exclude-packages -ep", "leave the packages out"),
    flag("--include-warnings -iw", "count warnings as failures"),
)
VERBS = {"hello": "doctor.hello:HELLO"}
