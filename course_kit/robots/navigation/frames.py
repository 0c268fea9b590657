"""Places from tf: of frames, and of a laser at the moment of a scan."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable
from typing import Any

from geometry_msgs.msg import PoseStamped
from rclpy.clock import JumpThreshold, TimeJump
from rclpy.duration import Duration
from rclpy.node import Node
from rclpy.qos import qos_profile_sensor_data
from rclpy.task import Future
from rclpy.time import Time
from sensor_msgs.msg import LaserScan
from tf2_ros import Buffer, TransformException, TransformListener

from course_kit.robots.navigation.messages import place_of
from course_kit.robots.navigation.places import Place, after

WAITING = 10  # scans that may wait for their transform; then the oldest is given up


class Frames:
    """A node's ear for /tf, and the names of its frames by its parameters."""

    def __init__(self, node: Node, on_restart: Callable[[], None]) -> None:
        """`on_restart()` is called when time jumps back: the simulation has begun anew, elsewhere."""
        self.map, self.odom, self.base = (
            node.declare_parameter(f"{name}_frame", default).value
            for name, default in (("map", "map"), ("odom", "odom"), ("base", "base_link"))
        )
        self.buffer = Buffer()
        self.listener = TransformListener(self.buffer, node)
        self._on_restart = on_restart
        self._clock = node.get_clock()
        back = JumpThreshold(min_forward=None, min_backward=Duration(seconds=-1), on_clock_change=False)
        self.jumps = self._clock.create_jump_callback(back, post_callback=self._on_jump)

    def _on_jump(self, _: TimeJump) -> None:
        self.buffer.clear()
        self._on_restart()

    def place(self, inside: str, frame: str, stamp: Any = None, oldest: Duration | None = None) -> Place | None:
        """Where a frame is in another at a time, or as of late, but not `oldest` ago; None if tf does not tell."""
        try:
            time = Time() if stamp is None else Time.from_msg(stamp)
            found = self.buffer.lookup_transform(inside, frame, time)
        except TransformException:
            return None
        now = self._clock.now()
        if oldest is not None and now - Time.from_msg(found.header.stamp, now.clock_type) > oldest:
            return None
        return place_of(found.transform)

    def in_map(self, pose: PoseStamped) -> Place:
        """Where a pose lies in the map, as of late; ValueError if tf does not tell."""
        place, frame = place_of(pose.pose), pose.header.frame_id
        if frame in ("", self.map):
            return place
        origin = self.place(self.map, frame)
        if origin is None:
            raise ValueError(f"tf does not tell where the frame '{frame}' is in '{self.map}'")
        return after(origin, place)


class PlacedScans:
    """Hands on each scan with the place of its laser in a frame, as soon as tf tells where that was.

    As a rule a scan comes before the transforms of its moment. To wait for them in its callback would keep the only
    thread of the node from hearing them.
    """

    def __init__(self, node: Node, frames: Frames, inside: str, hand_on: Callable[[LaserScan, Place], None]) -> None:
        self._frames, self._inside, self._hand_on = frames, inside, hand_on
        self._waiting: deque[tuple[LaserScan, Future]] = deque()
        node.create_subscription(LaserScan, "scan", self._on_scan, qos_profile_sensor_data)

    def _on_scan(self, scan: LaserScan) -> None:
        while len(self._waiting) >= WAITING:
            self._waiting.popleft()[1].cancel()
        stamp = Time.from_msg(scan.header.stamp)
        placed = self._frames.buffer.wait_for_transform_async(self._inside, scan.header.frame_id, stamp)
        self._waiting.append((scan, placed))
        placed.add_done_callback(self._on_placed)

    def _on_placed(self, _: Future) -> None:
        while self._waiting and self._waiting[0][1].done():
            scan, _ = self._waiting.popleft()
            place = self._frames.place(self._inside, scan.header.frame_id, scan.header.stamp)
            if place is not None:
                self._hand_on(scan, place)
