"""The parts that verbs of `ros2 topic` share: a topic's full name and type, and the QoS options."""

from __future__ import annotations

import copy
import time
from argparse import Namespace
from collections.abc import Sequence
from contextlib import AbstractContextManager
from typing import TYPE_CHECKING, Any

from course_kit.cli.ros2.session import Session, log_text
from course_kit.cli.ros2.verbs import (
    LONGEST,
    Arguments,
    CommandError,
    all_of,
    argument,
    did_you_mean,
    failing,
    number,
    one_line,
)

if TYPE_CHECKING:
    from rclpy.qos import QoSProfile
    from rclpy.topic_endpoint_info import TopicEndpointInfo

# As rclpy has them; written out so that a command line is parsed without it.
PROFILES = (
    "unknown",
    "default",
    "system_default",
    "sensor_data",
    "services_default",
    "parameters",
    "parameter_events",
    "action_status_default",
    "best_available",
)
HISTORIES = ("system_default", "keep_last", "keep_all", "unknown")
RELIABILITIES = ("system_default", "reliable", "best_effort", "unknown", "best_available")
DURABILITIES = ("system_default", "transient_local", "volatile", "unknown", "best_available")
LIVELINESSES = ("system_default", "automatic", "manual_by_topic", "unknown", "best_available")

# Fast DDS counts them in 32 bits. What is 0 or less, the real command takes for the preset's.
_depth = number(int, lambda value: True, "invalid int value: {!r}", 2**31 - 1)
_lease = number(float, lambda value: True, "invalid float value: {!r}", LONGEST)

POLICIES: dict[str, dict[str, Any]] = {
    "depth": {"metavar": "N", "type": _depth, "help": "the depth of the queue, in messages"},
    "history": {"choices": HISTORIES, "help": "which messages are kept: the last ones or all"},
    "reliability": {"choices": RELIABILITIES, "help": "whether lost messages are sent again"},
    "durability": {"choices": DURABILITIES, "help": "whether late subscriptions get earlier messages"},
    "liveliness": {"choices": LIVELINESSES, "help": "who asserts that the publisher is alive"},
    "liveliness-lease-duration-seconds": {
        "type": _lease,
        "help": "the seconds after which a silent publisher counts as dead",
    },
}


def qos_options(default: str) -> Arguments:
    """The --qos-… options; `default` is the name of a profile."""
    about = f"the preset that the other --qos- options change (default: {default})"
    preset = argument("--qos-profile", about, choices=PROFILES, default=default)
    return all_of(preset, *(argument(f"--qos-{policy}", **settings) for policy, settings in POLICIES.items()))


def is_chosen(args: Namespace) -> bool:
    """Return True if the command line names a policy, so that the QoS does not follow the publishers."""
    return any(getattr(args, f"qos_{policy.replace('-', '_')}") is not None for policy in POLICIES)


def chosen(args: Namespace) -> QoSProfile:
    """The profile of the command line: the preset, with the policies that are named."""
    from rclpy.duration import Duration
    from rclpy.qos import DurabilityPolicy, QoSPresetProfiles

    from course_kit.lab.bags import qos as bag_qos

    named = {policy: getattr(args, f"qos_{policy}") for policy in bag_qos.POLICIES}
    if "unknown" in (args.qos_profile, *named.values()):
        raise CommandError("The QoS 'unknown' is one that endpoints are described with, none that can be asked for")
    # A profile of one's own: the presets are shared by the whole process, in a notebook with the student's nodes.
    profile: QoSProfile = copy.copy(QoSPresetProfiles.get_from_short_key(args.qos_profile))
    for policy, value in named.items():
        if value:
            setattr(profile, policy, bag_qos.POLICIES[policy].get_from_short_key(value))
    if (args.qos_liveliness_lease_duration_seconds or 0) > 0:
        profile.liveliness_lease_duration = Duration(seconds=args.qos_liveliness_lease_duration_seconds)
    if (args.qos_depth or 0) > 0:
        profile.depth = args.qos_depth
    elif profile.durability == DurabilityPolicy.TRANSIENT_LOCAL and profile.depth == 0:
        profile.depth = 1
    return profile


def mixed_offers(published: Sequence[TopicEndpointInfo]) -> list[str]:
    """What echo says when publishers of one topic differ, so that it asks for less than some of them offer."""
    from rclpy.qos import DurabilityPolicy, ReliabilityPolicy

    reliable = {p.qos_profile.reliability == ReliabilityPolicy.RELIABLE for p in published}
    latched = {p.qos_profile.durability == DurabilityPolicy.TRANSIENT_LOCAL for p in published}
    line = "Some, but not all, publishers are offering {0}. Falling back to {1} as it will connect to all publishers"
    lines = []
    if len(reliable) == 2:
        lines.append(line.format("QoSReliabilityPolicy.RELIABLE", "QoSReliabilityPolicy.BEST_EFFORT"))
    if len(latched) == 2:
        lines.append(line.format("QoSDurabilityPolicy.TRANSIENT_LOCAL", "QoSDurabilityPolicy.VOLATILE"))
    return lines


def full_name(topic: str) -> str:
    """The full name of a topic. Raises CommandError for what cannot be one."""
    from course_kit.ros.subscriptions import topics

    with failing(ValueError):
        return topics.absolute(topic)


def type_of(session: Session, topic: str, waits: bool) -> str:
    """The type of a topic, with the real command's warning if nobody has it yet. CommandError if it has several.

    With `waits` those who publish it decide, and one who has it is waited for.
    """
    from course_kit.ros.subscriptions import topics

    name, node = full_name(topic), session.graph()
    known = dict(node.get_topic_names_and_types())
    if name not in known:
        session.print(f"WARNING: topic [{topic}] does not appear to be published yet")
        if not waits:
            raise CommandError("Could not determine the type for the passed topic", did_you_mean(name, known))
        while name not in (known := dict(session.node.get_topic_names_and_types())):
            session.sleep(0.05)
    types = sorted({p.topic_type for p in topics.publishers(node, name)} if waits else ()) or known[name]
    if len(types) > 1:
        raise CommandError(f"Cannot echo topic '{topic}', as it contains more than one type: [{', '.join(types)}]")
    return types[0]


def refused(topic: str) -> AbstractContextManager[None]:
    """A publisher or subscription that the middleware does not make is a failure of the verb."""
    # rclpy has several exceptions for that.
    return failing(Exception, say=lambda error: f"Cannot create an endpoint on the topic '{topic}': {one_line(error)}")


def incompatible(node_name: str, topic: str, policy_kind: Any, is_publisher: bool) -> str:
    """The line that rclpy logs when an endpoint on the other side asks for more than is offered."""
    from rclpy.qos import qos_policy_name_from_kind

    who, what, way = (
        ("subscription", "requesting", "sent to") if is_publisher else ("publisher", "offering", "received from")
    )
    text = (
        f"New {who} discovered on topic '{topic}', {what} incompatible QoS. No messages will be {way} it. "
        f"Last incompatible policy: {qos_policy_name_from_kind(policy_kind)}"
    )
    return log_text("WARN", node_name, text, time.time_ns())
