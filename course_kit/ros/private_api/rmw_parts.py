"""A subscription that speaks to rmw, the layer below rcl and rclpy, in C.

It takes what rclpy does not give: topics outside ROS's naming rules, such as the middleware's own
`ros_discovery_info` (rclpy puts a slash before every name), and which publisher sent a message. What comes is taken by
polling: it is meant for a few messages a second.

In C nothing says that a structure has changed, and a wrong one ends the process. So it is used only with the series of
rmw, rcl and rcutils whose headers stand below, which ROS keeps within a distribution; every structure has room behind
it; and what comes back is compared with what it must be before it is relied on.
"""

from __future__ import annotations

import ctypes
from ctypes import POINTER, byref, c_bool, c_char_p, c_int, c_int64, c_size_t, c_uint8, c_uint64, c_void_p
from dataclasses import dataclass
from typing import Any

import rclpy
from rclpy.node import Node

from course_kit.ros.private_api import NotAsExpected, expect, package_version
from course_kit.ros.private_api.fastdds_parts import GID_SIZE

SERIES = {"rmw": "7.3.", "rcl": "9.2.", "rcutils": "6.7."}  # of Jazzy
RMW_RET_OK = 0
KEEP_LAST, RELIABLE, TRANSIENT_LOCAL, AUTOMATIC = 1, 1, 1, 1  # of rmw/types.h
ROOM = 1024  # bytes of a message, to begin with
SPARE = c_uint8 * 256  # were a structure larger than it stands here, this much of it would still be ours


def request_topic(service: str) -> str:
    """The topic below ROS's names that carries the requests to a service."""
    return f"rq{service}Request"


def service_topics(service: str) -> tuple[str, str]:
    """The topics below ROS's names that carry a service's requests and responses."""
    return request_topic(service), f"rr{service}Reply"


def action_topics(action: str) -> tuple[str, ...]:
    """The topics below ROS's names that carry an action: goals, results, requests to cancel, feedback."""
    calls = (service_topics(f"{action}/_action/{call}") for call in ("send_goal", "get_result", "cancel_goal"))
    return (*(topic for both in calls for topic in both), f"rt{action}/_action/feedback")


class _Time(ctypes.Structure):
    _fields_ = (("sec", c_uint64), ("nsec", c_uint64))


class _QosProfile(ctypes.Structure):
    _fields_ = (
        ("history", c_int),
        ("depth", c_size_t),
        ("reliability", c_int),
        ("durability", c_int),
        ("deadline", _Time),
        ("lifespan", _Time),
        ("liveliness", c_int),
        ("liveliness_lease_duration", _Time),
        ("avoid_ros_namespace_conventions", c_bool),
        ("spare", SPARE),
    )


_PLAIN_OPTIONS = (
    ("rmw_specific_subscription_payload", c_void_p),
    ("ignore_local_publications", c_bool),
    ("require_unique_network_flow_endpoints", c_int),
    ("content_filter_options", c_void_p),
)


class _SubscriptionOptions(ctypes.Structure):
    _fields_ = (*_PLAIN_OPTIONS, ("spare", SPARE))


class _Allocator(ctypes.Structure):
    _fields_ = tuple((name, c_void_p) for name in ("allocate", "deallocate", "reallocate", "zero_allocate", "state"))


class _SerializedMessage(ctypes.Structure):
    _fields_ = (
        ("buffer", c_void_p),
        ("buffer_length", c_size_t),
        ("buffer_capacity", c_size_t),
        ("allocator", _Allocator),
        ("spare", SPARE),
    )


class _Gid(ctypes.Structure):
    _fields_ = (("implementation_identifier", c_void_p), ("data", c_uint8 * GID_SIZE))


class _MessageInfo(ctypes.Structure):
    _fields_ = (
        ("source_timestamp", c_int64),
        ("received_timestamp", c_int64),
        ("publication_sequence_number", c_uint64),
        ("reception_sequence_number", c_uint64),
        ("publisher_gid", _Gid),
        ("from_intra_process", c_bool),
        ("spare", SPARE),
    )


@dataclass(frozen=True)
class Sample:
    """One message, serialised; when it was received (nanoseconds), and the id of its publisher."""

    data: bytes
    received: int
    publisher: bytes


def is_fast_dds() -> bool:
    """Return True if the middleware is Fast DDS: what stands here about ids and announcements is true of it."""
    return rclpy.get_rmw_implementation_identifier().startswith("rmw_fastrtps")


def _function(library: str, name: str, result: Any, *arguments: Any) -> Any:
    # The libraries are loaded already, rclpy stands on them: this finds them by name.
    try:
        function = getattr(ctypes.CDLL(library), name)
    except (OSError, AttributeError):
        raise NotAsExpected(f"{library} has no {name} here") from None
    function.restype, function.argtypes = result, list(arguments)
    return function


def _expect(holds: Any, what: str) -> None:
    if not holds:
        raise NotAsExpected(f"{rclpy.get_rmw_implementation_identifier()} has another {what} here")


def _check_series() -> None:
    for package, series in SERIES.items():
        version = package_version(package)
        if not version.startswith(series):
            raise NotAsExpected(
                f"{package} {version or 'of an unknown version'} is here, the C structures known are those of {series}x"
            )


def _empty_message() -> tuple[_SerializedMessage, Any]:
    """A message for the middleware to fill, and the function that frees it."""
    array = POINTER(_SerializedMessage)
    allocator = _function("librcutils.so", "rcutils_get_default_allocator", _Allocator)()
    begin = _function("librcutils.so", "rcutils_uint8_array_init", c_int, array, c_size_t, POINTER(_Allocator))
    message = _SerializedMessage()
    status = begin(byref(message), ROOM, byref(allocator))
    sizes = (message.buffer_length, message.buffer_capacity)
    is_known = bytes(message.allocator) == bytes(allocator) and message.buffer and not any(message.spare)
    _expect(status == RMW_RET_OK and sizes == (0, ROOM) and is_known, "rmw_serialized_message_t")
    return message, _function("librcutils.so", "rcutils_uint8_array_fini", c_int, array)


class _Take:
    """Takes messages of a subscription of the middleware, with who sent them. Raises NotAsExpected."""

    def __init__(self) -> None:
        _check_series()
        middleware = f"lib{rclpy.get_rmw_implementation_identifier()}.so"
        taken = (POINTER(structure) for structure in (_SerializedMessage, c_bool, _MessageInfo))
        self._take = _function(middleware, "rmw_take_serialized_message_with_info", c_int, c_void_p, *taken, c_void_p)
        self._identifier = _function(middleware, "rmw_get_implementation_identifier", c_void_p)()
        self._message, self._finish_message = _empty_message()

    def expect_own(self, structure: int | None, what: str) -> None:
        """The middleware's structures begin with the address of its name."""
        _expect(bool(structure) and c_void_p.from_address(structure or 0).value == self._identifier, what)

    def take(self, subscription: int) -> Sample | None:
        """The next message of the subscription at this address; None if there is none."""
        taken, info = c_bool(), _MessageInfo()
        status = self._take(subscription, byref(self._message), byref(taken), byref(info), None)
        if status != RMW_RET_OK or not taken.value:
            return None
        _expect(info.publisher_gid.implementation_identifier == self._identifier, "rmw_message_info_t")
        is_whole = bool(self._message.buffer) and self._message.buffer_length <= self._message.buffer_capacity
        _expect(is_whole, "rmw_serialized_message_t")
        data = ctypes.string_at(self._message.buffer, self._message.buffer_length)
        return Sample(data, info.received_timestamp, bytes(info.publisher_gid.data))

    def close(self) -> None:
        """Free what it takes messages into."""
        self._finish_message(byref(self._message))


class SenderTaker:
    """Takes the messages of one of rclpy's subscriptions, and says who sent each. Raises NotAsExpected.

    `handle` is that of the subscription; whoever calls take() keeps it in use meanwhile.
    """

    def __init__(self, handle: Any) -> None:
        self._taking = _Take()
        expect("rclpy", handle, "pointer")
        with handle:
            of_rcl = _function("librcl.so", "rcl_subscription_get_rmw_handle", c_void_p, c_void_p)
            self._subscription: int = of_rcl(handle.pointer)
        self._taking.expect_own(self._subscription, "rmw_subscription_t")

    def take(self) -> tuple[bytes, dict[str, Any]] | None:
        """The next message and what rclpy would say of it, with its `publisher`; None if there is none."""
        sample = self._taking.take(self._subscription)
        if sample is None:
            return None
        return sample.data, {"received_timestamp": sample.received, "publisher": sample.publisher}

    def close(self) -> None:
        """Free what it takes messages into."""
        self._taking.close()


class SerializedSubscription:
    """A reliable, transient local subscription to the topic `name`, exactly so spelt: `rt/rosout` is /rosout.

    The type is named by its package and its name, and its Python class is not loaded: those with arrays take 0.1 s.
    Close it before its node is destroyed. Raises NotAsExpected if the middleware is one that this cannot speak to.
    """

    def __init__(self, node: Node, name: str, package: str, message: str, depth: int) -> None:
        self._subscription: int | None = None
        self._taking = _Take()
        middleware = f"lib{rclpy.get_rmw_implementation_identifier()}.so"
        create = _function(middleware, "rmw_create_subscription", c_void_p, *[c_void_p] * 2, c_char_p, *[c_void_p] * 2)
        actual_qos = _function(middleware, "rmw_subscription_get_actual_qos", c_int, c_void_p, c_void_p)
        self._destroy = _function(middleware, "rmw_destroy_subscription", c_int, c_void_p, c_void_p)
        default = _function("librmw.so", "rmw_get_default_subscription_options", _SubscriptionOptions)()
        _expect(not any(getattr(default, name) for name, _ in _PLAIN_OPTIONS), "rmw_subscription_options_t")
        options = _SubscriptionOptions()  # the same, and nothing in the room behind it
        support = _function(
            f"lib{package}__rosidl_typesupport_c.so",
            f"rosidl_typesupport_c__get_message_type_support_handle__{package}__msg__{message}",
            c_void_p,
        )()
        self._node_handle = node.handle
        expect("rclpy", self._node_handle, "pointer")
        with self._node_handle:
            rmw_node = _function("librcl.so", "rcl_node_get_rmw_handle", c_void_p, c_void_p)
            self._rmw_node = rmw_node(self._node_handle.pointer)
        self._taking.expect_own(self._rmw_node, "rmw_node_t")
        forever = _Time(9223372036, 854775807)
        qos = _QosProfile(KEEP_LAST, depth, RELIABLE, TRANSIENT_LOCAL, forever, forever, AUTOMATIC, forever, True)
        made = create(self._rmw_node, support, name.encode(), byref(qos), byref(options))
        if not made:
            _function("librcutils.so", "rcutils_reset_error", None)()
            raise NotAsExpected(f"{rclpy.get_rmw_implementation_identifier()} refuses a subscription to {name} here")
        self._taking.expect_own(made, "rmw_subscription_t")
        self._subscription = made
        actual = _QosProfile()
        status = actual_qos(made, byref(actual))
        told = (actual.history, actual.depth, actual.reliability, actual.durability)
        if status != RMW_RET_OK or told != (KEEP_LAST, depth, RELIABLE, TRANSIENT_LOCAL) or any(actual.spare):
            self.close()
            _expect(False, "rmw_qos_profile_t")

    def take(self) -> Sample | None:
        """The next message; None if there is none. Raises NotAsExpected."""
        return self._taking.take(self._subscription) if self._subscription else None

    def close(self) -> None:
        """End the subscription. Safe to call twice."""
        if self._subscription:
            with self._node_handle:
                self._destroy(self._rmw_node, self._subscription)
            self._taking.close()
            self._subscription = None
