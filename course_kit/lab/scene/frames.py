"""Places of frames over time, by the rules of robots/tf, from the messages that are given.

Pure numpy, no ROS.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt

from course_kit.robots.tf.chain import chain_between
from course_kit.robots.tf.errors import TransformException
from course_kit.robots.tf.link_history import NEVER, Found, Link, Sample
from course_kit.robots.tf.rigid_transforms import RigidTransform
from course_kit.robots.tf.tree import Tree

Float64s = npt.NDArray[np.float64]
ODOMETRY = "nav_msgs/msg/Odometry"
TRANSFORMS = ("geometry_msgs/msg/TransformStamped", "tf2_msgs/msg/TFMessage")
FOREVER = 1 << 62  # ns


def stamp_of(message: Any) -> int:
    """The stamp in the header of a message, in ns; NEVER if it is not set."""
    return int(message.header.stamp.sec) * 1_000_000_000 + int(message.header.stamp.nanosec)


class Frames:
    """Frames, with the link of each to its parent, which stays as it is before its first and after its last message."""

    def __init__(self) -> None:
        self._links: dict[str, Link] = {}
        self._odometry: dict[str, Link] = {}  # counts where no transform says where the frame is

    def add(self, message: Any, type_name: str, is_static: bool = False) -> None:
        """Learn from a message; one that says nothing about frames changes nothing."""
        if type_name == ODOMETRY:
            pose = message.pose.pose
            self._add(self._odometry, message, pose.position, pose.orientation, is_static)
        elif type_name in TRANSFORMS:
            for one in getattr(message, "transforms", None) or [message]:
                self._add(self._links, one, one.transform.translation, one.transform.rotation, is_static)

    @staticmethod
    def _add(links: dict[str, Link], message: Any, position: Any, orientation: Any, is_static: bool) -> None:
        parent, child = message.header.frame_id, message.child_frame_id
        if not parent or not child:
            return
        q = np.array([orientation.w, orientation.x, orientation.y, orientation.z], np.float64)
        length = float(np.linalg.norm(q))
        turn = q / length if length > 1e-9 else np.array([1.0, 0.0, 0.0, 0.0])
        place = RigidTransform(np.array([position.x, position.y, position.z], np.float64), turn)
        link = links.setdefault(child, Link(FOREVER, is_static))
        link.add(Sample(NEVER if link.is_static else stamp_of(message), parent, place))

    def place(self, inside: str, name: str, moment: int) -> Float64s | None:
        """The pose of a frame in another one as a matrix, at a moment in ns or the last (NEVER); None if not known."""
        return _pose(self._at(moment), inside, name)

    def places(self, inside: str, moment: int) -> dict[str, Float64s]:
        """The same of all frames to which messages lead from that one, by their names, parents first."""
        tree = self._at(moment)
        found = {name: _pose(tree, inside, name) for name in sorted(tree.names(), key=self._depth)}
        return {name: place for name, place in found.items() if place is not None}

    def beyond(self, inside: str, name: str, moment: int, near: int = 0) -> str:
        """Which link between two frames is not known within `near` ns of a moment, and by how much; '' if all are.

        A single message counts for all times.
        """
        known = self._known()
        chain = chain_between(inside, name, lambda frame: known[frame].parent if frame in known else None)
        for child, link in ((frame, known[frame]) for frame in chain if frame in known):
            if link.parent not in chain:  # of the frame that is above both
                continue
            for side, where, off in (
                ("last", "later", moment - link.latest),
                ("first", "earlier", link.oldest - moment),
            ):
                if moment and len(link) > 1 and off > near:
                    return f"{off * 1e-9:.2f} s {where} than the {side} that is known of '{child}' in '{link.parent}'"
        return ""

    def _depth(self, name: str) -> int:
        known, above = self._known(), [name]
        while (link := known.get(above[-1])) is not None and link.parent not in above:
            above.append(link.parent)
        return len(above)

    def _known(self) -> dict[str, Link]:
        return self._odometry | self._links

    def _at(self, moment: int) -> Tree:
        """All frames as they were at a moment, or as they were last."""
        tree = Tree()
        for child, link in self._known().items():
            found = link.at(min(max(moment, link.oldest), link.latest) if moment else NEVER)
            assert isinstance(found, Found)  # between its first and its last sample a link knows everything
            tree.add(child, Sample(NEVER, found.older.parent, found.placement()), "", is_static=True)
        return tree


def _pose(tree: Tree, inside: str, name: str) -> Float64s | None:
    from pytransform3d.transformations import transform_from_pq

    try:
        place, _ = tree.lookup(inside, name, NEVER)
    except TransformException:
        return None
    return np.asarray(transform_from_pq([*place.translation, *place.rotation]), np.float64)
