"""QoS profiles as bags keep them: of recorded publishers, for publishers that play, and from a file of overrides."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

from rclpy.duration import Duration
from rclpy.qos import DurabilityPolicy, HistoryPolicy, LivelinessPolicy, QoSProfile, ReliabilityPolicy

if TYPE_CHECKING:
    from rosbags.interfaces import Qos, QosTime

INFINITE = (1 << 63) - 1  # nanoseconds
DEPTH = 1000  # messages that a playing publisher keeps for readers that are busy
DEEPEST = 2**31 - 1  # Fast DDS counts in 32 bits
LATCHED_DEPTH = 10  # messages that it keeps for who comes later
POLICIES: Mapping[str, Any] = {
    "history": HistoryPolicy,
    "reliability": ReliabilityPolicy,
    "durability": DurabilityPolicy,
    "liveliness": LivelinessPolicy,
}
DURATIONS = ("deadline", "lifespan", "liveliness_lease_duration")


def recorded(profile: QoSProfile) -> Qos:
    """A publisher's profile in the form in which rosbags writes it."""
    from rosbags.interfaces import Qos, QosDurability, QosHistory, QosLiveliness, QosReliability, QosTime

    def period(duration: Duration) -> QosTime:
        return QosTime(*divmod(duration.nanoseconds, 10**9))

    # Both count the policies as rmw does.
    return Qos(
        QosHistory(int(profile.history)),
        int(profile.depth),
        QosReliability(int(profile.reliability)),
        QosDurability(int(profile.durability)),
        period(profile.deadline),
        period(profile.lifespan),
        QosLiveliness(int(profile.liveliness)),
        period(profile.liveliness_lease_duration),
        bool(profile.avoid_ros_namespace_conventions),
    )


def to_offer(profiles: Sequence[Qos]) -> QoSProfile:
    """The profile with which to publish what publishers with these profiles have sent.

    As theirs if they agree, else reliable and volatile; its depth is our own, since the middleware does not tell
    that of others.
    """
    first = profiles[0] if profiles else None
    if first is None or any(profile._replace(depth=first.depth) != first for profile in profiles):
        return QoSProfile(depth=DEPTH)
    is_latched = first.durability.name == "TRANSIENT_LOCAL"
    is_best_effort, is_manual = first.reliability.name == "BEST_EFFORT", first.liveliness.name == "MANUAL_BY_TOPIC"
    return QoSProfile(
        depth=LATCHED_DEPTH if is_latched else DEPTH,
        reliability=ReliabilityPolicy.BEST_EFFORT if is_best_effort else ReliabilityPolicy.RELIABLE,
        durability=DurabilityPolicy.TRANSIENT_LOCAL if is_latched else DurabilityPolicy.VOLATILE,
        liveliness=LivelinessPolicy.MANUAL_BY_TOPIC if is_manual else LivelinessPolicy.AUTOMATIC,
        deadline=_duration(first.deadline),
        lifespan=_duration(first.lifespan),
        liveliness_lease_duration=_duration(first.liveliness_lease_duration),
    )


def _duration(period: QosTime) -> Duration:
    nanoseconds = period.sec * 10**9 + period.nsec
    return Duration(nanoseconds=0 if nanoseconds >= INFINITE else nanoseconds)


def overrides(described: Any) -> dict[str, QoSProfile]:
    """{topic: profile} from what a YAML file of overrides says. ValueError for what is no profile."""
    if not isinstance(described, Mapping) or not all(isinstance(value, Mapping) for value in described.values()):
        raise ValueError("The QoS overrides must map each topic to its policies, such as '/scan: {depth: 10}'.")
    return {str(topic): _profile(policies) for topic, policies in described.items()}


def _profile(policies: Mapping[str, Any]) -> QoSProfile:
    settings: dict[str, Any] = {}
    for key, value in policies.items():
        if key in DURATIONS:
            if not isinstance(value, Mapping) or not {"sec", "nsec"} <= value.keys():
                raise ValueError("Time overrides must include both seconds (sec) and nanoseconds (nsec).")
            if not all(isinstance(value[part], int) for part in ("sec", "nsec")):
                raise ValueError(f"sec and nsec of `{key}` are integers.")
            nanoseconds = value["sec"] * 10**9 + value["nsec"]
            if nanoseconds < 0:
                raise ValueError("Time duration may not be a negative value.")
            if nanoseconds > INFINITE:
                raise ValueError(f"`{key}` is longer than the longest duration, {INFINITE // 10**9} s.")
            settings[key] = Duration(nanoseconds=nanoseconds)
        elif key in POLICIES:
            try:
                settings[key] = POLICIES[key].get_from_short_key(str(value))
            except KeyError:
                raise ValueError(f"`{value}` is no value of `{key}`.") from None
        elif key in ("depth", "avoid_ros_namespace_conventions"):
            if not isinstance(value, int) or value < 0:
                raise ValueError(f"`{key}` may not be a negative value.")
            if value > DEEPEST:
                raise ValueError(f"`{key}` is at most {DEEPEST}.")
            settings[key] = value
        else:
            raise ValueError(f"Unexpected key `{key}` for QoS profile.")
    try:
        return QoSProfile(**settings)
    except Exception as error:  # rclpy's InvalidQoSProfileException, and what wrong combinations raise
        raise ValueError(str(error)) from None
