"""What `ros2 topic echo` and `pub` share: the topic's full name, the QoS options and the profiles they stand for."""

from __future__ import annotations

import copy
import time
from argparse import ArgumentParser, Namespace
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

from course_kit.ros2.verbs import CommandError

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


def add_qos_arguments(parser: ArgumentParser, purpose: str, default: str) -> None:
    """Add the --qos-… options; `purpose` is subscribe or publish, `default` the name of a profile."""
    parser.add_argument(
        "--qos-profile",
        choices=PROFILES,
        default=default,
        help=f"Quality of service preset profile to {purpose} with (default: {default})",
    )
    parser.add_argument(
        "--qos-depth",
        metavar="N",
        type=int,
        help=f"Queue size setting to {purpose} with (overrides depth value of --qos-profile option)",
    )
    overridden = "(overrides {0} value of --qos-profile option{1})"
    followed = ", default: Compatible profile with running endpoints "
    for policy, choices, setting, note in (
        ("history", HISTORIES, "History of samples setting", ", default: keep_last"),
        ("reliability", RELIABILITIES, "Quality of service reliability setting", followed),
        ("durability", DURABILITIES, "Quality of service durability setting", followed),
        ("liveliness", LIVELINESSES, "Quality of service liveliness setting", ""),
    ):
        about = f"{setting} to {purpose} with {overridden.format(policy, note)}"
        parser.add_argument(f"--qos-{policy}", choices=choices, help=about)
    parser.add_argument(
        "--qos-liveliness-lease-duration-seconds",
        type=float,
        help=f"Quality of service liveliness lease duration setting to {purpose} with "
        f"{overridden.format('liveliness lease duration', '')}",
    )


def is_chosen(args: Namespace) -> bool:
    """Whether the command line names a policy, so that the QoS does not follow the publishers."""
    policies = ("depth", "history", "reliability", "durability", "liveliness", "liveliness_lease_duration_seconds")
    return any(getattr(args, f"qos_{policy}") is not None for policy in policies)


def chosen(args: Namespace) -> QoSProfile:
    """The profile of the command line: the preset, with the policies that are named."""
    from rclpy.duration import Duration
    from rclpy.qos import DurabilityPolicy, HistoryPolicy, LivelinessPolicy, QoSPresetProfiles, ReliabilityPolicy

    named = (args.qos_profile, args.qos_history, args.qos_reliability, args.qos_durability, args.qos_liveliness)
    if "unknown" in named:
        raise CommandError("The QoS 'unknown' is one that endpoints are described with, none that can be asked for")
    # A profile of one's own: the presets are shared by the whole process, in a notebook with the student's nodes.
    profile: QoSProfile = copy.copy(QoSPresetProfiles.get_from_short_key(args.qos_profile))
    if args.qos_history:
        profile.history = HistoryPolicy.get_from_short_key(args.qos_history)
    if args.qos_durability:
        profile.durability = DurabilityPolicy.get_from_short_key(args.qos_durability)
    if args.qos_reliability:
        profile.reliability = ReliabilityPolicy.get_from_short_key(args.qos_reliability)
    if args.qos_liveliness:
        profile.liveliness = LivelinessPolicy.get_from_short_key(args.qos_liveliness)
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


def positive_float(text: str) -> float:
    """A type of argparse, whose message names the function."""
    value = float(text)
    if value <= 0:
        raise ValueError
    return value


def full_name(topic: str) -> str:
    """The full name of a topic. Raises CommandError for what cannot be one."""
    from course_kit.watching import topics

    try:
        return topics.absolute(topic)
    except ValueError as error:
        raise CommandError(str(error)) from None


def refused(error: Exception, topic: str) -> CommandError:
    """The one line for a publisher or subscription that the middleware does not make."""
    reason = " ".join(str(error).split()) or type(error).__name__
    return CommandError(f"Cannot create an endpoint on the topic '{topic}': {reason}")


def incompatible(node_name: str, topic: str, policy_kind: Any, is_publisher: bool) -> str:
    """The line that rclpy logs when an endpoint on the other side asks for more than is offered."""
    from rclpy.qos import qos_policy_name_from_kind

    seconds, nanoseconds = divmod(time.time_ns(), 10**9)
    policy = qos_policy_name_from_kind(policy_kind)
    happened = (
        f"New subscription discovered on topic '{topic}', requesting incompatible QoS. No messages will be sent to it."
        if is_publisher
        else f"New publisher discovered on topic '{topic}', offering incompatible QoS. "
        f"No messages will be received from it."
    )
    return f"[WARN] [{seconds}.{nanoseconds:09}] [{node_name}]: {happened} Last incompatible policy: {policy}"
