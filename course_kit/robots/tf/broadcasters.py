"""TransformBroadcaster and StaticTransformBroadcaster of tf2_ros: nodes say where frames are."""

from __future__ import annotations

from collections.abc import Iterable

from geometry_msgs.msg import TransformStamped
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, HistoryPolicy, QoSProfile
from tf2_msgs.msg import TFMessage

TF, TF_STATIC = "/tf", "/tf_static"


def kept_qos(depth: int) -> QoSProfile:
    """That of /tf_static: who comes late still gets it."""
    return QoSProfile(depth=depth, durability=DurabilityPolicy.TRANSIENT_LOCAL, history=HistoryPolicy.KEEP_LAST)


def _listed(transform: TransformStamped | Iterable[TransformStamped]) -> list[TransformStamped]:
    listed = list(transform) if isinstance(transform, Iterable) else [transform]
    for one in listed:
        if not isinstance(one, TransformStamped):
            raise TypeError(f"sendTransform() takes a TransformStamped or a list of them, not {type(one).__name__}")
    return listed


class TransformBroadcaster:
    """Sends where frames are now, on /tf."""

    def __init__(self, node: Node, qos: QoSProfile | int | None = None) -> None:
        self.pub_tf = node.create_publisher(TFMessage, TF, QoSProfile(depth=100) if qos is None else qos)

    def sendTransform(self, transform: TransformStamped | Iterable[TransformStamped]) -> None:  # noqa: N802
        """Send one transform or several in one message."""
        self.pub_tf.publish(TFMessage(transforms=_listed(transform)))


class StaticTransformBroadcaster:
    """Sends where frames are for good, on /tf_static: all that was sent before goes with each message."""

    def __init__(self, node: Node, qos: QoSProfile | int | None = None) -> None:
        self.pub_tf = node.create_publisher(TFMessage, TF_STATIC, kept_qos(depth=1) if qos is None else qos)
        self._sent: dict[str, TransformStamped] = {}

    def sendTransform(self, transform: TransformStamped | Iterable[TransformStamped]) -> None:  # noqa: N802
        """Send one transform or several."""
        self._sent |= {one.child_frame_id: one for one in _listed(transform)}
        self.pub_tf.publish(TFMessage(transforms=list(self._sent.values())))
