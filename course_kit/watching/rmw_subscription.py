"""A subscription that speaks to rmw, the layer below rcl and rclpy, in C.

It takes what rclpy does not give: topics outside ROS's naming rules, such as the middleware's own
`ros_discovery_info` (rclpy puts a slash before every name), and which publisher sent a message. What comes is taken by
polling: it is meant for a few messages a second.
"""

from __future__ import annotations

import ctypes
from ctypes import POINTER, byref, c_bool, c_char_p, c_int, c_int64, c_size_t, c_uint8, c_uint64, c_void_p
from dataclasses import dataclass
from typing import Any

import rclpy
from rclpy.node import Node

RMW_RET_OK = 0
KEEP_LAST, RELIABLE, TRANSIENT_LOCAL, AUTOMATIC = 1, 1, 1, 1  # of rmw/types.h
GID_SIZE = 16  # bytes of an endpoint's id


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
    )


class _SubscriptionOptions(ctypes.Structure):
    _fields_ = (
        ("rmw_specific_subscription_payload", c_void_p),
        ("ignore_local_publications", c_bool),
        ("require_unique_network_flow_endpoints", c_int),
        ("content_filter_options", c_void_p),
    )


class _Allocator(ctypes.Structure):
    _fields_ = tuple((name, c_void_p) for name in ("allocate", "deallocate", "reallocate", "zero_allocate", "state"))


class _SerializedMessage(ctypes.Structure):
    _fields_ = (
        ("buffer", c_void_p),
        ("buffer_length", c_size_t),
        ("buffer_capacity", c_size_t),
        ("allocator", _Allocator),
    )


class _Gid(ctypes.Structure):
    _fields_ = (("implementation_identifier", c_char_p), ("data", c_uint8 * GID_SIZE))


class _MessageInfo(ctypes.Structure):
    _fields_ = (
        ("source_timestamp", c_int64),
        ("received_timestamp", c_int64),
        ("publication_sequence_number", c_uint64),
        ("reception_sequence_number", c_uint64),
        ("publisher_gid", _Gid),
        ("from_intra_process", c_bool),
    )


@dataclass(frozen=True)
class Sample:
    """One message, serialised; when it was received (nanoseconds), and the id of its publisher."""

    data: bytes
    received: int
    publisher: bytes


def is_fast_dds() -> bool:
    """Whether the middleware is Fast DDS: what stands here about ids and announcements is true of it."""
    return rclpy.get_rmw_implementation_identifier().startswith("rmw_fastrtps")


def _function(library: str, name: str, result: Any, *arguments: Any) -> Any:
    # The libraries are loaded already, rclpy stands on them: this finds them by name.
    function = getattr(ctypes.CDLL(library), name)
    function.restype, function.argtypes = result, list(arguments)
    return function


class SerializedSubscription:
    """A reliable, transient local subscription to the topic `name`, exactly so spelt: `rt/rosout` is /rosout.

    The type is named by its package and its name, and its Python class is not loaded: those with arrays take 0.1 s.
    Close it before its node is destroyed. Raises RuntimeError if the middleware refuses it.
    """

    def __init__(self, node: Node, name: str, package: str, message: str, depth: int) -> None:
        rmw_node = _function("librcl.so", "rcl_node_get_rmw_handle", c_void_p, c_void_p)
        middleware = f"lib{rclpy.get_rmw_implementation_identifier()}.so"
        create = _function(middleware, "rmw_create_subscription", c_void_p, *[c_void_p] * 2, c_char_p, *[c_void_p] * 2)
        options = _function("librmw.so", "rmw_get_default_subscription_options", _SubscriptionOptions)()
        self._destroy = _function(middleware, "rmw_destroy_subscription", c_int, c_void_p, c_void_p)
        self._take = _function(
            middleware,
            "rmw_take_serialized_message_with_info",
            c_int,
            c_void_p,
            POINTER(_SerializedMessage),
            POINTER(c_bool),
            POINTER(_MessageInfo),
            c_void_p,
        )
        allocator = _function("librcutils.so", "rcutils_get_default_allocator", _Allocator)()
        self._message = _SerializedMessage(None, 0, 0, allocator)
        self._finish_message = _function(
            "librcutils.so", "rcutils_uint8_array_fini", c_int, POINTER(_SerializedMessage)
        )
        self._node_handle = node.handle
        with self._node_handle:
            self._rmw_node = rmw_node(self._node_handle.pointer)
        forever = _Time(9223372036, 854775807)
        qos = _QosProfile(KEEP_LAST, depth, RELIABLE, TRANSIENT_LOCAL, forever, forever, AUTOMATIC, forever, True)
        support = _function(
            f"lib{package}__rosidl_typesupport_c.so",
            f"rosidl_typesupport_c__get_message_type_support_handle__{package}__msg__{message}",
            c_void_p,
        )()
        self._subscription = create(self._rmw_node, support, name.encode(), byref(qos), byref(options))
        if not self._subscription:
            raise RuntimeError(f"the middleware refuses a subscription to {name}")

    def take(self) -> Sample | None:
        """The next message; None if there is none."""
        if not self._subscription:
            return None
        taken, info = c_bool(), _MessageInfo()
        status = self._take(self._subscription, byref(self._message), byref(taken), byref(info), None)
        if status != RMW_RET_OK or not taken.value:
            return None
        data = ctypes.string_at(self._message.buffer, self._message.buffer_length)
        return Sample(data, info.received_timestamp, bytes(info.publisher_gid.data))

    def close(self) -> None:
        """End the subscription. Safe to call twice."""
        if self._subscription:
            with self._node_handle:
                self._destroy(self._rmw_node, self._subscription)
            self._finish_message(byref(self._message))
            self._subscription = None
