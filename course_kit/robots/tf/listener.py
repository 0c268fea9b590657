"""TransformListener of tf2_ros: fills a buffer with what comes on /tf and /tf_static."""

from __future__ import annotations

import contextlib
from collections.abc import Iterator
from threading import Thread

from rclpy.callback_groups import ReentrantCallbackGroup
from rclpy.exceptions import InvalidHandle
from rclpy.executors import ExternalShutdownException, SingleThreadedExecutor
from rclpy.node import Node
from rclpy.qos import QoSProfile
from rclpy.subscription import Subscription
from tf2_msgs.msg import TFMessage

from course_kit.robots.tf.broadcasters import TF, TF_STATIC, kept_qos
from course_kit.robots.tf.buffer import Buffer

AUTHORITY = "default_authority"  # rclpy does not tell who has sent a message
PAUSE = 1.0  # seconds between two looks whether the node still listens
DEPTH = 100  # messages that may wait


class TransformListener:
    """Has a node listen for transforms, and puts them into a buffer.

    With spin_thread=True a thread of its own spins the node, so that callbacks of other nodes may wait for transforms.
    A node belongs to one executor: as in ROS, rclpy.spin() of the same node takes it from that thread.
    """

    def __init__(
        self,
        buffer: Buffer,
        node: Node,
        *,
        spin_thread: bool = False,
        qos: QoSProfile | int | None = None,
        static_qos: QoSProfile | int | None = None,
    ) -> None:
        if isinstance(buffer, Node):
            raise TypeError("a TransformListener takes the buffer first: TransformListener(self.tf_buffer, self)")
        self.buffer = buffer
        self._takes = False  # what waits
        self.node = node
        buffer.logger = node.get_logger()
        # Beside other callbacks of the node, that one of these may wait for a transform.
        self.group = ReentrantCallbackGroup()
        self.tf_sub = node.create_subscription(
            TFMessage, TF, self.callback, DEPTH if qos is None else qos, callback_group=self.group
        )
        self.tf_static_sub = node.create_subscription(
            TFMessage,
            TF_STATIC,
            self.static_callback,
            kept_qos(depth=DEPTH) if static_qos is None else static_qos,
            callback_group=self.group,
        )
        if spin_thread:
            self.executor = SingleThreadedExecutor(context=node.context)
            self.executor.add_node(node)
            # It holds neither the listener nor the end of the process.
            self.dedicated_listener_thread = Thread(
                target=_spin, args=(self.executor, node, self.tf_static_sub), name="tf2_listener", daemon=True
            )
            self.dedicated_listener_thread.start()

    def unregister(self) -> None:
        """Listen no longer; the thread of its own ends."""
        self.node.destroy_subscription(self.tf_sub)
        self.node.destroy_subscription(self.tf_static_sub)
        if hasattr(self, "executor"):
            self.executor.wake()

    def callback(self, data: TFMessage) -> None:
        """Take in transforms of /tf, and those that wait behind them.

        An executor hands on one message a turn, and a node that gets fewer turns than messages, as on a busy machine,
        would go by transforms that are a hundred messages old.
        """
        for transform in data.transforms:
            self.buffer.set_transform(transform, AUTHORITY)
        if not self._takes:
            self._takes = True
            try:
                for message in self._waiting():
                    self.tf_sub.callback(message)  # not callback(): who counts a subscription's callbacks counts these
            finally:
                self._takes = False

    def _waiting(self) -> Iterator[TFMessage]:
        subscription = getattr(self, "tf_sub", None)  # a thread may spin the node already
        if subscription is None:
            return
        with contextlib.suppress(InvalidHandle), subscription.handle:
            for _ in range(DEPTH):
                taken = subscription.handle.take_message(subscription.msg_type, subscription.raw)
                if taken is None:
                    return
                yield taken[0]

    def static_callback(self, data: TFMessage) -> None:
        """Take in transforms of /tf_static."""
        for transform in data.transforms:
            self.buffer.set_transform_static(transform, AUTHORITY)


def _spin(executor: SingleThreadedExecutor, node: Node, subscription: Subscription) -> None:
    """Spin until the subscription is destroyed, with its node or without, or ROS ends."""
    with contextlib.suppress(ExternalShutdownException):
        while executor.context.ok() and subscription in node.subscriptions:
            executor.spin_once(timeout_sec=PAUSE)
    executor.shutdown(timeout_sec=0)
